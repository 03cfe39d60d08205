"""Point clouds: points of the unit sphere with two holes."""

import numpy as np
import pytest
from complete_mesh import CompleteMeshError, Status, complete_points
from conftest import same

HOLES = (([1, 0, 0], 0.35), ([0, -0.6, 0.8], 0.25))


@pytest.fixture(scope="module")
def cloud():
    i = np.arange(3000)
    z, a = 1 - (2 * i + 1) / len(i), np.pi * (3 - np.sqrt(5)) * i
    r = np.sqrt(1 - z**2)
    points = np.stack([r * np.cos(a), r * np.sin(a), z], axis=1)
    gone = [np.linalg.norm(points - centre, axis=1) < radius for centre, radius in HOLES]
    return points[~np.any(gone, axis=0)]


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_input_first_then_points_on_the_sphere(cloud, dtype):
    points = cloud.astype(dtype)
    result = complete_points(points)
    assert same(result.points[: len(points)], points)
    assert same(result.points[len(points) :], result.new_points)
    assert result.filled_count == 2 and [hole.status for hole in result.holes] == ["filled"] * 2
    radius = np.linalg.norm(result.new_points, axis=1)
    assert np.abs(radius - 1).max() < 0.01
    assert 0.8 < len(radius) / (3000 - len(points)) < 1.25
    assert np.allclose(np.linalg.norm(result.new_normals, axis=1), 1)
    assert (result.new_normals * result.new_points).sum(1).min() > 0.95
    for i, p in enumerate(result.new_points):
        near = [np.linalg.norm(p - centre) < 1.1 * size for centre, size in HOLES]
        hole = result.holes[result.new_point_holes[i]]
        assert sum(near) == 1
        assert np.linalg.norm(hole.centre - HOLES[near.index(True)][0]) < 0.1


def test_origins(cloud):
    result = complete_points(cloud)
    named = result.new_point_source_points >= 0
    assert named.mean() > 0.5 and result.new_point_source_points.max() < len(cloud)
    for i in np.flatnonzero(named):
        source = result.holes[result.new_point_holes[i]].sources[result.new_point_sources[i]]
        start = cloud[result.new_point_source_points[i]]
        there = source.transform[:, :3] @ start + source.transform[:, 3]
        assert np.linalg.norm(there - result.new_points[i]) < 0.1
    assert ((result.new_point_confidences >= 0) & (result.new_point_confidences <= 1)).all()
    smooth = complete_points(cloud, method="smooth")
    assert len(smooth.new_points) and (smooth.new_point_source_points == -1).all()


def test_normals_say_which_side_is_out(cloud):
    result = complete_points(cloud, -2 * cloud, method="smooth")
    assert len(result.new_points)
    assert (result.new_normals * result.new_points).sum(1).max() < -0.95
    with pytest.raises(ValueError, match="normals"):
        complete_points(cloud, cloud[1:])


def test_values(cloud):
    result = complete_points(cloud, method="smooth", vertex_values=cloud)
    assert result.new_point_values.shape == result.new_points.shape
    assert np.abs(result.new_point_values - result.new_points).max() < 0.1
    assert complete_points(cloud, method="smooth").new_point_values.shape[1] == 0


def test_cleaning(cloud):
    rng = np.random.default_rng(5)
    spacing = np.sqrt(4 * np.pi / 3000)
    rough = cloud * (1 + 0.2 * spacing * rng.standard_normal(len(cloud)))[:, None]
    astray = np.arange(0, len(cloud), 250)
    rough[astray] *= 1.3
    result = complete_points(rough, clean=True, method="smooth")
    assert same(result.points[: len(rough)], rough)
    assert result.removed_points[astray].all() and result.removed_points.sum() <= len(astray) + 2
    kept = ~result.removed_points
    off = [np.std(np.linalg.norm(p[kept], axis=1)) for p in (rough, result.cleaned_points)]
    assert off[1] < 0.6 * off[0]
    assert np.std(np.linalg.norm(result.new_points, axis=1)) < 0.15 * spacing
    still = complete_points(rough, clean=0, method="smooth")
    assert same(still.cleaned_points, rough) and same(still.removed_points, result.removed_points)
    assert complete_points(cloud, method="smooth").cleaned_points is None
    with pytest.raises(CompleteMeshError, match="clean"):
        complete_points(rough, clean=101)


def test_errors(cloud):
    with pytest.raises(CompleteMeshError, match="on one line") as raised:
        complete_points(np.arange(30.0).reshape(-1, 1) * [[1, 2, 3]])
    assert raised.value.status is Status.INVALID_MESH
    bad = cloud.copy()
    bad[17, 1] = np.inf
    with pytest.raises(CompleteMeshError, match="point 17"):
        complete_points(bad)
    with pytest.raises(CompleteMeshError) as raised:
        complete_points(cloud, selection="ids", selection_ids=[9])
    assert raised.value.status is Status.NO_SUCH_HOLE
