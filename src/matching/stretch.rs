//! Feldmar and Ayache (1996), "Rigid, affine and locally affine registration of free-form surfaces":
//! a rigidly aligned source stretched and sheared a little, since no two eyes are quite alike.
//!
//! Differences from the paper: point-to-plane distances, and a prior instead of a choice between
//! rigid and affine: strains are normal with deviation STRAIN, gaps with that of the pairs, so
//! that a ring which fits says more than one that does not.

use super::icp::{find_partner, Hint, Partner, RingPoint, AGREE, STILL};
use super::rigid::Rigid;
use super::source::Source;
use glam::{DMat3, DVec3};
use nalgebra::{SMatrix, SVector};

/// Standard deviation of a strain. The two sides of a scanned face are alike to some per cent; 0.03 and
/// 0.05 did as well, 0.1 worse.
const STRAIN: f64 = 0.05;
/// Greatest strain, three deviations: what needs more is another thing, and the rigid copy stands.
pub const MOST: f64 = 3.0 * STRAIN;
/// Fewest pairs for the twelve unknowns.
const LEAST_PAIRS: usize = 24;

/// A ring point's pair: where the rigid transform puts it, the normal there, and the gaps along it now
/// and from that place.
struct Pair {
    place: DVec3,
    normal: DVec3,
    gap: f64,
    whole_gap: f64,
}

/// The affine transform (source to target) near the rigid one `start`. `radius` bounds how far a
/// partner may lie, in mesh units; `keep` is the share of the pairs used, the nearest ones.
pub fn stretch(
    source: &Source,
    ring: &[RingPoint],
    start: &Rigid,
    steps: usize,
    radius: f64,
    keep: f64,
) -> Rigid {
    let base = start.inverse();
    let mut back = base;
    let mut hints = vec![Hint::NOTHING; ring.len()];
    let middle = ring.iter().map(|p| base.point(p.0)).sum::<DVec3>() / ring.len().max(1) as f64;
    for _ in 0..steps {
        let mut pairs = find_pairs(source, ring, &base, &back, radius, &mut hints);
        if pairs.len() < LEAST_PAIRS {
            break;
        }
        pairs.sort_by(|a, b| a.gap.abs().total_cmp(&b.gap.abs()));
        pairs.truncate((keep * pairs.len() as f64) as usize);
        let Some(strain) = solve(&pairs, middle) else { break };
        let new = strain.after(&base);
        let moved = ring.iter().map(|p| new.point(p.0).distance(back.point(p.0)));
        let moved = moved.fold(0.0, f64::max);
        back = new;
        if moved < STILL * source.edge {
            break;
        }
    }
    let gram = (back.linear.transpose() * back.linear - DMat3::IDENTITY).to_cols_array();
    match gram.iter().all(|g| g.abs() < 2.0 * MOST) {
        true => back.inverse(),
        false => *start,
    }
}

fn find_pairs(
    source: &Source,
    ring: &[RingPoint],
    base: &Rigid,
    back: &Rigid,
    radius: f64,
    hints: &mut [Hint],
) -> Vec<Pair> {
    let mut pairs = Vec::with_capacity(ring.len());
    for (&(p, n, _), hint) in ring.iter().zip(hints) {
        let (place, now) = (base.point(p), back.point(p));
        // A strain of some per cent turns normals by less than what the test lets pass.
        let n = base.direction(n);
        if let Some((q, m, ..)) = find_partner(source, now, Partner::Surface, radius, hint) {
            if n.dot(m) > AGREE {
                let (gap, whole_gap) = ((q - now).dot(m), (q - place).dot(m));
                pairs.push(Pair { place, normal: m, gap, whole_gap });
            }
        }
    }
    pairs
}

/// min Σ (m · (t + A (p − p̄)) − gap)² + n σ²/STRAIN² |sym A|², σ² the mean square of the present gaps:
/// x ↦ x + A (x − p̄) + t.
fn solve(pairs: &[Pair], middle: DVec3) -> Option<Rigid> {
    let count = pairs.len() as f64;
    let noise = pairs.iter().map(|p| p.gap * p.gap).sum::<f64>();
    let extent = pairs.iter().map(|p| p.place.distance_squared(middle)).sum::<f64>();
    // Unknowns: t, then A by rows.
    let (mut a, mut b) = (SMatrix::<f64, 12, 12>::zeros(), SVector::<f64, 12>::zeros());
    for pair in pairs {
        let (m, d) = (pair.normal, pair.place - middle);
        let row = SVector::<f64, 12>::from_fn(|i, _| match i {
            0..3 => m[i],
            _ => m[i / 3 - 1] * d[i % 3],
        });
        a += row * row.transpose();
        b += pair.whole_gap * row;
    }
    let prior = noise / (STRAIN * STRAIN);
    for i in 0..12 {
        // Directions that a plane or a cylinder leaves free stay as they are.
        a[(i, i)] += 1e-6 * if i < 3 { count } else { extent };
    }
    for i in 0..3 {
        for j in 0..3 {
            let (this, other) = (3 + 3 * i + j, 3 + 3 * j + i);
            a[(this, this)] += 0.5 * prior;
            a[(this, other)] += 0.5 * prior;
        }
    }
    let x = a.cholesky()?.solve(&b);
    let strain = DMat3::from_cols_array_2d(&[0, 1, 2].map(|j| [0, 1, 2].map(|i| x[3 + 3 * i + j])));
    let linear = DMat3::IDENTITY + strain;
    Some(Rigid { linear, translation: middle + DVec3::new(x[0], x[1], x[2]) - linear * middle })
}

#[cfg(test)]
mod tests {
    use super::super::icp::{align, Pairing, KEEP};
    use super::super::source::tests::{hills, hilly_source, some_transform};
    use super::*;

    /// A ring on the hills, moved and stretched by 4 % along one axis: the rigid alignment leaves a
    /// gap, the stretched one much less, and the strain comes back.
    #[test]
    fn a_known_strain_comes_back() {
        let source = hilly_source(60);
        for mirrored in [false, true] {
            let rigid = some_transform(mirrored);
            let strain = DMat3::from_diagonal(DVec3::new(1.04, 1.0, 1.0));
            let truth = Rigid { linear: rigid.linear * strain, ..rigid };
            let ring: Vec<RingPoint> = (0..240)
                .map(|k| {
                    let (r, turn) = (0.3 + 0.05 * (k % 8) as f64, 0.1 * k as f64);
                    let (p, n) = hills(r * turn.cos(), r * turn.sin());
                    (truth.point(p), truth.inverse().linear.transpose() * n, 0.0)
                })
                .map(|(p, n, tint)| (p, n.normalize(), tint))
                .collect();
            let off = |t: &Rigid| {
                let gap =
                    |p: &RingPoint| t.inverse().point(p.0).distance(truth.inverse().point(p.0));
                ring.iter().map(gap).fold(0.0, f64::max)
            };
            let pairing = Pairing {
                source: &source,
                partner: Partner::Surface,
                radius: 0.2,
                keep: KEEP,
                paint: 0.0,
            };
            let plain = align(&ring, rigid, 20, &pairing);
            let stretched = stretch(&source, &ring, &plain, 20, 0.2, KEEP);
            println!("{:.5} {:.5} of an edge {:.5}", off(&plain), off(&stretched), source.edge);
            assert_eq!(stretched.is_mirrored(), mirrored);
            assert!(off(&stretched) < 0.3 * off(&plain));
        }
    }

    /// An exact copy is not stretched; too few pairs change nothing.
    #[test]
    fn nothing_to_stretch_stays() {
        let source = hilly_source(60);
        let truth = some_transform(false);
        let ring: Vec<RingPoint> = (0..160)
            .map(|k| {
                let (r, turn) = (0.4 + 0.05 * (k % 5) as f64, 0.1 * k as f64);
                let (p, n) = hills(r * turn.cos(), r * turn.sin());
                (truth.point(p), truth.direction(n), 0.0)
            })
            .collect();
        let same = stretch(&source, &ring, &truth, 20, 0.2, KEEP);
        // The source's triangles cut the hills' tops by as much as is left.
        let strain = (same.linear.transpose() * same.linear - DMat3::IDENTITY).to_cols_array();
        assert!(strain.iter().all(|s| s.abs() < 0.03), "{strain:?}");
        let moved = |p: &RingPoint| same.point(truth.inverse().point(p.0)).distance(p.0);
        assert!(ring.iter().all(|p| moved(p) < 0.1 * source.edge));
        let few = stretch(&source, &ring[..20], &truth, 20, 0.2, KEEP);
        assert!((few.linear - truth.linear).to_cols_array().iter().all(|x| x.abs() < 1e-12));
    }
}
