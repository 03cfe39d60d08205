//! Each source fitted to the ring by thin-plate smoothing of the mismatch, its stiffness chosen by
//! hiding the inner ring (generalised from Wahba 1990, "Spline Models for Observational Data":
//! smoothing parameter by cross-validation). Stands where Harary et al. 2014, Sec. 6, have the
//! offset field.
//!
//! With D the mismatch on the ring (known height minus the source's), the correction minimises
//!
//!   Σ_ring m (d − D)² + λ dᵀ L M⁻¹ L d.
//!
//! A soft λ follows the mismatch as a C1 surface would, a stiff one leaves little more than a
//! rigid motion: right for rough surfaces, whose mismatch is noise. What is left of the mismatch at
//! the rim fades inward by (L + M/ℓ²) e = 0.
//!
//! Differences from the paper: the offset field is harmonic there (C0, no choice of stiffness).

use super::domain::Domain;
use super::factor::Symmetric;
use super::project::Copy;
use crate::error::Result;
use crate::parallel;
use std::sync::Arc;

/// λ in units of 0.01 R⁴: from C1-like to nearly rigid.
const STIFFNESSES: [f64; 7] = [1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1.0, 10.0];
/// Which of them are tried for the plate over a whole long hole: of all seven it nearly always took one of these.
const PLATES: [usize; 2] = [0, 3];
/// An error greater than any, whose square is a number still.
const UNTRIED: f64 = 1e100;
/// Widths of the inner ring that is hidden, in hole radii, one after the other. Hiding whole sectors
/// instead asks for extrapolation, which the fill never does, and chose far too stiff.
const HIDDEN: [f64; 2] = [0.2, 0.3];
/// Length over which the rest fades, in hole radii.
const FADE: f64 = 0.12;
/// Copies that choose the stiffness: the best ones.
const CHOOSERS: usize = 5;

/// Copies fitted to the ring, with what was hidden says of each.
pub struct Fitted {
    /// Heights over the domain; 0 on the rim.
    pub heights: Vec<Vec<f64>>,
    /// Root mean square error where the ring was hidden, in mesh units, by copy.
    pub error: Vec<f64>,
    /// The same of the bare thin plate.
    pub plate_error: f64,
    /// What was left on the ring before it was made to fade, by copy.
    pub leftover: Vec<Vec<f64>>,
    /// Which of the stiffnesses was chosen for the copies, and which for the bare plate.
    pub chosen: Chosen,
    /// What was predicted at that stiffness where the ring was hidden.
    pub hidden: Vec<Hidden>,
}

/// Numbers of stiffnesses, the softest 0: of the copies and of the bare plate.
pub type Chosen = [usize; 2];

impl Fitted {
    /// The share α of a consensus in its blend with the bare plate that predicts best what was
    /// hidden: with e_p and e_c their errors, Σ m e_p (e_p − e_c) / Σ m (e_p − e_c)², 0 to 1; and the
    /// ratio of the consensus' error to the plate's.
    pub fn trust(&self, weights: &[f64]) -> (f64, f64) {
        let (mut product, mut square, mut own, mut bare) = (0.0, 0.0, 0.0, 0.0);
        for hidden in &self.hidden {
            for (i, m) in hidden.weights.iter().enumerate() {
                let e_c: f64 = weights.iter().zip(&hidden.errors).map(|(w, e)| w * e[i]).sum();
                let e_p = hidden.errors[weights.len()][i];
                product += m * e_p * (e_p - e_c);
                square += m * (e_p - e_c).powi(2);
                own += m * e_c * e_c;
                bare += m * e_p * e_p;
            }
        }
        let tiny = f64::MIN_POSITIVE;
        ((product / square.max(tiny)).clamp(0.0, 1.0), (own / bare.max(tiny)).sqrt())
    }
}

/// Which stiffnesses are tried: all, or what was chosen for nearly the same surface, that of several copies with those
/// next to it (one that is alone was one of many when it was chosen).
fn tried(before: Option<Chosen>, copies: usize) -> Vec<usize> {
    let beside = usize::from(copies > 1);
    let near = |s: &usize| {
        before.is_none_or(|[chosen, plate]| s.abs_diff(chosen) <= beside || *s == plate)
    };
    (0..STIFFNESSES.len()).filter(near).collect()
}

/// Fits all copies with one stiffness. `plate`: what the copies are judged by, if that is not the domain's own bare
/// plate. `before`: what was chosen in an earlier look. `Ok(None)` if a system cannot be factored.
pub fn fit(
    domain: &Domain,
    copies: &[Copy],
    plate: Option<&Plate>,
    before: Option<Chosen>,
    threads: usize,
    check: &dyn Fn(f64) -> Result<()>,
) -> Result<Option<Fitted>> {
    let (groups, tried) = (HIDDEN.len(), tried(before, copies.len()));
    let Some((mut energy, weight)) = system(domain, domain.radius, &|| check(0.0))? else {
        return Ok(None);
    };
    let unit = unit(domain.radius);
    let one = |trial: usize| {
        let (stiffness, width) = (tried[trial / groups], trial % groups);
        let reach = HIDDEN[width] * domain.radius;
        let stiff = unit * STIFFNESSES[stiffness];
        let mut hidden = hide(domain, (copies, plate.is_none()), &energy, &weight, stiff, reach)?;
        if let Some(plate) = plate {
            hidden.errors.push(plate.errors(domain, stiffness, width));
        }
        Some(hidden)
    };
    let errors = parallel::map_part(tried.len() * groups, threads, check, &one)?;
    let Some(mut errors) = errors.into_iter().collect::<Option<Vec<Hidden>>>() else {
        return Ok(None);
    };
    let by_stiffness: Vec<Vec<f64>> = (0..tried.len())
        .map(|s| pool(&errors[s * groups..(s + 1) * groups], copies.len() + 1))
        .collect();
    let chosen = choose(&by_stiffness, copies.len());
    let stop = || check(1.0);
    let made =
        apply(domain, copies, &mut energy, &weight, unit * STIFFNESSES[tried[chosen]], &stop)?;
    let Some(mut fitted) = made else {
        return Ok(None);
    };
    // The plate is at its best when it follows what is known, not at the copies' stiffness.
    let of_plate = |s: &usize| by_stiffness[*s][copies.len()];
    let best_plate = (0..tried.len()).min_by(|a, b| of_plate(a).total_cmp(&of_plate(b)));
    let best_plate = best_plate.unwrap_or(0);
    let plates: Vec<Vec<f64>> = (errors[best_plate * groups..(best_plate + 1) * groups].iter())
        .map(|h| h.errors[copies.len()].clone())
        .collect();
    fitted.hidden = errors.drain(chosen * groups..(chosen + 1) * groups).collect();
    for (hidden, plate) in fitted.hidden.iter_mut().zip(plates) {
        hidden.errors[copies.len()] = plate;
    }
    fitted.chosen = [tried[chosen], tried[best_plate]];
    fitted.error = by_stiffness[chosen][..copies.len()].to_vec();
    fitted.plate_error = by_stiffness[best_plate][copies.len()];
    Ok(Some(fitted))
}

/// What the bare plate over a whole long hole says where the ring was hidden: a window's own is cut off where the
/// window ends, and lies far off there.
pub struct Plate {
    /// Error by stiffness (see [`PLATES`]), then width, then vertex of the whole domain.
    errors: Arc<Vec<Vec<f64>>>,
    /// Vertex of the whole domain of each of the window's.
    parent: Vec<usize>,
}

impl Plate {
    /// Over a domain. `radius`: that of its windows. `Ok(None)` if a system cannot be factored.
    pub fn of(
        domain: &Domain,
        radius: f64,
        threads: usize,
        check: &dyn Fn() -> Result<()>,
    ) -> Result<Option<Self>> {
        let Some((energy, weight)) = system(domain, radius, check)? else { return Ok(None) };
        let one = |trial: usize| {
            let (stiffness, width) = (PLATES[trial / HIDDEN.len()], trial % HIDDEN.len());
            let (stiff, reach) = (unit(radius) * STIFFNESSES[stiffness], HIDDEN[width] * radius);
            let made = hide(domain, (&[], true), &energy, &weight, stiff, reach)?;
            let mut errors = vec![0.0; weight.len()];
            hidden_ring(domain, reach).zip(&made.errors[0]).for_each(|(v, e)| errors[v] = *e);
            Some(errors)
        };
        let trials = PLATES.len() * HIDDEN.len();
        let errors = parallel::map_part(trials, threads, &|_| check(), &one)?;
        let errors: Option<Vec<Vec<f64>>> = errors.into_iter().collect();
        Ok(errors.map(|errors| Self { errors: Arc::new(errors), parent: Vec::new() }))
    }

    /// Where a window's ring was hidden; [`UNTRIED`] at other stiffnesses.
    fn errors(&self, window: &Domain, stiffness: usize, width: usize) -> Vec<f64> {
        let all = PLATES.iter().position(|&s| s == stiffness);
        let all = all.map(|s| &self.errors[s * HIDDEN.len() + width]);
        let of_vertex = |v: usize| all.map_or(UNTRIED, |all| all[self.parent[v]]);
        hidden_ring(window, HIDDEN[width] * window.radius).map(of_vertex).collect()
    }

    /// As a window sees it, whose vertices are those of the whole domain.
    pub fn seen(&self, parent: &[usize]) -> Self {
        Self { errors: self.errors.clone(), parent: parent.to_vec() }
    }
}

/// What stiffnesses are multiplied by.
fn unit(radius: f64) -> f64 {
    0.01 * radius.powi(4)
}

/// The plate's energy and the weight of each known vertex.
fn system(
    domain: &Domain,
    radius: f64,
    check: &dyn Fn() -> Result<()>,
) -> Result<Option<(Symmetric, Vec<f64>)>> {
    let mut energy = domain.plate_energy();
    let mut weight = vec![0.0; domain.sheet.positions.len()];
    domain.ring.iter().for_each(|&v| weight[v] = domain.laplacian.mass[v]);
    check()?;
    // All workers then share it.
    energy.order();
    check()?;
    let usable =
        !domain.ring.is_empty() && energy.factor(unit(radius) * STIFFNESSES[3], &weight).is_some();
    check()?;
    Ok(usable.then_some((energy, weight)))
}

/// The part of the ring that is hidden.
fn hidden_ring(domain: &Domain, reach: f64) -> impl Iterator<Item = usize> + '_ {
    domain.ring.iter().copied().filter(move |&v| domain.rim_distance[v] < reach)
}

/// What was predicted where the ring was hidden.
pub struct Hidden {
    /// Weight of each hidden vertex: mass times say.
    weights: Vec<f64>,
    /// Error at each hidden vertex by copy, the bare plate last.
    errors: Vec<Vec<f64>>,
}

/// Geometric mean over the widths of the root mean square errors.
fn pool(hidden: &[Hidden], count: usize) -> Vec<f64> {
    let error = |h: &Hidden, k: usize| {
        let square: f64 = h.weights.iter().zip(&h.errors[k]).map(|(m, e)| m * e * e).sum();
        (square / h.weights.iter().sum::<f64>()).sqrt().max(f64::MIN_POSITIVE)
    };
    (0..count)
        .map(|k| {
            let seen = hidden.iter().filter(|h| !h.weights.is_empty());
            let logs: Vec<f64> = seen.map(|h| error(h, k).ln()).collect();
            (logs.iter().sum::<f64>() / logs.len().max(1) as f64).exp()
        })
        .collect()
}

/// The ring up to `reach` from the rim hidden from the fit at one stiffness; the bare plate, too, if wanted.
fn hide(
    domain: &Domain,
    (copies, plate): (&[Copy], bool),
    energy: &Symmetric,
    weight: &[f64],
    stiffness: f64,
    reach: f64,
) -> Option<Hidden> {
    let hidden: Vec<usize> = hidden_ring(domain, reach).collect();
    let mut seen = weight.to_vec();
    hidden.iter().for_each(|&v| seen[v] = 0.0);
    let mut columns = mismatches(domain, copies, &seen);
    let positions = &domain.sheet.positions;
    for d in (0..3).filter(|_| plate) {
        let from_centre = |v: usize| seen[v] * (positions[v] - domain.centre)[d];
        columns.push((0..positions.len()).map(from_centre).collect());
    }
    energy.factored(stiffness, &seen)?.solve(&mut columns);
    let off_plate = |&v: &usize| {
        let predicted = glam::DVec3::from([0, 1, 2].map(|d| columns[copies.len() + d][v]));
        (positions[v] - domain.centre - predicted).dot(domain.directions[v])
    };
    let mut errors: Vec<Vec<f64>> = copies
        .iter()
        .zip(&columns)
        .map(|(copy, d)| hidden.iter().map(|&v| -copy.heights[v] - d[v]).collect())
        .collect();
    if plate {
        errors.push(hidden.iter().map(off_plate).collect());
    }
    let weights = hidden.iter().map(|&v| domain.laplacian.mass[v] * domain.say[v]).collect();
    Some(Hidden { weights, errors })
}

/// Right-hand sides m D of all copies.
fn mismatches(domain: &Domain, copies: &[Copy], weight: &[f64]) -> Vec<Vec<f64>> {
    let n = domain.sheet.positions.len();
    copies
        .iter()
        .map(|copy| {
            let mut column = vec![0.0; n];
            domain.ring.iter().for_each(|&v| column[v] = -weight[v] * copy.heights[v]);
            column
        })
        .collect()
}

/// The stiffness with the least mean log error over the best copies; of those within a hundredth
/// of it the stiffest.
fn choose(errors: &[Vec<f64>], copies: usize) -> usize {
    let score = |e: &Vec<f64>| {
        let mut best = e[..copies].to_vec();
        best.sort_by(f64::total_cmp);
        best.truncate(CHOOSERS);
        best.iter().map(|x| x.max(f64::MIN_POSITIVE).ln()).sum::<f64>() / best.len().max(1) as f64
    };
    let scores: Vec<f64> = errors.iter().map(score).collect();
    let least = scores.iter().copied().fold(f64::INFINITY, f64::min);
    scores.iter().rposition(|&s| s <= least + 0.01).unwrap_or(0)
}

fn apply(
    domain: &Domain,
    copies: &[Copy],
    energy: &mut Symmetric,
    weight: &[f64],
    stiffness: f64,
    check: &dyn Fn() -> Result<()>,
) -> Result<Option<Fitted>> {
    check()?;
    let mut columns = mismatches(domain, copies, weight);
    let Some(factor) = energy.factor(stiffness, weight) else { return Ok(None) };
    check()?;
    factor.solve(&mut columns);
    check()?;
    let leftover: Vec<Vec<f64>> = copies
        .iter()
        .zip(&columns)
        .map(|(copy, d)| {
            let mut rest = vec![0.0; weight.len()];
            domain.ring.iter().for_each(|&v| rest[v] = -copy.heights[v] - d[v]);
            rest
        })
        .collect();
    let screen = 1.0 / (FADE * domain.radius).powi(2);
    let Some(faded) = carry_in(domain, &leftover, screen, check)? else { return Ok(None) };
    check()?;
    let heights = copies
        .iter()
        .enumerate()
        .map(|(k, copy)| {
            (0..weight.len()).map(|v| copy.heights[v] + columns[k][v] + faded[k][v]).collect()
        })
        .collect();
    Ok(Some(Fitted {
        heights,
        error: Vec::new(),
        plate_error: 0.0,
        leftover,
        chosen: [0; 2],
        hidden: Vec::new(),
    }))
}

/// (L + M/ℓ²) e = 0 in the fill, e given on the known vertices. `screen`: 1/ℓ², per square mesh unit. `None` if
/// that cannot be factored.
pub fn carry_in(
    domain: &Domain,
    given: &[Vec<f64>],
    screen: f64,
    check: &dyn Fn() -> Result<()>,
) -> Result<Option<Vec<Vec<f64>>>> {
    let l = &domain.laplacian;
    let first = domain.fill.start;
    let column = |v: usize| {
        let below = l.row(v).filter(|&(w, _)| w > v && domain.fill.contains(&w));
        let entries = below.map(|(w, x)| ((w - first) as u32, -x));
        std::iter::once(((v - first) as u32, l.diagonal[v])).chain(entries).collect()
    };
    let mut matrix = Symmetric::from_columns(domain.fill.clone().map(column).collect());
    let masses: Vec<f64> = domain.fill.clone().map(|v| screen * l.mass[v]).collect();
    let Some(factor) = matrix.factor(1.0, &masses) else { return Ok(None) };
    check()?;
    let from_rim = |given: &Vec<f64>| {
        let sum = |v: usize| {
            l.row(v).filter(|&(w, _)| domain.is_known(w)).map(|(w, x)| x * given[w]).sum::<f64>()
        };
        domain.fill.clone().map(sum).collect::<Vec<f64>>()
    };
    let mut inside: Vec<Vec<f64>> = given.iter().map(from_rim).collect();
    factor.solve(&mut inside);
    let whole = |(given, inside): (&Vec<f64>, Vec<f64>)| {
        let mut all = given.clone();
        all[domain.fill.clone()].copy_from_slice(&inside);
        all
    };
    Ok(Some(given.iter().zip(inside).map(whole).collect()))
}
