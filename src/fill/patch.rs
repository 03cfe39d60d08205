//! A fill while it is being made: triangles with neighbours, open at the rim.
//!
//! Edges are known by their triangle and side, never by their two vertices, so that two different
//! edges between the same vertices (as a coarse triangulation of a ring has them) do no harm; the
//! refinement splits them before the fill is handed out.

use glam::DVec3;
use std::collections::HashMap;

/// "No triangle": the rim.
pub const NONE: u32 = u32::MAX;

/// The triangles of one fill. Vertices below `rim_count` belong to the input and never move.
#[derive(Debug, Clone, Default)]
pub struct Patch {
    /// Positions: the rim's vertices first, then the new ones.
    pub positions: Vec<DVec3>,
    /// Wanted edge length at each vertex, in mesh units.
    pub sizes: Vec<f64>,
    /// A displacement carried along while the patch is refined, in mesh units; empty: none is.
    pub offsets: Vec<DVec3>,
    /// How many vertices belong to the rim.
    pub rim_count: usize,
    /// Vertices of each triangle; a dead one starts with `NONE`.
    pub triangles: Vec<[u32; 3]>,
    /// The triangle across the edge from vertex k to k + 1.
    pub across: Vec<[u32; 3]>,
    /// A triangle at each vertex; `NONE` for a removed vertex.
    pub at: Vec<u32>,
}

/// The side after `k`.
#[inline]
pub fn next(k: usize) -> usize {
    (k + 1) % 3
}

/// The side before `k`.
#[inline]
pub fn previous(k: usize) -> usize {
    (k + 2) % 3
}

impl Patch {
    /// A patch of given triangles; its rim is the first `rim_count` vertices. Edges of more than two
    /// triangles, or of two that run the same way, are left open.
    pub fn of_triangles(
        positions: Vec<DVec3>,
        sizes: Vec<f64>,
        rim_count: usize,
        triangles: Vec<[u32; 3]>,
    ) -> Self {
        let mut across = vec![[NONE; 3]; triangles.len()];
        let mut open: HashMap<(u32, u32), (u32, usize)> = HashMap::new();
        let mut at = vec![NONE; positions.len()];
        for (t, tri) in triangles.iter().enumerate() {
            for k in 0..3 {
                at[tri[k] as usize] = t as u32;
                match open.remove(&(tri[next(k)], tri[k])) {
                    Some((s, side)) => {
                        across[t][k] = s;
                        across[s as usize][side] = t as u32;
                    }
                    None => {
                        open.insert((tri[k], tri[next(k)]), (t as u32, k));
                    }
                }
            }
        }
        let offsets = vec![DVec3::ZERO; positions.len()];
        Self { positions, sizes, offsets, rim_count, triangles, across, at }
    }

    /// Whether a triangle was not removed.
    #[inline]
    pub fn is_alive(&self, t: usize) -> bool {
        self.triangles[t][0] != NONE
    }

    /// Whether a vertex belongs to the rim.
    #[inline]
    pub fn is_rim(&self, v: u32) -> bool {
        (v as usize) < self.rim_count
    }

    /// How many vertices are new: all but the rim's.
    #[inline]
    pub fn new_count(&self) -> usize {
        self.positions.len() - self.rim_count
    }

    /// Position of a vertex.
    #[inline]
    pub fn p(&self, v: u32) -> DVec3 {
        self.positions[v as usize]
    }

    /// Twice the area times the normal of a triangle.
    #[inline]
    pub fn area_normal(&self, t: usize) -> DVec3 {
        let [a, b, c] = self.triangles[t].map(|v| self.p(v));
        (b - a).cross(c - a)
    }

    /// The side of triangle `n` that lies on the edge of `t` from `a` to `b`.
    #[inline]
    pub fn side_across(&self, n: u32, t: u32, a: u32, b: u32) -> usize {
        let (tri, across) = (self.triangles[n as usize], self.across[n as usize]);
        for k in 0..3 {
            if across[k] == t && tri[k] == b && tri[next(k)] == a {
                return k;
            }
        }
        unreachable!("neighbouring triangles know each other")
    }

    /// The sum of all triangles.
    pub fn area(&self) -> f64 {
        let alive = (0..self.triangles.len()).filter(|&t| self.is_alive(t));
        alive.map(|t| 0.5 * self.area_normal(t).length()).sum()
    }

    fn relink(&mut self, n: u32, old: u32, new: u32, a: u32, b: u32) {
        // The neighbour runs the edge a → b as b → a.
        if n != NONE {
            let (tri, across) = (self.triangles[n as usize], &mut self.across[n as usize]);
            for k in 0..3 {
                if across[k] == old && tri[k] == b && tri[next(k)] == a {
                    across[k] = new;
                    return;
                }
            }
        }
    }

    /// The triangles around `v`, each with the side that starts at `v`. Counter-clockwise; on the
    /// rim from the first to the last.
    pub fn fan(&self, v: u32, fan: &mut Vec<(u32, usize)>) {
        fan.clear();
        let start = self.at[v as usize];
        if start == NONE {
            return;
        }
        let side = |t: u32| self.triangles[t as usize].iter().position(|&w| w == v).unwrap_or(0);
        // Clockwise to the first triangle of an open fan.
        let (mut first, mut k) = (start, side(start));
        loop {
            let n = self.across[first as usize][k];
            if n == NONE || n == start {
                break;
            }
            let b = self.triangles[first as usize][next(k)];
            k = next(self.side_across(n, first, v, b));
            first = n;
        }
        if self.across[first as usize][k] != NONE {
            (first, k) = (start, side(start));
        }
        let (mut t, begin) = (first, (first, k));
        loop {
            fan.push((t, k));
            let side_back = previous(k);
            let n = self.across[t as usize][side_back];
            if n == NONE {
                break;
            }
            let c = self.triangles[t as usize][side_back];
            k = self.side_across(n, t, c, v);
            t = n;
            if (t, k) == begin {
                break;
            }
        }
    }

    /// Whether an edge of the patch joins two vertices.
    pub fn joined(&self, a: u32, b: u32, fan: &mut Vec<(u32, usize)>) -> bool {
        self.fan(a, fan);
        fan.iter().any(|&(t, k)| {
            let tri = self.triangles[t as usize];
            tri[next(k)] == b || tri[previous(k)] == b
        })
    }

    /// Replaces the edge at side `k` of `t` by the other diagonal. Not on the rim.
    pub fn flip(&mut self, t: u32, k: usize) {
        let n = self.across[t as usize][k];
        let tri = self.triangles[t as usize];
        let (a, b, c) = (tri[k], tri[next(k)], tri[previous(k)]);
        let j = self.side_across(n, t, a, b);
        let d = self.triangles[n as usize][previous(j)];
        let (bc, ca) = (self.across[t as usize][next(k)], self.across[t as usize][previous(k)]);
        let (ad, db) = (self.across[n as usize][next(j)], self.across[n as usize][previous(j)]);
        self.relink(bc, t, n, b, c);
        self.relink(ad, n, t, a, d);
        self.triangles[t as usize] = [a, d, c];
        self.across[t as usize] = [ad, n, ca];
        self.triangles[n as usize] = [d, b, c];
        self.across[n as usize] = [db, bc, t];
        for (v, tri) in [(a, t), (b, n), (c, t), (d, t)] {
            self.at[v as usize] = tri;
        }
    }

    /// Puts a new vertex on the edge at side `k` of `t`, not on the rim; returns it.
    pub fn split(&mut self, t: u32, k: usize, position: DVec3) -> u32 {
        let n = self.across[t as usize][k];
        let tri = self.triangles[t as usize];
        let (a, b, c) = (tri[k], tri[next(k)], tri[previous(k)]);
        let j = self.side_across(n, t, a, b);
        let d = self.triangles[n as usize][previous(j)];
        let (bc, ca) = (self.across[t as usize][next(k)], self.across[t as usize][previous(k)]);
        let (ad, db) = (self.across[n as usize][next(j)], self.across[n as usize][previous(j)]);
        let m = self.positions.len() as u32;
        self.positions.push(position);
        self.sizes.push(0.5 * (self.sizes[a as usize] + self.sizes[b as usize]));
        if !self.offsets.is_empty() {
            self.offsets.push(0.5 * (self.offsets[a as usize] + self.offsets[b as usize]));
        }
        let (t2, n2) = (self.triangles.len() as u32, self.triangles.len() as u32 + 1);
        self.relink(bc, t, t2, b, c);
        self.relink(db, n, n2, d, b);
        self.triangles[t as usize] = [a, m, c];
        self.across[t as usize] = [n, t2, ca];
        self.triangles.push([m, b, c]);
        self.across.push([n2, bc, t]);
        self.triangles[n as usize] = [m, a, d];
        self.across[n as usize] = [t, ad, n2];
        self.triangles.push([b, m, d]);
        self.across.push([t2, n, db]);
        self.at.push(t);
        for (v, tri) in [(a, t), (b, t2), (c, t), (d, n)] {
            self.at[v as usize] = tri;
        }
        m
    }

    /// Puts a new vertex into a triangle; returns it.
    pub fn insert(&mut self, t: u32, position: DVec3) -> u32 {
        let [a, b, c] = self.triangles[t as usize];
        let [ab, bc, ca] = self.across[t as usize];
        let m = self.positions.len() as u32;
        let third = |x: &[f64]| (x[a as usize] + x[b as usize] + x[c as usize]) / 3.0;
        self.sizes.push(third(&self.sizes));
        if !self.offsets.is_empty() {
            let offset: DVec3 = [a, b, c].iter().map(|&v| self.offsets[v as usize]).sum();
            self.offsets.push(offset / 3.0);
        }
        self.positions.push(position);
        let (t2, t3) = (self.triangles.len() as u32, self.triangles.len() as u32 + 1);
        self.relink(bc, t, t2, b, c);
        self.relink(ca, t, t3, c, a);
        self.triangles[t as usize] = [a, b, m];
        self.across[t as usize] = [ab, t2, t3];
        self.triangles.extend([[b, c, m], [c, a, m]]);
        self.across.extend([[bc, t3, t], [ca, t, t2]]);
        self.at.push(t);
        for (v, tri) in [(a, t), (b, t), (c, t2)] {
            self.at[v as usize] = tri;
        }
        m
    }

    /// Moves the new vertex at the start of side `k` of `t` into the one at its end and removes
    /// the two triangles between. The caller has checked that the result is a manifold.
    pub fn collapse(&mut self, t: u32, k: usize, fan: &mut Vec<(u32, usize)>) {
        let tri = self.triangles[t as usize];
        let (u, v, c) = (tri[k], tri[next(k)], tri[previous(k)]);
        let n = self.across[t as usize][k];
        let j = self.side_across(n, t, u, v);
        let d = self.triangles[n as usize][previous(j)];
        self.fan(u, fan);
        let (vc, cu) = (self.across[t as usize][next(k)], self.across[t as usize][previous(k)]);
        let (ud, dv) = (self.across[n as usize][next(j)], self.across[n as usize][previous(j)]);
        self.relink(vc, t, cu, v, c);
        self.relink(cu, t, vc, c, u);
        self.relink(ud, n, dv, u, d);
        self.relink(dv, n, ud, d, v);
        for &(f, side) in fan.iter() {
            self.triangles[f as usize][side] = v;
        }
        for dead in [t, n] {
            self.triangles[dead as usize] = [NONE; 3];
            self.across[dead as usize] = [NONE; 3];
        }
        self.at[u as usize] = NONE;
        let alive = |x: u32, y: u32| if x == NONE { y } else { x };
        self.at[c as usize] = alive(vc, cu);
        self.at[d as usize] = alive(ud, dv);
        self.at[v as usize] = alive(alive(vc, cu), alive(ud, dv));
    }

    /// Makes room for a number of splits. Growing by itself each array may get twice the room it needs.
    pub fn reserve(&mut self, splits: usize) {
        self.positions.reserve_exact(splits);
        self.sizes.reserve_exact(splits);
        if !self.offsets.is_empty() {
            self.offsets.reserve_exact(splits);
        }
        self.at.reserve_exact(splits);
        self.triangles.reserve_exact(2 * splits);
        self.across.reserve_exact(2 * splits);
    }

    /// How many vertices were removed and still have their places.
    pub fn gone(&self) -> usize {
        self.at[self.rim_count..].iter().filter(|&&t| t == NONE).count()
    }

    /// Drops removed triangles and vertices; rim vertices keep their numbers.
    pub fn compact(&mut self) {
        let mut tri_number = vec![NONE; self.triangles.len()];
        let mut kept = 0;
        for t in 0..self.triangles.len() {
            if self.is_alive(t) {
                tri_number[t] = kept as u32;
                self.triangles[kept] = self.triangles[t];
                self.across[kept] = self.across[t];
                kept += 1;
            }
        }
        self.triangles.truncate(kept);
        self.across.truncate(kept);
        let mut vertex_number = vec![NONE; self.positions.len()];
        let mut count = 0;
        for v in 0..self.positions.len() {
            if v < self.rim_count || self.at[v] != NONE {
                vertex_number[v] = count;
                self.positions[count as usize] = self.positions[v];
                self.sizes[count as usize] = self.sizes[v];
                if !self.offsets.is_empty() {
                    self.offsets[count as usize] = self.offsets[v];
                }
                self.at[count as usize] = self.at[v];
                count += 1;
            }
        }
        self.positions.truncate(count as usize);
        self.sizes.truncate(count as usize);
        self.offsets.truncate(count as usize);
        self.at.truncate(count as usize);
        let number = |t: u32| if t == NONE { NONE } else { tri_number[t as usize] };
        self.at.iter_mut().for_each(|t| *t = number(*t));
        let corners = self.triangles.iter_mut().flatten();
        corners.for_each(|v| *v = vertex_number[*v as usize]);
        self.across.iter_mut().flatten().for_each(|t| *t = number(*t));
        // Grown by pushes, they may be twice as long as what is in them.
        self.positions.shrink_to_fit();
        self.sizes.shrink_to_fit();
        self.offsets.shrink_to_fit();
        self.at.shrink_to_fit();
        self.triangles.shrink_to_fit();
        self.across.shrink_to_fit();
    }
}
