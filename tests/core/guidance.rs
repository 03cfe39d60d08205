//! Fills guided by hand: a transform, a candidate, a range of scales.

use crate::checker::{check, complete_checked, filled_rims};
use crate::meshes::{broken_vessel, off, sheet, Mesh};
use complete_mesh::intersect::Bvh;
use complete_mesh::matching::rigid::Rigid;
use complete_mesh::sample::{Break, Sample};
use complete_mesh::{
    complete_mesh, Appearance, Completer, Completion, Error, Exemplar, Grouping, Guidance, Method,
    Monitor, Options, Placement, Selection, Sources,
};
use glam::{DMat3, DVec3};
use std::sync::Arc;

/// A turn, mirrored or not, with a scale and a shift.
fn similarity(scale: f64, mirrored: bool) -> Rigid {
    let turn = DMat3::from_axis_angle(DVec3::new(0.2, 0.9, -0.5).normalize(), 2.1);
    let flip = DMat3::from_diagonal(DVec3::new(if mirrored { -1.0 } else { 1.0 }, 1.0, 1.0));
    Rigid { linear: scale * turn * flip, translation: DVec3::new(3.0, -7.0, 0.5) }
}

fn moved(mesh: &Mesh, to: &Rigid) -> Exemplar {
    let face = |f: &[u32; 3]| if to.is_mirrored() { [f[0], f[2], f[1]] } else { *f };
    Exemplar {
        vertices: mesh.vertices.iter().map(|&p| to.point(p.into()).to_array()).collect(),
        faces: mesh.faces.iter().map(face).collect(),
        ..Exemplar::default()
    }
}

fn twin_of(mesh: &Mesh, to: &Rigid) -> Sources {
    let exemplar = Some(Arc::new(moved(mesh, to)));
    Sources { exemplar, exemplar_only: true, ..Sources::default() }
}

fn placed(transform: Rigid, refined: bool) -> Guidance {
    Guidance { placement: Some(Placement { transform, refined }), ..Guidance::default() }
}

/// The way back given by hand is taken as it is and gives back what is missing, whatever the size; given
/// roughly it does not, and does once it is refined. The placed exemplar need not be told to be the only
/// source.
#[test]
fn a_transform_given_by_hand_is_the_only_copy() {
    let (broken, whole) = broken_vessel(Break::Disc);
    for (scale, mirrored) in [(1.0, false), (0.3, true)] {
        let to = similarity(scale, mirrored);
        let sources = Sources { exemplar_only: false, ..twin_of(&whole, &to) };
        let fill = |guidance| {
            let sources = sources.clone();
            complete_checked(&broken, &Options { sources, guidance, ..Options::default() })
        };
        let truth = to.inverse();
        let exact = fill(placed(truth, false));
        let hole = &exact.holes[0];
        let radius = 0.5 * whole.mean_edge() * (exact.vertices.len() as f64).sqrt();
        let nudge = Rigid {
            linear: DMat3::from_axis_angle(DVec3::Y, 0.06),
            translation: 0.1 * radius * DVec3::new(0.6, 0.0, 0.8),
        };
        // About the middle of the hole.
        let middle = exact.vertices.iter().map(|&p| DVec3::from(p)).sum::<DVec3>()
            / exact.vertices.len() as f64;
        let by = |t: DVec3| Rigid { translation: t, ..Rigid::IDENTITY };
        let rough = by(middle).after(&nudge).after(&by(-middle)).after(&truth);
        let (kept, refined) = (fill(placed(rough, false)), fill(placed(rough, true)));
        let [a, b, c] = [&exact, &kept, &refined].map(|made| off(made, &whole));
        println!("scale {scale}: exact {a:.1e}, rough {b:.3}, refined {c:.1e} edges");
        println!("confidences {} {}", hole.confidence, kept.holes[0].confidence);
        assert!(a < 1e-6 && b > 0.05 && c < 1e-6);
        assert_eq!((hole.sources.len(), hole.sources[0].transform), (1, truth));
        assert_eq!(kept.holes[0].sources[0].transform, rough);
        assert!(hole.confidence > 0.99 && refined.holes[0].confidence > 0.99);
        assert!(kept.holes[0].confidence < 0.95);
        let first = broken.faces.len() as u32;
        assert!(exact.origins.iter().all(|o| o.face >= first));
    }
}

/// A place that has nothing to do with the hole: whatever is done with it, nobody is told to believe it,
/// and the contract holds.
#[test]
fn a_wrong_transform_gets_a_low_confidence() {
    let (broken, whole) = broken_vessel(Break::Disc);
    let truth = complete_checked(&broken, &Options::default()).holes[0].sources[0].transform;
    let right = complete_checked(
        &broken,
        &Options { guidance: placed(truth, false), ..Options::default() },
    );
    let smooth =
        complete_checked(&broken, &Options { method: Method::Smooth, ..Options::default() });
    assert!(right.holes[0].confidence > 0.8, "{}", right.holes[0].confidence);
    for k in 0..6 {
        let turn = DMat3::from_axis_angle(DVec3::new(1.0, 0.3 * k as f64, -0.5).normalize(), 1.0);
        let shift = whole.mean_edge() * 3.0 * DVec3::new(k as f64, 1.0, -2.0);
        let wrong = Rigid { linear: turn, translation: shift }.after(&truth);
        for refined in [false, true] {
            let guidance = placed(wrong, refined);
            let made = complete_checked(&broken, &Options { guidance, ..Options::default() });
            let hole = &made.holes[0];
            let (own, plain) = (off(&made, &whole), off(&smooth, &whole));
            println!("{k} {refined}: {}, {own:.2} edges off, smooth {plain:.2}", hole.summary());
            assert!(hole.confidence < 0.6, "{}", hole.summary());
            assert!(own < 2.0 * plain, "{own} {plain}");
        }
    }
}

/// The candidates lie at different places, the best first; each is what it is when it is asked for alone,
/// and has one source. One too many is a smooth fill that says how many there are.
#[test]
fn candidates_are_different_places() {
    let (broken, whole) = broken_vessel(Break::Disc);
    let monitor = Monitor::silent();
    let completer = Completer::new(broken.view(), &Grouping::Automatic, &monitor).unwrap();
    let all = completer.candidates(4, &Options::default(), &monitor).unwrap();
    assert_eq!(all.len(), 4);
    for (i, made) in all.iter().enumerate() {
        let list =
            complete_mesh::find_holes(broken.view(), &Grouping::Automatic, &monitor).unwrap();
        check(&broken.vertices, &broken.faces, made, &filled_rims(made, &list)).unwrap();
        let hole = &made.holes[0];
        println!(
            "{i}: {}, {:.4}, {:.3} edges off",
            hole.summary(),
            hole.sources[0].error,
            off(made, &whole)
        );
        assert_eq!(hole.sources.len(), 1);
        assert!((hole.sources[0].weight - 1.0).abs() < 1e-9);
        assert!(hole.candidates >= 4);
        let guidance = Guidance { candidate: i + 1, ..Guidance::default() };
        let options = Options { guidance, ..Options::default() };
        let alone = complete_mesh(&broken.vertices[..], &broken.faces[..], &options).unwrap();
        assert_eq!(alone.vertices, made.vertices);
        assert_eq!(alone.holes[0].sources, hole.sources);
    }
    let place = |made: &Completion| {
        let back = made.holes[0].sources[0].transform.inverse();
        let all = all[0].vertices.iter();
        all.map(|&p| back.point(p.into())).collect::<Vec<_>>()
    };
    for (i, a) in all.iter().enumerate() {
        for b in &all[..i] {
            let (a, b) = (place(a), place(b));
            let square: f64 = a.iter().zip(&b).map(|(p, q)| p.distance_squared(*q)).sum();
            let apart = (square / a.len() as f64).sqrt();
            // A fifth of the hole's radius, of which its vertices say: half an edge each way.
            assert!(apart > 0.05 * whole.mean_edge() * (a.len() as f64).sqrt(), "{apart}");
        }
    }
    let many = Guidance { candidate: 1 + all[0].holes[0].candidates, ..Guidance::default() };
    let options = Options { guidance: many, ..Options::default() };
    let hole = completer.complete(&options, &monitor).unwrap().holes[0].clone();
    assert_eq!((hole.method, hole.candidates), (Method::Smooth, all[0].holes[0].candidates));
}

/// A candidate's transform, given back by hand, makes the same fill.
#[test]
fn a_reported_transform_can_be_given_back() {
    let (broken, _) = broken_vessel(Break::Disc);
    let fill = |guidance| complete_checked(&broken, &Options { guidance, ..Options::default() });
    let made = fill(Guidance { candidate: 2, ..Guidance::default() });
    let again = fill(placed(made.holes[0].sources[0].transform, false));
    assert_eq!(made.vertices, again.vertices);
    assert_eq!(made.origins, again.origins);
}

/// A twin that is turned, mirrored and of another size: positions come back to rounding, and colours to
/// what interpolation leaves.
#[test]
fn a_twin_of_another_size_gives_back_what_is_missing() {
    let (broken, whole) = broken_vessel(Break::Disc);
    let single = |mesh: &Mesh| -> Vec<[f32; 3]> {
        mesh.vertices.iter().map(|p| p.map(|x| x as f32)).collect()
    };
    let colours = |mesh: &Mesh| -> Vec<f64> {
        let all = Sample::Vessel.paint(&single(mesh)).unwrap();
        all.iter().flat_map(|c| [c[0], c[1], c[2]]).map(f64::from).collect()
    };
    let (values, exemplar_values) = (colours(&broken), colours(&whole));
    let corners: Vec<DVec3> = whole.vertices.iter().map(|&p| DVec3::from(p)).collect();
    let tree = Bvh::new(&corners, &whole.faces);
    for (scale, mirrored) in [(0.37, true), (4.2, false)] {
        let sources = twin_of(&whole, &similarity(scale, mirrored));
        let guidance = Guidance { scales: Some([0.1, 10.0]), ..Guidance::default() };
        let appearance = Arc::new(Appearance {
            channels: 3,
            steering: 3,
            values: values.clone(),
            exemplar_values: exemplar_values.clone(),
        });
        let options = Options {
            sources,
            guidance,
            appearance: Some(appearance.clone()),
            ..Options::default()
        };
        let made = complete_checked(&broken, &options);
        let exemplar = options.sources.exemplar.as_deref();
        let rows = appearance.complete(broken.view().faces, exemplar, &made);
        let wrong = |(p, row): (&[f64; 3], &[f64])| {
            let hit = tree.closest_point(DVec3::from(*p), f64::INFINITY).unwrap();
            let face = whole.faces[hit.face as usize];
            let [a, b, c] = face.map(|v| corners[v as usize]);
            let area = (b - a).cross(c - a);
            let part = |p: DVec3, q: DVec3| (p - hit.point).cross(q - hit.point).dot(area);
            let weights = [part(b, c), part(c, a), part(a, b)].map(|x| x / area.length_squared());
            let truth = |k: usize| {
                (0..3).map(|i| weights[i] * exemplar_values[3 * face[i] as usize + k]).sum::<f64>()
            };
            (0..3).map(|k| (truth(k) - row[k]).abs()).fold(0.0, f64::max)
        };
        let worst = made.vertices.iter().zip(rows.chunks_exact(3)).map(wrong).fold(0.0, f64::max);
        let (edges, hole) = (off(&made, &whole), &made.holes[0]);
        println!(
            "scale {scale}: {edges:.1e} edges, colours {worst:.1e} of 255, {}",
            hole.summary()
        );
        assert!(edges < 1e-5 && worst < 0.5, "{edges} {worst}");
        let found = hole.sources[0].transform.linear.determinant().abs().cbrt();
        assert!((found * scale - 1.0).abs() < 1e-6, "{found}");
        assert!(hole.confidence > 0.99);
        let rigid = Options { guidance: Guidance::default(), ..options };
        let without = complete_checked(&broken, &rigid);
        assert!(off(&without, &whole) > 0.1, "no other size without being asked");
    }
}

/// A wall with one ornament in three sizes: the largest is broken, and only a smaller one has what is
/// missing.
#[test]
fn the_mesh_itself_may_be_scaled() {
    let bump = |x: f64, y: f64| {
        let rest = (1.0 - x * x - y * y).max(0.0).powi(3);
        rest * (0.5 * (5.0 * x + 1.0).sin() + 0.4 * (4.0 * y - 3.0 * x).cos())
    };
    let sizes = [(30.0, 30.0, 24.0), (82.0, 30.0, 18.0)];
    let height = |x: f64, y: f64| {
        sizes.iter().map(|&(a, b, r)| r * 0.25 * bump((x - a) / r, (y - b) / r)).sum::<f64>()
    };
    let hole = |i: usize, j: usize| (i as f64 + 0.5 - 30.0).hypot(j as f64 + 0.5 - 30.0) > 10.0;
    let broken = sheet((110, 60), |x, y| [x, y, height(x, y)], hole);
    let truth = |made: &Completion| {
        let off = |p: &[f64; 3]| (p[2] - height(p[0], p[1])).powi(2);
        (made.vertices.iter().map(off).sum::<f64>() / made.vertices.len() as f64).sqrt()
    };
    let selection = Selection::NearPoint([30.0, 30.0, 0.0]);
    let fill = |scales| {
        let guidance = Guidance { scales, ..Guidance::default() };
        let selection = selection.clone();
        complete_checked(&broken, &Options { guidance, selection, ..Options::default() })
    };
    let (plain, scaled) = (fill(None), fill(Some([0.7, 1.6])));
    let (a, b) = (truth(&plain), truth(&scaled));
    println!("{a:.3} edges without, {b:.3} with scales");
    let holes = |made: &Completion| made.holes.iter().map(|h| h.summary()).collect::<Vec<_>>();
    println!("{:?} {:?}", holes(&plain), holes(&scaled));
    assert!(b < 0.2 && b < 0.3 * a, "{a} {b}");
    let best = scaled.holes.iter().find(|h| !h.sources.is_empty()).unwrap().sources[0];
    let scale = best.transform.linear.determinant().abs().cbrt();
    assert!((scale - 24.0 / 18.0).abs() < 0.03, "{scale}");
}

#[test]
fn bad_guidance_is_named() {
    let (broken, _) = broken_vessel(Break::Disc);
    let refused = |guidance: Guidance, method, option: &str| {
        let options = Options { guidance, method, ..Options::default() };
        match complete_mesh(&broken.vertices[..], &broken.faces[..], &options) {
            Err(Error::InvalidOption { name, .. }) => assert_eq!(name, option),
            other => panic!("{option}: {other:?}"),
        }
    };
    let sheared =
        Rigid { linear: DMat3::from_diagonal(DVec3::new(1.0, 2.0, 1.0)), ..Rigid::IDENTITY };
    refused(placed(sheared, false), Method::Coherent, "placement");
    refused(placed(Rigid::IDENTITY, false), Method::Smooth, "placement");
    refused(Guidance { candidate: 1, ..Guidance::default() }, Method::Harary, "candidate");
}

/// Two exemplars that lie on each other, a ball and a twin: the twin is found, and what is reported leads
/// from where it was given to the new vertices.
#[test]
fn exemplars_may_lie_on_each_other() {
    let (broken, whole) = broken_vessel(Break::Disc);
    let ball = Sample::Sphere.build(40).unwrap();
    let first = Exemplar {
        vertices: ball.vertices.iter().map(|p| p.map(f64::from)).collect(),
        faces: ball.faces,
        ..Exemplar::default()
    };
    let turn = Rigid { translation: DVec3::ZERO, ..similarity(1.0, true) };
    let second = moved(&whole, &turn);
    let exemplar = Exemplar::joined(&[first.clone(), second]);
    assert_eq!(exemplar.parts, [first.vertices.len(), whole.vertices.len()]);
    let sources = Sources {
        exemplar: Some(Arc::new(exemplar.clone())),
        exemplar_only: true,
        ..Sources::default()
    };
    let made = complete_checked(&broken, &Options { sources, ..Options::default() });
    let edges = off(&made, &whole);
    println!("{edges:.1e} edges, {}", made.holes[0].summary());
    assert!(edges < 0.02, "{edges}");
    let base = broken.faces.len();
    for (origin, p) in made.origins.iter().zip(&made.vertices) {
        let face = origin.face as usize - base;
        assert!(face >= first.faces.len(), "of the ball");
        let corners = exemplar.faces[face].map(|v| DVec3::from(exemplar.vertices[v as usize]));
        let there: DVec3 = corners.iter().zip(origin.barycentric).map(|(&c, w)| w * c).sum();
        let transform = made.holes[0].sources[origin.source as usize].transform;
        assert!(transform.point(there).distance((*p).into()) < 0.5 * whole.mean_edge());
    }
}

#[test]
fn parts_that_cannot_be_are_named() {
    let (broken, whole) = broken_vessel(Break::Disc);
    let twin = moved(&whole, &Rigid::IDENTITY);
    let both = Exemplar::joined(&[twin.clone(), twin]);
    let refused = |change: &dyn Fn(&mut Exemplar), word: &str| {
        let mut bad = both.clone();
        change(&mut bad);
        let sources = Sources { exemplar: Some(Arc::new(bad)), ..Sources::default() };
        let options = Options { sources, ..Options::default() };
        match complete_mesh(&broken.vertices[..], &broken.faces[..], &options) {
            Err(Error::InvalidOption { name: "sources", reason }) => {
                assert!(reason.contains(word), "{reason}")
            }
            other => panic!("{word}: {other:?}"),
        }
    };
    let n = both.faces.len();
    refused(&|e| e.parts[1] += 1, "parts have");
    refused(&|e| e.faces[0][0] = e.vertices.len() as u32 - 1, "face 0 joins");
    refused(&|e| e.faces.swap(0, n - 1), "not in its part's place");
}

/// A bump that nothing around shows, its top missing; some points of it are known.
fn bump(x: f64, y: f64) -> f64 {
    let r2 = ((x - 30.0).powi(2) + (y - 30.0).powi(2)) / 256.0;
    7.0 * (1.0 - r2).max(0.0).powi(3) * (1.0 + 0.02 * (x - 30.0))
}

fn bump_without_its_top() -> (Mesh, Vec<[f64; 3]>) {
    let far = |i: usize, j: usize| (i as f64 - 29.5).hypot(j as f64 - 29.5) > 14.0;
    let mesh = sheet((60, 60), |x, y| [x, y, bump(x, y)], far);
    let spiral = |k: usize| {
        let (r, turn) = (2.0 * (k as f64).sqrt(), 2.4 * k as f64);
        let (x, y) = (30.0 + r * turn.cos(), 30.0 + r * turn.sin());
        [x, y, bump(x, y)]
    };
    (mesh, (0..36).map(spiral).collect())
}

/// Smooth or coherent, the fill goes through the points and is near the bump between them, where it would be
/// far below; soft points are kept off by a part of that.
#[test]
fn fills_pass_through_points() {
    let (mesh, points) = bump_without_its_top();
    let selection = Selection::NearPoint([30.0, 30.0, 0.0]);
    for method in [Method::Smooth, Method::Coherent] {
        let fill = |points: &[[f64; 3]], softness| {
            let guidance = Guidance { points: points.into(), softness, ..Guidance::default() };
            let selection = selection.clone();
            complete_checked(&mesh, &Options { method, guidance, selection, ..Options::default() })
        };
        let from_truth = |made: &Completion| {
            let square = |p: &[f64; 3]| (p[2] - bump(p[0], p[1])).powi(2);
            let sum: f64 = made.vertices.iter().map(square).sum();
            (sum / made.vertices.len() as f64).sqrt()
        };
        let from_points = |made: &Completion| {
            let (all, faces) = made.to_mesh_f64(&mesh.vertices, &mesh.faces);
            let all: Vec<DVec3> = all.iter().map(|&p| p.into()).collect();
            let tree = Bvh::new(&all, &faces);
            let off =
                |p: &[f64; 3]| tree.closest_point(DVec3::from(*p), f64::INFINITY).unwrap().distance;
            points.iter().map(off).fold(0.0, f64::max)
        };
        let (none, hard, soft) = (fill(&[], 0.0), fill(&points, 0.0), fill(&points, 0.1));
        let truth = [&none, &hard, &soft].map(from_truth);
        let off = [&none, &hard, &soft].map(from_points);
        println!("{}: from the bump {truth:.4?}, from the points {off:.5?} edges", method.name());
        assert!(off[0] > 1.0 && off[1] < 1e-3 && truth[1] < 0.1 * truth[0]);
        assert!(off[2] > 10.0 * off[1] && off[2] < 0.8 * off[0]);
    }
}

/// What was copied is moved, too, and keeps its origins.
#[test]
fn copies_pass_through_points() {
    let (broken, whole) = broken_vessel(Break::Disc);
    let plain = complete_checked(&broken, &Options::default());
    let edge = whole.mean_edge();
    let middle = plain.vertices.iter().map(|&p| DVec3::from(p)).sum::<DVec3>();
    let out = (middle / plain.vertices.len() as f64).with_z(0.0).normalize();
    let some = plain.vertices.iter().step_by(plain.vertices.len() / 7);
    let points: Arc<[[f64; 3]]> =
        some.map(|&p| (DVec3::from(p) + 0.5 * edge * out).to_array()).collect();
    let guidance = Guidance { points: points.clone(), ..Guidance::default() };
    let made = complete_checked(&broken, &Options { guidance, ..Options::default() });
    let (all, faces) = made.to_mesh_f64(&broken.vertices, &broken.faces);
    let all: Vec<DVec3> = all.iter().map(|&p| p.into()).collect();
    let tree = Bvh::new(&all, &faces);
    let off = |p: &[f64; 3]| tree.closest_point(DVec3::from(*p), f64::INFINITY).unwrap().distance;
    let worst = points.iter().map(off).fold(0.0, f64::max) / edge;
    println!("{worst:.1e} edges, {}", made.holes[0].summary());
    assert!(worst < 1e-2, "{worst}");
    assert_eq!(made.holes[0].method, Method::Coherent);
    let copied = made.origins.iter().filter(|o| o.confidence > 0.0).count();
    assert!(copied * 10 > 9 * made.origins.len());
}

#[test]
fn points_far_away_are_named() {
    let (mesh, mut points) = bump_without_its_top();
    points[7] = [30.0, 30.0, 60.0];
    let refused = |points: &[[f64; 3]], softness, option: &str, word: &str| {
        let guidance = Guidance { points: points.into(), softness, ..Guidance::default() };
        let selection = Selection::NearPoint([30.0, 30.0, 0.0]);
        let options = Options { guidance, selection, ..Options::default() };
        match complete_mesh(&mesh.vertices[..], &mesh.faces[..], &options) {
            Err(Error::InvalidOption { name, reason }) => {
                assert!(name == option && reason.contains(word), "{name}: {reason}")
            }
            other => panic!("{word}: {other:?}"),
        }
    };
    refused(&points, 0.0, "points", "point 7 (30, 30, 60)");
    points[7][1] = f64::NAN;
    refused(&points, 0.0, "points", "point 7 has");
    refused(&points[..5], 1.5, "softness", "1.5");
}
