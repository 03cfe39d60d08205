//! Where a hole is looked at: as a whole, or through windows along it when it is long and narrow or
//! bends around the object (cracks, missing bands).

use super::domain::Domain;
use super::fit::Plate;
use crate::error::Result;
use glam::DVec3;

/// Windows overlap so that every fill vertex lies within this part of a window's radius.
const REACH: f64 = 0.7;
/// Length of the mean of the directions below which a fill bends too far to be seen from one side.
const BENT: f64 = 0.6;
/// Radius of the windows of a bent fill, in radii of its domain.
const BENT_PART: f64 = 0.8;

/// A part of a hole, or all of it.
pub struct Window {
    /// What is seen through it.
    pub domain: Domain,
    /// Vertex of the whole domain that each of its vertices is.
    pub parent: Vec<usize>,
    /// Where the window is in the fill: weight of each fill vertex of the whole, 0 to 1.
    pub weight: Vec<f64>,
    /// What the bare plate over the whole hole says, if the window is [judged](judge_by_whole) by it.
    pub plate: Option<Plate>,
    first: usize,
}

impl Window {
    /// First fill vertex of the whole domain.
    pub fn whole_start(&self) -> usize {
        self.first
    }

    /// Whether there are others.
    pub fn is_part(&self) -> bool {
        self.weight.iter().any(|&w| w < 1.0)
    }
}

/// The whole hole as one window; `None` if it bends too far to be seen from one side.
pub fn one_window(domain: &Domain) -> Option<Window> {
    if is_bent(domain) || domain.fill.is_empty() {
        return None;
    }
    let (part, parent) = domain.window(domain.fill.start, f64::INFINITY);
    let Domain { radius, extent, centre, .. } = *domain;
    let part = Domain { radius, extent, centre, ..part }.with_ring();
    let weight = vec![1.0; domain.fill.len()];
    Some(Window { domain: part, parent, weight, plate: None, first: domain.fill.start })
}

fn is_bent(domain: &Domain) -> bool {
    let mean: DVec3 = domain.fill.clone().map(|v| domain.directions[v]).sum();
    mean.length() < BENT * domain.fill.len() as f64
}

/// As many windows as cover the fill, all of the domain's radius.
pub fn plan_windows(domain: &Domain, check: &dyn Fn() -> Result<()>) -> Result<Vec<Window>> {
    let fill = domain.fill.len();
    // A bent fill is seen in parts.
    let part = if is_bent(domain) { BENT_PART } else { 1.0 };
    let radius = part * domain.radius;
    let positions = &domain.sheet.positions;
    let mut nearest = vec![f64::INFINITY; fill];
    let mut windows = Vec::new();
    let mut at = domain.fill.start;
    loop {
        check()?;
        for (i, v) in domain.fill.clone().enumerate() {
            nearest[i] = nearest[i].min(positions[v].distance(positions[at]));
        }
        windows.push(make_window(domain, at, radius));
        let farthest = (0..fill).max_by(|&a, &b| nearest[a].total_cmp(&nearest[b]));
        match farthest.filter(|&i| nearest[i] > REACH * radius) {
            Some(i) => at = domain.fill.start + i,
            None => return Ok(windows),
        }
    }
}

/// Has the windows of a domain judged by the bare plate over all of it; their own are cut off where they end.
pub fn judge_by_whole(
    windows: &mut [Window],
    domain: &Domain,
    threads: usize,
    check: &dyn Fn() -> Result<()>,
) -> Result<()> {
    let Some(radius) = windows.first().map(|window| window.domain.radius) else { return Ok(()) };
    let plate = Plate::of(domain, radius, threads, check)?;
    for window in windows {
        window.plate = plate.as_ref().map(|plate| plate.seen(&window.parent));
    }
    Ok(())
}

fn make_window(domain: &Domain, at: usize, radius: f64) -> Window {
    let (part, parent) = domain.window(at, radius);
    let mut weight = vec![0.0; domain.fill.len()];
    for v in part.fill.clone() {
        let off = part.sheet.positions[v].distance(part.centre) / radius;
        // Falls smoothly to (almost) nothing, so that no seam shows where a window ends.
        weight[parent[v] - domain.fill.start] = (1.0 - off * off).max(1e-6).powi(2);
    }
    Window { domain: part, parent, weight, plate: None, first: domain.fill.start }
}
