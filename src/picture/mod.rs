//! A headless, shaded picture of a mesh and its holes: before and after side by side, the whole
//! object first, then a close-up on each of the largest holes.
//!
//! No graphics card and no library: a z-buffer over 2 x 2 samples a pixel, smooth vertex normals,
//! a key and a fill light. The inside of the surface has another tint, so that holes show.

mod aim;
mod camera;
mod decode;
mod font;
mod image;
mod raster;
mod skin;
mod sources;

pub use camera::Camera;
pub use image::Image;
pub use raster::Shape;
pub use skin::{Paint, Skin, Texture};

use crate::holes::{Hole, HoleList};
use crate::matching::rigid::Rigid;
use crate::result::Completion;

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
    draw_rows(before, after, holes, &largest(holes, shown), |_| None)
}

/// The same with where the fill comes from. Each source of a fill has a colour, in which the faces
/// that take their detail from it and its place on the object are drawn; what has no source is
/// grey. Under the close-up of a hole one row more looks at its most used source: straight at it on
/// the left, at the whole object from that side on the right. Below the rows a legend says in words
/// what the colours mean. `completion` is of the mesh of `before`, and `after` is the whole.
pub fn with_sources(
    before: &Shape<'_>,
    after: &Shape<'_>,
    holes: &HoleList,
    shown: &[usize],
    completion: &Completion,
) -> Image {
    let chosen = largest(holes, shown);
    let ids: Vec<usize> = chosen.iter().map(|h| h.id).collect();
    let colours = sources::Colours::new(after.mesh, completion, &ids);
    let tints = Some(&colours.tints[..]);
    let main_source = |hole: &Hole| {
        let report = completion.holes.get(hole.id)?;
        Some(report.sources[*sources::by_use(completion, report).first()?].transform)
    };
    let (before, after) = (Shape { tints, ..*before }, Shape { tints, ..*after });
    let sheet = draw_rows(&before, &after, holes, &chosen, main_source);
    let legend = colours.legend(completion, &ids, sheet.width - 2 * GAP);
    let mut whole = Image::new(sheet.width, sheet.height + legend.height + GAP, [255; 3]);
    whole.paste(&sheet, 0, 0);
    whole.paste(&legend, GAP, sheet.height);
    whole
}

/// The largest of the holes with these ids, the largest first.
fn largest<'a>(holes: &'a HoleList, shown: &[usize]) -> Vec<&'a Hole> {
    let mut chosen: Vec<&Hole> = holes.holes.iter().filter(|h| shown.contains(&h.id)).collect();
    chosen.sort_by(|a, b| b.diameter.total_cmp(&a.diameter).then(a.id.cmp(&b.id)));
    chosen.truncate(MAX_CLOSE_UPS);
    chosen
}

/// The whole, the holes, and the places that `source` names for them: transforms to the hole.
fn draw_rows(
    before: &Shape<'_>,
    after: &Shape<'_>,
    holes: &HoleList,
    chosen: &[&Hole],
    source: impl Fn(&Hole) -> Option<Rigid>,
) -> Image {
    let (raw, filled) = (raster::Prepared::new(before), raster::Prepared::new(after));
    let front = chosen.first().map(|h| aim::outward(before.mesh, holes, h));
    // Each row: two views of (scene, camera, label).
    let both = |camera, label: &str| {
        let text = |word: &str| [word, label].join(if label.is_empty() { "" } else { ", " });
        [(&raw, camera, text("before")), (&filled, camera, text("after"))]
    };
    let mut rows = vec![both(Camera::on_whole(after.mesh, front), "")];
    for hole in chosen {
        let label = format!("hole {}: {} edges", hole.id, hole.edges);
        rows.push(both(aim::close_up(&raw, holes, hole), &label));
        if let Some(transform) = source(hole) {
            let front = aim::source_front(before.mesh, holes, hole, &transform);
            let near = aim::source_close_up(&raw, holes, hole, &transform);
            let whole = Camera::on_whole(after.mesh, Some(front));
            rows.push([
                (&filled, near, format!("main source of hole {}", hole.id)),
                (&filled, whole, "the whole from its side".into()),
            ]);
        }
    }
    let mut sheet =
        Image::new(2 * VIEW[0] + 3 * GAP, rows.len() * (VIEW[1] + GAP) + GAP, [255, 255, 255]);
    for (row, views) in rows.iter().enumerate() {
        let y = GAP + row * (VIEW[1] + GAP);
        for (column, (scene, camera, label)) in views.iter().enumerate() {
            let mut view = scene.draw(camera, VIEW);
            font::write(&mut view, 12, 12, label);
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
