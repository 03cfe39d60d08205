# SPDX-License-Identifier: MIT OR Apache-2.0
"""The C header, written down for ctypes: structs, enums, signatures. Nothing is explained here that
include/complete_mesh.h explains."""

from __future__ import annotations

import ctypes as c
from ctypes import POINTER, c_double, c_int, c_int32, c_size_t, c_uint32, c_void_p

ABI_VERSION = 0

F32, F64 = 0, 1
OUTPUT_NEW_ONLY = 1
VERTEX, EDGE, FACE, HOLE = 0, 1, 2, 3

METHODS = ("smooth", "coherent", "harary", "fragment", "warp")
FAIRINGS = ("auto", "none", "c0", "c1", "c2", "least_squares", "smoothed_plate")
SIZINGS = ("surroundings", "scaled", "edge_length", "none")
GROUPINGS = ("automatic", "separate", "join")
SELECTIONS = (
    "all",
    "ids",
    "max_edges",
    "max_circumference",
    "max_diameter",
    "all_but_largest",
    "near_point",
    "near_vertices",
)
HOLE_KINDS = ("disc", "islands", "ring", "several")
DETECTORS = ("surface", "boundary", "field")
IGNORED = ("missing", "duplicate", "outlier", "inside")
HOLE_STATUSES = ("open", "filled", "not_selected", "unsafe", "failed")

PROGRESS = c.CFUNCTYPE(c_int, c_void_p, c_double, c.c_char_p)


class Options(c.Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("vertex_type", c_uint32),
        ("vertex_stride", c_size_t),
        ("face_stride", c_size_t),
        ("method", c_uint32),
        ("fairing", c_uint32),
        ("sizing", c_uint32),
        ("grouping", c_uint32),
        ("sizing_value", c_double),
        ("selection", c_uint32),
        ("skip_unsafe", c_uint32),
        ("selection_ids", c_void_p),
        ("selection_count", c_size_t),
        ("selection_max_edges", c_size_t),
        ("selection_length", c_double),
        ("selection_point", c_double * 3),
        ("join_vertices", c_void_p),
        ("join_sizes", c_void_p),
        ("join_count", c_size_t),
        ("threads", c_uint32),
        ("output", c_uint32),
        ("progress", PROGRESS),
        ("progress_user", c_void_p),
        ("source_faces", c_void_p),
        ("exemplar_vertices", c_void_p),
        ("exemplar_vertex_count", c_size_t),
        ("exemplar_faces", c_void_p),
        ("exemplar_face_count", c_size_t),
        ("exemplar_only", c_uint32),
        ("unmirrored", c_uint32),
        ("initial_vertices", c_void_p),
        ("initial_vertex_count", c_size_t),
        ("initial_faces", c_void_p),
        ("initial_face_count", c_size_t),
        ("vertex_values", c_void_p),
        ("exemplar_values", c_void_p),
        ("value_channels", c_uint32),
        ("steering_channels", c_uint32),
        ("placement", c_void_p),
        ("refine", c_uint32),
        ("candidate", c_uint32),
        ("least_scale", c_double),
        ("greatest_scale", c_double),
        ("exemplar_parts", c_void_p),
        ("exemplar_part_count", c_size_t),
        ("constraint_points", c_void_p),
        ("constraint_count", c_size_t),
        ("softness", c_double),
        ("part", c_uint32),
        ("loose_vertices", c_void_p),
        ("loose_count", c_size_t),
        ("clean", c_uint32),
        ("clean_rounds", c_uint32),
        ("given_loop_points", c_void_p),
        ("given_loop_sizes", c_void_p),
        ("given_loop_count", c_size_t),
        ("given_regions", c_void_p),
        ("given_region_count", c_size_t),
    ]


class Hole(c.Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("id", c_uint32),
        ("kind", c_uint32),
        ("status", c_uint32),
        ("fairing", c_uint32),
        ("is_unsafe", c_uint32),
        ("loop_count", c_size_t),
        ("edge_count", c_size_t),
        ("circumference", c_double),
        ("diameter", c_double),
        ("centre", c_double * 3),
        ("first_new_vertex", c_size_t),
        ("new_vertex_count", c_size_t),
        ("first_new_face", c_size_t),
        ("new_face_count", c_size_t),
        ("seconds", c_double),
        ("method", c_uint32),
        ("source_count", c_uint32),
        ("confidence", c_double),
        ("coherence_error_before", c_double),
        ("coherence_error_after", c_double),
        ("candidate_count", c_uint32),
        ("is_border", c_uint32),
        ("detectors_asked", c_uint32),
        ("detectors_agreed", c_uint32),
        ("boundary_probability", c_double),
        ("missing_points", c_double),
    ]


class Source(c.Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("mirrored", c_uint32),
        ("transform", c_double * 12),
        ("error", c_double),
        ("weight", c_double),
        ("vertex_count", c_size_t),
        ("coloured_count", c_size_t),
    ]


_mesh = [c_void_p, c_size_t, c_void_p, c_size_t, POINTER(Options), POINTER(c_void_p)]
_count = POINTER(c_size_t)

# name without the prefix: (result, arguments). Arrays are plain addresses: _library copies them.
FUNCTIONS: dict[str, tuple[object, list[object]]] = {
    "": (c_int32, _mesh),
    "points": (
        c_int32,
        [c_void_p, c_size_t, c_void_p, POINTER(Options), POINTER(c_void_p)],
    ),
    "find_holes": (c_int32, _mesh),
    "find_point_holes": (
        c_int32,
        [c_void_p, c_size_t, c_void_p, POINTER(Options), POINTER(c_void_p)],
    ),
    "completer_new": (c_int32, _mesh),
    "completer_complete": (c_int32, [c_void_p, POINTER(Options), POINTER(c_void_p)]),
    "completer_holes": (c_void_p, [c_void_p]),
    "completer_free": (None, [c_void_p]),
    "options_init": (c_int32, [POINTER(Options), c_size_t]),
    "version_string": (c.c_char_p, []),
    "abi_version": (c_uint32, []),
    "status_name": (c.c_char_p, [c_int32]),
    "last_error_message": (c.c_char_p, []),
    "last_error_elements": (c_void_p, [c_uint32, _count]),
    "holes_count": (c_size_t, [c_void_p]),
    "holes_get": (c_int32, [c_void_p, c_size_t, POINTER(Hole), c_size_t]),
    "holes_source": (c_int32, [c_void_p, c_size_t, c_size_t, POINTER(Source), c_size_t]),
    "holes_loop": (c_void_p, [c_void_p, c_size_t, c_size_t, _count]),
    "holes_reason": (c.c_char_p, [c_void_p, c_size_t]),
    "holes_problem_elements": (c_void_p, [c_void_p, c_size_t, c_uint32, _count]),
    "holes_non_manifold_edges": (c_void_p, [c_void_p, _count]),
    "holes_inconsistent_edges": (c_void_p, [c_void_p, _count]),
    "holes_degenerate_faces": (c_void_p, [c_void_p, _count]),
    "holes_duplicate_vertices": (c_void_p, [c_void_p, _count]),
    "holes_spacing": (c_double, [c_void_p]),
    "holes_only_in_field": (c_void_p, [c_void_p, _count]),
    "holes_ignored_points": (c_void_p, [c_void_p, c_uint32, _count]),
    "holes_free": (None, [c_void_p]),
    "result_new_vertex_count": (c_size_t, [c_void_p]),
    "result_new_face_count": (c_size_t, [c_void_p]),
    "result_new_vertices": (c_void_p, [c_void_p]),
    "result_new_faces": (c_void_p, [c_void_p]),
    "result_new_vertex_holes": (c_void_p, [c_void_p]),
    "result_new_vertex_source_faces": (c_void_p, [c_void_p]),
    "result_new_vertex_barycentrics": (c_void_p, [c_void_p]),
    "result_new_vertex_sources": (c_void_p, [c_void_p]),
    "result_new_vertex_confidences": (c_void_p, [c_void_p]),
    "result_new_vertex_colour_faces": (c_void_p, [c_void_p]),
    "result_new_vertex_colour_barycentrics": (c_void_p, [c_void_p]),
    "result_new_vertex_colour_sources": (c_void_p, [c_void_p]),
    "result_new_vertex_colour_confidences": (c_void_p, [c_void_p]),
    "result_new_vertex_source_points": (c_void_p, [c_void_p]),
    "result_new_vertex_normals": (c_void_p, [c_void_p]),
    "result_cleaned_points": (c_void_p, [c_void_p]),
    "result_removed_points": (c_void_p, [c_void_p]),
    "result_new_vertex_values": (c_void_p, [c_void_p]),
    "result_new_face_holes": (c_void_p, [c_void_p]),
    "result_holes": (c_void_p, [c_void_p]),
    "result_seconds": (c_double, [c_void_p]),
    "result_cpu_seconds": (c_double, [c_void_p]),
    "result_free": (None, [c_void_p]),
}
