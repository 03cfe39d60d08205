//! Searches that were made, kept by all that they depend on: a hole that looks the same again is not
//! searched again.

use crate::error::Result;
use crate::matching::icp::RingPoint;
use crate::matching::search::Target;
use glam::DVec3;
use std::sync::{Mutex, PoisonError};

/// Searches kept; a hole's takes some hundred kilobytes.
const KEPT: usize = 256;

/// What was asked for, and what was found.
pub struct Searches<T>(Mutex<Vec<(Vec<Sought>, Scales, T)>>);

/// Least and greatest size of the sources.
type Scales = Option<[f64; 2]>;

/// All that the candidates of a window depend on, but the library and the sizes. (What is loose is not in the
/// ring.)
struct Sought {
    centre: DVec3,
    normal: DVec3,
    radius: f64,
    fill: Vec<DVec3>,
    ring: Vec<RingPoint>,
    emphasis: f64,
}

impl Sought {
    fn of(target: &Target<'_>) -> Self {
        let Target { centre, normal, radius, emphasis, .. } = *target;
        let (fill, ring) = (target.fill.into(), target.ring.into());
        Self { centre, normal, radius, fill, ring, emphasis }
    }

    fn is(&self, target: &Target<'_>) -> bool {
        let Target { centre, normal, radius, fill, ring, emphasis, .. } = *target;
        let own = (self.centre, self.normal, self.radius, self.emphasis);
        let place = own == (centre, normal, radius, emphasis);
        place && self.fill == fill && self.ring == ring
    }
}

impl<T> Default for Searches<T> {
    fn default() -> Self {
        Self(Mutex::default())
    }
}

impl<T: Clone> Searches<T> {
    /// What was found for some windows at some sizes, made if it is not there.
    pub fn find(
        &self,
        targets: &[Target<'_>],
        scales: Scales,
        make: impl FnOnce() -> Result<T>,
    ) -> Result<T> {
        let lock = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let same = |(sought, range, _): &&(Vec<Sought>, Scales, T)| {
            *range == scales
                && sought.len() == targets.len()
                && sought.iter().zip(targets).all(|(s, t)| s.is(t))
        };
        if let Some((_, _, found)) = lock().iter().find(same) {
            return Ok(found.clone());
        }
        let made = make()?;
        let mut kept = lock();
        if kept.len() < KEPT {
            kept.push((targets.iter().map(Sought::of).collect(), scales, made.clone()));
        }
        Ok(made)
    }
}
