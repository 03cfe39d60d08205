//! The completed object with what is known of each of its vertices, and the part of it that a
//! completion is changing.

use crate::fill::patch::{next, previous, Patch};
use crate::fill::sheet::Incidence;
use crate::mesh::neighbourhood::NONE;
use glam::DVec3;

/// Numbers of the heat kernel signature that correspondences are found by: its principal
/// components, of which the sixth is below a thousandth of the first on all models measured.
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

/// An object whose holes all have an initial completion.
pub struct Object {
    /// Positions, in mesh units.
    pub positions: Vec<DVec3>,
    /// Triangles.
    pub faces: Vec<[u32; 3]>,
    /// The hole whose completion each face belongs to; [`NONE`] for the input's.
    pub hole_of_face: Vec<u32>,
    /// The hole whose completion each vertex is new in; [`NONE`] for the source.
    pub hole_of_vertex: Vec<u32>,
    /// Faces at each vertex.
    pub incidence: Incidence,
    /// What is known of each vertex.
    pub traits: Vec<Traits>,
}

impl Object {
    /// Mean edge length, in mesh units; each inner edge counts twice.
    pub fn mean_edge(&self) -> f64 {
        let length = |f: &[u32; 3]| {
            let p = f.map(|v| self.positions[v as usize]);
            p[0].distance(p[1]) + p[1].distance(p[2]) + p[2].distance(p[0])
        };
        self.faces.iter().map(length).sum::<f64>() / (3 * self.faces.len().max(1)) as f64
    }

    /// Surface area, in square mesh units.
    pub fn area(&self) -> f64 {
        let area = |f: &[u32; 3]| {
            let [a, b, c] = f.map(|v| self.positions[v as usize]);
            0.5 * (b - a).cross(c - a).length()
        };
        self.faces.iter().map(area).sum()
    }

    /// Vertices of the source that some face uses.
    pub fn source_count(&self) -> usize {
        (0..self.positions.len()).filter(|&v| self.is_source(v as u32)).count()
    }

    /// Whether a vertex belongs to the source.
    pub fn is_source(&self, v: u32) -> bool {
        self.hole_of_vertex[v as usize] == NONE && !self.incidence.faces(v).is_empty()
    }
}

/// The completion of one hole while it changes. It replaces the object's own faces of that hole.
#[derive(Clone)]
pub struct Target {
    /// The hole, as in [`Object::hole_of_face`].
    pub hole: u32,
    /// The triangles.
    pub patch: Patch,
    /// Object vertex of each rim vertex.
    pub rim: Vec<u32>,
    /// Of each vertex of the patch.
    pub traits: Vec<Traits>,
    /// Vertices that share an edge with each, as one array with row starts.
    neighbours: (Vec<u32>, Vec<u32>),
    /// Patch vertex of each object vertex on the rim, sorted by object vertex.
    rim_number: Vec<(u32, u32)>,
}

impl Target {
    /// A completion whose rim vertex i is object vertex `rim[i]`.
    pub fn new(hole: u32, patch: Patch, rim: Vec<u32>, traits: Vec<Traits>) -> Self {
        let mut rim_number: Vec<(u32, u32)> = rim.iter().copied().zip(0..).collect();
        rim_number.sort_unstable();
        let neighbours = Default::default();
        let mut target = Self { hole, patch, rim, traits, neighbours, rim_number };
        target.find_neighbours();
        target
    }

    /// To be called when triangles have changed.
    pub fn find_neighbours(&mut self) {
        let triangles = &self.patch.triangles;
        let mut pairs: Vec<(u32, u32)> = Vec::with_capacity(6 * triangles.len());
        for tri in triangles {
            for k in 0..3 {
                pairs.push((tri[k], tri[next(k)]));
                pairs.push((tri[k], tri[previous(k)]));
            }
        }
        pairs.sort_unstable();
        pairs.dedup();
        let mut start = vec![0u32; self.patch.positions.len() + 1];
        pairs.iter().for_each(|&(v, _)| start[v as usize + 1] += 1);
        for v in 1..start.len() {
            start[v] += start[v - 1];
        }
        self.neighbours = (start, pairs.into_iter().map(|(_, w)| w).collect());
    }

    /// Neighbours of a patch vertex within the patch.
    pub fn neighbours(&self, v: u32) -> &[u32] {
        let (start, to) = &self.neighbours;
        &to[start[v as usize] as usize..start[v as usize + 1] as usize]
    }

    /// Patch vertex of an object vertex on the rim.
    pub fn rim_vertex(&self, v: u32) -> Option<u32> {
        self.rim_number.binary_search_by_key(&v, |r| r.0).ok().map(|i| self.rim_number[i].1)
    }

    /// New vertices, as patch vertices.
    pub fn new_vertices(&self) -> std::ops::Range<u32> {
        self.patch.rim_count as u32..self.patch.positions.len() as u32
    }
}

/// Object and target as one surface. Vertices below the object's count are the object's, then
/// come the target's new ones; the object's own vertices of the same hole are not reached.
#[derive(Clone, Copy)]
pub struct Scene<'a> {
    /// All but the hole.
    pub object: &'a Object,
    /// The hole.
    pub target: &'a Target,
}

impl Scene<'_> {
    /// Vertices, unreachable ones included.
    pub fn vertex_count(&self) -> usize {
        self.object.positions.len() + self.target.new_vertices().len()
    }

    /// The scene's number of a patch vertex.
    pub fn of_patch(&self, v: u32) -> u32 {
        match self.target.rim.get(v as usize) {
            Some(&rim) => rim,
            None => self.object.positions.len() as u32 + v - self.target.patch.rim_count as u32,
        }
    }

    /// The patch vertex of a new vertex; `None` for the object's.
    pub fn new_vertex(&self, v: u32) -> Option<u32> {
        let beyond = (v as usize).checked_sub(self.object.positions.len())?;
        Some((beyond + self.target.patch.rim_count) as u32)
    }

    /// Position of a vertex.
    pub fn position(&self, v: u32) -> DVec3 {
        match self.new_vertex(v) {
            Some(p) => self.target.patch.p(p),
            None => self.object.positions[v as usize],
        }
    }

    /// What is known of a vertex.
    pub fn traits(&self, v: u32) -> &Traits {
        match self.new_vertex(v) {
            Some(p) => &self.target.traits[p as usize],
            None => &self.object.traits[v as usize],
        }
    }

    /// Whether a vertex belongs to the source.
    pub fn is_source(&self, v: u32) -> bool {
        (v as usize) < self.object.positions.len() && self.object.is_source(v)
    }

    /// Calls `f` with every vertex that shares a face with `v`, some twice.
    fn for_neighbours(&self, v: u32, mut f: impl FnMut(u32)) {
        let of_patch = match self.new_vertex(v) {
            Some(p) => Some(p),
            None => {
                for &face in self.object.incidence.faces(v) {
                    if self.object.hole_of_face[face as usize] != self.target.hole {
                        self.object.faces[face as usize].into_iter().for_each(&mut f);
                    }
                }
                self.target.rim_vertex(v)
            }
        };
        if let Some(p) = of_patch {
            self.target.neighbours(p).iter().for_each(|&w| f(self.of_patch(w)));
        }
    }
}

/// Finds the patch around a vertex: the connected part of the surface within a ball (sec. 3).
pub struct Ball {
    seen: Vec<u32>,
    stamp: u32,
}

impl Ball {
    /// For scenes of at most this many vertices.
    pub fn new(vertex_count: usize) -> Self {
        Self { seen: vec![0; vertex_count], stamp: 0 }
    }

    /// The vertices of the patch, the centre first. False as soon as one of them is refused.
    pub fn gather(
        &mut self,
        scene: &Scene<'_>,
        centre: u32,
        radius: f64,
        accept: impl Fn(u32) -> bool,
        found: &mut Vec<u32>,
    ) -> bool {
        self.seen.resize(self.seen.len().max(scene.vertex_count()), 0);
        self.stamp += 1;
        found.clear();
        found.push(centre);
        self.seen[centre as usize] = self.stamp;
        let (middle, limit) = (scene.position(centre), radius * radius);
        let (mut at, mut accepted) = (0, accept(centre));
        while at < found.len() && accepted {
            scene.for_neighbours(found[at], |w| {
                if std::mem::replace(&mut self.seen[w as usize], self.stamp) != self.stamp
                    && scene.position(w).distance_squared(middle) <= limit
                {
                    accepted &= accept(w);
                    found.push(w);
                }
            });
            at += 1;
        }
        accepted
    }
}
