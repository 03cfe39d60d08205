"""What the vertices carry is completed with the shape."""

import numpy as np
import pytest
from complete_mesh import Completer, CompleteMeshError, Status, complete_mesh
from conftest import same
from meshes import column


def painted(vertices):
    """Linear, so that faces interpolate it exactly: red, green, blue and a height."""
    rows = vertices.astype(float) @ np.array([[0.3, -0.2, 0.1, 0], [0.1, 0.3, 0.2, 0], [0, 0.1, -0.2, 1]])
    return 0.5 + 0.1 * rows


def twin(vertices, **more):
    intact = column(windows=())
    return {
        "exemplar_vertices": intact[0][:, [2, 0, 1]] + [5, 6, 7],
        "exemplar_faces": intact[1],
        "exemplar_only": True,
    } | more


def test_rows_belong_to_their_vertices(broken):
    vertices, faces = broken
    rows = painted(vertices)
    rows = np.column_stack([rows, 7 - 2 * rows[:, 3]])
    options = {"vertex_values": rows, "steering_channels": 3}
    result = complete_mesh(vertices, faces, **options)
    values = result.new_vertex_values
    assert values.shape == (len(result.new_vertices), 5)
    assert np.abs(values[:, 4] - (7 - 2 * values[:, 3])).max() < 1e-6
    # From the rim or from where the same is known around: never far from what belongs there.
    spread = np.ptp(painted(vertices)[:, :3], axis=0)
    assert (np.abs(values[:, :3] - painted(result.new_vertices)[:, :3]).max(axis=0) < 0.1 * spread).all()
    again = Completer(vertices, faces).complete(**options)
    assert same(again.new_vertex_values, values)


def test_an_exemplar_gives_its_values(broken):
    vertices, faces = broken
    options = twin(vertices, vertex_values=np.full(len(vertices), 0.5))
    plain = complete_mesh(vertices, faces, **options)
    assert np.abs(plain.new_vertex_values - 0.5).max() < 1e-9
    brighter = np.full(len(options["exemplar_vertices"]), 0.8)
    result = complete_mesh(vertices, faces, **options, exemplar_values=brighter)
    # At the rim what is known there, farther in what the twin has.
    assert 0.5 < result.new_vertex_values.min() and 0.55 < result.new_vertex_values.max() <= 0.8
    with pytest.raises(ValueError, match="exemplar_values"):
        complete_mesh(vertices, faces, **options, exemplar_values=brighter[1:])


def test_values_without_a_source_stay_between_those_of_the_rim(broken):
    vertices, faces = broken
    heights = vertices[:, 2].astype(float)
    result = complete_mesh(vertices, faces, method="smooth", vertex_values=heights)
    assert result.new_vertex_values.shape == (len(result.new_vertices), 1)
    for hole in result.holes:
        own = slice(hole.first_new_vertex, hole.first_new_vertex + hole.new_vertex_count)
        rim = heights[np.concatenate(hole.loops)]
        values = result.new_vertex_values[own]
        assert rim.min() - 1e-6 <= values.min() < values.max() <= rim.max() + 1e-6
    assert complete_mesh(vertices, faces, method="smooth").new_vertex_values.shape[1] == 0


def test_values_that_cannot_be(broken):
    vertices, faces = broken
    rows = painted(vertices)
    for wrong in (rows[1:], rows[:, :0], rows[None]):
        with pytest.raises(ValueError, match="vertex_values"):
            complete_mesh(vertices, faces, vertex_values=wrong)
    with pytest.raises(ValueError, match="vertex_values"):
        complete_mesh(vertices, faces, steering_channels=3)
    rows[7, 1] = np.nan
    for options in ({"vertex_values": rows}, {"vertex_values": painted(vertices), "steering_channels": 5}):
        with pytest.raises(CompleteMeshError) as caught:
            complete_mesh(vertices, faces, **options)
        assert caught.value.status == Status.INVALID_OPTION
