//! Surfaces cut out of known ones: what each step must give is known without it.

use super::domain::{Domain, Extent};
use super::fit::{fit, Fitted};
use super::join::join;
use super::project::{project, Copy};
use super::rank::{known_normals, score, weights, Scores};
use super::view::{look, View};
use super::warp::warp;
use super::window::{judge_by_whole, one_window, plan_windows, Window};
use crate::descriptor::curvature::tests::grid;
use crate::error::Error;
use crate::fill::patch::Patch;
use crate::fill::sheet::Incidence;
use crate::matching::rigid::Rigid;
use crate::matching::source::tests::{hills, some_transform};
use crate::matching::source::Source;
use crate::mesh::neighbourhood::{Neighbourhood, Positions};
use crate::mesh::MeshView;
use glam::{DMat3, DVec3};
use std::f64::consts::TAU;

/// A whole mesh, of which a part is a hole.
struct Object {
    positions: Vec<DVec3>,
    faces: Vec<[u32; 3]>,
    /// By face.
    hole: Vec<bool>,
}

impl Object {
    fn new(
        (positions, faces): (Vec<DVec3>, Vec<[u32; 3]>),
        is_hole: impl Fn(DVec3) -> bool,
    ) -> Self {
        let middle = |f: &[u32; 3]| f.iter().map(|&v| positions[v as usize]).sum::<DVec3>() / 3.0;
        let hole = faces.iter().map(|f| is_hole(middle(f))).collect();
        Self { positions, faces, hole }
    }

    /// The domain of the hole, its fill lifted over the truth by `lift`.
    fn domain(&self, extent: Extent, lift: impl Fn(DVec3) -> DVec3) -> Domain {
        let n = self.positions.len();
        let (mut inside, mut outside) = (vec![false; n], vec![false; n]);
        let mut edges = (0.0, 0.0);
        for (face, &hole) in self.faces.iter().zip(&self.hole) {
            let side = if hole { &mut inside } else { &mut outside };
            face.iter().for_each(|&v| side[v as usize] = true);
            let p = face.map(|v| self.positions[v as usize]);
            edges = (edges.0 + p[0].distance(p[1]) + p[1].distance(p[2]), edges.1 + 2.0);
        }
        let of = |rim: bool| {
            let wanted = |v: &u32| inside[*v as usize] && outside[*v as usize] == rim;
            (0..n as u32).filter(wanted).collect::<Vec<u32>>()
        };
        let (rim, inner) = (of(true), of(false));
        let mut number = vec![u32::MAX; n];
        rim.iter().chain(&inner).enumerate().for_each(|(i, &v)| number[v as usize] = i as u32);
        let at = |&v: &u32| self.positions[v as usize];
        let positions: Vec<DVec3> =
            rim.iter().map(at).chain(inner.iter().map(at).map(|p| p + lift(p))).collect();
        let part = |of_hole: bool| {
            self.faces.iter().zip(&self.hole).filter(move |f| *f.1 == of_hole).map(|f| *f.0)
        };
        let triangles = part(true).map(|f| f.map(|v| number[v as usize])).collect();
        let sizes = vec![edges.0 / edges.1; positions.len()];
        let patch = Patch::of_triangles(positions, sizes, rim.len(), triangles);
        let near = Neighbourhood {
            vertices: (0..n as u32).collect(),
            positions: Positions::Double(self.positions.clone()),
            faces: part(false).collect(),
            ..Neighbourhood::default()
        };
        let incidence = Incidence::new(&near);
        Domain::new(&patch, &near, &incidence, &rim, edges.0 / edges.1, extent).unwrap()
    }

    /// The whole mesh taken elsewhere as the source: `to_target` takes it back.
    fn source(&self, to_target: &Rigid) -> Source {
        let away = to_target.inverse();
        let vertices: Vec<[f64; 3]> =
            self.positions.iter().map(|&p| away.point(p).to_array()).collect();
        let turned = |f: &[u32; 3]| if away.is_mirrored() { [f[0], f[2], f[1]] } else { *f };
        let faces: Vec<[u32; 3]> = self.faces.iter().map(turned).collect();
        Source::new(MeshView::new(&vertices[..], &faces[..]), [].into_iter(), &|_| Ok(())).unwrap()
    }
}

/// Irregular hills with a round hole in the middle.
fn hilly() -> Object {
    let at = |u: f64, v: f64| hills(3.0 * u - 1.5, 3.0 * v - 1.5).0;
    Object::new(grid((60, 60), (false, false), at), |p| p.truncate().length() < 0.45)
}

/// A tube without a band.
fn tube() -> Object {
    let at = |u: f64, v: f64| DVec3::new((TAU * u).cos(), (TAU * u).sin(), 4.0 * v);
    Object::new(grid((60, 40), (true, false), at), |p| (p.z - 2.0).abs() < 0.4)
}

/// A flat sheet with a long narrow gap.
fn cracked() -> Object {
    let at = |u: f64, v: f64| DVec3::new(6.0 * u - 3.0, 2.0 * v - 1.0, 0.0);
    let is_gap = |p: DVec3| p.x.abs() < 2.0 && (p.y - 0.1 * (2.0 * p.x).sin()).abs() < 0.16;
    Object::new(grid((120, 40), (false, false), at), is_gap)
}

fn flat(_: DVec3) -> DVec3 {
    DVec3::ZERO
}

fn whole(object: &Object, lift: impl Fn(DVec3) -> DVec3) -> Window {
    one_window(&object.domain(Extent::Whole, lift)).unwrap()
}

fn farthest(heights: &[f64]) -> f64 {
    heights.iter().fold(0.0, |m, h| m.max(h.abs()))
}

#[test]
fn a_domain_measures_its_hole() {
    let d = hilly().domain(Extent::Whole, flat);
    assert!((0.4..0.55).contains(&d.radius) && d.radius == d.extent, "{}", d.radius);
    assert!((0.38..0.6).contains(&d.depth), "{}", d.depth);
    assert!(!d.is_slender());
    let gap = cracked().domain(Extent::Narrow, flat);
    assert!(gap.is_slender() && gap.radius < 0.3 * gap.extent, "{} {}", gap.radius, gap.extent);
    for d in [&d, &gap] {
        let n = d.sheet.positions.len();
        assert!(d.directions.iter().all(|n| (n.length() - 1.0).abs() < 1e-9 && n.z > 0.5));
        assert!(d.ring.iter().all(|&v| d.is_known(v) && d.complete[v]));
        assert!(d.ring.iter().all(|&v| d.rim_distance[v] <= 0.5 * d.radius));
        // Rim and fill are at no distance; the rest is as far as the nearest rim vertex at least.
        for v in 0..n {
            let rim = &d.sheet.positions[..d.sheet.rim_count];
            let near = rim.iter().map(|p| p.distance(d.sheet.positions[v]));
            let straight = if d.is_known(v) { near.fold(f64::INFINITY, f64::min) } else { 0.0 };
            assert!(d.rim_distance[v] >= straight - 1e-12);
            assert!(d.is_known(v) || d.rim_distance[v] == 0.0);
        }
        let normals = known_normals(d);
        for (v, (p, n, _)) in d.ring.iter().zip(d.ring_points()) {
            assert_eq!((p, n), (d.sheet.positions[*v], normals[*v]));
        }
    }
}

/// The true surface, taken elsewhere and laid back, meets every line where it starts.
#[test]
fn the_truth_laid_on_itself_has_no_height() {
    let object = hilly();
    let d = object.domain(Extent::Whole, flat);
    for mirrored in [false, true] {
        let to_target = some_transform(mirrored);
        let source = object.source(&to_target);
        let copy = project(&d, &source, &to_target).unwrap();
        assert!(farthest(&copy.heights) < 1e-12, "{}", farthest(&copy.heights));
        let normals = known_normals(&d);
        for v in d.fill.clone().chain(d.ring.iter().copied()) {
            let place = copy.places[v].unwrap();
            let corners = source.faces[place.face as usize].map(|v| source.positions[v as usize]);
            let there: DVec3 = (0..3).map(|k| place.barycentric[k] * corners[k]).sum();
            assert!(to_target.point(there).distance(d.sheet.positions[v]) < 1e-12);
            // Outward, also on a mirrored source.
            assert!(copy.normals[v].z > 0.3);
            let away_from_rim = d.is_known(v) && v >= d.fill.end && d.rim_distance[v] > d.edge;
            assert!(!away_from_rim || copy.normals[v].dot(normals[v]) > 1.0 - 1e-9);
        }
        let lifted = Rigid { translation: to_target.translation + DVec3::Z * 0.05, ..to_target };
        let copy = project(&d, &source, &lifted).unwrap();
        for (v, h) in copy.heights.iter().enumerate().filter(|(v, _)| d.fill.contains(v)) {
            // A point 0.05 above the hills, along a line that leans.
            let p = d.sheet.positions[v] + *h * d.directions[v];
            assert!((p.z - 0.05 - hills(p.x, p.y).0.z).abs() < 6e-3, "{p}");
        }
    }
}

#[test]
fn a_source_that_covers_too_little_is_refused() {
    let object = hilly();
    let d = object.domain(Extent::Whole, flat);
    let source = object.source(&Rigid::IDENTITY);
    let shifted = |x: f64| Rigid { linear: DMat3::IDENTITY, translation: DVec3::X * x };
    assert!(project(&d, &source, &shifted(0.5)).is_some());
    assert!(project(&d, &source, &shifted(1.5)).is_none(), "half the fill is beyond the border");
    // Upside down, only backs face the lines.
    let over = Rigid {
        linear: DMat3::from_diagonal(DVec3::new(1.0, -1.0, -1.0)),
        translation: DVec3::ZERO,
    };
    assert!(project(&d, &source, &over).is_none());
    // A hole in the source where the hole is.
    let kept: Vec<[u32; 3]> =
        object.faces.iter().zip(&object.hole).filter(|f| !*f.1).map(|f| *f.0).collect();
    let vertices: Vec<[f64; 3]> = object.positions.iter().map(|p| p.to_array()).collect();
    let broken =
        Source::new(MeshView::new(&vertices[..], &kept[..]), [].into_iter(), &|_| Ok(())).unwrap();
    assert!(project(&d, &broken, &Rigid::IDENTITY).is_none(), "the hole itself is no source");
}

/// Copies of a source that is laid a little off.
fn laid_off(d: &Domain, source: &Source, by: &[Rigid]) -> Vec<Copy> {
    by.iter().map(|t| project(d, source, t).unwrap()).collect()
}

fn nudged(angle: f64, by: DVec3) -> Rigid {
    let axis = DVec3::new(0.8, -0.6, 0.0);
    Rigid { linear: DMat3::from_axis_angle(axis, angle), translation: by }
}

fn fitted(d: &Domain, copies: &[Copy]) -> Fitted {
    fit(d, copies, None, None, 1, &|_| Ok(())).unwrap().unwrap()
}

#[test]
fn a_rigid_offset_leaves_nothing_over() {
    // Low hills: on steep ones a shift is no plane along lines that lean.
    let mut object = hilly();
    object.positions.iter_mut().for_each(|p| p.z *= 0.1);
    let d = object.domain(Extent::Whole, flat);
    let source = object.source(&Rigid::IDENTITY);
    // 0.03 up and 2° aslant: the fill is up to 0.05 off, an edge.
    let copies = laid_off(&d, &source, &[nudged(0.035, DVec3::Z * 0.03)]);
    let before = farthest(&copies[0].heights[d.fill.clone()]);
    let made = fitted(&d, &copies);
    let (after, left) = (farthest(&made.heights[0][d.fill.clone()]), farthest(&made.leftover[0]));
    println!(
        "before {before:.2e}, after {after:.2e}, left {left:.2e}, error {:.2e}",
        made.error[0]
    );
    assert!(before > 0.03);
    assert!(after < 0.02 * before, "{after} of {before}");
    assert!(left < 0.02 * before && made.error[0] < 0.02 * before);
    assert!(made.plate_error > made.error[0], "hills are no thin plate");
    for v in 0..d.sheet.rim_count {
        assert!(made.heights[0][v].abs() < 1e-12, "a known vertex stays");
    }
}

/// A copy that is the truth itself is believed entirely, one of noise not at all.
#[test]
fn trust_is_the_share_that_predicts_best() {
    let object = hilly();
    let d = object.domain(Extent::Whole, flat);
    let source = object.source(&Rigid::IDENTITY);
    let good = project(&d, &source, &Rigid::IDENTITY).unwrap();
    let mut bad = good.clone();
    for (v, h) in bad.heights.iter_mut().enumerate() {
        *h = 0.2 * (((v * 7919 + 13) % 101) as f64 / 50.0 - 1.0);
    }
    let made = fitted(&d, &[good, bad]);
    let (share, ratio) = made.trust(&[1.0, 0.0]);
    assert!(share > 0.99 && ratio < 0.05, "{share} {ratio}");
    let (share, ratio) = made.trust(&[0.0, 1.0]);
    assert!(share < 0.2 && ratio > 1.0, "{share} {ratio}");
    assert!(made.error[0] < 0.01 * made.error[1]);
}

#[test]
fn weights_sum_to_one_and_the_better_copy_has_more() {
    let local = vec![vec![1.0, 0.0, 3e-9, 2.0], vec![2.0, 0.0, 4e-9, 1e300], vec![1.0; 4]];
    let scores = Scores { mean: vec![0.0; 3], best: 0, local };
    for i in 0..4 {
        for power in 1..5 {
            let w = weights(&scores, i, power);
            assert!((w.iter().sum::<f64>() - 1.0).abs() < 1e-12, "{w:?}");
            assert!(w.iter().all(|w| (0.0..=1.0).contains(w)), "{w:?}");
        }
    }
    let w = weights(&scores, 0, 2);
    assert!((w[0] - 4.0 / 9.0).abs() < 1e-12 && (w[1] - 1.0 / 9.0).abs() < 1e-12, "{w:?}");

    let object = hilly();
    let d = object.domain(Extent::Whole, flat);
    let source = object.source(&Rigid::IDENTITY);
    let away = [Rigid::IDENTITY, nudged(0.0, DVec3::new(0.3, 0.2, 0.0))];
    let copies = laid_off(&d, &source, &away);
    let scores = score(&d, &copies, &fitted(&d, &copies), 0.0);
    assert_eq!(scores.best, 0);
    for i in 0..d.fill.len() {
        let w = weights(&scores, i, 2);
        assert!((w.iter().sum::<f64>() - 1.0).abs() < 1e-12 && w[0] > 0.9, "{w:?}");
    }
}

#[test]
fn windows_cover_the_fill() {
    for (object, bent, least) in [(cracked(), false, 3), (tube(), true, 3)] {
        let d = object.domain(Extent::Narrow, flat);
        assert_eq!(one_window(&d).is_none(), bent);
        let windows = plan_windows(&d, &|| Ok(())).unwrap();
        assert!(windows.len() >= least, "{}", windows.len());
        let mut covered = vec![0.0; d.fill.len()];
        for w in &windows {
            assert!(w.domain.radius <= d.radius);
            assert_eq!(w.whole_start(), d.fill.start);
            assert!(w.weight.iter().all(|w| (0.0..=1.0).contains(w)));
            covered.iter_mut().zip(&w.weight).for_each(|(c, w)| *c += w);
            let part = &w.domain;
            assert_eq!(part.sheet.positions.len(), w.parent.len());
            for (v, &p) in w.parent.iter().enumerate() {
                assert_eq!(part.sheet.positions[v], d.sheet.positions[p]);
                assert_eq!(part.is_known(v), d.is_known(p));
                assert!(part.is_known(v) || w.weight[p - d.fill.start] > 0.0);
                if part.is_known(v) {
                    assert_eq!(part.near_vertex(v), d.near_vertex(p));
                }
            }
            // Seen from one side.
            let mean: DVec3 = part.fill.clone().map(|v| part.directions[v]).sum();
            assert!(mean.length() > 0.8 * part.fill.len() as f64);
            assert!(!part.ring.is_empty());
        }
        // At 0.7 radii from a window's centre its weight is a quarter.
        assert!(covered.iter().all(|&c| c > 0.25), "{covered:?}");
    }
}

#[test]
fn one_window_is_the_whole_domain() {
    let d = hilly().domain(Extent::Whole, flat);
    let w = one_window(&d).unwrap();
    assert!(w.weight.iter().all(|&x| x == 1.0) && w.weight.len() == d.fill.len());
    assert_eq!(w.domain.sheet.positions, d.sheet.positions);
    assert_eq!(w.domain.sheet.triangles, d.sheet.triangles);
    assert_eq!((&w.domain.ring, w.domain.fill.clone()), (&d.ring, d.fill.clone()));
    assert_eq!((w.domain.radius, w.domain.extent), (d.radius, d.extent));
}

/// Where a window cuts a long fill nothing is known, and a correction that only bends little inside may be anything
/// there: noise on the ring must not shoot up at the cut.
#[test]
fn windows_end_tamely() {
    let object = cracked();
    let source = object.source(&Rigid::IDENTITY);
    let whole = object.domain(Extent::Narrow, flat);
    for window in plan_windows(&whole, &|| Ok(())).unwrap() {
        let d = &window.domain;
        assert!(window.is_part() && d.fill.clone().any(|v| !d.complete[v]), "it is cut");
        let mut copy = project(d, &source, &Rigid::IDENTITY).unwrap();
        let noise = |v: usize| 0.01 * (((v * 37 + 5) % 23) as f64 / 11.0 - 1.0);
        d.ring.iter().for_each(|&v| copy.heights[v] += noise(v));
        let made = fitted(d, &[copy]);
        let most = farthest(&made.heights[0][d.fill.clone()]);
        println!("{most:.1e}");
        assert!(most < 0.02, "{most}");
    }
}

/// A window onto a plain tube ends where its fill still bends away, and its own plate is far off there; the plate over
/// the whole band is not. So a copy of noise is believed by the one and not by the other.
#[test]
fn windows_are_judged_by_the_whole() {
    let object = tube();
    let source = object.source(&Rigid::IDENTITY);
    let whole = object.domain(Extent::Narrow, flat);
    let mut windows = plan_windows(&whole, &|| Ok(())).unwrap();
    judge_by_whole(&mut windows, &whole, 1, &|| Ok(())).unwrap();
    for window in &windows {
        let d = &window.domain;
        let mut copy = project(d, &source, &Rigid::IDENTITY).unwrap();
        let noise = |v: usize| 0.01 * (((v * 37 + 5) % 23) as f64 / 11.0 - 1.0);
        d.ring.iter().for_each(|&v| copy.heights[v] += noise(v));
        let copies = [copy];
        let by = |plate| fit(d, &copies, plate, None, 1, &|_| Ok(())).unwrap().unwrap();
        let [own, all] = [None, window.plate.as_ref()].map(by);
        println!(
            "{:.1e}: own {:.1e}, whole {:.1e}",
            own.error[0], own.plate_error, all.plate_error
        );
        assert_eq!(own.error, all.error);
        assert!(own.error[0] < 0.02, "where it has a say the copy is off by the noise, no more");
        assert!(all.plate_error < 0.004 && all.trust(&[1.0]).1 > 1.5);
        assert!(own.plate_error > 5.0 * all.plate_error && own.trust(&[1.0]).1 < 1.0);
    }
}

/// Two windows' copies at different heights: the detail changes hands where it costs least, once, and where no window
/// reaches the initial completion stays.
#[test]
fn windows_share_a_fill() {
    let object = cracked();
    let source = object.source(&Rigid::IDENTITY);
    let d = object.domain(Extent::Narrow, flat);
    let windows = plan_windows(&d, &|| Ok(())).unwrap();
    let all: Vec<View<'_>> =
        windows.iter().filter_map(|w| seen(w, &source, &[Rigid::IDENTITY])).collect();
    assert_eq!(all.len(), windows.len());
    let joined = join(&d, &all, &|| Ok(())).unwrap().unwrap();
    assert!(farthest(&joined.heights) < 1e-9 && joined.labels.iter().all(|l| l.is_some()));
    let mut used: Vec<_> = joined.labels.iter().flatten().map(|l| l.0).collect();
    used.sort_unstable();
    used.dedup();
    assert!(used.len() > 1, "{used:?}");
    let first = &all[..1];
    let alone = join(&d, first, &|| Ok(())).unwrap().unwrap();
    for (label, weight) in alone.labels.iter().zip(&windows[0].weight) {
        assert_eq!(label.is_some(), *weight > 0.077);
    }
}

fn seen<'a>(window: &'a Window, source: &Source, by: &[Rigid]) -> Option<View<'a>> {
    look(window, source, by, (0.0, None), 1, &|_| Ok(())).unwrap()
}

/// A flat fill is lifted onto the hills by the copy that shows them, the wrong ones notwithstanding.
#[test]
fn a_view_chooses_the_copy_that_is_the_truth() {
    let object = hilly();
    let sunk = |p: DVec3| DVec3::Z * (0.1 - p.z);
    let window = whole(&object, sunk);
    let source = object.source(&Rigid::IDENTITY);
    let wrong = [DVec3::new(0.3, 0.2, 0.0), DVec3::new(-0.4, 0.1, 0.02)].map(|b| nudged(0.0, b));
    let view = seen(&window, &source, &[wrong[0], Rigid::IDENTITY, wrong[1]]).unwrap();
    assert!((view.shares.iter().sum::<f64>() - 1.0).abs() < 1e-12, "{:?}", view.shares);
    assert!(view.shares[1] > 0.9, "{:?}", view.shares);
    assert!(view.labels.iter().all(|&l| l == 1));
    assert!(view.confidence > 0.9, "{}", view.confidence);
    let d = &window.domain;
    let joined = join(d, &[view], &|| Ok(())).unwrap().unwrap();
    let off = |(i, h): (usize, &f64)| {
        let p = d.sheet.positions[d.fill.start + i] + *h * d.directions[d.fill.start + i];
        (p.z - hills(p.x, p.y).0.z).abs()
    };
    let most = joined.heights.iter().enumerate().map(off).fold(0.0, f64::max);
    println!("{most:.2e} with edges of {:.2e}", d.edge);
    assert!(most < 0.1 * d.edge, "{most}");
    assert!(joined.labels.iter().all(|&l| l == Some((0, 1))));
}

#[test]
fn nothing_to_look_at_is_no_view() {
    let object = hilly();
    let window = whole(&object, flat);
    let source = object.source(&Rigid::IDENTITY);
    assert!(seen(&window, &source, &[]).is_none());
    assert!(seen(&window, &source, &[nudged(0.0, DVec3::X * 9.0)]).is_none());
    let stop = |_| Err(Error::Cancelled);
    let stopped = look(&window, &source, &[Rigid::IDENTITY], (0.0, None), 1, &stop);
    assert_eq!(stopped.err(), Some(Error::Cancelled));
}

/// One copy, and the base equal to it: nothing to reconcile.
#[test]
fn a_copy_joined_with_itself_comes_back() {
    let object = hilly();
    let window = whole(&object, |p| DVec3::Z * (0.1 - p.z));
    let d = &window.domain;
    let mut view = seen(&window, &object.source(&Rigid::IDENTITY), &[Rigid::IDENTITY]).unwrap();
    let wave = |v: usize| if d.is_known(v) { 0.0 } else { ((v * 37 + 5) % 23) as f64 / 23.0 };
    let heights: Vec<f64> = (0..d.sheet.positions.len()).map(wave).collect();
    view.base = heights[d.fill.clone()].to_vec();
    view.fitted.heights = vec![heights];
    let wanted = view.base.clone();
    let joined = join(d, &[view], &|| Ok(())).unwrap().unwrap();
    for (x, y) in joined.heights.iter().zip(&wanted) {
        assert!((x - y).abs() < 1e-6, "{x} {y}");
    }
}

/// Waves of a copy that the base does not have are weakened; where relief can only be plausible they are as
/// strong as on the copy.
#[test]
fn plausible_relief_keeps_its_strength() {
    let object = hilly();
    let window = whole(&object, |p| DVec3::Z * (0.1 - p.z));
    let d = &window.domain;
    let strength = |heights: &dyn Fn(usize) -> f64| {
        let inside = |v: &usize| d.laplacian.row(*v).all(|(w, _)| d.fill.contains(&w));
        let bend = |v: usize| {
            d.laplacian.row(v).fold(0.0, |sum, (w, _)| sum + heights(v) - heights(w)).powi(2)
        };
        d.fill.clone().filter(inside).map(bend).sum::<f64>().sqrt()
    };
    let wave = |v: usize| match d.is_known(v) {
        true => 0.0,
        false => 0.1 * d.edge * (14.0 / d.radius * d.sheet.positions[v].x).sin(),
    };
    let joined = |plausible: f64| {
        let mut view = seen(&window, &object.source(&Rigid::IDENTITY), &[Rigid::IDENTITY]).unwrap();
        view.base.fill(0.0);
        view.fitted.heights = vec![(0..d.sheet.positions.len()).map(wave).collect()];
        view.plausible = plausible;
        let heights = join(d, &[view], &|| Ok(())).unwrap().unwrap().heights;
        strength(&|v| heights[v - d.fill.start]) / strength(&wave)
    };
    let [near, half, right] = [0.0, 0.5, 1.0].map(joined);
    println!("{near:.3} {half:.3} {right:.3}");
    assert!(near < 0.8 && near < half && half < right && (right - 1.0).abs() < 1e-6);
}

/// Eq. 13 to 15: a patch that meets the rim stays as it is, one that lies aside is moved back as a whole,
/// and no vertex is moved by more than the rim is.
#[test]
fn a_patch_is_warped_no_farther_than_its_rim() {
    let object = Object::new(
        grid((40, 40), (false, false), |u, v| hills(2.0 * u - 1.0, 2.0 * v - 1.0).0),
        |p| p.truncate().length() < 0.4,
    );
    let domain = object.domain(Extent::Whole, |_| DVec3::ZERO);
    let truth = &domain.sheet.positions;
    let fill = || truth[domain.fill.clone()].iter();
    let warped = |by: &dyn Fn(usize) -> DVec3| {
        let laid: Vec<DVec3> = (0..truth.len()).map(|v| truth[v] + by(v)).collect();
        warp(&domain, &laid).unwrap()
    };
    for by in [DVec3::ZERO, DVec3::new(0.3, -0.2, 0.5)] {
        assert!(warped(&|_| by).iter().zip(fill()).all(|(a, b)| a.distance(*b) < 1e-7));
    }
    // Detail inside, a shift of the rim: the detail stays, the shift goes.
    let detail = |v: usize| match domain.fill.contains(&v) {
        true => 0.01 * ((7 * v % 11) as f64 - 5.0) * DVec3::Z,
        false => DVec3::ZERO,
    };
    let by = DVec3::new(0.05, 0.02, -0.04);
    let found = warped(&|v| detail(v) + by);
    for (i, (a, b)) in found.iter().zip(fill()).enumerate() {
        assert!(a.distance(*b + detail(domain.fill.start + i)) < 1e-7);
    }
    // A rim that differs all around: the correction lies between its least and its greatest.
    let rim = |v: usize| if domain.fill.contains(&v) { 0.0 } else { 0.1 * (v % 5) as f64 };
    let found = warped(&|v| rim(v) * DVec3::X);
    let moved: Vec<f64> = found.iter().zip(fill()).map(|(a, b)| a.x - b.x).collect();
    assert!(moved.iter().all(|m| (-0.4 - 1e-9..=1e-9).contains(m)));
    assert!(moved.iter().any(|m| *m < -0.1));
}
