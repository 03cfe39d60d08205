//! Holes of clouds that the caller gives: loops and regions.

use super::points::{broken_sphere, find, nearest, noisy, spacing, sphere, HOLES};
use complete_mesh::{
    complete_mesh, complete_points, find_point_holes, Cleaning, Error, GivenHole, HoleStatus,
    Method, Monitor, Options, PointHoles, Selection,
};
use glam::DVec3;

fn with(given_holes: Vec<GivenHole>) -> Options {
    Options { method: Method::Smooth, threads: 1, given_holes, ..Options::default() }
}

fn list(points: &[[f64; 3]], given: Vec<GivenHole>) -> Result<PointHoles, Error> {
    find_point_holes(points.into(), None, &with(given), &Monitor::silent())
}

fn why(points: &[[f64; 3]], given: GivenHole) -> String {
    match list(points, vec![given]) {
        Err(Error::InvalidOption { name: "given_holes", reason }) => reason,
        other => panic!("{other:?}"),
    }
}

/// The points around a direction at about this distance from it, in order.
fn around(points: &[[f64; 3]], centre: [f64; 3], radius: f64) -> Vec<u32> {
    let c = DVec3::from(centre).normalize();
    let x = c.any_orthonormal_vector();
    let y = c.cross(x);
    let mut ring: Vec<u32> = (0..24)
        .map(|k| {
            let a = f64::from(k) / 24.0 * std::f64::consts::TAU;
            let at = (c + radius * (a.cos() * x + a.sin() * y)).normalize();
            let d = |i: &usize| DVec3::from(points[*i]).distance(at);
            (0..points.len()).min_by(|i, j| d(i).total_cmp(&d(j))).unwrap() as u32
        })
        .collect();
    ring.dedup();
    ring
}

/// A hole's own rim, given either way round: the same hole and the same new points as when it is found, and no
/// other is filled.
#[test]
fn the_rim_that_was_found_may_be_given() {
    let (kept, _) = broken_sphere(6000);
    let found = find(&kept);
    let rim = |h: usize| found.list.loops[found.list.holes[h].loops[0]].vertices.clone();
    let one = Options { selection: Selection::Ids(vec![1]), ..with(vec![]) };
    let wanted = complete_points(&kept[..], None, &one).unwrap();
    let mut back = rim(1);
    back.reverse();
    back.rotate_left(5);
    for points in [rim(1), back] {
        let made = complete_points(&kept[..], None, &with(vec![GivenHole::Loop(points)])).unwrap();
        assert_eq!(made.found.list.loops.len(), 1);
        assert_eq!(made.found.list.loops[0].vertices, rim(1));
        assert_eq!(made.completion.vertices, wanted.completion.vertices);
        assert_eq!(made.normals, wanted.normals);
        assert_eq!(made.completion.holes.len(), 1);
        assert_eq!(made.completion.holes[0].status, HoleStatus::Filled);
        assert!((made.found.in_loops[0], made.found.in_field[0]) == (true, Some(true)));
        assert_eq!(made.found.missing_in[0], found.missing_in[1]);
        assert!(made.found.inside.is_empty());
    }
    // Two of the three, in the order of their smallest points; every third point will do.
    let some = |h: usize| GivenHole::Loop(rim(h).into_iter().step_by(3).collect());
    let two = list(&kept, vec![some(2), some(0)]).unwrap();
    let rims: Vec<Vec<u32>> = two.list.loops.iter().map(|l| l.vertices.clone()).collect();
    assert_eq!(rims, [rim(0), rim(2)]);
}

/// Whether a point lies within a loop of others, but is none of them, seen along a direction.
fn is_within(p: &[f64; 3], rim: &[[f64; 3]], along: [f64; 3]) -> bool {
    let (x, y) = DVec3::from(along).any_orthonormal_pair();
    let flat = |q: &[f64; 3]| [x, y].map(|axis| DVec3::from(*q).dot(axis));
    let [u, v] = flat(p);
    let crossed = (0..rim.len()).filter(|&i| {
        let ([a, b], [c, d]) = (flat(&rim[i]), flat(&rim[(i + 1) % rim.len()]));
        (b > v) != (d > v) && u < a + (v - b) / (d - b) * (c - a)
    });
    let inside = crossed.count() % 2 == 1;
    inside && DVec3::from(*p).dot(DVec3::from(along)) > 0.0 && !rim.contains(p)
}

/// A loop around nothing, and one a little outside a hole: the surface inside is made anew, points there
/// stay where they are and are named.
#[test]
fn a_loop_may_take_in_points() {
    let h = spacing(6000);
    for (points, centre, radius) in
        [(sphere(6000), [0.0, 0.6, 0.8], 0.25), (broken_sphere(6000).0, HOLES[1].0, 0.3)]
    {
        let ring = around(&points, centre, radius);
        let options = Options {
            clean: Some(Cleaning { rounds: 0 }),
            ..with(vec![GivenHole::Loop(ring.clone())])
        };
        let made = complete_points(&points[..], None, &options).unwrap();
        let rim = &made.found.list.loops[0].vertices;
        assert!(ring.iter().all(|p| rim.contains(p)), "the points given are on the rim");
        let off = |i: u32| DVec3::from(points[i as usize]).distance(DVec3::from(centre));
        assert!(rim.iter().all(|&i| (off(i) - radius).abs() < 1.5 * h), "no other is far");
        // All points well inside, and none outside.
        let inside = &made.found.inside;
        assert!(inside.iter().all(|&i| off(i) < radius + 0.5 * h));
        let deep = (0..points.len() as u32).filter(|&i| off(i) < radius - 1.5 * h);
        assert!(deep.clone().all(|i| inside.contains(&i)) && deep.count() > 10);
        let removed = made.cleaned.unwrap().removed;
        assert!(inside.iter().all(|&i| removed[i as usize]));
        // The fill covers the whole, on the sphere, with as many points as the sphere has there.
        let rim: Vec<[f64; 3]> = rim.iter().map(|&i| points[i as usize]).collect();
        let of_sphere = sphere(6000).into_iter().filter(|p| is_within(p, &rim, centre)).count();
        let ratio = made.completion.vertices.len() as f64 / of_sphere as f64;
        assert!((0.9..1.1).contains(&ratio), "{ratio}");
        for p in &made.completion.vertices {
            assert!((DVec3::from(*p).length() - 1.0).abs() < 0.05 * h, "{p:?}");
            assert!(DVec3::from(*p).distance(DVec3::from(centre)) < radius + h);
        }
    }
}

/// A gap of four points is too small to be found; in a region it counts. The others are not filled.
#[test]
fn in_a_region_small_gaps_are_holes() {
    let (kept, _) = broken_sphere(6000);
    let centre = DVec3::new(0.0, 0.6, 0.8);
    let mut order: Vec<usize> = (0..kept.len()).collect();
    let d = |i: &usize| DVec3::from(kept[*i]).distance(centre);
    order.sort_by(|i, j| d(i).total_cmp(&d(j)));
    let (gone, h) = (&order[..4], spacing(6000));
    let points: Vec<[f64; 3]> =
        (0..kept.len()).filter(|i| !gone.contains(i)).map(|i| kept[i]).collect();
    assert_eq!(find(&points).list.holes.len(), 3, "it is not found");
    let region =
        |centre: DVec3, radius: f64| GivenHole::Region { centre: centre.to_array(), radius };
    let made = complete_points(&points[..], None, &with(vec![region(centre, 4.0 * h)])).unwrap();
    assert_eq!(made.found.list.holes.len(), 1);
    let new = &made.completion.vertices;
    assert!((3..=6).contains(&new.len()), "{} new points", new.len());
    // The gap is two spacings wide, and now no emptier than the rest.
    let all: Vec<[f64; 3]> = points.iter().chain(new).copied().collect();
    for p in new {
        assert!(
            DVec3::from(*p).distance(centre) < 1.3 * h && nearest(*p, &points) > 0.5 * h,
            "{p:?}"
        );
    }
    for &i in gone {
        assert!(nearest(kept[i], &all) < 0.85 * h, "{}", nearest(kept[i], &all) / h);
    }
    // Around one of the three that are found it is that one.
    let found = find(&points);
    let listed =
        list(&points, vec![region(DVec3::from(HOLES[0].0), HOLES[0].1 + 2.0 * h)]).unwrap();
    assert_eq!(listed.list.holes.len(), 1);
    let same = |l: &complete_mesh::BoundaryLoop| l.vertices == listed.list.loops[0].vertices;
    assert_eq!(found.list.loops.iter().filter(|l| same(l)).count(), 1);
    // Noise makes no more of it.
    let rough = noisy(&points, 0.1 * h / 3f64.sqrt());
    assert_eq!(list(&rough, vec![region(centre, 4.0 * h)]).unwrap().list.holes.len(), 1);
}

/// Every second point is gone in a patch: its triangles span it, until a region says what is missing.
#[test]
fn a_region_shows_a_sparse_place() {
    let at = |i: i32, j: i32| {
        [f64::from(i) + 0.5 * f64::from(j & 1), f64::from(j) * 0.75f64.sqrt(), 0.0]
    };
    let centre = DVec3::new(20.0, 17.0, 0.0);
    let grid = (0..40).flat_map(|j| (0..40).map(move |i| (i, j)));
    let sparse = |i: i32, j: i32| i % 2 != 0 || j % 2 != 0;
    let points: Vec<[f64; 3]> = grid
        .filter(|&(i, j)| DVec3::from(at(i, j)).distance(centre) > 6.0 || !sparse(i, j))
        .map(|(i, j)| at(i, j))
        .collect();
    let region = GivenHole::Region { centre: centre.to_array(), radius: 9.0 };
    let found = list(&points, vec![region]).unwrap();
    assert!(list(&points, vec![]).unwrap().borders.iter().all(|b| *b), "found without");
    let inside = |h: &complete_mesh::Hole| DVec3::from(h.centre).distance(centre) < 7.0;
    assert!(!found.list.holes.is_empty() && found.list.holes.iter().all(inside));
    let missing: f64 = found.missing_in.iter().sum();
    assert!(missing > 40.0, "{missing}");
}

#[test]
fn the_border_of_an_open_surface_may_be_given() {
    let points: Vec<[f64; 3]> = sphere(4000).into_iter().filter(|p| p[2] < 0.3).collect();
    let h = spacing(4000);
    let edge: Vec<u32> = {
        let mut on: Vec<u32> =
            (0..points.len() as u32).filter(|&i| points[i as usize][2] > 0.3 - 0.7 * h).collect();
        let angle = |i: &u32| points[*i as usize][1].atan2(points[*i as usize][0]);
        on.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
        on.into_iter().step_by(3).collect()
    };
    let made = complete_points(&points[..], None, &with(vec![GivenHole::Loop(edge)])).unwrap();
    assert_eq!((made.found.list.holes.len(), made.found.borders[0]), (1, false));
    assert!(made.completion.vertices.len() > 500);
    let rim = made.found.list.loops[0].vertices.iter().map(|&v| points[v as usize][2]);
    assert!(rim.fold(f64::MAX, f64::min) > 0.3 - 3.0 * h);
}

#[test]
fn what_cannot_be_given_is_refused_by_name() {
    let (points, h) = (sphere(3000), spacing(3000));
    let n = points.len();
    let ring = around(&points, [1.0, 0.0, 0.0], 0.3);
    let of = |list: &[u32]| why(&points, GivenHole::Loop(list.to_vec()));
    assert!(of(&ring[..2]).contains("loop 0 has 2 points"));
    let beyond = [&ring[..5], &[n as u32]].concat();
    assert!(of(&beyond).contains(&format!("names point {n}: the cloud has {n}")));
    let twice = [&ring[..5], &ring[2..3]].concat();
    assert!(of(&twice).contains(&format!("names point {} twice", ring[2])));
    // From one side of the ball to the other.
    let far = [ring[0], around(&points, [-1.0, 0.0, 0.0], 0.3)[0], ring[8]];
    let reason = of(&far);
    let [a, b] = [far[0], far[1]];
    assert!(
        reason.contains(&format!("points {a} and {b} of loop 0 are too far apart")),
        "{reason}"
    );
    let region = |centre: [f64; 3], radius: f64| why(&points, GivenHole::Region { centre, radius });
    assert!(
        region([1.0, 0.0, 0.0], 0.2).contains("region 0 has no rim of a gap within 0.2 of 1, 0, 0")
    );
    assert!(region([9.0, 0.0, 0.0], 0.2).contains("region 0 has no rim"));
    assert!(region([1.0, 0.0, f64::NAN], 0.2).contains("centre of region 0 is not finite"));
    for radius in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(region([1.0, 0.0, 0.0], radius).contains("radius"), "{radius}");
    }
    // A gap that reaches out of the region is not in it.
    let (kept, _) = broken_sphere(3000);
    let small = GivenHole::Region { centre: HOLES[0].0, radius: 0.5 * HOLES[0].1 };
    assert!(why(&kept, small).contains("make it larger"));
    // Points that are not on the surface.
    let mut more = points.clone();
    more.push([1.0 + 8.0 * h, 0.0, 0.0]);
    let with_outlier = GivenHole::Loop([&ring[..], &[n as u32]].concat());
    assert!(
        why(&more, with_outlier).contains(&format!("point {n} of loop 0 is not on the surface"))
    );
    // A mesh has rims of its own.
    let mesh = complete_mesh(
        &points[..],
        &[[0u32, 1, 2]][..],
        &with(vec![GivenHole::Loop(vec![0, 1, 2])]),
    );
    assert!(matches!(mesh, Err(Error::InvalidOption { name: "given_holes", .. })), "{mesh:?}");
}

#[test]
fn a_loop_that_parts_nothing_is_refused() {
    // A torus: around its tube a loop has the same surface on both sides.
    let (rows, round) = (90u32, 40u32);
    let at = |i: u32, j: u32| {
        let a = (f64::from(i) + 0.5 * f64::from(j % 2)) / f64::from(rows);
        let [u, v] = [a, f64::from(j) / f64::from(round)].map(|t| t * std::f64::consts::TAU);
        let r = 1.0 + 0.4 * v.cos();
        [r * u.cos(), r * u.sin(), 0.4 * v.sin()]
    };
    let points: Vec<[f64; 3]> = (0..rows).flat_map(|i| (0..round).map(move |j| at(i, j))).collect();
    let ring = (0..round).map(|j| 7 * round + j).collect();
    assert!(why(&points, GivenHole::Loop(ring)).contains("loop 0 does not part the surface"));
}

#[test]
fn the_same_points_come_on_any_number_of_threads() {
    let points = sphere(3000);
    let given = vec![GivenHole::Loop(around(&points, [0.0, 1.0, 0.0], 0.3))];
    let of = |threads| {
        let made = complete_points(&points[..], None, &Options { threads, ..with(given.clone()) });
        let made = made.unwrap();
        (made.completion.vertices, made.normals, made.found)
    };
    assert_eq!(of(1), of(4));
}
