//! What the vertices carry goes with the shape, and helps to find it.

use crate::checker::{check, filled_rims};
use crate::meshes::Mesh;
use complete_mesh::io::{Document, Extras, Format};
use complete_mesh::sample::{break_mesh, Break, BreakOptions, Sample};
use complete_mesh::{
    complete_mesh, find_holes, Appearance, Completion, Error, Exemplar, Grouping, Monitor, Options,
    Sources,
};
use glam::{DMat3, DVec3};
use std::f64::consts::TAU;
use std::fmt::Write;
use std::sync::Arc;

pub(crate) fn painted(
    mesh: &Mesh,
    colour: &dyn Fn(DVec3) -> Vec<f64>,
    steering: usize,
) -> Appearance {
    let values: Vec<f64> = mesh.vertices.iter().flat_map(|&p| colour(p.into())).collect();
    let channels = colour(DVec3::ZERO).len();
    Appearance { channels, steering, values, exemplar_values: Vec::new() }
}

fn fill(mesh: &Mesh, appearance: &Appearance, sources: Sources) -> (Completion, Vec<f64>) {
    let exemplar = sources.exemplar.clone();
    let appearance = Arc::new(appearance.clone());
    let options = Options { sources, appearance: Some(appearance.clone()), ..Options::default() };
    let made = complete_mesh(&mesh.vertices[..], &mesh.faces[..], &options).unwrap();
    let list = find_holes(mesh.view(), &Grouping::Automatic, &Monitor::silent()).unwrap();
    check(&mesh.vertices, &mesh.faces, &made, &filled_rims(&made, &list)).unwrap();
    let values = appearance.complete((&mesh.faces[..]).into(), exemplar.as_deref(), &made);
    (made, values)
}

/// Root mean square and greatest difference from the colour that belongs to the place.
pub(crate) fn off(
    made: &Completion,
    values: &[f64],
    truth: &dyn Fn(DVec3) -> Vec<f64>,
) -> (f64, f64) {
    let rows = values.chunks_exact(values.len() / made.vertices.len());
    let differences: Vec<f64> = (made.vertices.iter().zip(rows))
        .flat_map(|(&p, row)| truth(p.into()).into_iter().zip(row).map(|(x, y)| x - y))
        .collect();
    let square: f64 = differences.iter().map(|d| d * d).sum();
    let most = differences.iter().fold(0.0, |m: f64, d| m.max(d.abs()));
    ((square / differences.len() as f64).sqrt(), most)
}

/// Colours that are the same at no two places, and linear, so that faces interpolate them exactly.
fn linear(p: DVec3) -> Vec<f64> {
    let at = |d: DVec3| 128.0 + 60.0 * d.dot(p);
    vec![at(DVec3::X), at(DVec3::new(0.3, 0.8, 0.1)), at(DVec3::new(-0.2, 0.1, 0.7)), at(DVec3::Z)]
}

/// A vessel whole; the same broken, turned by so many radians and moved; the turn and the shift.
fn twins(angle: f64) -> (Mesh, Mesh, DMat3, DVec3) {
    let whole = Sample::Vessel.build(110).unwrap();
    let options = BreakOptions { kind: Break::Disc, seed: 1, size: 0.8 };
    let broken = break_mesh(Sample::Vessel, &whole, &options).unwrap().mesh;
    let turn = DMat3::from_axis_angle(DVec3::new(0.2, 0.9, -0.5).normalize(), angle);
    let to = DVec3::new(3.0, -7.0, 0.5);
    let double = |p: &[f32; 3]| p.map(f64::from);
    let place = |p: &[f32; 3]| (turn * DVec3::from(double(p)) + to).to_array();
    let whole =
        Mesh { vertices: whole.vertices.iter().map(double).collect(), faces: whole.faces.clone() };
    let broken =
        Mesh { vertices: broken.vertices.iter().map(place).collect(), faces: broken.faces.clone() };
    (whole, broken, turn, to)
}

/// Two identical painted parts, one of them broken: the colours that belong to the places come back,
/// all four channels, though only three steer. Not in every position: the vessel has a dozen places of the
/// same shape, and the search does not always align the one that has the colours (docs/appearance.md).
#[test]
fn a_broken_part_gets_the_colours_of_its_twin() {
    let (mut both, broken, turn, to) = twins(1.8);
    let mut values = painted(&both, &linear, 3);
    let truth = |p: DVec3| linear(turn.transpose() * (p - to));
    values.values.extend(painted(&broken, &truth, 3).values);
    let first = both.vertices.len() as u32;
    both.vertices.extend(&broken.vertices);
    both.faces.extend(broken.faces.iter().map(|f| f.map(|v| v + first)));
    let (made, found) = fill(&both, &values, Sources::default());
    // The place of each new vertex, on the twin or where the vessel itself has the same.
    let astray = |(p, o): (&[f64; 3], &complete_mesh::Origin)| {
        let corners = both.faces[o.face as usize].map(|v| DVec3::from(both.vertices[v as usize]));
        let at: DVec3 = corners.iter().zip(o.barycentric).map(|(&c, w)| w * c).sum();
        DVec3::from(*p).distance(turn * at + to)
    };
    let astray = made.vertices.iter().zip(&made.origins).map(astray).fold(0.0, f64::max);
    assert!(astray < 1e-5, "a vertex lies {astray} from its place on the twin");
    let (mean, most) = off(&made, &found, &truth);
    println!("mean {mean:.2e}, most {most:.2e} of 255");
    assert!(made.vertices.len() > 100 && made.origins.iter().all(|o| o.confidence > 0.9));
    assert!(most < 0.5, "the same byte: {most}");
}

/// The same from an exemplar, also from a mirrored one; without its colours there is nothing to copy.
#[test]
fn an_exemplar_gives_its_colours() {
    for mirrored in [false, true] {
        from_exemplar(mirrored);
    }
}

fn from_exemplar(mirrored: bool) {
    let (mut whole, broken, turn, to) = twins(2.1);
    let unflip = DVec3::new(if mirrored { -1.0 } else { 1.0 }, 1.0, 1.0);
    if mirrored {
        whole.vertices.iter_mut().for_each(|p| p[0] = -p[0]);
        whole.faces.iter_mut().for_each(|f| f.swap(1, 2));
    }
    let truth = |p: DVec3| linear(turn.transpose() * (p - to));
    let twin = Exemplar {
        vertices: whole.vertices.clone(),
        faces: whole.faces.clone(),
        ..Exemplar::default()
    };
    let sources =
        Sources { exemplar: Some(Arc::new(twin)), exemplar_only: true, ..Sources::default() };
    let mut values = painted(&broken, &truth, 3);
    let (made, plain) = fill(&broken, &values, sources.clone());
    let (_, without) = off(&made, &plain, &truth);
    values.exemplar_values = painted(&whole, &|p| linear(p * unflip), 3).values;
    let (made, found) = fill(&broken, &values, sources);
    let (mean, most) = off(&made, &found, &truth);
    println!("mean {mean:.2e}, most {most:.2e}, without the exemplar's colours {without:.2e}");
    assert!(most < 0.5 && without > 4.0 * most);
}

/// A smooth surface of revolution, or a flat wall, without a piece.
pub(crate) fn lathe(flat: bool) -> Mesh {
    let (around, along) = (160, 100);
    let place = |i: usize, j: usize| {
        let (a, z) = (TAU * i as f64 / around as f64, 2.0 * j as f64 / along as f64 - 1.0);
        if flat {
            return [a - 0.5 * TAU, 2.0 * z, 0.0];
        }
        let r = 1.0 + 0.2 * (2.0 * z).cos();
        [r * a.cos(), r * a.sin(), 2.0 * z]
    };
    let columns = if flat { around } else { around - 1 };
    let vertices: Vec<[f64; 3]> =
        (0..=along).flat_map(|j| (0..=columns).map(move |i| place(i, j))).collect();
    let width = columns + 1;
    let mut faces = Vec::new();
    for j in 0..along {
        for i in 0..around {
            let next = (i + 1) % width;
            let [a, b] = [j * width + i, j * width + next].map(|v| v as u32);
            let [c, d] = [b + width as u32, a + width as u32];
            faces.extend([[a, b, c], [a, c, d]]);
        }
    }
    let middle = if flat { DVec3::new(0.4, 0.3, 0.0) } else { DVec3::new(1.1, 0.5, 0.2) };
    let is_far = |v: &u32| DVec3::from(vertices[*v as usize]).distance(middle) > 0.62;
    faces.retain(|f| f.iter().all(is_far));
    let mut number = vec![u32::MAX; vertices.len()];
    let mut kept = Vec::new();
    for v in faces.iter_mut().flatten() {
        let n = &mut number[*v as usize];
        if *n == u32::MAX {
            *n = kept.len() as u32;
            kept.push(vertices[*v as usize]);
        }
        *v = *n;
    }
    Mesh { vertices: kept, faces }
}

/// Only the inner hole: the borders stay open.
pub(crate) fn fill_inner(mesh: &Mesh, appearance: Option<Appearance>) -> Completion {
    let list = find_holes(mesh.view(), &Grouping::Separate, &Monitor::silent()).unwrap();
    let inner = list.holes.iter().min_by(|a, b| a.circumference.total_cmp(&b.circumference));
    let options = Options {
        grouping: Grouping::Separate,
        selection: complete_mesh::Selection::Ids(vec![inner.unwrap().id]),
        appearance: appearance.map(Arc::new),
        ..Options::default()
    };
    complete_mesh(&mesh.vertices[..], &mesh.faces[..], &options).unwrap()
}

pub(crate) fn pattern(flat: bool) -> impl Fn(DVec3) -> Vec<f64> {
    move |p: DVec3| {
        let a = if flat { p.x } else { p.y.atan2(p.x) };
        let v = (6.0 * a).sin() * (5.0 * (if flat { p.y } else { p.z })).sin();
        vec![0.5 + 0.4 * v, 0.5 - 0.2 * v, 0.3]
    }
}

/// Where shape says nothing (any turn of a vessel, any place on a wall), colour finds the source.
#[test]
fn a_pattern_that_only_colour_can_find() {
    for flat in [false, true] {
        let (mesh, truth) = (lathe(flat), pattern(flat));
        let errors = [3, 0].map(|steering| {
            let values = painted(&mesh, &truth, steering);
            let made = fill_inner(&mesh, Some(values.clone()));
            off(&made, &values.complete((&mesh.faces[..]).into(), None, &made), &truth).0
        });
        println!("flat {flat}: {:.4} by colour, {:.4} by shape alone", errors[0], errors[1]);
        assert!(errors[0] < 0.02 && errors[1] > 5.0 * errors[0], "{errors:?}");
    }
}

/// Values that do not steer leave the shape as it is, to the bit; so do colours that are all one.
#[test]
fn without_steering_nothing_changes() {
    let mesh = lathe(false);
    let plain = fill_inner(&mesh, None);
    let one_colour = |_: DVec3| vec![0.3, 0.7, 0.2];
    for values in [painted(&mesh, &pattern(false), 0), painted(&mesh, &one_colour, 3)] {
        let made = fill_inner(&mesh, Some(values));
        assert!(made.vertices == plain.vertices && made.faces == plain.faces);
        assert!(made.origins == plain.origins);
    }
}

/// A file's colours and floats, written with the fill, are those of the library; bytes are rounded.
#[test]
fn files_get_the_same_values() {
    let (mesh, truth) = (lathe(false), pattern(false));
    let mut text = format!(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty double x\nproperty double y\n\
         property double z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n\
         property double heat\nelement face {}\nproperty list uchar int vertex_indices\nend_header\n",
        mesh.vertices.len(),
        mesh.faces.len()
    );
    let mut values = Vec::new();
    for &p in &mesh.vertices {
        let rgb: Vec<f64> = truth(p.into()).iter().map(|x| (255.0 * x).round()).collect();
        let heat = 7.0 * truth(p.into())[0];
        writeln!(text, "{} {} {} {} {} {} {heat}", p[0], p[1], p[2], rgb[0], rgb[1], rgb[2])
            .unwrap();
        values.extend(rgb.into_iter().chain([heat]));
    }
    mesh.faces.iter().for_each(|f| writeln!(text, "3 {} {} {}", f[0], f[1], f[2]).unwrap());
    let mut document = Document::parse(text.clone().into_bytes(), Format::Ply).unwrap();
    let appearance = Appearance { channels: 4, steering: 3, values, exemplar_values: Vec::new() };
    let made = fill_inner(&mesh, Some(appearance.clone()));
    let wanted = appearance.complete(document.faces(), None, &made);
    document.append(&made, &Extras::default()).unwrap();
    let written = String::from_utf8(document.to_bytes()).unwrap();
    let header = written.lines().position(|l| l == "end_header").unwrap() + 1;
    let rows = written.lines().skip(header + mesh.vertices.len());
    for (row, wanted) in rows.zip(wanted.chunks_exact(4)) {
        let row: Vec<f64> = row.split(' ').map(|x| x.parse().unwrap()).collect();
        for c in 0..3 {
            assert!((row[3 + c] - wanted[c]).abs() <= 0.5 + 1e-6, "{row:?} {wanted:?}");
        }
        assert!((row[6] - wanted[3]).abs() < 1e-6, "{row:?} {wanted:?}");
    }
}

/// Red, green, blue and alpha, as bytes or floats, and another float: of the lathe's pattern, alpha and heat
/// with a mark of their own where x < 0. Rows of five, colours in the unit of the file.
fn columns(mesh: &Mesh, bytes: bool) -> (String, Vec<[f64; 5]>) {
    let (kind, full) = if bytes { ("uchar", 255.0) } else { ("float", 1.0) };
    let mut text = format!("ply\nformat ascii 1.0\nelement vertex {}\n", mesh.vertices.len());
    ["x", "y", "z"].iter().for_each(|d| writeln!(text, "property double {d}").unwrap());
    for channel in ["red", "green", "blue", "alpha"] {
        writeln!(text, "property {kind} {channel}").unwrap();
    }
    let faces = mesh.faces.len();
    write!(text, "property double heat\nelement face {faces}\n").unwrap();
    text += "property list uchar int vertex_indices\nend_header\n";
    let mut rows = Vec::new();
    for &p in &mesh.vertices {
        let row = wanted(p.into()).map(|x| full * x);
        let row = if bytes { row.map(f64::round) } else { row };
        let row = [row[0], row[1], row[2], row[3], 7.0 * wanted(p.into())[4]];
        let [r, g, b, a, heat] = row;
        writeln!(text, "{} {} {} {r} {g} {b} {a} {heat}", p[0], p[1], p[2]).unwrap();
        rows.push(row);
    }
    mesh.faces.iter().for_each(|f| writeln!(text, "3 {} {} {}", f[0], f[1], f[2]).unwrap());
    (text, rows)
}

/// What is at a place, all channels from 0 to 1.
fn wanted(p: DVec3) -> [f64; 5] {
    let colour = pattern(false)(p);
    [colour[0], colour[1], colour[2], 1.0 - colour[0], colour[1]]
}

/// The rows of the new vertices of such a file, all channels from 0 to 1.
fn appended(text: String, made: &Completion, bytes: bool) -> Vec<[f64; 5]> {
    let mut document = Document::parse(text.into_bytes(), Format::Ply).unwrap();
    document.append(made, &Extras::default()).unwrap();
    let written = String::from_utf8(document.to_bytes()).unwrap();
    let header = written.lines().position(|l| l == "end_header").unwrap() + 1;
    let rows = written.lines().skip(header + made.input_vertex_count).take(made.vertices.len());
    let full = if bytes { 255.0 } else { 1.0 };
    rows.map(|row| {
        let row: Vec<f64> = row.split(' ').map(|x| x.parse().unwrap()).collect();
        [row[3] / full, row[4] / full, row[5] / full, row[6] / full, row[7] / 7.0]
    })
    .collect()
}

/// Each kind of column of a file gets what belongs to the place: not what is carried in from the rim, which is
/// off by a tenth.
#[test]
fn every_kind_of_column_is_copied() {
    let mesh = lathe(false);
    for bytes in [true, false] {
        let (text, _) = columns(&mesh, bytes);
        let made = fill_inner(&mesh, Some(painted(&mesh, &pattern(false), 3)));
        let found = appended(text, &made, bytes);
        assert!(found.len() == made.vertices.len() && found.len() > 300);
        for c in 0..5 {
            let off = |(row, p): (&[f64; 5], &[f64; 3])| (row[c] - wanted((*p).into())[c]).powi(2);
            let sum: f64 = found.iter().zip(&made.vertices).map(off).sum();
            let off = (sum / found.len() as f64).sqrt();
            println!("bytes {bytes}, column {c}: {off:.4}");
            assert!(off < 0.02, "bytes {bytes}, column {c}: {off}");
        }
    }
}

/// And nothing from where it may not be copied from: there every column is brighter, which the fill would
/// show.
#[test]
fn no_column_of_a_forbidden_place_is_copied() {
    let mesh = lathe(false);
    let may = |f: &[u32; 3]| f.iter().all(|&v| mesh.vertices[v as usize][0] > 0.1);
    let faces: Arc<[bool]> = mesh.faces.iter().map(may).collect();
    let list = find_holes(mesh.view(), &Grouping::Separate, &Monitor::silent()).unwrap();
    let inner = list.holes.iter().min_by(|a, b| a.circumference.total_cmp(&b.circumference));
    let options = Options {
        grouping: Grouping::Separate,
        selection: complete_mesh::Selection::Ids(vec![inner.unwrap().id]),
        appearance: Some(Arc::new(painted(&mesh, &pattern(false), 3))),
        sources: Sources { faces: Some(faces), ..Sources::default() },
        ..Options::default()
    };
    let made = complete_mesh(&mesh.vertices[..], &mesh.faces[..], &options).unwrap();
    for bytes in [true, false] {
        let (text, rows) = columns(&mesh, bytes);
        // Half as bright, and half of all more where copying is forbidden: what is off by a constant is believed,
        // and only drawn to the rim there.
        let full =
            if bytes { [255.0, 255.0, 255.0, 255.0, 7.0] } else { [1.0, 1.0, 1.0, 1.0, 7.0] };
        let (mut vertex, mut body) = (0, false);
        let marked = text.lines().map(|line| {
            let own = body && vertex < mesh.vertices.len();
            body |= line == "end_header";
            if !own {
                return format!("{line}\n");
            }
            let ([x, y, z], row) = (mesh.vertices[vertex], rows[vertex]);
            vertex += 1;
            let more = if x < 0.0 { 0.5 } else { 0.0 };
            let shade = |c: usize| 0.5 * row[c] + more * full[c];
            let shade = |c: usize| if bytes && c < 4 { shade(c).round() } else { shade(c) };
            let [r, g, b, a, heat] = std::array::from_fn(shade);
            format!("{x} {y} {z} {r} {g} {b} {a} {heat}\n")
        });
        let found = appended(marked.collect(), &made, bytes);
        let most = (0..5).map(|c| found.iter().map(|row| row[c]).fold(0.0, f64::max));
        assert!(most.clone().all(|x| x < 0.5), "{:?}", most.collect::<Vec<_>>());
    }
}

/// Nothing of a part that may not be copied from gets into the fill.
#[test]
fn forbidden_colours_stay_away() {
    let mesh = lathe(false);
    let marked = |p: DVec3| {
        let mark = if p.x < 0.0 { 1.0 } else { 0.0 };
        [&pattern(false)(p)[..], &[mark]].concat()
    };
    let values = painted(&mesh, &marked, 3);
    let may = |f: &[u32; 3]| f.iter().all(|&v| mesh.vertices[v as usize][0] > 0.1);
    let faces: Arc<[bool]> = mesh.faces.iter().map(may).collect();
    let sources = Sources { faces: Some(faces.clone()), ..Sources::default() };
    let list = find_holes(mesh.view(), &Grouping::Separate, &Monitor::silent()).unwrap();
    let inner = list.holes.iter().min_by(|a, b| a.circumference.total_cmp(&b.circumference));
    let options = Options {
        grouping: Grouping::Separate,
        selection: complete_mesh::Selection::Ids(vec![inner.unwrap().id]),
        appearance: Some(Arc::new(values.clone())),
        sources,
        ..Options::default()
    };
    let made = complete_mesh(&mesh.vertices[..], &mesh.faces[..], &options).unwrap();
    let found = values.complete((&mesh.faces[..]).into(), None, &made);
    assert!(made.origins.iter().any(|o| o.confidence > 0.0));
    for (row, origin) in found.chunks_exact(4).zip(&made.origins) {
        assert!(row[3].abs() < 1e-9, "{row:?}");
        assert!(faces.get(origin.face as usize).copied().unwrap_or(true), "{origin:?}");
    }
}

/// Lists that do not fit are errors.
#[test]
fn wrong_lists_are_refused() {
    let mesh = lathe(true);
    let good = painted(&mesh, &pattern(true), 3);
    let mut bad = vec![good.clone(); 5];
    bad[0].values.pop();
    bad[1].values[7] = f64::NAN;
    bad[2].steering = 4;
    bad[3].exemplar_values = vec![0.0; 3];
    bad[4].channels = 0;
    for appearance in bad {
        let appearance = Some(Arc::new(appearance));
        let options = Options { appearance, ..Options::default() };
        let error = complete_mesh(&mesh.vertices[..], &mesh.faces[..], &options).unwrap_err();
        assert!(matches!(error, Error::InvalidOption { name: "appearance", .. }), "{error}");
    }
}

/// The painted sample, broken: the braid, the stipples and their colours go on.
#[test]
fn the_painted_vessel_gets_its_pattern_back() {
    let whole = Sample::Vessel.build(110).unwrap();
    let options = BreakOptions { kind: Break::Disc, seed: 1, size: 0.8 };
    let broken = break_mesh(Sample::Vessel, &whole, &options).unwrap().mesh;
    let colour = |p: DVec3| -> Vec<f64> {
        let point = p.to_array().map(|x| x as f32);
        Sample::Vessel.paint(&[point]).unwrap()[0][..3].iter().map(|&x| f64::from(x)).collect()
    };
    let double = |p: &[f32; 3]| p.map(f64::from);
    let mesh = Mesh { vertices: broken.vertices.iter().map(double).collect(), faces: broken.faces };
    let values = painted(&mesh, &colour, 3);
    let (made, found) = fill(&mesh, &values, Sources::default());
    let plain = Options { method: complete_mesh::Method::Smooth, ..Options::default() };
    let smooth = complete_mesh(&mesh.vertices[..], &mesh.faces[..], &plain).unwrap();
    let from_rim = values.complete((&mesh.faces[..]).into(), None, &smooth);
    let (copied, blurred) = (off(&made, &found, &colour).0, off(&smooth, &from_rim, &colour).0);
    println!("off by {copied:.1} of 255, from the rim {blurred:.1}");
    assert!(copied < 0.4 * blurred, "{copied} {blurred}");
}

/// Stripes that wander, so that none goes on as another does.
fn stripes(p: DVec3) -> Vec<f64> {
    let wander = 1.9 * (1.7 * p.x + 0.3).sin() + 1.3 * (2.9 * p.x - 1.9 * p.y).sin();
    let v = (2.5 * (17.0 * p.y + 6.0 * (p.x * p.x) + wander).sin()).tanh();
    vec![0.5 + 0.4 * v, 0.5 - 0.2 * v, 0.3 + 0.1 * v]
}

/// Spots, each of its own size, shade and place in a cell of the wall.
fn spots(p: DVec3) -> Vec<f64> {
    let cell = (p * 4.0).floor();
    let mut v: f64 = 0.0;
    for (dx, dy) in (-1..=1).flat_map(|x| (-1..=1).map(move |y| (x, y))) {
        let c = cell + DVec3::new(f64::from(dx), f64::from(dy), 0.0);
        let random = |k: f64| (k * 1e4 * (12.9898 * c.x + 78.233 * c.y + k).sin()).rem_euclid(1.0);
        let at = c + DVec3::new(0.2 + 0.6 * random(1.0), 0.2 + 0.6 * random(1.3), 0.0);
        let size = 0.25 + 0.2 * random(1.7);
        v = v.max((1.0 - (p * 4.0).truncate().distance(at.truncate()) / size).clamp(0.0, 0.5));
    }
    vec![0.2 + 1.2 * v, 0.6 - 0.8 * v, 0.4]
}

/// Root mean square step along some edges, over all channels.
fn steps(edges: &[[usize; 2]], row: &dyn Fn(usize) -> Vec<f64>) -> f64 {
    let square = |&[a, b]: &[usize; 2]| -> f64 {
        row(a).iter().zip(row(b)).map(|(x, y)| (x - y) * (x - y)).sum()
    };
    (edges.iter().map(square).sum::<f64>() / edges.len() as f64).sqrt()
}

/// Root of the variance over all channels.
fn spread(rows: &[Vec<f64>]) -> f64 {
    let n = rows.len() as f64;
    let mean = |c: usize| rows.iter().map(|r| r[c]).sum::<f64>() / n;
    let of = |c: usize| rows.iter().map(|r| (r[c] - mean(c)).powi(2)).sum::<f64>() / n;
    (0..rows[0].len()).map(of).sum::<f64>().sqrt()
}

/// Paint that nothing on the wall continues is put together of pieces: contrast, detail and the change across the
/// rim are those of the paint around it, where a blur has none; it is no farther from the truth than another
/// sample of the paint would be (√2 of its spread), and the same on any number of threads.
#[test]
fn paint_that_nothing_continues_still_looks_like_it() {
    for (name, truth) in [("stripes", stripes as fn(DVec3) -> Vec<f64>), ("spots", spots)] {
        let mesh = lathe(true);
        let values = painted(&mesh, &truth, 3);
        let made = fill_inner(&mesh, Some(values.clone()));
        let found = values.complete((&mesh.faces[..]).into(), None, &made);
        let n = mesh.vertices.len();
        let known = |v: usize| values.values[3 * v..][..3].to_vec();
        let row = |v: usize| if v < n { known(v) } else { found[3 * (v - n)..][..3].to_vec() };
        let place =
            |v: usize| DVec3::from(if v < n { mesh.vertices[v] } else { made.vertices[v - n] });
        let right = |v: usize| truth(place(v));
        let (mut inside, mut across) = (Vec::new(), Vec::new());
        for f in &made.faces {
            for [a, b] in [[f[0], f[1]], [f[1], f[2]], [f[2], f[0]]] {
                let edge = [a as usize, b as usize];
                match edge.iter().filter(|&&v| v < n).count() {
                    0 => inside.push(edge),
                    1 => across.push(edge),
                    _ => {}
                }
            }
        }
        let new: Vec<usize> = (n..n + made.vertices.len()).collect();
        let of = |row: &dyn Fn(usize) -> Vec<f64>| {
            spread(&new.iter().map(|&v| row(v)).collect::<Vec<_>>())
        };
        let contrast = of(&row) / of(&right);
        let detail = steps(&inside, &row) / steps(&inside, &right);
        let seam = steps(&across, &row) / steps(&across, &right);
        let error = off(&made, &found, &truth).0 * 3f64.sqrt() / of(&right);
        println!(
            "{name}: contrast {contrast:.2}, detail {detail:.2}, seam {seam:.2}, error {error:.2}"
        );
        assert!((0.7..1.3).contains(&contrast) && (0.7..1.3).contains(&detail), "{name}");
        assert!(seam < 1.3 && error < 1.45, "{name}: {seam} {error}");
        let coloured: usize = made.holes.iter().flat_map(|h| &h.sources).map(|s| s.coloured).sum();
        assert_eq!(coloured, made.vertices.len(), "each vertex has a piece");
    }
}

/// Colours that change slowly are best carried in from the rim: no pieces.
#[test]
fn slow_colours_are_not_quilted() {
    let mesh = lathe(true);
    let truth = |p: DVec3| {
        vec![0.5 + 0.4 * (0.9 * p.x + 0.4 * p.y + 0.1 * p.x * p.y).sin(), 0.4, 0.1 * p.y]
    };
    let values = painted(&mesh, &truth, 3);
    let made = fill_inner(&mesh, Some(values.clone()));
    let found = values.complete((&mesh.faces[..]).into(), None, &made);
    let error = off(&made, &found, &truth).0;
    println!("off by {error:.4}");
    assert!(error < 0.02 && made.holes.iter().flat_map(|h| &h.sources).count() < 50);
}
