//! The source: what is known of the object, or the part of it and of an exemplar that may be copied
//! from, ready to be searched.

use super::axes::principal_axes;
use super::paint::Paint;
use super::point_tree::PointTree;
use super::rigid::Rigid;
use crate::error::Result;
use crate::intersect::Bvh;
use crate::mesh::boundary::find_boundary;
use crate::mesh::neighbourhood::NONE;
use crate::mesh::normals::vertex_normals_checked;
use crate::mesh::MeshView;
use crate::options::{Exemplar, Sources};
use crate::progress::{Monitor, Pace};
use glam::{DMat3, DVec3};
use std::ops::Deref;
use std::sync::Arc;

/// A mesh with normals and search trees: what is known of the object, or what may be copied from; as one
/// hole may use it.
#[derive(Clone)]
pub struct Source {
    mesh: Arc<SourceMesh>,
    /// The hole whose own completion is nothing to copy from; [`NONE`]: no hole's.
    pub own: u32,
}

impl Deref for Source {
    type Target = SourceMesh;

    fn deref(&self) -> &SourceMesh {
        &self.mesh
    }
}

/// What all holes share of a source. Faces and vertices of completions come after all that is known.
pub struct SourceMesh {
    /// Positions of all input vertices, in mesh units.
    pub positions: Vec<DVec3>,
    /// Unit normals, area-weighted; zero where there is no area.
    pub normals: Vec<DVec3>,
    /// All faces that have an area and may be copied from.
    pub faces: Vec<[u32; 3]>,
    /// Input index of each of them.
    pub face_ids: Vec<u32>,
    /// Whether a vertex lies on a boundary loop that has no completion.
    pub on_boundary: Vec<bool>,
    /// The hole that each vertex is completed in, or on whose rim it lies; [`NONE`]: none. Empty without
    /// completions.
    pub completion: Vec<u32>,
    /// Vertices that are no completion's.
    pub known_vertices: usize,
    /// Faces that are no completion's.
    pub known_faces: usize,
    /// Tree over `faces`.
    pub tree: Bvh,
    /// Tree over the vertices that some face uses.
    pub points: PointTree,
    /// Surface area, in square mesh units.
    pub area: f64,
    /// Mean edge length, in mesh units.
    pub edge: f64,
    /// Its principal axes: nothing found in it depends on how it lies in space.
    pub axes: DMat3,
    /// Mean square of the turn of the normal along the edges at each vertex, in radians² an edge
    /// of mean length: what there is of relief.
    pub roughness: Vec<f64>,
    /// Mean length of the edges at each vertex, in mesh units.
    pub lengths: Vec<f64>,
    /// The colours that steer the search, if there are any.
    pub paint: Option<Paint>,
    /// Input faces from which on they are of another exemplar, and how far that was shifted, so that no two
    /// lie on each other.
    pub shifts: Vec<(u32, DVec3)>,
}

impl Source {
    /// Copies the mesh and builds the trees: linear but for the trees' sorting. Asks `check` now and
    /// then whether to go on.
    pub fn new(
        mesh: MeshView<'_>,
        boundary: impl Iterator<Item = u32>,
        check: &dyn Fn(f64) -> Result<()>,
    ) -> Result<Self> {
        Parts::of(mesh, boundary, &|_| true, &|| check(0.0))?.build(check)
    }

    /// A source without completions, or that no hole uses yet.
    pub fn of(mesh: SourceMesh) -> Self {
        Self { mesh: Arc::new(mesh), own: NONE }
    }

    /// To change it in a test.
    #[cfg(test)]
    pub(crate) fn edit(&mut self) -> &mut SourceMesh {
        Arc::get_mut(&mut self.mesh).expect("nobody else has it")
    }

    /// The same as a hole may use it.
    pub fn for_hole(&self, own: u32) -> Self {
        Self { mesh: self.mesh.clone(), own }
    }

    /// A mesh with completions of some of its holes: faces from `known_faces` and vertices from
    /// `known_vertices` on are theirs. `completion`: see [`SourceMesh::completion`].
    pub fn completed(
        mesh: MeshView<'_>,
        boundary: impl Iterator<Item = u32>,
        completion: Vec<u32>,
        [known_vertices, known_faces]: [usize; 2],
        check: &dyn Fn(f64) -> Result<()>,
    ) -> Result<Self> {
        let open = boundary.filter(|&v| completion[v as usize] == NONE);
        let mut parts = Parts::of(mesh, open, &|_| true, &|| check(0.0))?;
        let first = parts.face_ids.partition_point(|&f| (f as usize) < known_faces);
        (parts.known_vertices, parts.known_faces) = (known_vertices, first);
        parts.completion = completion;
        parts.build(check)
    }

    /// What may be copied from of a mesh, with the exemplar if there is one: the exemplar's faces are
    /// numbered from the mesh's face count on.
    pub fn chosen(
        mesh: MeshView<'_>,
        boundary: impl Iterator<Item = u32>,
        sources: &Sources,
        check: &dyn Fn(f64) -> Result<()>,
    ) -> Result<Self> {
        let may = |f: usize| match &sources.faces {
            _ if sources.exemplar_only => false,
            Some(faces) => faces[f],
            None => true,
        };
        let mut parts = Parts::of(mesh, boundary, &may, &|| check(0.0))?;
        if let Some(exemplar) = &sources.exemplar {
            let view = MeshView::new(&exemplar.vertices[..], &exemplar.faces[..]);
            let edges = find_boundary(view, &Monitor::silent())?.edges;
            let boundary = edges.iter().flat_map(|e| [e.from, e.to]);
            let part = Parts::of(view, boundary, &|_| true, &|| check(PASSES[0]))?;
            parts.append(part, mesh.faces.len());
            parts.part(exemplar, mesh.vertices.len(), mesh.faces.len());
        }
        parts.build(check)
    }

    /// With the colours of the mesh and its exemplar.
    pub fn painted(mut self, paint: &Option<Paint>) -> Self {
        if let Some(mesh) = Arc::get_mut(&mut self.mesh) {
            mesh.paint = paint.as_ref().map(|p| p.on(&mesh.positions, &mesh.faces));
        }
        self
    }

    /// The tint of a vertex; 0 without colours.
    pub fn tint(&self, v: usize) -> f64 {
        self.paint.as_ref().map_or(0.0, |p| p.tint[v])
    }

    /// Unit normal of a face; zero if it has no area.
    pub fn face_normal(&self, face: u32) -> DVec3 {
        let p = self.faces[face as usize].map(|v| self.positions[v as usize]);
        (p[1] - p[0]).cross(p[2] - p[0]).normalize_or_zero()
    }

    /// Barycentric coordinates of a point on a face; they sum to 1.
    pub fn barycentric(&self, face: u32, p: DVec3) -> [f64; 3] {
        let [a, b, c] = self.faces[face as usize].map(|v| self.positions[v as usize]);
        let n = (b - a).cross(c - a);
        let scale = 1.0 / n.length_squared().max(f64::MIN_POSITIVE);
        let v = (p - a).cross(c - a).dot(n) * scale;
        let w = (b - a).cross(p - a).dot(n) * scale;
        [1.0 - v - w, v, w]
    }

    /// The normal at a point of a face, interpolated from its corners.
    pub fn smooth_normal(&self, face: u32, barycentric: [f64; 3]) -> DVec3 {
        let corners = self.faces[face as usize];
        let sum: DVec3 = (0..3).map(|k| barycentric[k] * self.normals[corners[k] as usize]).sum();
        sum.normalize_or_zero()
    }

    /// The mean length of the edges around a point of a face, in mesh units.
    pub fn length_at(&self, face: u32, barycentric: [f64; 3]) -> f64 {
        let corners = self.faces[face as usize];
        (0..3).map(|k| barycentric[k] * self.lengths[corners[k] as usize]).sum()
    }

    /// A transform of the source, as one of the exemplar that an input face belongs to.
    pub fn as_given(&self, transform: &Rigid, input_face: u32) -> Rigid {
        match self.shifts.iter().rfind(|s| s.0 <= input_face) {
            Some(&(_, by)) => transform.after(&Rigid { translation: by, ..Rigid::IDENTITY }),
            None => *transform,
        }
    }

    /// The other way round: a transform of the exemplar that an input face belongs to, as one of the source.
    pub fn as_laid(&self, given: &Rigid, input_face: u32) -> Rigid {
        match self.shifts.iter().rfind(|s| s.0 <= input_face) {
            Some(&(_, by)) => given.after(&Rigid { translation: -by, ..Rigid::IDENTITY }),
            None => *given,
        }
    }

    /// The point of a face with such coordinates.
    pub fn point(&self, face: u32, barycentric: [f64; 3]) -> DVec3 {
        let corners = self.faces[face as usize].map(|v| self.positions[v as usize]);
        (0..3).map(|k| barycentric[k] * corners[k]).sum()
    }

    /// Whether a vertex lies on a boundary loop, or is completed in the hole that this is for.
    pub fn is_boundary(&self, v: u32) -> bool {
        self.on_boundary[v as usize]
            || self.own != NONE && self.completion.get(v as usize) == Some(&self.own)
    }

    /// Whether a face has such a vertex.
    pub fn touches_boundary(&self, face: u32) -> bool {
        self.faces[face as usize].iter().any(|&v| self.is_boundary(v))
    }

    /// Whether a face is a completion's.
    pub fn is_completion(&self, face: u32) -> bool {
        face as usize >= self.known_faces
    }

    /// Whether it is that of the hole that this is for.
    pub fn is_own(&self, face: u32) -> bool {
        self.is_completion(face)
            && self.completion[self.faces[face as usize][0] as usize] == self.own
    }
}

/// Elementary steps that a pass takes for a face, and for a vertex.
const FACE: usize = 8;
const VERTEX: usize = 4;
/// The parts of a source's time at which begin: an exemplar, sums over the faces, means of the edges, axes with
/// the tree over faces, and that over vertices. Measured on 630 thousand vertices.
const PASSES: [f64; 5] = [0.02, 0.05, 0.06, 0.1, 0.86];

/// A source that is being put together.
struct Parts {
    positions: Vec<DVec3>,
    normals: Vec<DVec3>,
    on_boundary: Vec<bool>,
    faces: Vec<[u32; 3]>,
    face_ids: Vec<u32>,
    shifts: Vec<(u32, DVec3)>,
    completion: Vec<u32>,
    known_vertices: usize,
    known_faces: usize,
}

impl Parts {
    /// The faces of a mesh that may be copied from. Normals are those of the whole mesh.
    fn of(
        mesh: MeshView<'_>,
        boundary: impl Iterator<Item = u32>,
        may: &dyn Fn(usize) -> bool,
        check: &dyn Fn() -> Result<()>,
    ) -> Result<Self> {
        let mut pace = Pace::new(check);
        let n = mesh.vertices.len();
        let mut positions = Vec::with_capacity(n);
        for v in 0..n {
            pace.work(VERTEX)?;
            positions.push(DVec3::from(mesh.vertices.get(v)));
        }
        let all = || (0..mesh.faces.len()).map(|f| mesh.faces.get(f));
        let normals = vertex_normals_checked(&positions, all(), check)?;
        let (mut faces, mut face_ids) = (Vec::with_capacity(mesh.faces.len()), Vec::new());
        for (f, face) in all().enumerate().filter(|(f, _)| may(*f)) {
            pace.work(FACE)?;
            let [a, b, c] = face.map(|v| positions[v as usize]);
            if (b - a).cross(c - a) != DVec3::ZERO {
                faces.push(face);
                face_ids.push(f as u32);
            }
        }
        let mut on_boundary = vec![false; n];
        boundary.for_each(|v| on_boundary[v as usize] = true);
        let (shifts, completion, all) = (Vec::new(), Vec::new(), usize::MAX);
        Ok(Self {
            positions,
            normals,
            on_boundary,
            faces,
            face_ids,
            shifts,
            completion,
            known_vertices: all,
            known_faces: all,
        })
    }

    fn append(&mut self, other: Self, first_face: usize) {
        let first = self.positions.len() as u32;
        self.positions.extend(other.positions);
        self.normals.extend(other.normals);
        self.on_boundary.extend(other.on_boundary);
        self.faces.extend(other.faces.iter().map(|f| f.map(|v| v + first)));
        self.face_ids.extend(other.face_ids.iter().map(|&f| f + first_face as u32));
    }

    /// Moves the exemplars, all but the first, out of the way of all that is there, along x.
    fn part(&mut self, exemplar: &Exemplar, first_vertex: usize, first_face: usize) {
        let Some(&first) = exemplar.parts.first() else { return };
        let beyond = |p: &[DVec3]| p.iter().fold(f64::NEG_INFINITY, |x, p| x.max(p.x));
        let (before, of_parts) = self.positions.split_at_mut(first_vertex + first);
        let (mut end, mut rest, mut at) = (beyond(before), of_parts, first as u32);
        for &count in &exemplar.parts[1..] {
            let (own, others) = rest.split_at_mut(count);
            let low = own.iter().fold(f64::INFINITY, |x, p| x.min(p.x));
            // Farther apart than any hole is wide.
            let width = beyond(own) - low;
            let shift = (end + 2.0 * width.max(end.abs()) - low) * DVec3::X;
            own.iter_mut().for_each(|p| *p += shift);
            end = beyond(own).max(end);
            let face = exemplar.faces.iter().position(|f| f[0] >= at);
            if let Some(face) = face.filter(|_| count > 0) {
                self.shifts.push(((first_face + face) as u32, shift));
            }
            (rest, at) = (others, at + count as u32);
        }
    }

    fn build(self, check: &dyn Fn(f64) -> Result<()>) -> Result<Source> {
        let Self { positions, normals, on_boundary, faces, face_ids, shifts, .. } = self;
        let mut used = vec![false; positions.len()];
        let (mut area, mut length) = (0.0, 0.0);
        let [_, sums, means, tree, points] = PASSES;
        let stop = || check(sums);
        let mut pace = Pace::new(&stop);
        for face in &faces {
            pace.work(FACE)?;
            let p = face.map(|v| positions[v as usize]);
            area += 0.5 * (p[1] - p[0]).cross(p[2] - p[0]).length();
            length += p[0].distance(p[1]) + p[1].distance(p[2]) + p[2].distance(p[0]);
            face.iter().for_each(|&v| used[v as usize] = true);
        }
        let ids = (0..positions.len() as u32).filter(|&v| used[v as usize]).collect();
        let edge = length / (3 * faces.len().max(1)) as f64;
        let (roughness, lengths) =
            edge_means(&positions, &normals, &faces, edge, &|| check(means))?;
        Ok(Source::of(SourceMesh {
            completion: self.completion,
            known_vertices: self.known_vertices,
            known_faces: self.known_faces,
            paint: None,
            shifts,
            roughness,
            lengths,
            axes: principal_axes(&positions, &faces, &|| check(tree))?,
            tree: Bvh::new_checked(&positions, &faces, &|part| {
                check(tree + (points - tree) * part)
            })?,
            points: PointTree::new(&positions, ids, &|part| check(points + (1.0 - points) * part))?,
            area,
            edge,
            positions,
            normals,
            faces,
            face_ids,
            on_boundary,
        }))
    }
}

/// Of each vertex the mean over its edges of the roughness and of the length.
fn edge_means(
    positions: &[DVec3],
    normals: &[DVec3],
    faces: &[[u32; 3]],
    edge: f64,
    check: &dyn Fn() -> Result<()>,
) -> Result<(Vec<f64>, Vec<f64>)> {
    let mut pace = Pace::new(check);
    let n = positions.len();
    let (mut turns, mut lengths, mut counts) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
    for face in faces {
        pace.work(FACE)?;
        for k in 0..3 {
            let (a, b) = (face[k] as usize, face[(k + 1) % 3] as usize);
            let length2 = positions[a].distance_squared(positions[b]).max(f64::MIN_POSITIVE);
            let turn = normals[a].distance_squared(normals[b]) * edge * edge / length2;
            for v in [a, b] {
                turns[v] += turn;
                lengths[v] += length2.sqrt();
                counts[v] += 1.0;
            }
        }
    }
    for sums in [&mut turns, &mut lengths] {
        sums.iter_mut().zip(&counts).for_each(|(s, &c)| *s /= f64::max(c, 1.0));
    }
    Ok((turns, lengths))
}

#[cfg(test)]
pub(crate) mod tests {
    use super::super::rigid::Rigid;
    use super::*;
    use glam::DMat3;

    /// A point of irregular hills, and its normal.
    pub(crate) fn hills(x: f64, y: f64) -> (DVec3, DVec3) {
        let (mut z, mut dx, mut dy) = (0.0, 0.0, 0.0);
        for (height, width, a, b) in
            [(0.25, 0.3, 0.2, 0.1), (-0.2, 0.25, -0.4, 0.3), (0.15, 0.22, 0.1, -0.5)]
        {
            let (u, v) = ((x - a) / width, (y - b) / width);
            let bump = height * f64::exp(-u * u - v * v);
            z += bump;
            dx -= 2.0 * u / width * bump;
            dy -= 2.0 * v / width * bump;
        }
        z += 0.05 * (3.0 * x + 1.0).sin() + 0.04 * (4.0 * y).cos();
        dx += 0.15 * (3.0 * x + 1.0).cos();
        dy -= 0.16 * (4.0 * y).sin();
        (DVec3::new(x, y, z), DVec3::new(-dx, -dy, 1.0).normalize())
    }

    /// A rotation by 109° with a translation; mirrored on request.
    pub(crate) fn some_transform(mirrored: bool) -> Rigid {
        let turn = DMat3::from_axis_angle(DVec3::new(0.3, -1.0, 0.8).normalize(), 1.9);
        let flip = DMat3::from_diagonal(DVec3::new(if mirrored { -1.0 } else { 1.0 }, 1.0, 1.0));
        Rigid { linear: turn * flip, translation: DVec3::new(4.0, -2.0, 1.0) }
    }

    /// n × n points of the hills over ±1.5.
    pub(crate) fn hilly_source(n: usize) -> Source {
        let side = |i: usize| 3.0 * i as f64 / (n - 1) as f64 - 1.5;
        let vertices: Vec<[f64; 3]> =
            (0..n * n).map(|k| hills(side(k % n), side(k / n)).0.to_array()).collect();
        let mut faces = Vec::new();
        for k in (0..n * (n - 1)).filter(|k| k % n < n - 1) {
            let [a, b, c, d] = [k, k + 1, k + n + 1, k + n].map(|v| v as u32);
            faces.extend([[a, b, c], [a, c, d]]);
        }
        let border = (0..(n * n) as u32).filter(|v| {
            let (i, j) = (*v as usize % n, *v as usize / n);
            i == 0 || j == 0 || i == n - 1 || j == n - 1
        });
        Source::new(MeshView::new(&vertices[..], &faces[..]), border, &|_| Ok(())).unwrap()
    }

    #[test]
    fn a_source_knows_its_surface() {
        let source = hilly_source(60);
        for v in 0..source.positions.len() {
            let p = source.positions[v];
            let inner = !source.on_boundary[v];
            assert_eq!(inner, p.truncate().abs().max_element() < 1.49);
            assert!(!inner || source.normals[v].dot(hills(p.x, p.y).1) > 0.999);
        }
        let mut area = 0.0;
        for f in 0..source.faces.len() as u32 {
            let p = source.faces[f as usize].map(|v| source.positions[v as usize]);
            area += 0.5 * (p[1] - p[0]).cross(p[2] - p[0]).length();
            let at = 0.2 * p[0] + 0.3 * p[1] + 0.5 * p[2];
            let weights = source.barycentric(f, at);
            for (w, wanted) in weights.iter().zip([0.2, 0.3, 0.5]) {
                assert!((w - wanted).abs() < 1e-10, "{weights:?}");
            }
            let normal = source.face_normal(f);
            assert!((normal.length() - 1.0).abs() < 1e-12 && normal.z > 0.0);
            assert!(source.smooth_normal(f, weights).dot(normal) > 0.95);
            let corners = source.faces[f as usize];
            let touches = corners.iter().any(|&v| source.on_boundary[v as usize]);
            assert_eq!(source.touches_boundary(f), touches);
        }
        assert!((source.area - area).abs() < 1e-9 * area);
    }

    #[test]
    fn degenerate_faces_are_left_out_and_ids_stay() {
        let vertices = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let faces = [[0, 1, 2], [0, 1, 3], [1, 2, 3]];
        let source =
            Source::new(MeshView::new(&vertices[..], &faces[..]), [2].into_iter(), &|_| Ok(()))
                .unwrap();
        assert_eq!(source.faces, [[0, 1, 3], [1, 2, 3]]);
        assert_eq!(source.face_ids, [1, 2]);
        assert_eq!(source.area, 1.0);
        assert!(!source.touches_boundary(0) && source.touches_boundary(1));
        assert!(source.roughness.iter().all(|&r| r == 0.0), "flat");
    }
}
