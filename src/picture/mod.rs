//! A headless, shaded picture of a mesh and its holes: before and after side by side, the whole
//! object first, then a close-up on each of the largest holes.
//!
//! No graphics card and no library: a z-buffer over 2 x 2 samples a pixel, smooth vertex normals,
//! a key and a fill light. The inside of the surface has another tint, so that holes show.

mod camera;
mod font;
mod image;
mod raster;

pub use camera::Camera;
pub use image::Image;
pub use raster::Shape;

use crate::holes::{Hole, HoleList};
use crate::mesh::MeshView;

/// Size of one view in pixels.
const VIEW: [usize; 2] = [560, 460];
/// Pixels between views and around them.
const GAP: usize = 10;
/// Close-ups are this many hole diameters wide: the hole and as much around it.
const FRAME: f64 = 2.2;
/// Rows of close-ups: the largest holes.
const MAX_CLOSE_UPS: usize = 6;

/// Draws before and after: a row with the whole object, then one close-up row for each of the
/// largest holes among `shown` (ids), at most six. `holes` are those of `before`.
pub fn before_and_after(
    before: &Shape<'_>,
    after: &Shape<'_>,
    holes: &HoleList,
    shown: &[usize],
) -> Image {
    let mut chosen: Vec<&Hole> = holes.holes.iter().filter(|h| shown.contains(&h.id)).collect();
    chosen.sort_by(|a, b| b.diameter.total_cmp(&a.diameter).then(a.id.cmp(&b.id)));
    chosen.truncate(MAX_CLOSE_UPS);
    let front = chosen.first().map(|h| outward(before.mesh, holes, h));
    let mut rows = vec![(Camera::on_whole(before.mesh, front), String::new())];
    for hole in &chosen {
        let label = format!("hole {}: {} edges", hole.id, hole.edges);
        rows.push((close_up(before.mesh, holes, hole), label));
    }
    let mut sheet =
        Image::new(2 * VIEW[0] + 3 * GAP, rows.len() * (VIEW[1] + GAP) + GAP, [255, 255, 255]);
    let (raw, filled) = (raster::Prepared::new(before), raster::Prepared::new(after));
    for (row, (camera, label)) in rows.iter().enumerate() {
        let y = GAP + row * (VIEW[1] + GAP);
        for (column, (scene, word)) in [(&raw, "before"), (&filled, "after")].iter().enumerate() {
            let mut view = scene.draw(camera, VIEW);
            let text = if label.is_empty() { word.to_string() } else { format!("{word}, {label}") };
            font::write(&mut view, 12, 12, &text);
            sheet.paste(&view, GAP + column * (VIEW[0] + GAP), y);
        }
    }
    sheet
}

/// Draws one view of a shape from the front, a little from above and from the left.
pub fn portrait(shape: &Shape<'_>, size: [usize; 2]) -> Image {
    raster::Prepared::new(shape).draw(&Camera::on_whole(shape.mesh, None), size)
}

/// A camera that looks into a hole.
fn close_up(mesh: MeshView<'_>, holes: &HoleList, hole: &Hole) -> Camera {
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for &l in &hole.loops {
        for &v in &holes.loops[l].vertices {
            let p = mesh.vertices.get(v as usize);
            for k in 0..3 {
                low[k] = low[k].min(p[k]);
                high[k] = high[k].max(p[k]);
            }
        }
    }
    let centre = std::array::from_fn(|k| (low[k] + high[k]) / 2.0);
    let extent = (0..3).map(|k| (high[k] - low[k]).powi(2)).sum::<f64>().sqrt();
    Camera::towards(centre, outward(mesh, holes, hole), FRAME * hole.diameter.max(0.7 * extent))
}

/// The direction from which a hole is best seen: the area vector of its longest loop, out of the
/// object; for the two loops of a ring, whose area vectors cancel, across the axis.
fn outward(mesh: MeshView<'_>, holes: &HoleList, hole: &Hole) -> [f64; 3] {
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
    // A flat round rim has the area (length)²/4π; a hundredth of it says the loops cancel.
    if length(area) > 0.01 * around * around / (4.0 * std::f64::consts::PI) {
        return area.map(|x| x / length(area));
    }
    let axis = hole.loops.iter().map(|&l| holes.loops[l].centre).collect::<Vec<_>>();
    let along = if axis.len() > 1 { sub(axis[1], axis[0]) } else { [0.0, 1.0, 0.0] };
    let across = cross(along, [0.3, 0.2, 1.0]);
    let side = cross(across, along);
    let size = length(side);
    if size > 0.0 {
        side.map(|x| x / size)
    } else {
        [0.0, 0.0, 1.0]
    }
}

pub(crate) fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| a[k] - b[k])
}

pub(crate) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn length(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

#[cfg(test)]
mod tests;
