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


def wall():
    """A relief on the left (x < 1) with a hole; around the hole the colours of the flat right side."""
    i, j = np.meshgrid(np.arange(181), np.arange(81))
    x, y = 0.03 * i.ravel() - 2.7, 0.03 * j.ravel() - 1.2
    relief = 0.025 * np.sin(np.pi * x / 0.15) * np.cos(np.pi * y / 0.1875)
    relief += 0.015 * np.sin(np.pi * (x + y) / 0.3)
    vertices = np.column_stack([x, y, np.where(x < 1, relief, 0)])
    i, j = np.meshgrid(np.arange(180), np.arange(80))
    cells = np.hypot(0.03 * (i + 0.5) - 0.8, 0.03 * (j + 0.5) - 1.2).ravel() > 0.25
    a = (181 * j + i).ravel()[cells]
    faces = np.stack([a, a + 1, a + 182, a, a + 182, a + 181], axis=1).reshape(-1, 3)
    used = np.unique(faces)
    vertices, faces = vertices[used], np.searchsorted(used, faces)
    x, y = vertices[:, 0], vertices[:, 1]
    same = (x > 1) | (np.hypot(x + 1.9, y) < 0.45)
    v = np.where(same, np.sin(11 * x) * np.sin(9 * y), np.sin(17 * (x + 0.3 * y)))
    return vertices, faces, np.column_stack([0.5 + 0.4 * v, 0.5 - 0.2 * v, np.full(len(v), 0.3)])


def test_colours_from_elsewhere_say_so():
    vertices, faces, colours = wall()
    at_hole = {"selection": "near_point", "selection_point": [-1.9, 0.25, 0]}
    result = complete_mesh(
        vertices, faces, vertex_values=colours, steering_channels=3, **at_hole
    )
    right = vertices[faces[:, 0], 0] > 1
    came, shape = result.new_vertex_colour_faces, result.new_vertex_source_faces
    assert len(came) > 100 and not right[shape[shape >= 0]].any()
    assert right[came[came >= 0]].mean() > 0.9
    weights = result.new_vertex_colour_barycentrics
    assert np.allclose(weights.sum(axis=1), 1) and (result.new_vertex_colour_confidences > 0.5).all()
    # The values are those of that place, but for what closes the seam at the rim.
    there = (weights[:, :, None] * colours[faces[came]]).sum(axis=1)
    assert np.abs(there - result.new_vertex_values).mean() < 0.05 * np.ptp(colours[:, 0])
    last = [hole.sources[-1] for hole in result.holes if hole.sources]
    assert [source.vertex_count for source in last] == [0]
    own = result.new_vertex_colour_sources != result.new_vertex_sources
    assert [source.coloured_count for source in last] == [own.sum()]


def test_colours_come_with_the_shape(result):
    assert same(result.new_vertex_colour_faces, result.new_vertex_source_faces)
    assert same(result.new_vertex_colour_barycentrics, result.new_vertex_barycentrics)
    assert same(result.new_vertex_colour_sources, result.new_vertex_sources)
    assert same(result.new_vertex_colour_confidences, result.new_vertex_confidences)
    assert all(source.coloured_count == 0 for hole in result.holes for source in hole.sources)


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
