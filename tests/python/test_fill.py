"""The contract, and that each option arrives."""

import numpy as np
import pytest
from complete_mesh import Completer, complete_mesh, list_holes
from conftest import same
from meshes import WINDOWS, boundary_edges, column_radius, octahedron, positions, read_ply, write_ply


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("method", ["coherent", "smooth", "harary", "fragment", "warp"])
def test_input_comes_first_and_the_fill_closes_it(broken, dtype, method):
    vertices, faces = broken[0].astype(dtype), broken[1]
    result = complete_mesh(vertices, faces, method=method)
    n, m = len(vertices), len(faces)
    assert same(result.vertices[:n], vertices) and same(result.faces[:m], faces)
    assert same(result.vertices[n:], result.new_vertices)
    assert same(result.faces[m:], result.new_faces)
    assert len(boundary_edges(faces)) > 0 and len(boundary_edges(result.faces)) == 0
    assert result.filled_count == 2 and [h.status for h in result.holes] == ["filled"] * 2


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_fill_lies_where_the_column_was(broken, dtype):
    result = complete_mesh(broken[0].astype(dtype), broken[1])
    smooth = complete_mesh(broken[0].astype(dtype), broken[1], method="smooth")
    assert distance(result.new_vertices).max() < 0.03
    assert rms(result.new_vertices) < 0.5 * rms(smooth.new_vertices)
    # Spread over both holes, not heaped in a corner of them.
    for turn, z, size in WINDOWS:
        place = np.array([np.cos(turn), np.sin(turn), z])
        (hole,) = (h for h in result.holes if np.linalg.norm(h.centre - place) < size / 2)
        own = result.new_vertices[result.new_vertex_holes == hole.id]
        assert np.linalg.norm(own - place, axis=1).max() < 1.3 * size
        assert np.linalg.norm(own.mean(axis=0) - place) < 0.3 * size


def distance(points):
    angle = np.arctan2(points[:, 1], points[:, 0])
    return np.abs(np.hypot(points[:, 0], points[:, 1]) - column_radius(angle))


def rms(points):
    return np.sqrt((distance(points) ** 2).mean())


# Each option beside the flags of the command line that mean the same: another program reads the
# same mesh and must come to the same bytes.
OPTIONS = [
    ({}, []),
    ({"method": "smooth"}, ["--method", "smooth"]),
    ({"method": "harary"}, ["--method", "harary"]),
    ({"method": "fragment"}, ["--method", "fragment"]),
    ({"method": "warp"}, ["--method", "warp"]),
    *(
        ({"method": "smooth", "fairing": name}, ["--method", "smooth", "--fairing", name.replace("_", "-")])
        for name in ("none", "c0", "c1", "c2", "least_squares", "smoothed_plate")
    ),
    ({"sizing": "scaled", "sizing_value": 0.7}, ["--edge-scale", "0.7"]),
    ({"sizing": "edge_length", "sizing_value": 0.1}, ["--edge-length", "0.1"]),
    ({"unmirrored": True}, ["--unmirrored"]),
    ({"grouping": "separate"}, ["--separate-loops"]),
    ({"selection": "ids", "selection_ids": [1]}, ["--holes", "1"]),
    ({"selection": "all_but_largest"}, ["--holes", "all-but-largest"]),
    ({"selection": "max_edges", "selection_max_edges": 40}, ["--max-edges", "40"]),
    ({"selection": "max_circumference", "selection_length": 4.0}, ["--max-length", "4"]),
    ({"selection": "max_diameter", "selection_length": 0.94}, ["--max-diameter", "0.94"]),
    ({"selection": "near_point", "selection_point": (-1, -1, 0)}, ["--near=-1,-1,0"]),
    ({"selection": "near_vertices", "selection_ids": [5, 9]}, ["--near-vertex", "5,9"]),
]


@pytest.mark.parametrize("options, flags", OPTIONS, ids=[" ".join(f) or "default" for _, f in OPTIONS])
def test_option_gives_the_bytes_of_the_command_line(broken, program, tmp_path, options, flags):
    vertices, faces = broken[0].astype(np.float32), broken[1]
    all_vertices, all_faces = filled_by(program, tmp_path, vertices, faces, flags)
    result = complete_mesh(vertices, faces, **options)
    assert len(result.new_faces) > 0
    assert same(result.vertices, all_vertices) and same(result.faces, all_faces)
    kept = {k: v for k, v in options.items() if k not in ("grouping",)}
    again = Completer(vertices, faces, grouping=options.get("grouping", "automatic"))
    assert same(again.complete(**kept).vertices, result.vertices)


def filled_by(program, folder, vertices, faces, flags):
    write_ply(folder / "in.ply", vertices, faces)
    program("fill", folder / "in.ply", "-o", folder / "out.ply", "-q", *flags)
    rows, all_faces = read_ply(folder / "out.ply")
    return positions(rows), all_faces


def test_no_refinement_gives_the_bytes_of_the_command_line(program, tmp_path):
    vertices, faces = octahedron()  # across the column's flutes, it would meet itself
    faces = faces.astype(np.int32)
    flags = ["--method", "smooth", "--no-refine"]
    result = complete_mesh(vertices, faces, method="smooth", sizing="none")
    all_vertices, all_faces = filled_by(program, tmp_path, vertices, faces, flags)
    assert same(result.vertices, all_vertices) and same(result.faces, all_faces)
    assert len(result.new_vertices) == 0 and len(result.new_faces) == 2


def test_options_differ_from_each_other(broken):
    """Or the comparison with the command line would prove nothing."""
    seen = {}
    for options, flags in OPTIONS:
        if options != {"grouping": "separate"}:  # the column has no loops that belong together
            key = complete_mesh(*broken, **options).vertices.tobytes()
            seen.setdefault(key, []).append(flags)
    alike = [flags for flags in seen.values() if len(flags) > 1]
    chosen = {"--holes", "--max-edges", "--max-length", "--max-diameter", "--near", "--near-vertex"}
    for flags in alike:
        names = {own[0].split("=")[0] if own else "" for own in flags}
        assert names <= chosen or names == {"--method"}, alike


def test_join_makes_one_hole_of_two(broken):
    loops = [hole.loops[0] for hole in list_holes(*broken)]
    lists = [[loops[0][3], loops[1][5]]]
    joined = list_holes(*broken, grouping="join", join_vertices=lists)
    assert [hole.kind for hole in joined] == ["ring"] or [h.kind for h in joined] == ["several"]
    assert {tuple(np.sort(l)) for l in joined[0].loops} == {tuple(np.sort(l)) for l in loops}
    assert len(Completer(*broken, grouping="join", join_vertices=lists).holes) == 1


def test_selection_leaves_the_others_open(broken):
    result = complete_mesh(*broken, selection="ids", selection_ids=[1])
    assert [hole.status for hole in result.holes] == ["not_selected", "filled"]
    rim = {tuple(edge) for edge in boundary_edges(result.faces)}
    loop = result.holes[0].loops[0]
    assert rim == {(b, a) for a, b in zip(loop, np.roll(loop, -1))}


def test_no_hole_chosen_gives_the_input(broken):
    result = complete_mesh(*broken, selection="ids", selection_ids=[])
    assert same(result.vertices, broken[0]) and same(result.faces, broken[1])
    assert len(result.new_vertices) == 0 and result.new_vertices.shape == (0, 3)
    assert result.new_vertex_transforms.shape == (0, 3, 4)


def test_new_only_is_the_same_without_the_whole(broken):
    whole, new = complete_mesh(*broken), complete_mesh(*broken, output="new_only")
    assert same(whole.new_vertices, new.new_vertices) and same(whole.new_faces, new.new_faces)
    assert not hasattr(new, "vertices") and not hasattr(new, "faces")


def test_octahedron_by_hand():
    vertices, faces = octahedron()
    result = complete_mesh(vertices, faces, method="smooth", sizing="none")
    assert same(result.vertices, vertices)
    # The two faces that are missing, from any corner on.
    made = {frozenset(face) for face in result.new_faces.tolist()}
    assert made == {frozenset((0, 2, 4)), frozenset((1, 3, 5))}
    assert len(boundary_edges(result.faces)) == 0


def test_listed_holes_are_measured(broken):
    vertices, faces = broken
    holes = list_holes(vertices, faces)
    edges = {tuple(edge) for edge in boundary_edges(faces)}
    for hole in holes:
        (loop,) = hole.loops
        around = np.roll(loop, -1)
        assert {(b, a) for a, b in zip(loop, around)} <= edges
        length = np.linalg.norm(vertices[loop] - vertices[around], axis=1).sum()
        assert hole.edge_count == len(loop) and np.isclose(hole.circumference, length)
        assert hole.kind == "disc" and hole.status == "open" and hole.reason == ""
    assert sum(hole.edge_count for hole in holes) == len(edges)


def test_result_may_be_written_to(broken):
    first, second = complete_mesh(*broken), complete_mesh(*broken)
    first.vertices[:] = 0
    first.new_vertices[:] = 0
    first.new_vertex_confidences[:] = 0
    assert same(complete_mesh(*broken).vertices, second.vertices)
