//! Colours of a fill put together of small pieces of the object, where no place has those around the hole: they
//! can only look right there, and a blur does not.

use super::library::Library;
use super::smooth::Story;
use crate::error::Result;
use crate::matching::source::Source;
use crate::result::{Origin, Seam, SourceReport};
use crate::synthesis::appearance::TRUSTED;
use crate::synthesis::domain::Domain;
use crate::synthesis::fit::carry_in;
use crate::synthesis::join::beside;
use crate::synthesis::project::Place;
use crate::synthesis::quilt::{tone, Pieces, Quilt};
use crate::synthesis::quilt_cut::{cut, lay, Over};

/// What the copies must leave of the ring (as a root) for that: less than half of them would be believed.
const UNLIKE: f64 = 0.5 * (TRUSTED.0 + TRUSTED.1);
/// Detail that a smooth fill must have, of that around the hole, to look right itself: colours that change
/// slowly are best carried in from the rim.
const SMOOTH: f64 = 0.75;
/// Radius of a patch, in lengths over which the colours change by their spread: half a wave of a stripe.
const SCALE: f64 = 3.0;
/// It is at least so many edges, and at most this part of the hole's radius.
const LEAST: f64 = 4.0;
const MOST: f64 = 0.75;
/// Confidence in colours that can only look right: of what is no nearer than a smooth fill.
const CONFIDENCE: f64 = 0.5;

/// Quilts the colours of a finished fill whose sources leave `rho` of the ring's.
pub fn quilt_colours(
    story: &mut Story,
    domain: &Domain,
    library: &Library,
    rho: f64,
    threads: usize,
    check: &dyn Fn() -> Result<()>,
) -> Result<()> {
    let source = library.source();
    let (Some(paint), Some(of_known)) = (&domain.paint, &library.known.paint) else {
        return Ok(());
    };
    let Some(axis) = main_axis(domain).filter(|_| rho > UNLIKE) else { return Ok(()) };
    let of_ring = |v: usize| if domain.is_known(v) { tone(&axis, paint.row(v)) } else { 0.0 };
    let tones: Vec<f64> = (0..domain.sheet.positions.len()).map(of_ring).collect();
    let Some(smooth) = carry_in(domain, &[tones], 0.0, check)? else { return Ok(()) };
    let Some(detail) = Detail::of(domain, &smooth[0]) else { return Ok(()) };
    if detail.smooth >= SMOOTH * detail.ring {
        return Ok(());
    }
    let most = (MOST * domain.radius).max(LEAST * domain.edge);
    let radius = (SCALE * detail.length).clamp(LEAST * domain.edge, most);
    let pieces = Pieces::new(source, &axis, radius, library.mirrored, threads, check)?;
    let Some(pieces) = pieces else { return Ok(()) };
    let of_known = |v: u32| tone(&axis, of_known.row(v as usize));
    let Some(mut quilt) = pieces.fill(domain, &library.known, &of_known, check)? else {
        return Ok(());
    };
    let over = lay(domain, source, &quilt, radius);
    quilt.labels = cut(domain, source, &over, quilt.labels, check)?;
    tell(story, domain, source, &quilt, &over);
    Ok(())
}

/// The direction among the channels in which the ring's colours differ most; `None` if they do not.
fn main_axis(domain: &Domain) -> Option<Vec<f64>> {
    let paint = domain.paint.as_ref()?;
    // The tint is that of the whole object, smoothed.
    let mut axis = vec![0.0; paint.channels];
    for &v in &domain.ring {
        axis.iter_mut().zip(paint.row(v)).for_each(|(a, x)| *a += paint.tint[v] * x);
    }
    let length = axis.iter().map(|a| a * a).sum::<f64>().sqrt();
    axis.iter_mut().for_each(|a| *a /= length);
    (length > 0.0).then_some(axis)
}

/// How numbers change along a surface.
struct Detail {
    /// Root mean square gradient on the ring, and in the fill.
    ring: f64,
    smooth: f64,
    /// Length over which those of the ring change by their spread, in mesh units.
    length: f64,
}

impl Detail {
    fn of(domain: &Domain, tones: &[f64]) -> Option<Self> {
        let slope = |v: usize, known: bool| {
            let beside = domain.laplacian.row(v).map(|(w, _)| w);
            let beside = beside.filter(move |&w| !known || domain.is_known(w));
            beside.map(move |w| {
                let along = domain.sheet.positions[v].distance(domain.sheet.positions[w]);
                ((tones[v] - tones[w]) / along).powi(2)
            })
        };
        let mean = |slopes: &mut dyn Iterator<Item = f64>| {
            let (mut sum, mut count) = (0.0, 0.0);
            slopes.for_each(|s| (sum, count) = (sum + s, count + 1.0));
            // Along an edge the square of a gradient is half of what it is along itself.
            f64::sqrt(2.0 * sum / count)
        };
        let ring = mean(&mut domain.ring.iter().flat_map(|&v| slope(v, true)));
        let smooth = mean(&mut domain.fill.clone().flat_map(|v| slope(v, false)));
        let n = domain.ring.len() as f64;
        let middle = domain.ring.iter().map(|&v| tones[v]).sum::<f64>() / n;
        let spread = domain.ring.iter().map(|&v| (tones[v] - middle).powi(2)).sum::<f64>() / n;
        let length = spread.sqrt() / ring;
        (length.is_finite() && smooth.is_finite()).then_some(Self { ring, smooth, length })
    }
}

fn tell(story: &mut Story, domain: &Domain, source: &Source, quilt: &Quilt, over: &[Over]) {
    // Only pieces that some vertex has are reported.
    let mut used: Vec<usize> = quilt.labels.clone();
    used.sort_unstable();
    used.dedup();
    let first = story.sources.len();
    let number = |label: usize| (first + used.partition_point(|&l| l < label)) as u32;
    let face_of = |at: &Place| source.face_ids[at.face as usize];
    let mut reports: Vec<SourceReport> = Vec::new();
    for &label in &used {
        let face = over[label].iter().flatten().next().map_or(0, face_of);
        let transform = source.as_given(&quilt.pieces[label].0, face);
        let (error, weight) = (0.0, 0.0);
        reports.push(SourceReport { transform, error, weight, vertices: 0, coloured: 0 });
    }
    let mut colours = Vec::new();
    for (i, v) in domain.fill.clone().enumerate() {
        let label = quilt.labels[i];
        let Some(at) = &over[label][v] else {
            colours.push(story.origins[i]);
            continue;
        };
        let (face, source) = (face_of(at), number(label));
        reports[source as usize - first].coloured += 1;
        let barycentric = at.barycentric;
        colours.push(Origin { face, barycentric, source, confidence: CONFIDENCE });
    }
    story.colours = colours;
    let laid = |(&label, v): (&usize, usize)| over[label][v].is_some().then_some(label);
    let labels: Vec<Option<usize>> =
        quilt.labels.iter().zip(domain.fill.clone()).map(laid).collect();
    story.seams.extend(beside(domain, &labels).into_iter().filter_map(|(w, label)| {
        let at = over[label][w].as_ref()?;
        let (face, barycentric) = (face_of(at), at.barycentric);
        Some(Seam { vertex: w as u32, source: number(label), face, barycentric })
    }));
    story.sources.extend(reports);
}
