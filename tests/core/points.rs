//! Point clouds: holes found where they are and nowhere else, filled on the surface that is missing.

use complete_mesh::io::{Document, Extras, Format};
use complete_mesh::mesh::normals::vertex_normals;
use complete_mesh::sample::{break_mesh, Break, BreakOptions, Sample};
use complete_mesh::{
    complete_points, find_point_holes, Appearance, Cleaning, Error, HoleStatus, Method, Monitor,
    Options, PointCompletion, PointHoles, Selection, Sources,
};
use glam::DVec3;
use std::sync::Arc;

/// A number from 0 to 1 that is always the same for the same seed.
pub(super) fn chance(seed: u64) -> f64 {
    let mut x = seed.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((x ^ (x >> 31)) >> 11) as f64 / (1u64 << 53) as f64
}

/// Points evenly over the unit sphere, on a spiral.
pub(super) fn sphere(count: usize) -> Vec<[f64; 3]> {
    let golden = std::f64::consts::PI * (3.0 - 5f64.sqrt());
    (0..count)
        .map(|i| {
            let z = 1.0 - (2 * i + 1) as f64 / count as f64;
            let (r, a) = ((1.0 - z * z).sqrt(), golden * i as f64);
            [r * a.cos(), r * a.sin(), z]
        })
        .collect()
}

/// Where the sphere's three holes are, and their radii.
pub(super) const HOLES: [([f64; 3], f64); 3] =
    [([1.0, 0.0, 0.0], 0.3), ([-0.6, 0.8, 0.0], 0.2), ([0.0, -0.6, -0.8], 0.12)];

fn in_hole(p: &[f64; 3]) -> bool {
    HOLES.iter().any(|(c, r)| DVec3::from(*p).distance(DVec3::from(*c)) < *r)
}

/// The sphere with its holes, and what was taken out.
pub(super) fn broken_sphere(count: usize) -> (Vec<[f64; 3]>, Vec<[f64; 3]>) {
    let (gone, kept) = sphere(count).into_iter().partition(in_hole);
    (kept, gone)
}

/// Each point moved by noise of this standard deviation along each axis.
pub(super) fn noisy(points: &[[f64; 3]], sigma: f64) -> Vec<[f64; 3]> {
    let normal = |seed: u64| (0..12).map(|k| chance(12 * seed + k)).sum::<f64>() - 6.0;
    let moved =
        |(i, p): (usize, &[f64; 3])| [0, 1, 2].map(|k| p[k] + sigma * normal((3 * i + k) as u64));
    points.iter().enumerate().map(moved).collect()
}

pub(super) fn find(points: &[[f64; 3]]) -> PointHoles {
    let options = Options { threads: 1, ..Options::default() };
    find_point_holes(points.into(), None, &options, &Monitor::silent()).unwrap()
}

fn fill(points: &[[f64; 3]], method: Method) -> PointCompletion {
    let options = Options { method, threads: 1, ..Options::default() };
    complete_points(points, None, &options).unwrap()
}

/// Spacing of so many points on the unit sphere, as of a hexagonal lattice.
pub(super) fn spacing(count: usize) -> f64 {
    (4.0 * std::f64::consts::PI / count as f64 / 0.75f64.sqrt()).sqrt()
}

/// Exactly the sphere's three holes are there, each around its centre.
fn assert_three_holes(found: &PointHoles, what: &str) {
    let holes = &found.list.holes;
    assert_eq!(holes.len(), 3, "{what}: {holes:?}");
    assert_eq!(found.borders, [false; 3], "{what}");
    for (centre, radius) in HOLES {
        let at = |h: &&complete_mesh::Hole| {
            DVec3::from(h.centre).distance(DVec3::from(centre)) < 0.5 * radius
                && (0.7..1.4).contains(&(h.diameter / (2.0 * radius)))
        };
        assert_eq!(holes.iter().filter(at).count(), 1, "{what}: hole at {centre:?}: {holes:?}");
    }
}

pub(super) fn nearest(p: [f64; 3], all: &[[f64; 3]]) -> f64 {
    let p = DVec3::from(p);
    all.iter().map(|q| p.distance(DVec3::from(*q))).fold(f64::INFINITY, f64::min)
}

#[test]
fn every_hole_is_found_and_no_other() {
    let h = spacing(6000);
    let (kept, gone) = broken_sphere(6000);
    assert_three_holes(&find(&kept), "clean");
    for part in [0.1, 0.3] {
        assert_three_holes(&find(&noisy(&kept, part * h / 3f64.sqrt())), &format!("noise {part}"));
    }
    let found = find(&kept);
    let missing: f64 = found.missing_in.iter().sum();
    let ratio = missing / gone.len() as f64;
    assert!((0.8..1.3).contains(&ratio), "{ratio} of the points that are missing");
    assert!(found.probability.iter().all(|p| *p > 0.35), "{:?}", found.probability);
    assert_eq!(found.in_loops, [true; 3], "likely points close loops around them");
    assert_eq!(found.in_field, [Some(true); 3], "inner and outer contours meet in them");
    assert!(found.only_in_field.is_empty(), "{:?}", found.only_in_field);
    let rough = find(&noisy(&kept, 0.3 * h / 3f64.sqrt()));
    assert_eq!((&rough.in_field[..], rough.only_in_field.len()), (&[Some(true); 3][..], 0));
    // The whole sphere has none.
    for whole in [sphere(6000), noisy(&sphere(6000), 0.3 * h / 3f64.sqrt())] {
        let found = find(&whole);
        assert_eq!((found.list.holes.len(), found.only_in_field.len()), (0, 0));
    }
}

/// Two balls joined by a neck, as wide as the hole in one of them: contours start in both balls and meet in
/// the neck, which is no hole, both being inside.
#[test]
fn a_neck_between_two_chambers_is_no_hole_of_the_distance_field() {
    let neck = 0.35;
    let ball = |x: f64, side: f64| {
        let all = sphere(6000)
            .into_iter()
            .filter(move |p| DVec3::from(*p).distance(DVec3::X * side) > neck);
        all.map(move |p| [p[0] + x, p[1], p[2]])
    };
    let h = spacing(6000);
    let half = 1.3 - (1.0 - neck * neck / 2.0);
    let rows = (2.0 * half / h).round() as usize;
    let radius = neck * (1.0 - neck * neck / 4.0).sqrt();
    let round = (std::f64::consts::TAU * radius / h).round() as usize;
    let tube = (1..rows).flat_map(|i| {
        let x = -half + 2.0 * half * i as f64 / rows as f64;
        (0..round).map(move |j| {
            let a = (j as f64 + 0.5 * (i % 2) as f64) / round as f64 * std::f64::consts::TAU;
            [x, radius * a.cos(), radius * a.sin()]
        })
    });
    let mut points: Vec<[f64; 3]> = ball(-1.3, 1.0).chain(tube).chain(ball(1.3, -1.0)).collect();
    assert_eq!(find(&points).only_in_field.len(), 0);
    points.retain(|p| DVec3::from(*p).distance(DVec3::new(2.3, 0.0, 0.0)) > neck);
    let found = find(&points);
    assert_eq!((found.list.holes.len(), &found.in_field[..]), (1, &[Some(true)][..]));
    assert_eq!(found.only_in_field.len(), 0);
}

/// Outliers go, noise becomes less, the input does not change and comes first; the fill continues the
/// cleaned copy. At three strengths of noise, the shape known.
#[test]
fn a_cleaned_copy_is_completed() {
    let h = spacing(6000);
    let (kept, _) = broken_sphere(6000);
    let off = |all: &[[f64; 3]]| {
        let square = all.iter().map(|p| (DVec3::from(*p).length() - 1.0).powi(2)).sum::<f64>();
        (square / all.len() as f64).sqrt() / h
    };
    for part in [0.1, 0.2, 0.3] {
        let mut points = noisy(&kept, part * h / 3f64.sqrt());
        let count = points.len();
        for i in 0..count / 200 {
            let aside = 2.0 + 8.0 * chance(i as u64 + 5);
            let from = DVec3::from(kept[200 * i]);
            points.push((from * (1.0 + aside * h)).to_array());
        }
        let clean = Some(Cleaning::default());
        let options = Options { method: Method::Smooth, threads: 1, clean, ..Options::default() };
        let before = points.clone();
        let made = complete_points(&points[..], None, &options).unwrap();
        assert_eq!((points, made.completion.input_vertex_count), (before.clone(), before.len()));
        let cleaned = made.cleaned.unwrap();
        assert_eq!((cleaned.positions.len(), cleaned.removed.len()), (before.len(), before.len()));
        assert!(cleaned.removed[count..].iter().all(|r| *r), "noise {part}: all outliers go");
        let flags = |list: &[u32]| list.iter().all(|&i| cleaned.removed[i as usize]);
        assert!(flags(&made.found.outliers) && flags(&made.found.doubles));
        let gone = made.found.outliers.iter().filter(|&&i| (i as usize) < count).count();
        assert!(gone * 1000 <= count, "noise {part}: {gone} of {count} good points are gone");
        let left: Vec<[f64; 3]> =
            (0..count).filter(|&i| !cleaned.removed[i]).map(|i| cleaned.positions[i]).collect();
        let raw: Vec<[f64; 3]> =
            (0..count).filter(|&i| !cleaned.removed[i]).map(|i| before[i]).collect();
        assert!(off(&left) < 0.5 * off(&raw), "noise {part}: {} of {}", off(&left), off(&raw));
        // What the noise does to the fill, with and without.
        let plain = complete_points(&before[..], None, &Options { clean: None, ..options.clone() });
        let plain = plain.unwrap();
        assert_eq!(plain.cleaned, None);
        let [with, without] = [&made.completion, &plain.completion].map(|c| off(&c.vertices));
        assert!(with < 0.7 * without, "noise {part}: {with} of {without}");
    }
    // Nothing is moved in no rounds; more than the limit, and a mesh, are refused.
    let still = Options { clean: Some(Cleaning { rounds: 0 }), ..Options::default() };
    let made = complete_points(&kept[..], None, &still).unwrap();
    assert_eq!(made.cleaned.unwrap().positions, kept);
    let wild = Options { clean: Some(Cleaning { rounds: 101 }), ..Options::default() };
    let refused = |e: Error| matches!(e, Error::InvalidOption { name: "clean", .. });
    assert!(refused(complete_points(&kept[..], None, &wild).unwrap_err()));
    let faces: &[[u32; 3]] = &[[0, 1, 2]];
    let made = complete_mesh::complete_mesh(&kept[..], faces, &still);
    assert!(refused(made.unwrap_err()));
}

/// A vessel's wall, 1.4 edges thick at its thinnest: cleaned, its sides stay apart, and normals on the right side.
#[test]
fn cleaning_keeps_the_two_sides_of_a_thin_wall() {
    let whole = Sample::Vessel.build(120).unwrap();
    let vertices: Vec<[f64; 3]> = whole.vertices.iter().map(|v| v.map(f64::from)).collect();
    let places: Vec<DVec3> = vertices.iter().map(|&v| v.into()).collect();
    let normals = vertex_normals(&places, whole.faces.iter().copied());
    let length = |f: &[u32; 3]| places[f[0] as usize].distance(places[f[1] as usize]);
    let edge = whole.faces.iter().map(length).sum::<f64>() / whole.faces.len() as f64;
    let points = noisy(&vertices, 0.15 * edge);
    let clean = Some(Cleaning::default());
    let options = Options { method: Method::Smooth, threads: 1, clean, ..Options::default() };
    let made = complete_points(&points[..], None, &options).unwrap();
    let cleaned: Vec<DVec3> =
        made.cleaned.unwrap().positions.into_iter().map(DVec3::from).collect();
    let off = |all: &dyn Fn(usize) -> DVec3| {
        let square =
            (0..places.len()).map(|i| (all(i) - places[i]).dot(normals[i]).powi(2)).sum::<f64>();
        (square / places.len() as f64).sqrt() / edge
    };
    let [before, after] = [off(&|i| points[i].into()), off(&|i| cleaned[i])];
    let of_cloud = vertex_normals(&cleaned, made.copied.faces.iter().copied());
    let seen: Vec<usize> = (0..places.len()).filter(|&i| of_cloud[i] != DVec3::ZERO).collect();
    let right = seen.iter().filter(|&&i| of_cloud[i].dot(normals[i]) > 0.0).count();
    println!("{before:.3} {after:.3}, {right} of {} of {}", seen.len(), places.len());
    assert!(seen.len() * 100 > 95 * places.len(), "{}", seen.len());
    // With the sides mixed it was 0.55 of them.
    assert!(right * 1000 > 998 * seen.len(), "{right} of {}", seen.len());
    assert!(after < 0.8 * before, "{after} {before}");
}

/// From pole to pole the spacing grows by a factor of ten: nothing there is a hole but the one that is.
#[test]
fn wildly_uneven_density_makes_no_hole_and_hides_none() {
    // Rings from pole to pole, each as far from the last as its points are apart.
    let mut points: Vec<[f64; 3]> = Vec::new();
    let (mut angle, mut row) = (0.005, 0);
    while angle < std::f64::consts::PI - 0.02 {
        let step = 0.01 * 10f64.powf(angle / std::f64::consts::PI);
        let (s, c) = f64::sin_cos(angle);
        let count = (std::f64::consts::TAU * s / step).ceil().max(3.0) as usize;
        points.extend((0..count).map(|j| {
            let a = (j as f64 + 0.5 * f64::from(row % 2)) / count as f64 * std::f64::consts::TAU;
            [s * a.cos(), s * a.sin(), c]
        }));
        angle += 0.87 * step;
        row += 1;
    }
    let whole = find(&points);
    assert_eq!(whole.list.holes.len(), 0, "{:?}", whole.list.holes);
    for (centre, radius) in [([0.6, 0.0, 0.8], 0.1), ([0.0, 0.6, -0.8], 0.4)] {
        let centre = DVec3::from(centre);
        let with = points.iter().filter(|p| DVec3::from(**p).distance(centre) > radius);
        let found = find(&with.copied().collect::<Vec<_>>());
        assert_eq!(found.list.holes.len(), 1, "{:?}", found.list.holes);
        assert!(DVec3::from(found.list.holes[0].centre).distance(centre) < 0.3 * radius);
        assert_eq!(found.in_field, [Some(true)]);
    }
}

#[test]
fn outliers_are_named_and_make_no_hole() {
    let (mut points, _) = broken_sphere(6000);
    let first = points.len();
    for i in 0..30 {
        let r = 1.2 + 0.6 * chance(i);
        let p = sphere(30)[i as usize];
        points.push(p.map(|x| x * r));
    }
    let found = find(&points);
    assert_three_holes(&found, "outliers");
    assert_eq!(found.outliers, (first as u32..points.len() as u32).collect::<Vec<_>>());
    let made = fill(&points, Method::Smooth);
    for p in &made.completion.vertices {
        assert!((DVec3::from(*p).length() - 1.0).abs() < 0.02, "{p:?}");
    }
}

#[test]
fn new_points_lie_on_the_surface_as_densely_as_the_others() {
    let h = spacing(6000);
    let (kept, gone) = broken_sphere(6000);
    for method in [Method::Smooth, Method::Coherent] {
        let made = fill(&kept, method);
        let new = &made.completion.vertices;
        let ratio = new.len() as f64 / gone.len() as f64;
        assert!((0.8..1.25).contains(&ratio), "{ratio} of what was taken out");
        for (p, n) in new.iter().zip(&made.normals) {
            let p = DVec3::from(*p);
            assert!((p.length() - 1.0).abs() < 0.05 * h, "{p}");
            assert!(DVec3::from(*n).dot(p.normalize()) > 0.97, "normal {n:?} at {p}");
        }
        let all: Vec<[f64; 3]> = kept.iter().chain(new).copied().collect();
        for p in &gone {
            assert!(nearest(*p, &all) < 1.0 * h, "nothing near {p:?}");
        }
        // No two points at one place, and none on an old one.
        for (i, p) in new.iter().enumerate() {
            assert!(nearest(*p, &all[..kept.len() + i]) > 0.3 * h, "{p:?}");
        }
        let holes: Vec<u32> = made.completion.vertex_hole.clone();
        assert!(holes.iter().all(|&hole| hole < 3) && holes.contains(&2));
    }
}

/// A fluted column as points: continued, its flutes come nearer to the truth than a smooth surface.
#[test]
fn ornament_is_continued_and_its_sources_are_named() {
    let whole = Sample::Column.build(160).unwrap();
    let options = BreakOptions { kind: Break::Disc, seed: 1, size: 0.8 };
    let broken = break_mesh(Sample::Column, &whole, &options).unwrap().mesh;
    let points: Vec<[f32; 3]> = broken.vertices.clone();
    let truth: Vec<[f64; 3]> = whole.vertices.iter().map(|p| p.map(f64::from)).collect();
    let known: Vec<[f64; 3]> = points.iter().map(|p| p.map(f64::from)).collect();
    let gone: Vec<[f64; 3]> =
        truth.iter().copied().filter(|p| nearest(*p, &known) > 1e-6).collect();
    assert!(gone.len() > 50);
    let mean = |method| {
        let options = Options { method, threads: 1, ..Options::default() };
        let made = complete_points(&points[..], None, &options).unwrap();
        assert_eq!(made.completion.holes.len(), 1);
        for p in made.completion.vertices.iter().flatten() {
            assert_eq!(f64::from(*p as f32), *p, "not an f32 as the input");
        }
        let mut off = 0.0;
        for p in &made.completion.vertices {
            // From the plane of the three nearest true points.
            let mut near = truth.clone();
            let d = |q: &[f64; 3]| DVec3::from(*q).distance_squared(DVec3::from(*p));
            near.select_nth_unstable_by(2, |a, b| d(a).total_cmp(&d(b)));
            let [a, b, c] = [0, 1, 2].map(|i| DVec3::from(near[i]));
            off += (b - a).cross(c - a).normalize_or_zero().dot(DVec3::from(*p) - a).abs();
        }
        (off / made.completion.vertices.len() as f64, made)
    };
    let (smooth, plain) = mean(Method::Smooth);
    let (coherent, made) = mean(Method::Coherent);
    assert!(coherent < 0.5 * smooth, "coherent {coherent}, smooth {smooth}");
    assert!(plain.source_points.iter().all(|&s| s == u32::MAX));
    let hole = &made.completion.holes[0];
    assert_eq!(hole.method, Method::Coherent);
    let named: Vec<usize> =
        (0..made.source_points.len()).filter(|&i| made.source_points[i] != u32::MAX).collect();
    assert!(named.len() * 10 > 8 * made.source_points.len());
    let mut near = 0;
    for &i in &named {
        // The source's transform takes the named point near the new one.
        let source = &hole.sources[made.completion.origins[i].source as usize];
        let from = DVec3::from(known[made.source_points[i] as usize]);
        let to = source.transform.point(from);
        near += usize::from(to.distance(DVec3::from(made.completion.vertices[i])) < 0.1);
        assert!((0.0..=1.0).contains(&made.completion.origins[i].confidence));
    }
    assert!(near * 10 > 9 * named.len(), "{near} of {}", named.len());
}

/// Colours that follow the flutes are copied with them, into the library's values and into files; from
/// the rim they would come out as one.
#[test]
fn colours_are_copied_with_the_shape() {
    let whole = Sample::Column.build(160).unwrap();
    let options = BreakOptions { kind: Break::Disc, seed: 1, size: 0.8 };
    let points = break_mesh(Sample::Column, &whole, &options).unwrap().mesh.vertices;
    // 20 flutes.
    let stripes = |p: [f64; 3]| 128.0 + 100.0 * (20.0 * p[2].atan2(p[0])).cos();
    let known = points.iter().map(|p| stripes(p.map(f64::from))).collect::<Vec<_>>();
    let appearance =
        Appearance { channels: 1, steering: 1, values: known.clone(), ..Appearance::default() };
    let off = |made: &PointCompletion, values: &[f64]| {
        assert_eq!(values.len(), made.completion.vertices.len());
        let each = made.completion.vertices.iter().zip(values);
        each.map(|(p, x)| (x - stripes(*p)).abs()).sum::<f64>() / values.len() as f64
    };
    let of = |method| {
        let appearance = Some(Arc::new(appearance.clone()));
        let options = Options { method, threads: 1, appearance, ..Options::default() };
        complete_points(&points[..], None, &options).unwrap()
    };
    let (made, plain) = (of(Method::Coherent), of(Method::Smooth));
    let (copied, blurred) = (off(&made, &made.values), off(&plain, &plain.values));
    println!("off by {copied:.1}, from the rim {blurred:.1}");
    assert!(copied < 0.4 * blurred, "{copied}, from the rim {blurred}");
    let rows = points.iter().zip(&known).map(|(p, x)| format!("{} {} {} {x}\n", p[0], p[1], p[2]));
    let mut file = Document::parse(rows.collect::<String>().into_bytes(), Format::Xyz).unwrap();
    file.append_points(&made, &Extras::default()).unwrap();
    let text = String::from_utf8(file.to_bytes()).unwrap();
    let last = |line: &str| line.rsplit(' ').next().unwrap().parse::<f64>().unwrap();
    let written: Vec<f64> = text.lines().skip(points.len()).map(last).collect();
    let in_file = off(&made, &written);
    assert!((in_file - copied).abs() < 0.1 * blurred, "{in_file} in the file, {copied}");
    let short = Appearance { values: vec![0.0; 7], ..appearance.clone() };
    let options = Options { appearance: Some(Arc::new(short)), ..Options::default() };
    let refused = complete_points(&points[..], None, &options);
    assert!(matches!(refused, Err(Error::InvalidOption { name: "appearance", .. })), "{refused:?}");
}

/// A wavy relief seen from one side: its own border stays open, its hole is filled.
#[test]
fn the_border_of_an_open_surface_stays_open_unless_it_is_named() {
    let wave = |x: f64, y: f64| [x, y, 0.05 * (7.0 * x).sin() * (5.0 * y).cos()];
    let points: Vec<[f64; 3]> = (0..60)
        .flat_map(|j| (0..60).map(move |i| (i, j)))
        .map(|(i, j)| wave(f64::from(i) / 60.0, f64::from(j) / 60.0))
        .filter(|p| (p[0] - 0.5).hypot(p[1] - 0.5) > 0.12)
        .collect();
    let made = fill(&points, Method::Smooth);
    let found = &made.found;
    assert_eq!(found.list.holes.len(), 2);
    let border = found.borders.iter().position(|b| *b).expect("a border");
    assert_eq!(found.borders.iter().filter(|b| **b).count(), 1);
    assert_eq!(found.list.holes[border].edges, 4 * 59);
    let status = |i: usize| made.completion.holes[i].status.clone();
    assert_eq!((status(border), status(1 - border)), (HoleStatus::NotSelected, HoleStatus::Filled));
    for p in &made.completion.vertices {
        let surface = wave(p[0], p[1])[2];
        assert!((p[0] - 0.5).hypot(p[1] - 0.5) < 0.13 && (p[2] - surface).abs() < 0.02, "{p:?}");
    }
    let ids = Selection::Ids(vec![7]);
    let options = Options { selection: ids, ..Options::default() };
    assert_eq!(
        complete_points(&points[..], None, &options),
        Err(Error::NoSuchHole { hole: 7, count: 2 })
    );
}

#[test]
fn normals_that_are_given_say_which_side_is_out() {
    let (kept, _) = broken_sphere(3000);
    let inward: Vec<[f64; 3]> = kept.iter().map(|p| p.map(|x| -2.0 * x)).collect();
    let options = Options { method: Method::Smooth, threads: 1, ..Options::default() };
    let made = complete_points(&kept[..], Some((&inward[..]).into()), &options).unwrap();
    assert!(!made.normals.is_empty());
    for (p, n) in made.completion.vertices.iter().zip(&made.normals) {
        assert!(DVec3::from(*n).dot(DVec3::from(*p)) < -0.9, "{n:?} at {p:?}");
    }
    let wrong = complete_points(&kept[..], Some((&inward[1..]).into()), &options);
    assert!(matches!(wrong, Err(Error::InvalidOption { name: "normals", .. })), "{wrong:?}");
}

#[test]
fn the_same_points_come_on_any_number_of_threads() {
    let (kept, _) = broken_sphere(3000);
    let of = |threads| {
        let options = Options { threads, ..Options::default() };
        let mut made = complete_points(&kept[..], None, &options).unwrap();
        (made.completion.seconds, made.completion.cpu_seconds) = (0.0, 0.0);
        made.completion.holes.iter_mut().for_each(|h| h.seconds = 0.0);
        made
    };
    let one = of(1);
    assert_eq!(one, of(2));
    assert_eq!(one, of(5));
}

#[test]
fn points_without_coordinates_and_doubles_are_passed_over() {
    let (kept, _) = broken_sphere(3000);
    let plain = fill(&kept, Method::Smooth);
    // A hole in the scanner's grid before each hundredth point, and each tenth point once more.
    let (mut points, mut missing, mut doubles) = (Vec::new(), Vec::new(), Vec::new());
    for (i, p) in kept.iter().enumerate() {
        if i % 100 == 0 {
            missing.push(points.len() as u32);
            points.push([f64::NAN; 3]);
        }
        points.push(*p);
        if i % 10 == 0 {
            doubles.push(points.len() as u32);
            points.push(*p);
        }
    }
    let made = fill(&points, Method::Smooth);
    assert_eq!((&made.found.missing, &made.found.doubles), (&missing, &doubles));
    assert_eq!(made.completion.input_vertex_count, points.len());
    assert_eq!(made.completion.vertices.len(), plain.completion.vertices.len());
    for (p, q) in made.completion.vertices.iter().zip(&plain.completion.vertices) {
        // Not the same bits: the points' numbers break ties.
        assert!(nearest(*p, &plain.completion.vertices) < 0.5 * spacing(3000), "{p:?} {q:?}");
    }
}

#[test]
fn what_is_no_surface_is_an_error_that_says_why() {
    let refused = |points: &[[f64; 3]]| complete_points(points, None, &Options::default());
    let line: Vec<[f64; 3]> = (0..50).map(|i| [f64::from(i), 2.0 * f64::from(i), 1.0]).collect();
    assert_eq!(refused(&[]), Err(Error::TooFewPoints { count: 0 }));
    assert_eq!(refused(&line[..2]), Err(Error::TooFewPoints { count: 2 }));
    assert_eq!(refused(&[[1.0, 2.0, 3.0]; 40]), Err(Error::TooFewPoints { count: 1 }));
    assert_eq!(refused(&line), Err(Error::PointsOnALine { count: 50 }));
    for bad in [[f64::NAN, 0.0, 0.0], [f64::INFINITY, 0.0, 0.0], [f64::NEG_INFINITY; 3]] {
        let mut points = sphere(500);
        points[77] = bad;
        assert_eq!(refused(&points), Err(Error::NonFinitePoint { point: 77 }), "{bad:?}");
    }
    let faces = Sources { faces: Some(Arc::from(vec![true])), ..Sources::default() };
    let options = Options { sources: faces, ..Options::default() };
    let refused = complete_points(&sphere(500)[..], None, &options);
    assert!(matches!(refused, Err(Error::InvalidOption { name: "sources", .. })), "{refused:?}");
}

/// All in a plane, on a grid where four points always lie on one circle: the hole is filled in it.
#[test]
fn a_plane_is_filled_in_the_plane() {
    let points: Vec<[f64; 3]> = (0..40)
        .flat_map(|j| (0..40).map(move |i| [f64::from(i), f64::from(j), 5.0]))
        .filter(|p| (p[0] - 20.0).hypot(p[1] - 19.0) > 5.0)
        .collect();
    let made = fill(&points, Method::Coherent);
    assert_eq!(made.found.list.holes.len(), 2);
    let gone = 40 * 40 - points.len();
    let ratio = made.completion.vertices.len() as f64 / gone as f64;
    assert!((0.8..1.3).contains(&ratio), "{ratio}");
    for p in &made.completion.vertices {
        assert!((p[2] - 5.0).abs() < 1e-6 && (p[0] - 20.0).hypot(p[1] - 19.0) < 5.5, "{p:?}");
    }
}

/// Four times as close on one half of the sphere as on the other.
#[test]
fn uneven_density_makes_no_hole_and_hides_none() {
    let points: Vec<[f64; 3]> = sphere(16000)
        .into_iter()
        .filter(|p| p[2] > 0.0 && p[0] < 2.0)
        .chain(sphere(4000).into_iter().filter(|p| p[2] <= 0.0))
        .filter(|p| !in_hole(p))
        .collect();
    assert_three_holes(&find(&points), "uneven");
}
