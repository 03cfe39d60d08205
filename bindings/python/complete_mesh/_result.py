# SPDX-License-Identifier: MIT OR Apache-2.0
"""What a call gives back."""

from __future__ import annotations

import ctypes as c
from dataclasses import dataclass, field
from typing import Any, Iterator, Sequence, overload

import numpy as np
from numpy.typing import NDArray

from . import _abi
from ._arrays import Mesh
from ._library import Library, copied

Ids = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Source:
    """A place on the object that a fill was continued from. Lengths are in mesh units."""

    transform: NDArray[np.float64]
    """(3, 4): takes the place to the hole, ``transform[:, :3] @ point + transform[:, 3]``; a
    rotation, or a rotation and a reflection, in some with a stretch of a few per cent, and a
    translation; scaled where that was allowed."""
    mirrored: bool
    """The transform mirrors."""
    error: float
    """Root mean square error at known vertices near the rim that were hidden from the fit."""
    weight: float
    """Share in the low frequencies of the fill, 0 to 1; a hole's sources sum to 1."""
    vertex_count: int
    """How many new vertices have their detail from here."""
    coloured_count: int
    """How many new vertices have their values, but not their shape, from here."""


@dataclass(frozen=True, eq=False)
class Hole:
    """A hole and what became of it. Lengths and positions are in mesh units."""

    id: int
    """Its number, which is also its index."""
    kind: str
    """"disc", "islands", "ring" (a missing band) or "several" (loops joined)."""
    status: str
    """"open", "filled", "not_selected", "unsafe" or "failed"."""
    reason: str
    """Why it was not filled, or cannot be filled safely; else empty."""
    is_unsafe: bool
    """Something at the rim keeps it from being filled safely: see the problem_ arrays."""
    loops: tuple[Ids, ...]
    """The boundary loops, the longest first: indices of input vertices, in the order in which a
    filling face runs."""
    edge_count: int
    """Boundary edges of all loops."""
    circumference: float
    """Length of all loops."""
    diameter: float
    """Diameter of the longest loop."""
    centre: NDArray[np.float64]
    """(3,): centre of the longest loop."""
    first_new_vertex: int
    """Its first new vertex, counted among the new vertices."""
    new_vertex_count: int
    """How many new vertices it has, one after the other."""
    first_new_face: int
    """Its first new face, counted among the new faces."""
    new_face_count: int
    """How many new faces it has, one after the other."""
    method: str
    """The method that made the fill: "smooth" where nothing on the object served."""
    fairing: str
    """The fairing that was used; "auto" if not filled."""
    confidence: float
    """0 to 1; 0 for a smooth fill."""
    coherence_error_before: float
    """Coherence error of the smooth completion; NaN where it was not measured."""
    coherence_error_after: float
    """Coherence error of the fill; NaN where it was not measured."""
    candidate_count: int
    """How many candidates it has, if one was asked for; else 0."""
    seconds: float
    """Wall seconds that its fill took."""
    sources: tuple[Source, ...] = field(repr=False)
    """Where it was continued from, the greatest weight first; empty for a smooth fill."""
    problem_vertices: Ids = field(repr=False)
    """(k,): input vertices that keep it from being filled safely."""
    problem_edges: Ids = field(repr=False)
    """(k, 2): input edges that keep it from being filled safely."""
    is_border: bool
    """Of a cloud: the outer border of an open surface, which is filled only if it is named."""
    detectors_asked: tuple[str, ...] = field(repr=False)
    """Of a cloud: what could judge this hole: "surface", the mesh that is laid through the points, which
    finds all that are listed; "boundary", loops of likely boundary points (Bendels et al. 2005); "field",
    contours of the distance field (Park et al. 2006), not where the surface is open. Empty for a mesh."""
    detectors_agreed: tuple[str, ...] = field(repr=False)
    """Which of them find this hole. One that not all agree on may be a sparse place."""
    boundary_probability: float = field(repr=False)
    """Of a cloud: the mean probability that the points of the rim lie on a boundary; from 0.4 a rim is
    plain to see. NaN for a mesh."""
    missing_points: float = field(repr=False)
    """Of a cloud: an estimate of how many points are missing. NaN for a mesh."""

    @property
    def agreed(self) -> bool:
        """Whether all detectors find it that could judge."""
        return self.detectors_agreed == self.detectors_asked

    def __str__(self) -> str:
        kind = "border" if self.is_border else self.kind
        text = f"hole {self.id}: {kind}, {self.edge_count} edges, {self.status.replace('_', ' ')}"
        if self.status == "filled":
            text += f", {self.method}, {self.new_face_count} new faces"
            if self.sources:
                text += f", {len(self.sources)} sources, confidence {self.confidence:.2f}"
        return f"{text}: {self.reason}" if self.reason else text


class Holes(Sequence[Hole]):
    """The holes of a mesh or a cloud, by their ids, and everything odd that was found there. Nothing of
    that is repaired. A cloud has points for vertices."""

    def __init__(self, lib: Library, handle: c.c_void_p | int) -> None:
        self._holes = tuple(_hole(lib, handle, i) for i in range(lib.holes_count(handle)))
        self.non_manifold_edges: Ids = lib.list(lib.holes_non_manifold_edges, handle, width=2)
        """(k, 2): edges with more than two faces."""
        self.inconsistent_edges: Ids = lib.list(lib.holes_inconsistent_edges, handle, width=2)
        """(k, 2): edges whose two faces run the same way."""
        self.degenerate_faces: Ids = lib.list(lib.holes_degenerate_faces, handle)
        """(k,): faces that name a vertex twice."""
        self.duplicate_vertices: Ids = lib.list(lib.holes_duplicate_vertices, handle, width=2)
        """(k, 2): pairs of boundary vertices at one position: the mesh is not welded there."""
        self.spacing: float = lib.holes_spacing(handle)
        """Of a cloud: the middle one of the distances to the sixth neighbour; 0 for a mesh."""
        self.ignored_points: dict[str, Ids] = {
            name: lib.list(lib.holes_ignored_points, handle, kind)
            for kind, name in enumerate(_abi.IGNORED)
        }
        """Of a cloud, (k,) each: points that were not looked at: "missing" (no coordinates), "duplicate"
        (at the place of an earlier one), "outlier" (beside the surface) and "inside" (a loop given)."""
        self.only_in_field: NDArray[np.float64] = lib.places(lib.holes_only_in_field, handle)
        """Of a cloud, (k, 3): centres of the places that only the distance field takes for holes."""

    def __len__(self) -> int:
        return len(self._holes)

    @overload
    def __getitem__(self, index: int) -> Hole: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[Hole, ...]: ...
    def __getitem__(self, index: int | slice) -> Hole | tuple[Hole, ...]:
        return self._holes[index]

    def __iter__(self) -> Iterator[Hole]:
        return iter(self._holes)

    def __repr__(self) -> str:
        return f"Holes({', '.join(str(hole) for hole in self._holes)})"


class Result:
    """A completed mesh. k is the number of new vertices, j that of new faces.

    A vertex without a source (a smooth fill, a gap in a source) has -1 as source face and source,
    zeros as barycentrics and NaN as transform.
    """

    vertices: NDArray[Any]
    """(n + k, 3), dtype of the input: the input bit for bit, in order, then the new vertices. Not
    there with ``output="new_only"``."""
    faces: NDArray[Any]
    """(m + j, 3), dtype of the input: the input's faces, in order, then the new ones. Not there
    with ``output="new_only"``."""
    new_vertices: NDArray[Any]
    """(k, 3), dtype of the input."""
    new_faces: NDArray[Any]
    """(j, 3), dtype of the input's faces: an index below n is an input vertex; less n it is the
    index of a new one."""
    new_vertex_holes: Ids
    """(k,): the id of the hole that each new vertex fills."""
    new_vertex_source_faces: Ids
    """(k,): the input face that the vertex's detail was copied from; from m on faces of the
    exemplar, less m."""
    new_vertex_barycentrics: NDArray[np.float64]
    """(k, 3): where on that face: the weights of its corners in the face's order, sum 1."""
    new_vertex_sources: Ids
    """(k,): the source, an index into ``holes[hole].sources`` of the vertex's own hole."""
    new_vertex_confidences: NDArray[np.float64]
    """(k,): 0 (nothing on the object backs it) to 1. From 0.8 convincing, below 0.5 invention."""
    new_vertex_colour_faces: Ids
    """(k,): the face that the vertex's values were copied from, where they were copied: its source face,
    unless the place that the shape comes from does not have the colours around the hole and another has."""
    new_vertex_colour_barycentrics: NDArray[np.float64]
    """(k, 3): where on that face."""
    new_vertex_colour_sources: Ids
    """(k,): the source that gave the values, an index into ``holes[hole].sources``."""
    new_vertex_colour_confidences: NDArray[np.float64]
    """(k,): 0 to 1, how far that place has the colours around the hole; else the shape's confidence."""
    new_vertex_values: NDArray[np.float64]
    """(k, c): what `vertex_values` are at the new vertices, copied from where the shape was copied from
    as far as the surroundings bear it out, else carried in from the rim; (k, 0) without them."""
    new_face_holes: Ids
    """(j,): the id of the hole that each new face fills."""
    holes: Holes
    """All holes of the input, filled or not: the report."""
    seconds: float
    """Wall seconds that the completion took."""
    cpu_seconds: float
    """CPU seconds that the process spent, in all its threads, meanwhile."""

    def __init__(
        self,
        lib: Library,
        handle: c.c_void_p,
        mesh: Mesh,
        value_channels: int,
        whole_mesh: bool,
    ) -> None:
        vertices, faces = mesh.vertices, mesh.faces
        k, j = lib.result_new_vertex_count(handle), lib.result_new_face_count(handle)

        def array(name: str, count: int, dtype: Any) -> NDArray[Any]:
            return copied(getattr(lib, "result_" + name)(handle), count, np.dtype(dtype))

        def ids(name: str, count: int) -> Ids:
            numbers = array(name, count, np.uint32)
            return np.where(numbers == 0xFFFFFFFF, -1, numbers.astype(np.int64))

        self.new_vertices = array("new_vertices", k * 3, vertices.dtype).reshape(-1, 3)
        index = faces.dtype
        if len(vertices) + k - 1 > np.iinfo(index).max:
            index = np.dtype(np.int64)
        self.new_faces = array("new_faces", j * 3, np.uint32).astype(index).reshape(-1, 3)
        self.new_vertex_holes = ids("new_vertex_holes", k)
        self.new_vertex_source_faces = ids("new_vertex_source_faces", k)
        self.new_vertex_barycentrics = array("new_vertex_barycentrics", k * 3, float).reshape(-1, 3)
        self.new_vertex_sources = ids("new_vertex_sources", k)
        self.new_vertex_confidences = array("new_vertex_confidences", k, float)
        self.new_vertex_colour_faces = ids("new_vertex_colour_faces", k)
        weights = array("new_vertex_colour_barycentrics", k * 3, float)
        self.new_vertex_colour_barycentrics = weights.reshape(-1, 3)
        self.new_vertex_colour_sources = ids("new_vertex_colour_sources", k)
        self.new_vertex_colour_confidences = array("new_vertex_colour_confidences", k, float)
        values = array("new_vertex_values", k * value_channels, float)
        self.new_vertex_values = values.reshape(k, value_channels)
        self.new_face_holes = ids("new_face_holes", j)
        self.holes = Holes(lib, lib.result_holes(handle))
        self.seconds = lib.result_seconds(handle)
        self.cpu_seconds = lib.result_cpu_seconds(handle)
        self.input_vertex_count, self.input_face_count = len(vertices), len(faces)
        if whole_mesh:
            self.vertices = np.concatenate([vertices, self.new_vertices])
            self.faces = np.concatenate([faces.astype(index, copy=False), self.new_faces])

    @property
    def filled_count(self) -> int:
        """How many holes were filled."""
        return sum(hole.status == "filled" for hole in self.holes)

    @property
    def new_vertex_transforms(self) -> NDArray[np.float64]:
        """(k, 3, 4): for each new vertex the transform of its source."""
        transforms = np.full((len(self.new_vertices), 3, 4), np.nan)
        for hole in self.holes:
            own = slice(hole.first_new_vertex, hole.first_new_vertex + hole.new_vertex_count)
            sources = self.new_vertex_sources[own]
            if hole.sources:
                table = np.stack([source.transform for source in hole.sources])
                transforms[own][sources >= 0] = table[sources[sources >= 0]]
        return transforms

    def __repr__(self) -> str:
        return (
            f"Result({self.filled_count} of {len(self.holes)} holes filled, "
            f"{len(self.new_vertices)} vertices and {len(self.new_faces)} faces new)"
        )


def _hole(lib: Library, handle: c.c_void_p | int, i: int) -> Hole:
    info = _abi.Hole()
    if not lib.holes_get(handle, i, c.byref(info), c.sizeof(info)):
        raise IndexError(f"no hole {i}")
    return Hole(
        id=info.id,
        kind=_name(_abi.HOLE_KINDS, info.kind),
        status=_name(_abi.HOLE_STATUSES, info.status),
        reason=lib.holes_reason(handle, i).decode(),
        is_unsafe=bool(info.is_unsafe),
        loops=tuple(lib.list(lib.holes_loop, handle, i, k) for k in range(info.loop_count)),
        edge_count=info.edge_count,
        circumference=info.circumference,
        diameter=info.diameter,
        centre=np.array(info.centre),
        first_new_vertex=info.first_new_vertex,
        new_vertex_count=info.new_vertex_count,
        first_new_face=info.first_new_face,
        new_face_count=info.new_face_count,
        method=_name(_abi.METHODS, info.method),
        fairing=_name(_abi.FAIRINGS, info.fairing),
        confidence=info.confidence,
        coherence_error_before=info.coherence_error_before,
        coherence_error_after=info.coherence_error_after,
        candidate_count=info.candidate_count,
        seconds=info.seconds,
        sources=tuple(_source(lib, handle, i, k) for k in range(info.source_count)),
        problem_vertices=lib.list(lib.holes_problem_elements, handle, i, _abi.VERTEX),
        problem_edges=lib.list(lib.holes_problem_elements, handle, i, _abi.EDGE, width=2),
        is_border=bool(info.is_border),
        detectors_asked=_names(_abi.DETECTORS, info.detectors_asked),
        detectors_agreed=_names(_abi.DETECTORS, info.detectors_agreed),
        boundary_probability=info.boundary_probability,
        missing_points=info.missing_points,
    )


def _source(lib: Library, handle: c.c_void_p | int, hole: int, i: int) -> Source:
    info = _abi.Source()
    if not lib.holes_source(handle, hole, i, c.byref(info), c.sizeof(info)):
        raise IndexError(f"no source {i}")
    return Source(
        transform=np.array(info.transform).reshape(3, 4),
        mirrored=bool(info.mirrored),
        error=info.error,
        weight=info.weight,
        vertex_count=info.vertex_count,
        coloured_count=info.coloured_count,
    )


def _names(names: tuple[str, ...], bits: int) -> tuple[str, ...]:
    """What bits stand for, from the lowest."""
    return tuple(_name(names, k) for k in range(bits.bit_length()) if bits >> k & 1)


def _name(names: tuple[str, ...], number: int) -> str:
    """A newer library may have values that this package does not know."""
    return names[number] if number < len(names) else str(number)
