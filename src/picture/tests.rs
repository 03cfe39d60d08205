//! The picture shows what is there: values of pixels, not only that it does not crash.

use super::*;
use crate::holes::{BoundaryLoop, HoleKind};
use crate::mesh::MeshView;
use crate::sample::Sample;

/// A unit square in the plane z = 0, facing +z.
const SQUARE: [[f32; 3]; 4] =
    [[-0.5, -0.5, 0.0], [0.5, -0.5, 0.0], [0.5, 0.5, 0.0], [-0.5, 0.5, 0.0]];
const FACES: [[u32; 3]; 2] = [[0, 1, 2], [0, 2, 3]];

fn draw(vertices: &[[f32; 3]], faces: &[[u32; 3]], camera: &Camera, size: [usize; 2]) -> Image {
    let shape = Shape { mesh: MeshView::new(vertices, faces), colours: None, tints: None };
    raster::Prepared::new(&shape).draw(camera, size)
}

fn is_background(p: [u8; 3]) -> bool {
    // The ground is neutral; clay is clearly redder than blue, the inside bluer than red.
    p[2] >= p[0] && p[2] - p[0] < 8 && p[0] > 150
}

#[test]
fn a_square_covers_the_pixels_it_should() {
    // 2 units over 80 pixels: the unit square covers 40 x 40 pixels, to the pixel.
    let camera = Camera::towards([0.0; 3], [0.0, 0.0, 1.0], 2.0);
    let image = draw(&SQUARE, &FACES, &camera, [80, 80]);
    for y in 0..80 {
        for x in 0..80 {
            let inside = (20..60).contains(&x) && (20..60).contains(&y);
            assert_eq!(is_background(image.pixels[y * 80 + x]), !inside, "({x}, {y})");
        }
    }
}

#[test]
fn the_inside_has_another_tint_than_the_outside() {
    let size = [40, 40];
    let front = draw(&SQUARE, &FACES, &Camera::towards([0.0; 3], [0.0, 0.0, 1.0], 1.0), size);
    let back = draw(&SQUARE, &FACES, &Camera::towards([0.0; 3], [0.0, 0.0, -1.0], 1.0), size);
    let (f, b) = (front.pixels[20 * 40 + 20], back.pixels[20 * 40 + 20]);
    assert!(f[0] > f[2] + 20, "outside is clay: {f:?}");
    assert!(b[2] > b[0] + 10, "inside is slate: {b:?}");
}

#[test]
fn the_nearer_face_wins_whatever_the_order() {
    let mut vertices = SQUARE.to_vec();
    // A second square before the first, facing away: slate where it is seen.
    vertices.extend(SQUARE.map(|p| [p[0] * 0.5, p[1] * 0.5, 0.2]));
    let near = [[4, 6, 5], [4, 7, 6]];
    let camera = Camera::towards([0.0; 3], [0.0, 0.0, 1.0], 1.4);
    let first = draw(&vertices, &[near[0], near[1], FACES[0], FACES[1]], &camera, [60, 60]);
    let last = draw(&vertices, &[FACES[0], FACES[1], near[0], near[1]], &camera, [60, 60]);
    assert_eq!(first.pixels, last.pixels);
    let middle = first.pixels[30 * 60 + 30];
    assert!(middle[2] > middle[0] + 10, "{middle:?}");
}

#[test]
fn vertex_colours_are_shown() {
    let colours = [[20, 180, 30]; 4];
    let shape = Shape {
        mesh: MeshView::new(&SQUARE[..], &FACES[..]),
        colours: Some(&colours),
        tints: None,
    };
    let camera = Camera::towards([0.0; 3], [0.0, 0.0, 1.0], 1.0);
    let p = raster::Prepared::new(&shape).draw(&camera, [20, 20]).pixels[10 * 20 + 10];
    assert!(p[1] > p[0] + 60 && p[1] > p[2] + 60, "{p:?}");
}

#[test]
fn tints_colour_their_faces_on_the_outside() {
    let tints = [Some([0, 114, 178]), None];
    let shape =
        Shape { mesh: MeshView::new(&SQUARE[..], &FACES[..]), colours: None, tints: Some(&tints) };
    let scene = raster::Prepared::new(&shape);
    let image = scene.draw(&Camera::towards([0.0; 3], [0.0, 0.0, 1.0], 1.0), [20, 20]);
    // The first face is the lower right half.
    let (tinted, plain) = (image.pixels[15 * 20 + 15], image.pixels[4 * 20 + 4]);
    assert!(tinted[2] > tinted[0] + 40, "{tinted:?}");
    assert!(plain[0] > plain[2] + 20, "{plain:?}");
}

/// A list with one hole: the given rim.
fn one_hole(vertices: &[[f32; 3]], rim: Vec<u32>) -> HoleList {
    let p = |v: u32| vertices[v as usize].map(f64::from);
    let n = rim.len() as f64;
    let centre = std::array::from_fn(|k| rim.iter().map(|&v| p(v)[k]).sum::<f64>() / n);
    let diameter = 2.0 * length(sub(p(rim[0]), centre));
    let (edges, circumference) = (rim.len(), 3.1 * diameter);
    HoleList {
        loops: vec![BoundaryLoop { vertices: rim, length: circumference, diameter, centre }],
        holes: vec![Hole {
            id: 0,
            loops: vec![0],
            kind: HoleKind::Disc,
            edges,
            circumference,
            diameter,
            centre,
            problem: None,
        }],
        ..HoleList::default()
    }
}

/// The sphere without the faces around its top vertex, and the rim as a filling face runs:
/// counter-clockwise seen from outside.
fn open_sphere() -> (Vec<[f32; 3]>, Vec<[u32; 3]>, Vec<u32>) {
    let mesh = Sample::Sphere.build(40).unwrap();
    let top = mesh.vertices.len() as u32 - 1;
    let (fan, open): (Vec<[u32; 3]>, Vec<[u32; 3]>) =
        mesh.faces.iter().copied().partition(|f| f.contains(&top));
    let next = |v: u32| {
        fan.iter().find_map(|f| {
            let k = f.iter().position(|&w| w == v)?;
            (f[(k + 2) % 3] == top).then(|| f[(k + 1) % 3])
        })
    };
    let mut rim: Vec<u32> = Vec::new();
    let mut at = fan[0].iter().copied().find(|&v| v != top && next(v).is_some()).unwrap();
    while !rim.contains(&at) {
        rim.push(at);
        at = next(at).unwrap();
    }
    (mesh.vertices, open, rim)
}

#[test]
fn close_ups_look_into_the_hole() {
    // Seen from above, the inside shows before, not after.
    let (vertices, open, rim) = open_sphere();
    let mesh = Sample::Sphere.build(40).unwrap();
    let holes = one_hole(&vertices, rim);
    let before =
        Shape { mesh: MeshView::new(&mesh.vertices[..], &open[..]), colours: None, tints: None };
    let after = Shape { mesh: mesh.view(), colours: None, tints: None };
    let sheet = before_and_after(&before, &after, &holes, &[0]);
    assert_eq!(sheet.height, 2 * (VIEW[1] + GAP) + GAP);
    let y = GAP + VIEW[1] + GAP + VIEW[1] / 2;
    let left = sheet.pixels[y * sheet.width + GAP + VIEW[0] / 2];
    let right = sheet.pixels[y * sheet.width + 2 * GAP + VIEW[0] + VIEW[0] / 2];
    assert!(left[2] > left[0], "before: the inside, {left:?}");
    assert!(right[0] > right[2] + 20, "after: clay, {right:?}");
}

#[test]
fn at_most_six_close_ups_and_only_of_the_holes_asked_for() {
    let mut holes = one_hole(&SQUARE, vec![0, 3, 2, 1]);
    for id in 1..9 {
        let hole = Hole { id, ..holes.holes[0].clone() };
        holes.holes.push(hole);
    }
    let shape = Shape { mesh: MeshView::new(&SQUARE[..], &FACES[..]), colours: None, tints: None };
    let rows = |shown: &[usize]| {
        (before_and_after(&shape, &shape, &holes, shown).height - GAP) / (VIEW[1] + GAP)
    };
    assert_eq!([rows(&[]), rows(&[3]), rows(&[0, 1, 2, 3, 4, 5, 6, 7])], [1, 2, 7]);
}

#[test]
fn degenerate_meshes_are_drawn_without_trouble() {
    let points = [[0.0f32; 3]; 3];
    for faces in [&[][..], &[[0, 1, 2]][..]] {
        let shape = Shape { mesh: MeshView::new(&points[..], faces), colours: None, tints: None };
        assert!(portrait(&shape, [16, 16]).pixels.iter().all(|&p| is_background(p)));
    }
}

#[test]
fn png_can_be_read_back() {
    let mesh = Sample::Torus.build(30).unwrap();
    let image = portrait(&Shape { mesh: mesh.view(), colours: None, tints: None }, [64, 48]);
    let mut file = Vec::new();
    image.write_png(&mut file).unwrap();
    let mut reader = png::Decoder::new(std::io::Cursor::new(file)).read_info().unwrap();
    let mut back = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut back).unwrap();
    assert_eq!((info.width, info.height), (64, 48));
    assert_eq!(back, image.pixels.as_flattened());
}

#[test]
fn a_hole_behind_something_is_looked_at_from_aside() {
    // The sphere's top is open, and a plate hovers before it that is as wide as the hole.
    let (mut vertices, mut faces, rim) = open_sphere();
    let holes = one_hole(&vertices, rim.clone());
    let direction = |vertices: &[[f32; 3]], faces: &[[u32; 3]]| {
        let shape = Shape { mesh: MeshView::new(vertices, faces), colours: None, tints: None };
        let camera = aim::close_up(&raster::Prepared::new(&shape), &holes, &holes.holes[0]);
        camera.turn([0.0, 1.0, 0.0])[2]
    };
    assert!(direction(&vertices, &faces) > 0.999, "straight from above");
    let first = vertices.len() as u32;
    let radius = 0.5 * holes.holes[0].diameter as f32;
    vertices.extend(
        [[-1.2, 1.0], [1.2, 1.0], [1.2, -1.0], [-1.2, -1.0]]
            .map(|[x, z]: [f32; 2]| [1.2 * x * radius, 1.0 + 0.5 * radius, 1.5 * z * radius]),
    );
    faces.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    assert!(direction(&vertices, &faces) < 0.8, "from aside");
}
