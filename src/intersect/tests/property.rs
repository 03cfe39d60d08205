//! Properties over random triangles and meshes.

use super::exact::{expected, Corner, GridTriangle};
use crate::intersect::{
    closest_point_on_triangle, find_intersections, is_intersection_free, triangles_intersect, Aabb,
    Bvh, Soup, Triangle,
};
use glam::DVec3;
use proptest::prelude::*;

/// A corner of a small grid, where touching and coplanar cases are frequent.
fn grid_corner() -> impl Strategy<Value = Corner> {
    prop::array::uniform3(0..4i64)
}

/// Two triangles of which the second takes each corner from the first one time in four.
fn grid_pair() -> impl Strategy<Value = (GridTriangle, GridTriangle)> {
    let own = || prop::array::uniform3(grid_corner());
    let take = prop::array::uniform3(0..12usize);
    (own(), own(), take).prop_map(|(a, mut b, take)| {
        for k in 0..3 {
            if let Some(&corner) = a.get(take[k]) {
                b[k] = corner;
            }
        }
        (a, b)
    })
}

/// As `grid_pair`, squeezed into one plane z = x + 2 y.
fn coplanar_pair() -> impl Strategy<Value = (GridTriangle, GridTriangle)> {
    grid_pair().prop_map(|(a, b)| {
        let lift = |c: Corner| [c[0], c[1], c[0] + 2 * c[1]];
        (a.map(lift), b.map(lift))
    })
}

fn to_f64(t: &GridTriangle) -> Triangle {
    t.map(|c| DVec3::new(c[0] as f64, c[1] as f64, c[2] as f64))
}

/// An affine map with integer entries of about 2^20 and determinant 1: exact on the grid, keeps
/// every incidence, and makes each predicate need more than 53 bits.
fn sheared(t: &Triangle) -> Triangle {
    const A: f64 = 1_048_573.0;
    const B: f64 = 786_433.0;
    t.map(|p| {
        let q = DVec3::new(p.x + A * p.y, p.y, p.z + B * p.x);
        let q = DVec3::new(q.x, q.y + 4097.0 * q.z, q.z);
        DVec3::new(q.x + 12_345.0, q.y - 1.0, q.z + 7.0)
    })
}

/// All ways to write down the same pair.
fn variants(a: &Triangle, b: &Triangle) -> Vec<(Triangle, Triangle)> {
    let orders = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]];
    let mut all = Vec::new();
    for oa in orders {
        for ob in orders {
            let (x, y) = (oa.map(|k| a[k]), ob.map(|k| b[k]));
            all.extend([(x, y), (y, x)]);
        }
    }
    all
}

fn agrees(a: &GridTriangle, b: &GridTriangle) -> Result<(), TestCaseError> {
    let (ta, tb) = (to_f64(a), to_f64(b));
    let result = triangles_intersect(&ta, &tb);
    if let Some(want) = expected(a, b) {
        prop_assert_eq!(result, want);
        prop_assert_eq!(triangles_intersect(&sheared(&ta), &sheared(&tb)), want);
    }
    for (x, y) in variants(&ta, &tb) {
        prop_assert_eq!(triangles_intersect(&x, &y), result);
    }
    Ok(())
}

fn point() -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(-1.0..1.0f64).prop_map(DVec3::from_array)
}

/// Triangles of mixed size in the cube from -1 to 1, as a soup.
fn soup() -> impl Strategy<Value = Vec<Triangle>> {
    let one = (point(), point(), point(), 0.01..0.6f64)
        .prop_map(|(at, u, v, size)| [at, at + u * size, at + v * size]);
    prop::collection::vec(one, 0..60)
}

fn as_mesh(soup: &[Triangle]) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let faces = (0..soup.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    (soup.concat(), faces)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(20_000))]

    #[test]
    fn agrees_with_exact_clipping_in_space((a, b) in grid_pair()) {
        agrees(&a, &b)?;
    }

    #[test]
    fn agrees_with_exact_clipping_in_a_plane((a, b) in coplanar_pair()) {
        agrees(&a, &b)?;
    }
}

proptest! {
    #[test]
    fn tree_finds_the_pairs_of_brute_force(soup in soup(), cut in 0..60usize) {
        let (positions, faces) = as_mesh(&soup);
        let mut want = Vec::new();
        for f in cut..faces.len() {
            for g in (0..cut).chain(f + 1..faces.len()) {
                if triangles_intersect(&soup[f], &soup[g]) {
                    want.push([f as u32, g as u32]);
                }
            }
        }
        prop_assert_eq!(is_intersection_free(&positions, &faces, cut), want.is_empty());
        prop_assert_eq!(&find_intersections(&positions, &faces, cut), &want);
        // Part by part, down to single faces: nothing is lost or found twice at a border.
        for size in [1, 2, 7] {
            let soup = Soup { count: soup.len(), corners: |f: usize| soup[f] };
            let mut pairs = Vec::new();
            soup.any_by_parts(cut, size, &mut |pair| {
                pairs.push(pair);
                false
            });
            pairs.sort_unstable();
            prop_assert_eq!(&pairs, &want);
        }
    }

    #[test]
    fn tree_finds_the_boxes_of_brute_force(soup in soup(), p in point(), q in point()) {
        let (positions, faces) = as_mesh(&soup);
        let query = Aabb { lo: p.min(q), hi: p.max(q) };
        let mut seen = Vec::new();
        let stopped = Bvh::new(&positions, &faces).any_overlapping(&query, |f, t| {
            assert_eq!(t, &soup[f as usize]);
            seen.push(f);
            false
        });
        seen.sort_unstable();
        let want: Vec<u32> = (0..soup.len())
            .filter(|&f| Aabb::of(&soup[f]).overlaps(&query))
            .map(|f| f as u32)
            .collect();
        prop_assert!(!stopped);
        prop_assert_eq!(seen, want);
    }

    #[test]
    fn closest_point_is_that_of_brute_force(soup in soup(), p in point(), reach in 0.0..2.0f64) {
        let (positions, faces) = as_mesh(&soup);
        let distance = |t: &Triangle| closest_point_on_triangle(p, t).distance(p);
        let near = soup.iter().map(distance).fold(f64::INFINITY, f64::min);
        match Bvh::new(&positions, &faces).closest_point(p, reach) {
            Some(hit) => {
                prop_assert!(hit.distance <= reach && (hit.distance - near).abs() <= 1e-15);
                prop_assert_eq!(hit.point, closest_point_on_triangle(p, &soup[hit.face as usize]));
                prop_assert_eq!(hit.point.distance(p), hit.distance);
            }
            None => prop_assert!(near > reach),
        }
    }

    /// Against a dense sampling: the point lies on the triangle and nothing sampled is closer.
    #[test]
    fn no_sample_of_the_triangle_is_closer(p in point(), t in prop::array::uniform3(point())) {
        const N: u32 = 24;
        let hit = closest_point_on_triangle(p, &t);
        let mut nearest_sample = f64::INFINITY;
        let mut gap = f64::INFINITY;
        for i in 0..=N {
            for j in 0..=N - i {
                let (u, v) = (f64::from(i) / f64::from(N), f64::from(j) / f64::from(N));
                let sample = t[0] + (t[1] - t[0]) * u + (t[2] - t[0]) * v;
                nearest_sample = nearest_sample.min(sample.distance(p));
                gap = gap.min(sample.distance(hit));
            }
        }
        let longest = (0..3).map(|k| t[k].distance(t[(k + 1) % 3])).fold(0.0, f64::max);
        prop_assert!(hit.distance(p) <= nearest_sample + 1e-12);
        // Samples are at most a cell apart, so the hit is on the triangle.
        prop_assert!(gap <= longest / f64::from(N));
    }
}

/// Where a line meets a triangle, in whole numbers: the signs of the three volumes that the line
/// spans with the edges. `None` also for lines in the triangle's plane.
fn exact_parameter(o: Corner, d: Corner, t: &GridTriangle) -> Option<f64> {
    let sub = |a: Corner, b: Corner| [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    let dot = |a: Corner, b: Corner| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let cross = |a: Corner, b: Corner| {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    };
    let n = cross(sub(t[1], t[0]), sub(t[2], t[0]));
    let across = dot(d, n);
    let volume = |k: usize| dot(d, cross(sub(t[k], o), sub(t[(k + 1) % 3], o)));
    let v = [0, 1, 2].map(volume);
    let one_side = v.iter().all(|&x| x >= 0) || v.iter().all(|&x| x <= 0);
    (across != 0 && one_side).then(|| dot(sub(t[0], o), n) as f64 / across as f64)
}

proptest! {
    /// On a small grid, where lines along the axes run in the sides of boxes, through edges and
    /// through corners.
    #[test]
    fn a_line_meets_what_brute_force_says(
        soup in prop::collection::vec(prop::array::uniform3(grid_corner()), 1..60),
        origin in prop::array::uniform3(-1..5i64),
        direction in prop_oneof![
            prop::sample::select(
                &[[1, 0, 0], [0, 1, 0], [0, 0, 1], [-1, 0, 0], [0, -2, 0], [1, 1, 0]][..]
            ),
            prop::array::uniform3(-3..4i64),
        ],
        reach in prop::sample::select(&[0.71, 1.37, 1e9, f64::INFINITY][..]),
        third in 0..4u32,
    ) {
        prop_assume!(direction != [0; 3]);
        let triangles: Vec<Triangle> = soup.iter().map(to_f64).collect();
        let (positions, faces) = as_mesh(&triangles);
        let exact = |f: u32| exact_parameter(origin, direction, &soup[f as usize]);
        let allowed = |f: u32| third == 0 || f % 3 != third - 1;
        let near = (0..soup.len() as u32)
            .filter(|&f| allowed(f))
            .filter_map(|f| exact(f).map(f64::abs))
            .filter(|&t| t <= reach)
            .fold(f64::INFINITY, f64::min);
        let real = |c: Corner| DVec3::new(c[0] as f64, c[1] as f64, c[2] as f64);
        let tree = Bvh::new(&positions, &faces);
        let found = tree.meet_line(real(origin), real(direction), reach, |f, t| {
            assert_eq!(*t, triangles[f as usize]);
            allowed(f)
        });
        match found {
            Some((face, t)) => {
                prop_assert!(allowed(face));
                let own = exact(face);
                prop_assert!(own.is_some_and(|x| (x - t).abs() < 1e-12), "{own:?} {t}");
                prop_assert!((t.abs() - near).abs() < 1e-12, "{t} {near}");
            }
            None => prop_assert!(near == f64::INFINITY, "{near}"),
        }
    }
}
