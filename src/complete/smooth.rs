//! The smooth completion of one hole: triangulation, refinement, fairing, each checked.
//!
//! `Fairing::Auto` works in two steps. On a coarse fill the thin plate (C1) and the triharmonic
//! surface (C2) both predict the rim and a few rings that are hidden from them; the blend that
//! predicts best is kept. On the fine fill the thin plate is solved again and the difference
//! that the blend made is added. Should the result meet itself or the mesh and resist repair,
//! the thin plate, the membrane and the plain refined triangulation are tried in turn, and then
//! all of them from a coarser triangulation.

use super::check::{Obstacles, Rounding};
use super::initial::InitialFaces;
use crate::error::Result;
use crate::fill::even::refine_for;
use crate::fill::fairing::{fair, fair_both, fair_from, predict_hidden, Plate};
use crate::fill::outline::Outline;
use crate::fill::patch::Patch;
use crate::fill::polygon::join_loops;
use crate::fill::refine::{refine, split_taken};
use crate::fill::sheet::{Band, Incidences, Sheet};
use crate::fill::triangulate::{triangulate, ALL_PAIRS};
use crate::mesh::neighbourhood::{FacePlaces, Neighbourhood};
use crate::options::{Fairing, Method, Sizing};
use crate::progress::Pace;
use crate::result::{Origin, Seam, SourceReport};
use glam::DVec3;

/// Share of the hole's radius that is hidden from the predictions: measured with 0.05, 0.1, 0.2
/// and 0.3; nearer the choice is noise, farther it is about another surface.
const HIDDEN_SHARE: f64 = 0.1;
/// Wanted edge length of the coarse fill, in fine ones: the choice needs the low frequencies only,
/// and 2, 3 and 4 choose equally well.
const COARSE: f64 = 4.0;
/// Holes with less radius than this many edges have a finer one: `HALF`.
const SMALL: f64 = 12.0;
/// The same for small holes. With 4 here, too, the fill of a broken edge is a third worse.
const HALF: f64 = 2.0;
/// Holes with less radius than this many edges have no coarser fill worth the name.
const TINY: f64 = 5.0;
/// Holes with less radius than this many edges have one of four edges; with twice, of eight; and so
/// on: what it costs to choose does not grow with the hole.
const LARGE: f64 = 96.0;
/// Vertices of the surroundings that are hidden at most, but always a ring.
const MOST_HIDDEN: usize = 3000;
/// Unknowns of a thin plate that are solved at once in any mesh: its factor takes some 5 MiB; that of a
/// triharmonic surface has twice as many entries a row.
const AT_ONCE: usize = 4000;
/// Or one for so many vertices of the input: a factor of twice its arrays.
const ROOM: usize = 16;
/// Smoothing length of the smoothed plate, in hole radii; and its band.
const SMOOTHING: f64 = 0.1;
const SOFT_BAND: f64 = 0.4;

/// What all holes of a call share.
pub struct Surroundings<'a> {
    /// The caller's initial completion.
    pub initial: Option<&'a InitialFaces<'a>>,
    /// How many vertices the whole mesh has.
    pub input_vertices: usize,
    /// Whether and when fills get vertices as dense as a cloud's points.
    pub spreading: Spreading,
    /// The mesh near the holes.
    pub near: &'a Neighbourhood,
    /// Its faces by vertex.
    pub incidence: &'a Incidences<'a>,
    /// Its faces by place.
    pub places: &'a FacePlaces,
    /// The caller's choice of surface.
    pub fairing: Fairing,
    /// The caller's choice of size.
    pub sizing: Sizing,
    /// Precision of the result.
    pub rounding: Rounding,
}

/// When the vertices of a fill are spread evenly, as densely as the points around it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Spreading {
    /// Never: it is a mesh's.
    Never,
    /// When the smooth fill is refined.
    Early,
    /// When it is finished, by the method that goes on from the smooth fill.
    Late,
}

impl Surroundings<'_> {
    /// Whether the smooth fill is what comes out without options.
    pub fn is_standard(&self) -> bool {
        (self.fairing, self.sizing) == (Fairing::Auto, Sizing::Surroundings)
    }

    /// Whether the standard fill has not many more vertices than this one, with edges of a mean length
    /// at its rim: it may have millions where a coarse fill was asked for.
    pub fn is_near_standard(&self, edge: f64) -> bool {
        match self.sizing {
            Sizing::Surroundings => true,
            Sizing::Scaled(factor) => factor <= COARSEST,
            Sizing::EdgeLength(length) => length <= COARSEST * edge,
            Sizing::None => false,
        }
    }

    /// The same without options.
    pub fn standard(&self) -> Self {
        Self { initial: None, fairing: Fairing::Auto, sizing: Sizing::Surroundings, ..*self }
    }
}

/// Edges longer than standard by more than this factor are of a fill with less than a quarter of the
/// vertices: making the standard one as well could cost more than it saves.
const COARSEST: f64 = 2.0;

/// A finished fill. New vertices lie where the caller's precision puts them.
#[derive(Clone)]
pub struct Fill {
    /// The rim.
    pub outline: Outline,
    /// The triangles.
    pub patch: Patch,
    /// The fairing that was used.
    pub fairing: Fairing,
    /// What made the patch as it is now.
    pub method: Method,
    /// See [`crate::HoleReport::coherence_error`].
    pub coherence_error: Option<[f64; 2]>,
    /// See [`crate::HoleReport::candidates`].
    pub candidates: usize,
    /// Where it was continued from, unless it is smooth.
    pub story: Option<Story>,
}

/// Where a fill was continued from.
#[derive(Clone)]
pub struct Story {
    /// For each new vertex of the patch.
    pub origins: Vec<Origin>,
    /// See [`crate::Completion::colour_origins`].
    pub colours: Vec<Origin>,
    /// See [`crate::HoleReport::sources`].
    pub sources: Vec<SourceReport>,
    /// See [`crate::HoleReport::seams`]; vertices are the patch's.
    pub seams: Vec<Seam>,
    /// See [`crate::HoleReport::ring`]; vertices are the neighbourhood's.
    pub ring: Vec<Seam>,
    /// See [`crate::HoleReport::confidence`].
    pub confidence: f64,
    /// See [`crate::HoleReport::coherence_error`].
    pub coherence_error: Option<[f64; 2]>,
    /// How far the shape leans on the smooth fill, whose vertices it then has: 0 not at all, 1 wherever no
    /// copy says anything.
    pub doubt: f64,
}

impl Story {
    /// Of a patch that comes from nowhere.
    pub fn nothing(patch: &Patch) -> Self {
        Self {
            origins: vec![Origin::NOWHERE; patch.new_count()],
            colours: Vec::new(),
            sources: Vec::new(),
            seams: Vec::new(),
            ring: Vec::new(),
            confidence: 0.0,
            coherence_error: None,
            doubt: 1.0,
        }
    }
}

/// Fills one hole whose loops are given in neighbourhood vertices. `check` is called between the
/// stages and may cancel. The inner error says why no fill keeps the contract.
pub fn fill_hole(
    around: &Surroundings<'_>,
    loops: &[Vec<u32>],
    obstacles: &Obstacles<'_>,
    check: &dyn Fn(f64) -> Result<()>,
) -> Result<std::result::Result<Fill, String>> {
    let mut outline = Outline::new(around.near, &around.incidence.get(), loops);
    if around.spreading != Spreading::Never && around.sizing != Sizing::None {
        outline.measure_share(around.near);
        outline.is_even = around.spreading == Spreading::Early;
    }
    match around.sizing {
        Sizing::Scaled(f) => outline.sizes.iter_mut().for_each(|s| *s *= f),
        Sizing::EdgeLength(l) => outline.sizes.fill(l),
        Sizing::Surroundings | Sizing::None => {}
    }
    let polygon = join_loops(&outline.positions, &outline.rims);
    let attempts = match (around.fairing, around.sizing) {
        (Fairing::Auto, Sizing::None) => vec![Fairing::None],
        (Fairing::Auto, _) => vec![Fairing::Auto, Fairing::C1, Fairing::C0, Fairing::None],
        (one, _) => vec![one],
    };
    let ask = || check(0.2);
    let mut pace = Pace::new(&ask);
    let mut reason = String::from("its rim has no triangulation");
    // Each search is another only for polygons of some sizes.
    let is_another = |round: usize| match round {
        0 => true,
        1 => !ALL_PAIRS[1].holds(&polygon),
        _ => ALL_PAIRS[2].holds(&polygon) && !ALL_PAIRS[0].holds(&polygon),
    };
    for round in (0..ALL_PAIRS.len()).filter(|&round| is_another(round)) {
        let found =
            triangulate(&outline.positions, &outline.sizes, &polygon, ALL_PAIRS[round], &mut pace)?;
        let Some(first) = found else { continue };
        check(0.2)?;
        // What the plain attempts start from, refined once.
        let mut refined = Refined::Not;
        for &attempt in &attempts {
            let made = match make(around, &outline, &first, &mut refined, attempt, check)? {
                Ok(patch) => obstacles.settle(around, patch, &|| check(0.9))?,
                Err(reason) => Err(reason),
            };
            check(0.95)?;
            match made {
                Ok(mut patch) => {
                    patch.offsets = vec![DVec3::ZERO; patch.positions.len()];
                    // The blend is a thin plate with a share of curvature.
                    let fairing = if attempt == Fairing::Auto { Fairing::C1 } else { attempt };
                    let (method, coherence_error, story) = (Method::Smooth, None, None);
                    return Ok(Ok(Fill {
                        outline,
                        patch,
                        fairing,
                        method,
                        coherence_error,
                        candidates: 0,
                        story,
                    }));
                }
                Err(why) => reason = why,
            }
        }
    }
    Ok(Err(reason))
}

/// New vertices that a fill of some area asks for, about; 0 where the caller chose their size. A vertex of
/// an equilateral net has √3/2 square edges to itself, one of a refined patch somewhat less.
fn asks_for(around: &Surroundings<'_>, outline: &Outline, area: f64) -> f64 {
    let edge = outline.mean_size();
    match around.sizing {
        Sizing::Surroundings => area / (0.75 * edge * edge),
        _ => 0.0,
    }
}

/// Area of a coarse fill, in that of the triangulation it came from, from which on it is no surface to
/// refine: a half sphere over a flat rim has twice.
const SWOLLEN: f64 = 3.0;

/// Why an attempt fails before its check.
const TOO_MANY: &str = "its wanted edge length asks for too many vertices";
const SWELLS: &str = "its surface swells or folds";
const NO_FACTOR: &str = "the fairing's system is not positive definite";

/// A triangulation's refinement, which several attempts start from.
enum Refined {
    Not,
    Patch(Patch),
    /// So large that it is not kept: how many new vertices it has.
    Count(usize),
}

/// One attempt: refined and faired, not yet checked.
fn make(
    around: &Surroundings<'_>,
    outline: &Outline,
    first: &Patch,
    refined: &mut Refined,
    fairing: Fairing,
    check: &dyn Fn(f64) -> Result<()>,
) -> Result<std::result::Result<Patch, String>> {
    if fairing == Fairing::Auto {
        return auto(around, outline, first.clone(), check);
    }
    let plate = plate_of(fairing, outline);
    let in_steps = |count: usize| {
        let can = plate.filter(|p| !p.is_soft() && around.sizing != Sizing::None);
        can.is_some_and(|p| count > most_at_once(around, p))
    };
    if let (Refined::Count(count), Some(plate)) = (&*refined, plate) {
        if in_steps(*count) {
            return approach(around, outline, first.clone(), *count, plate, check);
        }
    }
    let mut patch = match &*refined {
        Refined::Patch(patch) => patch.clone(),
        _ => {
            let mut patch = first.clone();
            if around.sizing == Sizing::None {
                split_taken(&mut patch, &outline.taken);
                patch.compact();
            } else if !refine(&mut patch, &outline.taken, 4, &mut Pace::new(&|| check(0.25)))? {
                return Ok(Err(TOO_MANY.into()));
            }
            patch
        }
    };
    let Some(plate) = plate else { return Ok(Ok(patch)) };
    let count = patch.new_count();
    if in_steps(count) {
        *refined = Refined::Count(count);
        drop(patch);
        return approach(around, outline, first.clone(), count, plate, check);
    }
    // Only `Auto` comes back for another.
    if around.fairing == Fairing::Auto && matches!(refined, Refined::Not) {
        *refined = Refined::Patch(patch.clone());
    }
    let band = band_for(around, outline, patch.area(), plate);
    for pass in 0..2 {
        check(0.3 + 0.3 * f64::from(pass))?;
        let sheet = Sheet::new(&patch, &band, around.near);
        let Some(moved) = fair(sheet, plate, outline.mean_size()) else {
            return Ok(Err(NO_FACTOR.into()));
        };
        place(&mut patch, &moved);
        let again = pass == 0 && around.sizing != Sizing::None;
        if again && !refine_for(outline, &mut patch, 2, &mut Pace::new(&|| check(0.5)))? {
            return Ok(Err(TOO_MANY.into()));
        }
    }
    Ok(Ok(patch))
}

/// A fill of many vertices, about `count`: faired at once while it is coarse enough for that, then
/// finer and finer.
fn approach(
    around: &Surroundings<'_>,
    outline: &Outline,
    mut patch: Patch,
    count: usize,
    plate: Plate,
    check: &dyn Fn(f64) -> Result<()>,
) -> Result<std::result::Result<Patch, String>> {
    let band = &band_for(around, outline, patch.area(), plate);
    let mut coarse = HALF;
    while count as f64 > coarse * coarse * most_at_once(around, plate) as f64 {
        coarse *= 2.0;
    }
    patch.sizes.iter_mut().for_each(|s| *s *= coarse);
    if !refine(&mut patch, &outline.taken, 4, &mut Pace::new(&|| check(0.25)))? {
        return Ok(Err(TOO_MANY.into()));
    }
    check(0.3)?;
    let sheet = Sheet::new(&patch, band, around.near);
    let Some(moved) = fair(sheet, plate, outline.mean_size()) else {
        return Ok(Err(NO_FACTOR.into()));
    };
    let area = patch.area();
    place(&mut patch, &moved);
    if patch.area() > SWOLLEN * area {
        return Ok(Err(SWELLS.into()));
    }
    descend(around, outline, patch, coarse, plate, band, check)
}

/// From a faired patch of `coarse` times the wanted edge length to one of the wanted length. The
/// offsets are not the plate's: it is solved without them and they are added again.
fn descend(
    around: &Surroundings<'_>,
    outline: &Outline,
    mut patch: Patch,
    mut coarse: f64,
    plate: Plate,
    band: &Band,
    check: &dyn Fn(f64) -> Result<()>,
) -> Result<std::result::Result<Patch, String>> {
    let edge = outline.mean_size();
    let rim = patch.rim_count;
    // A vertex of an equilateral net has √3/2 square edges to itself.
    let most = most_at_once(around, plate);
    let in_steps = patch.area() > 0.75 * edge * edge * most as f64;
    loop {
        let step = if in_steps { coarse.min(2.0) } else { coarse };
        coarse /= step;
        patch.sizes.iter_mut().for_each(|s| *s /= step);
        let ask = || check(0.55);
        let pace = &mut Pace::new(&ask);
        let refined = match coarse <= 1.0 {
            true => refine_for(outline, &mut patch, 3, pace)?,
            false => refine(&mut patch, &outline.taken, 3, pace)?,
        };
        if !refined {
            return Ok(Err(TOO_MANY.into()));
        }
        check(0.6)?;
        let mut sheet = Sheet::take(&mut patch, band, around.near);
        if fair_from(&mut sheet, &patch.offsets, plate, most).is_none() {
            return Ok(Err(NO_FACTOR.into()));
        }
        sheet.give_back(&mut patch);
        for v in rim..patch.positions.len() {
            patch.positions[v] += patch.offsets.get(v).copied().unwrap_or_default();
        }
        if coarse <= 1.0 {
            return Ok(Ok(patch));
        }
    }
}

/// The blend of thin plate and triharmonic surface that the surroundings ask for.
fn auto(
    around: &Surroundings<'_>,
    outline: &Outline,
    mut patch: Patch,
    check: &dyn Fn(f64) -> Result<()>,
) -> Result<std::result::Result<Patch, String>> {
    let near = around.near;
    let edge = outline.mean_size();
    let radius = outline.radius();
    let coarse = match radius / edge {
        r if r > SMALL => COARSE * (r / LARGE).max(1.0).log2().ceil().exp2(),
        r if r > TINY => HALF,
        _ => 1.0,
    };
    let area = patch.area();
    // New vertices inherit their wanted length from the rim's.
    patch.sizes.iter_mut().for_each(|s| *s *= coarse);
    if !refine(&mut patch, &outline.taken, 3, &mut Pace::new(&|| check(0.25)))? {
        return Ok(Err(TOO_MANY.into()));
    }
    check(0.3)?;
    let rings = (HIDDEN_SHARE * radius / edge).round() as usize;
    let hidden = rings.min(MOST_HIDDEN / outline.vertices.len().max(1)).max(1);
    let band = band_of(around, outline, patch.area(), hidden + 2);
    let sheet = Sheet::new(&patch, &band, near);
    drop(band);
    let Some(prediction) = predict_hidden(sheet, hidden, edge) else {
        return Ok(Err(NO_FACTOR.into()));
    };
    check(0.5)?;
    place(&mut patch, &prediction.positions);
    let band = band_of(around, outline, patch.area(), 2);
    if prediction.share > 0.0 {
        let sheet = Sheet::new(&patch, &band, near);
        if let Some([thin, curved]) = fair_both(&sheet) {
            patch.offsets = vec![DVec3::ZERO; patch.positions.len()];
            let rim = patch.rim_count;
            for (i, (a, b)) in thin.iter().zip(&curved).enumerate() {
                patch.positions[rim + i] = a.lerp(*b, prediction.share);
                patch.offsets[rim + i] = prediction.share * (*b - *a);
            }
        }
    }
    if patch.area() > SWOLLEN * area {
        return Ok(Err(SWELLS.into()));
    }
    // In full the curvature is worth a solution of its own.
    let whole = prediction.share == 1.0;
    if whole {
        patch.offsets = Vec::new();
    }
    let plate = if whole { Plate::Triharmonic } else { Plate::Thin };
    descend(around, outline, patch, coarse, plate, &band, check)
}

/// Unknowns of a system that is solved at once: the factor shall not outweigh the input's arrays.
fn most_at_once(around: &Surroundings<'_>, plate: Plate) -> usize {
    let share = if plate == Plate::Triharmonic { 2 } else { 1 };
    (around.input_vertices / ROOM).max(AT_ONCE) / share
}

fn place(patch: &mut Patch, moved: &[DVec3]) {
    let rim = patch.rim_count;
    patch.positions[rim..].copy_from_slice(moved);
}

fn plate_of(fairing: Fairing, outline: &Outline) -> Option<Plate> {
    match fairing {
        Fairing::Auto | Fairing::None => None,
        Fairing::C0 => Some(Plate::Membrane),
        Fairing::C1 => Some(Plate::Thin),
        Fairing::C2 => Some(Plate::Triharmonic),
        Fairing::LeastSquares => Some(Plate::LeastSquares),
        Fairing::SmoothedPlate => Some(Plate::Smoothed(SMOOTHING * outline.radius())),
    }
}

/// The known surface that a plate needs around a fill of some area.
fn band_for(around: &Surroundings<'_>, outline: &Outline, area: f64, plate: Plate) -> Band {
    let soft = (SOFT_BAND * outline.radius() / outline.mean_size()).ceil().max(3.0) as usize;
    let rings = plate.rings() + if plate.is_soft() { soft } else { 0 };
    band_of(around, outline, area, rings)
}

fn band_of(around: &Surroundings<'_>, outline: &Outline, area: f64, rings: usize) -> Band {
    let band = Band::grow(around.near, &around.incidence.get(), &outline.vertices, rings);
    // Its factor needs the room, and making them again is nothing beside it.
    if asks_for(around, outline, area) * ROOM as f64 > around.input_vertices as f64 {
        around.incidence.forget();
    }
    band
}
