//! Holes found, measured, grouped, selected; and what cannot be filled, named.

use crate::checker::{check, components, euler, filled_rims};
use crate::meshes::{flat, sheet, tetrahedron_without_floor, tube, within, Mesh};
use complete_mesh::{
    complete_mesh, find_holes, Completion, Error, Grouping, HoleKind, HoleList, HoleStatus,
    Monitor, Options, Problem, Result, Selection,
};
use std::f64::consts::PI;

fn list_as(mesh: &Mesh, grouping: &Grouping) -> HoleList {
    find_holes(mesh.view(), grouping, &Monitor::silent()).unwrap()
}

fn list(mesh: &Mesh) -> HoleList {
    list_as(mesh, &Grouping::Automatic)
}

fn fill(mesh: &Mesh, options: &Options) -> Result<Completion> {
    complete_mesh(&mesh.vertices[..], &mesh.faces[..], options)
}

/// Fills and checks; the whole mesh's faces.
fn whole(mesh: &Mesh, options: &Options) -> Vec<[u32; 3]> {
    let made = fill(mesh, options).unwrap();
    let rims = filled_rims(&made, &list_as(mesh, &options.grouping));
    check(&mesh.vertices, &mesh.faces, &made, &rims).unwrap()
}

fn but_border() -> Options {
    Options { selection: Selection::AllButLargest, ..Options::default() }
}

/// All but the hole of vertex 0, where a gap and its island together are longer than the border.
fn but_first(mesh: &Mesh) -> Options {
    let ids = (1..list(mesh).holes.len()).collect();
    Options { selection: Selection::Ids(ids), ..Options::default() }
}

#[test]
fn tetrahedron_gets_its_floor_back() {
    // The smallest hole there is: three edges, and nothing outside them to learn from.
    let mesh = tetrahedron_without_floor();
    let found = list(&mesh);
    assert_eq!(found.loops[0].vertices, [0, 2, 1]);
    assert!((found.loops[0].length - 2.0 - 2f64.sqrt()).abs() < 1e-12);
    assert!((found.loops[0].diameter - 2f64.sqrt()).abs() < 1e-12);
    let all = whole(&mesh, &Options::default());
    assert_eq!((euler(&all), components(&all)), (2, 1));
}

#[test]
fn open_sheet_has_one_loop_and_is_left_as_it_is() {
    let mesh = sheet((1, 1), flat, |_, _| true);
    let found = list(&mesh);
    assert_eq!((found.holes.len(), found.holes[0].edges), (1, 4));
    assert_eq!((found.holes[0].circumference, found.holes[0].kind), (4.0, HoleKind::Disc));
    let made = fill(&mesh, &but_border()).unwrap();
    assert!(made.faces.is_empty() && made.vertices.is_empty());
    assert_eq!(made.holes[0].status, HoleStatus::NotSelected);
    // Asked to close it all the same: a second sheet on the first one would be a bad mesh.
    match fill(&mesh, &Options::default()) {
        Err(error) => assert!(matches!(error, Error::HoleFailed { hole: 0, .. }), "{error}"),
        Ok(_) => assert_eq!(euler(&whole(&mesh, &Options::default())), 2),
    }
}

#[test]
fn closed_mesh_has_no_hole() {
    let mut mesh = tetrahedron_without_floor();
    mesh.faces.push([0, 2, 1]);
    assert!(list(&mesh).holes.is_empty());
    assert!(fill(&mesh, &Options::default()).unwrap().faces.is_empty());
}

#[test]
fn loops_touching_in_a_vertex_are_named_and_the_rest_filled() {
    // Two missing cells share the corner (3, 3); a third one stands alone.
    let mesh = sheet((10, 10), flat, |i, j| !matches!((i, j), (2, 2) | (3, 3) | (7, 7)));
    let corner = mesh.at([3.0, 3.0, 0.0]);
    let error = fill(&mesh, &but_border()).unwrap_err();
    let problem = Problem::TouchingLoops { vertices: vec![corner] };
    assert!(matches!(&error, Error::UnsafeHole { problem: p, .. } if *p == problem), "{error}");
    assert!(error.to_string().contains(&format!("vertex {corner}")), "{error}");
    let made = fill(&mesh, &Options { skip_unsafe: true, ..but_border() }).unwrap();
    let filled = made.holes.iter().filter(|h| h.status == HoleStatus::Filled).count();
    let left = made.holes.iter().filter(|h| h.status == HoleStatus::Unsafe(problem.clone()));
    assert!(filled == 1 && left.count() >= 1, "{:?}", made.holes);
    check(&mesh.vertices, &mesh.faces, &made, &filled_rims(&made, &list(&mesh))).unwrap();
}

#[test]
fn non_manifold_edge_at_the_rim_is_named() {
    // A fin stands on an inner edge that ends at the hole.
    let mut mesh = sheet((9, 9), flat, |i, j| !within(i, j, 4, 6));
    let (a, b) = (mesh.at([4.0, 5.0, 0.0]), mesh.at([3.0, 5.0, 0.0]));
    mesh.vertices.push([3.5, 5.0, 1.0]);
    mesh.faces.push([a, b, mesh.vertices.len() as u32 - 1]);
    let edge = [a.min(b), a.max(b)];
    assert_eq!(list(&mesh).non_manifold_edges, [edge]);
    let options =
        Options { selection: Selection::NearPoint([5.0, 5.0, 0.0]), ..Options::default() };
    let error = fill(&mesh, &options).unwrap_err();
    assert!(
        matches!(&error, Error::UnsafeHole { problem: Problem::NonManifoldEdge { edges }, .. }
            if *edges == [edge]),
        "{error}"
    );
}

#[test]
fn flipped_face_at_the_rim_is_named() {
    let mut mesh = sheet((9, 9), flat, |i, j| !within(i, j, 4, 6));
    // The lower face of the cell left of the hole: its right edge is on the rim.
    let face = [[3.0, 4.0, 0.0], [4.0, 4.0, 0.0], [4.0, 5.0, 0.0]].map(|p| mesh.at(p));
    let f = mesh.faces.iter().position(|g| *g == face).unwrap();
    mesh.faces[f].swap(0, 1);
    let mut expected = [[face[0], face[1]], [face[0], face[2]]];
    expected.iter_mut().for_each(|e| e.sort_unstable());
    expected.sort_unstable();
    assert_eq!(list(&mesh).inconsistent_edges, expected);
    let error = fill(&mesh, &but_border()).unwrap_err();
    let Error::UnsafeHole { problem: Problem::InconsistentOrientation { edges }, .. } = &error
    else {
        panic!("{error}")
    };
    assert!(edges.iter().all(|e| expected.contains(e)) && !edges.is_empty(), "{edges:?}");
}

#[test]
fn unwelded_and_degenerate_elements_are_reported_and_passed_through() {
    // Two sheets side by side, not welded: three pairs at the same places.
    let mut mesh = sheet((2, 2), flat, |_, _| true);
    let second = sheet((2, 2), |x, y| [x + 2.0, y, 0.0], |_, _| true);
    let first = mesh.vertices.len() as u32;
    mesh.vertices.extend(&second.vertices);
    mesh.faces.extend(second.faces.iter().map(|f| f.map(|v| v + first)));
    mesh.faces.push([0, 0, 1]);
    let found = list(&mesh);
    // On the border where x = 2: vertices 2, 5, 8 of the first, 0, 3, 6 of the second.
    let mut pairs = found.duplicate_boundary_vertices.clone();
    pairs.sort_unstable();
    assert_eq!(pairs, [[2, first], [5, first + 3], [8, first + 6]]);
    assert_eq!(found.degenerate_faces, [mesh.faces.len() as u32 - 1]);
    assert_eq!(found.loops.len(), 2);
    let made = fill(&mesh, &Options { selection: Selection::Ids(vec![]), ..Options::default() });
    let (_, faces) = made.unwrap().to_mesh_f64(&mesh.vertices, &mesh.faces);
    assert_eq!(faces, mesh.faces);
}

#[test]
fn arrays_that_make_no_mesh_are_errors() {
    let good = tetrahedron_without_floor();
    let error = |change: &dyn Fn(&mut Mesh)| {
        let mut mesh = good.clone();
        change(&mut mesh);
        fill(&mesh, &Options::default()).unwrap_err()
    };
    assert_eq!(error(&|m| m.faces.clear()), Error::Empty);
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        assert_eq!(error(&|m| m.vertices[2][1] = bad), Error::NonFinite { vertex: 2 });
    }
    assert_eq!(
        error(&|m| m.faces[1][2] = 4),
        Error::IndexOutOfRange { face: 1, index: 4, vertex_count: 4 }
    );
    assert_eq!(
        error(&|m| m.faces[0][0] = u32::MAX),
        Error::IndexOutOfRange { face: 0, index: u32::MAX as usize, vertex_count: 4 }
    );
}

/// Which holes there are, as the places of one vertex of each of their loops.
fn grouped(mesh: &Mesh, at: &[[f64; 2]]) -> Vec<Vec<usize>> {
    let found = list(mesh);
    let marks: Vec<u32> = at.iter().map(|p| mesh.at([p[0], p[1], 0.0])).collect();
    let name = |l: usize| marks.iter().position(|m| found.loops[l].vertices.contains(m));
    let mut holes: Vec<Vec<usize>> = found
        .holes
        .iter()
        .map(|h| {
            let mut names: Vec<usize> = h.loops.iter().filter_map(|&l| name(l)).collect();
            names.sort_unstable();
            names
        })
        .filter(|names| !names.is_empty())
        .collect();
    holes.sort();
    holes
}

#[test]
fn island_with_a_hole_of_its_own() {
    // Border, gap, island, and in the island a hole that has nothing to do with the gap.
    let mesh = sheet((16, 16), flat, |i, j| {
        !within(i, j, 2, 14) || (within(i, j, 5, 11) && !within(i, j, 7, 9))
    });
    let marks = [[0.0, 0.0], [2.0, 2.0], [5.0, 5.0], [7.0, 7.0]];
    assert_eq!(grouped(&mesh, &marks), [vec![0], vec![1, 2], vec![3]]);
    let all = whole(&mesh, &but_first(&mesh));
    assert_eq!((components(&all), euler(&all)), (1, 1));
}

#[test]
fn nested_islands() {
    // Gap, island, gap in the island, island in that: two holes of two loops each.
    let mesh = sheet((30, 30), flat, |i, j| {
        !within(i, j, 4, 26)
            || (within(i, j, 10, 20) && !within(i, j, 12, 18))
            || within(i, j, 14, 16)
    });
    let marks = [[0.0, 0.0], [4.0, 4.0], [10.0, 10.0], [12.0, 12.0], [14.0, 14.0]];
    assert_eq!(grouped(&mesh, &marks), [vec![0], vec![1, 2], vec![3, 4]]);
    let kinds: Vec<HoleKind> =
        list(&mesh).holes.iter().filter(|h| h.loops.len() == 2).map(|h| h.kind).collect();
    assert_eq!(kinds, [HoleKind::Islands, HoleKind::Islands]);
    let all = whole(&mesh, &but_first(&mesh));
    assert_eq!((components(&all), euler(&all)), (1, 1));
}

#[test]
fn near_holes_stay_apart() {
    // One column of cells between two holes of 3 × 3: nearer to each other than they are wide.
    let mesh = sheet((13, 9), flat, |i, j| {
        !((3..6).contains(&j) && ((3..6).contains(&i) || (7..10).contains(&i)))
    });
    assert_eq!(grouped(&mesh, &[[0.0, 0.0], [3.0, 3.0], [7.0, 3.0]]), [[0], [1], [2]]);
    let all = whole(&mesh, &but_border());
    assert_eq!((components(&all), euler(&all)), (1, 1));
}

#[test]
fn band_is_bridged_and_far_ends_are_not_joined() {
    let place = |r: usize, angle: f64| [angle.cos(), angle.sin(), 0.3 * r as f64];
    // An open tube shorter than wide: its ends look away from each other.
    let short = tube(24, 4, place, |_, _| true);
    assert_eq!(list(&short).holes.len(), 2);
    // Two tubes with a band missing between them.
    let mesh = tube(24, 16, place, |r, _| !(7..9).contains(&r));
    let found = list(&mesh);
    let kinds: Vec<HoleKind> = found.holes.iter().map(|h| h.kind).collect();
    assert_eq!(kinds, [HoleKind::Disc, HoleKind::Ring, HoleKind::Disc]);
    let options = Options { selection: Selection::Ids(vec![1]), ..Options::default() };
    let all = whole(&mesh, &options);
    assert_eq!((components(&all), euler(&all)), (1, 0));
    // Told to keep them apart: two capped tubes.
    let apart = Options { grouping: Grouping::Separate, ..Options::default() };
    assert_eq!(list_as(&mesh, &apart.grouping).holes.len(), 4);
    let all = whole(&mesh, &apart);
    assert_eq!((components(&all), euler(&all)), (2, 4));
}

#[test]
fn loops_are_joined_by_name() {
    // Two tubes of different width, one above the other; the caller joins what he likes.
    let mesh = tube(24, 8, |r, a| [a.cos(), a.sin(), 0.3 * r as f64], |r, _| r != 3 && r != 4);
    // Row 4 is gone altogether.
    let (low, high) = (3 * 24, 4 * 24);
    let joined = list_as(&mesh, &Grouping::Join(vec![vec![low + 1, high + 5]]));
    assert_eq!(joined.holes.len(), 3);
    let hole = joined.holes.iter().find(|h| h.loops.len() == 2).unwrap();
    assert!([low, high]
        .iter()
        .all(|v| hole.loops.iter().any(|&l| joined.loops[l].vertices.contains(v))));
    let inner = 24 + 1;
    let error =
        find_holes(mesh.view(), &Grouping::Join(vec![vec![low, inner]]), &Monitor::silent());
    assert!(matches!(error, Err(Error::InvalidOption { name: "grouping", .. })));
}

#[test]
fn loops_are_measured() {
    for n in [6usize, 7, 100] {
        // A flat ring around a regular n-gon of radius 2, centred at (5, 6, 7).
        let place = |r: usize, a: f64| {
            let radius = 4.0 - 2.0 * r as f64;
            [5.0 + radius * a.cos(), 6.0 + radius * a.sin(), 7.0]
        };
        let mesh = tube(n, 1, place, |_, _| true);
        let found = list(&mesh);
        assert_eq!(found.holes.len(), 2, "{n}");
        let inner = found.loops.iter().find(|l| l.vertices[0] as usize == n).unwrap();
        assert_eq!(inner.vertices.len(), n);
        let step = PI / n as f64;
        assert!((inner.length - 4.0 * n as f64 * step.sin()).abs() < 1e-9, "{n}");
        // The farthest pair: opposite corners, or the two beside the opposite edge.
        let diameter = if n % 2 == 0 { 4.0 } else { 4.0 * (step / 2.0).cos() };
        assert!((inner.diameter - diameter).abs() < 1e-9, "{n}: {}", inner.diameter);
        for (c, exact) in inner.centre.iter().zip([5.0, 6.0, 7.0]) {
            assert!((c - exact).abs() < 1e-9, "{n}");
        }
    }
}

#[test]
fn selections_choose() {
    // Border 40 long, holes of 4, 8 and 12 edges.
    let mesh = sheet((12, 8), flat, |i, j| {
        !((i, j) == (1, 1)
            || ((4..6).contains(&i) && (3..5).contains(&j))
            || ((8..11).contains(&i) && (2..5).contains(&j)))
    });
    let found = list(&mesh);
    let id = |edges: usize| found.holes.iter().find(|h| h.edges == edges).unwrap().id;
    let (border, small, middle, large) = (id(40), id(4), id(8), id(12));
    let chosen = |selection| -> Vec<usize> {
        let made = fill(&mesh, &Options { selection, ..Options::default() }).unwrap();
        let rims = filled_rims(&made, &found);
        check(&mesh.vertices, &mesh.faces, &made, &rims).unwrap();
        let filled = made.holes.iter().filter(|h| h.status == HoleStatus::Filled);
        filled.map(|h| h.hole).collect()
    };
    let sorted = |mut ids: Vec<usize>| {
        ids.sort_unstable();
        ids
    };
    assert_eq!(border, 0);
    assert_eq!(chosen(Selection::AllButLargest), sorted(vec![small, middle, large]));
    assert_eq!(chosen(Selection::Ids(vec![large])), [large]);
    assert_eq!(chosen(Selection::Ids(vec![])), [0; 0]);
    assert_eq!(chosen(Selection::MaxEdges(8)), sorted(vec![small, middle]));
    assert_eq!(chosen(Selection::MaxEdges(3)), [0; 0]);
    assert_eq!(chosen(Selection::MaxCircumference(4.0)), [small]);
    // The middle one is 2√2 across, the large one 3√2.
    assert_eq!(chosen(Selection::MaxDiameter(2.9)), sorted(vec![small, middle]));
    assert_eq!(chosen(Selection::NearPoint([5.0, 4.2, 1.0])), [middle]);
    let on = |p: [f64; 3]| mesh.at(p);
    assert_eq!(
        chosen(Selection::NearVertices(vec![on([1.0, 1.0, 0.0]), on([8.0, 2.0, 0.0])])),
        sorted(vec![small, large])
    );
    // On no rim: (7, 4) lies one from the large hole and one from the middle; (3, 3) is nearer.
    assert_eq!(chosen(Selection::NearVertices(vec![on([3.0, 4.0, 0.0])])), [middle]);
    let error = |selection| fill(&mesh, &Options { selection, ..Options::default() }).unwrap_err();
    assert_eq!(error(Selection::Ids(vec![4])), Error::NoSuchHole { hole: 4, count: 4 });
    for bad in [
        Selection::NearVertices(vec![999]),
        Selection::MaxDiameter(f64::NAN),
        Selection::MaxCircumference(0.0),
        Selection::NearPoint([f64::NAN, 0.0, 0.0]),
    ] {
        assert!(matches!(error(bad), Error::InvalidOption { name: "selection", .. }));
    }
}
