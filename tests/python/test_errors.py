"""Failures: the status, the words and the elements."""

import pickle
import threading

import numpy as np
import pytest
from complete_mesh import Completer, CompleteMeshError, Status, complete_mesh, list_holes
from conftest import same
from meshes import boundary_edges, bow_tie, octahedron


def fails(status, *arguments, **options):
    with pytest.raises(CompleteMeshError) as caught:
        complete_mesh(*arguments, **options)
    assert caught.value.status == status and str(caught.value)
    return caught.value


def test_coordinate_that_is_not_finite(broken):
    for value in (np.nan, np.inf, -np.inf):
        vertices = broken[0].copy()
        vertices[11, 2] = value
        error = fails(Status.INVALID_MESH, vertices, broken[1])
        assert error.vertices.tolist() == [11] and "11" in str(error)
        assert error.faces.shape == (0,) and error.edges.shape == (0, 2)


def test_no_such_hole(broken):
    error = fails(Status.NO_SUCH_HOLE, *broken, selection="ids", selection_ids=[0, 9])
    assert error.holes.tolist() == [9]


def test_unsafe_hole_names_its_vertex():
    vertices, faces, touching = bow_tie()
    unsafe = [hole for hole in list_holes(vertices, faces) if hole.is_unsafe]
    assert unsafe and all(h.problem_vertices.tolist() == [touching] and h.reason for h in unsafe)
    chosen = {"selection": "ids", "selection_ids": [unsafe[0].id]}
    error = fails(Status.UNSAFE_HOLE, vertices, faces, **chosen)
    assert error.holes.tolist() == [unsafe[0].id] and error.vertices.tolist() == [touching]
    result = complete_mesh(vertices, faces, skip_unsafe=True, **chosen)
    assert same(result.vertices, vertices) and result.holes[unsafe[0].id].status == "unsafe"
    assert result.holes[unsafe[0].id].reason


def test_skip_unsafe_fills_the_rest():
    ball, faces = octahedron()
    tie, more, touching = bow_tie()
    vertices = np.concatenate([ball.astype(np.float64) - [9, 0, 0], tie])
    faces = np.concatenate([faces.astype(np.int64), more + len(ball)])
    small = {"selection": "max_edges", "selection_max_edges": 8}
    result = complete_mesh(vertices, faces, grouping="separate", skip_unsafe=True, **small)
    states = {hole.status for hole in result.holes}
    assert {"filled", "unsafe"} <= states and result.filled_count == 2
    rest = boundary_edges(result.faces)
    assert rest.min() >= len(ball) and touching + len(ball) in rest


def test_odd_things_are_listed():
    vertices, faces = octahedron()
    odd = np.concatenate([faces, [[0, 0, 1]], faces[:1, [0, 1, 2]]])
    holes = list_holes(vertices, odd)
    assert holes.degenerate_faces.tolist() == [6]
    twice = np.concatenate([vertices, vertices[4:5]])
    cut = faces.copy()
    cut[0, 2] = 6
    holes = list_holes(twice, cut)
    assert {tuple(sorted(pair)) for pair in holes.duplicate_vertices.tolist()} == {(4, 6)}
    flipped = faces.copy()
    flipped[4] = flipped[4, ::-1]
    assert len(list_holes(vertices, flipped).inconsistent_edges) > 0


@pytest.mark.parametrize(
    "options",
    [
        {"sizing": "scaled", "sizing_value": 1000.0},
        {"sizing": "scaled", "sizing_value": float("nan")},
        {"sizing": "edge_length", "sizing_value": -1.0},
        {"selection": "max_diameter", "selection_length": 0.0},
        {"selection": "near_point", "selection_point": (0, float("nan"), 0)},
        {"threads": 5000},
    ],
)
def test_option_out_of_range(broken, options):
    fails(Status.INVALID_OPTION, *broken, **options)


@pytest.mark.parametrize(
    "options, words",
    [
        ({"method": "coherrent"}, "smooth, coherent, harary, fragment, warp"),
        ({"fairing": "c3"}, "c0, c1, c2"),
        ({"sizing": "fine"}, "surroundings"),
        ({"grouping": "no"}, "separate"),
        ({"selection": "some"}, "all_but_largest"),
        ({"output": "half"}, "new_only"),
        ({"sizing_value": 2.0}, "sizing_value is read only with sizing='scaled' or 'edge_length'"),
        ({"sizing": "scaled"}, "needs sizing_value"),
        ({"selection": "ids"}, "needs selection_ids"),
        ({"selection_ids": [1]}, "read only with selection='ids' or 'near_vertices'"),
        ({"selection": "all", "selection_length": 1.0}, "read only with"),
        ({"grouping": "join"}, "needs join_vertices"),
        ({"join_vertices": [[1, 2]]}, "read only with grouping='join'"),
        ({"selection": "ids", "selection_ids": [-1]}, "0 to 2"),
        ({"selection": "near_point", "selection_point": (1, 2)}, "shape"),
        ({"threads": -1}, "0 to 2"),
    ],
)
def test_argument_that_cannot_be(broken, options, words):
    with pytest.raises(ValueError, match=words):
        complete_mesh(*broken, **options)


@pytest.mark.parametrize(
    "options",
    [
        {"mehtod": "smooth"},
        {"threads": 1.5},
        {"threads": True},
        {"selection": "ids", "selection_ids": [0.5]},
        {"selection": "max_edges", "selection_max_edges": "9"},
        {"sizing": "scaled", "sizing_value": "1"},
    ],
)
def test_argument_of_a_wrong_kind(broken, options):
    with pytest.raises(TypeError):
        complete_mesh(*broken, **options)


def test_completer_refuses_bad_meshes_at_once(broken):
    vertices = broken[0].copy()
    vertices[3] = np.nan
    with pytest.raises(CompleteMeshError):
        Completer(vertices, broken[1])


def test_messages_of_threads_do_not_mix(broken):
    def work(vertex, found):
        vertices = broken[0].copy()
        vertices[vertex] = np.nan
        for _ in range(20):
            found.append(fails(Status.INVALID_MESH, vertices, broken[1]).vertices.tolist())

    lists = {vertex: [] for vertex in (5, 17, 40, 99)}
    workers = [threading.Thread(target=work, args=pair) for pair in lists.items()]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    assert all(found == [[vertex]] * 20 for vertex, found in lists.items())


def test_error_survives_pickling(broken):
    """Pools of processes send errors home that way."""
    error = fails(Status.NO_SUCH_HOLE, *broken, selection="ids", selection_ids=[9])
    copy = pickle.loads(pickle.dumps(error))
    assert str(copy) == str(error) and copy.status == error.status
    assert copy.holes.tolist() == [9] and type(copy) is type(error)
