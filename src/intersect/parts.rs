//! The exact test of many faces, part by part: a fill of any size is tested with trees that stay in the
//! cache and take no room.

use super::boxes::Aabb;
use super::bvh::Bvh;
use super::triangle::{triangles_intersect, Triangle};

/// Height over longest edge at and below which a face counts as having no area.
///
/// Between the two roundings that matter: three corners on a line, once rounded to f32, give a
/// ratio of 0 or about 6e-8 (2^-24), so no face that f32 can tell from a line is condemned; the
/// cross product itself is off by about 4e-16 in f64, so no line is taken for a face.
const FLAT_RATIO: f64 = 1e-12;

/// Faces of the fill that are tested with one tree: it takes some 0.15 KiB for each and so half a
/// megabyte. Own choice.
const PART: usize = 4096;

/// Faces that are known by their corners alone, wherever those lie: the known ones near a fill, then
/// the fill.
pub struct Soup<F> {
    /// How many.
    pub count: usize,
    /// The corners of face `f`.
    pub corners: F,
}

impl<F: Fn(usize) -> Triangle> Soup<F> {
    /// The faces from `fill_start` on that [`super::find_intersections`] would name, ascending; only
    /// some of them if there are more than `most`. A fill that meets everything has millions of pairs:
    /// they are not kept.
    pub fn faces_that_meet(&self, fill_start: usize, most: usize) -> Vec<u32> {
        let first = fill_start.min(self.count);
        let mut meets = vec![false; self.count - first];
        let mut count = 0;
        self.any_intersection(fill_start, &mut |pair| {
            for f in pair.into_iter().filter(|&f| f as usize >= first) {
                count += usize::from(!std::mem::replace(&mut meets[f as usize - first], true));
            }
            count > most
        });
        (first as u32..).zip(meets).filter(|x| x.1).map(|x| x.0).collect()
    }

    /// As [`super::degenerate_faces`].
    pub fn degenerate_faces(&self, from: usize) -> Vec<u32> {
        let is_degenerate = |f: usize| {
            let [a, b, c] = (self.corners)(f);
            let edges = [b - a, c - b, a - c];
            let longest = edges.iter().fold(0.0, |m: f64, e| m.max(e.length_squared()));
            // Twice the area is height times longest edge. Written so that NaN is degenerate.
            let has_area = edges[0].cross(edges[1]).length() > FLAT_RATIO * longest;
            !(has_area && longest.is_finite())
        };
        (from..self.count).filter(|&f| is_degenerate(f)).map(|f| f as u32).collect()
    }

    /// Calls `found` for each pair until it returns true; whether it did.
    pub(super) fn any_intersection(
        &self,
        fill_start: usize,
        found: &mut dyn FnMut([u32; 2]) -> bool,
    ) -> bool {
        self.any_by_parts(fill_start, PART, found)
    }

    /// The same with parts of at most `size` faces, at least 1.
    pub(super) fn any_by_parts(
        &self,
        fill_start: usize,
        size: usize,
        found: &mut dyn FnMut([u32; 2]) -> bool,
    ) -> bool {
        let first = fill_start.min(self.count) as u32;
        let mut fill: Vec<u32> = (first..self.count as u32).collect();
        let bounds = self.bounds(&fill);
        let near = (0..first).filter(|&f| self.bounds_of(f).overlaps(&bounds));
        let all = near.chain(first..self.count as u32).collect();
        self.any_in_part(&mut fill, all, (first, size), found)
    }

    /// The same for a part of the fill and all faces whose boxes meet its own: the known ones are below
    /// `first`.
    fn any_in_part(
        &self,
        part: &mut [u32],
        near: Vec<u32>,
        (first, size): (u32, usize),
        found: &mut dyn FnMut([u32; 2]) -> bool,
    ) -> bool {
        if part.len() > size {
            // Across the longest extent. The index settles ties.
            let bounds = self.bounds(part);
            let extent = bounds.hi - bounds.lo;
            let axis = (0..3).fold(0, |a, b| if extent[b] > extent[a] { b } else { a });
            let middle = part.len() / 2;
            let key = |&f: &u32| self.bounds_of(f).lo[axis];
            let order = |a: &u32, b: &u32| key(a).total_cmp(&key(b)).then(a.cmp(b));
            part.select_nth_unstable_by(middle, order);
            let (left, right) = part.split_at_mut(middle);
            return [left, right].into_iter().any(|half| {
                let bounds = self.bounds(half);
                let meets = |f: &u32| self.bounds_of(*f).overlaps(&bounds);
                let near = near.iter().copied().filter(meets).collect();
                self.any_in_part(half, near, (first, size), found)
            });
        }
        let tree = Bvh::from_triangles(near.into_iter().map(|f| (f, (self.corners)(f as usize))));
        part.iter().any(|&f| {
            let t = (self.corners)(f as usize);
            tree.any_overlapping(&Aabb::of(&t), |other, s| {
                let is_mine = other < first || other > f;
                is_mine && triangles_intersect(&t, s) && found([f, other])
            })
        })
    }

    fn bounds_of(&self, f: u32) -> Aabb {
        Aabb::of(&(self.corners)(f as usize))
    }

    fn bounds(&self, faces: &[u32]) -> Aabb {
        faces.iter().fold(Aabb::EMPTY, |b, &f| b.union(&self.bounds_of(f)))
    }
}
