//! The points of a cloud's fill where copied ones do not go on: as many as around, spread evenly over the surface
//! that the copies make together; each has its source there.

use crate::error::Result;
use crate::fill::even::{share, spread};
use crate::fill::patch::Patch;
use crate::fill::refine::Taken;
use crate::matching::source::Source;
use crate::progress::Pace;
use glam::DVec3;

/// Radii of a hole around its middle within which the points say how dense they are.
const AROUND: f64 = 1.5;
/// With fewer triangles there the whole object says it.
const FEWEST: usize = 200;

/// A patch with its vertices spread evenly, as densely as the points around it, and the copy of each.
/// `copies`: of the patch's vertices.
pub fn spread_points(
    patch: &Patch,
    copies: &[Option<u32>],
    source: &Source,
    taken: Taken<'_>,
    check: &dyn Fn() -> Result<()>,
) -> Result<(Patch, Vec<Option<u32>>)> {
    let mut made = patch.clone();
    let on = spread(&mut made, share_around(patch, source), taken, &mut Pace::new(check))?;
    let copy = |(v, &t): (usize, &u32)| {
        let corners = *patch.triangles.get(t as usize)?;
        let far = |c: &u32| patch.p(*c).distance_squared(made.positions[v]);
        let copied = corners.iter().filter(|&&c| copies[c as usize].is_some());
        copies[*copied.min_by(|a, b| far(a).total_cmp(&far(b)))? as usize]
    };
    let copies = on.iter().enumerate().map(copy).collect();
    Ok((made, copies))
}

/// What [`spread`] is to be told so that the fill has as many triangles for its area as there are around it.
fn share_around(patch: &Patch, source: &Source) -> f64 {
    let rim = &patch.positions[..patch.rim_count];
    let middle = rim.iter().copied().sum::<DVec3>() / rim.len().max(1) as f64;
    let radius = rim.iter().map(|p| p.distance(middle)).fold(0.0, f64::max);
    let at = |v: u32| source.positions[v as usize];
    let known = &source.faces[..source.known_faces.min(source.faces.len())];
    let near = |f: &&[u32; 3]| at(f[0]).distance_squared(middle) < (AROUND * radius).powi(2);
    let corners = |f: &[u32; 3]| f.map(at);
    let sizes = &patch.sizes[..patch.rim_count];
    if known.iter().filter(near).nth(FEWEST).is_some() {
        share(known.iter().filter(near).map(corners), sizes)
    } else {
        share(known.iter().map(corners), sizes)
    }
}
