//! The completed object with what is known of each of its vertices, and the part of it that a
//! completion is changing.

use crate::descriptor::ball::VertexGraph;
use crate::descriptor::heat::Heat;
use crate::descriptor::patch_signature::Surface;
use crate::descriptor::prolong::Prolongation;
use crate::fill::patch::Patch;
use crate::fill::sheet::Incidence;
use crate::mesh::neighbourhood::NONE;
use glam::DVec3;

/// Principal components of the heat kernel signature that correspondences are found by. The sixth
/// spreads 0.2 to 0.7 % as much as the first on a head, a column, an animal and a relief.
pub const HEAT: usize = 6;

/// What matching knows of a vertex beside its position.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Traits {
    /// Principal components of its heat kernel signature.
    pub heat: [f64; HEAT],
    /// The feature-line field, a unit tangent; zero where there is none.
    pub field: DVec3,
    /// Whether a ridge or a valley passes through one of its faces.
    pub is_feature: bool,
}

impl Traits {
    /// Those of a vertex halfway between two.
    pub fn between(a: &Self, b: &Self) -> Self {
        Self {
            heat: std::array::from_fn(|k| 0.5 * (a.heat[k] + b.heat[k])),
            field: (a.field + b.field).normalize_or_zero(),
            is_feature: a.is_feature && b.is_feature,
        }
    }
}

/// An object whose holes all have an initial completion, and its description.
pub struct Object {
    /// Positions, in mesh units.
    pub positions: Vec<DVec3>,
    /// Triangles.
    pub faces: Vec<[u32; 3]>,
    /// The hole whose completion each face belongs to; [`NONE`] for the source's.
    pub hole_of_face: Vec<u32>,
    /// The hole whose completion each vertex is new in; [`NONE`] for the source.
    pub hole_of_vertex: Vec<u32>,
    /// Faces at each vertex.
    pub incidence: Incidence,
    /// Edges.
    pub graph: VertexGraph,
    /// Area of each vertex, in square mesh units.
    pub mass: Vec<f64>,
    /// Heat kernel signatures on a coarse copy.
    pub heat: Heat,
    /// The way from there.
    pub prolongation: Prolongation,
    /// What is known of each vertex.
    pub traits: Vec<Traits>,
    /// Greatest curvature without its sign at each vertex, in 1 / mesh unit.
    pub curvature: Vec<f64>,
}

impl Object {
    /// The mesh as patch signatures are computed on it.
    pub fn surface(&self) -> Surface<'_> {
        Surface {
            positions: &self.positions,
            graph: &self.graph,
            mass: &self.mass,
            prolongation: &self.prolongation,
        }
    }

    /// Whether a vertex belongs to the source and has faces.
    pub fn is_source(&self, v: u32) -> bool {
        self.hole_of_vertex[v as usize] == NONE && !self.incidence.faces(v).is_empty()
    }

    /// Surface area, in square mesh units.
    pub fn area(&self) -> f64 {
        self.mass.iter().sum()
    }

    /// Mean edge length, in mesh units; an edge counts once for each of its faces.
    pub fn mean_edge(&self) -> f64 {
        mean_edge(&self.positions, &self.faces)
    }
}

/// Mean edge length of a mesh, in mesh units; an edge counts once for each of its faces.
pub fn mean_edge(positions: &[DVec3], faces: &[[u32; 3]]) -> f64 {
    let length = |f: &[u32; 3]| {
        let p = f.map(|v| positions[v as usize]);
        p[0].distance(p[1]) + p[1].distance(p[2]) + p[2].distance(p[0])
    };
    faces.iter().map(length).sum::<f64>() / (3 * faces.len().max(1)) as f64
}

/// The completion of one hole while it changes. It replaces the object's own faces of that hole.
#[derive(Clone)]
pub struct Target {
    /// The hole, as in [`Object::hole_of_face`].
    pub hole: u32,
    /// The triangles. [`Patch::offsets`] holds where each vertex goes.
    pub patch: Patch,
    /// Object vertex of each rim vertex.
    pub rim: Vec<u32>,
    /// Of each vertex of the patch.
    pub traits: Vec<Traits>,
    /// Where each vertex of the patch was when it all began, in mesh units.
    pub rest: Vec<DVec3>,
    /// The number of the target patch around each vertex of the patch; [`NONE`]: no patch.
    pub centre: Vec<u32>,
}

impl Target {
    /// A completion whose vertex i is object vertex `origin[i]`.
    pub fn new(hole: u32, patch: Patch, origin: &[u32], object: &Object) -> Self {
        Self {
            hole,
            rim: origin[..patch.rim_count].to_vec(),
            traits: origin.iter().map(|&v| object.traits[v as usize]).collect(),
            rest: patch.positions.clone(),
            centre: vec![NONE; patch.positions.len()],
            patch,
        }
    }

    /// New vertices, as patch vertices.
    pub fn new_vertices(&self) -> std::ops::Range<usize> {
        self.patch.rim_count..self.patch.positions.len()
    }
}

/// Object and target as one surface. Vertices below the object's count are the object's, then
/// come the target's new ones; the object's own vertices of the same hole have no edges.
pub struct Scene<'a> {
    /// All but the hole.
    pub object: &'a Object,
    /// The hole.
    pub target: &'a Target,
    /// Positions of all, in mesh units.
    pub positions: Vec<DVec3>,
    /// Edges of all.
    pub graph: VertexGraph,
    /// Patch vertex of each; [`NONE`] for those that are no vertex of the patch.
    pub patch_vertex: Vec<u32>,
}

impl<'a> Scene<'a> {
    /// Puts both together.
    pub fn new(object: &'a Object, target: &'a Target) -> Self {
        let mut positions = object.positions.clone();
        positions.extend_from_slice(&target.patch.positions[target.patch.rim_count..]);
        let known = object.faces.iter().zip(&object.hole_of_face).filter(|f| *f.1 != target.hole);
        let mut faces: Vec<[u32; 3]> = known.map(|f| *f.0).collect();
        let number = |v: u32| scene_vertex(object, target, v as usize);
        faces.extend(target.patch.triangles.iter().map(|t| t.map(number)));
        let graph = VertexGraph::new(positions.len(), &faces);
        let mut patch_vertex = vec![NONE; positions.len()];
        for v in 0..target.patch.positions.len() {
            patch_vertex[number(v as u32) as usize] = v as u32;
        }
        Self { object, target, positions, graph, patch_vertex }
    }

    /// The scene's number of a patch vertex.
    pub fn of_patch(&self, v: usize) -> u32 {
        scene_vertex(self.object, self.target, v)
    }

    /// What is known of a vertex.
    pub fn traits(&self, v: u32) -> &Traits {
        match self.object.traits.get(v as usize) {
            Some(traits) => traits,
            None => &self.target.traits[self.patch_vertex[v as usize] as usize],
        }
    }

    /// Whether a vertex belongs to the source.
    pub fn is_source(&self, v: u32) -> bool {
        self.object.hole_of_vertex.get(v as usize) == Some(&NONE)
    }
}

fn scene_vertex(object: &Object, target: &Target, v: usize) -> u32 {
    match target.rim.get(v) {
        Some(&rim) => rim,
        None => (object.positions.len() + v - target.patch.rim_count) as u32,
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// An object without any description but its shape; faces whose middle `is_hole` accepts are the
    /// completion of hole 0, as are the vertices that only they have.
    pub(crate) fn bare_object(
        positions: Vec<DVec3>,
        faces: Vec<[u32; 3]>,
        is_hole: impl Fn(DVec3) -> bool,
    ) -> Object {
        let middle = |f: &[u32; 3]| f.iter().map(|&v| positions[v as usize]).sum::<DVec3>() / 3.0;
        let hole_of_face: Vec<u32> =
            faces.iter().map(|f| if is_hole(middle(f)) { 0 } else { NONE }).collect();
        let mut hole_of_vertex = vec![0; positions.len()];
        for (face, _) in faces.iter().zip(&hole_of_face).filter(|f| *f.1 == NONE) {
            face.iter().for_each(|&v| hole_of_vertex[v as usize] = NONE);
        }
        Object {
            hole_of_face,
            hole_of_vertex,
            incidence: Incidence::of(positions.len(), &faces),
            graph: VertexGraph::new(positions.len(), &faces),
            mass: vec![1.0; positions.len()],
            heat: Heat::default(),
            prolongation: Prolongation::default(),
            traits: vec![Traits::default(); positions.len()],
            curvature: vec![0.0; positions.len()],
            positions,
            faces,
        }
    }
}
