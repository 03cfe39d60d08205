"""Where each new vertex comes from."""

import json

import numpy as np
import pytest
from complete_mesh import complete_mesh
from conftest import same
from meshes import read_ply, write_ply


@pytest.fixture(scope="module")
def result(broken):
    return complete_mesh(*broken)


def test_arrays_agree_with_the_report(result):
    k, j = len(result.new_vertices), len(result.new_faces)
    assert k == sum(hole.new_vertex_count for hole in result.holes)
    assert j == sum(hole.new_face_count for hole in result.holes)
    for hole in result.holes:
        vertices = slice(hole.first_new_vertex, hole.first_new_vertex + hole.new_vertex_count)
        faces = slice(hole.first_new_face, hole.first_new_face + hole.new_face_count)
        assert (result.new_vertex_holes[vertices] == hole.id).all()
        assert (result.new_face_holes[faces] == hole.id).all()
        # A face of a hole has corners on the rim and among the hole's own vertices.
        corners = np.unique(result.new_faces[faces])
        own = np.arange(vertices.start, vertices.stop) + result.input_vertex_count
        assert set(corners) <= set(own) | set(hole.loops[0]) and set(own) <= set(corners)
        assert hole.method == "coherent" and hole.sources and hole.seconds > 0
        assert np.isclose(sum(source.weight for source in hole.sources), 1)
        counts = np.bincount(result.new_vertex_sources[vertices] + 1, minlength=len(hole.sources) + 1)
        assert [source.vertex_count for source in hole.sources] == counts[1:].tolist()
    assert 0 < result.seconds < 600 and result.cpu_seconds > 0


def test_sources_can_be_replayed(broken, result):
    vertices, faces = broken
    has = result.new_vertex_source_faces >= 0
    assert has.mean() > 0.9 and (has == (result.new_vertex_sources >= 0)).all()
    weights = result.new_vertex_barycentrics
    assert np.allclose(weights[has].sum(axis=1), 1) and (weights[has] >= -1e-9).all()
    assert (weights[~has] == 0).all()
    corners = vertices[faces[result.new_vertex_source_faces[has]]]
    places = (weights[has][:, :, None] * corners).sum(axis=1)
    transforms = result.new_vertex_transforms
    assert np.isnan(transforms[~has]).all()
    moved = np.einsum("ijk,ik->ij", transforms[has][:, :, :3], places) + transforms[has][:, :, 3]
    diameter = max(hole.diameter for hole in result.holes)
    error = np.linalg.norm(moved - result.new_vertices[has], axis=1)
    assert error.max() < 0.25 * diameter and np.median(error) < 0.1 * diameter
    # Not near the hole by being in it: sources lie elsewhere.
    assert np.median(np.linalg.norm(places - result.new_vertices[has], axis=1)) > 0.2 * diameter


def test_transforms_are_rigid_or_stretch_a_little(result):
    rigid = []
    for hole in result.holes:
        for source in hole.sources:
            turn = source.transform[:, :3]
            strains = np.linalg.svd(turn, compute_uv=False) - 1
            assert np.abs(strains).max() < 0.2
            assert (np.linalg.det(turn) < 0) == source.mirrored
            rigid.append(np.abs(strains).max() < 1e-9)
    assert np.mean(rigid) > 0.5
    assert {s.mirrored for hole in result.holes for s in hole.sources} == {True, False}


def test_confidences_are_those_of_sources(result):
    confidence = result.new_vertex_confidences
    assert (confidence >= 0).all() and (confidence <= 1).all()
    assert confidence[result.new_vertex_sources >= 0].min() > 0.5
    assert all(0.5 < hole.confidence <= 1 for hole in result.holes)


def test_confidences_are_those_of_the_own_hole(broken, result):
    vertices, faces = broken
    # Rough at the second hole, so that the two are not equally sure.
    first, second = (vertices[hole.loops[0]].mean(axis=0) for hole in result.holes)
    along = np.clip((vertices - first) @ (second - first) / ((second - first) @ (second - first)), 0, 1)
    edge = np.linalg.norm(vertices[faces[:, 0]] - vertices[faces[:, 1]], axis=1).mean()
    noise = np.random.default_rng(1).normal(size=vertices.shape) * along[:, None] * 0.1 * edge
    made = complete_mesh(vertices + noise, faces)
    confidence = made.new_vertex_confidences
    one, other = (hole.confidence for hole in made.holes)
    assert abs(one - other) > 0.01
    for hole in made.holes:
        assert np.isclose(confidence[made.new_vertex_holes == hole.id].mean(), hole.confidence)


def test_smooth_fill_comes_from_nowhere(broken):
    result = complete_mesh(*broken, method="smooth")
    assert (result.new_vertex_source_faces == -1).all() and (result.new_vertex_sources == -1).all()
    assert (result.new_vertex_confidences == 0).all()
    assert np.isnan(result.new_vertex_transforms).all()
    assert all(h.method == "smooth" and not h.sources and h.fairing != "auto" for h in result.holes)
    assert all(np.isnan(h.coherence_error_after) for h in result.holes)


def test_report_of_the_command_line_says_the_same(broken, program, tmp_path):
    vertices, faces = broken[0].astype(np.float32), broken[1]
    write_ply(tmp_path / "in.ply", vertices, faces)
    out, report = tmp_path / "out.ply", tmp_path / "report.json"
    program("fill", tmp_path / "in.ply", "-o", out, "-q", "--provenance", "--report", report)
    result = complete_mesh(vertices, faces)
    n = result.input_vertex_count
    rows = read_ply(out)[0][n:]
    assert same(rows["source_face"].astype(np.int64), result.new_vertex_source_faces)
    assert same(rows["source"].astype(np.int64), result.new_vertex_sources)
    assert same(rows["hole"].astype(np.int64), result.new_vertex_holes)
    assert same(rows["confidence"], result.new_vertex_confidences.astype(np.float32))
    for column, name in enumerate(("source_u", "source_v"), start=1):
        assert same(rows[name], result.new_vertex_barycentrics[:, column].astype(np.float32))

    for said, hole in zip(json.loads(report.read_text())["holes"], result.holes, strict=True):
        for name in ("id", "kind", "status", "method", "confidence", "circumference", "diameter"):
            assert said[name] == getattr(hole, name), name
        assert said["fairing"].replace("-", "_") == hole.fairing
        assert said["edges"] == hole.edge_count and said["loops"] == len(hole.loops)
        assert said["centre"] == hole.centre.tolist()
        for told, source in zip(said["sources"], hole.sources, strict=True):
            assert np.array_equal(np.ravel(told["transform"]), source.transform.ravel())
            assert told["mirrored"] == source.mirrored
            for name in ("weight", "error"):
                assert told[name] == getattr(source, name)
