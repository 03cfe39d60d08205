//! Rusinkiewicz and Levoy (2001), "Efficient variants of the ICP algorithm": point-to-plane, with
//! trimming, between the known ring of a hole and a place on the source.
//!
//! Differences from the paper: only known points take part, never the initial completion, which
//! would be matched to what is as smooth as itself. Points whose nearest source point lies on a
//! boundary loop say nothing and are dropped. Where there are colours, each pair also asks that the
//! tints agree (Park, Zhou, Koltun 2017, "Colored point cloud registration revisited").

use super::paint::{Paint, EDGES, FARTHEST};
use super::rigid::Rigid;
use super::source::Source;
use crate::intersect::closest_point_on_triangle;
use glam::{DMat3, DQuat, DVec3};
use nalgebra::{SMatrix, SVector};

/// Least cosine between the normals of a pair.
pub const AGREE: f64 = 0.3;
/// Share of the pairs that is used by default, the nearest ones.
pub const KEEP: f64 = 0.85;
/// An iteration that moves no point by more than this part of an edge is the last.
pub const STILL: f64 = 5e-3;
/// The same where partners are vertices, which decides only what is looked at closer.
const ROUGHLY: f64 = 3e-2;
/// No face, no vertex.
const NONE: u32 = u32::MAX;
/// A point that has moved by less than this part of an edge since its partner was looked for keeps it.
const KEPT: f64 = 0.4;
/// Least barycentric coordinate of a point inside a face.
const INSIDE: f64 = 1e-6;

/// What is known of a ring point's partner from earlier steps.
#[derive(Clone, Copy)]
pub struct Hint {
    /// A vertex or a face: the next is hardly farther. [`NONE`]: none was near.
    found: u32,
    /// Where the point was then, on the source; nowhere before the first step.
    of: DVec3,
}

impl Hint {
    /// Of a point without earlier steps.
    pub const NOTHING: Self = Self { found: NONE, of: DVec3::INFINITY };

    /// For a search of the nearest vertex to a point that was one of those of an alignment: it is no farther than
    /// what was found there.
    fn for_vertex(self, source: &Source, partner: Partner, p: DVec3) -> Self {
        if self.found == NONE || partner == Partner::Vertex {
            return Self { of: DVec3::INFINITY, ..self };
        }
        let off = |v: &u32| source.positions[*v as usize].distance_squared(p);
        let corners = source.faces[self.found as usize];
        let nearest = corners.into_iter().min_by(|a, b| off(a).total_cmp(&off(b)));
        Self { found: nearest.unwrap_or(NONE), ..Self::NOTHING }
    }
}

/// A known point of the ring with its normal and its tint (0 without colours).
pub type RingPoint = (DVec3, DVec3, f64);

/// A point of the source with its normal, its tint and the tint's slope.
pub type Met = (DVec3, DVec3, f64, DVec3);

/// How a ring point finds its partner.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Partner {
    /// The tangent plane at the nearest source vertex: fast.
    Vertex,
    /// The nearest point on the source's triangles.
    Surface,
}

/// Improves a transform (source to target) by up to `steps` iterations.
pub fn align(ring: &[RingPoint], start: Rigid, steps: usize, pairing: &Pairing<'_>) -> Rigid {
    align_with(ring, start, steps, pairing, &mut vec![Hint::NOTHING; ring.len()])
}

/// The same, with a hint for each point of the ring, which is left as the last step has it.
pub fn align_with(
    ring: &[RingPoint],
    start: Rigid,
    steps: usize,
    pairing: &Pairing<'_>,
    hints: &mut [Hint],
) -> Rigid {
    // From target to source: the source's trees do not move.
    let mut back = start.inverse();
    let extent = ring.iter().fold(0.0, |d: f64, (p, ..)| d.max(p.distance(ring[0].0)));
    let still = match pairing.partner {
        Partner::Vertex => ROUGHLY,
        Partner::Surface => STILL,
    };
    for _ in 0..steps {
        let step = improve(ring, &back, pairing, hints);
        let Some(step) = step else { break };
        let turn = (step.linear - DMat3::IDENTITY).to_cols_array();
        let turned = turn.iter().map(|x| x * x).sum::<f64>().sqrt() * extent;
        let centre = back.point(ring[0].0);
        let moved = step.point(centre).distance(centre);
        back = step.after(&back);
        if turned + moved < still * pairing.source.edge {
            break;
        }
    }
    back.inverse()
}

fn improve(
    ring: &[RingPoint],
    back: &Rigid,
    pairing: &Pairing<'_>,
    hints: &mut [Hint],
) -> Option<Rigid> {
    let &Pairing { radius, paint, .. } = pairing;
    let (pairs, middle) = pairing.find(ring, back, hints)?;
    let (mut a, b) = normal_equations(&pairs, paint > 0.0, |p, m| {
        let c = (p - middle).cross(m);
        [c.x, c.y, c.z, m.x, m.y, m.z]
    });
    // A plane or a cylinder leaves directions free: they stay as they are.
    let scale = pairs.iter().map(|p| p.place.distance_squared(middle)).sum::<f64>();
    for k in 0..6 {
        a[(k, k)] += 1e-6 * if k < 3 { scale } else { pairs.len() as f64 };
    }
    let x = a.cholesky()?.solve(&b);
    let turn = DVec3::new(x[0], x[1], x[2]);
    // A larger turn than 20° is beyond the linearisation.
    let angle = turn.length().min(0.35);
    let rotation = DMat3::from_quat(DQuat::from_scaled_axis(turn.normalize_or_zero() * angle));
    let mut shift = DVec3::new(x[3], x[4], x[5]);
    if paint > 0.0 {
        // Farther than this no slope says anything.
        shift = shift.clamp_length_max(0.2 * radius);
    }
    Some(Rigid { linear: rotation, translation: middle + shift - rotation * middle })
}

/// A ring point and its partner on the source.
pub struct Pair {
    /// Where the ring point is now.
    pub place: DVec3,
    /// The partner's normal.
    pub normal: DVec3,
    /// How far the partner is along it.
    pub gap: f64,
    /// The same of the tints, in mesh units, and the slope they change by.
    pub off: f64,
    /// See `off`.
    pub slope: DVec3,
}

/// Fewest pairs for an alignment.
const LEAST_PAIRS: usize = 12;

/// How partners are looked for.
pub struct Pairing<'a> {
    /// Where.
    pub source: &'a Source,
    /// What they are.
    pub partner: Partner,
    /// How far they may lie, in units of the source.
    pub radius: f64,
    /// The share of the pairs used, the nearest ones.
    pub keep: f64,
    /// What a difference of 1 in tint is worth, in units of the source.
    pub paint: f64,
}

impl Pairing<'_> {
    /// The nearest of the pairs whose normals agree, and the middle of their places; `None` if there are too
    /// few. `back`: from the ring to the source.
    pub fn find(
        &self,
        ring: &[RingPoint],
        back: &Rigid,
        hints: &mut [Hint],
    ) -> Option<(Vec<Pair>, DVec3)> {
        let &Self { source, partner, radius, keep, paint } = self;
        let mut pairs: Vec<Pair> = Vec::with_capacity(ring.len());
        for (&(p, n, tint), hint) in ring.iter().zip(hints) {
            let (place, n) = (back.point(p), back.direction(n).normalize_or_zero());
            let met = find_partner(source, place, partner, radius, hint);
            if let Some((q, normal, other, slope)) = met.filter(|met| n.dot(met.1) > AGREE) {
                let (gap, off) = ((q - place).dot(normal), tint - other - slope.dot(place - q));
                pairs.push(Pair { place, normal, gap, off: paint * off, slope: paint * slope });
            }
        }
        if pairs.len() < LEAST_PAIRS {
            return None;
        }
        let apart = |p: &Pair| p.gap.abs() + p.off.abs();
        let kept = (keep * pairs.len() as f64) as usize;
        if kept < pairs.len() {
            pairs.select_nth_unstable_by(kept, |a, b| apart(a).total_cmp(&apart(b)));
            pairs.truncate(kept);
        }
        let middle = pairs.iter().map(|p| p.place).sum::<DVec3>() / pairs.len() as f64;
        Some((pairs, middle))
    }
}

/// Σ r rᵀ and Σ gap r over the pairs, and over their colours if they are `painted`; `row` makes r of a place
/// and the direction that the gap is along.
pub fn normal_equations<const N: usize>(
    pairs: &[Pair],
    painted: bool,
    row: impl Fn(DVec3, DVec3) -> [f64; N],
) -> (SMatrix<f64, N, N>, SVector<f64, N>) {
    let (mut a, mut b) = (SMatrix::zeros(), SVector::zeros());
    let mut add = |gap: f64, place: DVec3, along: DVec3| {
        let row = SVector::from(row(place, along));
        a += row * row.transpose();
        b += gap * row;
    };
    for pair in pairs {
        add(pair.gap, pair.place, pair.normal);
        if painted {
            add(pair.off, pair.place, pair.slope);
        }
    }
    (a, b)
}

/// What a difference of 1 in tint is worth, in mesh units; 0 without colours.
pub fn worth(source: &Source) -> f64 {
    source.paint.as_ref().map_or(0.0, |_| EDGES * source.edge)
}

/// The partner of a point on the source. `hint`: what earlier steps found.
pub fn find_partner(
    source: &Source,
    p: DVec3,
    partner: Partner,
    radius: f64,
    hint: &mut Hint,
) -> Option<Met> {
    let nearby = hint.found != NONE && p.distance(hint.of) < KEPT * source.edge;
    let on_face = |face: u32, point: DVec3, at: [f64; 3]| {
        let tint_at = |p: &Paint| p.tint_at(source.faces[face as usize], at);
        let (tint, slope) = source.paint.as_ref().map_or((0.0, DVec3::ZERO), tint_at);
        (point, source.smooth_normal(face, at), tint, slope)
    };
    match partner {
        Partner::Vertex => {
            if !nearby {
                let mut most = radius * radius;
                if hint.found != NONE {
                    most = most.min(source.positions[hint.found as usize].distance_squared(p));
                }
                let near = source.points.nearest_below(p, most);
                let usable = near.filter(|n| !source.is_boundary(n.0));
                *hint = Hint { found: usable.map_or(NONE, |n| n.0), of: p };
            }
            let v = hint.found as usize;
            let tint = |paint: &Paint| (paint.tint[v], paint.slopes[v]);
            (hint.found != NONE).then(|| {
                let (tint, slope) = source.paint.as_ref().map_or((0.0, DVec3::ZERO), tint);
                (source.positions[v], source.normals[v], tint, slope)
            })
        }
        Partner::Surface => {
            let mut most = radius * radius;
            if hint.found != NONE {
                let corners =
                    source.faces[hint.found as usize].map(|v| source.positions[v as usize]);
                let point = closest_point_on_triangle(p, &corners);
                let at = source.barycentric(hint.found, point);
                // Inside its last face, or else another is likely nearer.
                if nearby && at.iter().all(|&x| x > INSIDE) && !source.touches_boundary(hint.found)
                {
                    return Some(on_face(hint.found, point, at));
                }
                most = most.min(point.distance_squared(p));
            }
            let hit = source.tree.closest_point_within(p, most)?;
            *hint = Hint { found: hit.face, of: p };
            if source.touches_boundary(hit.face) {
                return None;
            }
            Some(on_face(hit.face, hit.point, source.barycentric(hit.face, hit.point)))
        }
    }
}

/// How badly an aligned source fits the ring, in mesh units: root mean square distance (each at
/// most half of `radius`) plus half an edge for each unit of disagreement of the normals. `paint`: what a
/// difference of 1 in tint is worth, in units of the source. `aligned`: what aligning the same ring so left, which
/// saves time only.
pub fn misfit(
    source: &Source,
    ring: &[RingPoint],
    transform: &Rigid,
    [radius, paint]: [f64; 2],
    aligned: Option<(Partner, &[Hint])>,
) -> f64 {
    let back = transform.inverse();
    let (mut square, mut turned) = (0.0, 0.0);
    for (i, &(p, n, tint)) in ring.iter().enumerate() {
        let most = 0.5 * radius;
        let (p, n) = (back.point(p), back.direction(n).normalize());
        let hint = |(partner, hints): (_, &[Hint])| hints[i].for_vertex(source, partner, p);
        let mut hint = aligned.map_or(Hint::NOTHING, hint);
        let (gap, cosine, off) = match find_partner(source, p, Partner::Vertex, radius, &mut hint) {
            Some((q, m, other, slope)) => {
                let off = (tint - other - slope.dot(p - q)).abs().min(FARTHEST);
                ((q - p).dot(m).abs().min(most), n.dot(m), off)
            }
            None => (most, 0.0, FARTHEST),
        };
        square += gap * gap + (paint * off).powi(2);
        turned += 1.0 - cosine;
    }
    let n = ring.len().max(1) as f64;
    (square / n).sqrt() + 0.5 * source.edge * (turned / n).sqrt()
}

#[cfg(test)]
mod tests {
    use super::super::source::tests::{hills, hilly_source, some_transform};
    use super::*;

    fn on(source: &Source, partner: Partner, radius: f64) -> Pairing<'_> {
        Pairing { source, partner, radius, keep: KEEP, paint: 0.0 }
    }

    /// A ring on the hills, moved.
    fn ring(to_target: &Rigid) -> Vec<RingPoint> {
        let at = |k: usize| {
            let (r, turn) = (0.45 + 0.05 * (k % 5) as f64, 0.1 * k as f64);
            let (p, n) = hills(r * turn.cos(), r * turn.sin());
            (to_target.point(p), to_target.direction(n), 0.0)
        };
        (0..160).map(at).collect()
    }

    fn disturbed(t: &Rigid, angle: f64, by: f64) -> Rigid {
        let turn = DMat3::from_axis_angle(DVec3::new(1.0, 2.0, -2.0) / 3.0, angle);
        let shift = by * DVec3::new(2.0, -1.0, 2.0) / 3.0;
        t.after(&Rigid { linear: turn, translation: shift })
    }

    fn off(found: &Rigid, truth: &Rigid) -> f64 {
        let places = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z].map(|p| 0.5 * p);
        places.into_iter().map(|p| found.point(p).distance(truth.point(p))).fold(0.0, f64::max)
    }

    /// 10° and two edges off, rotated or mirrored: the truth comes back within a fraction of an edge.
    #[test]
    fn known_transforms_come_back() {
        let source = hilly_source(60);
        for mirrored in [false, true] {
            let truth = some_transform(mirrored);
            let start = disturbed(&truth, 0.17, 2.0 * source.edge);
            let ring = ring(&truth);
            let coarse = align(&ring, start, 20, &on(&source, Partner::Vertex, 0.2));
            let fine = align(&ring, coarse, 15, &on(&source, Partner::Surface, 0.2));
            let [before, first, second] = [start, coarse, fine].map(|t| off(&t, &truth));
            let edge = source.edge;
            println!("{before:.4} {first:.5} {second:.5} of an edge {edge:.4}");
            assert_eq!(fine.is_mirrored(), mirrored);
            assert!(before > edge && first < 0.2 * edge && second < 0.03 * edge);
            let [worst, best] = [start, fine].map(|t| misfit(&source, &ring, &t, [0.2, 0.0], None));
            assert!(best < 0.1 * worst, "{best} {worst}");
        }
    }

    /// Outliers are trimmed; points beyond reach or at the border have no partner.
    #[test]
    fn a_few_wrong_points_do_not_pull() {
        let source = hilly_source(60);
        let truth = some_transform(false);
        let mut ring = ring(&truth);
        for p in ring.iter_mut().step_by(12) {
            p.0 += 0.15 * p.1;
        }
        let start = disturbed(&truth, 0.1, source.edge);
        let found = align(&ring, start, 20, &on(&source, Partner::Surface, 0.3));
        assert!(off(&found, &truth) < 0.1 * source.edge, "{}", off(&found, &truth));
    }

    /// Too few partners: the start is given back.
    #[test]
    fn nothing_near_moves_nothing() {
        let source = hilly_source(30);
        let truth = some_transform(false);
        let start = disturbed(&truth, 0.0, 50.0);
        let found = align(&ring(&truth), start, 5, &on(&source, Partner::Surface, 0.2));
        assert!(off(&found, &start) < 1e-9);
        assert!(misfit(&source, &ring(&truth), &start, [0.2, 0.0], None) >= 0.1);
    }
}
