//! The gap between the rim and a part, closed.

use super::cut::Cut;
use super::Wanted;
use crate::complete::Completer;
use crate::error::Result;
use crate::mesh::MeshView;
use crate::options::{Fairing, Grouping, Method, Options, Selection};
use crate::progress::Monitor;
use glam::DVec3;
use std::collections::HashSet;

/// New vertices and faces of a gap, numbered after the mesh and the part.
pub type Gap = (Vec<DVec3>, Vec<[u32; 3]>);

/// What lies between the rim and the part: smooth fills of a mesh that has the part already.
pub fn close_gap(wanted: &Wanted<'_>, cut: &Cut) -> Result<std::result::Result<Gap, String>> {
    let mesh = wanted.mesh;
    let input = mesh.vertices.len() as u32;
    let mut vertices: Vec<[f64; 3]> =
        (0..mesh.vertices.len()).map(|v| mesh.vertices.get(v)).collect();
    vertices.extend(cut.positions.iter().map(|p| p.to_array()));
    let mut faces: Vec<[u32; 3]> = (0..mesh.faces.len()).map(|f| mesh.faces.get(f)).collect();
    faces.extend(cut.faces.iter().map(|f| f.map(|v| v + input)));
    let middle = |l: &[u32]| {
        l.iter().map(|&v| DVec3::from(vertices[v as usize])).sum::<DVec3>() / l.len() as f64
    };
    let mut left: Vec<Vec<u32>> =
        cut.loops.iter().map(|l| l.iter().map(|v| v + input).collect()).collect();
    let mut pairs = Vec::new();
    for rim in wanted.rim {
        let off = |l: &Vec<u32>| middle(l).distance_squared(middle(rim));
        let nearest = (0..left.len()).min_by(|&a, &b| off(&left[a]).total_cmp(&off(&left[b])));
        let Some(k) = nearest else { return Ok(Err("its part has too few borders".into())) };
        pairs.push(vec![rim[0], left.swap_remove(k)[0]]);
    }
    let starts: HashSet<u32> = wanted.rim.iter().map(|l| l[0]).collect();
    let view = MeshView::new(&vertices[..], &faces[..]);
    let silent = Monitor::silent();
    let completer = Completer::new(view, &Grouping::Join(pairs), &silent)?;
    let list = completer.holes();
    let ours = list.holes.iter().filter(|h| {
        h.loops.iter().any(|&l| list.loops[l].vertices.iter().any(|v| starts.contains(v)))
    });
    let options = Options {
        method: Method::Smooth,
        fairing: Fairing::C1,
        selection: Selection::Ids(ours.map(|h| h.id).collect()),
        threads: 1,
        ..Options::default()
    };
    let made = match completer.complete(&options, &silent) {
        Ok(made) => made,
        Err(why) => return Ok(Err(format!("between its rim and its part: {why}"))),
    };
    let new = made.vertices.iter().map(|&p| DVec3::from(p)).collect();
    Ok(Ok((new, made.faces)))
}
