"""What a fill may be copied from."""

import numpy as np
import pytest
from complete_mesh import Completer, CompleteMeshError, Status, complete_mesh
from conftest import same
from meshes import column, octahedron, positions, read_ply, write_ply


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


def triangles(result):
    """The fill's triangles by coordinates, in an order of their own; first corners, too."""
    corners = result.vertices[result.new_faces]
    first = np.array([sorted(range(3), key=lambda k: tuple(t[k]))[0] for t in corners])
    turns = (first[:, None] + np.arange(3)) % 3
    rows = np.take_along_axis(corners, turns[:, :, None], axis=1).reshape(-1, 9)
    return rows[np.lexsort(rows.T)]


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_initial_comes_back(broken, dtype):
    """A membrane, where a smooth fill would be another."""
    vertices, faces = broken[0].astype(dtype), broken[1]
    given = complete_mesh(vertices, faces, method="smooth", fairing="c0")
    other = complete_mesh(vertices, faces, method="smooth")
    assert len(given.new_vertices) > 0 and not same(triangles(given), triangles(other))
    completer = Completer(vertices, faces)
    for new_vertices, new_faces in (
        (given.new_vertices, given.new_faces),
        (given.new_vertices.astype(np.float64), given.new_faces.astype(np.int64)),
        (np.repeat(given.new_vertices, 2, axis=0)[::2], np.asfortranarray(given.new_faces)),
    ):
        options = {"initial_vertices": new_vertices, "initial_faces": new_faces, "method": "smooth"}
        for result in (complete_mesh(vertices, faces, **options), completer.complete(**options)):
            assert same(result.vertices[: len(vertices)], vertices)
            assert same(triangles(result), triangles(given))


def test_initial_only_of_faces():
    """One new face closes a triangle's hole and adds no vertex."""
    vertices, faces = octahedron()
    closing = np.array([[0, 2, 4], [1, 5, 3]])
    result = complete_mesh(vertices, faces, initial_vertices=[], initial_faces=closing)
    assert len(result.new_vertices) == 0
    assert sorted(sorted(face) for face in result.new_faces.tolist()) == [[0, 2, 4], [1, 3, 5]]


def test_initial_that_cannot_be(broken):
    vertices, faces = broken
    given = complete_mesh(vertices, faces, method="smooth")
    with pytest.raises(ValueError, match="need each other"):
        complete_mesh(vertices, faces, initial_faces=given.new_faces)
    options = {"initial_vertices": given.new_vertices, "initial_faces": given.new_faces[1:]}
    with pytest.raises(CompleteMeshError) as caught:
        complete_mesh(vertices, faces, **options)
    assert caught.value.status == Status.HOLE_FAILED
    beyond = given.new_faces.copy()
    beyond[0, 0] = len(vertices) + len(given.new_vertices)
    with pytest.raises(CompleteMeshError) as caught:
        complete_mesh(vertices, faces, **(options | {"initial_faces": beyond}))
    assert caught.value.status == Status.INVALID_OPTION
