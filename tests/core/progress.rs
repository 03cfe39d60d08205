//! What hosts draw their progress bars from: from 0 to 1, never falling by a bit, on their own thread.

use crate::meshes::{sheet, within, Mesh};
use complete_mesh::{
    complete_mesh_with, complete_points_with, Completer, Error, Grouping, Method, Monitor, Options,
    Selection, Sizing, Sources,
};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::Mutex;
use std::thread;

const METHODS: [Method; 5] =
    [Method::Smooth, Method::Coherent, Method::Harary, Method::Fragment, Method::Warp];

/// A wavy sheet of two rows of cells of `SIDE` squares, with a hole of four squares in the first `holes`.
fn with_holes(holes: usize) -> Mesh {
    const SIDE: usize = 7;
    let wave = |x: f64, y: f64| [x, y, 0.4 * (0.9 * x).sin() * (0.7 * y).cos()];
    let columns = holes.div_ceil(2).max(2);
    sheet((SIDE * columns, 2 * SIDE), wave, |i, j| {
        let cell = i / SIDE + columns * (j / SIDE);
        cell >= holes || !within(i % SIDE, j % SIDE, 2, 4)
    })
}

/// Runs a call that reports to `monitor`; what it reported, of which everything holds that hosts rely on.
fn watched<T>(name: &str, call: impl FnOnce(&Monitor<'_>) -> Result<T, Error>) -> T {
    let (caller, seen) = (thread::current().id(), Mutex::new(Vec::new()));
    let report = |fraction: f64, stage: &str| {
        // A panic here would be taken for one of the call's own.
        let here = thread::current().id() == caller;
        seen.lock().unwrap().push((fraction, stage.to_owned(), here));
        true
    };
    let made = call(&Monitor::new(&report)).unwrap_or_else(|e| panic!("{name}: {e}"));
    let seen = seen.into_inner().unwrap();
    for (i, (fraction, stage, here)) in seen.iter().enumerate() {
        assert!(here, "{name}: {stage} from another thread");
        assert!((0.0..=1.0).contains(fraction), "{name}: {fraction} at {stage}");
        assert!(!stage.is_empty(), "{name}: no stage at {fraction}");
        let before = if i == 0 { 0.0 } else { seen[i - 1].0 };
        assert!(*fraction >= before, "{name}: {before} fell to {fraction} at {stage}");
    }
    assert_eq!(seen.last().map(|s| s.0), Some(1.0), "{name}: it does not end");
    made
}

#[test]
fn never_falls_whatever_the_method_the_holes_and_the_threads() {
    for method in METHODS {
        let counts: Vec<usize> = match method {
            Method::Smooth => (1..=14).collect(),
            _ => vec![1, 9, 13],
        };
        for holes in counts {
            let mesh = with_holes(holes);
            for threads in [1, 2, 3] {
                let name = format!("{method:?}, {holes} holes, {threads} threads");
                let selection = Selection::AllButLargest;
                let options = Options { method, selection, threads, ..Options::default() };
                let made =
                    watched(&name, |monitor| complete_mesh_with(mesh.view(), &options, monitor));
                let filled = made.holes.iter().filter(|h| !h.faces.is_empty()).count();
                assert_eq!(filled, holes, "{name}");
            }
        }
    }
}

/// In a mesh so large that its passes ask on their way whether to go on; from all of it, and from a part.
#[test]
fn never_falls_where_passes_over_the_mesh_are_long() {
    let wave = |x: f64, y: f64| [x, y, 0.4 * (0.9 * x).sin() * (0.7 * y).cos()];
    let mesh = sheet((330, 330), wave, |i, j| !within(i, j, 150, 154));
    let half = (0..mesh.faces.len()).map(|f| f % 2 == 0 || f > 1000).collect();
    for faces in [None, Some(half)] {
        let name = format!("a part {}", faces.is_some());
        let sources = Sources { faces, ..Sources::default() };
        let selection = Selection::AllButLargest;
        let options = Options { sources, selection, threads: 1, ..Options::default() };
        watched(&name, |monitor| complete_mesh_with(mesh.view(), &options, monitor));
    }
}

/// A kept completer gives back what it made before, however the same holes were chosen: one report, the same bits.
#[test]
fn what_was_made_is_given_back_at_once() {
    let mesh = with_holes(2);
    let kept = Completer::new(mesh.view(), &Grouping::Automatic, &Monitor::silent()).unwrap();
    let border = kept.holes().holes.iter().max_by(|a, b| a.diameter.total_cmp(&b.diameter));
    let inner = (0..3).filter(|&id| Some(id) != border.map(|h| h.id)).collect::<Vec<usize>>();
    let of = |sizing, selection| Options { sizing, selection, ..Options::default() };
    let first = of(Sizing::Surroundings, Selection::AllButLargest);
    let other = of(Sizing::Scaled(0.6), Selection::AllButLargest);
    let chosen = of(Sizing::Surroundings, Selection::Ids(inner));
    let run = |options: &Options| {
        let count = AtomicUsize::new(0);
        let report = |_: f64, _: &str| {
            count.fetch_add(1, Ordering::Relaxed);
            true
        };
        let made = kept.complete(options, &Monitor::new(&report)).unwrap();
        (made.vertices, made.faces, count.into_inner())
    };
    let (made, again) = (run(&first), run(&other));
    assert!(made.2 > 1 && again.2 > 1 && made.0 != again.0);
    for options in [&first, &chosen] {
        assert_eq!(run(options), (made.0.clone(), made.1.clone(), 1), "{options:?}");
    }
    assert_eq!(run(&other), (again.0, again.1, 1));
}

/// Each candidate is a call of its own within the whole.
#[test]
fn never_falls_over_candidates_and_calls_that_are_kept() {
    let mesh = with_holes(5);
    let selection = Selection::AllButLargest;
    let options = Options { method: Method::Coherent, selection, threads: 2, ..Options::default() };
    let kept = watched("finding holes", |monitor| {
        let kept = Completer::new(mesh.view(), &Grouping::Automatic, monitor)?;
        monitor.step(1.0, "done")?;
        Ok(kept)
    });
    for round in 0..2 {
        let name = format!("candidates, round {round}");
        watched(&name, |monitor| kept.candidates(3, &options, monitor));
        watched("the same again", |monitor| kept.complete(&options, monitor));
    }
}

#[test]
fn never_falls_on_points() {
    for holes in [1, 9] {
        let cloud = with_holes(holes);
        for method in [Method::Smooth, Method::Coherent, Method::Fragment] {
            let options = Options { method, threads: 2, ..Options::default() };
            let name = format!("{method:?}, points with {holes} holes");
            watched(&name, |monitor| {
                complete_points_with((&cloud.vertices[..]).into(), None, &options, monitor)
            });
        }
    }
}
