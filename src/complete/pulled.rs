//! Points that fills shall pass through ([`crate::Guidance::points`]): which hole each belongs to, and
//! the fill drawn to them.

use super::check::Obstacles;
use super::smooth::{Fill, Surroundings};
use crate::error::{Error, Result};
use crate::fill::patch::Patch;
use crate::fill::refine::refine;
use crate::guidance::Guidance;
use crate::holes::Hole;
use crate::options::{Method, Sizing};
use crate::progress::Pace;
use crate::synthesis::constraints::pull;
use crate::synthesis::domain::{Domain, Extent};
use glam::DVec3;

/// Rounds of refinement where the fill was drawn out.
const AGAIN: usize = 2;

/// The points of each of some holes: each goes to the hole whose middle is nearest, in diameters.
pub fn share_points(guidance: &Guidance, holes: &[&Hole]) -> Result<Vec<Vec<DVec3>>> {
    let mut shares = vec![Vec::new(); holes.len()];
    for (i, point) in guidance.points.iter().map(|&p| DVec3::from(p)).enumerate() {
        let bad = |reason: String| Err(Error::InvalidOption { name: "points", reason });
        let off = |h: &Hole| point.distance(h.centre.into()) / h.diameter;
        let nearest = (0..holes.len()).min_by(|&a, &b| off(holes[a]).total_cmp(&off(holes[b])));
        let Some(k) = nearest else { return bad(format!("there is no hole for point {i}")) };
        if off(holes[k]) > 1.0 {
            let (id, [x, y, z]) = (holes[k].id, point.to_array());
            let (far, most) = (off(holes[k]) * holes[k].diameter, holes[k].diameter);
            return bad(format!(
                "point {i} ({x}, {y}, {z}) is {far:.4} from the middle of hole {id}, the nearest: more \
                 than the hole's diameter, {most:.4}; take it out"
            ));
        }
        shares[k].push(point);
    }
    Ok(shares)
}

/// Draws a fill to its points and checks it. The inner error says why that cannot be.
pub fn pull_fill(
    around: &Surroundings<'_>,
    obstacles: &Obstacles<'_>,
    fill: &mut Fill,
    (points, softness): (&[DVec3], f64),
    check: &dyn Fn(f64) -> Result<()>,
) -> Result<std::result::Result<(), String>> {
    if points.is_empty() || fill.patch.positions.len() == fill.patch.rim_count {
        return Ok(Ok(()));
    }
    let drawn = |patch: &Patch| -> Option<Vec<DVec3>> {
        let (rim, edge) = (&fill.outline.vertices, fill.outline.mean_size());
        let incidence = around.incidence.get();
        let domain = Domain::new(patch, around.near, &incidence, rim, edge, Extent::Whole)?;
        pull(patch, &domain, points, softness)
    };
    let none = || "the points given inside it are too many for its vertices".to_owned();
    let Some(positions) = drawn(&fill.patch) else { return Ok(Err(none())) };
    let mut patch = Patch { positions, ..fill.patch.clone() };
    let stop = || check(0.5);
    // A smooth fill has no story of its vertices yet.
    let finer = fill.method == Method::Smooth && around.sizing == Sizing::Surroundings;
    if finer && refine(&mut patch, &fill.outline.taken, AGAIN, &mut Pace::new(&stop))? {
        let Some(positions) = drawn(&patch) else { return Ok(Err(none())) };
        patch.positions = positions;
    }
    match obstacles.settle(around, patch, &|| check(0.9))? {
        Ok(patch) => fill.patch = patch,
        Err(why) => return Ok(Err(format!("drawn to the points given inside it, {why}"))),
    }
    Ok(Ok(()))
}
