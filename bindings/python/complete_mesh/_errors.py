# SPDX-License-Identifier: MIT OR Apache-2.0
"""What a call raises."""

from __future__ import annotations

import enum
from typing import Sequence

import numpy as np
from numpy.typing import NDArray


class Status(enum.IntEnum):
    """Why a call failed: complete_mesh_status of the C header."""

    INVALID_ARGUMENT = -1
    INVALID_OPTION = -2
    INVALID_MESH = -3
    NO_SUCH_HOLE = -4
    UNSAFE_HOLE = -5
    HOLE_FAILED = -6
    UNSUPPORTED = -7
    CANCELLED = -8
    OUT_OF_MEMORY = -9
    INTERNAL = -99


class LibraryNotFound(ImportError):
    """The shared library is not there, does not load, or has another ABI."""


class CompleteMeshError(RuntimeError):
    """A call that failed. Nothing was changed, and there is no result.

    The elements that are in the way can be selected or drawn; arrays that do not apply are empty.

    Attributes:
        status: what kind of failure, a `Status`.
        vertices: (k,) int64, indices of input vertices.
        edges: (k, 2) int64, pairs of input vertices.
        faces: (k,) int64, indices of input faces.
        holes: (k,) int64, ids of holes.
    """

    def __init__(
        self,
        status: int,
        message: str,
        vertices: Sequence[int] | NDArray[np.int64] = (),
        edges: Sequence[tuple[int, int]] | NDArray[np.int64] = (),
        faces: Sequence[int] | NDArray[np.int64] = (),
        holes: Sequence[int] | NDArray[np.int64] = (),
    ) -> None:
        super().__init__(message)
        try:
            self.status: int = Status(status)
        except ValueError:  # of a newer library
            self.status = status
        self.vertices = np.array(vertices, np.int64).reshape(-1)
        self.edges = np.array(edges, np.int64).reshape(-1, 2)
        self.faces = np.array(faces, np.int64).reshape(-1)
        self.holes = np.array(holes, np.int64).reshape(-1)

    def __reduce__(self) -> tuple[object, ...]:  # exceptions are pickled by their message alone
        elements = (self.vertices, self.edges, self.faces, self.holes)
        return type(self), (int(self.status), str(self), *elements)


class Cancelled(CompleteMeshError):
    """The progress function asked to stop."""
