"""What a fill may be copied from."""

import numpy as np
import pytest
from complete_mesh import Completer, CompleteMeshError, Status, complete_mesh
from conftest import same
from meshes import column, positions, read_ply, write_ply


def turned(vertices):
    """Somewhere else, and about another axis."""
    return (vertices[:, [2, 0, 1]] + [5, 6, 7]).astype(vertices.dtype)


def test_source_faces(broken):
    vertices, faces = broken
    low = vertices[faces][:, :, 2].max(axis=1) < 0
    for result in (
        complete_mesh(vertices, faces, source_faces=low),
        Completer(vertices, faces).complete(source_faces=low),
    ):
        sources = result.new_vertex_source_faces
        assert (sources >= 0).mean() > 0.5 and low[sources[sources >= 0]].all()
    free = complete_mesh(vertices, faces).new_vertex_source_faces
    assert not low[free[free >= 0]].all()


def test_nothing_to_copy_from(broken):
    with pytest.raises(CompleteMeshError) as caught:
        complete_mesh(*broken, source_faces=np.zeros(len(broken[1]), bool))
    assert caught.value.status == Status.INVALID_OPTION


@pytest.mark.parametrize("layout", ["packed", "strided", "other dtypes"])
def test_exemplar_gives_the_bytes_of_the_command_line(broken, program, tmp_path, layout):
    vertices, faces = broken[0].astype(np.float32), broken[1]
    intact = column(windows=())
    twin = turned(intact[0].astype(np.float32)), intact[1]
    write_ply(tmp_path / "in.ply", vertices, faces)
    write_ply(tmp_path / "twin.ply", *twin)
    flags = ["--exemplar", tmp_path / "twin.ply", "--exemplar-only", "-o", tmp_path / "out.ply"]
    program("fill", tmp_path / "in.ply", "-q", *flags)
    rows, all_faces = read_ply(tmp_path / "out.ply")
    given = twin
    if layout == "strided":
        given = np.repeat(twin[0], 2, axis=0)[::2], np.asfortranarray(twin[1])
    elif layout == "other dtypes":
        given = twin[0].astype(np.float64), twin[1].astype(np.int64)
    options = {"exemplar_vertices": given[0], "exemplar_faces": given[1], "exemplar_only": True}
    result = complete_mesh(vertices, faces, **options)
    assert same(result.vertices, positions(rows)) and same(result.faces, all_faces)
    # All of it comes from the twin, whose faces are counted on from the mesh's.
    has = result.new_vertex_source_faces >= 0
    assert has.mean() > 0.9 and (result.new_vertex_source_faces[has] >= len(faces)).all()
    corners = twin[0][twin[1][result.new_vertex_source_faces[has] - len(faces)]]
    places = (result.new_vertex_barycentrics[has][:, :, None] * corners).sum(axis=1)
    transforms = result.new_vertex_transforms[has]
    moved = np.einsum("ijk,ik->ij", transforms[:, :, :3], places) + transforms[:, :, 3]
    assert np.median(np.linalg.norm(moved - result.new_vertices[has], axis=1)) < 0.1


def test_unmirrored(broken):
    result = complete_mesh(*broken, unmirrored=True)
    assert not any(source.mirrored for hole in result.holes for source in hole.sources)


def test_sources_that_cannot_be(broken):
    vertices, faces = broken
    for mask in (np.ones(3, bool), np.ones(len(faces), int), np.ones((len(faces), 1), bool)):
        with pytest.raises(ValueError, match="source_faces are"):
            complete_mesh(vertices, faces, source_faces=mask)
    with pytest.raises(ValueError, match="need each other"):
        complete_mesh(vertices, faces, exemplar_vertices=vertices)
    wrong = faces.copy()
    wrong[2, 0] = len(vertices)
    with pytest.raises(CompleteMeshError):
        complete_mesh(vertices, faces, exemplar_vertices=vertices, exemplar_faces=wrong)
