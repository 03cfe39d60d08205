//! A perspective camera on a point, with y up as far as the view allows.

use super::{cross, dot, length, sub};
use crate::mesh::MeshView;

/// The camera's distance from the point it looks at, in frame widths: a long lens, so that shapes
/// keep their proportions.
const DISTANCE: f64 = 3.0;
/// What is nearer to the camera than this part of the distance is cut away: other parts of the
/// object must not stand before a hole.
const NEAR: f64 = 0.6;

/// Where a picture is taken from.
#[derive(Debug, Clone, Copy)]
pub struct Camera {
    eye: [f64; 3],
    right: [f64; 3],
    up: [f64; 3],
    back: [f64; 3],
    /// Width of what is shown at the distance of the point looked at, in mesh units.
    width: f64,
    distance: f64,
    near: f64,
}

impl Camera {
    /// Looks at `centre` against the direction `outward`, `width` mesh units wide.
    pub fn towards(centre: [f64; 3], outward: [f64; 3], width: f64) -> Self {
        let size = length(outward);
        let back = if size > 0.0 { outward.map(|x| x / size) } else { [0.0, 0.0, 1.0] };
        // Looking along y there is no up: z takes its place.
        let pole = if back[1].abs() > 0.95 { [0.0, 0.0, 1.0] } else { [0.0, 1.0, 0.0] };
        let right = cross(pole, back);
        let right = right.map(|x| x / length(right));
        let width = if width > 0.0 { width } else { 1.0 };
        let distance = DISTANCE * width;
        Self {
            eye: std::array::from_fn(|k| centre[k] + distance * back[k]),
            right,
            up: cross(back, right),
            back,
            width,
            distance,
            near: NEAR * distance,
        }
    }

    /// Shows the whole mesh: from `front`, turned a little sideways and up, so that depth shows.
    pub fn on_whole(mesh: MeshView<'_>, front: Option<[f64; 3]>) -> Self {
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for f in 0..mesh.faces.len() {
            for v in mesh.faces.get(f) {
                let p = mesh.vertices.get(v as usize);
                for k in 0..3 {
                    low[k] = low[k].min(p[k]);
                    high[k] = high[k].max(p[k]);
                }
            }
        }
        if low[0] > high[0] {
            return Self::towards([0.0; 3], [0.0, 0.0, 1.0], 1.0);
        }
        let centre: [f64; 3] = std::array::from_fn(|k| (low[k] + high[k]) / 2.0);
        let mut front = front.unwrap_or([0.0, 0.0, 1.0]);
        let flat = front[0].hypot(front[2]);
        if flat < 1e-6 {
            front = [0.0, front[1].clamp(-0.5, 0.5), 1.0];
        } else {
            // An object stands: it is not looked at from straight above or below.
            front[1] = front[1].clamp(-0.5 * flat, 0.5 * flat);
        }
        let flat = Self::towards(centre, front, 1.0);
        let (side, above) = (0.35, 0.18);
        let turned =
            std::array::from_fn(|k| flat.back[k] + side * flat.right[k] + above * flat.up[k]);
        let camera = Self::towards(centre, turned, 1.0);
        // The box's corners seen from there give the width; a view is wider than high.
        let mut width: f64 = 0.0;
        for corner in 0..8 {
            let p: [f64; 3] =
                std::array::from_fn(|k| if corner >> k & 1 == 0 { low[k] } else { high[k] });
            let d = sub(p, centre);
            width = width.max(2.0 * dot(d, camera.right).abs());
            width = width.max(2.0 * ASPECT * dot(d, camera.up).abs());
        }
        Self { near: 0.0, ..Self::towards(centre, turned, 1.12 * width) }
    }

    /// Pixel coordinates (from the top left) and depth of a point in a view of this size; `None`
    /// before the near plane. The depth is the distance along the view.
    pub(super) fn project(&self, p: [f64; 3], size: [usize; 2]) -> Option<[f64; 3]> {
        let d = sub(p, self.eye);
        let depth = -dot(d, self.back);
        // 1e-3: a point on the eye has no place in the picture.
        if depth <= self.near.max(1e-3 * self.distance) {
            return None;
        }
        let scale = size[0] as f64 / self.width * self.distance / depth;
        Some([
            size[0] as f64 / 2.0 + scale * dot(d, self.right),
            size[1] as f64 / 2.0 - scale * dot(d, self.up),
            depth,
        ])
    }

    /// A direction in the camera's frame (right, up, back).
    pub(super) fn turn(&self, d: [f64; 3]) -> [f64; 3] {
        [dot(d, self.right), dot(d, self.up), dot(d, self.back)]
    }

    /// The direction from a projected point to the eye, in the camera's frame.
    pub(super) fn sight(&self, x: f64, y: f64, size: [usize; 2]) -> [f64; 3] {
        let unit = self.width / size[0] as f64 / self.distance;
        let d = [-(x - size[0] as f64 / 2.0) * unit, (y - size[1] as f64 / 2.0) * unit, 1.0];
        let size = length(d);
        d.map(|x| x / size)
    }
}

/// Width over height of a view, see [`super::VIEW`].
const ASPECT: f64 = super::VIEW[0] as f64 / super::VIEW[1] as f64;
