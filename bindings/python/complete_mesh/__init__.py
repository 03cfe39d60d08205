# SPDX-License-Identifier: MIT OR Apache-2.0
"""Fills the holes of triangle meshes so that nobody sees where they were.

    from complete_mesh import complete_mesh

    result = complete_mesh(vertices, faces)       # (n, 3) float32 or float64, (m, 3) integers
    result.vertices, result.faces                 # the input bit for bit, first, then the fill
    for hole in result.holes:
        print(hole)                               # what became of it, and from where

``complete_points`` does the same for point clouds, with new points instead of faces.
``list_holes`` finds the holes and fills nothing; ``Completer`` keeps a mesh for more than one
fill. The work is done by the shared library of the project, which lies beside this file, is named
by the environment variable COMPLETE_MESH_LIBRARY, or is installed on the system.
"""

from ._errors import Cancelled, CompleteMeshError, LibraryNotFound, Status
from ._library import library_path, library_version
from ._mesh import Completer, candidates, complete_mesh, list_holes
from ._points import PointResult, complete_points
from ._result import Hole, Holes, Result, Source

__version__ = "0.1.0"

__all__ = [
    "Cancelled",
    "CompleteMeshError",
    "Completer",
    "Hole",
    "Holes",
    "LibraryNotFound",
    "PointResult",
    "Result",
    "Source",
    "Status",
    "candidates",
    "complete_mesh",
    "complete_points",
    "library_path",
    "library_version",
    "list_holes",
]
