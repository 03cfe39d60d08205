//! The options that guide a fill by hand, read.

use super::arrays::array;
use super::error::{Failure, Status};
use super::options::{flag, COptions};
use crate::guidance::{Guidance, Placement};
use crate::matching::rigid::Rigid;
use glam::{DMat3, DVec3};

impl COptions {
    /// The guidance, every number checked.
    ///
    /// # Safety
    /// The arrays are as long as their counts say.
    pub(super) unsafe fn guidance(&self) -> Result<Guidance, Failure> {
        let refined = flag("refine", self.refine)?;
        let placement = match self.placement.is_null() {
            true if refined => return Err(alone("refine", "placement")),
            true => None,
            false => {
                // SAFETY: the caller of this function answers for the array.
                let numbers = unsafe { array("placement", self.placement, 12) }?;
                Some(Placement { transform: transform(&numbers), refined })
            }
        };
        // A bound that is 0 was not set.
        let scales = match [self.least_scale, self.greatest_scale] {
            [0.0, 0.0] => None,
            range => Some(range),
        };
        let count = self.constraint_count.saturating_mul(3);
        // SAFETY: as above.
        let numbers = unsafe { array("constraint_points", self.constraint_points, count) }?;
        let points = numbers.chunks_exact(3).map(|p| [p[0], p[1], p[2]]).collect();
        let (candidate, softness) = (self.candidate as usize, self.softness);
        Ok(Guidance { placement, candidate, scales, points, softness })
    }
}

fn alone(field: &str, other: &str) -> Failure {
    Failure::new(Status::InvalidOption, format!("option {field}: it needs {other}"))
}

/// Of three rows of four numbers.
fn transform(rows: &[f64]) -> Rigid {
    let column = |j: usize| DVec3::new(rows[j], rows[4 + j], rows[8 + j]);
    let linear = DMat3::from_cols(column(0), column(1), column(2));
    Rigid { linear, translation: column(3) }
}
