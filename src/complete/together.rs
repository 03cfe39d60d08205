//! Methods that complete all holes together, from the smooth fills that there are.

use super::check::Obstacles;
use super::smooth::{Fill, Story, Surroundings};
use super::{fragment, harary, workers, Completer, Outcome, BESIDE};
use crate::error::Result;
use crate::fill::patch::Patch;
use crate::mesh::neighbourhood::Bounds;
use crate::options::{Method, Options};
use crate::parallel::thread_count;
use crate::progress::Monitor;

impl Completer<'_> {
    /// The smooth fills made coherent with the object (Harary et al. 2014): of each hole the most
    /// coherent one that keeps the contract, the smooth one at the worst.
    pub(super) fn make_coherent(
        &self,
        around: &Surroundings<'_>,
        boxes: &[Bounds],
        outcomes: &mut [Outcome],
        monitor: &Monitor,
    ) -> Result<()> {
        let mut fills = filled(outcomes);
        let initial: Vec<_> = fills.iter().map(|fill| initial_of(around, fill)).collect();
        let made = workers::beside(
            (monitor, BESIDE),
            "continuing what the object shows",
            &|inner, done| harary::complete_holes_harary(self.mesh, &initial, inner, done),
        )?;
        for (fill, coherent) in fills.iter_mut().zip(made) {
            fill.coherence_error = Some(coherent.errors).filter(|e| e[0].is_finite());
            let offered = coherent.patches.into_iter().map(|patch| (patch, None));
            self.settle_first(around, boxes, fill, Method::Harary, offered, monitor)?;
        }
        Ok(())
    }

    /// The smooth fills replaced by fragments of the object (Bendels et al. 2005): of each hole those of
    /// the finest scale that keep the contract, the smooth one at the worst.
    pub(super) fn paste_fragments(
        &self,
        around: &Surroundings<'_>,
        boxes: &[Bounds],
        outcomes: &mut [Outcome],
        options: &Options,
        monitor: &Monitor,
    ) -> Result<()> {
        let mut fills = filled(outcomes);
        let initial: Vec<_> = fills.iter().map(|fill| initial_of(around, fill)).collect();
        let asked = fragment::Asked {
            rims: &self.rims(),
            mirrored: !options.sources.unmirrored,
            threads: thread_count(options.threads),
        };
        let made = workers::beside((monitor, BESIDE), "copying fragments", &|inner, done| {
            fragment::complete_holes(self.mesh, &initial, &asked, inner, done)
        })?;
        for (fill, completed) in fills.iter_mut().zip(made) {
            let offered = completed.patches.into_iter().map(|(patch, story)| (patch, Some(story)));
            self.settle_first(around, boxes, fill, Method::Fragment, offered, monitor)?;
        }
        Ok(())
    }

    /// Takes the first of some patches that keeps the contract; the fill stands if none does.
    fn settle_first(
        &self,
        around: &Surroundings<'_>,
        boxes: &[Bounds],
        fill: &mut Fill,
        method: Method,
        offered: impl Iterator<Item = (Patch, Option<Story>)>,
        monitor: &Monitor,
    ) -> Result<()> {
        let obstacles = Obstacles { mesh: self.mesh, covered: boxes, others: &[] };
        for (patch, story) in offered {
            monitor.check()?;
            if let Ok(patch) = obstacles.settle(around, patch, &|| monitor.check())? {
                (fill.patch, fill.story, fill.method) = (patch, story, method);
                break;
            }
        }
        Ok(())
    }
}

/// The fills there are.
fn filled(outcomes: &mut [Outcome]) -> Vec<&mut Fill> {
    outcomes.iter_mut().filter_map(|o| o.as_mut().ok()).map(|o| &mut o.0).collect()
}

/// A fill as what to start from.
pub(super) fn initial_of<'f>(around: &Surroundings<'_>, fill: &'f Fill) -> harary::Initial<'f> {
    let input = |&v: &u32| around.near.vertices[v as usize];
    harary::Initial {
        rim: fill.outline.vertices.iter().map(input).collect(),
        patch: &fill.patch,
        taken: &fill.outline.taken,
        share: fill.outline.share,
    }
}
