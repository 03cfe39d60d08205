/* SPDX-License-Identifier: MIT OR Apache-2.0
 *
 * The numbers of the C ABI by name.
 * Part of complete_mesh.hpp: include that.
 */
#ifndef COMPLETE_MESH_ENUMS_HPP
#define COMPLETE_MESH_ENUMS_HPP

#include <cstdint>

#include "complete_mesh.h"

namespace mesh_completion {

enum class Status : std::int32_t {
  ok = COMPLETE_MESH_STATUS_OK,
  invalid_argument = COMPLETE_MESH_STATUS_INVALID_ARGUMENT,
  invalid_option = COMPLETE_MESH_STATUS_INVALID_OPTION,
  invalid_mesh = COMPLETE_MESH_STATUS_INVALID_MESH,
  no_such_hole = COMPLETE_MESH_STATUS_NO_SUCH_HOLE,
  unsafe_hole = COMPLETE_MESH_STATUS_UNSAFE_HOLE,
  hole_failed = COMPLETE_MESH_STATUS_HOLE_FAILED,
  unsupported = COMPLETE_MESH_STATUS_UNSUPPORTED,
  cancelled = COMPLETE_MESH_STATUS_CANCELLED,
  out_of_memory = COMPLETE_MESH_STATUS_OUT_OF_MEMORY,
  internal = COMPLETE_MESH_STATUS_INTERNAL
};

enum class Method : std::uint32_t {
  smooth = COMPLETE_MESH_METHOD_SMOOTH,
  coherent = COMPLETE_MESH_METHOD_COHERENT,
  harary = COMPLETE_MESH_METHOD_HARARY,
  fragment = COMPLETE_MESH_METHOD_FRAGMENT,
  warp = COMPLETE_MESH_METHOD_WARP
};

enum class Fairing : std::uint32_t {
  automatic = COMPLETE_MESH_FAIRING_AUTO,
  none = COMPLETE_MESH_FAIRING_NONE,
  c0 = COMPLETE_MESH_FAIRING_C0,
  c1 = COMPLETE_MESH_FAIRING_C1,
  c2 = COMPLETE_MESH_FAIRING_C2,
  least_squares = COMPLETE_MESH_FAIRING_LEAST_SQUARES,
  smoothed_plate = COMPLETE_MESH_FAIRING_SMOOTHED_PLATE
};

enum class Sizing : std::uint32_t {
  surroundings = COMPLETE_MESH_SIZING_SURROUNDINGS,
  scaled = COMPLETE_MESH_SIZING_SCALED,
  edge_length = COMPLETE_MESH_SIZING_EDGE_LENGTH,
  none = COMPLETE_MESH_SIZING_NONE
};

enum class Grouping : std::uint32_t {
  automatic = COMPLETE_MESH_GROUPING_AUTOMATIC,
  separate = COMPLETE_MESH_GROUPING_SEPARATE,
  join = COMPLETE_MESH_GROUPING_JOIN
};

enum class Selection : std::uint32_t {
  all = COMPLETE_MESH_SELECTION_ALL,
  ids = COMPLETE_MESH_SELECTION_IDS,
  max_edges = COMPLETE_MESH_SELECTION_MAX_EDGES,
  max_circumference = COMPLETE_MESH_SELECTION_MAX_CIRCUMFERENCE,
  max_diameter = COMPLETE_MESH_SELECTION_MAX_DIAMETER,
  all_but_largest = COMPLETE_MESH_SELECTION_ALL_BUT_LARGEST,
  near_point = COMPLETE_MESH_SELECTION_NEAR_POINT,
  near_vertices = COMPLETE_MESH_SELECTION_NEAR_VERTICES
};

enum class Output : std::uint32_t {
  whole_mesh = COMPLETE_MESH_OUTPUT_WHOLE_MESH,
  new_only = COMPLETE_MESH_OUTPUT_NEW_ONLY
};

enum class HoleKind : std::uint32_t {
  disc = COMPLETE_MESH_HOLE_KIND_DISC,
  islands = COMPLETE_MESH_HOLE_KIND_ISLANDS,
  ring = COMPLETE_MESH_HOLE_KIND_RING,
  several = COMPLETE_MESH_HOLE_KIND_SEVERAL
};

enum class HoleStatus : std::uint32_t {
  open = COMPLETE_MESH_HOLE_STATUS_OPEN,
  filled = COMPLETE_MESH_HOLE_STATUS_FILLED,
  not_selected = COMPLETE_MESH_HOLE_STATUS_NOT_SELECTED,
  unsafe = COMPLETE_MESH_HOLE_STATUS_UNSAFE,
  failed = COMPLETE_MESH_HOLE_STATUS_FAILED
};

// Bits of Hole::detectors_asked and detectors_agreed.
enum class Detector : std::uint32_t {
  surface = COMPLETE_MESH_DETECTOR_SURFACE,
  boundary = COMPLETE_MESH_DETECTOR_BOUNDARY,
  field = COMPLETE_MESH_DETECTOR_FIELD
};

enum class Ignored : std::uint32_t {
  missing = COMPLETE_MESH_IGNORED_MISSING,
  duplicate = COMPLETE_MESH_IGNORED_DUPLICATE,
  outlier = COMPLETE_MESH_IGNORED_OUTLIER,
  inside = COMPLETE_MESH_IGNORED_INSIDE
};

inline const char* to_string(Status status) {
  return complete_mesh_status_name(static_cast<std::int32_t>(status));
}

// No face, no source: see Result::new_vertex_source_faces.
inline constexpr std::uint32_t none = UINT32_MAX;

// Of the library that is running.
inline std::uint32_t version() { return complete_mesh_version(); }
inline const char* version_string() { return complete_mesh_version_string(); }
inline std::uint32_t abi_version() { return complete_mesh_abi_version(); }

}  // namespace mesh_completion

#endif
