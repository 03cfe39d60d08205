//! Bendels, Schnabel and Klein (2005), "Fragment-based surface inpainting", Sec. 4.2 to 5.3: a hole is
//! filled at one scale, fragment by fragment, from its rim inward.
//!
//! Differences from the paper:
//! - The vertices of the fill are there already and are laid onto the copy; no points are put in.
//! - Every n-th vertex of the source is a candidate (`MOST`); what was copied next to the place, and
//!   there at the coarser scale, are further ones.
//! - The best few candidates are aligned with up to `STEPS` steps of the ICP, and each alignment is
//!   judged again by the descriptor: turns of 10° and every n-th vertex are coarse.
//! - A source smoother than what it shall continue is worse for it, as in the coherent method.
//! - A fragment is laid only where it tells more of what is known than the coarser surface does
//!   (`Fragment::is_continued_by`); elsewhere the smooth completion's shape goes on and meets the copies.

use super::hierarchy::Scale;
use super::join::matrix;
use crate::descriptor::ball::VertexGraph;
use crate::error::Result;
use crate::fill::patch::Patch;
use crate::intersect::Bvh;
use crate::matching::fragment::{spread, Fragment, Turned};
use crate::matching::height_map::Frame;
use crate::matching::icp::{align, worth, Pairing, Partner, RingPoint, KEEP};
use crate::matching::rigid::Rigid;
use crate::matching::ring_pattern::{blandness, keep_different, Candidate};
use crate::matching::source::Source;
use crate::mesh::normals::vertex_normals;
use crate::parallel;
use glam::DVec3;
use std::collections::{BTreeMap, BTreeSet};

/// Candidates at most.
const MOST: usize = 3000;
/// Candidates that are aligned.
const ALIGNED: usize = 6;
/// Steps of an alignment at most.
const STEPS: usize = 8;
/// Candidates that are compared at every place: the best by a sketch.
const COMPARED: usize = 100;
/// Candidates worked on between two looks at the wish to stop.
const BATCH: usize = 64;
/// How far the fine surface may be from the coarse one, in radii: farther off it is another sheet.
const APART: f64 = 0.6;
/// Least cosine between a line and the normal of a face that it meets.
const FACING: f64 = 0.1;
/// Length over which copies that do not quite meet are bent, in radii.
const SEAM: f64 = 0.5;
/// An edge of a copy that is so many times as long as the coarser fill's jumps to another sheet.
const JUMP: f64 = 4.0;
/// How far closing the seams may move a vertex, in radii.
const MOVED: f64 = 0.25;
/// Bins of the mean confidence when the next fragment is chosen (Sec. 4.3).
const BINS: f64 = 10.0;

/// A target that nothing serves is put off with those nearer than so much of its radius: one edge on the finest
/// scale.
const PUT_OFF: f64 = 0.25;
/// After so many targets in a row that nothing serves the rest is left: the likeliest come first, and the border of
/// a statue's open foot has hundreds.
const REFUSED: usize = 24;
/// Least cosine between the normals of a target and of a vertex that its fragment gives: beyond 60° a fragment
/// was compared at one place in two at most.
const SEEN: f64 = 0.5;
/// Times that seams are closed anew without what moved too far.
const JOINS: usize = 3;

/// A height along a line and the face met.
type Met = Option<(u32, f64)>;

/// Where a line meets a surface on the side that it points out of.
fn meet(tree: &Bvh, origin: DVec3, direction: DVec3, reach: f64) -> Met {
    tree.meet_line(origin, direction, reach, |_, t| {
        let n = (t[1] - t[0]).cross(t[2] - t[0]);
        n.dot(direction) > FACING * n.length()
    })
}

/// What may be copied at one scale.
pub struct Candidates<'a> {
    fine: &'a Source,
    coarse: &'a Source,
    /// Radius of a fragment, in mesh units.
    radius: f64,
    turns: &'a [(usize, bool, Turned)],
    all: Vec<(Fragment, f64)>,
}

impl<'a> Candidates<'a> {
    /// Around vertices of the source; `scales`: this one and the next coarser.
    pub fn new(
        scales: [&'a Scale; 2],
        radius: f64,
        turns: &'a [(usize, bool, Turned)],
        threads: usize,
        check: &dyn Fn() -> Result<()>,
    ) -> Result<Self> {
        let [fine, coarse] = [&scales[0].source, &scales[1].source];
        let ids = fine.points.ids();
        let step = ids.len().div_ceil(MOST).max(1);
        let centres: Vec<u32> = ids.iter().copied().step_by(step).collect();
        let mut made = Self { fine, coarse, radius, turns, all: Vec::new() };
        let one = |block: usize| {
            let of = |&c: &u32| {
                let v = c as usize;
                let frame = Frame::new(scales[1].positions[v], scales[1].normals[v], &coarse.axes);
                let usable = scales[1].normals[v] != DVec3::ZERO && !fine.on_boundary[v];
                let fragment = usable.then(|| made.look(frame))?;
                let enough = fragment.fine.mean_confidence() > 0.7;
                enough.then(|| (fragment, fine.roughness[v]))
            };
            let part = &centres[block * BATCH..centres.len().min((block + 1) * BATCH)];
            part.iter().filter_map(of).collect::<Vec<_>>()
        };
        let found = parallel::map(centres.len().div_ceil(BATCH), threads, check, &one)?;
        made.all = found.into_iter().flatten().collect();
        Ok(made)
    }

    /// The source seen in a frame, which may be mirrored.
    fn look(&self, frame: Frame) -> Fragment {
        let n = frame.axes.z_axis;
        Fragment::new(frame, self.radius, |origin, _| {
            let Some((_, h)) = meet(&self.coarse.tree, origin, n, self.radius) else {
                return [None; 2];
            };
            let fine = meet(&self.fine.tree, origin + h * n, n, APART * self.radius);
            [Some((h, 1.0)), fine.map(|(_, f)| (h + f, 1.0))]
        })
    }
}

/// A place that a fragment is to be copied to.
struct Target {
    fragment: Fragment,
    /// Known points of it.
    ring: Vec<RingPoint>,
    /// Mean confidence, in bins.
    bin: u32,
    /// σ of its known heights.
    deviation: f64,
    roughness: f64,
}

/// What a fragment was copied by.
#[derive(Debug, Clone, Copy)]
pub struct Pasted {
    /// From source to target.
    pub transform: Rigid,
    /// Root of what is left of the difference to the known surface, and of what there is of it between
    /// the known surface and the coarser one; in mesh units.
    pub errors: [f64; 2],
}

/// A hole at one scale.
pub struct Filling<'a> {
    scales: [&'a Scale; 2],
    candidates: &'a Candidates<'a>,
    patch: &'a Patch,
    /// The fill at the coarser scale, and a tree over it.
    guidance: Vec<DVec3>,
    guidance_tree: Bvh,
    normals: Vec<DVec3>,
    /// What the smooth completion has at this scale and not at the coarser one.
    band: Vec<DVec3>,
    /// The fill at this scale, where there is any, and a tree over it.
    filled: Vec<Option<DVec3>>,
    tree: Bvh,
    confidence: Vec<f64>,
    graph: VertexGraph,
    /// What was copied at each vertex, into `pasted`.
    copies: Vec<Option<u32>>,
    pasted: Vec<Pasted>,
    threads: usize,
}

/// A hole that was filled at one scale.
pub struct Filled {
    /// Of the patch's vertices.
    pub positions: Vec<DVec3>,
    /// For each vertex which fragment gave it, if one did.
    pub copies: Vec<Option<u32>>,
    /// The fragments.
    pub pasted: Vec<Pasted>,
}

impl<'a> Filling<'a> {
    /// `origin`: the vertex of the object that each vertex of the patch is; `guidance`: the patch at the
    /// coarser scale.
    pub fn new(
        scales: [&'a Scale; 2],
        candidates: &'a Candidates<'a>,
        patch: &'a Patch,
        origin: &[u32],
        guidance: Vec<DVec3>,
        threads: usize,
    ) -> Self {
        let rim = patch.rim_count;
        let corners = |t: &[u32; 3]| t.map(|v| guidance[v as usize]);
        let faces = patch.triangles.iter().enumerate();
        let guidance_tree = Bvh::from_triangles(faces.map(|(i, t)| (i as u32, corners(t))));
        let mut normals = vertex_normals(&guidance, patch.triangles.iter().copied());
        for v in 0..rim {
            normals[v] = scales[1].normals[origin[v] as usize];
        }
        let mut filled = vec![None; guidance.len()];
        let mut confidence = vec![0.0; guidance.len()];
        for v in 0..rim {
            filled[v] = Some(scales[0].positions[origin[v] as usize]);
            confidence[v] = 1.0;
        }
        let band = origin.iter().map(|&v| v as usize);
        let band = band.map(|v| scales[0].positions[v] - scales[1].positions[v]).collect();
        let graph = VertexGraph::new(guidance.len(), &patch.triangles);
        let copies = vec![None; guidance.len()];
        let mut made = Self {
            scales,
            candidates,
            patch,
            guidance,
            guidance_tree,
            normals,
            band,
            filled,
            tree: Bvh::from_triangles(std::iter::empty()),
            confidence,
            graph,
            copies,
            pasted: Vec::new(),
            threads,
        };
        made.plant();
        made
    }

    /// The tree over what is filled.
    fn plant(&mut self) {
        let corners = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|v| self.filled[v as usize]);
            Some([a?, b?, c?])
        };
        let faces = self.patch.triangles.iter().enumerate();
        let known: Vec<_> = faces.filter_map(|(i, t)| Some((i as u32, corners(t)?))).collect();
        self.tree = Bvh::from_triangles(known.into_iter());
    }

    /// Fills the hole. `before`: the copies of the coarser scale; `progress` is called with the fraction done.
    pub fn run(
        mut self,
        before: Option<&Filled>,
        progress: &dyn Fn(f64) -> Result<()>,
    ) -> Result<Filled> {
        let radius = self.candidates.radius;
        let new = self.filled.len() - self.patch.rim_count;
        let mut targets: BTreeMap<u32, Target> = BTreeMap::new();
        let mut in_row = 0;
        let mut put_off: BTreeSet<u32> = BTreeSet::new();
        let mut stale: Vec<u32> = self.frontier().collect();
        loop {
            let empty = self.filled.iter().filter(|f| f.is_none()).count();
            let check = || progress(1.0 - empty as f64 / new.max(1) as f64);
            check()?;
            let fresh =
                parallel::map(stale.len(), self.threads, &check, &|i| self.target(stale[i]))?;
            targets.extend(stale.iter().copied().zip(fresh));
            // The greatest bin, then the greatest deviation, then the first.
            let best = targets.iter().max_by(|(a, x), (b, y)| {
                (x.bin.cmp(&y.bin)).then(x.deviation.total_cmp(&y.deviation)).then(b.cmp(a))
            });
            let Some((&b, _)) = best else { break };
            // The order may be a little old, what is compared not.
            let target = &self.target(b);
            let found = self.find(b, target, before, &check)?;
            let pasted = found.is_some_and(|p| self.paste(b, target, p));
            if pasted {
                self.plant();
                in_row = 0;
            }
            let centre = self.guidance[b as usize];
            let off = |v: u32| self.guidance[v as usize].distance(centre);
            if !pasted {
                // Put off, with its neighbours, until something is laid beside it.
                let near: Vec<u32> =
                    targets.keys().copied().filter(|&v| off(v) <= PUT_OFF * radius).collect();
                for v in near {
                    targets.remove(&v);
                    put_off.insert(v);
                }
                stale.clear();
                in_row += 1;
                if in_row >= REFUSED {
                    break;
                }
                continue;
            }
            let open: Vec<u32> = self.frontier().collect();
            // What others show has changed: with those nearer than a radius made anew the order is nearly that
            // of all, at a third of the time.
            let holds = |v: u32| off(v) > radius && open.binary_search(&v).is_ok();
            targets.retain(|&v, _| holds(v));
            put_off.retain(|&v| holds(v));
            let known = |v: &u32| targets.contains_key(v) || put_off.contains(v);
            stale = open.into_iter().filter(|v| !known(v)).collect();
        }
        let positions = self.close_seams();
        Ok(Filled { positions, copies: self.copies, pasted: self.pasted })
    }

    /// The whole fill: where no copy serves the smooth completion's own shape of this scale goes on, and so it does
    /// where a copy would have to move far to meet the others: it was never one surface with them.
    fn close_seams(&mut self) -> Vec<DVec3> {
        let (rim, n) = (self.patch.rim_count, self.filled.len());
        for i in rim..n {
            let plain = self.plain(i);
            self.filled[i].get_or_insert(plain);
        }
        let mut positions = self.joined();
        for _ in 0..JOINS {
            let most = MOVED * self.candidates.radius;
            let moved = |i: usize| self.filled[i].map_or(0.0, |p| p.distance(positions[i]));
            let is_far = |i: &usize| self.copies[*i].is_some() && moved(*i) > most;
            let far: Vec<usize> = (rim..n).filter(is_far).collect();
            if far.is_empty() {
                break;
            }
            for i in far {
                self.copies[i] = None;
                self.filled[i] = Some(self.plain(i));
            }
            positions = self.joined();
        }
        positions
    }

    /// The fill, its seams closed: differences between neighbours are those of the copy at each vertex,
    /// as in [`super::join`].
    fn joined(&self) -> Vec<DVec3> {
        let all = self.filled.iter().zip(&self.guidance);
        let mut positions: Vec<DVec3> = all.map(|(p, g)| p.unwrap_or(*g)).collect();
        let (rim, n) = (self.patch.rim_count, positions.len());
        let edge = self.candidates.fine.edge;
        let ratio = (edge / (SEAM * self.candidates.radius)).powi(2) / 4.0;
        let beside = |i: usize| self.beside(i).iter().map(|&w| w as usize).collect();
        let mut columns = vec![vec![0.0; n - rim]; 3];
        let mut holds = vec![0.0; n - rim];
        for i in rim..n {
            let around = self.beside(i);
            let degree = around.len() as f64;
            let p = positions[i];
            let of_copy = |w: usize| self.copies[i].and_then(|c| self.copied(c, w));
            let own = of_copy(i);
            // Edges of the copy where it has both ends, else those that are there.
            let edge_to = |w: usize| match (own, of_copy(w)) {
                (Some(a), Some(b))
                    if a.distance(b) < JUMP * self.guidance[i].distance(self.guidance[w]) =>
                {
                    a - b
                }
                // Nothing was copied: the shape that stands in goes on, wherever its surroundings are.
                _ if self.copies[i].is_none() => self.plain(i) - self.plain(w),
                _ => p - positions[w],
            };
            let wanted: DVec3 = around.iter().map(|&w| edge_to(w as usize)).sum();
            let rims = around.iter().filter(|&&w| (w as usize) < rim);
            let known: DVec3 = rims.map(|&w| positions[w as usize]).sum();
            let rhs = (wanted + known) / degree;
            let hold = if self.copies[i].is_some() { degree * ratio * ratio } else { 0.0 };
            holds[i - rim] = hold;
            for d in 0..3 {
                columns[d][i - rim] += degree * rhs[d] + hold * p[d];
                for &w in around.iter().filter(|&&w| w as usize >= rim) {
                    columns[d][w as usize - rim] -= rhs[d];
                }
            }
        }
        let factor = matrix(rim..n, 0.0, &beside).factor(1.0, &holds);
        if let Some(factor) = factor {
            factor.solve(&mut columns);
            let solved = |i: usize| DVec3::from([0, 1, 2].map(|d| columns[d][i - rim]));
            (rim..n).for_each(|i| positions[i] = solved(i));
        }
        positions
    }

    /// Where a copy lies at a vertex.
    fn copied(&self, copy: u32, v: usize) -> Option<DVec3> {
        let inverse = self.pasted[copy as usize].transform.inverse();
        let (p, n) = (self.guidance[v], self.normals[v]);
        let reach = APART * self.candidates.radius;
        let tree = &self.candidates.fine.tree;
        let (_, h) = meet(tree, inverse.point(p), inverse.direction(n), reach)?;
        Some(p + h * n)
    }

    /// Where a vertex is without a copy.
    fn plain(&self, i: usize) -> DVec3 {
        self.guidance[i] + self.band[i]
    }

    fn beside(&self, i: usize) -> &[u32] {
        self.graph.neighbours(i as u32)
    }

    /// Filled vertices beside empty ones, ascending.
    fn frontier(&self) -> impl Iterator<Item = u32> + '_ {
        let empty = |&w: &u32| self.filled[w as usize].is_none();
        let is_open = move |v: &u32| {
            self.filled[*v as usize].is_some() && self.graph.neighbours(*v).iter().any(empty)
        };
        (0..self.filled.len() as u32).filter(is_open)
    }

    fn target(&self, v: u32) -> Target {
        let radius = self.candidates.radius;
        let axes = &self.candidates.coarse.axes;
        let frame = Frame::new(self.guidance[v as usize], self.normals[v as usize], axes);
        let n = frame.axes.z_axis;
        let [fine, coarse] = self.scales.map(|s| &s.source);
        let (mut ring, mut rough, mut known) = (Vec::new(), 0.0, 0.0);
        let nearer = |a: Met, b: Met| match (a, b) {
            (Some(x), Some(y)) if y.1.abs() < x.1.abs() => (None, Some(y)),
            (Some(x), _) => (Some(x), None),
            (None, b) => (None, b),
        };
        let fragment = Fragment::new(frame, radius, |origin, _| {
            let of_known = meet(&coarse.tree, origin, n, radius);
            let of_fill = meet(&self.guidance_tree, origin, n, radius);
            let (a, b) = nearer(of_known, of_fill);
            let Some((_, h)) = a.or(b) else { return [None; 2] };
            let above = origin + h * n;
            let of_known = meet(&fine.tree, above, n, APART * radius);
            let of_fill = meet(&self.tree, above, n, APART * radius);
            let coarse = Some((h, 1.0));
            match nearer(of_known, of_fill) {
                (Some((face, f)), _) => {
                    let at = fine.barycentric(face, above + f * n);
                    ring.push((above + f * n, fine.smooth_normal(face, at), 0.0));
                    rough += fine.roughness[fine.faces[face as usize][0] as usize];
                    known += 1.0;
                    [coarse, Some((h + f, 1.0))]
                }
                (_, Some((face, f))) => {
                    let corners = self.patch.triangles[face as usize].map(|v| v as usize);
                    let own = corners.map(|v| self.confidence[v]).iter().sum::<f64>() / 3.0;
                    let [p, q, r] = corners.map(|v| self.filled[v].unwrap_or(self.guidance[v]));
                    let normal = (q - p).cross(r - p).normalize_or_zero();
                    ring.push((above + f * n, normal, 0.0));
                    [coarse, Some((h + f, own.max(0.01)))]
                }
                _ => [coarse, None],
            }
        });
        let bin = (BINS * fragment.fine.mean_confidence()) as u32;
        let deviation = fragment.fine.deviation();
        Target { ring, bin, deviation, roughness: rough / f64::max(known, 1.0), fragment }
    }

    /// The turned candidates most like a target, not in order: all are sketched, few are looked at closely.
    fn alike(&self, target: &Target, check: &dyn Fn() -> Result<()>) -> Result<Vec<Candidate>> {
        let Candidates { all, turns, .. } = self.candidates;
        let own = &target.fragment;
        let bland = |c: usize| blandness(target.roughness, all[c].1);
        let sketch = |block: usize| {
            let of = |c: usize| {
                let at = |t: &(_, _, Turned)| own.sketched_distance(&all[c].0, &t.2);
                turns.iter().filter_map(at).reduce(f64::min).map(|d| (bland(c) * d, c))
            };
            (block * BATCH..all.len().min((block + 1) * BATCH)).filter_map(of).collect::<Vec<_>>()
        };
        let sketches = parallel::map(all.len().div_ceil(BATCH), self.threads, check, &sketch)?;
        let sketches = least(sketches.into_iter().flatten().collect(), COMPARED);
        // One a candidate: alignment wants starts that differ.
        let compare = |i: usize| {
            let c = sketches[i].1;
            let (source, bland) = (&all[c].0, bland(c));
            let at = |t: &'_ (usize, bool, Turned)| Some((own.distance(source, &t.2)?, t.0, t.1));
            let best = turns.iter().filter_map(at).min_by(|a, b| a.0.total_cmp(&b.0));
            best.map(|(d, turn, mirrored)| {
                let transform = own.transform(&source.frame, turn, mirrored);
                Candidate { transform, cost: bland * d, bland }
            })
        };
        let found = parallel::map(sketches.len(), self.threads, check, &compare)?;
        Ok(found.into_iter().flatten().collect())
    }

    /// The copy that continues a target best.
    fn find(
        &self,
        v: u32,
        target: &Target,
        before: Option<&Filled>,
        check: &dyn Fn() -> Result<()>,
    ) -> Result<Option<Pasted>> {
        let Candidates { radius, fine, .. } = self.candidates;
        let own = &target.fragment;
        let found = self.alike(target, check)?;
        let centre = own.frame.centre;
        let mut starts: Vec<(Rigid, f64)> = keep_different(found, centre, *radius, 0.3, ALIGNED)
            .into_iter()
            .map(|c| (c.transform, c.bland))
            .collect();
        starts.extend(self.neighbours(v, before).into_iter().map(|t| (t, self.bland(target, &t))));
        let (partner, paint) = (Partner::Surface, worth(fine));
        let pairing = Pairing { source: fine, partner, radius: 0.3 * radius, keep: KEEP, paint };
        let judged = |i: usize| {
            let (start, bland) = starts[i];
            let steps = align(&target.ring, start, STEPS, &pairing);
            [start, steps].map(|t| Some((bland * self.judge(own, &t)?, t)))
        };
        let judged = parallel::map(starts.len(), self.threads, check, &judged)?;
        let mut best: Option<(f64, Rigid)> = None;
        for (cost, t) in judged.into_iter().flatten().flatten() {
            if best.is_none_or(|b| cost < b.0) {
                best = Some((cost, t));
            }
        }
        Ok(best.and_then(|(_, transform)| {
            let source = self.candidates.look(back(&transform, &own.frame));
            let is_alike = own.is_continued_by(&source);
            let left = own.fine_distance(&source).unwrap_or(f64::INFINITY);
            let errors = [left, own.detail()].map(|d| radius * d.sqrt());
            is_alike.then_some(Pasted { transform, errors })
        }))
    }

    /// Transforms by which vertices near a place were copied, at this scale and the coarser one.
    fn neighbours(&self, v: u32, before: Option<&Filled>) -> Vec<Rigid> {
        let near: Vec<u32> =
            std::iter::once(v).chain(self.graph.neighbours(v).iter().copied()).collect();
        let mut found: Vec<Rigid> = Vec::new();
        let here = (&self.copies, &self.pasted);
        let lists = std::iter::once(here).chain(before.map(|b| (&b.copies, &b.pasted)));
        for (copies, pasted) in lists {
            let mut ids: Vec<u32> = near.iter().filter_map(|&w| copies[w as usize]).collect();
            ids.sort_unstable();
            ids.dedup();
            ids.truncate(ALIGNED / 2);
            found.extend(ids.iter().map(|&i| pasted[i as usize].transform));
        }
        found
    }

    fn bland(&self, target: &Target, transform: &Rigid) -> f64 {
        let fine = self.candidates.fine;
        let there = transform.inverse().point(target.fragment.frame.centre);
        match fine.points.nearest(there) {
            Some((v, _)) => blandness(target.roughness, fine.roughness[v as usize]),
            None => 1.0,
        }
    }

    /// δ of an aligned source; `None` where it does not cover the target.
    fn judge(&self, own: &Fragment, transform: &Rigid) -> Option<f64> {
        let source = self.candidates.look(back(transform, &own.frame));
        // The first is turned by nothing.
        own.distance(&source, &self.candidates.turns[0].2)
    }

    /// Lays the empty vertices of a target onto its copy; whether there was one that could be.
    fn paste(&mut self, b: u32, target: &Target, pasted: Pasted) -> bool {
        let Candidates { radius, fine, .. } = *self.candidates;
        let own = &target.fragment;
        let away = back(&pasted.transform, &own.frame);
        let source = self.candidates.look(away);
        let off = spread(|i| {
            let both = own.fine.confidence[i] * source.fine.confidence[i] > 0.0;
            both.then(|| f64::from(own.fine.height[i] - source.fine.height[i]) * radius)
        });
        let inverse = pasted.transform.inverse();
        let id = self.pasted.len() as u32;
        // The queue runs over empty vertices from the target on, so that no other sheet is met.
        let (mut queue, mut seen) = (vec![b], vec![false; self.filled.len()]);
        let mut any = false;
        let confidence = own.fine.mean_confidence();
        while let Some(v) = queue.pop() {
            for &w in self.graph.neighbours(v) {
                let i = w as usize;
                if std::mem::replace(&mut seen[i], true) || self.filled[i].is_some() {
                    continue;
                }
                let (p, n) = (self.guidance[i], self.normals[i]);
                let flat = own.frame.local(p).truncate() / radius;
                if flat.length() > 1.0 || n.dot(own.frame.axes.z_axis) < SEEN {
                    continue;
                }
                queue.push(w);
                let (origin, direction) = (inverse.point(p), inverse.direction(n));
                let Some((_, h)) = meet(&fine.tree, origin, direction, APART * radius) else {
                    continue;
                };
                let lift = off.at(flat) * own.frame.axes.z_axis;
                self.filled[i] = Some(p + h * n + lift);
                self.confidence[i] = confidence;
                self.copies[i] = Some(id);
                any = true;
            }
        }
        if any {
            self.pasted.push(pasted);
        }
        any
    }
}

/// The `count` least, the least first.
fn least(mut all: Vec<(f64, usize)>, count: usize) -> Vec<(f64, usize)> {
    let order = |a: &(f64, usize), b: &(f64, usize)| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1));
    if all.len() > count {
        all.select_nth_unstable_by(count, order);
        all.truncate(count);
    }
    all.sort_unstable_by(order);
    all
}

/// A frame as seen from the source.
fn back(transform: &Rigid, frame: &Frame) -> Frame {
    let there = transform.inverse();
    Frame { centre: there.point(frame.centre), axes: there.linear * frame.axes }
}
