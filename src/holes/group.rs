//! Which boundary loops face each other and so are filled together: islands, rings, cracks.
//!
//! Every boundary edge looks out of its face along the conormal, into the gap. The nearest edge
//! that looks back tells where the surface went on. On a plain hole that is the loop itself; on
//! an island it is the hole around it; on a missing band each loop sees the other one.

use super::loops::{position, Chain};
use crate::mesh::MeshView;
use glam::DVec3;

/// Edges of a loop that look around; the rest is only looked at.
const LOOKERS: usize = 64;
/// Least cosine between a conormal and the direction of sight, both ways: beyond 75° an edge looks
/// along the gap, not across.
const FACING: f64 = 0.26;
/// Share of a loop's lookers that must see another loop before the two can belong together; own
/// choice: a clear majority.
const MAJORITY: f64 = 0.6;
/// Share of an island's lookers that another loop must have to be joined to it.
const SHARE: f64 = 0.1;
/// Length of the mean conormal above which a loop is the open end of a tube, not an island or a
/// plain hole: these look to all sides, and theirs is near 0.
const TUBE: f64 = 0.5;
/// Widest missing band between two tube ends, in diameters of the smaller one; own choice.
const WIDEST_BAND: f64 = 2.0;

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
    centre: DVec3,
    radius: f64,
}

/// For each loop the number of its group; groups are numbered by their first loop.
pub fn group_loops(mesh: MeshView<'_>, chains: &[Chain]) -> Vec<usize> {
    if chains.len() < 2 {
        return vec![0; chains.len()];
    }
    let rings: Vec<Ring> = chains.iter().map(|c| look_around(mesh, c)).collect();
    let seen: Vec<Vec<(usize, f64)>> = (0..rings.len())
        .map(|a| if chains[a].problem.is_some() { Vec::new() } else { who_is_seen(&rings, chains, a) })
        .collect();
    let share = |a: usize, b: usize| {
        seen[a].iter().find(|(c, _)| *c == b).map_or(0.0, |&(_, share)| share)
    };
    let mut groups = Groups::new(rings.len());
    for a in 0..rings.len() {
        let others: f64 = seen[a].iter().filter(|(b, _)| *b != a).map(|(_, s)| s).sum();
        if others < MAJORITY {
            continue;
        }
        let island = rings[a].mean_conormal.length() < TUBE;
        for &(b, s) in seen[a].iter().filter(|(b, _)| *b != a) {
            let mutual = s >= MAJORITY && share(b, a) >= MAJORITY;
            let joined = match island {
                true => s >= SHARE,
                false => mutual && are_tube_ends(&rings[a], &rings[b]),
            };
            if joined || mutual && rings[b].mean_conormal.length() < TUBE {
                groups.join(a, b);
            }
        }
    }
    groups.numbers()
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
    Ring { looks, mean_conormal, centre, radius }
}

/// The loops that loop `a` sees, with the share of its lookers.
fn who_is_seen(rings: &[Ring], chains: &[Chain], a: usize) -> Vec<(usize, f64)> {
    let me = &rings[a];
    // An island can be far smaller than the hole around it, so the larger loop sets the reach.
    let near: Vec<usize> = (0..rings.len())
        .filter(|&b| {
            let reach = 2.0 * WIDEST_BAND * me.radius.max(rings[b].radius);
            chains[b].problem.is_none()
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

/// Sets of loops, merged.
struct Groups(Vec<usize>);

impl Groups {
    fn new(n: usize) -> Self {
        Self((0..n).collect())
    }
    fn root(&self, mut a: usize) -> usize {
        while self.0[a] != a {
            a = self.0[a];
        }
        a
    }
    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        // The smaller index leads, so a root is its group's first loop.
        self.0[a.max(b)] = a.min(b);
    }
    fn numbers(&self) -> Vec<usize> {
        (0..self.0.len()).map(|a| self.root(a)).collect()
    }
}
