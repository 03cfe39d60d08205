//! Coherent completion against surfaces whose truth is known.

use crate::checker::complete_checked;
use crate::meshes::{flat, sheet, tetrahedron_without_floor, within, Mesh};
use complete_mesh::intersect::Bvh;
use complete_mesh::matching::rigid::Rigid;
use complete_mesh::sample::{break_mesh, Break, BreakOptions, Sample, SampleMesh};
use complete_mesh::{
    complete_mesh, complete_mesh_with, Completer, Completion, Error, Fairing, Grouping, Guidance,
    MeshView, Method, Monitor, Options, Selection, Sizing, Sources,
};
use glam::{DMat3, DVec3};

fn fill(mesh: &Mesh, method: Method) -> Completion {
    complete_checked(mesh, &Options { method, ..Options::default() })
}

/// Every bit of two results but their times.
fn same(a: &Completion, b: &Completion) -> bool {
    let bits = |c: &Completion| -> Vec<[u64; 3]> {
        c.vertices.iter().map(|p| p.map(f64::to_bits)).collect()
    };
    let stories = |c: &Completion| -> Vec<_> {
        c.holes.iter().map(|h| (h.method, h.sources.clone(), h.confidence.to_bits())).collect()
    };
    bits(a) == bits(b)
        && (&a.faces, &a.face_hole, &a.origins) == (&b.faces, &b.face_hole, &b.origins)
        && stories(a) == stories(b)
}

/// An irregular relief about the origin of a plane, nothing from radius 1 on.
fn motif(x: f64, y: f64) -> f64 {
    const BUMPS: [[f64; 4]; 7] = [
        [0.14, 0.26, 0.10, 0.05],
        [-0.11, 0.22, -0.32, 0.18],
        [0.10, 0.20, 0.28, -0.36],
        [0.12, 0.24, -0.15, -0.42],
        [-0.09, 0.20, 0.42, 0.30],
        [0.09, 0.22, -0.55, -0.08],
        [0.10, 0.20, 0.02, 0.55],
    ];
    let rest = (1.0 - x * x - y * y).max(0.0);
    let bump = |&[height, width, a, b]: &[f64; 4]| {
        height * (-((x - a).powi(2) + (y - b).powi(2)) / (width * width)).exp()
    };
    // Twice differentiable where it ends.
    (4.0 * rest.min(0.25)).powi(3) * BUMPS.iter().map(bump).sum::<f64>()
}

/// The unit sphere with the relief twice.
struct Twins {
    /// Where one is; `to_hole` takes it to the other.
    to_hole: Rigid,
    edge: f64,
    /// The whole surface without a disc in the middle of the other.
    mesh: Mesh,
}

/// Radius of the relief and of the hole, on the unit sphere.
const SIZE: f64 = 0.5;
const HOLE: f64 = 0.24;
/// Middle of the one that stays.
const STAYS: DVec3 = DVec3::Z;

impl Twins {
    fn new(mirrored: bool) -> Self {
        Self::damaged(mirrored, 0.0)
    }

    /// The one that stays has a hole of such a radius in its middle.
    fn damaged(mirrored: bool, damage: f64) -> Self {
        let turn = DMat3::from_axis_angle(DVec3::new(-0.8, 0.6, 0.3).normalize(), 1.9);
        let flip = if mirrored { -1.0 } else { 1.0 };
        let linear = turn * DMat3::from_diagonal(DVec3::new(flip, 1.0, 1.0));
        let mut twins = Self {
            to_hole: Rigid { linear, translation: DVec3::ZERO },
            edge: 0.05,
            mesh: Mesh::default(),
        };
        let ball = Sample::Sphere.build(40).unwrap();
        let place = |p: &[f32; 3]| {
            let d = DVec3::from(p.map(f64::from)).normalize();
            (d * twins.radius(d)).to_array()
        };
        let vertices: Vec<[f64; 3]> = ball.vertices.iter().map(place).collect();
        let at = |v: u32| DVec3::from(vertices[v as usize]);
        let lengths = ball.faces.iter().map(|f| at(f[0]).distance(at(f[1])));
        twins.edge = lengths.sum::<f64>() / ball.faces.len() as f64;
        let lost = |f: &&[u32; 3]| {
            let middle = f.iter().map(|&v| at(v)).sum::<DVec3>().normalize();
            middle.distance(twins.hole()) >= HOLE && middle.distance(STAYS) >= damage
        };
        let faces = ball.faces.iter().filter(lost).copied().collect();
        twins.mesh = compact(&vertices, faces);
        twins
    }

    fn hole(&self) -> DVec3 {
        self.to_hole.point(STAYS)
    }

    /// Distance of the surface from the origin in a direction.
    fn radius(&self, d: DVec3) -> f64 {
        let own = |d: DVec3| match d.z > 0.0 {
            true => SIZE * motif(d.x / SIZE, d.y / SIZE),
            false => 0.0,
        };
        1.0 + own(d) + own(self.to_hole.inverse().point(d))
    }

    /// Root mean square and greatest distance from the truth, in edges.
    fn error(&self, points: impl Iterator<Item = DVec3>) -> (f64, f64) {
        let off: Vec<f64> =
            points.map(|p| (p.length() - self.radius(p.normalize())).abs() / self.edge).collect();
        let square = off.iter().map(|x| x * x).sum::<f64>() / off.len() as f64;
        (square.sqrt(), off.into_iter().fold(0.0, f64::max))
    }
}

/// Without the vertices that no face uses.
fn compact(vertices: &[[f64; 3]], mut faces: Vec<[u32; 3]>) -> Mesh {
    let mut number = vec![u32::MAX; vertices.len()];
    let mut kept = Vec::new();
    for v in faces.iter_mut().flatten() {
        let place = &mut number[*v as usize];
        if *place == u32::MAX {
            *place = kept.len() as u32;
            kept.push(vertices[*v as usize]);
        }
        *v = *place;
    }
    Mesh { vertices: kept, faces }
}

fn points(made: &Completion) -> impl Iterator<Item = DVec3> + '_ {
    made.vertices.iter().map(|&p| DVec3::from(p))
}

/// What the object shows a second time comes back to a small part of an edge, and the report says
/// where it was taken from.
#[test]
fn a_twin_gives_back_what_was_lost() {
    for mirrored in [false, true] {
        let twins = Twins::new(mirrored);
        let made = fill(&twins.mesh, Method::Coherent);
        let smooth = fill(&twins.mesh, Method::Smooth);
        let ((rms, most), (smooth_rms, smooth_most)) =
            (twins.error(points(&made)), twins.error(points(&smooth)));
        let hole = &made.holes[0];
        let best = hole.sources[0];
        let off = points(&made)
            .map(|p| best.transform.point(twins.to_hole.inverse().point(p)).distance(p))
            .fold(0.0, f64::max);
        println!(
            "mirrored {mirrored}, {} vertices: {rms:.3}, most {most:.3} (smooth {smooth_rms:.3}, \
             {smooth_most:.3}) edges; transform {:.3} edges off; weight {:.2}; {}",
            made.vertices.len(),
            off / twins.edge,
            best.weight,
            hole.summary()
        );
        assert_eq!((made.holes.len(), hole.method), (1, Method::Coherent));
        assert!(made.vertices.len() > 50);
        assert!(rms < 0.06 && most < 0.2, "{rms} {most}");
        assert!(rms < 0.1 * smooth_rms, "{rms} of {smooth_rms}");
        assert_eq!(best.transform.is_mirrored(), mirrored);
        assert!(off < 0.1 * twins.edge, "{}", off / twins.edge);
        assert!(hole.confidence > 0.8, "{}", hole.confidence);
        // The detail is taken from where the twin is.
        let mut from_twin = 0;
        for (origin, p) in made.origins.iter().zip(points(&made)) {
            let Some(face) = twins.mesh.faces.get(origin.face as usize) else { continue };
            let corner = |k: usize| DVec3::from(twins.mesh.vertices[face[k] as usize]);
            let there: DVec3 = (0..3).map(|k| origin.barycentric[k] * corner(k)).sum();
            let near = there.distance(twins.to_hole.inverse().point(p)) < 0.25 * twins.edge;
            from_twin += usize::from(near && there.normalize().distance(STAYS) < SIZE);
        }
        assert!(from_twin * 10 > made.vertices.len() * 9, "{from_twin}");
    }
}

/// A twin that has a hole of its own serves once that is completed, too: what it shows comes back as before,
/// and what it does not show has no origin. Its hole alone in the way, nothing of it is found.
#[test]
fn a_damaged_twin_gives_back_what_it_has() {
    const DAMAGE: f64 = 0.06;
    for mirrored in [false, true] {
        let twins = Twins::damaged(mirrored, DAMAGE);
        let both = fill(&twins.mesh, Method::Coherent);
        let large = both.holes.iter().max_by_key(|h| h.vertices.len()).unwrap();
        let only = Options {
            method: Method::Coherent,
            selection: Selection::Ids(vec![large.hole]),
            ..Options::default()
        };
        let alone = complete_checked(&twins.mesh, &only);
        let there = |p: DVec3| twins.to_hole.inverse().point(p).normalize().distance(STAYS);
        let shown = |c: &Completion, hole: usize| {
            let own = c.vertices[c.holes[hole].vertices.clone()].iter().map(|&p| DVec3::from(p));
            twins.error(own.filter(|&p| there(p) > DAMAGE + twins.edge)).0
        };
        let (rms, before) = (shown(&both, large.hole), shown(&alone, large.hole));
        println!(
            "mirrored {mirrored}: {rms:.3} edges, {before:.3} without the small hole's fill; {} | {}",
            large.summary(),
            alone.holes[large.hole].summary()
        );
        assert_eq!(large.sources[0].transform.is_mirrored(), mirrored);
        assert!(rms < 0.15 && rms < 0.3 * before, "{rms} {before}");
        let (mut nowhere, mut shown) = (0, 0);
        for v in large.vertices.clone() {
            let p = DVec3::from(both.vertices[v]);
            // What lies over the small hole comes from nowhere, as do seams that were bridged.
            if there(p) < DAMAGE - 0.5 * twins.edge {
                nowhere += 1;
                assert!(both.origins[v].is_nowhere() && both.origins[v].confidence == 0.0);
            } else if there(p) > DAMAGE + 1.5 * twins.edge {
                shown += usize::from(!both.origins[v].is_nowhere());
                let face = both.origins[v].face as usize;
                assert!(both.origins[v].is_nowhere() || face < twins.mesh.faces.len());
            }
        }
        assert!(nowhere > 0 && shown > 20 * nowhere, "{nowhere} {shown}");
    }
}

/// The input moved, mirrored or scaled: the fill is as true to the truth that moved with it.
#[test]
fn the_fill_moves_with_its_input() {
    let twins = Twins::new(true);
    let here = fill(&twins.mesh, Method::Coherent);
    let (rms, _) = twins.error(points(&here));
    let turn = DMat3::from_axis_angle(DVec3::new(1.0, 2.0, -0.5).normalize(), 1.1);
    let mirror = DMat3::from_diagonal(DVec3::new(1.0, -1.0, 1.0));
    for (scale, linear, by) in [
        (1.0, turn, DVec3::new(3.0, -5.0, 2.0)),
        (1.0, turn * mirror, DVec3::ZERO),
        (3.7, DMat3::IDENTITY, DVec3::ZERO),
        (4.0, DMat3::IDENTITY, DVec3::ZERO),
    ] {
        let to = Rigid { linear, translation: by };
        let vertices: Vec<[f64; 3]> = (twins.mesh.vertices.iter())
            .map(|&p| to.point(scale * DVec3::from(p)).to_array())
            .collect();
        let turned = |f: &[u32; 3]| if to.is_mirrored() { [f[0], f[2], f[1]] } else { *f };
        let faces = twins.mesh.faces.iter().map(turned).collect();
        let there = fill(&Mesh { vertices, faces }, Method::Coherent);
        let back = || points(&there).map(|p| to.inverse().point(p) / scale);
        let (moved_rms, most) = twins.error(back());
        let name = format!("times {scale}, mirrored {}", to.is_mirrored());
        println!("{name}: {moved_rms:.4} (in place {rms:.4}), most {most:.3} edges");
        assert!(moved_rms < 1.3 * rms + 0.01 && most < 0.2, "{name}: {moved_rms} {most}");
        assert_eq!(there.holes[0].method, Method::Coherent, "{name}");
        assert!(there.holes[0].sources[0].transform.is_mirrored(), "{name}");
        // The same vertices, but for rounding: a power of two changes none but that of logarithms. What
        // is averaged and binned lies along the surface's axes, which are right-handed.
        if !to.is_mirrored() {
            assert_eq!(here.faces, there.faces, "{name}");
            let apart = points(&here).zip(back()).map(|(p, q)| p.distance(q)).fold(0.0, f64::max);
            println!("apart {apart:.1e}");
            assert!(apart < if scale == 4.0 { 1e-13 } else { 1e-6 }, "{name}: {apart}");
        }
    }
}

fn broken(sample: Sample, kind: Break, seed: u64, fine: f64) -> (SampleMesh, Mesh) {
    let resolution = (fine * sample.longest_side() / sample.site().radius).ceil() as usize;
    let whole = sample.build(resolution).unwrap();
    let left = break_mesh(sample, &whole, &BreakOptions { kind, seed, size: 1.0 }).unwrap().mesh;
    let vertices = left.vertices.iter().map(|p| p.map(f64::from)).collect();
    (whole, Mesh { vertices, faces: left.faces })
}

#[test]
fn bytes_depend_neither_on_threads_nor_on_the_run() {
    for (sample, kind) in [(Sample::Column, Break::Ragged), (Sample::Relief, Break::Disc)] {
        let (_, left) = broken(sample, kind, 1, 12.0);
        let run = |threads| {
            let options = Options { threads, ..Options::default() };
            complete_mesh(&left.vertices[..], &left.faces[..], &options).unwrap()
        };
        let first = run(1);
        let name = format!("{} {}", sample.name(), kind.name());
        assert!(first.holes.iter().any(|h| h.method == Method::Coherent), "{name}");
        for threads in [1, 2, 3] {
            assert!(same(&first, &run(threads)), "{name}: {threads} threads");
        }
    }
}

/// Root mean square distance of the new vertices from a mesh.
fn rms_distance(made: &Completion, truth: &SampleMesh) -> f64 {
    let positions: Vec<DVec3> =
        truth.vertices.iter().map(|p| DVec3::from(p.map(f64::from))).collect();
    let tree = Bvh::new(&positions, &truth.faces);
    let square = |p| tree.closest_point(p, f64::INFINITY).unwrap().distance.powi(2);
    (points(made).map(square).sum::<f64>() / made.vertices.len() as f64).sqrt()
}

#[test]
fn flutes_are_continued() {
    let mut ratios = Vec::new();
    for (kind, seed) in [(Break::Disc, 0), (Break::Ragged, 0), (Break::Ragged, 1)] {
        let (whole, left) = broken(Sample::Column, kind, seed, 16.0);
        let [coherent, smooth] = [Method::Coherent, Method::Smooth]
            .map(|method| rms_distance(&fill(&left, method), &whole));
        println!("{} {seed}: {coherent:.1e}, smooth {smooth:.1e}", kind.name());
        ratios.push(coherent / smooth);
    }
    assert!(ratios.iter().all(|&r| r < 0.1), "{ratios:?}");
}

/// Cracks are looked at through windows, whose copies go on across: what is worn by them repeats, and no smooth fill
/// shows it.
#[test]
fn relief_goes_on_across_a_crack() {
    for sample in [Sample::Column, Sample::Vessel, Sample::Relief] {
        let whole = sample.build(120).unwrap();
        let options = BreakOptions { kind: Break::Crack, seed: 1, size: 1.0 };
        let left = break_mesh(sample, &whole, &options).unwrap().mesh;
        let vertices = left.vertices.iter().map(|p| p.map(f64::from)).collect();
        let left = Mesh { vertices, faces: left.faces };
        let made = fill(&left, Method::Coherent);
        assert!(made.holes.iter().all(|h| h.method == Method::Coherent), "{}", sample.name());
        let [coherent, smooth] =
            [made, fill(&left, Method::Smooth)].map(|made| rms_distance(&made, &whole));
        println!("{}: {coherent:.1e}, smooth {smooth:.1e}", sample.name());
        assert!(coherent < 0.8 * smooth, "{}: {coherent} {smooth}", sample.name());
    }
}

/// A missing band is seen in parts. A plain one is best filled smoothly, and no copy must be believed because a part's
/// own bare plate, cut off where the part ends, is far off there; flutes go on all around.
#[test]
fn bands_are_continued_where_there_is_something_to_continue() {
    for (sample, seeds, most) in [(Sample::Leg, 1..5, 1.1), (Sample::Column, 1..5, 0.7)] {
        let whole = sample.build(80).unwrap();
        let (mut coherent, mut smooth) = (0.0, 0.0);
        for seed in seeds {
            let options = BreakOptions { kind: Break::Ring, seed, size: 1.0 };
            let left = break_mesh(sample, &whole, &options).unwrap().mesh;
            let vertices = left.vertices.iter().map(|p| p.map(f64::from)).collect();
            let left = Mesh { vertices, faces: left.faces };
            let both = [Method::Coherent, Method::Smooth]
                .map(|method| rms_distance(&fill(&left, method), &whole));
            println!("{} {seed}: {:.1e}, smooth {:.1e}", sample.name(), both[0], both[1]);
            (coherent, smooth) = (coherent + both[0], smooth + both[1]);
        }
        assert!(coherent < most * smooth, "{}: {coherent} {smooth}", sample.name());
    }
}

/// Every sphere is like every other part of itself; and with nothing to continue no harm is done.
#[test]
fn a_plain_sphere_stays_one() {
    for kind in [Break::Disc, Break::Several] {
        let (_, left) = broken(Sample::Sphere, kind, 1, 10.0);
        let edge = 0.1 * Sample::Sphere.site().radius;
        let off = |p: DVec3| (p.length() - 1.0).abs() / edge;
        let most = |method| points(&fill(&left, method)).map(off).fold(0.0, f64::max);
        let (coherent, smooth) = (most(Method::Coherent), most(Method::Smooth));
        println!("{}: {coherent:.3} edges, smooth {smooth:.3}", kind.name());
        assert!(coherent < 0.15 && coherent < smooth + 0.05, "{coherent} {smooth}");
    }
}

#[test]
fn a_hole_without_room_for_detail_is_filled_smoothly() {
    // 2 × 2 cells lost: one new vertex or so.
    let wavy = |x: f64, y: f64| [x, y, 0.4 * x.sin() * (0.7 * y).cos()];
    let mesh = sheet((14, 14), wavy, |i, j| !within(i, j, 6, 8));
    let options =
        |method| Options { method, selection: Selection::AllButLargest, ..Options::default() };
    let fill = |m| complete_mesh(&mesh.vertices[..], &mesh.faces[..], &options(m)).unwrap();
    let (coherent, smooth) = (fill(Method::Coherent), fill(Method::Smooth));
    assert!((1..6).contains(&coherent.vertices.len()), "{}", coherent.vertices.len());
    assert!(same(&coherent, &smooth));
    assert!(coherent.holes.iter().all(|h| h.method == Method::Smooth));
}

#[test]
fn the_smallest_meshes_are_filled() {
    fill(&tetrahedron_without_floor(), Method::Coherent);
    let corners =
        [DVec3::X, DVec3::Y, -DVec3::X, -DVec3::Y, DVec3::Z, -DVec3::Z].map(|p| p.to_array());
    let mut octahedron = Mesh { vertices: corners.to_vec(), faces: Vec::new() };
    for k in 0..4 {
        let next = (k + 1) % 4;
        octahedron.faces.extend([[k, next, 4], [next, k, 5]]);
    }
    octahedron.faces.pop();
    fill(&octahedron, Method::Coherent);
    // Refined to many vertices, with next to nothing known.
    octahedron.faces.pop();
    let sizing = Sizing::EdgeLength(0.1);
    let options = Options { sizing, ..Options::default() };
    let made = complete_checked(&octahedron, &options);
    assert!(made.vertices.len() > 50, "{}", made.vertices.len());
}

#[test]
fn a_completer_gives_the_same_again() {
    let (_, left) = broken(Sample::Relief, Break::Disc, 1, 12.0);
    let silent = Monitor::silent();
    let view = MeshView::new(&left.vertices[..], &left.faces[..]);
    let kept = Completer::new(view, &Grouping::Automatic, &silent).unwrap();
    let coherent = Options::default();
    let smooth = Options { method: Method::Smooth, ..Options::default() };
    let first = kept.complete(&coherent, &silent).unwrap();
    assert_eq!(first.holes[0].method, Method::Coherent);
    let between = kept.complete(&smooth, &silent).unwrap();
    assert!(!same(&first, &between));
    assert!(same(&first, &kept.complete(&coherent, &silent).unwrap()));
    let fresh = complete_mesh(&left.vertices[..], &left.faces[..], &coherent).unwrap();
    assert!(same(&first, &fresh));
}

/// What a completer keeps of other calls changes nothing: one hole and then all, another fairing, smaller triangles,
/// other sources.
#[test]
fn what_was_asked_before_does_not_matter() {
    let (_, left) = broken(Sample::Torus, Break::Several, 1, 8.0);
    let silent = Monitor::silent();
    let view = MeshView::new(&left.vertices[..], &left.faces[..]);
    let kept = Completer::new(view, &Grouping::Automatic, &silent).unwrap();
    let all = Options::default();
    let one = Options { selection: Selection::Ids(vec![1]), ..all.clone() };
    let fairing = Options { fairing: Fairing::C1, ..all.clone() };
    let fine = Options { sizing: Sizing::Scaled(0.8), ..all.clone() };
    let length = Options { sizing: Sizing::EdgeLength(0.05), ..fairing.clone() };
    let warp = Options { method: Method::Warp, ..all.clone() };
    let coarse = Options { sizing: Sizing::Scaled(1.5), fairing: Fairing::C0, ..warp.clone() };
    let guidance = Guidance { candidate: 2, ..Guidance::default() };
    let second = Options { guidance, ..all.clone() };
    let of = |sources: Sources| Options { sources, ..all.clone() };
    let plain = of(Sources { unmirrored: true, ..Sources::default() });
    let faces = (0..left.faces.len()).map(|f| f % 2 == 0 || f > 100).collect();
    let part = of(Sources { faces: Some(faces), ..Sources::default() });
    let order = [
        &one, &warp, &all, &plain, &second, &fairing, &part, &coarse, &fine, &one, &length, &all,
        &fine, &plain, &part,
    ];
    for asked in order {
        let fresh = complete_mesh(&left.vertices[..], &left.faces[..], asked).unwrap();
        assert!(fresh.holes.iter().any(|h| h.method == asked.method));
        assert!(same(&fresh, &kept.complete(asked, &silent).unwrap()), "{asked:?}");
    }
}

/// Triangles of another size show the same surface, told to come from the same places. Another fairing changes
/// nothing where copies are trusted, and draws the fill to its own surface where they are doubted.
#[test]
fn another_size_or_fairing_is_the_same_completion() {
    for (sample, kind) in [(Sample::Column, Break::Disc), (Sample::Relief, Break::Ragged)] {
        let (whole, left) = broken(sample, kind, 1, 12.0);
        let standard = complete_checked(&left, &Options::default());
        let smooth = fill(&left, Method::Smooth);
        let surface = fill_of(&left, &standard);
        let edge = left.mean_edge();
        let mean = |made: &Completion, to: &Bvh| {
            let off = |p: DVec3| to.closest_point(p, f64::INFINITY).unwrap().distance;
            points(made).map(off).sum::<f64>() / (edge * made.vertices.len() as f64)
        };
        let most = 0.25 * mean(&smooth, &surface);
        for factor in [0.5, 1.5] {
            let options = Options { sizing: Sizing::Scaled(factor), ..Options::default() };
            let made = complete_checked(&left, &options);
            let name = format!("{} {factor}", sample.name());
            assert_eq!(made.holes[0].method, Method::Coherent, "{name}");
            let count = made.vertices.len() as f64 / standard.vertices.len() as f64;
            assert!((0.8..1.35).contains(&(count * factor * factor)), "{name}: {count}");
            let off = mean(&made, &surface);
            let (now, before) = (rms_distance(&made, &whole), rms_distance(&standard, &whole));
            let (now, before) = (now / edge, before / edge);
            println!("{name}: off {off:.4} of {most:.4}, from truth {now:.4}, before {before:.4}");
            assert!(off < most, "{name}: {off}");
            assert!(now < 1.15 * before + 0.05, "{name}: {now} {before}");
            let of = |c: &Completion| -> Vec<_> {
                c.holes[0].sources.iter().map(|s| (s.transform, s.weight)).collect()
            };
            assert_eq!(of(&made), of(&standard), "{name}");
            let told = made.origins.iter().filter(|o| !o.is_nowhere()).count();
            assert!(10 * told > 9 * made.origins.len(), "{name}: {told}");
        }
        let fairing = Fairing::C0;
        let made = complete_checked(&left, &Options { fairing, ..Options::default() });
        let trusted = sample == Sample::Column;
        assert_eq!(same(&made, &standard), trusted, "{}", sample.name());
        let tight = complete_checked(
            &left,
            &Options { fairing, method: Method::Smooth, ..Options::default() },
        );
        let tight = fill_of(&left, &tight);
        assert!(trusted || mean(&made, &tight) < mean(&standard, &tight));
        assert_eq!((&made.faces, &made.origins), (&standard.faces, &standard.origins));
    }
}

/// The tree over the faces of a fill.
fn fill_of(left: &Mesh, made: &Completion) -> Bvh {
    let all = left.vertices.iter().chain(&made.vertices);
    let all: Vec<DVec3> = all.map(|&p| DVec3::from(p)).collect();
    Bvh::new(&all, &made.faces)
}

/// Stopped anywhere on the way; the same completer then still gives the whole result.
#[test]
fn a_cancelled_completion_leaves_nothing() {
    let (_, left) = broken(Sample::Relief, Break::Disc, 1, 12.0);
    let view = MeshView::new(&left.vertices[..], &left.faces[..]);
    let whole = complete_mesh_with(view, &Options::default(), &Monitor::silent()).unwrap();
    let kept = Completer::new(view, &Grouping::Automatic, &Monitor::silent()).unwrap();
    for threads in [1, 2] {
        let options = Options { threads, ..Options::default() };
        for part in [0.0, 0.15, 0.3, 0.5, 0.8, 0.95] {
            let go_on = |fraction: f64, _: &str| fraction < part;
            let stopped = kept.complete(&options, &Monitor::new(&go_on));
            assert_eq!(stopped.err(), Some(Error::Cancelled), "at {part}");
        }
        assert!(same(&whole, &kept.complete(&options, &Monitor::silent()).unwrap()));
    }
}

/// A sheet open at its border is no hole to be closed, but its inside may serve as a source.
#[test]
fn a_flat_sheet_stays_flat() {
    let mesh = sheet((40, 40), flat, |i, j| !within(i, j, 14, 24));
    let options = Options { selection: Selection::AllButLargest, ..Options::default() };
    let made = complete_mesh(&mesh.vertices[..], &mesh.faces[..], &options).unwrap();
    assert!(made.vertices.len() > 50);
    let most = made.vertices.iter().fold(0.0, |m: f64, p| m.max(p[2].abs()));
    assert!(most < 1e-9, "{most}");
}
