//! A hole that is long and narrow or bends around the object (a crack, a missing band), completed through windows
//! along it: searched and looked at through each, then once more over the surface found, through others, at all that
//! served those nearby. So neighbours come to agree, and triangles to lie along what was copied.

use super::coherent::{domain_of, finish, finish_again, Scope, AGAIN};
use super::smooth::{Fill, Story};
use crate::error::Result;
use crate::fill::patch::Patch;
use crate::fill::refine::refine;
use crate::matching::rigid::Rigid;
use crate::progress::Pace;
use crate::synthesis::domain::{Domain, Extent};
use crate::synthesis::fit::Chosen;
use crate::synthesis::view::{look, View};
use crate::synthesis::window::{judge_by_whole, plan_windows, Window};

/// Where the search ends in such a hole's time, and where the first look does; measured on cracks and bands of the
/// samples, of which the search takes 0.25 to 0.7.
const PARTS: [f64; 2] = [0.45, 0.75];
/// Share of a window from which on a copy that gives no detail is looked at once more.
const SOME: f64 = 0.05;

/// The completion of a long hole; `Ok(None)`: nothing on the object serves.
pub fn complete_long(scope: &Scope<'_>, fill: &Fill) -> Result<Option<(Patch, Story)>> {
    let scope = Scope { search: PARTS[0], first: PARTS[1], ..*scope };
    let source = scope.library.source();
    let domain_of = |patch, extent| domain_of(scope.around, fill, scope.library, patch, extent);
    let Some(domain) = domain_of(&fill.patch, Extent::Narrow) else { return Ok(None) };
    let windows = windows_of(&scope, &domain, 0.0)?;
    let views = scope.look_through(&windows)?;
    let stop = || (scope.check)(scope.first);
    let made = finish(&fill.patch, source, &domain, &views, &stop)?;
    let Some((patch, story)) = made else { return Ok(None) };
    let mut finer = patch.clone();
    if !refine(&mut finer, &fill.outline.taken, AGAIN, &mut Pace::new(&stop))? {
        return Ok(Some((patch, story)));
    }
    let Some(domain) = domain_of(&finer, Extent::FoundNarrow) else {
        return Ok(Some((patch, story)));
    };
    let windows = windows_of(&scope, &domain, scope.first)?;
    let again = look_along(&scope, &windows, &views)?;
    let stop = || (scope.check)(1.0);
    let second = finish_again(&finer, source, &domain, &again, story.coherence_error, &stop)?;
    Ok(second.or(Some((patch, story))))
}

/// The windows of a long fill, judged by all of it. `done`: part of the whole time that is over.
fn windows_of(scope: &Scope<'_>, domain: &Domain, done: f64) -> Result<Vec<Window>> {
    let mut windows = plan_windows(domain);
    judge_by_whole(&mut windows, domain, scope.threads, &|| (scope.check)(done))?;
    Ok(windows)
}

/// Looks through windows at what was seen through those nearby.
fn look_along<'w>(
    scope: &Scope<'_>,
    windows: &'w [Window],
    first: &[View<'_>],
) -> Result<Vec<View<'w>>> {
    let mut views = Vec::new();
    for (i, window) in windows.iter().enumerate() {
        let done = |p: f64| (i as f64 + p) / windows.len() as f64;
        let at = |p: f64| (scope.check)(scope.first + (1.0 - scope.first) * done(p));
        let Some((places, chosen)) = seen_nearby(&window.domain, first) else { continue };
        let known = (scope.roughness(&window.domain), Some(chosen));
        let source = scope.library.source();
        views.extend(look(window, source, &places, known, scope.threads, &at)?);
    }
    Ok(views)
}

/// The places that served the windows whose middles are nearer to a window's than its radius, and the stiffnesses
/// chosen in the nearest.
fn seen_nearby(domain: &Domain, first: &[View<'_>]) -> Option<(Vec<Rigid>, Chosen)> {
    let off = |view: &&View<'_>| view.window.domain.centre.distance(domain.centre);
    let mut near: Vec<&View<'_>> = first.iter().filter(|view| off(view) < domain.radius).collect();
    near.sort_by(|a, b| off(a).total_cmp(&off(b)));
    let chosen = near.first()?.fitted.chosen;
    let mut places: Vec<Rigid> = Vec::new();
    for view in near {
        let serves = |k: &usize| view.shares[*k] > SOME || view.labels.contains(k);
        for k in (0..view.copies.len()).filter(serves) {
            if !places.contains(&view.copies[k].transform) {
                places.push(view.copies[k].transform);
            }
        }
    }
    Some((places, chosen))
}
