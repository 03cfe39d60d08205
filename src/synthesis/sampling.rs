//! Bendels, Schnabel and Klein (2005), "Fragment-based surface inpainting", Sec. 4.2: the points that a
//! fragment brings along are put in. For point clouds, where a mesh has its vertices already.
//!
//! Differences from the paper: a copy is first laid so that its points go on where those around it end
//! (a rigid fit of paired points); the triangles through the hole are kept, so that the points have faces
//! to be checked by.

use super::fragments::Pasted;
use super::raster::Raster;
use crate::fill::patch::Patch;
use crate::fill::refine::{collapse_edges, flip_pass, Taken};
use crate::intersect::{closest_point_on_triangle, Bvh};
use crate::matching::point_tree::PointTree;
use crate::matching::rigid::Rigid;
use crate::matching::source::Source;
use glam::DVec3;
use std::collections::BTreeMap;

/// Paired points are at most so far apart, in spacings: farther, another is meant.
const PAIRED: f64 = 0.7;
/// Points of a copy stay so far from points that are there, in spacings.
const APART: f64 = 0.5;
/// Fewest pairs that a fit is made from.
const FEWEST: usize = 12;
/// Steps of a fit.
const STEPS: usize = 12;
/// A copy goes on with a point around it that one of its own is so near to, in spacings. By chance it does
/// with some 0.22 (π / 16 square spacings, 2 / √3 points in each).
const ON: f64 = 0.25;
/// Copied points are taken if the copies go on with this part of the points around them: half as many
/// again as by chance. Scans: `docs/fragment.md`.
const ORDERED: f64 = 0.33;
/// Spacings around a copy in which points say how its own lie.
const AROUND: f64 = 4.0;
/// Radii of a hole around its middle within which points tell a raster.
const ALIKE: f64 = 2.0;
/// Places on the rim from which a raster is looked for.
const STARTS: usize = 3;
/// Passes of collapses and flips.
const PASSES: usize = 4;

/// A patch whose vertices are points of the copies, and the copy of each; `None` if these do not go on with
/// the points around them. `copies`: of the patch's vertices, into `pasted`.
pub fn take_points(
    patch: &Patch,
    copies: &[Option<u32>],
    pasted: &[Pasted],
    source: &Source,
    taken: Taken<'_>,
) -> Option<(Patch, Vec<Option<u32>>)> {
    let points: Vec<(DVec3, Option<u32>)> =
        points_of(patch, copies, pasted, source)?.into_iter().map(|(p, c)| (p, Some(c))).collect();
    let mut loose: Vec<bool> = copies.iter().map(|c| c.is_some()).collect();
    loose[..patch.rim_count].fill(false);
    put_points(patch, copies, &points, loose, taken)
}

/// A patch whose vertices are the nodes of the raster on which the points around it lie, where that sees it; `None` if
/// they lie on none. `copies`: of the patch's vertices.
pub fn take_nodes(
    patch: &Patch,
    copies: &[Option<u32>],
    source: &Source,
    taken: Taken<'_>,
) -> Option<(Patch, Vec<Option<u32>>)> {
    let rim = &patch.positions[..patch.rim_count];
    let middle = rim.iter().copied().sum::<DVec3>() / rim.len().max(1) as f64;
    let radius = rim.iter().map(|p| p.distance(middle)).fold(0.0, f64::max);
    let size = patch.sizes.iter().sum::<f64>() / patch.sizes.len().max(1) as f64;
    let around = source.points.within(middle, ALIKE * radius);
    let around: Vec<DVec3> = around.iter().map(|&v| source.positions[v as usize]).collect();
    let starts: Vec<DVec3> = (0..STARTS).map(|i| rim[i * rim.len() / STARTS]).collect();
    let nodes = Raster::find(&around, &starts, size)?.nodes(patch)?;
    let is_free = |p: &DVec3| source.points.nearest_within(*p, APART * size).is_none();
    let all = PointTree::of_all(&patch.positions, &|| Ok(())).ok()?;
    let of = |p: DVec3| Some((p, copies[all.nearest(p)?.0 as usize]));
    let points: Vec<_> = nodes.into_iter().filter(is_free).filter_map(of).collect();
    let placed: Vec<DVec3> = points.iter().map(|p| p.0).collect();
    let nodes = PointTree::of_all(&placed, &|| Ok(())).ok()?;
    let is_beside = |v: usize| nodes.nearest_within(patch.positions[v], size).is_some();
    let loose = (0..patch.positions.len()).map(|v| v >= patch.rim_count && is_beside(v)).collect();
    put_points(patch, copies, &points, loose, taken)
}

/// A patch with points, of copies, for its vertices; those of its own that are `loose` go.
fn put_points(
    patch: &Patch,
    copies: &[Option<u32>],
    points: &[(DVec3, Option<u32>)],
    mut loose: Vec<bool>,
    taken: Taken<'_>,
) -> Option<(Patch, Vec<Option<u32>>)> {
    let mut made = patch.clone();
    // Which copy a vertex is of rides along as its offset, from 1.
    let tag = |c: Option<u32>| DVec3::X * c.map_or(0.0, |c| f64::from(c) + 1.0);
    for (offset, copy) in made.offsets.iter_mut().zip(copies) {
        *offset = tag(*copy);
    }
    let inner: Vec<u32> = (0..loose.len() as u32).filter(|&v| loose[v as usize]).collect();
    let tree = PointTree::new(&patch.positions, inner, &|_| Ok(())).ok()?;
    let mut pairs: Vec<(f64, usize, u32)> = Vec::new();
    for (i, (p, _)) in points.iter().enumerate() {
        let (nearest, _) = tree.nearest(*p)?;
        let reach = patch.sizes[nearest as usize];
        let near = tree.within(*p, reach);
        pairs.extend(near.iter().map(|&v| (patch.positions[v as usize].distance(*p), i, v)));
    }
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    let mut left = vec![true; points.len()];
    for (_, i, v) in pairs {
        if left[i] && loose[v as usize] {
            (left[i], loose[v as usize]) = (false, false);
            made.positions[v as usize] = points[i].0;
            made.offsets[v as usize] = tag(points[i].1);
        }
    }
    insert(&mut made, points.iter().zip(&left).filter(|p| *p.1).map(|p| (p.0 .0, tag(p.0 .1))));
    loose.resize(made.positions.len(), false);
    for _ in 0..PASSES {
        collapse_edges(&mut made, taken, |p, t, k| loose[p.triangles[t as usize][k] as usize]);
        flip_pass(&mut made, taken);
    }
    made.compact();
    let copies = made.offsets.iter().map(|o| (o.x > 0.5).then(|| o.x as u32 - 1)).collect();
    made.offsets.fill(DVec3::ZERO);
    Some((made, copies))
}

/// The points of all copies that are in the hole and not where another is.
fn points_of(
    patch: &Patch,
    copies: &[Option<u32>],
    pasted: &[Pasted],
    source: &Source,
) -> Option<Vec<(DVec3, u32)>> {
    let rim = patch.rim_count;
    let mut members: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    for v in rim..copies.len() {
        if let Some(c) = copies[v] {
            members.entry(c).or_default().push(v as u32);
        }
    }
    let all = PointTree::of_all(&patch.positions, &|| Ok(())).ok()?;
    let mut found: Vec<(DVec3, u32)> = Vec::new();
    let (mut on, mut around) = (0, 0);
    for (&c, members) in &members {
        let at = |&v: &u32| patch.positions[v as usize];
        let centre = members.iter().map(at).sum::<DVec3>() / members.len() as f64;
        let size = members.iter().map(|&v| patch.sizes[v as usize]).sum::<f64>();
        let size = size / members.len() as f64;
        let reach = members.iter().map(|v| at(v).distance(centre)).fold(0.0, f64::max);
        let known = source.points.within(centre, reach + AROUND * size);
        let mut fixed: Vec<DVec3> = known.iter().map(|&v| source.positions[v as usize]).collect();
        let known = fixed.len();
        let near = |p: &&(DVec3, u32)| p.0.distance(centre) < reach + AROUND * size;
        fixed.extend(found.iter().filter(near).map(|p| p.0));
        let transform = lay(pasted[c as usize].transform, &fixed, source, size);
        let back = transform.inverse();
        let goes_on = |q: &&DVec3| {
            let nearest = source.points.nearest(back.point(**q));
            nearest.is_some_and(|(_, d2)| d2.sqrt() < ON * size)
        };
        on += fixed[..known].iter().filter(goes_on).count();
        around += known;
        let mut ids: Vec<u32> =
            members.iter().flat_map(|v| source.points.within(back.point(at(v)), size)).collect();
        ids.sort_unstable();
        ids.dedup();
        for s in ids {
            let p = transform.point(source.positions[s as usize]);
            let owner = all.nearest(p)?.0 as usize;
            let own = owner >= rim && copies[owner] == Some(c);
            if own && fixed.iter().all(|q| q.distance(p) > APART * size) {
                found.push((p, c));
            }
        }
    }
    (on as f64 >= ORDERED * around as f64).then_some(found)
}

/// A transform changed a little so that the source's points lie where points are.
fn lay(start: Rigid, fixed: &[DVec3], source: &Source, size: f64) -> Rigid {
    let mut transform = start;
    for _ in 0..STEPS {
        let back = transform.inverse();
        let pair = |q: &DVec3| {
            let (s, d2) = source.points.nearest(back.point(*q))?;
            (d2.sqrt() < PAIRED * size).then(|| (source.positions[s as usize], *q, 1.0))
        };
        let pairs: Vec<(DVec3, DVec3, f64)> = fixed.iter().filter_map(pair).collect();
        if pairs.len() < FEWEST {
            return start;
        }
        match Rigid::fit(pairs.iter().copied(), Some(start.is_mirrored())) {
            Some(better) => transform = better,
            None => return start,
        }
    }
    transform
}

/// Puts points into the triangles that they are nearest to.
fn insert(patch: &mut Patch, points: impl Iterator<Item = (DVec3, DVec3)>) {
    let corners = |p: &Patch, t: usize| p.triangles[t].map(|v| p.p(v));
    let before: Vec<_> =
        (0..patch.triangles.len()).map(|t| (t as u32, corners(patch, t))).collect();
    let tree = Bvh::from_triangles(before.into_iter());
    // What each of the triangles was split into.
    let mut parts: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    for (p, tag) in points {
        let Some(hit) = tree.closest_point(p, f64::INFINITY) else { return };
        let parts = parts.entry(hit.face).or_insert_with(|| vec![hit.face]);
        let off = |t: &u32| {
            closest_point_on_triangle(p, &corners(patch, *t as usize)).distance_squared(p)
        };
        let Some(&t) = parts.iter().min_by(|a, b| off(a).total_cmp(&off(b))) else { return };
        let first = patch.triangles.len() as u32;
        let v = patch.insert(t, p);
        patch.offsets[v as usize] = tag;
        parts.extend([first, first + 1]);
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::matching::source::tests::{hills, hilly_source};
    use super::*;

    /// A copy of the hills three tenths of an edge aside is laid back onto their points.
    #[test]
    fn a_copy_goes_on_where_points_end() {
        let source = hilly_source(40);
        let fixed: Vec<DVec3> = source
            .positions
            .iter()
            .copied()
            .filter(|p| p.length() > 0.3 && p.length() < 0.8)
            .collect();
        let aside = Rigid { translation: 0.3 * source.edge * DVec3::X, ..Rigid::IDENTITY };
        let laid = lay(aside, &fixed, &source, source.edge);
        assert!(laid.translation.length() < 1e-6 * source.edge, "{:?}", laid);
        assert_eq!(lay(aside, &fixed[..5], &source, source.edge), aside);
    }

    /// Of a coarse patch over a square each point becomes a vertex, and no other vertex is left inside.
    #[test]
    fn the_vertices_are_the_points() {
        let source = hilly_source(40);
        let corner = |x: f64, y: f64| DVec3::new(x, y, 0.0);
        let (n, side) = (9, 0.5);
        let rim: Vec<DVec3> = (0..4 * n)
            .map(|i| {
                let t = 2.0 * side * (i % n) as f64 / n as f64 - side;
                match i / n {
                    0 => corner(t, -side),
                    1 => corner(side, t),
                    2 => corner(-t, side),
                    _ => corner(-side, -t),
                }
            })
            .collect();
        let (count, centre) = (rim.len(), corner(0.0, 0.0));
        let positions = [rim, vec![centre]].concat();
        let triangles =
            (0..count as u32).map(|i| [i, (i + 1) % count as u32, count as u32]).collect();
        let sizes = vec![source.edge; positions.len()];
        let mut patch = Patch::of_triangles(positions, sizes, count, triangles);
        let never = || Ok(());
        let mut pace = crate::progress::Pace::new(&never);
        assert!(crate::fill::refine::refine(&mut patch, &[], 4, &mut pace).unwrap());
        let copies: Vec<Option<u32>> =
            (0..patch.positions.len()).map(|v| (v >= count).then_some(0)).collect();
        // Far from the source itself, so that nothing is known there.
        let shifted = [Pasted {
            transform: Rigid { translation: DVec3::Z * 9.0, ..Rigid::IDENTITY },
            errors: [0.0; 2],
        }];
        let mut far = patch.clone();
        far.positions.iter_mut().for_each(|p| *p = hills(p.x, p.y).0 + DVec3::Z * 9.0);
        let (made, of) = take_points(&far, &copies, &shifted, &source, &[]).unwrap();
        let is_point = |p: &DVec3| {
            let (_, d2) = source.points.nearest(*p - DVec3::Z * 9.0).unwrap();
            d2.sqrt() < 1e-9
        };
        let inner = &made.positions[count..];
        let points = inner.iter().filter(|p| is_point(p)).count();
        assert!(points * 10 > inner.len() * 9, "{points} of {}", inner.len());
        // A strip at the rim stays free.
        let wanted = 4.0 * side * side / (3.0f64 / 39.0).powi(2);
        assert!((0.6..1.1).contains(&(points as f64 / wanted)), "{points} {wanted}");
        assert!(of[count..].iter().all(|c| *c == Some(0)));
    }
}
