//! The loops of a hole joined to one polygon: bridges from loop to loop, each walked both ways.
//!
//! Islands and rings become a single closed walk, which any polygon triangulation can fill; the
//! two sides of a bridge are glued again afterwards. This is the front merging of Zhao, Gao and
//! Lin (2007), done once at the start, at the narrowest places.

use glam::DVec3;

/// What lies on the other side of a polygon edge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Beyond {
    /// An input face with this unit normal.
    Face(DVec3),
    /// The other side of a bridge: the polygon edge with this index.
    Bridge(usize),
}

/// A closed walk over the rim; edge `i` runs from corner `i` to corner `i + 1`.
#[derive(Debug, Clone, Default)]
pub struct Polygon {
    /// Patch vertex at each corner; the ends of bridges occur more than once.
    pub corners: Vec<u32>,
    /// The other side of each edge.
    pub beyond: Vec<Beyond>,
}

impl Polygon {
    /// Which loop each corner is of: 0 for that of the first corner. A walk comes back over each bridge.
    pub fn loops(&self) -> Vec<u32> {
        let (mut under_way, mut count) = (vec![0], 0);
        let mut loops = Vec::with_capacity(self.corners.len());
        for (edge, beyond) in self.beyond.iter().enumerate() {
            loops.push(under_way.last().copied().unwrap_or(0));
            match beyond {
                Beyond::Face(_) => {}
                Beyond::Bridge(twin) if *twin > edge => {
                    count += 1;
                    under_way.push(count);
                }
                Beyond::Bridge(_) => {
                    under_way.pop();
                }
            }
        }
        loops
    }
}

/// A loop as the bridges see it: vertices and the normals of the faces at its edges.
#[derive(Clone)]
pub struct Rim {
    /// Patch vertices in the order in which a fill runs along them.
    pub vertices: Vec<u32>,
    /// Unit normal of the input face at the edge from vertex i to i + 1.
    pub normals: Vec<DVec3>,
}

/// Pairs looked at for one bridge at most; longer loops are looked at in steps.
const PAIRS: usize = 1 << 20;

/// How much longer a bridge may seem when it starts from a vertex that already carries one.
const CROWDED: f64 = 4.0;

/// Joins the loops of one hole, nearest first.
pub fn join_loops(positions: &[DVec3], rims: &[Rim]) -> Polygon {
    let conormals: Vec<Vec<DVec3>> = rims.iter().map(|r| corner_conormals(positions, r)).collect();
    let mut taken: Vec<Vec<bool>> = rims.iter().map(|r| vec![false; r.vertices.len()]).collect();
    let mut walks: Vec<Walk> = rims.iter().enumerate().map(|(l, r)| Walk::around(l, r)).collect();
    // Kruskal over loops: always the shortest bridge between two that are not yet joined.
    let mut owner: Vec<usize> = (0..rims.len()).collect();
    let mut bridges: Vec<(f64, [usize; 4])> = Vec::new();
    for a in 0..rims.len() {
        for b in a + 1..rims.len() {
            bridges.push(shortest(positions, rims, &conormals, &taken, a, b));
        }
    }
    for number in 1..rims.len() {
        bridges.retain(|(_, [a, b, ..])| owner[*a] != owner[*b]);
        let best = (0..bridges.len())
            .min_by(|&x, &y| bridges[x].0.total_cmp(&bridges[y].0).then(x.cmp(&y)));
        let Some(best) = best else { break };
        let [a, b, i, j] = bridges[best].1;
        let (keep, merge) = (owner[a], owner[b]);
        let other = std::mem::take(&mut walks[merge]);
        walks[keep].splice((a, i), other, (b, j), number);
        owner.iter_mut().filter(|o| **o == merge).for_each(|o| *o = keep);
        taken[a][i] = true;
        taken[b][j] = true;
        // Bridges that started at the vertices just taken look for a better place.
        for bridge in &mut bridges {
            let [c, d, k, l] = bridge.1;
            if taken[c][k] || taken[d][l] {
                *bridge = shortest(positions, rims, &conormals, &taken, c, d);
            }
        }
    }
    let first = owner.first().map_or(0, |&o| o);
    walks.swap_remove(first).polygon(rims)
}

/// The direction into the hole at each corner.
fn corner_conormals(positions: &[DVec3], rim: &Rim) -> Vec<DVec3> {
    let n = rim.vertices.len();
    let p = |i: usize| positions[rim.vertices[i % n] as usize];
    (0..n)
        .map(|i| {
            let before = (i + n - 1) % n;
            let out = |e: usize| rim.normals[e].cross(p(e + 1) - p(e)).normalize_or_zero();
            (out(before) + out(i)).normalize_or_zero()
        })
        .collect()
}

fn shortest(
    positions: &[DVec3],
    rims: &[Rim],
    conormals: &[Vec<DVec3>],
    taken: &[Vec<bool>],
    a: usize,
    b: usize,
) -> (f64, [usize; 4]) {
    let (na, nb) = (rims[a].vertices.len(), rims[b].vertices.len());
    let step = ((na * nb) as f64 / PAIRS as f64).sqrt().ceil().max(1.0) as usize;
    let mut best = (f64::INFINITY, [a, b, 0, 0]);
    for i in (0..na).step_by(step) {
        let p = positions[rims[a].vertices[i] as usize];
        for j in (0..nb).step_by(step) {
            let to = positions[rims[b].vertices[j] as usize] - p;
            let d = to.length();
            if d >= best.0 {
                continue;
            }
            // A bridge that leaves along the rim, or through the material, seems longer.
            let facing = conormals[a][i].dot(to) - conormals[b][j].dot(to);
            let mut cost = d * (2.0 - 0.5 * facing / d.max(f64::MIN_POSITIVE));
            for crowded in [taken[a][i], taken[b][j]] {
                cost *= if crowded { CROWDED } else { 1.0 };
            }
            if cost < best.0 {
                best = (cost, [a, b, i, j]);
            }
        }
    }
    best
}

/// A loop and the place of a vertex in it.
type Corner = (usize, usize);

/// A closed walk as a list of steps; each step is a corner and the edge that leaves it.
#[derive(Default)]
struct Walk(Vec<Step>);

#[derive(Clone, Copy)]
struct Step {
    corner: Corner,
    /// None: the rim's own edge. Some: number of the bridge, and which of its sides.
    bridge: Option<(usize, usize)>,
}

impl Walk {
    fn around(l: usize, rim: &Rim) -> Self {
        Self((0..rim.vertices.len()).map(|i| Step { corner: (l, i), bridge: None }).collect())
    }

    /// ... a | b ... b | a ...: the walk goes over the bridge, around the other, and back.
    fn splice(&mut self, at: Corner, mut other: Walk, to: Corner, number: usize) {
        let find = |w: &Walk, c| w.0.iter().position(|s| s.corner == c && s.bridge.is_none());
        // The first occurrence whose own edge leaves: later ones only return from bridges.
        let (Some(i), Some(j)) = (find(self, at), find(&other, to)) else { return };
        other.0.rotate_left(j);
        let over = Step { corner: at, bridge: Some((number, 0)) };
        let back = Step { corner: to, bridge: Some((number, 1)) };
        let mut steps = Vec::with_capacity(self.0.len() + other.0.len() + 2);
        steps.extend_from_slice(&self.0[..i]);
        steps.push(over);
        steps.extend_from_slice(&other.0);
        steps.push(back);
        steps.extend_from_slice(&self.0[i..]);
        self.0 = steps;
    }

    fn polygon(self, rims: &[Rim]) -> Polygon {
        let corners = self.0.iter().map(|s| rims[s.corner.0].vertices[s.corner.1]).collect();
        let beyond = self
            .0
            .iter()
            .map(|s| match s.bridge {
                None => Beyond::Face(rims[s.corner.0].normals[s.corner.1]),
                Some((b, side)) => {
                    let twin = |t: &Step| t.bridge == Some((b, 1 - side));
                    Beyond::Bridge(self.0.iter().position(twin).unwrap_or(0))
                }
            })
            .collect();
        Polygon { corners, beyond }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A large square with two small ones in a row beside its middle: one bridge starts where another ends.
    #[test]
    fn corners_know_their_loops() {
        let square =
            |x: f64, r: f64| [[-r, -r], [r, -r], [r, r], [-r, r]].map(|p| [x + p[0], p[1]]);
        let corners = [square(0.0, 5.0), square(3.0, 0.5), square(1.0, 0.5)];
        let positions: Vec<DVec3> =
            corners.iter().flatten().map(|p| DVec3::new(p[0], p[1], 0.0)).collect();
        let rim = |l: u32| Rim {
            vertices: match l {
                0 => (0..4).collect(),
                _ => (4 * l..4 * l + 4).rev().collect(),
            },
            normals: vec![DVec3::Z; 4],
        };
        let polygon = join_loops(&positions, &[rim(0), rim(1), rim(2)]);
        // Twelve corners, and two ends more for each of two bridges.
        assert_eq!(polygon.corners.len(), 16);
        let loops = polygon.loops();
        for (a, b) in (0..16).flat_map(|a| (0..16).map(move |b| (a, b))) {
            let same_rim = polygon.corners[a] / 4 == polygon.corners[b] / 4;
            assert_eq!(loops[a] == loops[b], same_rim, "{:?} {loops:?}", polygon.corners);
        }
    }
}
