"""Point clouds: points of the unit sphere with two holes."""

import numpy as np
import pytest
from complete_mesh import CompleteMeshError, Status, complete_points, list_holes
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


def test_listed_holes(cloud):
    """Each rim is the points along the edge of what was taken out, and all detectors find it."""
    holes = list_holes(cloud)
    assert len(holes) == 2 and abs(holes.spacing - 0.075) < 0.015
    assert [len(points) for points in holes.ignored_points.values()] == [0, 0, 0, 0]
    assert holes.only_in_field.shape == (0, 3)
    for hole in holes:
        centre, radius = min(HOLES, key=lambda h: np.linalg.norm(hole.centre - h[0]))
        near = np.linalg.norm(cloud - centre, axis=1)
        (loop,) = hole.loops
        assert near[loop].max() < radius + 1.5 * holes.spacing
        assert set(np.flatnonzero(near < radius + 0.2 * holes.spacing)) <= set(loop)
        assert np.linalg.norm(hole.centre - centre) < 0.1
        taken = 3000 * radius**2 / 4  # the share of a cap of chord r is r^2 / 4
        assert abs(hole.missing_points - taken) < 0.2 * taken
        assert hole.boundary_probability > 0.4 and hole.status == "open" and not hole.is_border
        assert hole.agreed and hole.detectors_asked == ("surface", "boundary", "field")
    for hole, filled in zip(holes, complete_points(cloud, method="smooth").holes):
        assert np.array_equal(hole.loops[0], filled.loops[0])
        assert filled.detectors_asked == filled.detectors_agreed == hole.detectors_asked


def test_a_loop_is_given(cloud):
    """The second hole's own rim, backwards and every third point of it: as if it were found and chosen."""
    found = list_holes(cloud)
    (rim,) = found[1].loops
    wanted = complete_points(cloud, method="smooth", selection="ids", selection_ids=[1])
    for loop in (rim[::-1], rim[::3].tolist()):
        result = complete_points(cloud, method="smooth", given_loops=[loop])
        (hole,) = result.holes
        assert same(result.new_points, wanted.new_points) and np.array_equal(hole.loops[0], rim)
        assert hole.agreed and "field" in hole.detectors_agreed
    both = list_holes(cloud, given_loops=[rim, found[0].loops[0]])
    assert [hole.loops[0].tolist() for hole in both] == [hole.loops[0].tolist() for hole in found]


def test_a_loop_takes_in_points(cloud):
    """Around nothing at the south pole: the surface inside is made anew, on the sphere."""
    near = np.linalg.norm(cloud - [0, 0, -1], axis=1)
    ring = np.flatnonzero((near > 0.3) & (near < 0.34))
    ring = ring[np.argsort(np.arctan2(*cloud[ring, :2].T))]
    result = complete_points(cloud, method="smooth", given_loops=[ring], clean=0)
    inside = result.holes.ignored_points["inside"]
    assert set(np.flatnonzero(near < 0.2)) <= set(inside) and near[inside].max() < 0.34 and len(inside) > 40
    assert result.removed_points[inside].all()
    assert np.abs(np.linalg.norm(result.new_points, axis=1) - 1).max() < 0.01
    assert np.linalg.norm(result.new_points - [0, 0, -1], axis=1).max() < 0.36
    # Around those inside as densely, as far as the ring.
    assert 0.9 < len(result.new_points) / len(inside) < 1.4


def test_a_region_is_given(cloud):
    centre, radius = HOLES[0]
    wanted = complete_points(cloud, method="smooth", selection="near_point", selection_point=centre)
    result = complete_points(cloud, method="smooth", given_regions=[[*centre, radius + 0.2]])
    assert same(result.new_points, wanted.new_points) and len(result.holes) == 1
    # Five points are too few to be found.
    small = np.argsort(np.linalg.norm(cloud - [0, 1, 0], axis=1))[:5]
    points = np.delete(cloud, small, axis=0)
    assert len(list_holes(points)) == 2
    result = complete_points(points, method="smooth", given_regions=[[0, 1, 0, 0.25]])
    for p in cloud[small]:
        assert np.linalg.norm(result.points - p, axis=1).min() < 0.9 * result.holes.spacing
    assert len(result.new_points) > 1


def test_what_cannot_be_given(cloud, broken):
    n = len(cloud)
    for given, words in [
        ({"given_loops": [[1, 2]]}, "loop 0 has 2 points"),
        ({"given_loops": [[1, 2, 1]]}, "point 1 twice"),
        ({"given_loops": [[1, 2, n]]}, f"names point {n}"),
        ({"given_loops": [[0, n // 2, n - 1]]}, "too far apart"),
        ({"given_regions": [[0, 0, -1, 0.2]]}, "region 0 has no rim"),
        ({"given_regions": [[0, 0, -1, 0]]}, "radius 0"),
    ]:
        with pytest.raises(CompleteMeshError, match=words) as raised:
            list_holes(cloud, **given)
        assert raised.value.status is Status.INVALID_OPTION
    with pytest.raises(ValueError, match="given_regions have the shape"):
        list_holes(cloud, given_regions=[[0, 0, 1]])
    with pytest.raises(ValueError, match="given_loops and given_regions are those of a cloud"):
        list_holes(*broken, given_loops=[[0, 1, 2]])


def relief():
    """A waving hexagonal lattice of spacing 1 with a hole of radius 5."""
    j, i = np.divmod(np.arange(1600), 40)
    x, y = i + 0.5 * (j % 2), j * np.sqrt(0.75)
    points = np.stack([x, y, 0.3 * np.sin(0.2 * x)], axis=1)
    return points[np.hypot(x - 20, y - 17) >= 5]


def test_listed_border_and_ignored_points():
    """The edge of a relief is a border, which is chosen only by its name."""
    points = relief()
    points = np.concatenate([points, np.full((1, 3), np.nan), [[60, 60, 60]], points[3:4]])
    holes = list_holes(points, normals=np.tile([0, 0, 1], (len(points), 1)))
    (border,) = [hole for hole in holes if hole.is_border]
    assert border.status == "not_selected" and len(holes) == 2 and "border" in str(border)
    edge = points[border.loops[0]]
    at_edge = (edge[:, 0] < 0.6) | (edge[:, 0] > 38.9) | (edge[:, 1] < 0.1) | (edge[:, 1] > 33.7)
    assert at_edge.all() and len(edge) > 110
    named = list_holes(points, selection="ids", selection_ids=[border.id])
    assert [hole.status == "open" for hole in named] == [hole.is_border for hole in holes]
    n = len(points)
    assert holes.ignored_points["missing"].tolist() == [n - 3]
    assert holes.ignored_points["outlier"].tolist() == [n - 2]
    assert holes.ignored_points["duplicate"].tolist() == [n - 1]


def test_a_mesh_has_no_detectors(broken):
    for hole in list_holes(*broken):
        assert hole.detectors_asked == () and np.isnan(hole.boundary_probability)
    with pytest.raises(ValueError, match="normals"):
        list_holes(*broken, normals=broken[0])


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
