//! A headless, shaded picture of a mesh and its holes: before and after side by side, the whole
//! object first, then a close-up on each of the largest holes.
//!
//! No graphics card and no library: a z-buffer over 2 x 2 samples a pixel, smooth vertex normals,
//! a key and a fill light. The inside of the surface has another tint, so that holes show.

mod aim;
mod camera;
mod font;
mod image;
mod raster;

pub use camera::Camera;
pub use image::Image;
pub use raster::Shape;

use crate::holes::{Hole, HoleList};

/// Size of one view in pixels.
const VIEW: [usize; 2] = [560, 460];
/// Pixels between views and around them.
const GAP: usize = 10;
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
    let (raw, filled) = (raster::Prepared::new(before), raster::Prepared::new(after));
    let front = chosen.first().map(|h| aim::outward(before.mesh, holes, h));
    let mut rows = vec![(Camera::on_whole(before.mesh, front), String::new())];
    for hole in &chosen {
        let label = format!("hole {}: {} edges", hole.id, hole.edges);
        rows.push((aim::close_up(&raw, holes, hole), label));
    }
    let mut sheet =
        Image::new(2 * VIEW[0] + 3 * GAP, rows.len() * (VIEW[1] + GAP) + GAP, [255, 255, 255]);
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
