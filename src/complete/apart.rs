//! Fills that were made side by side, kept off each other.

use super::check::Obstacles;
use super::continued::Call;
use super::library::Library;
use super::{Completer, Outcome};
use crate::error::Result;
use crate::mesh::neighbourhood::Bounds;
use crate::progress::Monitor;
use glam::DVec3;

impl Completer<'_> {
    /// Fills made side by side may meet: the later one is then made again around the earlier.
    pub(super) fn part_fills(
        &self,
        call: &Call<'_>,
        outcomes: &mut [Outcome],
        library: Option<&Library>,
        monitor: &Monitor,
    ) -> Result<()> {
        let bounds: Vec<Bounds> = outcomes
            .iter()
            .map(|o| match o {
                Ok((fill, _)) => Bounds::of(fill.patch.positions.iter().copied()),
                Err(_) => Bounds::EMPTY,
            })
            .collect();
        let mut order: Vec<usize> = (0..bounds.len()).collect();
        order.sort_by(|&a, &b| bounds[a].min.x.total_cmp(&bounds[b].min.x).then(a.cmp(&b)));
        // Neighbours by a sweep along x; for each fill the earlier holes whose box meets its own.
        let mut earlier: Vec<Vec<usize>> = vec![Vec::new(); bounds.len()];
        for (place, &a) in order.iter().enumerate() {
            for &b in &order[place + 1..] {
                if bounds[b].min.x > bounds[a].max.x {
                    break;
                }
                if bounds[a].overlaps(&bounds[b]) {
                    earlier[a.max(b)].push(a.min(b));
                }
            }
        }
        for i in 0..outcomes.len() {
            monitor.check()?;
            earlier[i].sort_unstable();
            let others: Vec<[DVec3; 3]> = earlier[i]
                .iter()
                .filter_map(|&j| outcomes[j].as_ref().ok())
                .flat_map(|(f, _)| f.patch.triangles.iter().map(|t| t.map(|v| f.patch.p(v))))
                .collect();
            let obstacles = Obstacles { mesh: self.mesh, covered: call.boxes, others: &others };
            let meets = match &outcomes[i] {
                Ok((fill, _)) if !others.is_empty() => obstacles.meets(call.around, &fill.patch),
                _ => false,
            };
            if meets {
                let check = |_| monitor.check();
                outcomes[i] = self.fill_one(call, &obstacles, i, library, &check)?;
            }
        }
        Ok(())
    }
}
