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
    let shape = Shape::plain(MeshView::new(vertices, faces));
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
    let plain = Shape::plain(MeshView::new(&SQUARE[..], &FACES[..]));
    let shape = Shape { colours: Some(&colours), ..plain };
    let camera = Camera::towards([0.0; 3], [0.0, 0.0, 1.0], 1.0);
    let p = raster::Prepared::new(&shape).draw(&camera, [20, 20]).pixels[10 * 20 + 10];
    assert!(p[1] > p[0] + 60 && p[1] > p[2] + 60, "{p:?}");
}

#[test]
fn tints_colour_their_faces_on_the_outside() {
    let tints = [Some([0, 114, 178]), None];
    let plain = Shape::plain(MeshView::new(&SQUARE[..], &FACES[..]));
    let shape = Shape { tints: Some(&tints), ..plain };
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
    let before = Shape::plain(MeshView::new(&mesh.vertices[..], &open[..]));
    let after = Shape::plain(mesh.view());
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
    let shape = Shape::plain(MeshView::new(&SQUARE[..], &FACES[..]));
    let rows = |shown: &[usize]| {
        (before_and_after(&shape, &shape, &holes, shown).height - GAP) / (VIEW[1] + GAP)
    };
    assert_eq!([rows(&[]), rows(&[3]), rows(&[0, 1, 2, 3, 4, 5, 6, 7])], [1, 2, 7]);
}

#[test]
fn degenerate_meshes_are_drawn_without_trouble() {
    let points = [[0.0f32; 3]; 3];
    for faces in [&[][..], &[[0, 1, 2]][..]] {
        let shape = Shape::plain(MeshView::new(&points[..], faces));
        assert!(portrait(&shape, [16, 16]).pixels.iter().all(|&p| is_background(p)));
    }
}

#[test]
fn png_can_be_read_back() {
    let mesh = Sample::Torus.build(30).unwrap();
    let image = portrait(&Shape::plain(mesh.view()), [64, 48]);
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
        let shape = Shape::plain(MeshView::new(vertices, faces));
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

/// Four colours: red and green above, blue and white below.
fn four_colours(size: usize) -> Image {
    let mut image = Image::new(2 * size, 2 * size, [255; 3]);
    image.paste(&Image::new(size, size, [255, 0, 0]), 0, 0);
    image.paste(&Image::new(size, size, [0, 255, 0]), size, 0);
    image.paste(&Image::new(size, size, [0, 0, 255]), 0, size);
    image
}

/// The square with an image, whose corners have these texture coordinates, 40 pixels a side.
fn textured(image: Image, uv: [[f64; 2]; 4]) -> Image {
    let textures = [Texture::new(image).unwrap()];
    let of = |f: [u32; 3]| Paint::Image { image: 0, corners: f.map(|v| uv[v as usize]) };
    let skin = Skin { textures: &textures, paints: FACES.map(of).to_vec() };
    let mesh = MeshView::new(&SQUARE[..], &FACES[..]);
    // Colours of the vertices do not shine through.
    let colours = [[120, 0, 120]; 4];
    let shape = Shape { skin: Some(&skin), colours: Some(&colours), ..Shape::plain(mesh) };
    let camera = Camera::towards([0.0; 3], [0.0, 0.0, 1.0], 1.0);
    raster::Prepared::new(&shape).draw(&camera, [40, 40])
}

const UNIT: [[f64; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];

/// The strongest channels of a pixel, within a tenth: red is 1, green 2, blue 4.
fn hue(p: [u8; 3]) -> u8 {
    let most = *p.iter().max().unwrap();
    (0..3).map(|k| if 10 * u32::from(p[k]) > 8 * u32::from(most) { 1 << k } else { 0 }).sum()
}

fn quadrants(image: &Image) -> [u8; 4] {
    [(10, 10), (30, 10), (10, 30), (30, 30)].map(|(x, y)| hue(image.pixels[y * 40 + x]))
}

#[test]
fn images_lie_where_the_coordinates_say() {
    for size in [1, 8, 512] {
        let upright = textured(four_colours(size), UNIT);
        assert_eq!(quadrants(&upright), [1, 2, 4, 7], "{size}");
        // A quarter turn, and somewhere among the repetitions.
        let turned = UNIT.map(|[u, v]| [v - 7.0, 4.0 - u]);
        assert_eq!(quadrants(&textured(four_colours(size), turned)), [2, 7, 1, 4], "{size}");
    }
    // Twice in each direction: every quadrant has all four.
    let twice = textured(four_colours(8), UNIT.map(|p| p.map(|x| 2.0 * x)));
    let at = |x: usize, y: usize| hue(twice.pixels[y * 40 + x]);
    for (x, y) in [(0, 0), (20, 0), (0, 20), (20, 20)] {
        assert_eq!([at(x + 5, y + 5), at(x + 15, y + 5), at(x + 5, y + 15)], [1, 2, 4]);
    }
}

/// In perspective the image's middle is where the square's middle is.
#[test]
fn images_are_seen_in_perspective() {
    let textures = [Texture::new(four_colours(64)).unwrap()];
    let of = |f: [u32; 3]| Paint::Image { image: 0, corners: f.map(|v| UNIT[v as usize]) };
    let skin = Skin { textures: &textures, paints: FACES.map(of).to_vec() };
    let mesh = MeshView::new(&SQUARE[..], &FACES[..]);
    let shape = Shape { skin: Some(&skin), ..Shape::plain(mesh) };
    let camera = Camera::towards([0.0; 3], [0.0, -0.9, 0.5], 1.2);
    let image = raster::Prepared::new(&shape).draw(&camera, [200, 200]);
    let hues: Vec<u8> = (0..200).map(|y| hue(image.pixels[y * 200 + 80])).collect();
    let border = (1..200).find(|&y| hues[y - 1] == 1 && hues[y] == 4).expect("red above blue");
    let [_, middle, _] = camera.project([0.0; 3], [200, 200]).unwrap();
    assert!((border as f64 - middle).abs() < 2.0, "{border}, {middle}");
}

/// A board of single black and white texels, far finer than the pixels, is an even grey: half the light,
/// not noise.
#[test]
fn fine_images_are_averaged_in_linear_light() {
    let mut board = Image::new(1024, 1024, [0; 3]);
    for (i, p) in board.pixels.iter_mut().enumerate() {
        *p = [255 * ((i / 1024 + i) % 2) as u8; 3];
    }
    let fine = textured(board, UNIT);
    // What sRGB calls half of the light.
    let even = textured(Image::new(1, 1, [188; 3]), UNIT);
    for (a, b) in fine.pixels.iter().zip(&even.pixels) {
        assert!((0..3).all(|k| a[k].abs_diff(b[k]) <= 3), "{a:?} {b:?}");
    }
    assert!(Texture::new(Image::new(0, 0, [0; 3])).is_none());
}

#[test]
fn images_of_any_depth_are_read() {
    let encode = |colour, depth, data: &[u8]| {
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(&mut file, 2, 1);
        encoder.set_color(colour);
        encoder.set_depth(depth);
        encoder.write_header().unwrap().write_image_data(data).unwrap();
        Image::decode(&file).unwrap().pixels
    };
    use png::{BitDepth::*, ColorType::*};
    assert_eq!(encode(Grayscale, One, &[0b0100_0000]), [[0; 3], [255; 3]]);
    assert_eq!(encode(GrayscaleAlpha, Eight, &[7, 0, 9, 255]), [[7; 3], [9; 3]]);
    assert_eq!(encode(Rgba, Eight, &[1, 2, 3, 0, 4, 5, 6, 255]), [[1, 2, 3], [4, 5, 6]]);
    let sixteen = [1, 0, 2, 0, 3, 0, 4, 0, 5, 0, 6, 0];
    assert_eq!(encode(Rgb, Sixteen, &sixteen), [[1, 2, 3], [4, 5, 6]]);
}

/// A header that claims more than there is, or than is sensible, is an error, not a crash.
#[test]
fn broken_images_are_errors() {
    let mut file = Vec::new();
    Image::new(64, 64, [9; 3]).write_png(&mut file).unwrap();
    for end in [0, 3, 8, 20, 33, file.len() / 2] {
        assert!(Image::decode(&file[..end]).is_err(), "{end}");
    }
    let jpeg = [0xff, 0xd8, 0xff, 0xe0, 0, 16, b'J', b'F', b'I', b'F', 0];
    assert!(Image::decode(&jpeg).is_err());
    let mut large = Vec::new();
    let mut writer = png::Encoder::new(&mut large, 70_000, 70_000).write_header().unwrap();
    writer.write_chunk(png::chunk::IDAT, &[0]).unwrap();
    drop(writer);
    let error = Image::decode(&large).unwrap_err().to_string();
    assert!(error.contains("70000"), "{error}");
}
