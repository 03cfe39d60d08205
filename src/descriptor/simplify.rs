//! Simplification by edge collapses (Garland and Heckbert 1997, "Surface simplification using
//! quadric error metrics"), to triangles of even size or to planes.
//!
//! Differences from the paper:
//! - Besides the squared distances to planes, the quadric of a vertex holds the squared distances
//!   to the vertices merged into it, each times its mass: E(x) = Σ a (n·x + d)² + w Σ m |x − p|².
//!   A little of it ([`Cost::Quadric`]) says what to do where the surface is flat. More of it
//!   ([`Cost::Uniform`]) makes clusters of even size, in the manner of Ward (1963), and thereby
//!   even triangles, as spectra need them: see `docs/spectrum.md` for the figures.
//! - Only edges are collapsed, never pairs of vertices apart, so the topology stays.
//! - A collapse must keep the mesh manifold (link condition), turn no face over and make no
//!   needles. A boundary vertex only moves along the boundary.
//! - The queue is an array of buckets, not a heap: edges whose costs differ by less than half come
//!   last in, first out, which keeps the work in one place of the memory.

use crate::error::Result;
use crate::mesh::neighbourhood::{Bounds, NONE};
use crate::progress::Monitor;
use glam::DVec3;

/// What a collapse shall cost.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cost {
    /// Vertices spread evenly over the surface.
    Uniform,
    /// Vertices where the surface is curved: the paper's cost.
    Quadric,
}

/// Weight w of the squared distances to vertices, see the top. Of 0.1, 0.3 and 1 the one with the
/// least error of the heat kernel signature (`docs/spectrum.md`).
const UNIFORM_SPREAD: f64 = 0.1;
/// The same for [`Cost::Quadric`]: small against 1, large against rounding.
const QUADRIC_SPREAD: f64 = 1e-3;
/// Weight of the planes that hold a boundary, in squares of its edges. Own choice; the paper says
/// "a large penalty".
const BOUNDARY_WEIGHT: f64 = 10.0;
/// Least cosine between the normals of a face before and after a collapse (about 75°); meshoptimizer
/// takes the same.
const LEAST_COSINE: f64 = 0.25;
/// Least quality (1 is equilateral) of a face made by a collapse, unless it was worse before. Own
/// choice: an angle of about 4°.
const LEAST_QUALITY: f64 = 0.1;
/// Collapses between two looks at the monitor: some 2 ms.
const BEAT: usize = 2048;
/// Mantissa bits of the cost that choose the bucket: a width of up to 50 %, in edge lengths 10 %, as
/// costs grow with the fourth power. Measured on 134k vertices: as even as with 6 bits (1.6 %), and
/// 0.34 instead of 0.45 CPU seconds; with 0 bits slivers appear.
const BUCKET_BITS: u32 = 1;

/// A coarse mesh and where the fine one's vertices went.
#[derive(Debug, Clone, Default)]
pub struct Coarse {
    /// Positions, in mesh units.
    pub positions: Vec<DVec3>,
    /// Triangles, oriented as on the fine mesh.
    pub faces: Vec<[u32; 3]>,
    /// The coarse vertex that each fine vertex was merged into; [`NONE`] for vertices without faces.
    pub parent: Vec<u32>,
}

/// Collapses edges until about `target` vertices are left, or none can be collapsed.
///
/// Faces with a repeated vertex and vertices without faces are dropped; else nothing happens to a
/// mesh of at most `target` vertices. Each component keeps at least a triangle or a tetrahedron.
/// Edges of more than two faces and vertices where boundaries touch stay as they are. Face indices
/// must be below `positions.len()`. The result depends on nothing but the arguments.
pub fn simplify(
    positions: &[DVec3],
    faces: &[[u32; 3]],
    target: usize,
    cost: Cost,
    monitor: &Monitor,
) -> Result<Coarse> {
    let mut mesh = Mesh::new(positions, faces);
    monitor.check()?;
    if mesh.vertex_count > target {
        let spread = match cost {
            Cost::Uniform => UNIFORM_SPREAD,
            Cost::Quadric => QUADRIC_SPREAD,
        };
        mesh.collapse_until(target, spread, monitor)?;
    }
    Ok(mesh.into_coarse(positions))
}

/// E(x) = xᵀ A x + 2 bᵀ x + c with symmetric A.
#[derive(Debug, Clone, Copy, Default)]
struct Quadric {
    /// xx, yy, zz, xy, xz, yz.
    a: [f64; 6],
    b: DVec3,
    c: f64,
}

impl Quadric {
    /// `weight` times the squared distance to the plane n·x + d = 0.
    fn plane(n: DVec3, d: f64, weight: f64) -> Self {
        let a = [n.x * n.x, n.y * n.y, n.z * n.z, n.x * n.y, n.x * n.z, n.y * n.z];
        Self { a: a.map(|x| weight * x), b: weight * d * n, c: weight * d * d }
    }

    /// `weight` times the squared distance to a point.
    fn point(p: DVec3, weight: f64) -> Self {
        let a = [weight, weight, weight, 0.0, 0.0, 0.0];
        Self { a, b: -weight * p, c: weight * p.length_squared() }
    }

    fn add(&mut self, o: &Self) {
        for k in 0..6 {
            self.a[k] += o.a[k];
        }
        self.b += o.b;
        self.c += o.c;
    }

    fn at(&self, p: DVec3) -> f64 {
        let [xx, yy, zz, xy, xz, yz] = self.a;
        let ax = DVec3::new(
            xx * p.x + xy * p.y + xz * p.z,
            xy * p.x + yy * p.y + yz * p.z,
            xz * p.x + yz * p.y + zz * p.z,
        );
        (ax + 2.0 * self.b).dot(p) + self.c
    }

    /// The point of least E, by Cholesky; `None` if A is singular to rounding.
    fn minimizer(&self) -> Option<DVec3> {
        let [xx, yy, zz, xy, xz, yz] = self.a;
        let least = 1e-12 * (xx + yy + zz);
        let (l10, l20) = (xy / xx, xz / xx);
        let d1 = yy - l10 * xy;
        let m21 = yz - l20 * xy;
        let l21 = m21 / d1;
        let d2 = zz - l20 * xz - l21 * m21;
        // Written so that NaN fails.
        if !(xx > least && d1 > least && d2 > least) {
            return None;
        }
        let r = -self.b;
        let y1 = r.y - l10 * r.x;
        let y2 = r.z - l20 * r.x - l21 * y1;
        let z = y2 / d2;
        let y = y1 / d1 - l21 * z;
        Some(DVec3::new(r.x / xx - l10 * y - l20 * z, y, z))
    }
}

/// An edge in the queue; out of date if one of its ends has changed since.
#[derive(Clone, Copy)]
struct Entry {
    ends: [u32; 2],
    /// Sum of the stamps of the ends.
    stamp: u32,
}

/// Buckets by the leading bits of the cost.
struct Queue {
    buckets: Vec<Vec<Entry>>,
    lowest: usize,
}

impl Queue {
    fn new() -> Self {
        Self { buckets: vec![Vec::new(); 1 << (8 + BUCKET_BITS)], lowest: usize::MAX }
    }

    fn push(&mut self, cost: f64, entry: Entry) {
        // The sign is 0 and so no bucket beyond the last; NaN comes after all numbers.
        let at = ((cost.max(0.0) as f32).to_bits() >> (23 - BUCKET_BITS)) as usize;
        self.buckets[at].push(entry);
        self.lowest = self.lowest.min(at);
    }

    fn pop(&mut self) -> Option<Entry> {
        while let Some(bucket) = self.buckets.get_mut(self.lowest) {
            if let Some(entry) = bucket.pop() {
                return Some(entry);
            }
            self.lowest += 1;
        }
        None
    }
}

/// Faces at each vertex as spans of one pool, which grows at its end.
struct Spans {
    start: Vec<u32>,
    len: Vec<u32>,
    pool: Vec<u32>,
}

impl Spans {
    fn new(vertices: usize, faces: &[[u32; 3]]) -> Self {
        let mut len = vec![0u32; vertices];
        faces.iter().flatten().for_each(|&v| len[v as usize] += 1);
        let mut sum = 0;
        let start: Vec<u32> = len
            .iter()
            .map(|&n| {
                sum += n;
                sum - n
            })
            .collect();
        let mut next = start.clone();
        let mut pool = vec![0; 3 * faces.len()];
        for (f, face) in faces.iter().enumerate() {
            for &v in face {
                pool[next[v as usize] as usize] = f as u32;
                next[v as usize] += 1;
            }
        }
        Self { start, len, pool }
    }

    fn of(&self, v: u32) -> &[u32] {
        let start = self.start[v as usize] as usize;
        &self.pool[start..start + self.len[v as usize] as usize]
    }

    fn remove(&mut self, v: u32, face: u32) {
        let (start, len) = (self.start[v as usize] as usize, self.len[v as usize] as usize);
        let span = &mut self.pool[start..start + len];
        if let Some(at) = span.iter().position(|&f| f == face) {
            span.swap(at, len - 1);
            self.len[v as usize] -= 1;
        }
    }

    /// Gives `to` the faces of both.
    fn merge(&mut self, to: u32, from: u32) {
        let (a, b) = (self.of(to), self.of(from));
        let count = (a.len() + b.len()) as u32;
        let (a, b) = (self.start[to as usize] as usize, self.start[from as usize] as usize);
        let (a, b) =
            (a..a + self.len[to as usize] as usize, b..b + self.len[from as usize] as usize);
        self.start[to as usize] = self.pool.len() as u32;
        self.pool.extend_from_within(a);
        self.pool.extend_from_within(b);
        self.len[to as usize] = count;
        self.len[from as usize] = 0;
    }
}

/// What a vertex may do.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Inner,
    Boundary,
    /// At an edge of more than two faces, or where boundaries touch: stays.
    Locked,
}

struct Mesh {
    center: DVec3,
    size: f64,
    positions: Vec<DVec3>,
    faces: Vec<[u32; 3]>,
    spans: Spans,
    kind: Vec<Kind>,
    stamp: Vec<u32>,
    /// Who a vertex was merged into; itself while it lives.
    parent: Vec<u32>,
    vertex_count: usize,
    /// Marks of vertices: which round put it there.
    mark: Vec<u32>,
    round: u32,
    /// Scratch: the neighbours of a vertex.
    ring: Vec<u32>,
}

impl Mesh {
    /// The mesh in coordinates from its centre in units of its size, since quadrics square them.
    fn new(positions: &[DVec3], faces: &[[u32; 3]]) -> Self {
        let whole = |f: &&[u32; 3]| f[0] != f[1] && f[1] != f[2] && f[2] != f[0];
        let faces: Vec<[u32; 3]> = faces.iter().filter(whole).copied().collect();
        let bounds = Bounds::of(positions.iter().copied());
        let center = 0.5 * (bounds.min + bounds.max);
        let size = (bounds.max - bounds.min).max_element().max(f64::MIN_POSITIVE);
        let n = positions.len();
        let spans = Spans::new(n, &faces);
        let vertex_count = spans.len.iter().filter(|&&n| n > 0).count();
        Self {
            center,
            size,
            positions: positions.iter().map(|&p| (p - center) / size).collect(),
            faces,
            spans,
            kind: vec![Kind::Inner; n],
            stamp: vec![0; n],
            parent: (0..n as u32).collect(),
            vertex_count,
            mark: vec![0; n],
            round: 0,
            ring: Vec::new(),
        }
    }

    fn collapse_until(&mut self, target: usize, spread: f64, monitor: &Monitor) -> Result<()> {
        let mut quadrics = self.quadrics(spread);
        let edges = self.classify(&mut quadrics);
        monitor.check()?;
        let mut queue = Queue::new();
        for (i, ends) in edges.into_iter().enumerate() {
            if i % (BEAT * 16) == 0 {
                monitor.check()?;
            }
            self.enqueue(&mut queue, &quadrics, ends);
        }
        let mut done = 0;
        while self.vertex_count > target {
            let Some(entry) = queue.pop() else { break };
            let [u, v] = entry.ends;
            let is_old = self.spans.len[u as usize] == 0
                || self.spans.len[v as usize] == 0
                || self.stamp[u as usize] + self.stamp[v as usize] != entry.stamp;
            if is_old {
                continue;
            }
            let (_, place) = self.best_place(&quadrics, entry.ends);
            if !self.may_collapse(u, v, place) {
                continue;
            }
            self.collapse(u, v, place);
            let other = quadrics[v as usize];
            quadrics[u as usize].add(&other);
            self.neighbours(u);
            let ring = std::mem::take(&mut self.ring);
            ring.iter().for_each(|&w| self.enqueue(&mut queue, &quadrics, [u, w]));
            self.ring = ring;
            done += 1;
            if done % BEAT == 0 {
                monitor.check()?;
            }
        }
        Ok(())
    }

    /// Planes of the faces and the vertices' own positions, a third of the area each.
    fn quadrics(&self, spread: f64) -> Vec<Quadric> {
        let mut quadrics = vec![Quadric::default(); self.positions.len()];
        let mut mass = vec![0.0; self.positions.len()];
        for face in &self.faces {
            let [a, b, c] = face.map(|v| self.positions[v as usize]);
            let normal = (b - a).cross(c - a);
            let length = normal.length();
            if length > 0.0 {
                let n = normal / length;
                let q = Quadric::plane(n, -n.dot(a), length / 6.0);
                for &v in face {
                    quadrics[v as usize].add(&q);
                    mass[v as usize] += length / 6.0;
                }
            }
        }
        for (v, q) in quadrics.iter_mut().enumerate() {
            q.add(&Quadric::point(self.positions[v], spread * mass[v]));
        }
        quadrics
    }

    /// Finds all edges, boundaries and what cannot be touched; adds the quadrics that hold
    /// boundaries: planes through a boundary edge across its face, as in the paper.
    fn classify(&mut self, quadrics: &mut [Quadric]) -> Vec<[u32; 2]> {
        let mut edges = Vec::with_capacity(3 * self.faces.len() / 2);
        let mut boundary_edges = vec![0u8; self.positions.len()];
        // Neighbours of a vertex with the number of faces at the edge and one of them.
        let mut ring: Vec<(u32, u32, u32)> = Vec::new();
        for u in 0..self.positions.len() as u32 {
            ring.clear();
            for &f in self.spans.of(u) {
                for w in self.faces[f as usize] {
                    match ring.iter_mut().find(|e| e.0 == w) {
                        _ if w <= u => {}
                        Some(e) => e.1 += 1,
                        None => ring.push((w, 1, f)),
                    }
                }
            }
            for &(w, count, f) in &ring {
                edges.push([u, w]);
                if count > 2 {
                    self.kind[u as usize] = Kind::Locked;
                    self.kind[w as usize] = Kind::Locked;
                }
                if count != 1 {
                    continue;
                }
                let [a, b, c] = self.faces[f as usize].map(|v| self.positions[v as usize]);
                let (p, q) = (self.positions[u as usize], self.positions[w as usize]);
                let across = (b - a).cross(c - a).cross(q - p).normalize_or_zero();
                let weight = BOUNDARY_WEIGHT * p.distance_squared(q);
                let plane = Quadric::plane(across, -across.dot(p), weight);
                for v in [u as usize, w as usize] {
                    quadrics[v].add(&plane);
                    boundary_edges[v] = boundary_edges[v].saturating_add(1);
                    if self.kind[v] == Kind::Inner {
                        self.kind[v] = Kind::Boundary;
                    }
                }
            }
        }
        for (kind, &count) in self.kind.iter_mut().zip(&boundary_edges) {
            if count > 2 {
                *kind = Kind::Locked;
            }
        }
        edges
    }

    fn enqueue(&self, queue: &mut Queue, quadrics: &[Quadric], ends: [u32; 2]) {
        let [u, v] = ends.map(|v| v as usize);
        if self.kind[u] == Kind::Locked && self.kind[v] == Kind::Locked {
            return;
        }
        let (cost, _) = self.best_place(quadrics, ends);
        queue.push(cost, Entry { ends, stamp: self.stamp[u] + self.stamp[v] });
    }

    /// Where two vertices would meet, and the cost of that.
    fn best_place(&self, quadrics: &[Quadric], ends: [u32; 2]) -> (f64, DVec3) {
        let [u, v] = ends.map(|v| v as usize);
        let mut q = quadrics[u];
        q.add(&quadrics[v]);
        let (p, r) = (self.positions[u], self.positions[v]);
        let rank = |v: usize| match self.kind[v] {
            Kind::Inner => 0,
            Kind::Boundary => 1,
            Kind::Locked => 2,
        };
        let place = match rank(u).cmp(&rank(v)) {
            std::cmp::Ordering::Greater => p,
            std::cmp::Ordering::Less => r,
            std::cmp::Ordering::Equal => q.minimizer().unwrap_or(0.5 * (p + r)),
        };
        (q.at(place), place)
    }

    /// Collects the neighbours of `v` in `ring`.
    fn neighbours(&mut self, v: u32) {
        self.round += 1;
        self.ring.clear();
        self.mark[v as usize] = self.round;
        for &f in self.spans.of(v) {
            for w in self.faces[f as usize] {
                if std::mem::replace(&mut self.mark[w as usize], self.round) != self.round {
                    self.ring.push(w);
                }
            }
        }
    }

    /// Whether the mesh stays manifold (the link condition), and no face turns over.
    fn may_collapse(&mut self, u: u32, v: u32, place: DVec3) -> bool {
        let mut opposite = [NONE; 2];
        let mut shared = 0;
        for &f in self.spans.of(u) {
            let face = self.faces[f as usize];
            if face.contains(&v) {
                let w = face.into_iter().find(|&w| w != u && w != v);
                let (Some(w), true) = (w, shared < 2) else { return false };
                opposite[shared] = w;
                shared += 1;
            }
        }
        let both = |kind| self.kind[u as usize] == kind && self.kind[v as usize] == kind;
        let lone = |w: u32| w != NONE && self.spans.len[w as usize] == 1;
        let is_forbidden = match shared {
            1 => self.spans.len[u as usize] == 1 && self.spans.len[v as usize] == 1,
            2 => both(Kind::Boundary) || opposite[0] == opposite[1],
            _ => true,
        };
        if is_forbidden || opposite.into_iter().any(lone) {
            return false;
        }
        // Common neighbours: those across the edge and no others.
        self.neighbours(u);
        let mut common = 0;
        let ring = self.round;
        self.round += 1;
        for &f in self.spans.of(v) {
            for w in self.faces[f as usize] {
                let mark = &mut self.mark[w as usize];
                if w != u && w != v && *mark == ring {
                    *mark = self.round;
                    common += 1;
                }
            }
        }
        if common != shared {
            return false;
        }
        if shared == 2 {
            // Two faces over the same three vertices would be left, e.g. of a tetrahedron.
            let has_both = |x: u32| {
                let spans = self.spans.of(x).iter();
                spans
                    .map(|&f| self.faces[f as usize])
                    .any(|f| opposite.iter().all(|w| f.contains(w)))
            };
            if has_both(u) && has_both(v) {
                return false;
            }
        }
        self.keeps_faces(u, v, place) && self.keeps_faces(v, u, place)
    }

    /// Whether the faces at `moved` that are not at `other`, too, stay in shape.
    fn keeps_faces(&self, moved: u32, other: u32, place: DVec3) -> bool {
        self.spans.of(moved).iter().all(|&f| {
            let face = self.faces[f as usize];
            if face.contains(&other) {
                return true;
            }
            let k = (0..3).find(|&k| face[k] == moved).unwrap_or(0);
            let (p, q) = (
                self.positions[face[(k + 1) % 3] as usize],
                self.positions[face[(k + 2) % 3] as usize],
            );
            let old = self.positions[moved as usize];
            let normal = |x: DVec3| (p - x).cross(q - x);
            let quality = |x: DVec3, area2: f64| {
                let edges = p.distance_squared(x) + q.distance_squared(x) + p.distance_squared(q);
                2.0 * 3f64.sqrt() * area2 / edges.max(f64::MIN_POSITIVE)
            };
            let (before, after) = (normal(old), normal(place));
            let (a, b) = (before.length(), after.length());
            if a == 0.0 {
                return true;
            }
            if before.dot(after) < LEAST_COSINE * a * b || b == 0.0 {
                return false;
            }
            let now = quality(place, b);
            now >= LEAST_QUALITY || now >= quality(old, a)
        })
    }

    /// Merges `v` into `u`.
    fn collapse(&mut self, u: u32, v: u32, place: DVec3) {
        let mut at = self.spans.start[v as usize] as usize;
        let mut left = self.spans.len[v as usize];
        while left > 0 {
            let f = self.spans.pool[at];
            let face = self.faces[f as usize];
            if face.contains(&u) {
                face.iter().for_each(|&w| self.spans.remove(w, f));
                self.faces[f as usize] = [NONE; 3];
                // `remove` put another face in this place.
            } else {
                self.faces[f as usize] = face.map(|w| if w == v { u } else { w });
                at += 1;
            }
            left -= 1;
        }
        self.spans.merge(u, v);
        self.positions[u as usize] = place;
        if self.kind[v as usize] != Kind::Inner && self.kind[u as usize] == Kind::Inner
            || self.kind[v as usize] == Kind::Locked
        {
            self.kind[u as usize] = self.kind[v as usize];
        }
        self.parent[v as usize] = u;
        self.stamp[u as usize] += 1;
        self.vertex_count -= 1;
    }

    fn into_coarse(mut self, fine: &[DVec3]) -> Coarse {
        let n = self.positions.len();
        let (center, size) = (self.center, self.size);
        let mut number = vec![NONE; n];
        let mut positions = Vec::with_capacity(self.vertex_count);
        for v in 0..n {
            if self.spans.len[v] > 0 {
                number[v] = positions.len() as u32;
                // What was not moved keeps its bits.
                let is_fixed = self.stamp[v] == 0;
                positions.push(if is_fixed { fine[v] } else { center + size * self.positions[v] });
            }
        }
        let is_live = |f: &[u32; 3]| f[0] != NONE;
        self.faces.retain(is_live);
        let faces = self.faces.iter().map(|f| f.map(|v| number[v as usize])).collect();
        let mut parent = self.parent;
        let resolved = (0..n as u32).map(|v| {
            let mut root = v;
            while parent[root as usize] != root {
                // Halves the path.
                let up = parent[parent[root as usize] as usize];
                parent[root as usize] = up;
                root = up;
            }
            number[root as usize]
        });
        let parent = resolved.collect();
        Coarse { positions, faces, parent }
    }
}
