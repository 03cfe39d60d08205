//! What the steps of a coherent completion cost, about, in seconds of some machine: for the progress alone.
//! `examples/coherent_cost.rs` says how true it is.

use crate::fill::patch::{next, Patch, NONE};
use crate::synthesis::domain::depth;

/// What a hole costs. Fitted to seven holes of 158 to 6,434 new vertices.
pub struct Cost {
    search: f64,
    /// Two looks.
    looks: f64,
}

/// Part of the two looks that the first takes: the second has more copies to look at.
const FIRST_LOOK: f64 = 0.35;

impl Cost {
    /// Of a hole with so many new vertices; `area`: the object's, in squares of the hole's radius.
    pub fn of(vertices: usize, area: f64) -> Self {
        let n = vertices as f64;
        let maps = (10.0 * n).clamp(400.0, 4000.0).min(11.0 * area);
        Self { search: 0.03 + 3e-5 * maps + 1e-4 * n, looks: 0.01 + 6.5e-4 * n }
    }

    /// Bringing a fill to so many vertices, see [`resize`](super::resized::resize).
    pub fn of_resizing(vertices: f64) -> f64 {
        4e-5 * vertices
    }

    /// Making the library of a mesh, with its symmetries.
    pub fn of_library(vertices: usize) -> f64 {
        0.01 + 1.5e-6 * vertices as f64
    }

    /// All of it.
    pub fn all(&self) -> f64 {
        self.search + self.looks
    }

    /// Where the search ends in all of it, and where the first look does.
    pub fn parts(&self) -> [f64; 2] {
        let search = self.search / self.all();
        [search, search + FIRST_LOOK * (1.0 - search)]
    }
}

/// A rim that is as ragged as scans' is so many times as long as what it runs around: 2 without.
const AROUND: f64 = 2.8;
/// What is longer than so many half-widths is surely long, see
/// [`Domain::is_slender`](crate::synthesis::domain::Domain::is_slender).
const LONG: f64 = 6.0;
/// How far apart windows lie, in half-widths, about.
const APART: f64 = 3.0;

/// All that a hole costs with such a smooth fill, as far as can be told before anything is known of the object.
pub fn cost_of(fill: &Patch) -> f64 {
    let (half, mut rim) = (depth(fill), 0.0);
    for (tri, across) in fill.triangles.iter().zip(&fill.across) {
        for k in (0..3).filter(|&k| across[k] == NONE) {
            rim += fill.p(tri[k]).distance(fill.p(tri[next(k)]));
        }
    }
    let (count, length) = (fill.new_count(), rim / AROUND);
    if half == 0.0 || length < LONG * half {
        return Cost::of(count, f64::INFINITY).all();
    }
    let windows = (length / (APART * half)).ceil();
    // Each vertex is seen through three.
    let own = (3 * count) as f64 / windows;
    LongCost::of(count, windows as usize, own as usize, f64::INFINITY).all()
}

/// What a long hole costs, which is looked at through windows. Fitted to eight cracks and bands of 139 to 6,672 new
/// vertices.
pub struct LongCost {
    /// The bare plate over all of it, for one look.
    plate: f64,
    /// Making the height maps.
    maps: f64,
    /// Comparing with them, and alignment.
    search: f64,
    /// One look.
    look: f64,
}

impl LongCost {
    /// Of so many new vertices, windows, and new vertices in each; `area`: the object's, in squares of a window's
    /// radius.
    pub fn of(vertices: usize, windows: usize, own: usize, area: f64) -> Self {
        let (windows, own) = (windows as f64, own as f64);
        Self {
            plate: 6.5e-5 * vertices as f64,
            maps: 0.03 + 3e-5 * f64::min(4000.0, 11.0 * area),
            search: windows * (0.01 + 2e-5 * own),
            look: windows * (0.006 + 6e-5 * own),
        }
    }

    fn steps(&self) -> [f64; 5] {
        [self.plate, self.maps + self.search, self.look, self.plate, self.look]
    }

    /// All of it.
    pub fn all(&self) -> f64 {
        self.steps().iter().sum()
    }

    /// The part of the search that making the maps is.
    pub fn maps_part(&self) -> f64 {
        self.maps / (self.maps + self.search)
    }

    /// Where the first plate ends in all of it, the search, the first look and the second plate.
    pub fn parts(&self) -> [f64; 4] {
        let (steps, mut end) = (self.steps(), 0.0);
        [0, 1, 2, 3].map(|i| {
            end += steps[i] / self.all();
            end
        })
    }
}
