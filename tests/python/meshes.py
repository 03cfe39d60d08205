"""Meshes with holes, and PLY files of them."""

import pathlib
import re

import numpy as np


WINDOWS = ((0.8, 0.5, 0.45), (3.6, -0.6, 0.4))


def column(around=60, up=48, windows=WINDOWS, flutes=12, depth=0.05):
    """A fluted column about the z axis, closed by flat lids, with a hole for each (angle, z, radius).
    (n, 3) float64 and (m, 3) int32."""
    angle, height = np.meshgrid(
        np.arange(around) * (2 * np.pi / around), np.linspace(-1.5, 1.5, up), indexing="xy"
    )
    radius = column_radius(angle, flutes, depth)
    rings = np.stack([radius * np.cos(angle), radius * np.sin(angle), height], axis=2)
    vertices = np.concatenate([rings.reshape(-1, 3), [[0, 0, -1.5], [0, 0, 1.5]]])
    at = np.arange(up * around).reshape(up, around)
    a, b = at[:-1], np.roll(at, -1, axis=1)[:-1]
    c, d = np.roll(at, -1, axis=1)[1:], at[1:]
    side = np.concatenate([np.stack([a, b, c], 2), np.stack([a, c, d], 2)]).reshape(-1, 3)
    low = np.stack([np.roll(at[0], -1), at[0], np.full(around, up * around)], 1)
    high = np.stack([at[-1], np.roll(at[-1], -1), np.full(around, up * around + 1)], 1)
    faces = np.concatenate([side, low, high])
    middle = vertices[faces].mean(axis=1)
    open_ = np.zeros(len(faces), bool)
    for turn, z, size in windows:
        place = [np.cos(turn), np.sin(turn), z]
        open_ |= np.linalg.norm(middle - place, axis=1) < size
    return without_unused(vertices, faces[~open_])


def column_radius(angle, flutes=12, depth=0.05):
    return 1 + depth * np.cos(flutes * angle)


def without_unused(vertices, faces):
    used, faces = np.unique(faces, return_inverse=True)
    return vertices[used], faces.reshape(-1, 3).astype(np.int32)


def octahedron():
    """Without two of its faces, as in the README: two holes of three edges each."""
    vertices = np.array(
        [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], np.float32
    )
    faces = np.array(
        [[2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [0, 3, 5]], np.uint32
    )
    return vertices, faces


def bow_tie():
    """A grid with two holes that touch in a vertex, and its number."""
    x, y = np.meshgrid(np.arange(9.0), np.arange(9.0))
    vertices = np.stack([x.ravel(), y.ravel(), np.zeros(81)], axis=1)
    cell = [(i, j) for j in range(8) for i in range(8) if (i, j) not in ((3, 3), (4, 4))]
    faces = []
    for i, j in cell:
        a = j * 9 + i
        faces += [[a, a + 1, a + 10], [a, a + 10, a + 9]]
    return vertices, np.array(faces, np.int32), 4 * 9 + 4


def boundary_edges(faces):
    """(k, 2) directed edges without a partner that runs the other way."""
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]).astype(np.int64)
    assert len(np.unique(edges, axis=0)) == len(edges), "an edge is used twice in one direction"
    ways = {tuple(edge) for edge in edges.tolist()}
    return np.array([(a, b) for a, b in ways if (b, a) not in ways], np.int64).reshape(-1, 2)


def write_ply(path, vertices, faces):
    kind = {4: "float", 8: "double"}[vertices.dtype.itemsize]
    rows = np.empty(len(faces), [("count", "u1"), ("index", "<i4", 3)])
    rows["count"], rows["index"] = 3, faces
    header = (
        f"ply\nformat binary_little_endian 1.0\nelement vertex {len(vertices)}\n"
        f"property {kind} x\nproperty {kind} y\nproperty {kind} z\n"
        f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    pathlib.Path(path).write_bytes(header.encode() + vertices.tobytes() + rows.tobytes())


def read_ply(path):
    """Vertices with all their properties, and faces, of a binary PLY file with triangles."""
    data = pathlib.Path(path).read_bytes()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    header = data[:end].decode()
    assert "binary_little_endian" in header
    n, m = (int(re.search(rf"element {name} (\d+)", header)[1]) for name in ("vertex", "face"))
    types = {"float": "<f4", "double": "<f8", "uchar": "u1", "int": "<i4", "uint": "<u4"}
    vertex_part, face_part = header.split("element face")
    dtype = [(name, types[kind]) for kind, name in re.findall(r"property (\w+) (\w+)\n", vertex_part)]
    vertices = np.frombuffer(data, dtype, n, end)
    count, index = re.search(r"property list (\w+) (\w+)", face_part).groups()
    row = [("count", types[count]), ("index", types[index], 3)]
    rows = np.frombuffer(data, row, m, end + vertices.nbytes)
    assert (rows["count"] == 3).all()
    return vertices, rows["index"]


def positions(rows):
    return np.stack([rows["x"], rows["y"], rows["z"]], axis=1)
