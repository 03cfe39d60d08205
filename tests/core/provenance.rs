//! Where fills come from: what a result says of it, replayed.

use crate::checker::extent;
use complete_mesh::intersect::Bvh;
use complete_mesh::result::{confidence_word, NONE};
use complete_mesh::sample::{break_mesh, Break, BreakOptions, Sample, SampleMesh};
use complete_mesh::{complete_mesh, Completion, HoleReport, Method, Options, Origin};
use glam::DVec3;

/// Greatest distance of a replayed point from its vertex, and the median, in hole diameters
/// (docs/provenance.md).
const FARTHEST: f64 = 0.25;
const MEDIAN: f64 = 0.1;
/// Greatest roughness of the deformation, as a share of that of the fill's own detail.
const DETAIL: f64 = 0.75;

fn broken(sample: Sample, kind: Break) -> SampleMesh {
    let resolution = (12.0 * sample.longest_side() / sample.site().radius).ceil() as usize;
    let whole = sample.build(resolution).unwrap();
    break_mesh(sample, &whole, &BreakOptions { kind, seed: 1, size: 1.0 }).unwrap().mesh
}

fn fill(mesh: &SampleMesh, method: Method) -> Completion {
    let options = Options { method, ..Options::default() };
    complete_mesh(&mesh.vertices[..], &mesh.faces[..], &options).unwrap()
}

/// The point that a vertex was copied from, where its source's transform takes it.
fn replay(mesh: &SampleMesh, hole: &HoleReport, origin: &Origin) -> Option<DVec3> {
    let face = mesh.faces.get(origin.face as usize)?;
    let corner = |k: usize| DVec3::from(mesh.vertices[face[k] as usize].map(f64::from));
    let place = (0..3).map(|k| origin.barycentric[k] * corner(k)).sum();
    Some(hole.sources[origin.source as usize].transform.point(place))
}

fn check_ranges(mesh: &SampleMesh, made: &Completion) {
    assert_eq!(made.origins.len(), made.vertices.len());
    for (origin, &hole) in made.origins.iter().zip(&made.vertex_hole) {
        let hole = &made.holes[hole as usize];
        assert!((0.0..=1.0).contains(&origin.confidence), "{origin:?}");
        if origin.source == NONE {
            assert_eq!(*origin, Origin::NOWHERE);
            continue;
        }
        assert!((origin.source as usize) < hole.sources.len(), "{origin:?}");
        assert!((origin.face as usize) < mesh.faces.len(), "{origin:?}");
        assert!((origin.barycentric.iter().sum::<f64>() - 1.0).abs() < 1e-9, "{origin:?}");
        assert!(origin.barycentric.iter().all(|w| (-1e-6..=1.0 + 1e-6).contains(w)), "{origin:?}");
    }
    for hole in &made.holes {
        assert!((0.0..=1.0).contains(&hole.confidence));
        assert_eq!(hole.method == Method::Coherent, !hole.sources.is_empty());
        let sum: f64 = hole.sources.iter().map(|s| s.weight).sum();
        assert!(hole.sources.is_empty() || (sum - 1.0).abs() < 1e-9, "{sum}");
        assert!(hole.sources.windows(2).all(|w| w[0].weight >= w[1].weight));
        let used: usize = hole.sources.iter().map(|s| s.vertices).sum();
        assert!(used <= hole.vertices.len(), "{used} of {}", hole.vertices.len());
        for source in &hole.sources {
            let m = source.transform.linear;
            let off = m.transpose() * m - glam::DMat3::IDENTITY;
            // Rigid, or stretched by at most 15 %.
            assert!(off.to_cols_array().iter().all(|x| x.abs() < 0.4), "{source:?}");
            assert!(source.error >= 0.0 && source.error.is_finite());
        }
    }
}

/// How rough a field over the new vertices is: root mean square of its difference from the mean of
/// the neighbours, at vertices that one copy surrounds.
fn roughness(made: &Completion, field: impl Fn(usize) -> Option<DVec3>) -> f64 {
    let n = made.vertices.len();
    let mut around = vec![(DVec3::ZERO, 0.0); n];
    let mut inner = vec![true; n];
    for face in &made.faces {
        let new = face.map(|v| (v as usize).checked_sub(made.input_vertex_count));
        let source = |v: Option<usize>| v.map(|v| made.origins[v].source);
        for k in 0..3 {
            let Some(v) = new[k] else { continue };
            for other in [new[(k + 1) % 3], new[(k + 2) % 3]] {
                match other.and_then(&field) {
                    Some(x) if source(other) == source(Some(v)) => {
                        around[v] = (around[v].0 + x, around[v].1 + 1.0);
                    }
                    _ => inner[v] = false,
                }
            }
        }
    }
    let squares: Vec<f64> = (0..n)
        .filter(|&v| inner[v])
        .filter_map(|v| Some(field(v)?.distance_squared(around[v].0 / around[v].1)))
        .collect();
    f64::sqrt(squares.iter().sum::<f64>() / squares.len().max(1) as f64)
}

#[test]
fn replayed_sources_give_the_fill() {
    for (sample, kind) in [
        (Sample::Column, Break::Disc),
        (Sample::Column, Break::Ragged),
        (Sample::Relief, Break::Disc),
    ] {
        let mesh = broken(sample, kind);
        let made = fill(&mesh, Method::Coherent);
        let name = format!("{} {}", sample.name(), kind.name());
        check_ranges(&mesh, &made);
        let hole = &made.holes[0];
        assert_eq!(hole.method, Method::Coherent, "{name}");
        let there: Vec<Option<DVec3>> =
            made.origins.iter().map(|o| replay(&mesh, hole, o)).collect();
        let off = |v: usize| Some(DVec3::from(made.vertices[v]) - there[v]?);
        let mut far: Vec<f64> = (0..there.len()).filter_map(&off).map(DVec3::length).collect();
        far.sort_by(f64::total_cmp);
        assert!(10 * far.len() > 9 * there.len(), "{name}: {} of {}", far.len(), there.len());
        // The fill's extent stands for the hole's diameter.
        let size = extent(&made.vertices);
        let (median, most) = (far[far.len() / 2] / size, far[far.len() - 1] / size);
        // What the smooth fill lacks is detail.
        let smooth = fill(&mesh, Method::Smooth);
        let (vertices, faces) = smooth.to_mesh_f32(&mesh.vertices, &mesh.faces);
        let vertices: Vec<DVec3> =
            vertices.into_iter().map(|p| DVec3::from(p.map(f64::from))).collect();
        let smooth = Bvh::new(&vertices, &faces[mesh.faces.len()..]);
        let detail = |v: usize| {
            let p = DVec3::from(made.vertices[v]);
            Some(p - smooth.closest_point(p, f64::INFINITY)?.point)
        };
        let share = roughness(&made, off) / roughness(&made, detail);
        println!("{name}: median {median:.4}, most {most:.4}, detail {share:.3}");
        assert!(median < MEDIAN && most < FARTHEST, "{name}: {median} {most}");
        assert!(share < DETAIL, "{name}: {share}");
    }
}

#[test]
fn smooth_fills_come_from_nowhere() {
    let mesh = broken(Sample::Sphere, Break::Several);
    let made = fill(&mesh, Method::Smooth);
    check_ranges(&mesh, &made);
    assert!(made.origins.iter().all(|o| *o == Origin::NOWHERE));
    assert!(made.holes.iter().all(|h| h.confidence == 0.0 && h.coherence_error.is_none()));
    assert_eq!(made.holes[0].summary(), "smooth, no source");
}

#[test]
fn words_change_at_their_thresholds() {
    let words = [0.0, 0.499, 0.5, 0.799, 0.8, 1.0].map(confidence_word);
    let [a, b, c] = ["invention", "plausible", "convincing"];
    assert_eq!(words, [a, a, b, b, c, c]);
}
