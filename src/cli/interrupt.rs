//! Ctrl-C and termination: the first asks the run to stop, the second ends the process.

use crate::progress::Monitor;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::Mutex;
use std::time::Duration;

/// Process-wide, as signals are.
static REQUESTED: AtomicBool = AtomicBool::new(false);
/// Files written aside that a sudden end must remove.
static ASIDE: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());
/// How often the run looks whether it should stop: not felt by a person, no load for a core.
const LOOK: Duration = Duration::from_millis(20);

/// Whether the user asked to stop.
pub(super) fn requested() -> bool {
    REQUESTED.load(Ordering::Relaxed)
}

/// Starts to listen. Without a handler (a second one in the same process) Ctrl-C ends it as ever.
pub(super) fn listen() {
    let _ = ctrlc::set_handler(|| {
        if REQUESTED.swap(true, Ordering::Relaxed) {
            for file in aside().drain(..) {
                let _ = std::fs::remove_file(file);
            }
            std::process::exit(130);
        }
    });
}

fn aside() -> std::sync::MutexGuard<'static, Vec<PathBuf>> {
    ASIDE.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
}

/// Remembers a file for a sudden end.
pub(super) fn remember(file: &Path) {
    aside().push(file.to_owned());
}

/// Forgets it again: it is in place or gone.
pub(super) fn forget(file: &Path) {
    aside().retain(|f| f != file);
}

/// Runs `work`, and cancels `monitor` as soon as the user asks to stop: also between two reports
/// of progress.
pub(super) fn watched<T>(monitor: &Monitor<'_>, work: impl FnOnce() -> T) -> T {
    /// Ends the watch when the work is done, also by a panic.
    struct End<'a>(&'a AtomicBool, std::thread::Thread);
    impl Drop for End<'_> {
        fn drop(&mut self) {
            self.0.store(true, Ordering::Release);
            self.1.unpark();
        }
    }
    let done = AtomicBool::new(false);
    std::thread::scope(|scope| {
        let watch = scope.spawn(|| {
            while !done.load(Ordering::Acquire) {
                if requested() {
                    return monitor.cancel();
                }
                std::thread::park_timeout(LOOK);
            }
        });
        let _end = End(&done, watch.thread().clone());
        work()
    })
}
