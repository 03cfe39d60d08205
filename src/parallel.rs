//! Work side by side, results in order: the thread count cannot change a bit of what comes out.
//!
//! Plain threads and a counter, as for whole holes: the caller's thread stays free to ask the
//! progress function, which must be called from it.

use crate::error::Result;
use std::panic::{catch_unwind, resume_unwind, AssertUnwindSafe};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc;
use std::time::{Duration, Instant};

/// Name of the worker threads, by which the C ABI knows their panics from the host's.
pub(crate) const WORKER: &str = "complete-mesh";
/// How long the calling thread waits between two looks at the progress function: a quarter of
/// what a cancel may take.
pub(crate) const BEAT: Duration = Duration::from_millis(25);

/// The threads to use when `threads` are asked for; 0 asks for all cores.
pub fn thread_count(threads: usize) -> usize {
    match threads {
        // It reads some files of the system's: not for nothing.
        0 => std::thread::available_parallelism().map_or(1, |n| n.get()),
        some => some,
    }
}

/// `[f(0), f(1), …]`, worked on by up to `threads` threads. `check` is called on this thread now
/// and then; when it fails no further item is begun and its error is returned.
pub fn map<T: Send>(
    count: usize,
    threads: usize,
    check: &dyn Fn() -> Result<()>,
    f: &(dyn Fn(usize) -> T + Sync),
) -> Result<Vec<T>> {
    map_part(count, threads, &|_| check(), f)
}

/// The same; `check` is told which part of the items is done.
pub fn map_part<T: Send>(
    count: usize,
    threads: usize,
    check: &dyn Fn(f64) -> Result<()>,
    f: &(dyn Fn(usize) -> T + Sync),
) -> Result<Vec<T>> {
    let part = |done: usize| done as f64 / count.max(1) as f64;
    if threads <= 1 || count <= 1 {
        return (0..count)
            .map(|i| {
                check(part(i))?;
                Ok(f(i))
            })
            .collect();
    }
    let (next, stop) = (AtomicUsize::new(0), AtomicBool::new(false));
    let (send, receive) = mpsc::channel();
    let mut results: Vec<Option<T>> = (0..count).map(|_| None).collect();
    let (mut panic, mut answer, mut done) = (None, Ok(()), 0);
    std::thread::scope(|scope| {
        for _ in 0..threads.min(count) {
            let (send, next, stop) = (send.clone(), &next, &stop);
            let work = move || loop {
                let i = next.fetch_add(1, Ordering::Relaxed);
                if i >= count || stop.load(Ordering::Relaxed) {
                    break;
                }
                // An item that panics only read what is outside.
                if send.send((i, catch_unwind(AssertUnwindSafe(|| f(i))))).is_err() {
                    break;
                }
            };
            // Without a thread the others do the work; without any it is done here below.
            let _ = std::thread::Builder::new().name(WORKER.into()).spawn_scoped(scope, work);
        }
        drop(send);
        let mut asked = Instant::now();
        loop {
            // Results that keep coming must not put the question off.
            match receive.recv_timeout(BEAT.saturating_sub(asked.elapsed())) {
                Ok((i, Ok(result))) => {
                    results[i] = Some(result);
                    done += 1;
                }
                Ok((_, Err(payload))) => panic = Some(payload),
                Err(mpsc::RecvTimeoutError::Timeout) => {}
                Err(mpsc::RecvTimeoutError::Disconnected) => break,
            }
            if asked.elapsed() >= BEAT {
                if answer.is_ok() {
                    answer = check(part(done));
                }
                asked = Instant::now();
            }
            if answer.is_err() || panic.is_some() {
                stop.store(true, Ordering::Relaxed);
            }
        }
    });
    if let Some(payload) = panic {
        resume_unwind(payload);
    }
    answer?;
    check(1.0)?;
    Ok(results.into_iter().enumerate().map(|(i, r)| r.unwrap_or_else(|| f(i))).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Error;
    use std::cell::Cell;

    #[test]
    fn results_come_in_order_on_any_number_of_threads() {
        for threads in 0..5 {
            let squares = map(50, threads, &|| Ok(()), &|i| i * i).unwrap();
            assert_eq!(squares, (0..50).map(|i| i * i).collect::<Vec<_>>());
        }
    }

    #[test]
    fn a_cancel_ends_the_work_early() {
        // On this thread it is asked before each item.
        let (begun, asked) = (AtomicUsize::new(0), Cell::new(0));
        let count = |_| begun.fetch_add(1, Ordering::Relaxed);
        let third = || {
            asked.set(asked.get() + 1);
            (asked.get() <= 3).then_some(()).ok_or(Error::Cancelled)
        };
        assert_eq!(map(1000, 1, &third, &count), Err(Error::Cancelled));
        assert_eq!((begun.load(Ordering::Relaxed), asked.get()), (3, 4));
    }

    /// Results that come faster than the caller looks: it looks all the same. The work would take
    /// some five seconds, so that no load on the machine makes it end before the first look.
    #[test]
    fn a_cancel_reaches_workers_that_are_never_still() {
        let (begun, asked) = (AtomicUsize::new(0), Cell::new(0));
        let work = |_| {
            begun.fetch_add(1, Ordering::Relaxed);
            std::thread::sleep(Duration::from_millis(1));
        };
        let cancel = || {
            asked.set(asked.get() + 1);
            Err(Error::Cancelled)
        };
        assert_eq!(map(10_000, 2, &cancel, &work), Err(Error::Cancelled));
        assert!(begun.load(Ordering::Relaxed) < 10_000);
        assert_eq!(asked.get(), 1);
    }
}
