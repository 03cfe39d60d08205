//! Holes side by side on a few threads, progress on the caller's own.
//!
//! Plain threads and a counter: each hole is worked on by one thread alone and its result goes
//! to its own place, so the thread count cannot change a bit of it. rayon would call the
//! progress function from its workers, and a host's callback must come from the calling thread.

use crate::error::Result;
use crate::parallel::{thread_count, BEAT, WORKER};
use crate::progress::Monitor;
use std::cell::Cell;
use std::panic::{catch_unwind, resume_unwind, AssertUnwindSafe};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc;

/// Holes from which on a second thread pays: starting one costs as much as a small fill.
const FEW: usize = 4;
/// The part of the whole call's progress that a piece of work is: from, to.
pub type Span = (f64, f64);

/// What is done with each hole: called with its number and with what it has to call now and then.
pub type Job<'a, T> = &'a (dyn Fn(usize, Check<'_>) -> Result<T> + Sync);
/// Called with the fraction of the job done; fails when the work shall stop.
pub type Check<'a> = &'a dyn Fn(f64) -> Result<()>;

/// The threads that each of `count` holes may use inside: all of them if the holes are worked on one
/// after the other, else one.
pub fn threads_inside(count: usize, threads: usize) -> usize {
    if count < FEW {
        thread_count(threads)
    } else {
        1
    }
}

/// Does jobs that cost about so much and returns their results in order. A job calls its `check` with
/// the fraction it has done.
pub fn run<T: Send>(
    costs: &[f64],
    threads: usize,
    (monitor, span): (&Monitor, Span),
    job: Job<'_, T>,
) -> Result<Vec<T>> {
    let (count, total) = (costs.len(), costs.iter().sum::<f64>());
    // Not a bit more than the whole span.
    let fraction = |done: f64| span.0 + (span.1 - span.0) * (done / total).clamp(0.0, 1.0);
    let threads = thread_count(threads).min(count / FEW * 2).max(1);
    if threads == 1 {
        let one = |i: usize| {
            // A job that starts anew must not turn the progress back.
            let (most, before) = (Cell::new(0.0), costs[..i].iter().sum::<f64>());
            job(i, &|part| {
                most.set(part.max(most.get()));
                monitor.step(fraction(before + costs[i] * most.get()), "filling")
            })
        };
        return (0..count).map(one).collect();
    }
    let next = AtomicUsize::new(0);
    let (send, receive) = mpsc::channel();
    let mut results: Vec<Option<Result<T>>> = (0..count).map(|_| None).collect();
    let mut panic = None;
    std::thread::scope(|scope| {
        for _ in 0..threads {
            let (send, next) = (send.clone(), &next);
            let work = move || loop {
                let i = next.fetch_add(1, Ordering::Relaxed);
                if i >= count || monitor.is_cancelled() {
                    break;
                }
                // Nothing outside is half changed by a job that panics: it only reads.
                let result = catch_unwind(AssertUnwindSafe(|| job(i, &|_| monitor.check())));
                if send.send((i, result)).is_err() {
                    break;
                }
            };
            let named = std::thread::Builder::new().name(WORKER.into());
            // Without a thread the others do the work; without any it is done here below.
            let _ = named.spawn_scoped(scope, work);
        }
        drop(send);
        let mut done = 0.0;
        loop {
            match receive.recv_timeout(BEAT) {
                Ok((i, Ok(result))) => {
                    results[i] = Some(result);
                    done += costs[i];
                }
                Ok((_, Err(payload))) => {
                    monitor.cancel();
                    panic = Some(payload);
                }
                Err(mpsc::RecvTimeoutError::Timeout) => {}
                Err(mpsc::RecvTimeoutError::Disconnected) => break,
            }
            // A wish to stop reaches the workers through the monitor.
            let _ = monitor.step(fraction(done), "filling");
        }
    });
    if let Some(payload) = panic {
        // On the caller's thread, where the C ABI catches it with its message.
        resume_unwind(payload);
    }
    monitor.check()?;
    let missing = |i: usize| job(i, &|_| monitor.check());
    let all = results.into_iter().enumerate();
    all.map(|(i, result)| result.unwrap_or_else(|| missing(i))).collect()
}

/// One long job: gets a monitor to check and a function to report the fraction done to.
pub type LongJob<'a, T> = &'a (dyn Fn(&Monitor, &dyn Fn(f64)) -> Result<T> + Sync);

/// Does one long job on a thread of its own, while this one asks the progress function whether to
/// go on.
pub fn beside<T: Send>(
    (monitor, span): (&Monitor, Span),
    stage: &str,
    job: LongJob<'_, T>,
) -> Result<T> {
    let inner = Monitor::silent();
    let done = AtomicUsize::new(0);
    // What starts anew must not turn the progress back, and all of it is the span and not more.
    let report = |part: f64| {
        done.fetch_max((1e6 * part.min(1.0)) as usize, Ordering::Relaxed);
    };
    std::thread::scope(|scope| {
        let (send, receive) = mpsc::channel();
        let (inner, report) = (&inner, &report);
        let work = move || {
            let result = catch_unwind(AssertUnwindSafe(|| job(inner, report)));
            let _ = send.send(result);
        };
        let named = std::thread::Builder::new().name(WORKER.into());
        if named.spawn_scoped(scope, work).is_err() {
            return job(monitor, report);
        }
        loop {
            match receive.recv_timeout(BEAT) {
                Ok(Ok(result)) => return result,
                Ok(Err(payload)) => resume_unwind(payload),
                Err(_) => {
                    let part = done.load(Ordering::Relaxed) as f64 / 1e6;
                    if monitor.step(span.0 + (span.1 - span.0) * part, stage).is_err() {
                        inner.cancel();
                    }
                }
            }
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_come_in_order_on_any_number_of_threads() {
        for threads in 0..5 {
            let squares =
                run(&[1.0; 50], threads, (&Monitor::silent(), (0.0, 1.0)), &|i, _| Ok(i * i))
                    .unwrap();
            assert_eq!(squares, (0..50).map(|i| i * i).collect::<Vec<_>>());
        }
    }

    /// What the caller reports next is the span's end: nothing before it may be more, by a rounding either.
    #[test]
    fn progress_ends_where_the_span_ends() {
        for (count, threads) in (0..100).flat_map(|n| [(n, 1), (n, 2)]) {
            let most = std::sync::Mutex::new(0.0_f64);
            let report = |fraction: f64, _: &str| {
                let mut most = most.lock().unwrap();
                *most = most.max(fraction);
                true
            };
            let jobs = |_: usize, check: Check<'_>| check(1.0);
            let costs = vec![0.7; count];
            run(&costs, threads, (&Monitor::new(&report), (0.02, 0.98)), &jobs).unwrap();
            assert!(*most.lock().unwrap() <= 0.98, "{count} holes, {threads} threads");
        }
    }

    /// A scope alone would say "a scoped thread panicked", which nobody can act on.
    #[test]
    fn a_panic_in_a_worker_arrives_with_its_message() {
        let job = |i: usize, _: Check<'_>| match i {
            7 => panic!("job {i}"),
            _ => Ok(i),
        };
        let caught = catch_unwind(|| run(&[1.0; 9], 2, (&Monitor::silent(), (0.0, 1.0)), &job));
        let payload = caught.unwrap_err();
        assert_eq!(payload.downcast_ref::<String>().unwrap(), "job 7");
    }
}
