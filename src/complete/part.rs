//! A missing part taken whole, with its own triangles, from where a transform lays an intact one over the
//! hole: a hand, a foot, a spout, whose rim is far from flat and which no smooth surface comes near to.
//!
//! Park, Guo, Shin and Qin (2006), Sec. 5.3 to 6.3, do so by hand: a curve is drawn around the part, which
//! is then moved, mirrored if need be, and warped to the rim by the Poisson equation. Differences from the
//! paper:
//! - The curve is found: a vertex of the source belongs to the part if, laid over the mesh, the nearest
//!   known place is on the rim, or if it is far from all that is known.
//! - The gap between part and rim is triangulated; the result is one mesh.

use super::check::Obstacles;
use super::initial::check_edges;
use super::library::Library;
use super::smooth::{Fill, Story, Surroundings};
use super::Completer;
use crate::error::Result;
use crate::fill::outline::Outline;
use crate::fill::patch::Patch;
use crate::fill::sheet::Band;
use crate::matching::icp::RingPoint;
use crate::matching::rigid::Rigid;
use crate::matching::search::{Loose, Target};
use crate::matching::similarity::{gap, scale_of};
use crate::matching::source::Source;
use crate::mesh::MeshView;
use crate::options::{Fairing, Grouping, Method, Options, Selection};
use crate::progress::Monitor;
use crate::result::{Origin, SourceReport};
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

/// One hole and where its part is taken from.
pub struct Wanted<'a> {
    /// The whole mesh.
    pub mesh: MeshView<'a>,
    /// What is known and what may be copied from.
    pub library: &'a Library,
    /// Loops of the rim, in input vertices.
    pub rim: &'a [Vec<u32>],
    /// The same in vertices of the neighbourhood.
    pub local: &'a [Vec<u32>],
    /// Known points around it.
    pub ring: &'a [RingPoint],
}

/// Rings of known surface around the rim that a part is aligned with, at least and at most; between them half
/// as wide as the hole.
const RINGS: (f64, f64) = (4.0, 24.0);

/// Known points around a hole, whose loops are given in vertices of the neighbourhood.
pub fn ring_around(
    around: &Surroundings<'_>,
    library: &Library,
    loops: &[Vec<u32>],
) -> Vec<RingPoint> {
    let outline = Outline::new(around.near, &around.incidence.get(), loops);
    let rings = (0.5 * outline.radius() / outline.mean_size()).clamp(RINGS.0, RINGS.1);
    let band = Band::grow(around.near, &around.incidence.get(), &outline.vertices, rings as usize);
    let known = &library.known;
    let point = |&v: &u32| {
        let v = around.near.vertices[v as usize] as usize;
        (known.positions[v], known.normals[v], known.tint(v))
    };
    band.vertices.iter().map(point).filter(|p| p.1 != DVec3::ZERO).collect()
}

/// What places are searched for by. `rim`: positions of the rim.
pub fn target_of<'a>(ring: &'a [RingPoint], rim: &'a [DVec3]) -> Target<'a> {
    let centre = rim.iter().sum::<DVec3>() / rim.len().max(1) as f64;
    let radius = rim.iter().map(|p| p.distance(centre)).fold(0.0, f64::max);
    let normal = ring.iter().map(|p| p.1).sum::<DVec3>().normalize_or(DVec3::Z);
    Target { centre, normal, radius, fill: rim, ring, loose: Loose::default(), emphasis: 1.0 }
}

/// A part cut out of the source and laid over the mesh.
struct Cut {
    /// Source vertex of each vertex.
    of: Vec<u32>,
    positions: Vec<DVec3>,
    /// Turned around if the transform mirrors.
    faces: Vec<[u32; 3]>,
    /// Source face of each.
    face_of: Vec<u32>,
    /// Its borders, in its own vertices.
    loops: Vec<Vec<u32>>,
}

/// The hole filled with the part that a transform lays there. The inner error says why that cannot be.
pub fn take_part(
    around: &Surroundings<'_>,
    obstacles: &Obstacles<'_>,
    wanted: &Wanted<'_>,
    transform: &Rigid,
    check: &dyn Fn() -> Result<()>,
) -> Result<std::result::Result<Fill, String>> {
    check()?;
    let source = wanted.library.source();
    let known = &wanted.library.known;
    let mut cut = match cut_out(known, source, transform, wanted.rim) {
        Ok(cut) => cut,
        Err(why) => return Ok(Err(why)),
    };
    check()?;
    if bend(&mut cut, known, source, transform, wanted.rim).is_none() {
        return Ok(Err("its part cannot be bent to the rim".into()));
    }
    cut.positions.iter_mut().for_each(|p| *p = around.rounding.apply(*p));
    check()?;
    let (gap_vertices, gap_faces) = match close_gap(wanted, &cut)? {
        Ok(found) => found,
        Err(why) => return Ok(Err(why)),
    };
    let outline = Outline::new(around.near, &around.incidence.get(), wanted.local);
    let input = wanted.mesh.vertices.len() as u32;
    let rim = outline.vertices.iter().map(|&v| around.near.vertices[v as usize]);
    let number: HashMap<u32, u32> = rim.enumerate().map(|(i, v)| (v, i as u32)).collect();
    let count = outline.vertices.len() as u32;
    let index = |v: u32| match v.checked_sub(input) {
        Some(new) => Some(count + new),
        None => number.get(&v).copied(),
    };
    let of_part = cut.faces.iter().map(|f| f.map(|v| v + input));
    let triangles: Option<Vec<[u32; 3]>> = (of_part.chain(gap_faces))
        .map(|f| Some([index(f[0])?, index(f[1])?, index(f[2])?]))
        .collect();
    let Some(triangles) = triangles else {
        return Ok(Err("its part does not end at the rim".into()));
    };
    if let Err(why) = check_edges(&triangles, &outline) {
        return Ok(Err(format!("its part {why}")));
    }
    let positions: Vec<DVec3> =
        outline.positions.iter().chain(&cut.positions).chain(&gap_vertices).copied().collect();
    let sizes = vec![outline.mean_size(); positions.len()];
    let patch = Patch::of_triangles(positions, sizes, outline.vertices.len(), triangles);
    let settled = obstacles.settle(around, patch, check)?;
    let story = tell(wanted, &cut, &gap_vertices, transform);
    Ok(settled.map(|patch| Fill {
        outline,
        patch,
        fairing: Fairing::None,
        method: Method::Coherent,
        coherence_error: None,
        candidates: 0,
        story: Some(story),
    }))
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

fn cut_out(
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
fn bend(
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

/// New vertices and faces of a gap, numbered after the mesh and the part.
type Gap = (Vec<DVec3>, Vec<[u32; 3]>);

/// What lies between the rim and the part: smooth fills of a mesh that has the part already.
fn close_gap(wanted: &Wanted<'_>, cut: &Cut) -> Result<std::result::Result<Gap, String>> {
    let mesh = wanted.mesh;
    let input = mesh.vertices.len() as u32;
    let mut vertices: Vec<[f64; 3]> =
        (0..mesh.vertices.len()).map(|v| mesh.vertices.get(v)).collect();
    vertices.extend(cut.positions.iter().map(|p| p.to_array()));
    let mut faces: Vec<[u32; 3]> = (0..mesh.faces.len()).map(|f| mesh.faces.get(f)).collect();
    faces.extend(cut.faces.iter().map(|f| f.map(|v| v + input)));
    let middle = |l: &[u32]| {
        l.iter().map(|&v| DVec3::from(vertices[v as usize])).sum::<DVec3>() / l.len() as f64
    };
    let mut left: Vec<Vec<u32>> =
        cut.loops.iter().map(|l| l.iter().map(|v| v + input).collect()).collect();
    let mut pairs = Vec::new();
    for rim in wanted.rim {
        let off = |l: &Vec<u32>| middle(l).distance_squared(middle(rim));
        let nearest = (0..left.len()).min_by(|&a, &b| off(&left[a]).total_cmp(&off(&left[b])));
        let Some(k) = nearest else { return Ok(Err("its part has too few borders".into())) };
        pairs.push(vec![rim[0], left.swap_remove(k)[0]]);
    }
    let starts: HashSet<u32> = wanted.rim.iter().map(|l| l[0]).collect();
    let view = MeshView::new(&vertices[..], &faces[..]);
    let silent = Monitor::silent();
    let completer = Completer::new(view, &Grouping::Join(pairs), &silent)?;
    let list = completer.holes();
    let ours = list.holes.iter().filter(|h| {
        h.loops.iter().any(|&l| list.loops[l].vertices.iter().any(|v| starts.contains(v)))
    });
    let options = Options {
        method: Method::Smooth,
        fairing: Fairing::C1,
        selection: Selection::Ids(ours.map(|h| h.id).collect()),
        threads: 1,
        ..Options::default()
    };
    let made = match completer.complete(&options, &silent) {
        Ok(made) => made,
        Err(why) => return Ok(Err(format!("between its rim and its part: {why}"))),
    };
    let new = made.vertices.iter().map(|&p| DVec3::from(p)).collect();
    Ok(Ok((new, made.faces)))
}

/// Where each new vertex comes from.
fn tell(wanted: &Wanted<'_>, cut: &Cut, gap_vertices: &[DVec3], transform: &Rigid) -> Story {
    let source = wanted.library.source();
    let edge = wanted.library.known.edge;
    // The known ring says how far the part may be off, here in edges.
    let error = gap(source, wanted.ring, transform, edge / scale_of(&transform.inverse()));
    let confidence = 1.0 / (1.0 + (error / edge).powi(2));
    let mut corner = vec![(0u32, 0usize); cut.of.len()];
    let number: HashMap<u32, usize> = cut.of.iter().enumerate().map(|(i, &v)| (v, i)).collect();
    for &f in &cut.face_of {
        for (k, v) in source.faces[f as usize].iter().enumerate() {
            corner[number[v]] = (f, k);
        }
    }
    let origin = |face: u32, barycentric: [f64; 3]| Origin {
        face: source.face_ids[face as usize],
        barycentric,
        source: 0,
        confidence,
    };
    let of_part = corner.iter().map(|&(f, k)| {
        let mut at = [0.0; 3];
        at[k] = 1.0;
        origin(f, at)
    });
    let back = transform.inverse();
    let of_gap = gap_vertices.iter().map(|&p| {
        let hit = source.tree.closest_point(back.point(p), f64::INFINITY);
        hit.map_or(Origin::NOWHERE, |hit| origin(hit.face, source.barycentric(hit.face, hit.point)))
    });
    let origins: Vec<Origin> = of_part.chain(of_gap).collect();
    let first = cut.face_of.first().map_or(0, |&f| source.face_ids[f as usize]);
    let report = SourceReport {
        transform: source.as_given(transform, first),
        error,
        weight: 1.0,
        vertices: origins.len(),
        coloured: 0,
    };
    let (colours, seams, ring) = (Vec::new(), Vec::new(), Vec::new());
    let sources = vec![report];
    Story { origins, colours, sources, seams, ring, confidence, coherence_error: None }
}
