//! Harary, Tal and Grinspun (2014), "Context-based coherent surface completion", Eq. 1 and 3: how far
//! a fill is from being made of pieces of the object, each patch compared with the best of them.
//!
//! Differences from the paper:
//! - The pieces are the copies found for the hole, not all patches of the object, and lie where they
//!   were aligned; what a small rigid motion of a patch would change (offset and tilt of its heights)
//!   is taken out.
//! - As in [`super::coherence_error`] the root of the mean over the vertices, so that it is a length.

use super::domain::Domain;
use super::view::View;
use crate::error::Result;
use glam::{DMat3, DVec3};

/// Radius of a patch, in hole radii: a few vertices of a small hole, one feature of a large one.
const PATCH: f64 = 0.25;
/// And at least this many mean edges: a patch of a dozen vertices is more than a plane.
const PATCH_EDGES: f64 = 2.5;
/// Patches of a window at most, evenly spread: more change the third digit.
const MOST_PATCHES: usize = 200;

/// A vertex that no patch takes in, and one that none has so far.
const NEVER: usize = usize::MAX;
const NOT_YET: usize = usize::MAX - 1;

/// Root mean square difference of the fill from the nearest copy, patch by patch, in mesh units, over
/// all windows. `heights`: of the fill vertices of the whole; infinite without any patch.
pub fn coherence_error(
    views: &[View<'_>],
    heights: &dyn Fn(usize) -> f64,
    check: &dyn Fn() -> Result<()>,
) -> Result<f64> {
    let (mut square, mut count) = (0.0, 0);
    for view in views {
        let domain = &view.window.domain;
        let whole_start = view.window.whole_start();
        let height = |v: usize| match domain.is_known(v) {
            true => 0.0,
            false => heights(view.window.parent[v] - whole_start),
        };
        let mut reached = vec![NEVER; domain.sheet.positions.len()];
        domain.fill.clone().chain(domain.ring.iter().copied()).for_each(|v| reached[v] = NOT_YET);
        let step = domain.fill.len().div_ceil(MOST_PATCHES).max(1);
        for centre in domain.fill.clone().step_by(step) {
            check()?;
            let patch = gather(domain, centre, &mut reached);
            let frame = Frame::new(domain, centre, &patch);
            let differences = view
                .copies
                .iter()
                .map(|copy| frame.rest(patch.iter().map(|&v| copy.heights[v] - height(v))));
            let least = differences.fold(f64::INFINITY, f64::min);
            if least.is_finite() {
                square += least;
                count += patch.len();
            }
        }
    }
    Ok(match count {
        0 => f64::INFINITY,
        _ => (square / count as f64).sqrt(),
    })
}

/// The compared vertices around a centre that hang together with it.
/// `reached`: by which patch each vertex was last.
fn gather(domain: &Domain, centre: usize, reached: &mut [usize]) -> Vec<usize> {
    let radius = (PATCH * domain.radius).max(PATCH_EDGES * domain.edge);
    let at = domain.sheet.positions[centre];
    let mut patch = vec![centre];
    reached[centre] = centre;
    let mut next = 0;
    while let Some(&v) = patch.get(next) {
        next += 1;
        for (w, _) in domain.laplacian.row(v) {
            let near = domain.sheet.positions[w].distance(at) <= radius;
            if near && reached[w] != NEVER && reached[w] != centre {
                reached[w] = centre;
                patch.push(w);
            }
        }
    }
    patch
}

/// Where the vertices of a patch lie in its tangent plane.
struct Frame {
    /// (1, x, y) of each vertex.
    places: Vec<DVec3>,
    /// The inverse of the sum of their outer products.
    inverse: DMat3,
}

impl Frame {
    fn new(domain: &Domain, centre: usize, patch: &[usize]) -> Self {
        let (x, y) = domain.directions[centre].any_orthonormal_pair();
        let at = domain.sheet.positions[centre];
        let place = |&v: &usize| {
            let off = domain.sheet.positions[v] - at;
            DVec3::new(1.0, off.dot(x), off.dot(y))
        };
        let places: Vec<DVec3> = patch.iter().map(place).collect();
        let mut sum = DMat3::ZERO;
        places.iter().for_each(|p| sum += DMat3::from_cols(*p * p.x, *p * p.y, *p * p.z));
        Self { places, inverse: sum.inverse() }
    }

    /// Sum of the squares of what a plane leaves of some values; infinite if there is no one plane.
    fn rest(&self, values: impl Iterator<Item = f64> + Clone) -> f64 {
        let rhs: DVec3 = self.places.iter().zip(values.clone()).map(|(p, d)| *p * d).sum();
        let plane = self.inverse * rhs;
        if !plane.is_finite() {
            return f64::INFINITY;
        }
        self.places.iter().zip(values).map(|(p, d)| (d - plane.dot(*p)).powi(2)).sum()
    }
}
