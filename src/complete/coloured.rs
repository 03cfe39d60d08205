//! Park, Guo, Shin and Qin (2006), "Surface completion for shape and appearance", end of Sec. 5.2.2: colours
//! may come from another place than the shape does.
//!
//! Differences from the paper: only if the place that the shape comes from does not have the colours that are
//! known around the hole, and the other has.

use super::library::Library;
use super::smooth::Story;
use crate::error::Result;
use crate::matching::paint::Paint;
use crate::matching::rigid::Rigid;
use crate::matching::search::{align_closely, Target, POINTS};
use crate::matching::source::Source;
use crate::mesh::neighbourhood::Neighbourhood;
use crate::parallel;
use crate::result::{Origin, Seam, SourceReport};
use crate::synthesis::appearance::{unlike, TRUSTED};
use crate::synthesis::domain::Domain;
use crate::synthesis::join::SEEN;
use crate::synthesis::project::{place_of, project, Copy, Place};

/// How many times what they usually count colours count in a search for them: a difference of one spread is
/// then worth an edge. Of 255, a painted vase's colours are off by 5.1 at half an edge, 4.9 at one and at two.
pub const EMPHASIS: f64 = 7.0;
/// Places that are looked at.
const TRIED: usize = 12;
/// How much less of the ring's variance another place must leave (as a root) than what is believed whole, to
/// be worth its seam: with 1 smooth colours, which the rim tells well, were off by an eighth.
const BETTER: f64 = 0.5;

fn ranges(paint: &Paint) -> Vec<[f64; 2]> {
    let mut ranges = vec![[f64::INFINITY, f64::NEG_INFINITY]; paint.channels];
    for row in paint.rows.chunks_exact(paint.channels) {
        for (range, &x) in ranges.iter_mut().zip(row) {
            // Faster than `min` and `max`, which look at NaN: there is none.
            *range =
                [if x < range[0] { x } else { range[0] }, if x > range[1] { x } else { range[1] }];
        }
    }
    ranges
}

/// What the copies that the shape comes from leave of the colours known on the ring, see [`unlike`], if that is
/// too much to believe them whole; `None` also without colours.
pub fn lack(story: &Story, near: &Neighbourhood, library: &Library) -> Option<f64> {
    let (source, known) = (library.source(), library.known.paint.as_ref()?);
    let paint = source.paint.as_ref()?;
    let ranges = ranges(known);
    let (mut square, mut count) = (0.0, 0.0);
    for of_copy in story.ring.chunk_by(|a, b| a.source == b.source) {
        let (mut own, mut rows) = (Vec::new(), Vec::new());
        for seam in of_copy {
            // In ascending order, as they were taken.
            let Ok(face) = source.face_ids.binary_search(&seam.face) else { continue };
            own.push(known.row(near.vertices[seam.vertex as usize] as usize));
            paint.push_row(source.faces[face], seam.barycentric, &mut rows);
        }
        let copied: Vec<&[f64]> = rows.chunks_exact(paint.channels).collect();
        let vertices = story.sources[of_copy[0].source as usize].vertices as f64;
        square += vertices * unlike(&own, &copied, 0..paint.channels, &ranges).powi(2);
        count += vertices;
    }
    let rho = if count > 0.0 { (square / count).sqrt() } else { f64::INFINITY };
    (rho > TRUSTED.0).then_some(rho)
}

/// The same of one place over a domain, as some vertices of its ring tell. `ranges`: of the source's colours.
fn leaves(
    domain: &Domain,
    source: &Source,
    transform: &Rigid,
    ranges: &[[f64; 2]],
    ring: impl Iterator<Item = usize>,
) -> Option<f64> {
    let (known, paint) = (domain.paint.as_ref()?, source.paint.as_ref()?);
    let back = transform.inverse();
    let (mut own, mut rows) = (Vec::new(), Vec::new());
    for v in ring {
        if let Some((at, _)) = place_of(domain, source, &back, v) {
            own.push(known.row(v));
            paint.push_row(source.faces[at.face as usize], at.barycentric, &mut rows);
        }
    }
    let copied: Vec<&[f64]> = rows.chunks_exact(known.channels).collect();
    (!own.is_empty()).then(|| unlike(&own, &copied, 0..known.channels, ranges))
}

/// Takes the colours of the fill from the best of some places, if it is better than those that the shape comes
/// from, which leave `rho`, and surely to be believed; says whether it is. `domain`: the finished fill with what is
/// around it.
pub fn take_colours(
    story: &mut Story,
    domain: &Domain,
    library: &Library,
    (target, transforms): (&Target<'_>, &[Rigid]),
    rho: f64,
    threads: usize,
    check: &dyn Fn() -> Result<()>,
) -> Result<bool> {
    let source = library.source();
    let ranges = source.paint.as_ref().map_or(Vec::new(), ranges);
    let most = BETTER * f64::min(rho, TRUSTED.0);
    // A part of the ring tells which are worth a closer look: it takes a fifth of what they leave, at most.
    let step = domain.ring.len().div_ceil(POINTS[0]).max(1);
    let rough = |i: usize| {
        let ring = domain.ring.iter().copied().step_by(step);
        let left = leaves(domain, source, &transforms[i], &ranges, ring)?;
        (left < TRUSTED.1).then_some(transforms[i])
    };
    let tried = transforms.len().min(TRIED);
    let found = parallel::map(tried, threads, check, &rough)?;
    let found: Vec<Rigid> = found.into_iter().flatten().collect();
    let found = align_closely(&library.known, source, target, &found, threads, check)?;
    let one = |i: usize| {
        let left = leaves(domain, source, &found[i], &ranges, domain.ring.iter().copied())?;
        (left < most).then_some(())?;
        Some((left, project(domain, source, &found[i])?))
    };
    let found = parallel::map(found.len(), threads, check, &one)?;
    let best = found.into_iter().flatten().min_by(|a, b| a.0.total_cmp(&b.0));
    if let Some((left, copy)) = &best {
        tell(story, domain, source, copy, *left);
    }
    Ok(best.is_some())
}

fn tell(story: &mut Story, domain: &Domain, source: &Source, copy: &Copy, left: f64) {
    let number = story.sources.len() as u32;
    let confidence = 1.0 / (1.0 + left * left);
    let mut coloured = 0;
    let from = |(v, shape): (usize, &Origin)| match copy.places[v] {
        Some(at) => {
            coloured += 1;
            let face = source.face_ids[at.face as usize];
            Origin { face, barycentric: at.barycentric, source: number, confidence }
        }
        None => *shape,
    };
    story.colours = domain.fill.clone().zip(&story.origins).map(from).collect();
    let seam = |vertex: u32, v: usize| {
        let at = copy.places[v]?;
        let face = source.face_ids[at.face as usize];
        Some(Seam { vertex, source: number, face, barycentric: at.barycentric })
    };
    // All new vertices have this one source: only the rim lies beyond its border.
    story.seams.extend((0..domain.fill.start).filter_map(|v| seam(v as u32, v)));
    let step = domain.ring.len().div_ceil(SEEN).max(1);
    let ring = domain.ring.iter().step_by(step);
    story.ring.extend(ring.filter_map(|&v| seam(domain.near_vertex(v), v)));
    let square = domain.ring.iter().map(|&v| copy.heights[v].powi(2)).sum::<f64>();
    let error = (square / domain.ring.len().max(1) as f64).sqrt();
    let at = copy.places.iter().flatten().next();
    let given = |at: &Place| source.as_given(&copy.transform, source.face_ids[at.face as usize]);
    let transform = at.map_or(copy.transform, given);
    story.sources.push(SourceReport { transform, error, weight: 0.0, vertices: 0, coloured });
}
