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


def test_an_exemplar_gives_its_values(broken):
    vertices, faces = broken
    intact = column(windows=())
    options = {
        "exemplar_vertices": intact[0][:, [2, 0, 1]] + [5, 6, 7],
        "exemplar_faces": intact[1],
        "exemplar_only": True,
        "vertex_values": painted(vertices),
        "exemplar_values": painted(intact[0]),
        "steering_channels": 3,
    }
    result = complete_mesh(vertices, faces, **options)
    assert result.new_vertex_values.shape == (len(result.new_vertices), 4)
    assert np.abs(result.new_vertex_values - painted(result.new_vertices)).max() < 2e-3
    again = Completer(vertices, faces).complete(**options)
    assert same(again.new_vertex_values, result.new_vertex_values)


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
