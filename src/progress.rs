//! Progress out, cancel in.

use crate::error::{Error, Result};
use std::sync::atomic::{AtomicBool, Ordering};

/// Called with the fraction done (0 to 1, never falling) and the stage; returns false to cancel.
pub type ProgressFn<'a> = &'a (dyn Fn(f64, &str) -> bool + Sync);

/// Carries progress to the caller and the wish to stop back.
///
/// The progress function is called on the thread that called the library, at least once a stage.
/// Once it has returned false, or [`Monitor::cancel`] was called from any thread, every later
/// check fails: the call returns [`Error::Cancelled`] and frees everything.
#[derive(Default)]
pub struct Monitor<'a> {
    progress: Option<ProgressFn<'a>>,
    cancelled: AtomicBool,
}

impl<'a> Monitor<'a> {
    /// A monitor that reports to nobody.
    pub fn silent() -> Self {
        Self::default()
    }

    /// A monitor that reports to `progress`.
    pub fn new(progress: ProgressFn<'a>) -> Self {
        Self { progress: Some(progress), cancelled: AtomicBool::new(false) }
    }

    /// Asks the running call to stop; may be called from any thread.
    pub fn cancel(&self) {
        self.cancelled.store(true, Ordering::Relaxed);
    }

    /// Whether the call was asked to stop.
    pub fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }

    /// Reports and checks. Only from the calling thread.
    pub fn step(&self, fraction: f64, stage: &str) -> Result<()> {
        if let Some(report) = self.progress {
            if !self.is_cancelled() && !report(fraction.clamp(0.0, 1.0), stage) {
                self.cancel();
            }
        }
        self.check()
    }

    /// Checks only; cheap, from any thread.
    pub fn check(&self) -> Result<()> {
        if self.is_cancelled() {
            Err(Error::Cancelled)
        } else {
            Ok(())
        }
    }
}

/// Elementary steps (an edge looked at, an apex tried) between two looks at the wish to stop: some
/// five milliseconds of work.
const PACE: usize = 1 << 20;

/// Asks now and then, in a long loop, whether to go on.
pub struct Pace<'a> {
    check: &'a dyn Fn() -> Result<()>,
    done: usize,
}

impl<'a> Pace<'a> {
    /// Asks `check`.
    pub fn new(check: &'a dyn Fn() -> Result<()>) -> Self {
        Self { check, done: 0 }
    }

    /// Counts steps of work; asks when there have been enough.
    #[inline]
    pub fn work(&mut self, steps: usize) -> Result<()> {
        self.done += steps;
        if self.done < PACE {
            return Ok(());
        }
        self.done = 0;
        (self.check)()
    }
}
