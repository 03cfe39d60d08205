//! The part cut out of the source, and bent to the rim.

use super::Wanted;
use crate::error::Result;
use crate::fill::sheet::Incidence;
use crate::matching::rigid::Rigid;
use crate::matching::similarity::scale_of;
use crate::matching::source::Source;
use crate::progress::Pace;
use crate::synthesis::warp::harmonic;
use glam::DVec3;
use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

/// Farther than this from all that is known a vertex belongs to the part, in edges: two samplings of one
/// surface differ by less, and alignments are better than that.
const FAR: f64 = 1.5;
/// Vertices of the part keep so far from the rim, in edges: room for triangles between them.
const ROOM: f64 = 0.5;
/// The part begins within this distance of the rim, in edges.
const NEAR: f64 = 3.0;
/// More than a transform stretches anything beyond its scale: strains of 15 % are taken.
const MOST_STRAIN: f64 = 1.25;
/// Elementary steps that a search for the nearest place takes, about.
const LOOK: usize = 1 << 8;
/// Rounds in which the part's border is made even, at most.
const ROUNDS: usize = 50;
/// Barycentric coordinates below this are 0: the point is on an edge.
const ON_EDGE: f64 = 1e-9;

/// A part cut out of the source and laid over the mesh.
pub struct Cut {
    /// Source vertex of each vertex.
    pub of: Vec<u32>,
    pub positions: Vec<DVec3>,
    /// Turned around if the transform mirrors.
    pub faces: Vec<[u32; 3]>,
    /// Source face of each.
    pub face_of: Vec<u32>,
    /// Its borders, in its own vertices.
    pub loops: Vec<Vec<u32>>,
}

/// Edges and vertices of a rim, to be asked for.
struct Rim {
    edges: HashSet<[u32; 2]>,
    vertices: HashSet<u32>,
}

impl Rim {
    fn new(loops: &[Vec<u32>]) -> Self {
        let edge = |l: &Vec<u32>, i: usize| sorted([l[i], l[(i + 1) % l.len()]]);
        let edges = loops.iter().flat_map(|l| (0..l.len()).map(move |i| edge(l, i))).collect();
        Self { edges, vertices: loops.iter().flatten().copied().collect() }
    }

    /// Whether a point of a face lies on it.
    fn holds(&self, face: [u32; 3], at: [f64; 3]) -> bool {
        let there: Vec<u32> = (0..3).filter(|&k| at[k] > ON_EDGE).map(|k| face[k]).collect();
        match there[..] {
            [a] => self.vertices.contains(&a),
            [a, b] => self.edges.contains(&sorted([a, b])),
            _ => false,
        }
    }
}

/// What of a source belongs to a part, found out vertex by vertex.
struct Search<'a> {
    known: &'a Source,
    source: &'a Source,
    transform: &'a Rigid,
    rim: Rim,
    seen: HashMap<u32, Standing>,
}

/// How a vertex of the source lies to what is known.
#[derive(Clone, Copy)]
struct Standing {
    /// It belongs to a part.
    free: bool,
    /// A part begins there.
    begins: bool,
}

impl Search<'_> {
    fn standing(&mut self, v: u32) -> Standing {
        if let Some(&standing) = self.seen.get(&v) {
            return standing;
        }
        let (known, edge) = (self.known, self.known.edge);
        let p = self.transform.point(self.source.positions[v as usize]);
        let standing = match known.tree.closest_point(p, NEAR * edge) {
            None => Standing { free: true, begins: false },
            Some(hit) => {
                let at = known.barycentric(hit.face, hit.point);
                let on_rim = self.rim.holds(known.faces[hit.face as usize], at);
                let off = hit.distance / edge;
                let free = off > if on_rim { ROOM } else { FAR };
                Standing { free, begins: on_rim && off > ROOM && off < NEAR }
            }
        };
        self.seen.insert(v, standing);
        standing
    }

    fn is_free(&mut self, face: u32) -> bool {
        self.source.faces[face as usize].iter().all(|&v| self.standing(v).free)
    }

    /// Where parts begin, ascending: not farther from the rim than that.
    fn beginnings(&mut self, pace: &mut Pace<'_>) -> Result<BTreeSet<u32>> {
        let back = self.transform.inverse();
        let mut found = BTreeSet::new();
        for &[a, b] in &self.rim.edges {
            let [a, b] = [a, b].map(|v| self.known.positions[v as usize]);
            let reach = NEAR * self.known.edge + 0.5 * a.distance(b);
            let reach = MOST_STRAIN * scale_of(&back) * reach;
            let near = self.source.points.within(back.point(0.5 * (a + b)), reach);
            pace.work(LOOK + near.len())?;
            found.extend(near);
        }
        let mut begins = BTreeSet::new();
        for v in found {
            pace.work(LOOK)?;
            if self.standing(v).begins {
                begins.insert(v);
            }
        }
        Ok(begins)
    }

    /// The faces that belong to a part and hang together over edges with where one begins, ascending.
    fn grow(&mut self, incidence: &Incidence, pace: &mut Pace<'_>) -> Result<Vec<u32>> {
        let begins = self.beginnings(pace)?;
        let at_begin = begins.iter().flat_map(|&v| incidence.faces(v)).copied();
        let mut queue: Vec<u32> = at_begin.filter(|&f| self.is_free(f)).collect();
        let mut kept: BTreeSet<u32> = queue.iter().copied().collect();
        while let Some(f) = queue.pop() {
            for [a, b] in edges(self.source.faces[f as usize]) {
                for &g in incidence.faces(a) {
                    pace.work(1)?;
                    if !self.source.faces[g as usize].contains(&b) || kept.contains(&g) {
                        continue;
                    }
                    pace.work(LOOK)?;
                    if self.is_free(g) {
                        kept.insert(g);
                        queue.push(g);
                    }
                }
            }
        }
        Ok(kept.into_iter().collect())
    }
}

/// What lies over the rim, as the source has it, whose faces by vertex are `incidence`. The inner error says
/// why that is no part.
pub fn cut_out(
    wanted: &Wanted<'_>,
    transform: &Rigid,
    check: &dyn Fn() -> Result<()>,
) -> Result<std::result::Result<Cut, String>> {
    let (known, source) = (&wanted.library.known, wanted.library.source());
    let mut pace = Pace::new(check);
    let mut search =
        Search { known, source, transform, rim: Rim::new(wanted.rim), seen: HashMap::new() };
    let mut kept = search.grow(wanted.incidence, &mut pace)?;
    even_border(source, &mut kept);
    if kept.is_empty() {
        return Ok(Err("nothing of the source lies over it that is not there already".into()));
    }
    let mirrored = transform.is_mirrored();
    let mut number: HashMap<u32, u32> = HashMap::new();
    let (mut of, mut faces) = (Vec::new(), Vec::new());
    for &f in &kept {
        let face = source.faces[f as usize].map(|v| {
            *number.entry(v).or_insert_with(|| {
                of.push(v);
                of.len() as u32 - 1
            })
        });
        faces.push(if mirrored { [face[0], face[2], face[1]] } else { face });
    }
    let positions = of.iter().map(|&v| transform.point(source.positions[v as usize])).collect();
    let cut = Cut { of, positions, loops: borders(&faces), faces, face_of: kept };
    let count = wanted.rim.len();
    Ok(match cut.loops.len() == count {
        true => Ok(cut),
        false => Err(format!(
            "the part that lies over it has {} borders, its rim {count} loops",
            cut.loops.len()
        )),
    })
}

/// The largest of the pieces that some faces fall into, which hang together over edges.
fn largest_piece(source: &Source, all: &[u32]) -> Vec<u32> {
    let mut at: HashMap<[u32; 2], Vec<u32>> = HashMap::new();
    for &f in all {
        edges(source.faces[f as usize]).for_each(|e| at.entry(sorted(e)).or_default().push(f));
    }
    let mut rest: BTreeSet<u32> = all.iter().copied().collect();
    let mut pieces: Vec<Vec<u32>> = Vec::new();
    while let Some(first) = rest.pop_first() {
        let (mut piece, mut next) = (vec![first], 0);
        while let Some(&f) = piece.get(next) {
            let beside = edges(source.faces[f as usize]).flat_map(|e| &at[&sorted(e)]);
            piece.extend(beside.filter(|g| rest.remove(g)));
            next += 1;
        }
        piece.sort_unstable();
        pieces.push(piece);
    }
    // The last of equal ones is the same every time.
    pieces.into_iter().max_by_key(Vec::len).unwrap_or_default()
}

/// Takes away faces that touch the rest at vertices alone, or stick out with two edges, until the border is a
/// set of simple loops; then all but the largest piece.
fn even_border(source: &Source, kept: &mut Vec<u32>) {
    for _ in 0..ROUNDS {
        let mut count: HashMap<[u32; 2], u32> = HashMap::new();
        let each = || kept.iter().flat_map(|&f| edges(source.faces[f as usize]));
        each().for_each(|e| *count.entry(sorted(e)).or_default() += 1);
        let mut ends: HashMap<u32, u32> = HashMap::new();
        let open = each().filter(|e| count[&sorted(*e)] == 1);
        open.for_each(|e| *ends.entry(e[0]).or_default() += 1);
        let before = kept.len();
        kept.retain(|&f| {
            let face = source.faces[f as usize];
            let outer = edges(face).filter(|e| count[&sorted(*e)] == 1).count();
            outer < 2 && face.iter().all(|v| ends.get(v).is_none_or(|&n| n < 2))
        });
        if kept.len() == before {
            break;
        }
    }
    *kept = largest_piece(source, kept);
}

fn edges(f: [u32; 3]) -> impl Iterator<Item = [u32; 2]> {
    [[f[0], f[1]], [f[1], f[2]], [f[2], f[0]]].into_iter()
}

fn sorted([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

/// The loops that some faces end at, each begun at its least vertex, in the order of these.
fn borders(faces: &[[u32; 3]]) -> Vec<Vec<u32>> {
    let all: HashSet<[u32; 2]> = faces.iter().flat_map(|f| edges(*f)).collect();
    let open = all.iter().filter(|[a, b]| !all.contains(&[*b, *a]));
    let mut next: BTreeMap<u32, u32> = open.map(|&[a, b]| (a, b)).collect();
    let mut loops = Vec::new();
    while let Some((first, mut at)) = next.pop_first() {
        let mut own = vec![first];
        while at != first {
            own.push(at);
            let Some(to) = next.remove(&at) else { break };
            at = to;
        }
        loops.push(own);
    }
    loops
}

/// Warps a part so that it goes on where the mesh ends: each border vertex moves by what the source is off at
/// the nearest rim vertex, the rest follows (Eq. 15).
pub fn bend(cut: &mut Cut, wanted: &Wanted<'_>, transform: &Rigid) -> Option<()> {
    let (known, source) = (&wanted.library.known, wanted.library.source());
    let back = transform.inverse();
    let rim: Vec<(DVec3, DVec3)> = (wanted.rim.iter().flatten())
        .filter_map(|&v| {
            let p = known.positions[v as usize];
            let hit = source.tree.closest_point(back.point(p), f64::INFINITY)?;
            Some((p, p - transform.point(hit.point)))
        })
        .collect();
    let mut given = vec![None; cut.positions.len()];
    for &v in cut.loops.iter().flatten() {
        let p = cut.positions[v as usize];
        let off = |r: &&(DVec3, DVec3)| r.0.distance_squared(p);
        given[v as usize] =
            rim.iter().min_by(|a, b| off(a).total_cmp(&off(b))).map(|nearest| nearest.1);
    }
    let mut beside: Vec<Vec<usize>> = vec![Vec::new(); cut.positions.len()];
    for [a, b] in cut.faces.iter().flat_map(|f| edges(*f)) {
        beside[a as usize].push(b as usize);
        beside[b as usize].push(a as usize);
    }
    beside.iter_mut().for_each(|list| {
        list.sort_unstable();
        list.dedup();
    });
    let by = harmonic(&cut.positions, &|v| beside[v].clone(), &|v| given[v])?;
    cut.positions.iter_mut().zip(by).for_each(|(p, by)| *p += by);
    Some(())
}
