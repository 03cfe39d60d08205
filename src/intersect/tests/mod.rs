//! Micro cases with the reason for each; `property` compares with an independent exact answer.

mod exact;
mod property;

use super::{
    closest_point_on_triangle, degenerate_faces, find_intersections, is_intersection_free,
    predicates, triangles_intersect, Bvh, Triangle,
};
use glam::{dvec3, DVec3, Vec3Swizzles};

fn triangle(a: [f64; 3], b: [f64; 3], c: [f64; 3]) -> Triangle {
    [a, b, c].map(DVec3::from_array)
}

/// The triangle most cases are about: right-angled, in z = 0.
fn floor() -> Triangle {
    triangle([0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0])
}

/// The answer for a pair, after checking that neither order nor swap matters.
fn meets(a: Triangle, b: Triangle) -> bool {
    let result = triangles_intersect(&a, &b);
    for [i, j, k] in [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]] {
        assert_eq!(triangles_intersect(&[a[i], a[j], a[k]], &b), result);
        assert_eq!(triangles_intersect(&b, &[a[i], a[j], a[k]]), result);
        assert_eq!(triangles_intersect(&a, &[b[i], b[j], b[k]]), result);
    }
    result
}

fn meets_floor(b: [[f64; 3]; 3]) -> bool {
    meets(floor(), triangle(b[0], b[1], b[2]))
}

#[test]
fn without_a_shared_vertex_any_contact_counts() {
    let cases = [
        // An edge goes through the inside.
        (true, [[1.0, 1.0, -1.0], [1.0, 1.0, 1.0], [5.0, 5.0, 1.0]]),
        // The floor's edge goes through the other's inside.
        (true, [[2.0, 0.0, -2.0], [2.0, 1.0, 2.0], [2.0, -3.0, 2.0]]),
        // Same, one grid step further away: the line of crossing misses.
        (false, [[5.0, 5.0, -1.0], [5.0, 5.0, 1.0], [6.0, 5.0, 1.0]]),
        // Parallel plane: boxes overlap in x and y only.
        (false, [[0.0, 0.0, 1.0], [4.0, 0.0, 1.0], [0.0, 4.0, 1.0]]),
        // The smallest step above the plane.
        (false, [[0.0, 0.0, 5e-324], [4.0, 0.0, 1.0], [0.0, 4.0, 1.0]]),
        // A vertex stands on the face.
        (true, [[1.0, 1.0, 0.0], [1.0, 2.0, 3.0], [2.0, 1.0, 3.0]]),
        // A vertex stands on an edge.
        (true, [[2.0, 2.0, 0.0], [2.0, 2.0, 3.0], [3.0, 3.0, 3.0]]),
        // A vertex in the plane, outside the edge by one unit in the last place.
        (false, [[2.0, 2.0 + f64::EPSILON * 2.0, 0.0], [2.0, 2.0, 3.0], [3.0, 3.0, 3.0]]),
        // Two edges cross in one point.
        (true, [[2.0, -1.0, -1.0], [2.0, 1.0, 1.0], [2.0, -3.0, 5.0]]),
        // An edge lies on part of an edge, otherwise apart.
        (true, [[1.0, 0.0, 0.0], [3.0, 0.0, 0.0], [2.0, -1.0, 1.0]]),
        // An edge lies in the face, the rest stands up.
        (true, [[1.0, 1.0, 0.0], [2.0, 1.0, 0.0], [1.0, 1.0, 2.0]]),
    ];
    for (want, b) in cases {
        assert_eq!(meets_floor(b), want, "{b:?}");
    }
}

#[test]
fn coplanar_triangles_are_compared_in_their_plane() {
    let cases = [
        // Partial overlap.
        (true, [[1.0, 1.0, 0.0], [5.0, 1.0, 0.0], [1.0, 5.0, 0.0]]),
        // Star of David: edges cross, no vertex is inside the other.
        (true, [[-1.0, 1.0, 0.0], [5.0, 1.0, 0.0], [1.0, -2.0, 0.0]]),
        // Nested, either way round.
        (true, [[1.0, 1.0, 0.0], [1.5, 1.0, 0.0], [1.0, 1.5, 0.0]]),
        (true, [[-9.0, -9.0, 0.0], [40.0, -9.0, 0.0], [-9.0, 40.0, 0.0]]),
        // Disjoint although the boxes overlap.
        (false, [[4.0, 1.0, 0.0], [4.0, 4.0, 0.0], [1.0, 4.0, 0.0]]),
        // Touching in one point, vertex on edge.
        (true, [[2.0, 2.0, 0.0], [4.0, 4.0, 0.0], [3.0, 4.0, 0.0]]),
        // Edge along edge without a common vertex, on opposite sides: they touch.
        (true, [[1.0, 3.0, 0.0], [3.0, 1.0, 0.0], [4.0, 4.0, 0.0]]),
        // The lines of two edges coincide, the edges do not.
        (false, [[5.0, 0.0, 0.0], [7.0, 0.0, 0.0], [6.0, 1.0, 0.0]]),
    ];
    for (want, b) in cases {
        assert_eq!(meets_floor(b), want, "{b:?}");
        // The same in the two other coordinate planes and in a tilted one (z = x + y is exact).
        for lift in [|p: DVec3| p.zxy(), |p: DVec3| p.yzx(), |p: DVec3| dvec3(p.x, p.y, p.x + p.y)]
        {
            let lifted = triangle(b[0], b[1], b[2]).map(lift);
            assert_eq!(meets(floor().map(lift), lifted), want, "lifted {b:?}");
        }
    }
}

#[test]
fn a_shared_vertex_alone_is_no_contact() {
    let o = [0.0, 0.0, 0.0];
    let cases = [
        // Neighbours around a vertex, in one plane and out of it.
        (false, [o, [-1.0, 3.0, 0.0], [-3.0, 1.0, 0.0]]),
        (false, [o, [-1.0, 3.0, 2.0], [-3.0, 1.0, 1.0]]),
        // Straight on across the vertex: edges on one line, on opposite rays.
        (false, [o, [-4.0, 0.0, 0.0], [0.0, -4.0, 0.0]]),
        // A spike on the vertex, above the face.
        (false, [o, [1.0, 1.0, 1.0], [1.0, 2.0, 1.0]]),
        // The opposite edge pierces the face.
        (true, [o, [1.0, 1.0, -1.0], [1.0, 1.0, 1.0]]),
        // The opposite edge of the floor is pierced.
        (true, [o, [4.0, 4.0, -1.0], [4.0, 4.0, 1.0]]),
        // The other triangle crosses the plane outside the face.
        (false, [o, [-1.0, 1.0, -1.0], [-1.0, 1.0, 1.0]]),
        // Coplanar overlap from the shared vertex on.
        (true, [o, [1.0, 1.0, 0.0], [1.0, 2.0, 0.0]]),
        (true, [o, [8.0, 1.0, 0.0], [-1.0, -4.0, 0.0]]),
        // An edge runs along an edge: the vertex id is not shared, the line is.
        (true, [o, [2.0, 0.0, 0.0], [2.0, -2.0, 0.0]]),
        (true, [o, [2.0, 0.0, 0.0], [2.0, -2.0, 5.0]]),
        // An edge runs inside the face.
        (true, [o, [1.0, 1.0, 0.0], [1.0, 1.0, 5.0]]),
        // The tip of the opposite edge stands on the face.
        (true, [o, [1.0, 2.0, 0.0], [-3.0, 2.0, 5.0]]),
        // Coplanar, wide angle, boxes overlap: only the vertex is common.
        (false, [o, [4.0, -0.5, 0.0], [-4.0, 0.4, 0.0]]),
    ];
    for (want, b) in cases {
        assert_eq!(meets_floor(b), want, "{b:?}");
    }
}

#[test]
fn a_shared_edge_counts_only_when_folded_flat() {
    let (e0, e1) = ([0.0, 0.0, 0.0], [4.0, 0.0, 0.0]);
    // Flat continuation.
    assert!(!meets_floor([e1, e0, [1.0, -3.0, 0.0]]));
    // Folded exactly onto the floor.
    assert!(meets_floor([e1, e0, [1.0, 3.0, 0.0]]));
    // Folded nearly: the smallest step off the plane is enough.
    assert!(!meets_floor([e1, e0, [1.0, 3.0, 5e-324]]));
    assert!(!meets_floor([e1, e0, [1.0, 3.0, -1e-300]]));
    // Upright.
    assert!(!meets_floor([e1, e0, [1.0, 0.0, 3.0]]));
    // In a plane that no coordinate plane is parallel to.
    let tilt = |p: DVec3| dvec3(p.x + p.y, p.x - p.y, p.x + 3.0 * p.y + p.z);
    let folded = triangle(e1, e0, [1.0, 3.0, 0.0]).map(tilt);
    assert!(meets(floor().map(tilt), folded));
    assert!(!meets(floor().map(tilt), triangle(e1, e0, [1.0, -3.0, 0.0]).map(tilt)));
    // In the plane y = 0, where two of the three views are edge-on or the edge is.
    let upright = triangle(e0, e1, [0.0, 0.0, 4.0]);
    assert!(meets(upright, triangle(e1, e0, [1.0, 0.0, 2.0])));
    assert!(!meets(upright, triangle(e1, e0, [1.0, 0.0, -2.0])));
    // A sliver without area beside the edge has no side.
    assert!(!meets_floor([e1, e0, [2.0, 0.0, 0.0]]));
}

#[test]
fn a_repeated_face_counts() {
    let [a, b, c] = floor();
    assert!(meets(floor(), [b, c, a]));
    assert!(meets(floor(), [c, b, a]));
}

#[test]
fn vertices_are_shared_by_position() {
    // Two faces on the same edge, but with their own copies of its ends: a neighbour, not a touch.
    let positions =
        [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [4.0, 0.0, -0.0], [0.0, -0.0, 0.0]];
    let mut positions: Vec<DVec3> = positions.map(DVec3::from_array).to_vec();
    positions.push(dvec3(0.0, -4.0, 1.0));
    assert!(is_intersection_free(&positions, &[[0, 1, 2], [3, 4, 5]], 1));
    // One copy off by one unit in the last place: now the corner lies on the edge and counts.
    positions[3].x = 4.0f64.next_down();
    assert_eq!(find_intersections(&positions, &[[0, 1, 2], [3, 4, 5]], 1), [[1, 0]]);
}

#[test]
fn slivers_are_decided_exactly() {
    // A needle of width 1e-12 through the floor, and the same needle one needle width beside it.
    let needle = |x: f64| triangle([x, 1.0, -1.0], [x + 1e-12, 1.0, -1.0], [x, 1.0, 1.0]);
    assert!(meets(floor(), needle(3.0 - 1e-11)));
    assert!(!meets(floor(), needle(3.0 + 1e-11)));
    // Corners that are collinear up to rounding: 0.1 * 3 is not 0.3 in f64. The segment passes the
    // edge of the sliver at a distance below 1e-16 and must be told apart.
    let sliver = triangle([0.0, 0.0, 0.0], [1.0, 0.1, 0.0], [3.0, 0.1 * 3.0, 0.0]);
    let at = |y: f64| triangle([3.0, y, -1.0], [3.0, y, 1.0], [9.0, 9.0, 1.0]);
    assert!(meets(sliver, at(0.1 * 3.0)));
    assert!(!meets(sliver, at((0.1f64 * 3.0).next_up())));
    assert!(!meets(sliver, at((0.1f64 * 3.0).next_down())));
}

#[test]
fn triangles_without_area_are_segments_and_points() {
    // A segment through the face, beside it, in its plane.
    assert!(meets_floor([[1.0, 1.0, -1.0], [1.0, 1.0, 1.0], [1.0, 1.0, 3.0]]));
    assert!(!meets_floor([[3.0, 3.0, -1.0], [3.0, 3.0, 1.0], [3.0, 3.0, 3.0]]));
    assert!(meets_floor([[-1.0, 1.0, 0.0], [1.0, 1.0, 0.0], [9.0, 1.0, 0.0]]));
    assert!(!meets_floor([[5.0, 0.0, 0.0], [3.0, 2.0, 0.0], [4.0, 1.0, 0.0]]));
    // A point on the face and above it.
    assert!(meets_floor([[1.0, 1.0, 0.0]; 3]));
    assert!(!meets_floor([[1.0, 1.0, 1.0]; 3]));
    // Hanging on a shared vertex: outside, along the inside, and through it (by convention yes).
    assert!(!meets_floor([[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, 2.0]]));
    assert!(meets_floor([[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [2.0, 2.0, 0.0]]));
    assert!(meets_floor([[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]));
    // A repeated corner: the spike on the shared vertex, and the shared edge itself.
    assert!(!meets_floor([[0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 2.0]]));
    assert!(meets_floor([[0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [1.0, 1.0, 0.0]]));
    assert!(!meets_floor([[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [4.0, 0.0, 0.0]]));
    assert!(!meets_floor([[0.0, 0.0, 0.0]; 3]));
    // Two segments: crossing, skew, on one line with and without contact.
    let segment = |a, b| triangle(a, b, b);
    let bar = segment([0.0, 0.0, 0.0], [4.0, 0.0, 0.0]);
    assert!(meets(bar, segment([1.0, -1.0, 0.0], [1.0, 1.0, 0.0])));
    assert!(!meets(bar, segment([1.0, -1.0, 1.0], [1.0, 1.0, 1.0])));
    assert!(meets(bar, segment([3.0, 0.0, 0.0], [9.0, 0.0, 0.0])));
    assert!(!meets(bar, segment([5.0, 0.0, 0.0], [9.0, 0.0, 0.0])));
    assert!(!meets(bar, segment([0.0, 1.0, 0.0], [4.0, 1.0, 0.0])));
}

#[test]
fn not_finite_coordinates_do_not_panic() {
    for bad in [f64::NAN, f64::INFINITY, 1e308, -1e308] {
        let b = triangle([bad, 1.0, 1.0], [1.0, bad, 2.0], [0.5, 1.0, -bad]);
        triangles_intersect(&floor(), &b);
        triangles_intersect(&b, &b);
        let positions = [floor(), b].concat();
        let faces = [[0, 1, 2], [3, 4, 5]];
        find_intersections(&positions, &faces, 0);
        Bvh::new(&positions, &faces).closest_point(dvec3(1.0, 2.0, 3.0), f64::INFINITY);
    }
}

#[test]
fn only_pairs_with_the_fill_are_looked_at() {
    // Three walls through each other's middle, no common vertex.
    let walls = [
        triangle([-2.0, -1.0, 0.0], [2.0, -1.0, 0.0], [0.0, 3.0, 0.0]),
        triangle([0.0, -2.0, -1.0], [0.0, 2.0, -1.0], [0.0, 0.0, 3.0]),
        triangle([-1.0, 0.0, -2.0], [-1.0, 0.0, 2.0], [3.0, 0.0, 0.0]),
    ];
    let positions = walls.concat();
    let faces = [[0, 1, 2], [3, 4, 5], [6, 7, 8]];
    assert_eq!(find_intersections(&positions, &faces, 0), [[0, 1], [0, 2], [1, 2]]);
    assert_eq!(find_intersections(&positions, &faces, 1), [[1, 0], [1, 2], [2, 0]]);
    assert_eq!(find_intersections(&positions, &faces, 2), [[2, 0], [2, 1]]);
    assert!(!is_intersection_free(&positions, &faces, 2));
    // No fill, and a start beyond the end.
    assert!(is_intersection_free(&positions, &faces, 3));
    assert!(is_intersection_free(&positions, &faces, 4));
    assert!(find_intersections(&[], &[], 0).is_empty());
}

#[test]
fn degenerate_faces_are_told_by_height_over_length() {
    let positions: Vec<DVec3> = [
        [0.0, 0.0, 0.0],
        [2.0, 0.0, 0.0],
        [1.0, 1.9e-12, 0.0], // height over longest edge 0.95e-12: no area
        [1.0, 2.1e-12, 0.0], // 1.05e-12: area
        [1.0, 0.0, 0.0],     // on the edge
        [f64::NAN, 0.0, 0.0],
        [f64::INFINITY, 1.0, 0.0],
        [1.0, 1.0, 0.0],
    ]
    .map(DVec3::from_array)
    .to_vec();
    let faces: Vec<[u32; 3]> = vec![
        [0, 1, 4],
        [0, 1, 7],
        [0, 1, 2],
        [2, 0, 1],
        [0, 1, 3],
        [0, 1, 4],
        [0, 0, 1],
        [7, 7, 7],
    ]
    .into_iter()
    .chain([[0, 1, 5], [0, 1, 6]])
    .collect();
    // The first face has no area either, but is not asked for.
    assert_eq!(degenerate_faces(&positions, &faces, 1), [2, 3, 5, 6, 7, 8, 9]);
    assert!(degenerate_faces(&positions, &faces, 11).is_empty());
    // The scale of the model does not matter.
    let tiny: Vec<DVec3> = positions.iter().map(|p| p * 1e-30).collect();
    assert_eq!(degenerate_faces(&tiny, &faces, 1), [2, 3, 5, 6, 7, 8, 9]);
}

#[test]
fn predicates_have_the_documented_signs() {
    let [a, b, c] = floor();
    // From below, the counterclockwise floor turns clockwise.
    assert!(predicates::orient3d(a, b, c, dvec3(0.0, 0.0, -1.0)) > 0.0);
    assert!(predicates::orient3d(a, b, c, dvec3(0.0, 0.0, 1.0)) < 0.0);
    assert_eq!(predicates::orient3d(a, b, c, dvec3(9.0, 9.0, 0.0)), 0.0);
    assert!(predicates::orient2d(2, a, b, c) > 0.0);
    assert_eq!(predicates::orient2d(0, a, b, c), 0.0);
    // Dropping y keeps (z, x): the corner order z then x is a left turn.
    let (z, x) = (dvec3(0.0, 5.0, 1.0), dvec3(1.0, -5.0, 0.0));
    assert!(predicates::orient2d(1, DVec3::ZERO, z, x) > 0.0);
    // A difference of one unit in the last place beside a large coordinate.
    let far = DVec3::splat(1e6);
    let up = dvec3(0.0, 0.0, (1e6f64.next_up()) - 1e6);
    let (p, q) = (far + DVec3::X, far + DVec3::Y);
    assert_eq!(predicates::side_of_plane(far, p, q, far + dvec3(0.3, 0.3, 0.0) + up), -1);
    assert_eq!(predicates::side_of_plane(far, p, q, far + dvec3(0.3, 0.3, 0.0)), 0);
}

#[test]
fn closest_point_covers_face_edges_and_corners() {
    let cases = [
        ([1.0, 1.0, 5.0], [1.0, 1.0, 0.0]),   // inside
        ([2.0, -3.0, 4.0], [2.0, 0.0, 0.0]),  // edge
        ([4.0, 4.0, 1.0], [2.0, 2.0, 0.0]),   // slanted edge
        ([-1.0, -2.0, 3.0], [0.0, 0.0, 0.0]), // corner
        ([9.0, 1.0, 0.0], [4.0, 0.0, 0.0]),   // corner, beyond the slanted edge
    ];
    for (p, want) in cases {
        let hit = closest_point_on_triangle(DVec3::from_array(p), &floor());
        assert_eq!(hit, DVec3::from_array(want), "{p:?}");
    }
    // Without area: the nearest point of the segment.
    let bar = triangle([0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [1.0, 0.0, 0.0]);
    assert_eq!(closest_point_on_triangle(dvec3(3.0, 1.0, 0.0), &bar), dvec3(3.0, 0.0, 0.0));
}

#[test]
fn closest_face_respects_reach_and_settles_ties_by_index() {
    let positions = [floor(), floor().map(|p| p + DVec3::Z * 2.0), floor()].concat();
    let faces = [[3, 4, 5], [0, 1, 2], [6, 7, 8]];
    let tree = Bvh::new(&positions, &faces);
    let between = dvec3(1.0, 1.0, 1.0);
    let hit = tree.closest_point(between, f64::INFINITY).expect("there are faces");
    assert_eq!((hit.face, hit.point, hit.distance), (0, dvec3(1.0, 1.0, 2.0), 1.0));
    let low = tree.closest_point(dvec3(1.0, 1.0, 0.5), 0.5).expect("exactly at the reach");
    assert_eq!((low.face, low.distance), (1, 0.5));
    assert_eq!(tree.closest_point(dvec3(1.0, 1.0, 0.5), 0.499), None);
    assert_eq!(tree.closest_point(between, f64::NAN), None);
    assert_eq!(tree.closest_point(dvec3(f64::NAN, 0.0, 0.0), 9.0), None);
    assert_eq!(Bvh::new(&[], &[]).closest_point(between, f64::INFINITY), None);
}
