//! A finished fill in triangles of another size: its surface stays, and what it shows between its vertices is read
//! from where they were copied. Nothing is searched or fitted again.
//!
//! A vertex of the new triangles lies on a triangle of the old ones, at a point q with barycentric coordinates b:
//!
//!   x = q + g h n + (1 − g) (φ(q) − q)
//!
//! with n the normal there, h how far the copy is from what its own points at the corners span (where the line
//! along n from Σ b T(s) meets it), g the part of the copy's detail that the fill took, and φ Phong tessellation
//! (Boubekeur and Alexa 2008), which rounds what no copy says anything of.

use super::smooth::{Fill, Story};
use crate::descriptor::prolong::barycentric;
use crate::error::Result;
use crate::fill::even::refine_for;
use crate::fill::patch::Patch;
use crate::intersect::Bvh;
use crate::matching::rigid::Rigid;
use crate::matching::source::Source;
use crate::mesh::normals::vertex_normals;
use crate::options::Sizing;
use crate::parallel;
use crate::progress::Pace;
use crate::result::{Origin, Seam};
use crate::synthesis::join::MOST_GAIN;
use crate::synthesis::project::{meet_source, Place};
use glam::DVec3;
use std::collections::BTreeMap;

/// Rounds of refinement, as for a smooth fill.
const ROUNDS: usize = 4;
/// Part of Phong tessellation's bulge that is taken: that of the paper.
const BULGE: f64 = 0.75;
/// A point of the old surface is looked for along the normal so many times as far as the nearest lies: what slopes by
/// less than 70° is met.
const FARTHER: f64 = 3.0;
/// Vertices of one copy, with its like all around, that say how much of its detail a fill took; with fewer, all.
const ENOUGH: usize = 6;

/// A fill in triangles of the size wished for; `None` if that asks for too many. `fill`: the one it was continued
/// from.
pub fn resize(
    (patch, story): (&Patch, &Story),
    fill: &Fill,
    sizing: Sizing,
    source: &Source,
    threads: usize,
    check: &dyn Fn() -> Result<()>,
) -> Result<Option<(Patch, Story)>> {
    let mut finer = patch.clone();
    finer.offsets = Vec::new();
    match sizing {
        Sizing::Scaled(factor) => finer.sizes.iter_mut().for_each(|s| *s *= factor),
        Sizing::EdgeLength(length) => finer.sizes.fill(length),
        Sizing::Surroundings | Sizing::None => {}
    }
    if !refine_for(&fill.outline, &mut finer, ROUNDS, &mut Pace::new(check))? {
        return Ok(None);
    }
    let old = Old::new(patch, story, source);
    let rim = finer.rim_count;
    let normals = vertex_normals(&finer.positions, finer.triangles.iter().copied());
    let one = |i: usize| old.read(finer.positions[rim + i], normals[rim + i]);
    let read = parallel::map(finer.new_count(), threads, check, &one)?;
    for (p, read) in finer.positions[rim..].iter_mut().zip(&read) {
        *p = read.position;
    }
    let mut story = Story {
        origins: read.iter().map(|r| r.shape).collect(),
        colours: read.iter().filter_map(|r| r.colour).collect(),
        ..story.clone()
    };
    for (k, of) in story.sources.iter_mut().enumerate() {
        let is_own = |o: &&Origin| o.source == k as u32;
        of.vertices = story.origins.iter().filter(is_own).count();
        let elsewhere = |(o, shape): (&Origin, &Origin)| o.source == k as u32 && o != shape;
        of.coloured =
            story.colours.iter().zip(&story.origins).map(elsewhere).filter(|&x| x).count();
    }
    story.seams = old.seams(&finer, &[&story.origins, &story.colours]);
    Ok(Some((finer, story)))
}

/// What a point of the old surface says.
struct Read {
    position: DVec3,
    shape: Origin,
    /// Where colours come from other places.
    colour: Option<Origin>,
}

/// The fill as it was.
struct Old<'a> {
    patch: &'a Patch,
    story: &'a Story,
    source: &'a Source,
    tree: Bvh,
    normals: Vec<DVec3>,
    /// Where each copy lies at each vertex that it gave or lies beside: by vertex and number of the copy.
    places: BTreeMap<(u32, u32), Place>,
    /// From the source to the fill, by number of the copy.
    transforms: Vec<Rigid>,
    /// The part of each copy's detail that the fill took.
    taken: Vec<f64>,
}

impl<'a> Old<'a> {
    fn new(patch: &'a Patch, story: &'a Story, source: &'a Source) -> Self {
        let rim = patch.rim_count;
        let of_vertices = |list: &'a [Origin]| {
            let known = list.iter().enumerate().filter(|(_, o)| !o.is_nowhere());
            known.map(move |(i, o)| ((rim + i) as u32, o.source, o.face, o.barycentric))
        };
        let seams = story.seams.iter().map(|s| (s.vertex, s.source, s.face, s.barycentric));
        let mut places = BTreeMap::new();
        let mut transforms: Vec<Rigid> = story.sources.iter().map(|s| s.transform).collect();
        for (v, copy, face, barycentric) in
            of_vertices(&story.origins).chain(of_vertices(&story.colours)).chain(seams)
        {
            if let Ok(own) = source.face_ids.binary_search(&face) {
                places.insert((v, copy), Place { face: own as u32, barycentric });
                let given = &story.sources[copy as usize].transform;
                transforms[copy as usize] = source.as_laid(given, face);
            }
        }
        let mut old = Self {
            tree: Bvh::new(&patch.positions, &patch.triangles),
            normals: vertex_normals(&patch.positions, patch.triangles.iter().copied()),
            taken: vec![1.0; story.sources.len()],
            patch,
            story,
            source,
            places,
            transforms,
        };
        old.taken = old.measure();
        old
    }

    /// How much of each copy's detail the fill took, by least squares over the vertices that have nothing but that
    /// copy around them.
    fn measure(&self) -> Vec<f64> {
        let n = self.patch.positions.len();
        let mut around = vec![(DVec3::ZERO, DVec3::ZERO, 0.0); n];
        let mut inner = vec![true; n];
        for tri in &self.patch.triangles {
            for k in 0..3 {
                let v = tri[k];
                let Some(label) = self.label(v) else { continue };
                let w = tri[(k + 1) % 3];
                match self.label(w).filter(|&l| l == label).and_then(|_| self.copied(w, label)) {
                    Some(p) => {
                        let (own, copy, count) = around[v as usize];
                        around[v as usize] = (own + self.patch.p(w), copy + p, count + 1.0);
                    }
                    None => inner[v as usize] = false,
                }
            }
        }
        let mut sums = vec![(0.0, 0.0, 0); self.story.sources.len()];
        for v in (self.patch.rim_count..n).filter(|&v| inner[v] && around[v].2 > 0.0) {
            let Some(label) = self.label(v as u32) else { continue };
            let Some(p) = self.copied(v as u32, label) else { continue };
            let (own, copy, count) = around[v];
            let detail = |p: DVec3, sum: DVec3| (p - sum / count).dot(self.normals[v]);
            let (own, copy) = (detail(self.patch.positions[v], own), detail(p, copy));
            let sum = &mut sums[label as usize];
            *sum = (sum.0 + own * copy, sum.1 + copy * copy, sum.2 + 1);
        }
        let part = |&(both, copy, count): &(f64, f64, usize)| match count < ENOUGH || copy == 0.0 {
            true => 1.0,
            false => f64::clamp(both / copy, 0.0, MOST_GAIN),
        };
        sums.iter().map(part).collect()
    }

    /// The copy that gave a vertex its detail.
    fn label(&self, v: u32) -> Option<u32> {
        let origin = self.story.origins.get((v as usize).checked_sub(self.patch.rim_count)?)?;
        (!origin.is_nowhere()).then_some(origin.source)
    }

    /// Where a copy is at a vertex, if it is known there.
    fn copied(&self, v: u32, copy: u32) -> Option<DVec3> {
        let at = self.places.get(&(v, copy))?;
        Some(self.transforms[copy as usize].point(self.source.point(at.face, at.barycentric)))
    }

    /// What the old surface says beside a vertex of the new triangles.
    fn read(&self, p: DVec3, normal: DVec3) -> Read {
        let nothing = Read { position: p, shape: Origin::NOWHERE, colour: None };
        let Some(at) = self.spot(p, normal) else { return nothing };
        let (corners, weights) = (at.corners, at.weights);
        let normal: DVec3 = (0..3).map(|k| weights[k] * self.normals[corners[k] as usize]).sum();
        let normal = normal.normalize_or_zero();
        let (mut height, mut bulge) = (0.0, 1.0);
        let (shape, copies) = self.origin(&at, normal, &self.story.origins);
        let sum: f64 = copies.iter().map(|c| c.weight).sum();
        for copy in copies {
            let (share, part) = (copy.weight / sum, self.taken[copy.number as usize]);
            height += share * part * copy.height;
            bulge -= share * part.min(1.0);
        }
        let rounded = bulge * BULGE * self.phong(&at);
        let colour = (!self.story.colours.is_empty())
            .then(|| self.origin(&at, normal, &self.story.colours).0);
        Read { position: at.point + height * normal + rounded, shape, colour }
    }

    /// The point of the old surface that a vertex of the new triangles stands for. Along the normal: what is
    /// nearest to many points is one point of a crease.
    fn spot(&self, p: DVec3, normal: DVec3) -> Option<Spot> {
        let nearest = self.tree.closest_point(p, f64::INFINITY)?;
        let facing = |_: u32, t: &[DVec3; 3]| (t[1] - t[0]).cross(t[2] - t[0]).dot(normal) > 0.0;
        let reach = FARTHER * nearest.distance;
        let (face, point) = match self.tree.meet_line(p, normal, reach, facing) {
            Some((face, height)) => (face, p + height * normal),
            None => (nearest.face, nearest.point),
        };
        let corners = self.patch.triangles[face as usize];
        let positions = corners.map(|v| self.patch.p(v));
        Some(Spot { corners, positions, weights: barycentric(point, &positions), point })
    }

    /// How far a point lies from the mean of its projections onto the planes of the corners.
    fn phong(&self, at: &Spot) -> DVec3 {
        let off = |k: usize| {
            let n = self.normals[at.corners[k] as usize];
            -at.weights[k] * (at.point - at.positions[k]).dot(n) * n
        };
        (0..3).map(off).sum()
    }

    /// Where a point comes from, given where its triangle's corners do, and all copies that those are of.
    fn origin(&self, at: &Spot, normal: DVec3, origins: &[Origin]) -> (Origin, Vec<Met>) {
        let of = |k: usize| {
            let own = origins.get((at.corners[k] as usize).checked_sub(self.patch.rim_count)?)?;
            (!own.is_nowhere()).then_some(*own)
        };
        let mut copies: Vec<Met> = Vec::new();
        for (k, own) in (0..3).filter_map(|k| Some((k, of(k)?))) {
            let weight = at.weights[k];
            let found = match copies.iter().position(|c| c.number == own.source) {
                Some(i) => &mut copies[i],
                None => {
                    let Some((place, height)) = self.follow(at, normal, own.source) else {
                        continue;
                    };
                    let number = own.source;
                    copies.push(Met { number, place, height, weight: 0.0, confidence: 0.0 });
                    let last = copies.len() - 1;
                    &mut copies[last]
                }
            };
            found.weight += weight;
            found.confidence += weight * own.confidence;
        }
        copies.retain(|c| c.weight > 0.0);
        let best = copies.iter().max_by(|a, b| a.weight.total_cmp(&b.weight));
        let origin = best.map_or(Origin::NOWHERE, |c| Origin {
            face: self.source.face_ids[c.place.face as usize],
            barycentric: c.place.barycentric,
            source: c.number,
            confidence: (c.confidence / c.weight).clamp(0.0, 1.0),
        });
        (origin, copies)
    }

    /// Where a copy lies at a point of the old surface, and how far from what it has at the corners.
    fn follow(&self, at: &Spot, normal: DVec3, copy: u32) -> Option<(Place, f64)> {
        let there = at.corners.map(|v| self.copied(v, copy));
        let start = match there {
            [Some(a), Some(b), Some(c)] => {
                at.weights[0] * a + at.weights[1] * b + at.weights[2] * c
            }
            _ => {
                let known = (0..3).filter_map(|k| Some((k, there[k]?)));
                let (k, p) = known.max_by(|a, b| at.weights[a.0].total_cmp(&at.weights[b.0]))?;
                p + at.point - at.positions[k]
            }
        };
        let reach = at.reach();
        let transform = &self.transforms[copy as usize];
        let back = transform.inverse();
        let (place, height) = match meet_source(self.source, &back, (start, normal), reach) {
            Some(met) => met,
            None => {
                let place = self.nearest(copy, start)?;
                let point = transform.point(self.source.point(place.face, place.barycentric));
                (place, (point - start).dot(normal))
            }
        };
        (!self.source.is_completion(place.face)).then_some((place, height))
    }

    /// The place of a copy that is nearest to a point of the fill.
    fn nearest(&self, copy: u32, p: DVec3) -> Option<Place> {
        let p = self.transforms[copy as usize].inverse().point(p);
        let met = self.source.tree.closest_point(p, f64::INFINITY)?;
        let corners =
            self.source.faces[met.face as usize].map(|v| self.source.positions[v as usize]);
        let known = !self.source.is_completion(met.face);
        known.then(|| Place { face: met.face, barycentric: barycentric(met.point, &corners) })
    }

    /// Where copies lie beside the vertices that come from them, on the rim and on the other side of a border.
    fn seams(&self, patch: &Patch, lists: &[&Vec<Origin>]) -> Vec<Seam> {
        let rim = patch.rim_count;
        let mut found = BTreeMap::new();
        for origins in lists.iter().filter(|list| !list.is_empty()) {
            let of = |v: u32| (v as usize).checked_sub(rim).map(|i| &origins[i]);
            let sides = |tri: &[u32; 3]| {
                let [a, b, c] = *tri;
                [(a, b), (b, a), (b, c), (c, b), (c, a), (a, c)]
            };
            for (u, v) in patch.triangles.iter().flat_map(sides) {
                let Some(own) = of(u).filter(|o| !o.is_nowhere()) else { continue };
                if of(v).is_none_or(|o| o.source != own.source) {
                    let beside: &mut u32 = found.entry((v, own.source)).or_insert(u);
                    *beside = u.min(*beside);
                }
            }
        }
        let seam = |(&(vertex, source), &beside): (&(u32, u32), &u32)| {
            let own = |list: &&&Vec<Origin>| {
                list.get(beside as usize - rim).is_some_and(|o| o.source == source)
            };
            let own = lists.iter().find(own)?[beside as usize - rim];
            let face = self.source.face_ids.binary_search(&own.face).ok()? as u32;
            let there =
                self.transforms[source as usize].point(self.source.point(face, own.barycentric));
            let at = self.nearest(source, there + patch.p(vertex) - patch.p(beside))?;
            let face = self.source.face_ids[at.face as usize];
            Some(Seam { vertex, source, face, barycentric: at.barycentric })
        };
        found.iter().filter_map(seam).collect()
    }
}

/// A point of the old surface.
struct Spot {
    corners: [u32; 3],
    positions: [DVec3; 3],
    weights: [f64; 3],
    point: DVec3,
}

impl Spot {
    /// As far as the longest side of the triangle.
    fn reach(&self) -> f64 {
        let [a, b, c] = self.positions;
        a.distance(b).max(b.distance(c)).max(c.distance(a))
    }
}

/// A copy met at a point.
struct Met {
    number: u32,
    place: Place,
    height: f64,
    /// Sum of the barycentric coordinates of the corners that come from it.
    weight: f64,
    /// Sum of their confidences by these.
    confidence: f64,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fill::outline::Outline;
    use crate::mesh::MeshView;
    use crate::options::{Fairing, Method};
    use crate::result::SourceReport;

    const SIDE: usize = 96;
    /// Vertices of the source between two of the patch.
    const STEP: usize = 8;

    fn wave(x: f64, y: f64) -> f64 {
        0.5 * (0.8 * x).sin() * (0.7 * y).cos()
    }

    /// A square sheet of so many cells of a length, its border first if wished for.
    fn sheet(
        cells: usize,
        length: f64,
        z: impl Fn(f64, f64) -> f64,
    ) -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let n = cells + 1;
        let position = |i: usize, j: usize| {
            let (x, y) = (i as f64 * length, j as f64 * length);
            DVec3::new(x, y, z(x, y))
        };
        let positions = (0..n * n).map(|v| position(v % n, v / n)).collect();
        let of_cell = |c: usize| {
            let at = |i: usize, j: usize| ((c / cells + j) * n + c % cells + i) as u32;
            [[at(0, 0), at(1, 0), at(1, 1)], [at(0, 0), at(1, 1), at(0, 1)]]
        };
        (positions, (0..cells * cells).flat_map(of_cell).collect())
    }

    fn source() -> Source {
        let (positions, faces) = sheet(SIDE, 0.25, wave);
        let positions: Vec<[f64; 3]> = positions.iter().map(|p| p.to_array()).collect();
        let mesh = MeshView::new(&positions[..], &faces[..]);
        Source::new(mesh, std::iter::empty(), &|_| Ok(())).unwrap()
    }

    /// A coarse patch over the source, each of its vertices copied from there; at height `z`.
    fn patch(source: &Source, z: impl Fn(f64, f64) -> f64) -> (Patch, Story) {
        let (positions, faces) = sheet(SIDE / STEP, 0.25 * STEP as f64, z);
        let n = SIDE / STEP + 1;
        let is_rim = |v: &usize| [0, n - 1].contains(&(v % n)) || [0, n - 1].contains(&(v / n));
        let (rim, inner): (Vec<usize>, Vec<usize>) = (0..n * n).partition(is_rim);
        let order: Vec<usize> = rim.iter().chain(&inner).copied().collect();
        let mut number = vec![0; n * n];
        order.iter().enumerate().for_each(|(i, &v)| number[v] = i as u32);
        let triangles = faces.iter().map(|t| t.map(|v| number[v as usize])).collect();
        let positions: Vec<DVec3> = order.iter().map(|&v| positions[v]).collect();
        let place = |p: &DVec3| {
            let on = DVec3::new(p.x, p.y, wave(p.x, p.y));
            let face = source.tree.closest_point(on, 1.0).unwrap().face;
            (source.face_ids[face as usize], source.barycentric(face, on))
        };
        let origins: Vec<Origin> = positions[rim.len()..]
            .iter()
            .map(place)
            .map(|(face, barycentric)| Origin { face, barycentric, source: 0, confidence: 0.9 })
            .collect();
        let seams = (0..rim.len())
            .map(|v| (v, place(&positions[v])))
            .map(|(v, (face, barycentric))| Seam { vertex: v as u32, source: 0, face, barycentric })
            .collect();
        let transform = Rigid::IDENTITY;
        let one = SourceReport {
            transform,
            error: 0.0,
            weight: 1.0,
            vertices: origins.len(),
            coloured: 0,
        };
        let sizes = vec![0.25 * STEP as f64; positions.len()];
        let patch = Patch::of_triangles(positions, sizes, rim.len(), triangles);
        let story = Story { origins, seams, sources: vec![one], ..Story::nothing(&patch) };
        (patch, story)
    }

    fn fill(patch: &Patch) -> Fill {
        let (vertices, positions) = (Vec::new(), patch.positions[..patch.rim_count].to_vec());
        let sizes = patch.sizes[..patch.rim_count].to_vec();
        Fill {
            outline: Outline {
                vertices,
                positions,
                sizes,
                rims: Vec::new(),
                taken: Vec::new(),
                share: None,
                is_even: false,
            },
            patch: patch.clone(),
            fairing: Fairing::C1,
            method: Method::Smooth,
            coherence_error: None,
            candidates: 0,
            story: None,
        }
    }

    fn resized(source: &Source, (patch, story): &(Patch, Story), factor: f64) -> (Patch, Story) {
        let sizing = Sizing::Scaled(factor);
        let made = resize((patch, story), &fill(patch), sizing, source, 2, &|| Ok(())).unwrap();
        made.unwrap()
    }

    /// Root mean square of a field over the vertices off the rim's triangles.
    fn rms(patch: &Patch, field: impl Fn(DVec3) -> f64) -> f64 {
        let inner = |p: &&DVec3| {
            let (low, high) = (0.25 * STEP as f64, 0.25 * (SIDE - STEP) as f64);
            [p.x, p.y].iter().all(|x| (low..high).contains(x))
        };
        let squares: Vec<f64> = patch.positions[patch.rim_count..]
            .iter()
            .filter(inner)
            .map(|&p| field(p).powi(2))
            .collect();
        (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
    }

    /// How far the triangles of a patch are from a surface that its vertices lie on.
    fn chords(patch: &Patch, z: impl Fn(f64, f64) -> f64) -> impl Fn(DVec3) -> f64 {
        let tree = Bvh::new(&patch.positions, &patch.triangles);
        move |p| {
            let high = DVec3::new(p.x, p.y, 9.0);
            let (_, down) = tree.meet_line(high, -DVec3::Z, 99.0, |_, _| true).unwrap();
            9.0 - down - z(p.x, p.y)
        }
    }

    /// Waves of four edges of the patch: chords miss a third of them, the source has all.
    #[test]
    fn what_the_copy_has_between_the_vertices_is_found() {
        let source = source();
        let coarse = patch(&source, wave);
        for factor in [0.5, 0.2] {
            let (finer, story) = resized(&source, &coarse, factor);
            let off = |p: DVec3| p.z - wave(p.x, p.y);
            let (now, before) = (rms(&finer, off), rms(&finer, chords(&coarse.0, wave)));
            assert!(before > 0.09 && now < 0.05 * before, "{factor}: {now} of {before}");
            // A vertex of such triangles has 0.75 square edges to itself, and the waves have more area than the square.
            let square = 0.25 * SIDE as f64 / (0.25 * STEP as f64 * factor);
            let count = 0.75 * finer.new_count() as f64 / square.powi(2);
            assert!((1.0..1.4).contains(&count), "{factor}: {count}");
            let told = story.origins.iter().zip(&finer.positions[finer.rim_count..]);
            // All but those on the triangles at two corners, which have no inner vertex.
            let told: Vec<_> = told.filter(|(o, _)| !o.is_nowhere()).collect();
            assert!(told.len() as f64 > 0.97 * finer.new_count() as f64, "{}", told.len());
            for (origin, p) in &told {
                let there = source.point(origin.face, origin.barycentric);
                assert!(there.distance(**p) < 0.1, "{there} for {p}");
                assert!((origin.confidence - 0.9).abs() < 1e-9);
            }
            assert_eq!(story.sources[0].vertices, told.len());
        }
    }

    /// A fill that kept to the smooth surface keeps to it.
    #[test]
    fn detail_that_was_not_taken_is_not_found() {
        let source = source();
        let (finer, _) = resized(&source, &patch(&source, |_, _| 0.0), 0.3);
        let off = rms(&finer, |p| p.z);
        assert!(off < 1e-9, "{off}");
    }

    /// Where nothing was copied the surface is rounded: a coarse cylinder's chords were half as far off again.
    #[test]
    fn what_no_copy_tells_is_rounded() {
        let source = source();
        let bow = |x: f64, _: f64| (400.0 - (x - 12.0).powi(2)).sqrt() - 16.0;
        let (coarse, story) = patch(&source, bow);
        let story =
            Story { seams: Vec::new(), sources: Vec::new(), origins: story.origins, ..story };
        let nowhere = vec![Origin::NOWHERE; story.origins.len()];
        let story = Story { origins: nowhere, ..story };
        let (finer, story) = resized(&source, &(coarse.clone(), story), 0.25);
        let (now, before) =
            (rms(&finer, |p| p.z - bow(p.x, p.y)), rms(&finer, chords(&coarse, bow)));
        assert!(now < 0.65 * before, "{now} of {before}");
        assert!(story.origins.iter().all(Origin::is_nowhere));
    }
}
