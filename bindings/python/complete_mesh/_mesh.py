# SPDX-License-Identifier: MIT OR Apache-2.0
"""The calls."""

from __future__ import annotations

import weakref
from typing import Any, Optional, Sequence

from numpy.typing import ArrayLike

from ._arrays import Mesh
from ._library import library
from ._options import Call, Progress
from ._points import Cloud
from ._result import Holes, Result

_OUTPUTS = ("whole_mesh", "new_only")


def complete_mesh(
    vertices: ArrayLike,
    faces: ArrayLike,
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
    source_faces: Optional[ArrayLike] = None,
    exemplar_vertices: Optional[ArrayLike] = None,
    exemplar_faces: Optional[ArrayLike] = None,
    exemplar_only: bool = False,
    unmirrored: bool = False,
    initial_vertices: Optional[ArrayLike] = None,
    initial_faces: Optional[ArrayLike] = None,
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
    part: bool = False,
    loose_vertices: Optional[ArrayLike] = None,
    threads: int = 0,
    output: str = "whole_mesh",
    progress: Optional[Progress] = None,
) -> Result:
    """Fills holes of a triangle mesh.

    The arrays are only read; float32, float64, int32 and uint32 rows of three numbers side by side
    (packed, or columns of a wider array) are read where they lie, others are copied. The GIL is
    released: other threads run, and must leave the arrays alone.

    Args:
        vertices: (n, 3) positions, float32 or float64, in any unit: the mesh unit.
        faces: (m, 3) vertex indices, integers, counter-clockwise seen from outside.
        method: "coherent" continues what the object shows, or is smooth where nothing serves;
            "smooth" is always smooth; "harary" is the paper's method as written, slow;
            "fragment" copies fragments of the object (Bendels et al. 2005); "warp" warps the most
            similar patch into the hole (Park et al. 2006).
        fairing: the smooth surface to start from: "auto", "none", "c0", "c1", "c2",
            "least_squares" or "smoothed_plate".
        sizing: the edge length that new triangles aim for: "surroundings", "scaled" (that times
            `sizing_value`), "edge_length" (`sizing_value`) or "none".
        sizing_value: a factor, 0.05 to 20, or a length in mesh units.
        grouping: which boundary loops are one hole: "automatic" (loops that face each other),
            "separate" (every loop), or "join" (the lists of `join_vertices`).
        join_vertices: a list of vertices for each hole; any vertex of a loop stands for the loop.
        selection: which holes: "all", "ids", "max_edges", "max_circumference", "max_diameter",
            "all_but_largest", "near_point" or "near_vertices".
        selection_ids: ids of holes for "ids", indices of vertices for "near_vertices".
        selection_max_edges: boundary edges, for "max_edges".
        selection_length: mesh units, for "max_circumference" and "max_diameter".
        selection_point: (3,), mesh units, for "near_point".
        skip_unsafe: leave a hole open that cannot be filled, and say why in the report, instead
            of failing.
        source_faces: (m,) bool: which faces of the mesh may be copied from; None: all.
        exemplar_vertices: another mesh to copy from, (p, 3), in any position and of the same
            scale, e.g. an intact twin.
        exemplar_faces: its faces, (q, 3).
        exemplar_only: copy from the exemplar alone.
        unmirrored: copy nothing mirrored.
        initial_vertices: new vertices of a completion to start from instead of a smooth one, (k, 3).
            A hole that it does not fill fails.
        initial_faces: its new faces, (l, 3), numbered as those of a result: new vertices from n on.
        vertex_values: what the vertices carry, colours or any numbers, (n, c) or (n,): completed with
            the shape, see `Result.new_vertex_values`.
        exemplar_values: the same of the exemplar's vertices, (p, c) or (p,).
        steering_channels: how many numbers of a row, from the first on, help to find what is copied:
            3 for red, green and blue.
        placement: (3, 4) or (4, 4): the one place to copy from, given by hand, as the transform from
            the source to the hole (`Source.transform`); of the exemplar, if there is one. It may
            turn, mirror, scale and shift.
        refine: improve the placement by what is known around the hole.
        candidate: make each fill from this one of the places found, counted from 1, the best first; 0:
            from all together. A hole that has fewer gets a smooth fill; see `Hole.candidate_count`.
        scale_range: (least, greatest) factor by which sources may be scaled, within 0.001 to 1000. The
            wider, the slower.
        exemplar_parts: how many vertices each of several exemplars has that stand one after the other in
            exemplar_vertices, faces in the same order; each may lie anywhere. None: they are one.
        constraint_points: (p, 3): points inside holes that fills pass through, smooth ones, too. One
            that is farther from its hole's middle than the hole's diameter is refused.
        softness: how far fills may stay off the points, 0 to 1; 0.1 halves the height of a bump over
            the whole hole.
        part: fill each hole with a part taken whole, with the source's own triangles: a missing hand,
            foot or spout. It is what lies over the hole at `placement`, or at the first of the places
            found that has one.
        loose_vertices: vertices of rims where the fill need only be joined: neither tangents nor relief
            nor values go on from what lies beyond them.
        threads: worker threads, 0 for as many as there are cores. The result does not depend on it.
        output: "whole_mesh", or "new_only" for a result without `vertices` and `faces`.
        progress: called as ``progress(fraction, stage)`` with 0 to 1 and a word or two, on the
            calling thread. What it returns cancels the call if it is true; what it raises cancels
            the call and comes out of it.

    Raises:
        CompleteMeshError: with a status and the elements that are in the way.
        Cancelled: progress returned something true.
        TypeError, ValueError: an argument cannot be.
    """
    options = dict(locals())
    whole_mesh = _is_whole(options.pop("output"))
    lib, mesh = library(), Mesh(options.pop("vertices"), options.pop("faces"))
    call = Call(lib, mesh, **options)
    handle = call.run(lib.complete, lib.result_free, *mesh.arguments())
    try:
        return Result(lib, handle, mesh, call.options.value_channels, whole_mesh)
    finally:
        lib.result_free(handle)


def list_holes(
    vertices: ArrayLike,
    faces: Optional[ArrayLike] = None,
    *,
    normals: Optional[ArrayLike] = None,
    grouping: str = "automatic",
    join_vertices: Optional[Sequence[Sequence[int]]] = None,
    selection: str = "all",
    selection_ids: Optional[ArrayLike] = None,
    selection_max_edges: Optional[int] = None,
    selection_length: Optional[float] = None,
    selection_point: Optional[ArrayLike] = None,
    given_loops: Sequence[Sequence[int]] = (),
    given_regions: Optional[ArrayLike] = None,
    threads: int = 0,
    progress: Optional[Progress] = None,
) -> Holes:
    """Finds and measures the holes of a mesh, or without faces of a point cloud, and fills nothing.

    Arguments and errors are those of `complete_mesh`, for a cloud those of `complete_points`. Holes
    outside the selection are listed with the status "not_selected", and so are the outer borders of a
    cloud that are not named.
    """
    options = dict(locals())
    for name in ("vertices", "faces", "normals"):
        del options[name]
    lib = library()
    if faces is None:
        cloud = Cloud(vertices, normals)
        call = Call(lib, cloud.mesh, **options)
        handle = call.run(lib.find_point_holes, lib.holes_free, *cloud.arguments())
    elif len(given_loops) or given_regions is not None:
        raise ValueError("given_loops and given_regions are those of a cloud, which has no faces")
    elif normals is None:
        mesh = Mesh(vertices, faces)
        call = Call(lib, mesh, **options)
        handle = call.run(lib.find_holes, lib.holes_free, *mesh.arguments())
    else:
        raise ValueError("normals are those of a cloud, which has no faces")
    try:
        return Holes(lib, handle)
    finally:
        lib.holes_free(handle)


class Completer:
    """A mesh whose holes are known, for filling them more than once with different options.

    Arguments and errors are those of `complete_mesh`. The arrays are copied, and may be changed
    afterwards. Several threads may use one completer at once.
    """

    def __init__(
        self,
        vertices: ArrayLike,
        faces: ArrayLike,
        *,
        grouping: str = "automatic",
        join_vertices: Optional[Sequence[Sequence[int]]] = None,
        progress: Optional[Progress] = None,
    ) -> None:
        self._lib = library()
        self._mesh = Mesh(vertices, faces, copy=True)
        call = Call(
            self._lib,
            self._mesh,
            grouping=grouping,
            join_vertices=join_vertices,
            progress=progress,
        )
        self._handle = call.run(
            self._lib.completer_new, self._lib.completer_free, *self._mesh.arguments()
        )
        # The library reads the arrays: they are kept until it has let go of them.
        weakref.finalize(self, _free, self._lib, self._handle, self._mesh)
        self.holes = Holes(self._lib, self._lib.completer_holes(self._handle))

    def complete(
        self,
        *,
        method: str = "coherent",
        fairing: str = "auto",
        sizing: str = "surroundings",
        sizing_value: Optional[float] = None,
        selection: str = "all",
        selection_ids: Optional[ArrayLike] = None,
        selection_max_edges: Optional[int] = None,
        selection_length: Optional[float] = None,
        selection_point: Optional[ArrayLike] = None,
        skip_unsafe: bool = False,
        source_faces: Optional[ArrayLike] = None,
        exemplar_vertices: Optional[ArrayLike] = None,
        exemplar_faces: Optional[ArrayLike] = None,
        exemplar_only: bool = False,
        unmirrored: bool = False,
        initial_vertices: Optional[ArrayLike] = None,
        initial_faces: Optional[ArrayLike] = None,
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
        part: bool = False,
        loose_vertices: Optional[ArrayLike] = None,
        threads: int = 0,
        output: str = "whole_mesh",
        progress: Optional[Progress] = None,
    ) -> Result:
        """Fills holes of the mesh; the same as `complete_mesh` with the same options."""
        options = dict(locals())
        del options["self"]
        whole_mesh = _is_whole(options.pop("output"))
        call = Call(self._lib, self._mesh, **options)
        handle = call.run(
            self._lib.completer_complete, self._lib.result_free, self._handle
        )
        try:
            return Result(
                self._lib, handle, self._mesh, call.options.value_channels, whole_mesh
            )
        finally:
            self._lib.result_free(handle)

    def candidates(self, count: int = 5, **options: Any) -> list[Result]:
        """The completions that the best places alone make, best first, `count` at most; each hole's
        source has the transform and the error. Keywords are those of `complete`, without
        `candidate`. The places are searched for once."""
        made: list[Result] = []
        for candidate in range(1, count + 1):
            result = self.complete(candidate=candidate, **options)
            if all(hole.candidate_count < candidate for hole in result.holes):
                break
            made.append(result)
        return made


def candidates(
    vertices: ArrayLike,
    faces: ArrayLike,
    count: int = 5,
    *,
    grouping: str = "automatic",
    join_vertices: Optional[Sequence[Sequence[int]]] = None,
    **options: Any,
) -> list[Result]:
    """The completions that the best places alone make: `Completer.candidates` of a new completer."""
    completer = Completer(vertices, faces, grouping=grouping, join_vertices=join_vertices)
    return completer.candidates(count, **options)


def _is_whole(output: str) -> bool:
    if output not in _OUTPUTS:
        raise ValueError(f"output is {output!r}, but must be one of {', '.join(_OUTPUTS)}")
    return output == "whole_mesh"


def _free(lib: Any, handle: Any, _mesh: Mesh) -> None:
    lib.completer_free(handle)
