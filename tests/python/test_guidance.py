"""Fills guided by hand: a transform, a candidate, a range of scales."""

import numpy as np
import pytest
from complete_mesh import Completer, CompleteMeshError, Status, candidates, complete_mesh
from conftest import same
from meshes import column, column_radius


def off(result):
    """Greatest distance of a new vertex from the column, less what its facets cut off."""
    x, y, _ = result.new_vertices.T
    return np.abs(np.hypot(x, y) - column_radius(np.arctan2(y, x))).max()


def twin():
    """Whole, twice as large, and with x, y and z changed round; and the way back."""
    vertices, faces = column(windows=())
    matrix = np.array([[0, 0.5, 0, 0], [0, 0, 0.5, 0], [0.5, 0, 0, -1]])
    there = 2 * (vertices + [0, 0, 1])[:, [2, 0, 1]]
    assert np.allclose(there @ matrix[:, :3].T + matrix[:, 3], vertices)
    return {"exemplar_vertices": there, "exemplar_faces": faces}, matrix


def test_placement(broken):
    exemplar, matrix = twin()
    exact = complete_mesh(*broken, **exemplar, placement=matrix)
    assert (exact.new_vertex_source_faces >= len(broken[1])).all()
    for hole in exact.holes:
        assert len(hole.sources) == 1 and np.array_equal(hole.sources[0].transform, matrix)
    square = np.vstack([matrix, [0, 0, 0, 1]]).tolist()
    assert same(complete_mesh(*broken, **exemplar, placement=square).vertices, exact.vertices)
    rough = matrix.copy()
    rough[:, 3] += [0.02, 0.03, 0.02]
    kept = complete_mesh(*broken, **exemplar, placement=rough)
    refined = complete_mesh(*broken, **exemplar, placement=rough, refine=True)
    assert off(refined) < off(exact) + 1e-4
    assert refined.holes[0].confidence > kept.holes[0].confidence


def test_scale_range(broken):
    exemplar, _ = twin()
    options = {**exemplar, "exemplar_only": True}
    scaled = complete_mesh(*broken, **options, scale_range=(0.25, 2))
    assert off(scaled) < off(complete_mesh(*broken, **exemplar, placement=twin()[1])) + 1e-4
    linear = scaled.holes[0].sources[0].transform[:, :3]
    assert abs(np.linalg.det(linear)) == pytest.approx(0.125, rel=1e-4)


def test_candidates(broken):
    made = candidates(*broken, 3, selection="ids", selection_ids=[0])
    assert len(made) == 3
    completer = Completer(*broken)
    for i, result in enumerate(made):
        hole = result.holes[0]
        assert len(hole.sources) == 1 and hole.candidate_count >= 3
        options = {"selection": "ids", "selection_ids": [0], "candidate": i + 1}
        assert same(completer.complete(**options).vertices, result.vertices)
    places = [result.holes[0].sources[0].transform.tobytes() for result in made]
    assert len(set(places)) == 3


@pytest.mark.parametrize("method", ["smooth", "coherent"])
def test_constraint_points(broken, method):
    """A bump over a hole that nothing shows: the fill goes through its top."""
    place = 1.25 * np.array([[np.cos(0.8), np.sin(0.8), 0.4]])

    def nearest(**options):
        result = complete_mesh(*broken, method=method, **options)
        return np.linalg.norm(result.new_vertices - place, axis=1).min()

    hard = nearest(constraint_points=place)
    soft = nearest(constraint_points=place, softness=0.5)
    assert hard < 0.08 and nearest() > soft > 1.5 * hard


def test_exemplar_parts(broken):
    """Two columns on each other, of which one has another number of flutes."""
    other, twin = column(windows=(), flutes=7), column(windows=())
    options = {
        "exemplar_vertices": np.concatenate([other[0], twin[0]]),
        "exemplar_faces": np.concatenate([other[1], twin[1] + len(other[0])]),
        "exemplar_parts": [len(other[0]), len(twin[0])],
        "exemplar_only": True,
    }
    result = complete_mesh(*broken, **options)
    from_twin = result.new_vertex_source_faces >= len(broken[1]) + len(other[1])
    assert from_twin.mean() > 0.9


def test_part(broken):
    """The pieces of a twin, with its vertices and triangles."""
    exemplar, matrix = twin()
    made = complete_mesh(*broken, **exemplar, placement=matrix, part=True)
    new, whole = made.new_vertices, column(windows=())[0]
    off = np.linalg.norm(new[:, None] - whole[None], axis=2).min(axis=1)
    # To f32's rounding; the others, 15 of 136, close the gap to the rim.
    assert len(new) > 30 and (off < 1e-6).mean() > 0.85
    assert (made.new_vertex_source_faces >= len(broken[1])).all()
    with pytest.raises(CompleteMeshError, match="part"):
        complete_mesh(*broken, method="smooth", part=True)


def test_loose_vertices():
    """A sheet folded at the right side of its hole: the fill lies in the plane of the other sides."""
    grid = np.arange(441)
    x, y = (grid % 21).astype(float), (grid // 21).astype(float)
    vertices = np.stack([np.minimum(x, 10), y, np.maximum(x - 10, 0)], axis=1)
    cells = [(i, j) for j in range(20) for i in range(20) if not (4 <= i < 10 and 6 <= j < 14)]
    corners = [(j * 21 + i, j * 21 + i + 1, (j + 1) * 21 + i + 1, (j + 1) * 21 + i) for i, j in cells]
    faces = np.array([t for a, b, c, d in corners for t in ((a, b, c), (a, c, d))])
    options = {"method": "smooth", "fairing": "c1", "selection": "all_but_largest"}
    pulled = complete_mesh(vertices, faces, **options)
    loose = [j * 21 + 10 for j in range(6, 15)]
    kept = complete_mesh(vertices, faces, loose_vertices=loose, **options)
    assert np.abs(kept.new_vertices[:, 2]).max() < 1e-6 < 0.1 < np.abs(pulled.new_vertices[:, 2]).max()
    with pytest.raises(CompleteMeshError, match="vertex 0 is on no rim|vertex 22 is on no rim"):
        complete_mesh(vertices, faces, loose_vertices=[22], **options)


def test_guidance_that_cannot_be(broken):
    for matrix in (np.eye(3), np.ones((4, 4)), [1, 2]):
        with pytest.raises(ValueError, match="placement"):
            complete_mesh(*broken, placement=matrix)
    for options in (
        {"placement": np.diag([1, 2, 1, 1])},
        {"refine": True},
        {"scale_range": (0, 0)},
        {"scale_range": (2, 1)},
        {"candidate": 1, "method": "smooth"},
        {"constraint_points": [[0, 0, 90]]},
        {"softness": -1},
    ):
        with pytest.raises(CompleteMeshError) as caught:
            complete_mesh(*broken, **options)
        assert caught.value.status == Status.INVALID_OPTION
    with pytest.raises(ValueError, match="constraint_points"):
        complete_mesh(*broken, constraint_points=[1, 2, 3])
    with pytest.raises(TypeError):
        complete_mesh(*broken, candidate=1.5)
