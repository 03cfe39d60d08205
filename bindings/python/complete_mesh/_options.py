# SPDX-License-Identifier: MIT OR Apache-2.0
"""Keyword arguments into the C options, and the progress function."""

from __future__ import annotations

import ctypes as c
import signal
import threading
from typing import Any, Callable, Optional, Sequence, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _abi
from ._arrays import Mesh
from ._library import Library

Progress = Callable[[float, str], Any]

# Which of the selection_ arguments each selection reads.
_READS = {
    "ids": "selection_ids",
    "near_vertices": "selection_ids",
    "max_edges": "selection_max_edges",
    "max_circumference": "selection_length",
    "max_diameter": "selection_length",
    "near_point": "selection_point",
}


class Call:
    """One call's options. It holds whatever the C struct points to, so it must outlive the call."""

    def __init__(
        self,
        lib: Library,
        mesh: Mesh,
        *,
        method: str = "coherent",
        fairing: str = "auto",
        sizing: str = "surroundings",
        sizing_value: Optional[float] = None,
        grouping: str = "automatic",
        join_vertices: Optional[Sequence[Sequence[int]]] = None,
        selection: str = "all",
        skip_unsafe: bool = False,
        threads: int = 0,
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
        clean: Union[bool, int] = False,
        given_loops: Sequence[Sequence[int]] = (),
        given_regions: Optional[ArrayLike] = None,
        progress: Optional[Progress] = None,
        **selected: Any,
    ) -> None:
        self._lib = lib
        self._kept: list[Any] = []
        self._raised: Optional[BaseException] = None
        self._interrupts = _Interrupts()
        self.options = options = _abi.Options()
        lib.check(lib.options_init(c.byref(options), c.sizeof(options)))
        options.vertex_type = mesh.vertex_type
        options.vertex_stride = mesh.vertex_stride
        options.face_stride = mesh.face_stride
        options.method = _number("method", method, _abi.METHODS)
        options.fairing = _number("fairing", fairing, _abi.FAIRINGS)
        options.skip_unsafe = bool(skip_unsafe)
        options.threads = _unsigned("threads", threads)
        # The whole mesh is put together here: that saves the library a copy of it.
        options.output = _abi.OUTPUT_NEW_ONLY
        self._set_sizing(sizing, sizing_value)
        self._set_grouping(grouping, join_vertices)
        self._set_selection(selection, selected)
        self._set_source_faces(source_faces, len(mesh.faces))
        self._set_surface("exemplar", exemplar_vertices, exemplar_faces, mesh)
        options.exemplar_only = bool(exemplar_only)
        options.unmirrored = bool(unmirrored)
        self._set_surface("initial", initial_vertices, initial_faces, mesh)
        self._set_values(vertex_values, exemplar_values, steering_channels, len(mesh.vertices))
        self._set_guidance(placement, refine, candidate, scale_range)
        if exemplar_parts is not None:
            options.exemplar_parts = self._indices("exemplar_parts", exemplar_parts)
            options.exemplar_part_count = len(exemplar_parts)
        self._set_points(constraint_points, softness)
        options.part = bool(part)
        if loose_vertices is not None:
            loose = np.asarray(loose_vertices)
            options.loose_vertices = self._indices("loose_vertices", loose)
            options.loose_count = loose.size
        options.clean = clean is not False
        if not isinstance(clean, bool):
            options.clean_rounds = _unsigned("clean", clean)
        self._set_given(given_loops, given_regions)
        self._set_progress(progress)

    def run(self, function: Any, free: Any, *arguments: object) -> c.c_void_p:
        """Calls; gives the new object, to be freed with `free`, or raises what went wrong."""
        made = c.c_void_p()
        with _Interrupts() as self._interrupts:
            status = function(*arguments, c.byref(self.options), c.byref(made))
        if self._interrupts.came and self._raised is None:  # after the last progress call
            free(made)
            raise KeyboardInterrupt
        if self._raised is not None:
            raise self._raised
        self._lib.check(status)
        return made

    def _set_sizing(self, sizing: str, value: Optional[float]) -> None:
        self.options.sizing = _number("sizing", sizing, _abi.SIZINGS)
        _together("sizing", sizing, ("scaled", "edge_length"), "sizing_value", value)
        if value is not None:
            self.options.sizing_value = value

    def _set_grouping(self, grouping: str, lists: Optional[Sequence[Sequence[int]]]) -> None:
        self.options.grouping = _number("grouping", grouping, _abi.GROUPINGS)
        _together("grouping", grouping, ("join",), "join_vertices", lists)
        if lists is not None:
            options = self.options
            options.join_vertices, options.join_sizes = self._lists("join_vertices", lists)
            options.join_count = len(lists)

    def _set_given(self, loops: Sequence[Sequence[int]], regions: Optional[ArrayLike]) -> None:
        options = self.options
        options.given_loop_points, options.given_loop_sizes = self._lists("given_loops", loops)
        options.given_loop_count = len(loops)
        if regions is not None:
            kept = self._floats("given_regions", regions, 4)
            options.given_regions, options.given_region_count = kept.ctypes.data, len(kept)

    def _set_selection(self, selection: str, given: dict[str, Any]) -> None:
        options = self.options
        options.selection = _number("selection", selection, _abi.SELECTIONS)
        for name, value in given.items():
            readers = tuple(reader for reader, read in _READS.items() if read == name)
            _together("selection", selection, readers, name, value)
            if value is None:
                continue
            if name == "selection_ids":
                options.selection_ids = self._indices(name, value)
                options.selection_count = np.size(value)
            elif name == "selection_max_edges":
                options.selection_max_edges = _unsigned(name, value)
            elif name == "selection_length":
                options.selection_length = value
            else:
                options.selection_point = tuple(np.asarray(value, np.float64).reshape(3))

    def _set_source_faces(self, given: Optional[ArrayLike], face_count: int) -> None:
        if given is None:
            return
        mask = np.asarray(given)
        if mask.dtype != np.bool_ or mask.shape != (face_count,):
            raise ValueError(
                f"source_faces are {mask.dtype} of the shape {mask.shape}, but must be a bool for "
                f"each face: ({face_count},)"
            )
        kept = np.array(mask, np.uint8)
        self._kept.append(kept)
        self.options.source_faces = kept.ctypes.data

    def _set_surface(
        self, name: str, vertices: Optional[ArrayLike], faces: Optional[ArrayLike], mesh: Mesh
    ) -> None:
        """The options NAME_vertices, NAME_faces and their counts, packed and in the mesh's dtype."""
        if (vertices is None) != (faces is None):
            raise ValueError(f"{name}_vertices and {name}_faces need each other")
        if vertices is None or faces is None:
            return
        given = Mesh(vertices, faces)
        positions = np.array(given.vertices, mesh.vertices.dtype, order="C")
        packed = Mesh(positions, given.faces, copy=True)
        self._kept.append(packed)
        fields = ("vertices", "vertex_count", "faces", "face_count")
        for field, value in zip(fields, packed.arguments()):
            setattr(self.options, f"{name}_{field}", value)

    def _set_values(
        self,
        of_mesh: Optional[ArrayLike],
        of_exemplar: Optional[ArrayLike],
        steering_channels: int,
        vertex_count: int,
    ) -> None:
        """The values of the vertices, a row each; a bare number is a row of one."""
        self.options.steering_channels = _unsigned("steering_channels", steering_channels)
        if of_mesh is None:
            if of_exemplar is not None or steering_channels:
                raise ValueError("exemplar_values and steering_channels need vertex_values")
            return
        rows = _rows("vertex_values", of_mesh, vertex_count)
        self._kept.append(rows)
        self.options.vertex_values = rows.ctypes.data
        self.options.value_channels = rows.shape[1]
        if of_exemplar is not None:
            rows = _rows("exemplar_values", of_exemplar, self.options.exemplar_vertex_count)
            if rows.shape[1] != self.options.value_channels:
                raise ValueError("exemplar_values and vertex_values have rows of different lengths")
            self._kept.append(rows)
            self.options.exemplar_values = rows.ctypes.data

    def _lists(
        self, name: str, lists: Sequence[Sequence[int]]
    ) -> tuple[Optional[int], Optional[int]]:
        """The addresses of the numbers of all lists, and of their lengths."""
        of_all = [i for own in lists for i in own]
        return self._indices(name, of_all), self._indices(name, [len(own) for own in lists])

    def _floats(self, name: str, given: ArrayLike, width: int) -> NDArray[np.float64]:
        """A copy, which self keeps."""
        kept = np.array(given, np.float64, order="C")
        if kept.ndim != 2 or kept.shape[1] != width:
            raise ValueError(f"{name} have the shape {kept.shape}, but must be (p, {width})")
        self._kept.append(kept)
        return kept

    def _indices(self, name: str, numbers: Any) -> Optional[int]:
        """The address of a copy as 32-bit numbers, which self keeps; None if there are none."""
        array = np.asarray(numbers).reshape(-1)
        if not array.size:
            return None
        if array.dtype.kind not in "iu":
            raise TypeError(f"{name} are {array.dtype}, but must be integers")
        if array.min() < 0 or array.max() > 0xFFFFFFFF:
            raise ValueError(f"{name} has a number outside 0 to 2**32 - 1")
        kept = np.array(array, np.uint32)
        self._kept.append(kept)
        return kept.ctypes.data

    def _set_guidance(
        self,
        placement: Optional[ArrayLike],
        refine: bool,
        candidate: int,
        scale_range: Optional[Sequence[float]],
    ) -> None:
        if placement is not None:
            matrix = np.array(placement, np.float64)
            if matrix.shape == (4, 4) and (matrix[3] == (0, 0, 0, 1)).all():
                matrix = matrix[:3]
            if matrix.shape != (3, 4):
                raise ValueError(
                    f"placement has the shape {np.shape(placement)}, but must be a matrix of (3, 4), "
                    "or of (4, 4) whose last row is 0, 0, 0, 1"
                )
            kept = np.ascontiguousarray(matrix)
            self._kept.append(kept)
            self.options.placement = kept.ctypes.data
        self.options.refine = bool(refine)
        self.options.candidate = _unsigned("candidate", candidate)
        if scale_range is not None:
            # 0 and 0 are the default of the library, and would be ignored.
            least, greatest = (float(x) or np.nan for x in scale_range)
            self.options.least_scale, self.options.greatest_scale = least, greatest

    def _set_points(self, points: Optional[ArrayLike], softness: float) -> None:
        if points is not None:
            kept = self._floats("constraint_points", points, 3)
            self.options.constraint_points = kept.ctypes.data
            self.options.constraint_count = len(kept)
        self.options.softness = softness

    def _set_progress(self, progress: Optional[Progress]) -> None:
        def report(_user: Any, fraction: float, stage: bytes) -> int:
            if self._interrupts.came:
                self._raised = KeyboardInterrupt()
                return 1
            try:
                return int(progress is not None and bool(progress(fraction, stage.decode())))
            except BaseException as error:  # cancels the call, which then raises it
                self._raised = error
                return 1

        self.options.progress = _abi.PROGRESS(report)


class _Interrupts:
    """Notes Ctrl-C during a call instead of raising. Python would raise at the first line of the
    progress function, where ctypes loses it. A handler that is not Python's own is left alone."""

    def __init__(self) -> None:
        self.came = False
        self._replaced = False

    def __enter__(self) -> _Interrupts:
        if (
            threading.current_thread() is threading.main_thread()
            and signal.getsignal(signal.SIGINT) is signal.default_int_handler
        ):
            signal.signal(signal.SIGINT, self._note)
            self._replaced = True
        return self

    def __exit__(self, *_: object) -> None:
        if self._replaced:
            signal.signal(signal.SIGINT, signal.default_int_handler)

    def _note(self, *_: object) -> None:
        self.came = True


def _rows(name: str, given: ArrayLike, count: int) -> NDArray[np.float64]:
    rows = np.array(given, np.float64, order="C")
    if rows.ndim == 1:
        rows = rows[:, None]
    if rows.ndim != 2 or len(rows) != count or rows.shape[1] == 0:
        raise ValueError(
            f"{name} have the shape {np.shape(given)}, but must have a row for each vertex: ({count}, c)"
        )
    return rows


def _number(name: str, value: str, names: tuple[str, ...]) -> int:
    if value not in names:
        raise ValueError(f"{name} is {value!r}, but must be one of {', '.join(names)}")
    return names.index(value)


def _unsigned(name: str, value: int) -> int:
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, (int, np.integer)):
        raise TypeError(f"{name} is {value!r}, but must be a whole number")
    if not 0 <= value < 2**32:
        raise ValueError(f"{name} is {value}, but must be 0 to 2**32 - 1")
    return int(value)


def _together(name: str, value: str, readers: tuple[str, ...], other: str, given: Any) -> None:
    """An argument that would not be read is a mistake, and so is one that is missing."""
    if value in readers and given is None:
        raise ValueError(f"{name}={value!r} needs {other}")
    if value not in readers and given is not None:
        raise ValueError(f"{other} is read only with {name}={' or '.join(map(repr, readers))}")
