//! A hole that is long and narrow or bends around the object (a crack, a missing band), completed through windows
//! along it: searched and looked at through each, then once more over the surface found, through others, at all that
//! served those nearby. So neighbours come to agree, and triangles to lie along what was copied.

use super::coherent::{domain_of, finish, finish_again, Scope, AGAIN};
use super::cost::LongCost;
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

/// Share of a window from which on a copy that gives no detail is looked at once more.
const SOME: f64 = 0.05;

/// The completion of a long hole; `Ok(None)`: nothing on the object serves.
pub fn complete_long(scope: &Scope<'_>, fill: &Fill) -> Result<Option<(Patch, Story)>> {
    let source = scope.library.source();
    let domain_of = |patch, extent| domain_of(scope.around, fill, scope.library, patch, extent);
    let Some(domain) = domain_of(&fill.patch, Extent::Narrow) else { return Ok(None) };
    let mut windows = plan_windows(&domain, &|| (scope.check)(0.0))?;
    let own = windows.first().map_or(0, |w| w.domain.fill.len());
    let area = windows.first().map_or(0.0, |w| scope.library.known.area / w.domain.radius.powi(2));
    let [plate, search, first, again] =
        LongCost::of(domain.fill.len(), windows.len(), own, area).parts();
    let rest = |end: f64| (end - plate) / (1.0 - plate);
    let late = |part: f64| (scope.check)(plate + (1.0 - plate) * part);
    let scope = Scope { search: rest(search), first: rest(first), check: &late, ..*scope };
    judge_by_whole(&mut windows, &domain, scope.threads, &|| late(0.0))?;
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
    let mut windows = plan_windows(&domain, &stop)?;
    judge_by_whole(&mut windows, &domain, scope.threads, &stop)?;
    let again = look_along(&Scope { first: rest(again), ..scope }, &windows, &views)?;
    let stop = || (scope.check)(1.0);
    let second = finish_again(&finer, source, &domain, &again, story.coherence_error, &stop)?;
    Ok(second.or(Some((patch, story))))
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
