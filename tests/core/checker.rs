//! The contract, counted anew: shares no code with the library but the test of two triangles.

use crate::meshes::Mesh;
use complete_mesh::intersect::triangles_intersect;
use complete_mesh::{complete_mesh, find_holes, Completion, HoleStatus, Monitor, Options};
use glam::DVec3;
use std::collections::{HashMap, HashSet};

/// How often each directed edge is run.
pub fn half_edges(faces: &[[u32; 3]]) -> HashMap<(u32, u32), usize> {
    let mut count = HashMap::new();
    for f in faces {
        for k in 0..3 {
            *count.entry((f[k], f[(k + 1) % 3])).or_insert(0) += 1;
        }
    }
    count
}

/// Directed edges without a partner, sorted.
pub fn open_edges(faces: &[[u32; 3]]) -> Vec<(u32, u32)> {
    let count = half_edges(faces);
    let mut open: Vec<(u32, u32)> =
        count.keys().filter(|&&(a, b)| !count.contains_key(&(b, a))).copied().collect();
    open.sort_unstable();
    open
}

/// V - E + F over the vertices that faces use.
pub fn euler(faces: &[[u32; 3]]) -> i64 {
    let mut used: Vec<u32> = faces.iter().flatten().copied().collect();
    used.sort_unstable();
    used.dedup();
    let sides = |f: &[u32; 3]| [(f[0], f[1]), (f[1], f[2]), (f[2], f[0])];
    let mut edges: Vec<(u32, u32)> =
        faces.iter().flat_map(sides).map(|(a, b)| (a.min(b), a.max(b))).collect();
    edges.sort_unstable();
    edges.dedup();
    used.len() as i64 - edges.len() as i64 + faces.len() as i64
}

/// Pieces that hang together by vertices.
pub fn components(faces: &[[u32; 3]]) -> usize {
    let count = faces.iter().flatten().max().map_or(0, |&v| v as usize + 1);
    let mut parent: Vec<usize> = (0..count).collect();
    fn root(parent: &mut [usize], mut v: usize) -> usize {
        while parent[v] != v {
            parent[v] = parent[parent[v]];
            v = parent[v];
        }
        v
    }
    for f in faces {
        for k in 1..3 {
            let (a, b) = (root(&mut parent, f[0] as usize), root(&mut parent, f[k] as usize));
            parent[a.max(b)] = a.min(b);
        }
    }
    let mut roots: Vec<usize> = faces.iter().map(|f| root(&mut parent, f[0] as usize)).collect();
    roots.sort_unstable();
    roots.dedup();
    roots.len()
}

/// The whole mesh of a completion, and an error for the first broken promise. The input must be
/// manifold itself. `rims` are the loops of the filled holes, in input vertices.
pub fn check(
    vertices: &[[f64; 3]],
    faces: &[[u32; 3]],
    made: &Completion,
    rims: &[Vec<u32>],
) -> Result<Vec<[u32; 3]>, String> {
    let (all_vertices, all) = made.to_mesh_f64(vertices, faces);
    let bits =
        |v: &[[f64; 3]]| -> Vec<[u64; 3]> { v.iter().map(|p| p.map(f64::to_bits)).collect() };
    if bits(&all_vertices[..vertices.len()]) != bits(vertices) || all[..faces.len()] != *faces {
        return Err("the input does not come first, bit for bit".into());
    }
    check_reports(made)?;
    if !made.vertices.iter().flatten().all(|x| x.is_finite()) {
        return Err("a new vertex is not finite".into());
    }
    if let Some(f) = made.faces.iter().find(|f| f.iter().any(|&v| v as usize >= all_vertices.len()))
    {
        return Err(format!("face {f:?} is out of range"));
    }
    check_connectivity(faces, &all, rims)?;
    let used: HashSet<u32> = made.faces.iter().flatten().copied().collect();
    let first = vertices.len() as u32;
    if let Some(v) = (first..all_vertices.len() as u32).find(|v| !used.contains(v)) {
        return Err(format!("new vertex {v} is in no face"));
    }
    check_intersections(&all_vertices, &all, faces.len())?;
    Ok(all)
}

fn check_reports(made: &Completion) -> Result<(), String> {
    let (mut vertices, mut faces) = (0, 0);
    for report in &made.holes {
        if report.status != HoleStatus::Filled {
            if !report.vertices.is_empty() || !report.faces.is_empty() {
                return Err(format!("hole {} is open but has a fill", report.hole));
            }
            continue;
        }
        if report.vertices.start != vertices || report.faces.start != faces {
            return Err(format!("the fill of hole {} is not where it should be", report.hole));
        }
        (vertices, faces) = (report.vertices.end, report.faces.end);
        let id = report.hole as u32;
        if made.vertex_hole[report.vertices.clone()].iter().any(|&h| h != id)
            || made.face_hole[report.faces.clone()].iter().any(|&h| h != id)
        {
            return Err(format!("an element of hole {id} names another"));
        }
    }
    if (vertices, faces) != (made.vertices.len(), made.faces.len()) {
        return Err("the reports do not cover all that is new".into());
    }
    Ok(())
}

fn check_connectivity(
    input: &[[u32; 3]],
    all: &[[u32; 3]],
    rims: &[Vec<u32>],
) -> Result<(), String> {
    let mut seen = HashSet::new();
    for f in all {
        let mut key = *f;
        key.sort_unstable();
        if key[0] == key[1] || key[1] == key[2] {
            return Err(format!("face {f:?} names a vertex twice"));
        }
        if !seen.insert(key) {
            return Err(format!("face {f:?} is there twice"));
        }
    }
    let count = half_edges(all);
    // Each directed edge at most once: so at most two faces, and oppositely run.
    if let Some((e, _)) = count.iter().find(|(_, &n)| n > 1) {
        return Err(format!("edge {e:?} is run twice the same way"));
    }
    // What stays open is what was open, less exactly the rims that were filled.
    let mut expected: HashSet<(u32, u32)> = open_edges(input).into_iter().collect();
    for rim in rims {
        for i in 0..rim.len() {
            if !expected.remove(&(rim[(i + 1) % rim.len()], rim[i])) {
                return Err("a rim is no boundary of the input".into());
            }
        }
    }
    let open: HashSet<(u32, u32)> =
        count.keys().filter(|&&(a, b)| !count.contains_key(&(b, a))).copied().collect();
    if open != expected {
        let odd = open.symmetric_difference(&expected).next();
        return Err(format!("the boundary left is not the one expected, e.g. at {odd:?}"));
    }
    check_fans(all, &rims.iter().flatten().copied().collect(), input)
}

/// The faces around each new or rim vertex make one fan.
fn check_fans(all: &[[u32; 3]], rim: &HashSet<u32>, input: &[[u32; 3]]) -> Result<(), String> {
    let mut old: Vec<bool> = vec![false; all.iter().flatten().max().map_or(0, |&v| v as usize + 1)];
    input.iter().flatten().for_each(|&v| old[v as usize] = true);
    let mut around: HashMap<u32, Vec<(u32, u32)>> = HashMap::new();
    for f in all {
        for k in 0..3 {
            if rim.contains(&f[k]) || !old[f[k] as usize] {
                around.entry(f[k]).or_default().push((f[(k + 1) % 3], f[(k + 2) % 3]));
            }
        }
    }
    for (v, spokes) in &around {
        let next: HashMap<u32, u32> = spokes.iter().copied().collect();
        let ends: HashSet<u32> = spokes.iter().map(|s| s.1).collect();
        // An open fan starts where nothing arrives.
        let start = next.keys().find(|w| !ends.contains(w)).unwrap_or(&spokes[0].0);
        let (mut at, mut steps) = (*start, 0);
        while let Some(&w) = next.get(&at) {
            (at, steps) = (w, steps + 1);
            if at == *start {
                break;
            }
        }
        if steps != spokes.len() {
            return Err(format!("vertex {v} has more than one fan"));
        }
    }
    Ok(())
}

/// New faces against all faces, by a sweep along x.
fn check_intersections(points: &[[f64; 3]], all: &[[u32; 3]], new: usize) -> Result<(), String> {
    let corners = |f: usize| all[f].map(|v| DVec3::from(points[v as usize]));
    let bounds: Vec<(DVec3, DVec3)> =
        (0..all.len()).map(corners).map(|[a, b, c]| (a.min(b).min(c), a.max(b).max(c))).collect();
    let lowest = bounds[new..].iter().fold(DVec3::INFINITY, |m, b| m.min(b.0));
    let highest = bounds[new..].iter().fold(DVec3::NEG_INFINITY, |m, b| m.max(b.1));
    let near = |f: &usize| bounds[*f].0.cmple(highest).all() && bounds[*f].1.cmpge(lowest).all();
    let mut order: Vec<usize> = (0..all.len()).filter(near).collect();
    order.sort_by(|&a, &b| bounds[a].0.x.total_cmp(&bounds[b].0.x));
    let mut active: Vec<usize> = Vec::new();
    for &f in &order {
        let (min, max) = bounds[f];
        active.retain(|&g| bounds[g].1.x >= min.x);
        for &g in &active {
            let (gmin, gmax) = bounds[g];
            if (f < new && g < new)
                || gmin.y > max.y
                || gmax.y < min.y
                || gmin.z > max.z
                || gmax.z < min.z
            {
                continue;
            }
            if triangles_intersect(&corners(f), &corners(g)) {
                return Err(format!("faces {:?} and {:?} intersect", all[f], all[g]));
            }
        }
        active.push(f);
    }
    Ok(())
}

/// Greatest extent of a mesh along an axis.
pub fn extent(points: &[[f64; 3]]) -> f64 {
    let p = || points.iter().map(|&p| DVec3::from(p));
    let min = p().fold(DVec3::INFINITY, DVec3::min);
    (p().fold(DVec3::NEG_INFINITY, DVec3::max) - min).max_element()
}

/// The loops of the holes that a completion filled.
pub fn filled_rims(made: &Completion, list: &complete_mesh::HoleList) -> Vec<Vec<u32>> {
    made.holes
        .iter()
        .filter(|h| h.status == HoleStatus::Filled)
        .flat_map(|h| h.loops.iter().map(|&l| list.loops[l].vertices.clone()))
        .collect()
}

/// Completes a mesh and checks the contract.
pub fn complete_checked(mesh: &Mesh, options: &Options) -> Completion {
    let made = complete_mesh(&mesh.vertices[..], &mesh.faces[..], options).unwrap();
    let list = find_holes(mesh.view(), &options.grouping, &Monitor::silent()).unwrap();
    check(&mesh.vertices, &mesh.faces, &made, &filled_rims(&made, &list)).unwrap();
    made
}

mod itself {
    //! A checker that lets everything pass would prove nothing.
    use super::*;
    use crate::meshes::tetrahedron_without_floor;
    use complete_mesh::Sizing;

    #[test]
    fn broken_promises_are_noticed() {
        let mesh = tetrahedron_without_floor();
        let options = Options { sizing: Sizing::None, ..Options::default() };
        let good = complete_mesh(&mesh.vertices[..], &mesh.faces[..], &options).unwrap();
        let rims = [vec![0, 2, 1]];
        let test = |c: &Completion| check(&mesh.vertices, &mesh.faces, c, &rims);
        test(&good).unwrap();
        let broken = |change: &dyn Fn(&mut Completion), words: &str| {
            let mut bad = good.clone();
            change(&mut bad);
            let said = test(&bad).unwrap_err();
            assert!(said.contains(words), "{said}");
        };
        broken(&|c| c.faces[0].swap(0, 1), "twice the same way");
        broken(&|c| c.faces[0][0] = 9, "out of range");
        broken(&|c| c.faces[0][0] = c.faces[0][1], "names a vertex twice");
        broken(&|c| c.faces[0] = mesh.faces[0], "there twice");
        broken(&|c| c.face_hole[0] = 1, "names another");
        let drop_face = |c: &mut Completion| {
            c.faces.clear();
            c.face_hole.clear();
            c.holes[0].faces = 0..0;
        };
        broken(&drop_face, "boundary left");
        let add_vertex = |c: &mut Completion, p: [f64; 3]| {
            c.vertices.push(p);
            c.vertex_hole.push(0);
            c.holes[0].vertices = 0..1;
        };
        broken(&|c| add_vertex(c, [0.2, 0.2, 0.2]), "in no face");
        broken(&|c| add_vertex(c, [f64::NAN; 3]), "not finite");
        // A floor pulled up through the walls.
        let through = |c: &mut Completion| {
            add_vertex(c, [2.0, 2.0, 2.0]);
            let [a, b, d] = c.faces[0];
            c.faces = vec![[a, b, 4], [b, d, 4], [d, a, 4]];
            c.face_hole = vec![0; 3];
            c.holes[0].faces = 0..3;
        };
        broken(&through, "intersect");
    }
}
