"""A scan from points to a surface: the sample cloud (examples/scan.rs), completed, then meshed by Open3D."""

import os
import pathlib
import subprocess

import numpy as np
import pytest
from complete_mesh import complete_points

SPACING = 0.02  # of the thinned cloud, in cloud units: halves the points
FAR = 2.5  # spacings from any point from which on a surface is invention


@pytest.fixture(scope="module")
def scan(tmp_path_factory):
    path = tmp_path_factory.mktemp("scan") / "scan.ply"
    subprocess.run([os.environ["COMPLETE_MESH_SCAN"], path], check=True)
    lines = pathlib.Path(path).read_text().splitlines()
    rows = lines[lines.index("end_header") + 1 :]
    return np.array([row.split()[:3] for row in rows], dtype=np.float32)


def rims(points, holes):
    """Boundary edges near each hole of what is left of a Poisson surface where there are points."""
    o3d = pytest.importorskip("open3d", exc_type=ImportError)
    cloud = o3d.geometry.PointCloud(o3d.utility.Vector3dVector(points.astype(float)))
    cloud = cloud.voxel_down_sample(SPACING)
    cloud, _ = cloud.remove_statistical_outlier(20, 3.0)
    cloud.estimate_normals(o3d.geometry.KDTreeSearchParamKNN(16))
    cloud.orient_normals_consistent_tangent_plane(10)
    # One thread: the sums of several come in another order each time.
    made, _ = o3d.geometry.TriangleMesh.create_from_point_cloud_poisson(cloud, depth=7, n_threads=1)
    vertices = o3d.geometry.PointCloud(made.vertices)
    near = np.asarray(vertices.compute_point_cloud_distance(cloud)) < FAR * SPACING
    faces = np.asarray(made.triangles)
    faces = faces[near[faces].all(1)]
    edges = np.sort(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    edges, count = np.unique(edges, axis=0, return_counts=True)
    middles = np.asarray(made.vertices)[edges[count == 1]].mean(1)
    off = [np.linalg.norm(middles - h.centre, axis=1) / h.diameter for h in holes]
    return [int((d < 0.6).sum()) for d in off]


def test_a_completed_scan_has_no_hole_left(scan):
    made = complete_points(scan)
    holes = [hole for hole in made.holes if hole.status == "filled"]
    assert len(holes) >= 3
    before, after = rims(scan, holes), rims(made.points, holes)
    # The largest are open without the completion, or the test would prove nothing.
    assert sum(n > 10 for n in before) >= 3, before
    assert after == [0] * len(holes), (before, after)
