# SPDX-License-Identifier: GPL-3.0-or-later
"""One fill, from arrays to a result, without Blender: this runs on a thread of its own. What was
learnt from the last meshes is kept, so that the redo panel need not wait for it again."""

import hashlib
import threading
from dataclasses import dataclass, field

import numpy as np

from .complete_mesh import CompleteMeshError, Completer, complete_points, list_holes

# Two: the mesh before a fill and, for a second fill, the mesh after it.
KEPT_MESHES = 2

_lock = threading.Lock()
_kept = {}  # (hash of the mesh, whether a cloud, grouping): Kept; the last used is the last


@dataclass
class Options:
    """What the library is asked for; all of it comes from the operator's properties."""

    method: str = "coherent"
    density: float = 1.0
    max_edges: int = 0
    keep_largest_open: bool = False
    join_loops: bool = True
    skip_unsafe: bool = False
    mirror: bool = True
    all_if_untouched: bool = False
    """Whether a selection that touches no hole chooses all."""
    is_cloud: bool = False
    """Points alone: new points are added."""
    normals: np.ndarray | None = None
    """Of the points of a cloud, if it has any."""
    sources: dict = field(default_factory=dict)
    """The library's source_faces, or exemplar_vertices and exemplar_faces: see guidance.py."""
    guidance: dict = field(default_factory=dict)
    """Its placement and refine, or candidate and scale_range; and part."""
    points: dict = field(default_factory=dict)
    """Its constraint_points and softness."""
    rims: dict = field(default_factory=dict)
    """Its loose_vertices, initial_vertices and initial_faces."""
    values: dict = field(default_factory=dict)
    """The library's vertex_values and what belongs to them: see values.py."""

    @property
    def grouping(self):
        return "automatic" if self.join_loops else "separate"

    def arguments(self):
        """The library's own names for what the result depends on, beside the choice of holes."""
        arguments = {"method": self.method, "skip_unsafe": self.skip_unsafe}
        arguments |= {"unmirrored": not self.mirror, **self.sources, **self.values}
        arguments |= {**self.points, **self.rims}
        if self.method == "coherent":
            arguments |= self.guidance
        if self.density != 1.0:
            # A density of 2 is twice as many vertices along an edge.
            arguments |= {"sizing": "scaled", "sizing_value": 1.0 / self.density}
        return arguments


class NothingToFill(Exception):
    """There is no hole that was asked for, or nothing to copy from; the text says why."""


class Kept:
    """A completer, or a cloud, and its last result."""

    def __init__(self, completer):
        self.completer = completer
        self.asked, self.result = None, None

    def fill(self, progress, **arguments):
        asked = [
            (name, content_hash(value) if isinstance(value, np.ndarray) else repr(value))
            for name, value in sorted(arguments.items())
        ]
        if asked != self.asked:
            result = self.completer.complete(output="new_only", progress=progress, **arguments)
            self.asked, self.result = asked, result
        return self.result


class Cloud:
    """A cloud of points in the place of a completer. Its holes are listed only if somebody asks."""

    def __init__(self, points, normals, grouping):
        self._points, self._normals, self._grouping = points, normals, grouping
        self._holes = None

    @property
    def holes(self):
        if self._holes is None:
            self._holes = list_holes(self._points, normals=self._normals, grouping=self._grouping)
        return self._holes

    def complete(self, output, **arguments):
        assert output == "new_only"
        return complete_points(self._points, self._normals, grouping=self._grouping, **arguments)


def fill(vertices, triangles, selected, options, progress=None):
    """The fill of the holes that are chosen. `selected`: (n,) bool, which vertices are; if any is,
    only holes that one of them lies on; but see all_if_untouched. An error that names holes has
    their edges as `rims`."""
    progress = progress or (lambda _fraction, _stage: False)
    if not len(triangles) and not options.is_cloud:
        raise NothingToFill("The mesh has edges and no faces: fill needs faces, or vertices alone")
    kept = _completer(vertices, triangles, options, progress)
    arguments = options.arguments()
    if "loose_vertices" in arguments:
        arguments["loose_vertices"] = on_rims(kept.completer.holes, arguments["loose_vertices"])
    try:
        result = kept.fill(
            # Finding the holes is quick: a twentieth of the bar.
            lambda fraction, stage: progress(0.05 + 0.95 * fraction, stage),
            **selection(kept.completer, selected, options),
            **arguments,
        )
        if all(hole.is_border for hole in result.holes):
            raise NothingToFill("The points have no holes" + " but their border" * bool(len(result.holes)))
        return result
    except CompleteMeshError as error:
        if len(error.holes):
            error.rims = rims(kept.completer.holes, error.holes)
        raise


def selection(completer, selected, options):
    """The library's selection, as ids but where a cloud's holes need not be listed for it."""
    if options.is_cloud and not (selected.any() or options.max_edges or options.keep_largest_open):
        return {"selection": "all"}
    return {"selection": "ids", "selection_ids": choose(completer.holes, selected, options)}


def choose(holes, selected, options):
    """The ids of the holes to fill. The border of a cloud is none unless it is touched."""
    chosen = list(holes) if selected.any() else [hole for hole in holes if not hole.is_border]
    if not chosen:
        raise NothingToFill("The mesh has no holes")
    if selected.any():
        touched = [hole for hole in chosen if any(selected[loop].any() for loop in hole.loops)]
        if not touched and not options.all_if_untouched:
            raise NothingToFill(
                "No hole touches the selection: select a vertex of a rim, or nothing to fill all holes"
            )
        chosen = touched or chosen
    if options.keep_largest_open:
        largest = max(holes, key=lambda hole: hole.circumference)
        chosen = [hole for hole in chosen if hole is not largest]
        if not chosen:
            raise NothingToFill("There is no hole but the largest, and that is to be kept open")
    if options.max_edges:
        chosen = [hole for hole in chosen if hole.edge_count <= options.max_edges]
        if not chosen:
            raise NothingToFill(f"Every hole has more than {options.max_edges} edges")
    return [hole.id for hole in chosen]


def on_rims(holes, vertices):
    """Those of some vertices that lie on a rim."""
    loops = [loop for hole in holes for loop in hole.loops]
    found = np.intersect1d(vertices, np.concatenate([np.empty(0, np.int64), *loops]))
    if not len(found):
        raise NothingToFill("No vertex of the group of the loose rim lies on a rim")
    return found


def rims(holes, ids):
    """(k, 2): the boundary edges of some holes."""
    loops = [loop for i in ids for loop in holes[int(i)].loops]
    pairs = [np.stack([loop, np.roll(loop, -1)], axis=1) for loop in loops]
    return np.concatenate([np.empty((0, 2), np.int64), *pairs])


def content_hash(*arrays):
    digest = hashlib.blake2b(digest_size=16)
    for array in arrays:
        digest.update(np.ascontiguousarray(array))
        digest.update(str(array.shape).encode())
    return digest.digest()


def forget():
    """Frees what is kept."""
    with _lock:
        _kept.clear()


def _completer(vertices, triangles, options, progress):
    arrays = [vertices, triangles] + ([] if options.normals is None else [options.normals])
    key = content_hash(*arrays), options.is_cloud, options.grouping
    with _lock:
        kept = _kept.pop(key, None)
    if kept is None:
        if options.is_cloud:
            kept = Kept(Cloud(vertices, options.normals, options.grouping))
        else:
            completer = Completer(
                vertices,
                triangles,
                grouping=options.grouping,
                progress=lambda fraction, stage: progress(0.05 * fraction, stage),
            )
            kept = Kept(completer)
    with _lock:
        _kept[key] = kept
        while len(_kept) > KEPT_MESHES:
            _kept.pop(next(iter(_kept)))
    return kept


class Job:
    """A fill on a thread of its own. The thread touches arrays only."""

    def __init__(self, *arguments):
        self.fraction, self.stage = 0.0, ""
        self.cancelled = False
        self.result, self.error = None, None
        self._thread = threading.Thread(target=self._work, args=arguments, daemon=True)
        self._thread.start()

    def _work(self, *arguments):
        try:
            self.result = fill(*arguments, progress=self._progress)
        except Exception as error:  # the operator shows it
            self.error = error

    def _progress(self, fraction, stage):
        self.fraction, self.stage = fraction, stage
        return self.cancelled

    @property
    def is_running(self):
        return self._thread.is_alive()

    def stop(self):
        self.cancelled = True
        self._thread.join()
