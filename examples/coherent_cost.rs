//! What a coherent fill costs and how that grows with the mesh and with the hole, what a second call
//! on a kept completer costs, how true the progress is, and how soon a cancel is answered.
//!
//! `cargo run --release --example coherent_cost` prints tables in Markdown, `docs/coherent.md` has
//! them. With arguments, SAMPLE BREAK RESOLUTION SIZE, it prints the row of one mesh. One thread; CPU
//! time, so that a busy machine changes little.

mod peak;

use complete_mesh::sample::{break_mesh, Break, BreakOptions, Sample, SampleMesh};
use complete_mesh::{
    Completer, Completion, Fairing, Guidance, Method, Monitor, Options, Selection, Sizing,
};
use cpu_time::ProcessTime;
use peak::{LIVE, PEAK};
use std::error::Error;
use std::sync::atomic::Ordering::Relaxed;
use std::sync::Mutex;
use std::time::{Duration, Instant};

type Case = (Sample, Break, usize, f64);

/// Meshes that grow, the hole hardly.
const MESHES: [Case; 4] = [
    (Sample::Column, Break::Disc, 55, 1.5),
    (Sample::Column, Break::Disc, 135, 0.8),
    (Sample::Column, Break::Disc, 284, 0.4),
    (Sample::Column, Break::Disc, 776, 0.2),
];
/// Growing holes in one mesh.
const HOLES: [Case; 5] = [
    (Sample::Vessel, Break::Disc, 400, 0.2),
    (Sample::Vessel, Break::Disc, 400, 0.3),
    (Sample::Vessel, Break::Disc, 400, 0.5),
    (Sample::Vessel, Break::Disc, 400, 0.9),
    (Sample::Vessel, Break::Disc, 400, 1.5),
];
const OTHERS: [Case; 3] = [
    (Sample::Column, Break::Ragged, 150, 1.0),
    (Sample::Torus, Break::Several, 150, 1.0),
    (Sample::Leg, Break::Ring, 150, 1.0),
];
/// Moments of a call at which it is cancelled.
const MOMENTS: u32 = 8;

fn main() -> Result<(), Box<dyn Error>> {
    let given: Vec<String> = std::env::args().skip(1).collect();
    println!("| sample | vertices | new | continued | CPU s | again | one hole | candidate | fairing | density | after smooth | peak MiB | progress | gap ms | cancel ms |");
    println!("|{}", "---|".repeat(15));
    if let [sample, kind, resolution, size] = &given[..] {
        let sample = Sample::ALL.into_iter().find(|s| s.name() == sample);
        let kind =
            [Break::Ragged, Break::Disc, Break::Islands, Break::Ring, Break::Crack, Break::Several]
                .into_iter()
                .find(|k| k.name() == kind);
        let (Some(sample), Some(kind)) = (sample, kind) else {
            return Err("no such sample or break".into());
        };
        return row((sample, kind, resolution.parse()?, size.parse()?));
    }
    MESHES.into_iter().chain(HOLES).chain(OTHERS).try_for_each(row)
}

fn row((sample, kind, resolution, size): Case) -> Result<(), Box<dyn Error>> {
    let options = BreakOptions { kind, seed: 1, size };
    let mesh = break_mesh(sample, &sample.build(resolution)?, &options)?.mesh;
    let before = LIVE.load(Relaxed);
    PEAK.store(before, Relaxed);
    let log = Log::new();
    let progress = |fraction: f64, stage: &str| log.note(fraction, stage);
    let monitor = Monitor::new(&progress);
    let first = Options { threads: 1, ..Options::default() };
    let completer = Completer::new(mesh.view(), &first.grouping, &monitor)?;
    let made = completer.complete(&first, &monitor)?;
    let peak = (PEAK.load(Relaxed) - before) as f64 / (1 << 20) as f64;
    let (truth, gap) = log.read();
    let again = seconds(&completer, &first)?;
    let one = Options { selection: Selection::Ids(vec![0]), ..first.clone() };
    let guidance = Guidance { candidate: 2, ..Guidance::default() };
    let candidate = Options { guidance, ..first.clone() };
    let fairing = Options { fairing: Fairing::C1, ..first.clone() };
    let density = Options { sizing: Sizing::Scaled(0.8), ..first.clone() };
    let one = seconds(&completer, &one)?;
    let candidate = seconds(&completer, &candidate)?;
    let fairing = seconds(&completer, &fairing)?;
    let density = seconds(&completer, &density)?;
    drop(completer);
    let completer = Completer::new(mesh.view(), &first.grouping, &Monitor::silent())?;
    seconds(&completer, &Options { method: Method::Smooth, ..first.clone() })?;
    let later = seconds(&completer, &first)?;
    drop(completer);
    let continued = made.holes.iter().filter(|h| !h.sources.is_empty()).count();
    println!(
        "| {} {} {resolution} {size} | {} | {} | {continued} of {} | {:.2} | {again:.2} | {one:.2} | {candidate:.2} | {fairing:.2} | {density:.2} | {later:.2} | {peak:.0} | {truth:.1} | {gap:.0} | {:.0} |",
        sample.name(),
        kind.name(),
        mesh.vertices.len(),
        made.vertices.len(),
        made.holes.len(),
        made.cpu_seconds,
        slowest_cancel(&mesh, &first, made.seconds),
    );
    Ok(())
}

/// CPU seconds of one more call.
fn seconds(completer: &Completer<'_>, options: &Options) -> Result<f64, Box<dyn Error>> {
    let clock = ProcessTime::now();
    let _: Completion = completer.complete(options, &Monitor::silent())?;
    Ok(clock.elapsed().as_secs_f64())
}

/// When which fraction was reported.
struct Log {
    clock: ProcessTime,
    notes: Mutex<Vec<(f64, f64)>>,
    verbose: bool,
}

impl Log {
    fn new() -> Self {
        let verbose = std::env::var_os("STAGES").is_some();
        Self { clock: ProcessTime::now(), notes: Mutex::new(vec![(0.0, 0.0)]), verbose }
    }

    fn note(&self, fraction: f64, stage: &str) -> bool {
        let now = self.clock.elapsed().as_secs_f64();
        let mut notes = self.notes.lock().unwrap();
        let (last, _) = notes[notes.len() - 1];
        if self.verbose {
            eprintln!("{now:8.4} +{:6.1} ms {fraction:.3} {stage}", 1e3 * (now - last));
        }
        notes.push((now, fraction));
        true
    }

    /// The worst ratio of time and fraction, whichever is more, once a tenth of the time is over, and
    /// the longest time between two reports in milliseconds.
    fn read(&self) -> (f64, f64) {
        let notes = self.notes.lock().unwrap();
        let (all, _) = notes[notes.len() - 1];
        let (mut worst, mut gap) = (1.0f64, 0.0f64);
        for pair in notes.windows(2) {
            gap = gap.max(pair[1].0 - pair[0].0);
            // What was on display just before the report, and just after it.
            for (time, fraction) in [(pair[1].0, pair[0].1), pair[1]] {
                let share = time / all;
                if share > 0.1 {
                    worst = worst.max(share / fraction).max(fraction / share);
                }
            }
        }
        (worst, 1e3 * gap)
    }
}

/// The longest wait for an answer to a cancel, in milliseconds, over moments spread over a call.
fn slowest_cancel(mesh: &SampleMesh, options: &Options, call: f64) -> f64 {
    let mut slowest = Duration::ZERO;
    for k in 0..MOMENTS {
        let moment = Duration::from_secs_f64(call * (f64::from(k) + 0.5) / f64::from(MOMENTS));
        let (start, monitor) = (Instant::now(), Monitor::silent());
        let (asked, answered) = std::thread::scope(|scope| {
            let asked = scope.spawn(|| {
                std::thread::sleep(moment.saturating_sub(start.elapsed()));
                let now = Instant::now();
                monitor.cancel();
                now
            });
            let _ = complete_mesh::complete_mesh_with(mesh.view(), options, &monitor);
            let answered = Instant::now();
            (asked.join().unwrap(), answered)
        });
        slowest = slowest.max(answered.saturating_duration_since(asked));
    }
    1e3 * slowest.as_secs_f64()
}
