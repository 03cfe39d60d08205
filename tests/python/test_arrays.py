"""Arrays of all sorts."""

import gc

import numpy as np
import pytest
from complete_mesh import Completer, CompleteMeshError, Status, complete_mesh, list_holes
from conftest import same

QUICK = {"method": "smooth"}


def between(array, left, right):
    """The same numbers as columns of a wider array."""
    wide = np.full((len(array), left + 3 + right), 77, array.dtype)
    wide[:, left : left + 3] = array
    return wide[:, left : left + 3]


def unaligned(array):
    raw = np.zeros(array.nbytes + 1, np.uint8)
    view = raw[1:].view(array.dtype).reshape(array.shape)
    view[:] = array
    return view


def read_only(array):
    array = array.copy()
    array.flags.writeable = False
    return array


LAYOUTS = {
    "between columns": lambda a: between(a, 2, 3),
    "every other row": lambda a: np.repeat(a, 2, axis=0)[::2],
    "rows backwards": lambda a: a[::-1].copy()[::-1],
    "columns backwards": lambda a: a[:, ::-1].copy()[:, ::-1],
    "every other column": lambda a: np.repeat(a, 2, axis=1)[:, ::2],
    "Fortran order": np.asfortranarray,
    "transposed": lambda a: a.T.copy().T,
    "unaligned": unaligned,
    "read only": read_only,
    "other byte order": lambda a: a.astype(a.dtype.newbyteorder()),
    "subclass": lambda a: a.view(type("Own", (np.ndarray,), {})),
}


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("layout", LAYOUTS)
@pytest.mark.parametrize("which", ["vertices", "faces"])
def test_layout_makes_no_difference(broken, layout, dtype, which):
    packed = [broken[0].astype(dtype), broken[1]]
    reference = complete_mesh(*packed, **QUICK)
    given = list(packed)
    i = ("vertices", "faces").index(which)
    given[i] = LAYOUTS[layout](packed[i])
    assert np.array_equal(given[i], packed[i])
    before = given[i].copy()
    for made in (complete_mesh(*given, **QUICK), Completer(*given).complete(**QUICK)):
        assert same(made.vertices, reference.vertices) and same(made.faces, reference.faces)
    assert np.array_equal(given[i], before)


@pytest.mark.parametrize("dtype", [np.int16, np.uint16, np.int32, np.uint32, np.int64, np.uint64])
def test_faces_keep_their_dtype(broken, dtype):
    faces = broken[1].astype(dtype)
    result = complete_mesh(broken[0], faces, **QUICK)
    assert result.faces.dtype == dtype and result.new_faces.dtype == dtype
    assert same(result.faces[: len(faces)], faces)
    assert np.array_equal(result.faces, complete_mesh(*broken, **QUICK).faces)


def test_indices_that_grow_too_large_are_widened():
    """125 vertices, int8: the input's indices fit, the fill's do not."""
    ring = np.arange(124) * (2 * np.pi / 124)
    vertices = np.concatenate([np.stack([np.cos(ring), np.sin(ring), 0 * ring], 1), [[0, 0, 0.5]]])
    faces = np.stack([np.arange(124), (np.arange(124) + 1) % 124, np.full(124, 124)], 1)
    options = {"method": "smooth", "sizing": "scaled", "sizing_value": 0.7}
    result = complete_mesh(vertices, faces.astype(np.int8), **options)
    assert result.faces.dtype == np.int64 and result.faces.max() > 127
    assert np.array_equal(result.faces, complete_mesh(vertices, faces, **options).faces)


def test_lists_will_do():
    vertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2]]
    result = complete_mesh(vertices, faces, method="smooth", sizing="none")
    assert result.vertices.dtype == np.float64 and result.vertices.tolist() == vertices
    assert result.faces[:3].tolist() == faces
    assert set(result.faces[3]) == {1, 2, 3} and len(result.faces) == 4


@pytest.mark.parametrize("dtype", [np.float16, np.longdouble, np.int32, np.complex128, object, "U3"])
def test_wrong_vertices(broken, dtype):
    with pytest.raises(TypeError, match="vertices are .* must be float32 or float64"):
        complete_mesh(broken[0].astype(dtype), broken[1])


@pytest.mark.parametrize("dtype", [np.float32, np.float64, bool, np.complex64, object])
def test_wrong_faces(broken, dtype):
    with pytest.raises(TypeError, match="faces are .* must be integers"):
        complete_mesh(broken[0], broken[1].astype(dtype))


@pytest.mark.parametrize("shape", [(-1,), (-1, 2), (3, -1), (1, -1, 3)])
def test_wrong_shapes(broken, shape):
    vertices, faces = broken[0][:36], broken[1][:36]
    with pytest.raises(ValueError, match="vertices have the shape"):
        complete_mesh(vertices.reshape(shape), faces)
    with pytest.raises(ValueError, match="faces have the shape"):
        complete_mesh(vertices, faces.reshape(shape))


def test_quads_are_not_triangles(broken):
    with pytest.raises(ValueError, match="triangulate"):
        complete_mesh(broken[0], [[0, 1, 2, 3]])


@pytest.mark.parametrize("dtype", [np.int32, np.int64, np.uint64])
@pytest.mark.parametrize("wrong", [-1, 100_000, 2**31 - 1, 2**40])
def test_wrong_indices(broken, dtype, wrong):
    if not np.iinfo(dtype).min <= wrong <= np.iinfo(dtype).max:
        return
    faces = broken[1].astype(dtype)
    faces[7, 1] = wrong
    for call in (complete_mesh, list_holes, Completer):
        with pytest.raises(CompleteMeshError, match="face 7 names") as caught:
            call(broken[0], faces)
        assert caught.value.status == Status.INVALID_MESH and caught.value.faces.tolist() == [7]


@pytest.mark.parametrize("empty", [[], np.zeros((0, 3)), np.zeros(0)])
def test_no_vertices_and_no_faces(empty):
    with pytest.raises(CompleteMeshError) as caught:
        complete_mesh(empty, np.asarray(empty, np.int32))
    assert caught.value.status == Status.INVALID_MESH


def test_completer_keeps_what_it_was_given(broken):
    vertices, faces = broken[0].copy(), broken[1].copy()
    reference = complete_mesh(vertices, faces)
    completer = Completer(vertices, faces)
    vertices[:] = np.nan
    faces[:] = 0
    del vertices, faces
    gc.collect()
    assert same(completer.complete().vertices, reference.vertices)
    assert len(completer.holes) == 2


def test_result_outlives_its_completer(broken):
    completer = Completer(*broken)
    result = completer.complete(**QUICK)
    holes = completer.holes
    del completer
    gc.collect()
    assert same(result.vertices, complete_mesh(*broken, **QUICK).vertices)
    assert [hole.edge_count for hole in holes] == [hole.edge_count for hole in result.holes]
