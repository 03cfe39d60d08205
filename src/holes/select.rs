//! Which of the holes the caller asked for.

use super::loops::position;
use super::HoleList;
use crate::error::{Error, Result};
use crate::mesh::MeshView;
use crate::options::Selection;
use glam::DVec3;

/// For each hole whether it is selected.
pub fn select_holes(
    mesh: MeshView<'_>,
    list: &HoleList,
    selection: &Selection,
) -> Result<Vec<bool>> {
    let holes = &list.holes;
    let each = |wanted: &dyn Fn(&super::Hole) -> bool| Ok(holes.iter().map(wanted).collect());
    match selection {
        Selection::All => each(&|_| true),
        Selection::Ids(ids) => {
            if let Some(&hole) = ids.iter().find(|&&id| id >= holes.len()) {
                return Err(Error::NoSuchHole { hole, count: holes.len() });
            }
            each(&|h| ids.contains(&h.id))
        }
        Selection::MaxEdges(n) => each(&|h| h.edges <= *n),
        Selection::MaxCircumference(l) => each(&|h| h.circumference <= *l),
        Selection::MaxDiameter(d) => each(&|h| h.diameter <= *d),
        Selection::AllButLargest => {
            // By its longest loop: islands do not make a gap larger than the scan's own border.
            let length = |h: &super::Hole| list.loops[h.loops[0]].length;
            let largest = holes
                .iter()
                .max_by(|a, b| length(a).total_cmp(&length(b)).then(b.id.cmp(&a.id)))
                .map(|h| h.id);
            each(&|h| Some(h.id) != largest)
        }
        Selection::NearPoint(p) => {
            let nearest = nearest_hole(mesh, list, DVec3::from(*p));
            each(&|h| Some(h.id) == nearest)
        }
        Selection::NearVertices(vertices) => near_vertices(mesh, list, vertices),
    }
}

fn nearest_hole(mesh: MeshView<'_>, list: &HoleList, p: DVec3) -> Option<usize> {
    let distance = |hole: &super::Hole| {
        hole.loops
            .iter()
            .flat_map(|&l| &list.loops[l].vertices)
            .map(|&v| position(mesh, v).distance_squared(p))
            .fold(f64::INFINITY, f64::min)
    };
    let far = list.holes.iter().map(|h| (distance(h), h.id));
    far.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, id)| id)
}

fn near_vertices(mesh: MeshView<'_>, list: &HoleList, vertices: &[u32]) -> Result<Vec<bool>> {
    let count = mesh.vertices.len();
    if let Some(v) = vertices.iter().find(|&&v| v as usize >= count) {
        let reason = format!("vertex {v} does not exist: the mesh has {count}");
        return Err(Error::InvalidOption { name: "selection", reason });
    }
    let on_rim = |hole: &super::Hole, v: &u32| {
        hole.loops.iter().any(|&l| list.loops[l].vertices.contains(v))
    };
    let mut wanted: Vec<bool> =
        list.holes.iter().map(|h| vertices.iter().any(|v| on_rim(h, v))).collect();
    if !wanted.contains(&true) {
        for &v in vertices {
            if let Some(id) = nearest_hole(mesh, list, position(mesh, v)) {
                wanted[id] = true;
            }
        }
    }
    Ok(wanted)
}
