//! Dempster, Laird and Rubin (1977), expectation maximisation, for a mixture of three Gaussians on
//! a line, as Harary et al. (2014, sec. 7) take it to find how large a feature is.
//!
//! Differences from the papers: the start is given by quantiles, so that the result is the same
//! every time, and no component may become narrower than a thousandth of the spread of all.

/// Rounds at most; the start is near enough that some thirty do.
const ROUNDS: usize = 200;
/// The rounds end when the mean log likelihood grows by less than this.
const CONVERGED: f64 = 1e-9;
/// Least deviation of a component, in deviations of all values: a pile of equal values would else
/// draw one component into a point of infinite likelihood.
const NARROWEST: f64 = 1e-3;
/// Quantiles at which the components start: the background is most of a surface.
const START: [f64; 3] = [0.25, 0.75, 0.97];

/// One component.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gaussian {
    /// Its share of the whole, 0 to 1.
    pub weight: f64,
    /// Its mean, in the unit of the values.
    pub mean: f64,
    /// Its standard deviation.
    pub deviation: f64,
}

/// The three Gaussians that fit the values best, by ascending mean. `None` for fewer than three
/// values or values that are all the same.
pub fn fit_three_gaussians(values: &[f64]) -> Option<[Gaussian; 3]> {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let spread = (values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / n).sqrt();
    // Not a number: no values, or one that is none.
    if values.len() < 3 || spread.is_nan() || spread <= 1e-12 * mean.abs() {
        return None;
    }
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let mut mixture = START.map(|q| Gaussian {
        weight: 1.0 / 3.0,
        mean: sorted[(q * (n - 1.0)) as usize],
        deviation: 0.5 * spread,
    });
    let mut before = f64::NEG_INFINITY;
    for _ in 0..ROUNDS {
        let likelihood = step(&mut mixture, &sorted, NARROWEST * spread);
        if likelihood - before < CONVERGED {
            break;
        }
        before = likelihood;
    }
    mixture.sort_by(|a, b| a.mean.total_cmp(&b.mean));
    Some(mixture)
}

/// One expectation and one maximisation; returns the mean log likelihood before it.
fn step(mixture: &mut [Gaussian; 3], values: &[f64], narrowest: f64) -> f64 {
    let mut sums = [[0.0; 3]; 3];
    let mut likelihood = 0.0;
    for &x in values {
        // Logarithms, relative to the greatest: far from all means every density is 0 in f64.
        let log = mixture.map(|g| {
            let d = (x - g.mean) / g.deviation;
            (g.weight / g.deviation).ln() - 0.5 * d * d
        });
        let most = log.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let part = log.map(|l| (l - most).exp());
        let total: f64 = part.iter().sum();
        likelihood += most + total.ln();
        for k in 0..3 {
            let share = part[k] / total;
            // About the old mean, where the squares cancel less.
            let d = x - mixture[k].mean;
            sums[k][0] += share;
            sums[k][1] += share * d;
            sums[k][2] += share * d * d;
        }
    }
    let n = values.len() as f64;
    for (g, [share, first, second]) in mixture.iter_mut().zip(sums) {
        let share = share.max(f64::MIN_POSITIVE);
        let moved = first / share;
        g.mean += moved;
        g.deviation = (second / share - moved * moved).max(0.0).sqrt().max(narrowest);
        g.weight = share / n;
    }
    likelihood / n
}

/// The radius of a patch that holds a prominent feature (sec. 7): R = (1/(|e| μ₂) + 1) |e|, with μ₂
/// the mean of the middle one of three Gaussians through the greatest curvatures and |e| the mean
/// edge length. In mesh units; `None` where no curvature stands out.
pub fn patch_radius(curvatures: &[f64], mean_edge: f64) -> Option<f64> {
    let [_, prominent, _] = fit_three_gaussians(curvatures)?;
    let radius = (1.0 / (mean_edge * prominent.mean) + 1.0) * mean_edge;
    (radius.is_finite() && radius > 0.0).then_some(radius)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values spread as a Gaussian: its quantiles, by inverting the logistic approximation of it.
    fn spread(count: usize, mean: f64, deviation: f64) -> impl Iterator<Item = f64> {
        (0..count).map(move |i| {
            let q = (i as f64 + 0.5) / count as f64;
            // Twelve uniform numbers would do; a normal quantile is smoother (Acklam's centre).
            let t = (-2.0 * q.min(1.0 - q).ln()).sqrt();
            let tail = t
                - (2.515517 + 0.802853 * t + 0.010328 * t * t)
                    / (1.0 + 1.432788 * t + 0.189269 * t * t + 0.001308 * t * t * t);
            mean + deviation * if q < 0.5 { -tail } else { tail }
        })
    }

    #[test]
    fn a_known_mixture_comes_back() {
        let values: Vec<f64> = spread(6000, 1.0, 0.3)
            .chain(spread(3000, 5.0, 0.8))
            .chain(spread(1000, 12.0, 1.5))
            .collect();
        let found = fit_three_gaussians(&values).unwrap();
        for (g, (w, m, d)) in found.iter().zip([(0.6, 1.0, 0.3), (0.3, 5.0, 0.8), (0.1, 12.0, 1.5)])
        {
            assert!((g.weight - w).abs() < 0.01, "{found:?}");
            assert!((g.mean - m).abs() < 0.05 * m, "{found:?}");
            assert!((g.deviation - d).abs() < 0.1 * d, "{found:?}");
        }
        let radius = patch_radius(&values, 0.1).unwrap();
        assert!((radius - (1.0 / 5.0 + 0.1)).abs() < 0.01, "{radius}");
    }

    #[test]
    fn the_order_of_the_values_does_not_matter() {
        let values: Vec<f64> = spread(500, 0.0, 1.0).chain(spread(500, 4.0, 1.0)).collect();
        let turned: Vec<f64> = values.iter().rev().copied().collect();
        assert_eq!(fit_three_gaussians(&values), fit_three_gaussians(&turned));
    }

    #[test]
    fn nothing_to_fit_is_told() {
        assert_eq!(fit_three_gaussians(&[]), None);
        assert_eq!(fit_three_gaussians(&[1.0, 2.0]), None);
        assert_eq!(fit_three_gaussians(&[3.0; 50]), None);
        assert_eq!(fit_three_gaussians(&[f64::NAN; 50]), None);
        assert!(fit_three_gaussians(&[0.0, 0.0, 0.0, 0.0, 1.0]).is_some());
    }
}
