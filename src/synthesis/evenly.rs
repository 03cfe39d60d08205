//! The points of a cloud's fill where copied ones do not go on: as many as it asks for, spread evenly
//! over the surface that the copies make together; each has its source there.

use crate::error::Result;
use crate::fill::even::spread;
use crate::fill::patch::Patch;
use crate::fill::refine::Taken;
use crate::progress::Pace;

/// A patch with its vertices spread evenly, and the copy of each. `copies`: of the patch's vertices;
/// `share`: see [`crate::fill::even::share`].
pub fn spread_points(
    patch: &Patch,
    copies: &[Option<u32>],
    share: f64,
    taken: Taken<'_>,
    check: &dyn Fn() -> Result<()>,
) -> Result<(Patch, Vec<Option<u32>>)> {
    let mut made = patch.clone();
    let on = spread(&mut made, share, taken, &mut Pace::new(check))?;
    let copy = |(v, &t): (usize, &u32)| {
        let corners = *patch.triangles.get(t as usize)?;
        let far = |c: &u32| patch.p(*c).distance_squared(made.positions[v]);
        let copied = corners.iter().filter(|&&c| copies[c as usize].is_some());
        copies[*copied.min_by(|a, b| far(a).total_cmp(&far(b)))? as usize]
    };
    let copies = on.iter().enumerate().map(copy).collect();
    Ok((made, copies))
}
