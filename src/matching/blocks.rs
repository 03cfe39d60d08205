//! The points of a cloud by blocks of near ones, in single precision and lane by lane: height maps
//! are made of some thousand points each, and this is most of what a search costs.
//!
//! Sums run over the lanes in the same order on every machine, whatever its vectors: same bytes.

use super::cloud::Thinned;
use crate::error::Result;
use crate::intersect::Aabb;
use crate::mesh::neighbourhood::NONE;
use glam::DVec3;
use pulp::{Simd, WithSimd};

/// Points that are worked on side by side.
pub const LANES: usize = 8;
/// Points of a block at most.
const MOST: usize = 4 * LANES;
/// Splits of more points than this ask whether to go on.
const CHECKED: usize = 1 << 12;

/// A value of each of some points.
pub type Lanes = [f32; LANES];

/// Points side by side; places that no point fills lie far off.
#[derive(Clone, Copy)]
pub struct Group {
    /// Position, relative to the block's origin.
    pub at: [Lanes; 3],
    /// Unit normal.
    pub normal: [Lanes; 3],
    /// See [`Thinned::roughness`].
    pub roughness: Lanes,
    /// Whether some of them are of a hole's completion.
    pub is_completed: bool,
    /// Which points of the cloud they are.
    pub ids: [u32; LANES],
}

/// Farther than any point, with a square that is still a number.
const FAR: f32 = 1e18;

impl Group {
    const EMPTY: Self = Self {
        at: [[FAR; LANES]; 3],
        normal: [[0.0; LANES]; 3],
        roughness: [0.0; LANES],
        is_completed: false,
        ids: [0; LANES],
    };
}

/// A box of a tree in depth-first order.
struct Node {
    bounds: Aabb,
    /// Where to go on if nothing of it is wanted.
    next: u32,
    /// Groups of a leaf; none of an inner node.
    groups: std::ops::Range<u32>,
}

/// A tree over points.
pub struct Blocks {
    nodes: Vec<Node>,
    groups: Vec<Group>,
    /// By group, see [`Thinned::tints`]; empty without colours.
    tints: Vec<Lanes>,
}

/// The blocks that a ball meets.
pub struct Near {
    centre: DVec3,
    /// Of the ball, in mesh units.
    pub radius: f64,
    nodes: Vec<u32>,
}

impl Blocks {
    /// Over points with unit normals.
    pub fn new(cloud: &Thinned, check: &dyn Fn() -> Result<()>) -> Result<Self> {
        let mut ids: Vec<u32> = (0..cloud.points.len() as u32).collect();
        let mut blocks = Self { nodes: Vec::new(), groups: Vec::new(), tints: Vec::new() };
        if !ids.is_empty() {
            blocks.add(cloud, &mut ids, check)?;
        }
        Ok(blocks)
    }

    fn add(
        &mut self,
        cloud: &Thinned,
        ids: &mut [u32],
        check: &dyn Fn() -> Result<()>,
    ) -> Result<()> {
        let points = &cloud.points;
        let (mut lo, mut hi) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for &i in ids.iter() {
            (lo, hi) = (lo.min(points[i as usize]), hi.max(points[i as usize]));
        }
        let (node, first) = (self.nodes.len(), self.groups.len() as u32);
        self.nodes.push(Node { bounds: Aabb { lo, hi }, next: 0, groups: first..first });
        if ids.len() <= MOST {
            ids.sort_unstable();
            self.groups.extend(ids.chunks(LANES).map(|ids| group(cloud, ids, lo)));
            if let Some(all) = &cloud.tints {
                let tint = |ids: &[u32], l: usize| ids.get(l).map_or(0.0, |&i| all[i as usize]);
                let of_group = |ids: &[u32]| std::array::from_fn(|l| tint(ids, l) as f32);
                self.tints.extend(ids.chunks(LANES).map(of_group));
            }
            self.nodes[node].groups.end = self.groups.len() as u32;
        } else {
            if ids.len() > CHECKED {
                check()?;
            }
            let axis = (hi - lo).max_position();
            let key = |i: &u32| points[*i as usize][axis];
            // Whole groups on the left.
            let middle = (ids.len() / 2).next_multiple_of(LANES);
            ids.select_nth_unstable_by(middle, |a, b| key(a).total_cmp(&key(b)).then(a.cmp(b)));
            let (left, right) = ids.split_at_mut(middle);
            self.add(cloud, left, check)?;
            self.add(cloud, right, check)?;
        }
        self.nodes[node].next = self.nodes.len() as u32;
        Ok(())
    }

    /// The blocks with points in a ball, and others that are near.
    pub fn near(&self, centre: DVec3, radius: f64) -> Near {
        let (mut nodes, mut at) = (Vec::new(), 0);
        while let Some(node) = self.nodes.get(at) {
            let off = centre.distance_squared(centre.clamp(node.bounds.lo, node.bounds.hi));
            if off > radius * radius {
                at = node.next as usize;
                continue;
            }
            if !node.groups.is_empty() {
                nodes.push(at as u32);
            }
            at += 1;
        }
        Near { centre, radius, nodes }
    }

    /// Calls `visit` with each group of the blocks found, its number, and its origin as seen from the ball's
    /// centre.
    #[inline(always)]
    pub fn visit(&self, near: &Near, mut visit: impl FnMut(&Group, usize, [f32; 3])) {
        for &node in &near.nodes {
            let node = &self.nodes[node as usize];
            let origin = (node.bounds.lo - near.centre).as_vec3().to_array();
            let first = node.groups.start as usize;
            let groups = &self.groups[first..node.groups.end as usize];
            groups.iter().enumerate().for_each(|(k, group)| visit(group, first + k, origin));
        }
    }

    /// The tints of a group's points; `None` without colours.
    #[inline(always)]
    pub fn tints_of(&self, group: usize) -> Option<&Lanes> {
        self.tints.get(group)
    }

    /// The sum of the normals of the points in a ball that are on the side of `normal`.
    pub fn sum_normals(&self, near: &Near, normal: DVec3) -> DVec3 {
        let sums = pulp::Arch::new().dispatch(Normals { blocks: self, near, side: normal });
        DVec3::from(sums.map(|lanes| lanes.iter().map(|&x| f64::from(x)).sum()))
    }
}

/// The work of [`Blocks::sum_normals`], lane by lane.
struct Normals<'a> {
    blocks: &'a Blocks,
    near: &'a Near,
    side: DVec3,
}

impl WithSimd for Normals<'_> {
    type Output = [Lanes; 3];

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> [Lanes; 3] {
        let side = self.side.as_vec3().to_array();
        let square = (self.near.radius * self.near.radius) as f32;
        let mut sums = [[0f32; LANES]; 3];
        self.blocks.visit(self.near, |group, _, origin| {
            for l in 0..LANES {
                let [x, y, z] = [0, 1, 2].map(|k| group.at[k][l] + origin[k]);
                let n = [0, 1, 2].map(|k| group.normal[k][l]);
                let counts = (n[0] * side[0] + n[1] * side[1] + n[2] * side[2] > 0.0)
                    & (x * x + y * y + z * z < square);
                let weight = f32::from(u8::from(counts));
                for k in 0..3 {
                    sums[k][l] += weight * n[k];
                }
            }
        });
        sums
    }
}

fn group(cloud: &Thinned, ids: &[u32], origin: DVec3) -> Group {
    let mut group = Group::EMPTY;
    for (l, &id) in ids.iter().enumerate() {
        let i = id as usize;
        let (p, n) = (cloud.points[i] - origin, cloud.normals[i]);
        group.roughness[l] = cloud.roughness[i] as f32;
        group.is_completed |= cloud.completion_of(i) != NONE;
        for k in 0..3 {
            (group.at[k][l], group.normal[k][l]) = (p[k] as f32, n[k] as f32);
        }
        group.ids[l] = id;
    }
    group
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Error;

    fn noise(k: usize, s: usize) -> f64 {
        ((k * s) % 10_007) as f64 / 10_007.0
    }

    /// What is visited holds every point of the ball once, where it is.
    #[test]
    fn every_point_of_a_ball_is_visited() {
        let at = |k: usize| DVec3::new(noise(k, 7919), noise(k, 4729), 3.0 + noise(k, 1337));
        for count in [0, 1, 31, 33, 5000] {
            let points: Vec<DVec3> = (0..count).map(at).collect();
            let normals: Vec<DVec3> = points.iter().map(|p| p.normalize()).collect();
            let cloud = Thinned {
                points,
                normals,
                roughness: vec![0.0; count],
                tints: Some((0..count).map(|i| i as f64).collect()),
                completion: Vec::new(),
            };
            let Thinned { points, normals, .. } = &cloud;
            let blocks = Blocks::new(&cloud, &|| Ok(())).unwrap();
            for (k, radius) in [(3, 0.1), (17, 0.4), (40, 9.0)] {
                let (centre, mut seen) = (at(k), Vec::new());
                let near = blocks.near(centre, radius);
                let mut sum = DVec3::ZERO;
                blocks.visit(&near, |group, number, origin| {
                    let tints = blocks.tints_of(number).unwrap();
                    for l in (0..LANES).filter(|&l| group.at[0][l] != FAR) {
                        let p = [0, 1, 2].map(|k| f64::from(group.at[k][l] + origin[k]));
                        let i = group.ids[l] as usize;
                        assert_eq!(tints[l], i as f32);
                        assert!(DVec3::from(p).distance(points[i] - centre) < 1e-6);
                        seen.push(i);
                    }
                });
                let all = seen.len();
                seen.sort_unstable();
                seen.dedup();
                assert_eq!(seen.len(), all, "none twice");
                for i in 0..count {
                    let off = points[i].distance(centre);
                    assert!(off > radius || seen.binary_search(&i).is_ok());
                    if off < 0.99 * radius && normals[i].x > 0.0 {
                        sum += normals[i];
                    }
                }
                let found = blocks.sum_normals(&blocks.near(centre, 0.99 * radius), DVec3::X);
                assert!(found.distance(sum) < 1e-6 * (1.0 + sum.length()), "{found} {sum}");
            }
            let stop = || Err(Error::Cancelled);
            assert_eq!(Blocks::new(&cloud, &stop).is_err(), count == 5000);
        }
    }
}
