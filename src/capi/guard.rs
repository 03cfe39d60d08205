//! No panic crosses into C, and none prints: what failed is told by status and message.

use super::error::{self, Failure, Status};
use std::cell::{Cell, RefCell};
use std::panic::{catch_unwind, AssertUnwindSafe, PanicHookInfo};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::Once;

thread_local! {
    /// How many guarded calls this thread is in: a progress function may call the library again.
    static DEPTH: Cell<usize> = const { Cell::new(0) };
    /// Where the last panic of this thread was raised, "file:line".
    static PANIC_PLACE: RefCell<String> = const { RefCell::new(String::new()) };
}

/// Guarded calls of all threads: worker threads cannot know whom they work for.
static ACTIVE: AtomicUsize = AtomicUsize::new(0);

type Hook = Box<dyn Fn(&PanicHookInfo<'_>) + Send + Sync>;

/// Passes on to `previous` what was not raised inside a guarded call.
fn quiet(previous: Hook) -> Hook {
    Box::new(move |info| {
        let here = || DEPTH.with(Cell::get) > 0;
        let worker = || {
            ACTIVE.load(Ordering::Relaxed) > 0
                && std::thread::current().name() == Some(crate::complete::WORKER)
        };
        if !here() && !worker() {
            return previous(info);
        }
        if let Some(place) = info.location() {
            let text = format!("{}:{}", place.file(), place.line());
            let _ = PANIC_PLACE.try_with(|p| *p.borrow_mut() = text);
        }
    })
}

/// Rust's own hook writes every panic to standard error before unwinding starts, which a library
/// inside a host has no business doing.
fn install_quiet_hook() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| std::panic::set_hook(quiet(std::panic::take_hook())));
}

/// Counts a call in, and out again however it ends.
struct Entered;

impl Entered {
    fn new() -> Self {
        DEPTH.with(|d| d.set(d.get() + 1));
        ACTIVE.fetch_add(1, Ordering::Relaxed);
        Entered
    }
}

impl Drop for Entered {
    fn drop(&mut self) {
        DEPTH.with(|d| d.set(d.get() - 1));
        ACTIVE.fetch_sub(1, Ordering::Relaxed);
    }
}

fn caught<T>(body: impl FnOnce() -> T) -> Result<T, Failure> {
    install_quiet_hook();
    PANIC_PLACE.with(|p| p.borrow_mut().clear());
    let entered = Entered::new();
    // Sound to assert: what a panicking call was making is dropped, and it only reads the rest.
    let outcome = catch_unwind(AssertUnwindSafe(body));
    drop(entered);
    outcome.map_err(|payload| {
        let what = payload
            .downcast_ref::<&str>()
            .map(|s| s.to_string())
            .or_else(|| payload.downcast_ref::<String>().cloned())
            .unwrap_or_else(|| "no message".into());
        let place = PANIC_PLACE.with(|p| p.borrow().clone());
        let place = if place.is_empty() { place } else { format!(" at {place}") };
        Failure::new(Status::Internal, format!("internal error{place}: {what}; please report it"))
    })
}

/// Runs the body of an entry that returns a status, and keeps message and elements of a failure.
pub(super) fn guard(body: impl FnOnce() -> Result<(), Failure>) -> Status {
    match caught(body).and_then(|result| result) {
        Ok(()) => Status::Ok,
        Err(failure) => error::keep(failure),
    }
}

/// Runs the body of an accessor, which answers `otherwise` when it cannot answer.
pub(super) fn guard_value<T>(otherwise: T, body: impl FnOnce() -> Option<T>) -> T {
    match caught(body) {
        Ok(value) => value.unwrap_or(otherwise),
        Err(failure) => {
            error::keep(failure);
            otherwise
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Mutex;

    fn message() -> String {
        let text = error::complete_mesh_last_error_message();
        // SAFETY: the message is a NUL-terminated string until the next failure of this thread.
        unsafe { std::ffi::CStr::from_ptr(text) }.to_str().unwrap().to_owned()
    }

    #[test]
    fn a_panic_is_a_status_with_its_message_and_place() {
        assert_eq!(guard(|| panic!("edge {} is odd", 7)), Status::Internal);
        assert!(message().contains("edge 7 is odd"), "{}", message());
        assert!(message().contains("guard.rs:"), "{}", message());
        assert_eq!(guard(|| Ok(())), Status::Ok);
        assert_eq!(guard_value(3, || panic!("no answer")), 3);
        assert!(message().contains("no answer"));
        assert_eq!(guard_value(3, || None), 3);
        assert_eq!(guard_value(3, || Some(4)), 4);
    }

    /// Failed before the quiet hook: every caught panic printed into the host's standard error.
    #[test]
    fn only_panics_of_others_reach_the_hook_below() {
        static HEARD: Mutex<Vec<String>> = Mutex::new(Vec::new());
        install_quiet_hook(); // now, not in the middle
        let before = std::panic::take_hook();
        std::panic::set_hook(quiet(Box::new(|info| {
            let text = info.payload().downcast_ref::<&str>().unwrap_or(&"").to_string();
            HEARD.lock().unwrap().push(text);
        })));
        let ours = guard(|| panic!("ours"));
        let worker = guard(|| {
            let named = std::thread::Builder::new().name(crate::complete::WORKER.into());
            assert!(named.spawn(|| panic!("worker")).unwrap().join().is_err());
            Ok(())
        });
        let theirs = std::thread::spawn(|| panic!("theirs")).join();
        std::panic::set_hook(before);
        assert_eq!((ours, worker), (Status::Internal, Status::Ok));
        assert!(theirs.is_err());
        let heard = HEARD.lock().unwrap();
        assert!(heard.iter().any(|t| t == "theirs"));
        assert!(heard.iter().all(|t| t != "ours" && t != "worker"));
    }
}
