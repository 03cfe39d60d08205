//! From where a hole is seen best.

use super::raster::Prepared;
use super::{cross, length, sub, Camera};
use crate::holes::{Hole, HoleList};
use crate::matching::rigid::Rigid;
use crate::mesh::MeshView;
use glam::DVec3;

/// Close-ups are this many hole diameters wide: the hole and as much around it.
const FRAME: f64 = 2.2;
/// At most so many vertices of the rim say how much of it is seen.
const PROBES: usize = 96;
/// Tangent of the angle by which the camera looks aside when something stands before the hole: 50°.
const ASIDE: f64 = 1.19;

/// A camera that looks into a hole: against its outward direction or, where that shows clearly
/// less of the rim than a look from aside, from there.
pub(super) fn close_up(scene: &Prepared<'_>, holes: &HoleList, hole: &Hole) -> Camera {
    let front = outward(scene.mesh(), holes, hole);
    frame(scene, &rim(scene.mesh(), holes, hole), front, hole.diameter)
}

/// The same of a place that a hole's fill comes from, as `transform` takes it to the hole.
pub(super) fn source_close_up(
    scene: &Prepared<'_>,
    holes: &HoleList,
    hole: &Hole,
    transform: &Rigid,
) -> Camera {
    let back = transform.inverse();
    let there: Vec<[f64; 3]> = rim(scene.mesh(), holes, hole)
        .into_iter()
        .map(|p| back.point(DVec3::from(p)).to_array())
        .collect();
    let front = source_front(scene.mesh(), holes, hole, transform);
    frame(scene, &there, front, hole.diameter)
}

/// The direction out of such a place.
pub(super) fn source_front(
    mesh: MeshView<'_>,
    holes: &HoleList,
    hole: &Hole,
    transform: &Rigid,
) -> [f64; 3] {
    let front = DVec3::from(outward(mesh, holes, hole));
    transform.inverse().direction(front).to_array()
}

fn rim(mesh: MeshView<'_>, holes: &HoleList, hole: &Hole) -> Vec<[f64; 3]> {
    let loops = hole.loops.iter().map(|&l| &holes.loops[l].vertices);
    loops.flatten().map(|&v| mesh.vertices.get(v as usize)).collect()
}

/// A camera on what these points enclose, from `front` or from aside.
fn frame(scene: &Prepared<'_>, rim: &[[f64; 3]], front: [f64; 3], diameter: f64) -> Camera {
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for p in rim {
        for k in 0..3 {
            low[k] = low[k].min(p[k]);
            high[k] = high[k].max(p[k]);
        }
    }
    let centre = std::array::from_fn(|k| (low[k] + high[k]) / 2.0);
    let extent = (0..3).map(|k| (high[k] - low[k]).powi(2)).sum::<f64>().sqrt();
    let camera = |direction| {
        // The box's diagonal is longer than a thin ring is wide.
        Camera::towards(centre, direction, FRAME * diameter.max(0.7 * extent))
    };
    let probes: Vec<[f64; 3]> =
        rim.iter().step_by(rim.len().div_ceil(PROBES).max(1)).copied().collect();
    let straight = camera(front);
    let seen = scene.count_visible(&straight, &probes);
    let aside = look_aside(front).map(camera);
    let best = aside.iter().map(|c| (scene.count_visible(c, &probes), c)).reduce(|a, b| {
        if b.0 > a.0 {
            b
        } else {
            a
        }
    });
    match best {
        // A third more of the rim: less is not worth the oblique look.
        Some((more, camera)) if 3 * more > 4 * seen => *camera,
        _ => straight,
    }
}

/// Four directions around `front`.
fn look_aside(front: [f64; 3]) -> [[f64; 3]; 4] {
    let pole = if front[1].abs() > 0.9 { [0.0, 0.0, 1.0] } else { [0.0, 1.0, 0.0] };
    let right = cross(pole, front);
    let right = right.map(|x| x / length(right).max(f64::MIN_POSITIVE));
    let up = cross(front, right);
    [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)]
        .map(|(r, u)| std::array::from_fn(|k| front[k] + ASIDE * (r * right[k] + u * up[k])))
}

/// The direction out of a hole: the area vector of its loops; for the two loops of a ring, whose
/// area vectors cancel, across the axis.
pub(super) fn outward(mesh: MeshView<'_>, holes: &HoleList, hole: &Hole) -> [f64; 3] {
    let mut area = [0.0; 3];
    let mut around = 0.0;
    for &l in &hole.loops {
        let rim = &holes.loops[l].vertices;
        for i in 0..rim.len() {
            let p = sub(mesh.vertices.get(rim[i] as usize), hole.centre);
            let q = sub(mesh.vertices.get(rim[(i + 1) % rim.len()] as usize), hole.centre);
            let c = cross(p, q);
            for k in 0..3 {
                area[k] += c[k] / 2.0;
            }
        }
        around += holes.loops[l].length;
    }
    // A flat round rim has the area (length)²/4π. Two loops that face each other and differ by a
    // third leave a tenth of that; a crack folded over an edge has less, too, and is as well seen
    // from across.
    let cancels = hole.loops.len() > 1 && length(area) < 0.1 * around * around / 12.57;
    if !cancels && length(area) > 0.0 {
        return area.map(|x| x / length(area));
    }
    let centres: Vec<_> = hole.loops.iter().map(|&l| holes.loops[l].centre).collect();
    let axis = if centres.len() > 1 { sub(centres[1], centres[0]) } else { [0.0, 1.0, 0.0] };
    // Somewhere in front: along none of the axes, so that no upright or lying ring is parallel.
    let side = cross(cross(axis, [0.3, 0.2, 1.0]), axis);
    let size = length(side);
    if size > 0.0 {
        side.map(|x| x / size)
    } else {
        [0.0, 0.0, 1.0]
    }
}
