# SPDX-License-Identifier: MIT OR Apache-2.0
"""Meshes as the library takes them: without a copy where that can be."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _abi
from ._errors import CompleteMeshError, Status


class Mesh:
    """Vertices and faces, as given in dtype and value, and how to hand them over."""

    def __init__(self, vertices: ArrayLike, faces: ArrayLike, copy: bool = False) -> None:
        self.vertices = _vertices(vertices)
        self.faces = _faces(faces)
        indices = _indices(self.faces)
        if copy:
            self.vertices = np.array(self.vertices, order="C")
            self.faces = np.array(self.faces, order="C")
            indices = np.array(indices, order="C")
        self._positions, self.vertex_stride = _in_rows(self.vertices)
        self._indices, self.face_stride = _in_rows(indices)
        self.vertex_type = _abi.F64 if self.vertices.dtype == np.float64 else _abi.F32

    def arguments(self) -> tuple[int | None, int, int | None, int]:
        """The first four arguments of the C functions; valid as long as self."""
        return (
            self._positions.ctypes.data if len(self._positions) else None,
            len(self._positions),
            self._indices.ctypes.data if len(self._indices) else None,
            len(self._indices),
        )


def _vertices(given: ArrayLike) -> NDArray[Any]:
    array = np.asarray(given)
    if not hasattr(given, "dtype") and array.dtype.kind in "iu":
        array = array.astype(np.float64)  # [[0, 0, 0], [1, 0, 0], ...]
    if array.size == 0:
        array = array.reshape(-1, 3)
    if array.dtype.newbyteorder("=") not in (np.float32, np.float64):
        raise TypeError(
            f"vertices are {array.dtype}, but must be float32 or float64: convert them, "
            "e.g. vertices.astype(np.float64)"
        )
    _check_shape("vertices", array)
    return array.astype(array.dtype.newbyteorder("="), copy=False)


def _faces(given: ArrayLike) -> NDArray[Any]:
    array = np.asarray(given)
    if array.size == 0:
        array = array.reshape(-1, 3)
        if array.dtype.kind == "f":  # what NumPy makes of []
            array = array.astype(np.int64)
    if array.dtype.kind not in "iu":
        raise TypeError(f"faces are {array.dtype}, but must be integers")
    _check_shape("faces", array)
    return array.astype(array.dtype.newbyteorder("="), copy=False)


def _check_shape(name: str, array: NDArray[Any]) -> None:
    if array.ndim == 2 and array.shape[1] == 3:
        return
    text = f"{name} have the shape {array.shape}, but must have (count, 3)"
    if name == "faces" and array.ndim == 2 and array.shape[1] == 4:
        text += ": triangulate the quads first"
    raise ValueError(text)


def _indices(faces: NDArray[Any]) -> NDArray[np.uint32]:
    """The faces as 32-bit indices; the caller's own memory where they are that already."""
    wrong = np.zeros(0, np.int64)
    if faces.dtype.kind == "i" and faces.size and faces.min() < 0:
        wrong = np.flatnonzero((faces < 0).any(axis=1))
    elif faces.dtype.itemsize > 4 and faces.size and faces.max() > 0xFFFFFFFF:
        wrong = np.flatnonzero((faces > 0xFFFFFFFF).any(axis=1))
    if len(wrong):
        raise CompleteMeshError(
            Status.INVALID_MESH,
            f"face {wrong[0]} names a vertex that does not exist: {faces[wrong[0]].tolist()}",
            faces=wrong,
        )
    return faces.view(np.uint32) if faces.dtype == np.int32 else faces.astype(np.uint32, copy=False)


def _in_rows(array: NDArray[Any]) -> tuple[NDArray[Any], int]:
    """The array, or a copy if its rows are not three numbers side by side; and the stride."""
    row, item = array.strides
    if len(array) > 1 and item == array.itemsize and row >= 3 * item:
        return array, row
    return np.ascontiguousarray(array), 0
