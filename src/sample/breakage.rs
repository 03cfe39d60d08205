//! Takes pieces out of a sample and keeps them: holes whose truth is known.

use super::noise::{fractal, mix, uniform};
use super::{Sample, SampleMesh, Site};
use crate::error::{Error, Result};

/// What is broken off.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Break {
    /// A piece with a ragged rim: a ball whose surface is disturbed by noise.
    Ragged,
    /// A round piece.
    Disc,
    /// A round piece around three islands that stay.
    Islands,
    /// A band around the object: two loops face each other.
    Ring,
    /// A long, narrow, winding gap.
    Crack,
    /// Five round pieces of different size, at different places.
    Several,
}

impl Break {
    /// All of them.
    pub const ALL: [Break; 6] =
        [Break::Ragged, Break::Disc, Break::Islands, Break::Ring, Break::Crack, Break::Several];

    /// The name in the command line.
    pub fn name(self) -> &'static str {
        match self {
            Break::Ragged => "ragged",
            Break::Disc => "disc",
            Break::Islands => "islands",
            Break::Ring => "ring",
            Break::Crack => "crack",
            Break::Several => "several",
        }
    }

    /// Boundary loops and holes that the break leaves where the mesh is fine enough (edges at most
    /// a tenth of the site's radius).
    pub fn promised(self) -> (usize, usize) {
        match self {
            Break::Ragged | Break::Disc | Break::Crack => (1, 1),
            Break::Islands => (4, 1),
            Break::Ring => (2, 1),
            Break::Several => (5, 5),
        }
    }
}

/// How a sample is broken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BreakOptions {
    /// What is broken off.
    pub kind: Break,
    /// Another seed gives another rim, crack or set of places.
    pub seed: u64,
    /// Size of the piece, as a factor on the sample's own (0.2 to 1.5).
    pub size: f64,
}

/// A broken sample and the piece.
#[derive(Debug, Clone, PartialEq)]
pub struct Broken {
    /// What is left; vertices renumbered in their order, none isolated.
    pub mesh: SampleMesh,
    /// The piece: the truth that a fill is compared with.
    pub removed: SampleMesh,
    /// For each vertex left, its index in the whole sample.
    pub kept_vertices: Vec<u32>,
}

/// One piece to take out: faces whose centroid has a negative `level`, connected to `near`.
struct Cut<'a> {
    near: [f64; 3],
    level: Box<dyn Fn([f64; 3]) -> f64 + 'a>,
}

/// Breaks a piece off `mesh`, which [`Sample::build`] made of `sample`.
///
/// Fails with [`Error::InvalidOption`] when the size is out of range, or so small that no face
/// goes.
pub fn break_mesh(sample: Sample, mesh: &SampleMesh, options: &BreakOptions) -> Result<Broken> {
    if !(0.2..=1.5).contains(&options.size) {
        return Err(Error::InvalidOption {
            name: "size",
            reason: format!("{} is outside 0.2 to 1.5", options.size),
        });
    }
    let site = sample.site();
    let links = Links::of(mesh);
    let mut gone = vec![false; mesh.faces.len()];
    for cut in cuts(mesh, &site, options) {
        take_out(mesh, &links, &cut, &mut gone);
    }
    let crumb = match options.kind {
        Break::Islands => CRUMB_FACES,
        // What the rim has cut off falls out; the two ends that a ring leaves are larger.
        _ => gone.iter().filter(|&&g| g).count() / 2,
    };
    clean(mesh, &links, crumb.max(CRUMB_FACES), &mut gone);
    if !gone.contains(&true) {
        return Err(Error::InvalidOption {
            name: "size",
            reason: "no face is removed: raise the size or the resolution".into(),
        });
    }
    let (left, kept_vertices) = part(mesh, |f| !gone[f]);
    let (removed, _) = part(mesh, |f| gone[f]);
    Ok(Broken { mesh: left, removed, kept_vertices })
}

fn cuts<'a>(mesh: &'a SampleMesh, site: &Site, options: &BreakOptions) -> Vec<Cut<'a>> {
    let (seed, radius) = (options.seed, site.radius * options.size);
    let near = site.point;
    let Site { ring_centre, ring_axis, ring_reach, .. } = *site;
    let one = |level: Box<dyn Fn([f64; 3]) -> f64 + 'a>| vec![Cut { near, level }];
    match options.kind {
        Break::Disc => one(Box::new(move |p| distance(p, near) - radius)),
        Break::Ragged => one(Box::new(move |p| {
            // Waves of 1/2, 1/4 and 1/8 of the radius, at most ±35 % of it together.
            let wave = fractal(seed, p.map(|x| 2.0 * x / radius));
            distance(p, near) - radius * (1.0 + 0.2 * wave)
        })),
        Break::Islands => {
            let islands = islands(mesh, site, radius, seed);
            one(Box::new(move |p| {
                let keep = islands.iter().map(|(c, r)| r - distance(p, *c));
                keep.fold(distance(p, near) - radius, f64::max)
            }))
        }
        // Half as wide as the ragged piece's radius, each side.
        Break::Ring => vec![Cut {
            near: ring_start(mesh, site),
            level: Box::new(move |p| {
                let d = sub(p, ring_centre);
                let wave = 0.15 * fractal(seed, p.map(|x| 2.0 * x / radius));
                let band = dot(d, ring_axis).abs() - radius * (0.5 + wave);
                if dot(d, d).sqrt() > ring_reach {
                    1.0
                } else {
                    band
                }
            }),
        }],
        Break::Crack => {
            let line = crack_line(site, radius, seed);
            // At least 1.5 edges each side, or the gap would not be connected.
            let width = (0.06 * radius).max(1.5 * mean_edge(mesh));
            let normal = site.normal;
            // Seen along the normal: the line is flat, the surface is not.
            one(Box::new(move |p| {
                let height = dot(sub(p, near), normal);
                let flat = std::array::from_fn(|k| p[k] - height * normal[k]);
                line_distance(&line, flat) - width
            }))
        }
        Break::Several => several(mesh, radius, seed),
    }
}

/// Three places on the surface around the middle, half the radius away from it.
fn islands(mesh: &SampleMesh, site: &Site, radius: f64, seed: u64) -> Vec<([f64; 3], f64)> {
    let (u, v) = tangents(site.normal);
    let turn = std::f64::consts::TAU * uniform(seed, 7);
    (0..3)
        .map(|i| {
            let (sin, cos) = (turn + std::f64::consts::TAU * i as f64 / 3.0).sin_cos();
            let c =
                std::array::from_fn(|k| site.point[k] + 0.52 * radius * (cos * u[k] + sin * v[k]));
            let off = |p: &[f64; 3]| distance(*p, c);
            let on_surface = mesh
                .vertices
                .iter()
                .map(|v| v.map(f64::from))
                .min_by(|p, q| off(p).total_cmp(&off(q)));
            (on_surface.unwrap_or(c), radius * (0.19 + 0.06 * uniform(seed, 8 + i)))
        })
        .collect()
}

/// The vertex in the middle of the band nearest to the front: where the band's faces are sought.
fn ring_start(mesh: &SampleMesh, site: &Site) -> [f64; 3] {
    let off = |p: [f64; 3]| {
        let d = sub(p, site.ring_centre);
        if dot(d, d).sqrt() > site.ring_reach {
            f64::INFINITY
        } else {
            dot(d, site.ring_axis).abs()
        }
    };
    mesh.vertices
        .iter()
        .map(|v| v.map(f64::from))
        .min_by(|a, b| off(*a).total_cmp(&off(*b)))
        .unwrap_or(site.point)
}

/// A winding line through the site, in its tangent plane, 2.2 radii long.
fn crack_line(site: &Site, radius: f64, seed: u64) -> Vec<[f64; 3]> {
    let (u, v) = tangents(site.normal);
    (0..=32)
        .map(|i| {
            let t = 1.1 * radius * (i as f64 / 16.0 - 1.0);
            let side = 0.35 * radius * fractal(seed, [t / radius * 1.3, 0.5, 0.5]);
            // Mostly upward, a little across: along neither u nor v of a structured mesh.
            std::array::from_fn(|k| site.point[k] + t * (0.4 * u[k] + 0.92 * v[k]) + side * u[k])
        })
        .collect()
}

/// Five discs at random vertices that stay clear of each other.
fn several<'a>(mesh: &SampleMesh, radius: f64, seed: u64) -> Vec<Cut<'a>> {
    let mut places: Vec<([f64; 3], f64)> = Vec::new();
    // A few hundred tries place five small discs on any of the models.
    for attempt in 0..1000 {
        if places.len() == 5 {
            break;
        }
        let pick = (mix(seed, 100 + attempt) % mesh.vertices.len() as u64) as usize;
        let p = mesh.vertices[pick].map(f64::from);
        let r = radius * [0.5, 0.42, 0.36, 0.3, 0.25][places.len()];
        if places.iter().all(|(q, s)| distance(p, *q) > 1.6 * (r + s)) {
            places.push((p, r));
        }
    }
    places
        .into_iter()
        .map(|(c, r)| Cut { near: c, level: Box::new(move |p| distance(p, c) - r) as _ })
        .collect()
}

/// The faces across each edge of each face. The sample is closed, so each edge has two.
struct Links(Vec<[u32; 3]>);

impl Links {
    fn of(mesh: &SampleMesh) -> Self {
        let mut halves: Vec<(u32, u32, u32, u8)> = Vec::with_capacity(3 * mesh.faces.len());
        for (f, face) in mesh.faces.iter().enumerate() {
            for k in 0..3 {
                let (a, b) = (face[k], face[(k + 1) % 3]);
                halves.push((a.min(b), a.max(b), f as u32, k as u8));
            }
        }
        halves.sort_unstable();
        let mut links = vec![[u32::MAX; 3]; mesh.faces.len()];
        for pair in halves.chunk_by(|x, y| (x.0, x.1) == (y.0, y.1)) {
            if let [x, y] = pair {
                links[x.2 as usize][x.3 as usize] = y.2;
                links[y.2 as usize][y.3 as usize] = x.2;
            }
        }
        Links(links)
    }

    /// The faces reached from `start` over edges, through faces that `inside` accepts.
    fn flood(&self, start: usize, seen: &mut [bool], inside: impl Fn(usize) -> bool) -> Vec<usize> {
        let mut found = vec![start];
        seen[start] = true;
        let mut next = 0;
        while next < found.len() {
            for &g in &self.0[found[next]] {
                let g = g as usize;
                if g < seen.len() && !seen[g] && inside(g) {
                    seen[g] = true;
                    found.push(g);
                }
            }
            next += 1;
        }
        found
    }
}

/// Takes out the connected piece nearest to the cut's place: the far wall of a thin object that
/// the ball also reaches stays.
fn take_out(mesh: &SampleMesh, links: &Links, cut: &Cut, gone: &mut [bool]) {
    let inside: Vec<bool> =
        (0..mesh.faces.len()).map(|f| (cut.level)(mesh.centroid(f)) < 0.0).collect();
    let nearest = (0..mesh.faces.len()).filter(|&f| inside[f]).min_by(|&f, &g| {
        let d = |f| distance(mesh.centroid(f), cut.near);
        d(f).total_cmp(&d(g))
    });
    if let Some(start) = nearest {
        let mut seen = vec![false; mesh.faces.len()];
        for f in links.flood(start, &mut seen, |f| inside[f]) {
            gone[f] = true;
        }
    }
}

/// Islands of fewer faces than this are crumbs and fall out; gaps of fewer are closed again.
const CRUMB_FACES: usize = 12;

/// Removes crumbs, closes specks, and takes out faces around every vertex where the rim would
/// touch itself, until nothing changes. Ends: each round but the first only takes out.
fn clean(mesh: &SampleMesh, links: &Links, crumb: usize, gone: &mut [bool]) {
    for f in small_parts(links, gone, true, CRUMB_FACES) {
        gone[f] = false;
    }
    loop {
        let mut out = pinched_faces(mesh, gone);
        if out.is_empty() {
            out = small_parts(links, gone, false, crumb);
        }
        if out.is_empty() {
            return;
        }
        for f in out {
            gone[f] = true;
        }
    }
}

/// Faces of connected parts of fewer than `crumb` faces, of those whose `gone` equals `value`.
fn small_parts(links: &Links, gone: &[bool], value: bool, crumb: usize) -> Vec<usize> {
    let mut seen = vec![false; gone.len()];
    let mut small = Vec::new();
    for f in 0..gone.len() {
        if gone[f] == value && !seen[f] {
            let found = links.flood(f, &mut seen, |g| gone[g] == value);
            if found.len() < crumb {
                small.extend(found);
            }
        }
    }
    small
}

/// The faces left around vertices that the rim would pass more than once.
fn pinched_faces(mesh: &SampleMesh, gone: &[bool]) -> Vec<usize> {
    // Each face left that meets a vertex by one edge ends a fan; a vertex inside has no end. A
    // vertex with e incoming boundary edges has e fans.
    let mut edges = std::collections::HashSet::new();
    for (f, face) in mesh.faces.iter().enumerate() {
        if gone[f] {
            for k in 0..3 {
                edges.insert((face[k], face[(k + 1) % 3]));
            }
        }
    }
    let mut fans = std::collections::HashMap::new();
    for &(a, b) in &edges {
        if !edges.contains(&(b, a)) {
            *fans.entry(a).or_insert(0) += 1;
        }
    }
    let pinched = |v: &u32| fans.get(v).is_some_and(|&n| n > 1);
    (0..mesh.faces.len()).filter(|&f| !gone[f] && mesh.faces[f].iter().any(pinched)).collect()
}

/// The faces that `keep` accepts, their vertices in order, and the vertices' old indices.
fn part(mesh: &SampleMesh, keep: impl Fn(usize) -> bool) -> (SampleMesh, Vec<u32>) {
    let mut used = vec![false; mesh.vertices.len()];
    let faces: Vec<[u32; 3]> =
        (0..mesh.faces.len()).filter(|&f| keep(f)).map(|f| mesh.faces[f]).collect();
    for v in faces.iter().flatten() {
        used[*v as usize] = true;
    }
    let mut number = vec![0u32; used.len()];
    let mut old = Vec::new();
    for v in 0..used.len() {
        if used[v] {
            number[v] = old.len() as u32;
            old.push(v as u32);
        }
    }
    let part = SampleMesh {
        vertices: old.iter().map(|&v| mesh.vertices[v as usize]).collect(),
        faces: faces.iter().map(|f| f.map(|v| number[v as usize])).collect(),
    };
    (part, old)
}

fn mean_edge(mesh: &SampleMesh) -> f64 {
    let edges = mesh.faces.iter().enumerate().flat_map(|(f, _)| {
        let c = mesh.corners(f);
        [distance(c[0], c[1]), distance(c[1], c[2]), distance(c[2], c[0])]
    });
    edges.sum::<f64>() / (3 * mesh.faces.len().max(1)) as f64
}

fn line_distance(line: &[[f64; 3]], p: [f64; 3]) -> f64 {
    let to_segment = |a: [f64; 3], b: [f64; 3]| {
        let (d, e) = (sub(b, a), sub(p, a));
        let t = (dot(d, e) / dot(d, d).max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        let off: [f64; 3] = std::array::from_fn(|k| e[k] - t * d[k]);
        dot(off, off).sqrt()
    };
    line.windows(2).map(|w| to_segment(w[0], w[1])).fold(f64::INFINITY, f64::min)
}

/// Two unit vectors across `n`: sideways and, as far as `n` allows, up (y).
fn tangents(n: [f64; 3]) -> ([f64; 3], [f64; 3]) {
    let up = if n[1].abs() > 0.9 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
    let u = [up[1] * n[2] - up[2] * n[1], up[2] * n[0] - up[0] * n[2], up[0] * n[1] - up[1] * n[0]];
    let length = dot(u, u).sqrt();
    let u = u.map(|x| x / length);
    (u, [n[1] * u[2] - n[2] * u[1], n[2] * u[0] - n[0] * u[2], n[0] * u[1] - n[1] * u[0]])
}

fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| a[k] - b[k])
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    let d = sub(a, b);
    dot(d, d).sqrt()
}
