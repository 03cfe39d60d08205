//! Which boundary loops face each other and so are filled together: islands, rings, cracks.
//!
//! Every boundary edge looks out of its face along the conormal, into the gap. A plain hole's
//! edges look at its own middle and it is filled alone. An island's edges look away from its
//! middle, those of an open tube along its axis: such a loop belongs to what it sees, the nearest
//! edges of other loops that look back.

use super::loops::{position, Chain};
use crate::mesh::roots::Roots;
use crate::mesh::MeshView;
use glam::DVec3;

/// Edges of a loop that look around; the rest is only looked at.
const LOOKERS: usize = 64;
/// Least cosine between a conormal and the direction of sight, both ways: beyond 75° an edge looks
/// along the gap, not across.
const FACING: f64 = 0.26;
/// Share of a tube end's lookers that must see the other end, both ways; own choice: a clear
/// majority.
const MAJORITY: f64 = 0.6;
/// Share of an island's lookers that see another loop for the two to be joined; below lie chance
/// looks past the surroundings.
const SHARE: f64 = 0.1;
/// How far to its own middle (-1) or away from it (1) a loop looks: a plain hole is near -1, an
/// island near 1, a tube's end near 0. Ragged rims come half way to 0, hence a fifth.
const INWARD: f64 = -0.2;
/// The same for islands.
const OUTWARD: f64 = 0.2;
/// Widest missing band between two tube ends, in diameters of the smaller one; own choice.
const WIDEST_BAND: f64 = 2.0;
/// Ragged rims look everywhere; the mean over this share of the loop, and at least over two edges
/// to each side, looks across the gap.
const WINDOW: f64 = 0.03;

/// A boundary edge looking into the gap.
#[derive(Clone, Copy)]
struct Look {
    from: DVec3,
    conormal: DVec3,
    normal: DVec3,
}

struct Ring {
    looks: Vec<Look>,
    mean_conormal: DVec3,
    /// From -1, all look at the middle, to 1, all look away from it.
    outward: f64,
    centre: DVec3,
    radius: f64,
}

/// For each loop the number of its group, which is the number of its first loop.
pub fn group_loops(mesh: MeshView<'_>, chains: &[Chain]) -> Vec<usize> {
    if chains.len() < 2 {
        return vec![0; chains.len()];
    }
    let rings: Vec<Ring> = chains.iter().map(|c| look_around(mesh, c)).collect();
    let seen: Vec<Vec<(usize, f64)>> =
        (0..rings.len()).map(|a| who_is_seen(&rings, chains, a)).collect();
    let sees =
        |a: usize, b: usize| seen[a].iter().find(|(c, _)| *c == b).map_or(0.0, |&(_, share)| share);
    let mut groups = Roots::new(rings.len());
    for a in 0..rings.len() {
        for &(b, share) in &seen[a] {
            let joined = if rings[a].outward > OUTWARD {
                share >= SHARE
            } else {
                share >= MAJORITY && sees(b, a) >= MAJORITY && are_tube_ends(&rings[a], &rings[b])
            };
            if joined {
                groups.join(a as u32, b as u32);
            }
        }
    }
    groups.into_roots().into_iter().map(|root| root as usize).collect()
}

fn are_tube_ends(a: &Ring, b: &Ring) -> bool {
    a.mean_conormal.dot(b.mean_conormal) < 0.0
        && a.centre.distance(b.centre) < WIDEST_BAND * 2.0 * a.radius.min(b.radius)
}

fn look_around(mesh: MeshView<'_>, chain: &Chain) -> Ring {
    let vertices = &chain.shape.vertices;
    let n = vertices.len();
    let looks: Vec<Look> = (0..n)
        .map(|i| {
            let (p, q) = (position(mesh, vertices[i]), position(mesh, vertices[(i + 1) % n]));
            let [a, b, c] = mesh.faces.get(chain.faces[i] as usize).map(|v| position(mesh, v));
            let normal = (b - a).cross(c - a).normalize_or_zero();
            // The fill runs p → q with the hole on its left, seen from outside.
            let conormal = normal.cross(q - p).normalize_or_zero();
            Look { from: 0.5 * (p + q), conormal, normal }
        })
        .collect();
    let mean_conormal = looks.iter().map(|l| l.conormal).sum::<DVec3>() / n.max(1) as f64;
    let centre = DVec3::from(chain.shape.centre);
    let radius = looks.iter().map(|l| l.from.distance(centre)).fold(0.0, f64::max);
    let (mut away, mut all) = (0.0, 0.0);
    for (i, look) in looks.iter().enumerate() {
        let length = position(mesh, vertices[i]).distance(position(mesh, vertices[(i + 1) % n]));
        away += length * look.conormal.dot(look.from - centre);
        all += length * look.from.distance(centre);
    }
    let outward = away / all.max(f64::MIN_POSITIVE);
    Ring { looks: smooth(&looks), mean_conormal, outward, centre, radius }
}

/// The looks averaged along the loop.
fn smooth(looks: &[Look]) -> Vec<Look> {
    let n = looks.len();
    let half = ((WINDOW * n as f64) as usize).max(2).min(n / 4);
    let mean = |i: usize, of: &dyn Fn(&Look) -> DVec3| {
        (n + i - half..=n + i + half).map(|j| of(&looks[j % n])).sum::<DVec3>()
    };
    (0..n)
        .map(|i| Look {
            from: looks[i].from,
            conormal: mean(i, &|l| l.conormal).normalize_or_zero(),
            normal: mean(i, &|l| l.normal).normalize_or_zero(),
        })
        .collect()
}

/// The other loops that loop `a` sees, with the share of its lookers; none for a plain hole.
fn who_is_seen(rings: &[Ring], chains: &[Chain], a: usize) -> Vec<(usize, f64)> {
    let me = &rings[a];
    if me.outward < INWARD || chains[a].problem.is_some() {
        return Vec::new();
    }
    // An island can be far smaller than the hole around it, so the larger loop sets the reach.
    let near: Vec<usize> = (0..rings.len())
        .filter(|&b| {
            let reach = 2.0 * WIDEST_BAND * me.radius.max(rings[b].radius);
            b != a
                && chains[b].problem.is_none()
                && me.centre.distance(rings[b].centre) < me.radius + rings[b].radius + reach
        })
        .collect();
    let step = me.looks.len().div_ceil(LOOKERS).max(1);
    let mut votes: Vec<(usize, f64)> = Vec::new();
    let mut lookers = 0.0;
    for look in me.looks.iter().step_by(step) {
        lookers += 1.0;
        if let Some(b) = nearest_facing(rings, &near, look) {
            match votes.iter_mut().find(|(c, _)| *c == b) {
                Some(vote) => vote.1 += 1.0,
                None => votes.push((b, 1.0)),
            }
        }
    }
    votes.iter_mut().for_each(|v| v.1 /= lookers);
    votes.sort_by_key(|v| v.0);
    votes
}

fn nearest_facing(rings: &[Ring], near: &[usize], look: &Look) -> Option<usize> {
    let mut best = (f64::INFINITY, None);
    for &b in near {
        for other in &rings[b].looks {
            let to = other.from - look.from;
            let d2 = to.length_squared();
            if d2 >= best.0 || d2 == 0.0 {
                continue;
            }
            let least = FACING * d2.sqrt();
            if look.conormal.dot(to) > least
                && -other.conormal.dot(to) > least
                && look.normal.dot(other.normal) > -0.5
            {
                best = (d2, Some(b));
            }
        }
    }
    best.1
}
