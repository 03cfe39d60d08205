//! The options that guide a fill by hand, read.

use super::arrays::array;
use super::error::{Failure, Status};
use super::options::{flag, COptions};
use crate::guidance::{Guidance, Placement};
use crate::matching::rigid::Rigid;

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
                let row = |i: usize| [0, 1, 2, 3].map(|j| numbers[4 * i + j]);
                let transform = Rigid::from_rows([0, 1, 2].map(row));
                Some(Placement { transform, refined })
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
        let part = flag("part", self.part)?;
        // SAFETY: as above.
        let loose =
            unsafe { array("loose_vertices", self.loose_vertices, self.loose_count) }?.into();
        Ok(Guidance { placement, candidate, scales, points, part, loose, softness })
    }
}

fn alone(field: &str, other: &str) -> Failure {
    Failure::new(Status::InvalidOption, format!("option {field}: it needs {other}"))
}
