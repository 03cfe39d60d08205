//! The nearest of many points.

use crate::error::Result;
use glam::DVec3;
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use std::num::NonZero;

/// A k-d tree over points that may be few or none; many are cut into pieces with a tree each, as the
/// build of one cannot be stopped.
pub struct PointTree {
    pieces: Vec<Piece>,
    ids: Vec<u32>,
}

struct Piece {
    low: DVec3,
    high: DVec3,
    tree: ImmutableKdTree<f64, 3>,
    /// Ascending.
    ids: Vec<u32>,
}

/// Points of a piece at most: its tree takes some 30 milliseconds.
const PIECE: usize = 1 << 15;

impl Piece {
    fn distance2(&self, p: DVec3) -> f64 {
        p.distance_squared(p.clamp(self.low, self.high))
    }

    fn nearest(&self, p: DVec3) -> (u32, f64) {
        let found = self.tree.nearest_one::<SquaredEuclidean>(&p.to_array());
        (self.ids[found.item as usize], found.distance)
    }
}

impl PointTree {
    /// Over the points whose indices are given.
    pub fn new(points: &[DVec3], ids: Vec<u32>, check: &dyn Fn(f64) -> Result<()>) -> Result<Self> {
        let (mut pieces, mut done) = (Vec::new(), 0);
        let mut whole = vec![ids.clone()];
        while let Some(mut part) = whole.pop() {
            check(done as f64 / ids.len().max(1) as f64)?;
            let at = || part.iter().map(|&i| points[i as usize]);
            let (low, high) =
                at().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(l, h), p| (l.min(p), h.max(p)));
            if part.len() > PIECE {
                let axis = (high - low).max_position();
                let key = |i: &u32| points[*i as usize][axis];
                let mid = part.len() / 2;
                part.select_nth_unstable_by(mid, |a, b| key(a).total_cmp(&key(b)).then(a.cmp(b)));
                whole.push(part.split_off(mid));
                whole.push(part);
            } else if !part.is_empty() {
                part.sort_unstable();
                let entries: Vec<[f64; 3]> =
                    part.iter().map(|&i| points[i as usize].to_array()).collect();
                let tree = ImmutableKdTree::new_from_slice(&entries);
                done += part.len();
                pieces.push(Piece { low, high, tree, ids: part });
            }
        }
        Ok(Self { pieces, ids })
    }

    /// Over all points.
    pub fn of_all(points: &[DVec3], check: &dyn Fn() -> Result<()>) -> Result<Self> {
        Self::new(points, (0..points.len() as u32).collect(), &|_| check())
    }

    /// The nearest point's index and its squared distance.
    pub fn nearest(&self, p: DVec3) -> Option<(u32, f64)> {
        if let [piece] = &self.pieces[..] {
            return Some(piece.nearest(p));
        }
        // The piece that the point is in or next to, then those that may hold a nearer one.
        let off = |k: &usize| self.pieces[*k].distance2(p);
        let first = (0..self.pieces.len()).min_by(|a, b| off(a).total_cmp(&off(b)))?;
        let mut best = self.pieces[first].nearest(p);
        for k in (0..self.pieces.len()).filter(|&k| k != first) {
            if off(&k) < best.1 {
                let other = self.pieces[k].nearest(p);
                if other.1 < best.1 {
                    best = other;
                }
            }
        }
        Some(best)
    }

    /// The same if it lies within a radius: much faster where there is none.
    pub fn nearest_within(&self, p: DVec3, radius: f64) -> Option<(u32, f64)> {
        let (one, mut best) = (NonZero::<usize>::MIN, None::<(u32, f64)>);
        for piece in &self.pieces {
            let limit = best.map_or(radius * radius, |b| b.1);
            if piece.distance2(p) <= limit {
                let at = p.to_array();
                let found = piece.tree.nearest_n_within::<SquaredEuclidean>(&at, limit, one, true);
                let found = found.first().filter(|f| best.is_none_or(|b| f.distance < b.1));
                best = found.map(|f| (piece.ids[f.item as usize], f.distance)).or(best);
            }
        }
        best
    }

    /// The indices of the points, in ascending order.
    pub fn ids(&self) -> &[u32] {
        &self.ids
    }

    /// All points within a radius, in ascending order of their indices.
    pub fn within(&self, p: DVec3, radius: f64) -> Vec<u32> {
        let square = radius * radius;
        let mut found = Vec::new();
        for piece in self.pieces.iter().filter(|piece| piece.distance2(p) <= square) {
            let near = piece.tree.within_unsorted::<SquaredEuclidean>(&p.to_array(), square);
            found.extend(near.iter().map(|n| piece.ids[n.item as usize]));
        }
        found.sort_unstable();
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// More points than a piece holds: what is found is what a look at all of them finds.
    #[test]
    fn a_tree_in_pieces_finds_the_nearest_of_all() {
        let noise = |k: usize, s: usize| ((k * s) % 100_003) as f64 / 100_003.0;
        let at = |k: usize| DVec3::new(noise(k, 7919), noise(k, 104_729), noise(k, 31_337));
        let points: Vec<DVec3> = (0..3 * PIECE + 5).map(at).collect();
        let tree = PointTree::of_all(&points, &|| Ok(())).unwrap();
        assert!(tree.pieces.len() > 3);
        for k in 0..40 {
            let p = 1.4 * at(k * 997 + 1) - DVec3::splat(0.2);
            let off = |i: &usize| points[*i].distance_squared(p);
            let nearest = (0..points.len()).min_by(|a, b| off(a).total_cmp(&off(b))).unwrap();
            let (found, square) = tree.nearest(p).unwrap();
            assert_eq!((points[found as usize], square), (points[nearest], off(&nearest)));
            assert_eq!(tree.nearest_within(p, 1.01 * square.sqrt()), Some((found, square)));
            assert_eq!(tree.nearest_within(p, 0.99 * square.sqrt()), None);
            let radius = 0.05 + off(&nearest).sqrt();
            let within: Vec<u32> =
                (0..points.len()).filter(|i| off(i) <= radius * radius).map(|i| i as u32).collect();
            assert_eq!(tree.within(p, radius), within);
        }
        let stop = || Err(crate::error::Error::Cancelled);
        assert!(PointTree::of_all(&points, &stop).is_err());
    }

    #[test]
    fn point_trees_answer_as_a_list_does() {
        let points: Vec<DVec3> = (0..200)
            .map(|i| DVec3::new((i * 37 % 101) as f64, (i * 53 % 89) as f64, (i % 7) as f64))
            .collect();
        let even: Vec<u32> = (0..200).step_by(2).collect();
        let tree = PointTree::new(&points, even.clone(), &|_| Ok(())).unwrap();
        for q in &points {
            let d = |i: &u32| points[*i as usize].distance_squared(*q + 0.3);
            let nearest = even.iter().map(d).fold(f64::INFINITY, f64::min);
            let (found, distance) = tree.nearest(*q + 0.3).unwrap();
            assert!((d(&found) - nearest).abs() < 1e-9 && (distance - nearest).abs() < 1e-9);
            let (close, _) = tree.nearest_within(*q + 0.3, 50.0).unwrap();
            assert!((d(&close) - nearest).abs() < 1e-9);
            let near: Vec<u32> = even.iter().copied().filter(|i| d(i) < 400.0).collect();
            assert_eq!(tree.within(*q + 0.3, 20.0), near);
        }
        let none = PointTree::of_all(&[], &|| Ok(())).unwrap();
        assert!(none.nearest(DVec3::ZERO).is_none() && none.within(DVec3::ZERO, 1e9).is_empty());
    }
}
