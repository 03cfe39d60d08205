//! The part cut out of the source, and bent to the rim.

use crate::matching::rigid::Rigid;
use crate::matching::source::Source;
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

/// What lies over the rim, as the source has it. The error says why that is no part.
pub fn cut_out(
    known: &Source,
    source: &Source,
    transform: &Rigid,
    loops: &[Vec<u32>],
) -> std::result::Result<Cut, String> {
    let rim = Rim::new(loops);
    let n = source.positions.len();
    let (mut free, mut begins) = (vec![false; n], vec![false; n]);
    for &v in source.points.ids() {
        let p = transform.point(source.positions[v as usize]);
        let Some(hit) = known.tree.closest_point(p, f64::INFINITY) else { continue };
        let on_rim =
            rim.holds(known.faces[hit.face as usize], known.barycentric(hit.face, hit.point));
        let off = hit.distance / known.edge;
        free[v as usize] = off > if on_rim { ROOM } else { FAR };
        begins[v as usize] = on_rim && off > ROOM && off < NEAR;
    }
    let all: Vec<u32> = (0..source.faces.len() as u32)
        .filter(|&f| source.faces[f as usize].iter().all(|&v| free[v as usize]))
        .collect();
    let mut kept = hanging_together(source, &all, &begins);
    even_border(source, &mut kept);
    if kept.is_empty() {
        return Err("nothing of the source lies over it that is not there already".into());
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
    match cut.loops.len() == loops.len() {
        true => Ok(cut),
        false => Err(format!(
            "the part that lies over it has {} borders, its rim {} loops",
            cut.loops.len(),
            loops.len()
        )),
    }
}

/// Of some faces those that hang together over edges with one that has a vertex where the part begins.
fn hanging_together(source: &Source, all: &[u32], begins: &[bool]) -> Vec<u32> {
    let mut at: HashMap<[u32; 2], Vec<u32>> = HashMap::new();
    for &f in all {
        edges(source.faces[f as usize]).for_each(|e| at.entry(sorted(e)).or_default().push(f));
    }
    let starts = |f: &&u32| source.faces[**f as usize].iter().any(|&v| begins[v as usize]);
    let mut queue: Vec<u32> = all.iter().filter(starts).copied().collect();
    let mut kept: BTreeSet<u32> = queue.iter().copied().collect();
    while let Some(f) = queue.pop() {
        for e in edges(source.faces[f as usize]) {
            for &g in &at[&sorted(e)] {
                if kept.insert(g) {
                    queue.push(g);
                }
            }
        }
    }
    kept.into_iter().collect()
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
    let mut pieces: Vec<Vec<u32>> = Vec::new();
    let mut rest: BTreeSet<u32> = kept.iter().copied().collect();
    while let Some(&f) = rest.first() {
        let mut begins = vec![false; source.positions.len()];
        source.faces[f as usize].iter().for_each(|&v| begins[v as usize] = true);
        let left: Vec<u32> = rest.iter().copied().collect();
        let piece = hanging_together(source, &left, &begins);
        piece.iter().for_each(|g| _ = rest.remove(g));
        pieces.push(piece);
    }
    // The last of equal ones is the same every time.
    *kept = pieces.into_iter().max_by_key(Vec::len).unwrap_or_default();
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
pub fn bend(
    cut: &mut Cut,
    known: &Source,
    source: &Source,
    transform: &Rigid,
    loops: &[Vec<u32>],
) -> Option<()> {
    let back = transform.inverse();
    let rim: Vec<(DVec3, DVec3)> = (loops.iter().flatten())
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
