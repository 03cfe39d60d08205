//! The nearest of many points: the tree of `intersect::boxes` over them.
//!
//! Not `kiddo`, which `points` uses: a search that starts with a bound, as those of the alignment do, and one that
//! shares its code with the triangles' tree, measurably decide the time of the search for sources.

use crate::error::Result;
use crate::intersect::boxes::{put_in_order, sort, Later, Node, Sorted, INNER};
use glam::DVec3;

/// A tree over points that may be few or none.
pub struct PointTree {
    nodes: Vec<Node>,
    /// In the tree's order.
    points: Vec<DVec3>,
    numbers: Vec<u32>,
    /// As they were given.
    ids: Vec<u32>,
}

impl PointTree {
    /// Over the points whose indices are given. Asks `check` now and then whether to go on, with the part that is
    /// done.
    pub fn new(points: &[DVec3], ids: Vec<u32>, check: &dyn Fn(f64) -> Result<()>) -> Result<Self> {
        let mut sorted = sort(ids.iter().map(|&i| (i, points[i as usize])), check)?;
        put_in_order(&mut sorted);
        let Sorted { nodes, numbers, things, .. } = sorted;
        Ok(Self { nodes, points: things, numbers, ids })
    }

    /// Over all points.
    pub fn of_all(points: &[DVec3], check: &dyn Fn() -> Result<()>) -> Result<Self> {
        Self::new(points, (0..points.len() as u32).collect(), &|_| check())
    }

    /// The nearest point's index and its squared distance; of equal ones the smallest index.
    pub fn nearest(&self, p: DVec3) -> Option<(u32, f64)> {
        self.nearest_below(p, f64::INFINITY)
    }

    /// The same if it lies within a radius: much faster where there is none.
    pub fn nearest_within(&self, p: DVec3, radius: f64) -> Option<(u32, f64)> {
        self.nearest_below(p, radius * radius)
    }

    /// The same with the square of the radius; one that is known, from a point nearby, saves most of the search.
    pub fn nearest_below(&self, p: DVec3, square: f64) -> Option<(u32, f64)> {
        let (mut best, mut limit) = (None::<(u32, f64)>, square);
        let mut later = Later::new();
        while let Some((first, count)) = later.next(limit) {
            if count == INNER {
                let Some(node) = self.nodes.get(first as usize) else { break };
                later.add(node, node.distances_squared(p), limit);
                continue;
            }
            for k in first as usize..(first + count) as usize {
                let (d, id) = (self.points[k].distance_squared(p), self.numbers[k]);
                if d < limit || d == limit && best.is_none_or(|b| id < b.0) {
                    (best, limit) = (Some((id, d)), d);
                }
            }
        }
        best
    }

    /// The indices of the points, as they were given.
    pub fn ids(&self) -> &[u32] {
        &self.ids
    }

    /// All points within a radius, in ascending order of their indices.
    pub fn within(&self, p: DVec3, radius: f64) -> Vec<u32> {
        let square = radius * radius;
        let mut found = Vec::new();
        let mut later = Later::new();
        while let Some((first, count)) = later.next(square) {
            if count == INNER {
                let Some(node) = self.nodes.get(first as usize) else { break };
                later.add(node, node.distances_squared(p), square);
                continue;
            }
            let leaf = first as usize..(first + count) as usize;
            let near = leaf.filter(|&k| self.points[k].distance_squared(p) <= square);
            found.extend(near.map(|k| self.numbers[k]));
        }
        found.sort_unstable();
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is found is what a look at all of them finds.
    #[test]
    fn a_large_tree_finds_the_nearest_of_all() {
        let noise = |k: usize, s: usize| ((k * s) % 100_003) as f64 / 100_003.0;
        let at = |k: usize| DVec3::new(noise(k, 7919), noise(k, 104_729), noise(k, 31_337));
        let points: Vec<DVec3> = (0..100_005).map(at).collect();
        let tree = PointTree::of_all(&points, &|| Ok(())).unwrap();
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
