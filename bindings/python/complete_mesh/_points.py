# SPDX-License-Identifier: MIT OR Apache-2.0
"""Point clouds."""

from __future__ import annotations

from typing import Any, Optional, Sequence, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._arrays import Mesh
from ._library import Library, copied, library
from ._options import Call, Progress
from ._result import Holes, Ids

_NO_FACES = np.empty((0, 3), np.uint32)


class PointResult:
    """A completed point cloud. k is the number of new points.

    Vertices of ``holes`` are points. A point without a source has -1 as source point and source.
    """

    points: NDArray[Any]
    """(n + k, 3), dtype of the input: the input bit for bit, in order, then the new points."""
    new_points: NDArray[Any]
    """(k, 3), dtype of the input."""
    new_normals: NDArray[np.float64]
    """(k, 3): unit normals, on the side of those given, or else outside."""
    new_point_holes: Ids
    """(k,): the id of the hole that each new point fills."""
    new_point_source_points: Ids
    """(k,): the input point nearest to where the new point's detail was copied from."""
    new_point_sources: Ids
    """(k,): the source, an index into ``holes[hole].sources`` of the point's own hole."""
    new_point_confidences: NDArray[np.float64]
    """(k,): 0 (nothing on the object backs it) to 1. From 0.8 convincing, below 0.5 invention."""
    new_point_values: NDArray[np.float64]
    """(k, c): what ``vertex_values`` are at the new points, copied from where the shape was copied from,
    else carried in from the rim; c is 0 without."""
    cleaned_points: Optional[NDArray[np.float64]]
    """(n, 3): where each input point lies in the cleaned copy; None without ``clean``."""
    removed_points: Optional[NDArray[np.bool_]]
    """(n,): whether it is left out there; None without ``clean``."""
    holes: Holes
    """All holes and borders of the input, filled or not: the report."""
    seconds: float
    """Wall seconds that the completion took."""
    cpu_seconds: float
    """CPU seconds that the process spent, in all its threads, meanwhile."""

    def __init__(self, lib: Library, handle: Any, points: NDArray[Any], value_channels: int) -> None:
        k = lib.result_new_vertex_count(handle)

        def array(name: str, count: int, dtype: Any) -> NDArray[Any]:
            return copied(getattr(lib, "result_new_" + name)(handle), count, np.dtype(dtype))

        def ids(name: str) -> Ids:
            numbers = array(name, k, np.uint32)
            return np.where(numbers == 0xFFFFFFFF, -1, numbers.astype(np.int64))

        self.new_points = array("vertices", k * 3, points.dtype).reshape(-1, 3)
        self.new_normals = array("vertex_normals", k * 3, float).reshape(-1, 3)
        self.new_point_holes = ids("vertex_holes")
        self.new_point_source_points = ids("vertex_source_points")
        self.new_point_sources = ids("vertex_sources")
        self.new_point_confidences = array("vertex_confidences", k, float)
        values = array("vertex_values", k * value_channels, float)
        self.new_point_values = values.reshape(k, value_channels)
        self.cleaned_points = self.removed_points = None
        if lib.result_removed_points(handle):
            moved = copied(lib.result_cleaned_points(handle), points.size, np.dtype(float))
            self.cleaned_points = moved.reshape(-1, 3)
            flags = copied(lib.result_removed_points(handle), len(points), np.dtype(np.uint8))
            self.removed_points = flags.astype(bool)
        self.holes = Holes(lib, lib.result_holes(handle))
        self.seconds = lib.result_seconds(handle)
        self.cpu_seconds = lib.result_cpu_seconds(handle)
        self.points = np.concatenate([points, self.new_points])

    @property
    def filled_count(self) -> int:
        """How many holes were filled."""
        return sum(hole.status == "filled" for hole in self.holes)

    def __repr__(self) -> str:
        return (
            f"PointResult({self.filled_count} of {len(self.holes)} holes filled, "
            f"{len(self.new_points)} points new)"
        )


class Cloud:
    """Points and their normals, and how to hand them over."""

    def __init__(self, points: ArrayLike, normals: Optional[ArrayLike]) -> None:
        self.mesh = Mesh(points, _NO_FACES)
        self._normals: Optional[NDArray[Any]] = None
        if normals is not None:
            self._normals = np.ascontiguousarray(normals, dtype=self.mesh.vertices.dtype)
            if self._normals.shape != self.mesh.vertices.shape:
                raise ValueError(
                    f"normals have the shape {self._normals.shape}, but points "
                    f"{self.mesh.vertices.shape}"
                )

    def arguments(self) -> tuple[Optional[int], int, Optional[int]]:
        """The first three arguments of the C functions; valid as long as self."""
        positions, count = self.mesh.arguments()[:2]
        if self._normals is None or not count:
            return positions, count, None
        return positions, count, self._normals.ctypes.data


def complete_points(
    points: ArrayLike,
    normals: Optional[ArrayLike] = None,
    *,
    method: str = "coherent",
    fairing: str = "auto",
    sizing: str = "surroundings",
    sizing_value: Optional[float] = None,
    grouping: str = "automatic",
    join_vertices: Optional[Sequence[Sequence[int]]] = None,
    selection: str = "all",
    selection_ids: Optional[ArrayLike] = None,
    selection_max_edges: Optional[int] = None,
    selection_length: Optional[float] = None,
    selection_point: Optional[ArrayLike] = None,
    skip_unsafe: bool = False,
    exemplar_vertices: Optional[ArrayLike] = None,
    exemplar_faces: Optional[ArrayLike] = None,
    exemplar_only: bool = False,
    unmirrored: bool = False,
    vertex_values: Optional[ArrayLike] = None,
    exemplar_values: Optional[ArrayLike] = None,
    steering_channels: int = 0,
    placement: Optional[ArrayLike] = None,
    refine: bool = False,
    candidate: int = 0,
    scale_range: Optional[Sequence[float]] = None,
    exemplar_parts: Optional[Sequence[int]] = None,
    constraint_points: Optional[ArrayLike] = None,
    softness: float = 0.0,
    clean: Union[bool, int] = False,
    given_loops: Sequence[Sequence[int]] = (),
    given_regions: Optional[ArrayLike] = None,
    threads: int = 0,
    progress: Optional[Progress] = None,
) -> PointResult:
    """Fills holes of a point cloud with new points.

    The outer border of an open surface stays open, unless it is selected by id, point or vertices.

    Args:
        points: (n, 3) positions, float32 or float64. Three NaN are a point without coordinates.
        normals: (n, 3), any length, zero where unknown: which side is out; None: guessed.
        vertex_values: what the points carry, colours or any numbers, (n, c) or (n,): completed with the
            shape, see `PointResult.new_point_values`.
        clean: complete a cleaned copy, without outliers, its noise smoothed so many times (0 to 100; True:
            three times). ``points`` of the result are the input's all the same; see
            `PointResult.cleaned_points`.
        given_loops: holes that are given instead of being found: for each the indices of 3 or more points
            around it, in order, either way round. Where the surface through the points has no edge between
            two of them the loop follows its rims and edges, without a detour. Inside is the smaller part;
            points there stay, and are not looked at.
        given_regions: (p, 4): the centre and the radius of balls: the holes whose rims lie in one; if there
            are none, the largest gap that shows. If any hole is given no others are looked for.

    The other arguments, and the errors, are those of `complete_mesh`, vertices being points.
    """
    options = dict(locals())
    lib, cloud = library(), Cloud(options.pop("points"), options.pop("normals"))
    call = Call(lib, cloud.mesh, **options)
    handle = call.run(lib.points, lib.result_free, *cloud.arguments())
    try:
        return PointResult(lib, handle, cloud.mesh.vertices, call.options.value_channels)
    finally:
        lib.result_free(handle)
