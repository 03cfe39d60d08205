//! The caller's progress function as a [`Monitor`].

use super::error::{c_string, Failure};
use super::options::{COptions, CProgressFn};
use crate::progress::Monitor;
use std::ffi::c_void;

/// The progress function and what it is called with.
struct Callback {
    function: CProgressFn,
    user: *mut c_void,
}

// SAFETY: a `Monitor` calls its progress function on the calling thread only, so `user` never
// reaches another thread; `Sync` is asked for because workers hold the monitor to check for cancel.
unsafe impl Sync for Callback {}

impl Callback {
    fn report(&self, fraction: f64, stage: &str) -> bool {
        #[cfg(feature = "test-panic")]
        test_panic::count_down();
        let Some(function) = self.function else { return true };
        let stage = c_string(stage);
        // SAFETY: a function of this type by the caller's word; the string outlives the call.
        unsafe { function(self.user, fraction, stage.as_ptr()) == 0 }
    }
}

/// Runs `body` with a monitor that reports to the caller of the C function. The first report comes
/// before anything is done, so that every call can be cancelled, however short.
pub(super) fn with_monitor<T>(
    opts: &COptions,
    body: impl FnOnce(&Monitor) -> Result<T, Failure>,
) -> Result<T, Failure> {
    let callback = Callback { function: opts.progress, user: opts.progress_user };
    let report = |fraction: f64, stage: &str| callback.report(fraction, stage);
    let monitor = Monitor::new(&report);
    monitor.step(0.0, "reading the mesh")?;
    body(&monitor)
}

/// Panics on demand, for the test of the panic boundary; never in a library that is installed.
#[cfg(feature = "test-panic")]
mod test_panic {
    use std::cell::Cell;

    thread_local! { static LEFT: Cell<u32> = const { Cell::new(0) }; }

    /// Makes the `nth` next report of progress on this thread panic, deep inside the algorithms;
    /// 0: none.
    #[no_mangle]
    pub extern "C" fn complete_mesh_test_panic_at(nth: u32) {
        LEFT.with(|l| l.set(nth));
    }

    pub(super) fn count_down() {
        let left = LEFT.with(|l| l.replace(l.get().saturating_sub(1)));
        assert!(left != 1, "panic on demand");
    }
}
