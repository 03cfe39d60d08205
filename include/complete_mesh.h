/* SPDX-License-Identifier: MIT OR Apache-2.0
 *
 * complete-mesh: fills the holes of triangle meshes so that nobody sees where they were.
 * Generated from src/capi by cbindgen; do not edit.
 *
 *   complete_mesh_result *result = NULL;
 *   if (complete_mesh(vertices, vertex_count, faces, face_count, NULL, &result) != COMPLETE_MESH_STATUS_OK)
 *     fprintf(stderr, "%s\n", complete_mesh_last_error_message());
 *   else
 *     use(complete_mesh_result_vertices(result), complete_mesh_result_vertex_count(result),
 *         complete_mesh_result_faces(result), complete_mesh_result_face_count(result));
 *   complete_mesh_result_free(result);
 *
 * The contract: the input comes back bit for bit, first, in order; the fill is manifold, oriented,
 * joined to the rim and free of self-intersections, or the call fails and returns nothing half done.
 *
 * Coordinates are float unless the option vertex_type says double. Arrays that a function returns
 * belong to the object that it was asked of, live as long as it does and are not to be written.
 * Every accessor takes NULL, and answers 0, NULL or "". Objects may be read by many threads at once;
 * a pointer that was freed, or never given by the library, may crash. The library keeps no global
 * state, prints nothing, and never lets a fault of its own cross into the caller.
 */

#ifndef COMPLETE_MESH_H
#define COMPLETE_MESH_H

#include <stddef.h>
#include <stdint.h>

// Version of this header, first number.
#define COMPLETE_MESH_VERSION_MAJOR 0

// Version of this header, second number.
#define COMPLETE_MESH_VERSION_MINOR 1

// Version of this header, third number.
#define COMPLETE_MESH_VERSION_PATCH 0

// Version of this header as one number that grows: major * 1000000 + minor * 1000 + patch.
#define COMPLETE_MESH_VERSION (((COMPLETE_MESH_VERSION_MAJOR * 1000000) + (COMPLETE_MESH_VERSION_MINOR * 1000)) + COMPLETE_MESH_VERSION_PATCH)

// Changes when programs must be compiled anew; the number in the shared library's soname. Compare
// it with complete_mesh_abi_version() when you load the library by hand.
#define COMPLETE_MESH_ABI_VERSION 0

// What a call returns: 0 is success, everything else is negative. A failed call has no result and
// has changed nothing; complete_mesh_last_error_message() says what was wrong and what to do.
// Numbers are never given a second meaning.
typedef enum complete_mesh_status {
  // Success.
  COMPLETE_MESH_STATUS_OK = 0,
  // A NULL pointer that must not be, a size or stride that cannot be, a number that is none of
  // an enum's.
  COMPLETE_MESH_STATUS_INVALID_ARGUMENT = -1,
  // An option is outside its range.
  COMPLETE_MESH_STATUS_INVALID_OPTION = -2,
  // The mesh has no faces, a coordinate that is not finite, a face that names a vertex that
  // does not exist, or too many elements for 32-bit indices.
  COMPLETE_MESH_STATUS_INVALID_MESH = -3,
  // The selection names a hole that does not exist.
  COMPLETE_MESH_STATUS_NO_SUCH_HOLE = -4,
  // A selected hole cannot be filled safely, e.g. because loops touch in a vertex. See the
  // option skip_unsafe.
  COMPLETE_MESH_STATUS_UNSAFE_HOLE = -5,
  // No fill that keeps the contract was found for a selected hole. See the option skip_unsafe.
  COMPLETE_MESH_STATUS_HOLE_FAILED = -6,
  // This version cannot do what was asked for.
  COMPLETE_MESH_STATUS_UNSUPPORTED = -7,
  // The progress function returned non-zero.
  COMPLETE_MESH_STATUS_CANCELLED = -8,
  // There was no memory for the result.
  COMPLETE_MESH_STATUS_OUT_OF_MEMORY = -9,
  // A fault of this library: please report the message.
  COMPLETE_MESH_STATUS_INTERNAL = -99,
} complete_mesh_status;

// The number type of the coordinates, of input and result alike.
typedef enum complete_mesh_vertex_type {
  // float, 4 bytes. The default: what hosts and GPUs keep.
  COMPLETE_MESH_VERTEX_TYPE_F32 = 0,
  // double, 8 bytes.
  COMPLETE_MESH_VERTEX_TYPE_F64 = 1,
} complete_mesh_vertex_type;

// How a fill is made.
typedef enum complete_mesh_method {
  // Smooth completion: triangulation, refinement, fairing.
  COMPLETE_MESH_METHOD_SMOOTH = 0,
  // Coherent completion: continues what the object shows. A hole for which nothing on the object
  // serves gets a smooth fill; the method of its complete_mesh_hole says so.
  COMPLETE_MESH_METHOD_COHERENT = 1,
  // Coherent completion as Harary, Tal and Grinspun (2014) describe it, to compare with; slow.
  COMPLETE_MESH_METHOD_HARARY = 2,
  // Fragment-based inpainting (Bendels, Schnabel, Klein 2005): copies of fragments of the object, scale
  // by scale.
  COMPLETE_MESH_METHOD_FRAGMENT = 3,
  // Completion for shape and appearance (Park, Guo, Shin, Qin 2006): the patch whose surroundings are the
  // most similar is warped into the hole.
  COMPLETE_MESH_METHOD_WARP = 4,
} complete_mesh_method;

// The smooth surface that a hole is filled with, or that its coherent fill starts from.
typedef enum complete_mesh_fairing {
  // The best of the others for each hole, chosen by what its surroundings show.
  COMPLETE_MESH_FAIRING_AUTO = 0,
  // The refined triangulation as it is.
  COMPLETE_MESH_FAIRING_NONE = 1,
  // Membrane: meets the rim, with a crease.
  COMPLETE_MESH_FAIRING_C0 = 2,
  // Thin plate: continues the tangent planes at the rim.
  COMPLETE_MESH_FAIRING_C1 = 3,
  // Continues the curvature, too.
  COMPLETE_MESH_FAIRING_C2 = 4,
  // Least-squares mesh of the fill and a band of the surroundings.
  COMPLETE_MESH_FAIRING_LEAST_SQUARES = 5,
  // Thin plate through the smoothed surroundings: continues shape, not roughness.
  COMPLETE_MESH_FAIRING_SMOOTHED_PLATE = 6,
} complete_mesh_fairing;

// The edge length that new triangles aim for.
typedef enum complete_mesh_sizing {
  // The edge length of the surroundings, carried inward from the rim.
  COMPLETE_MESH_SIZING_SURROUNDINGS = 0,
  // The same, times sizing_value (0.05 to 20).
  COMPLETE_MESH_SIZING_SCALED = 1,
  // sizing_value everywhere, in mesh units, greater than 0.
  COMPLETE_MESH_SIZING_EDGE_LENGTH = 2,
  // No refinement: no vertex is added but where a valid fill needs one.
  COMPLETE_MESH_SIZING_NONE = 3,
} complete_mesh_sizing;

// Which boundary loops are filled together, as one hole.
typedef enum complete_mesh_grouping {
  // Loops that face each other: islands inside a loop, the two ends of a missing band.
  COMPLETE_MESH_GROUPING_AUTOMATIC = 0,
  // Every loop is a hole of its own.
  COMPLETE_MESH_GROUPING_SEPARATE = 1,
  // The lists of join_vertices; loops in no list are holes of their own.
  COMPLETE_MESH_GROUPING_JOIN = 2,
} complete_mesh_grouping;

// Which holes are filled.
typedef enum complete_mesh_selection {
  // Every hole.
  COMPLETE_MESH_SELECTION_ALL = 0,
  // The holes whose ids are in selection_ids.
  COMPLETE_MESH_SELECTION_IDS = 1,
  // Holes of at most selection_max_edges boundary edges.
  COMPLETE_MESH_SELECTION_MAX_EDGES = 2,
  // Holes whose loops are together at most selection_length long.
  COMPLETE_MESH_SELECTION_MAX_CIRCUMFERENCE = 3,
  // Holes of at most selection_length diameter.
  COMPLETE_MESH_SELECTION_MAX_DIAMETER = 4,
  // All but the hole with the greatest circumference: an open scan's own border.
  COMPLETE_MESH_SELECTION_ALL_BUT_LARGEST = 5,
  // The one hole whose rim passes nearest to selection_point.
  COMPLETE_MESH_SELECTION_NEAR_POINT = 6,
  // The holes whose rim contains a vertex of selection_ids; if there is none, the one hole
  // whose rim passes nearest to these vertices.
  COMPLETE_MESH_SELECTION_NEAR_VERTICES = 7,
} complete_mesh_selection;

// What arrays a result holds.
typedef enum complete_mesh_output {
  // The whole mesh (input first) and the new elements: one copy of the input.
  COMPLETE_MESH_OUTPUT_WHOLE_MESH = 0,
  // Only the new elements, for hosts that add to the mesh they have.
  COMPLETE_MESH_OUTPUT_NEW_ONLY = 1,
} complete_mesh_output;

// What a hole looks like.
typedef enum complete_mesh_hole_kind {
  // One loop: filled by a disc.
  COMPLETE_MESH_HOLE_KIND_DISC = 0,
  // A loop with islands inside, which become part of the fill.
  COMPLETE_MESH_HOLE_KIND_ISLANDS = 1,
  // Two loops that face each other: a band is missing.
  COMPLETE_MESH_HOLE_KIND_RING = 2,
  // Several loops that the caller joined, or a branching gap.
  COMPLETE_MESH_HOLE_KIND_SEVERAL = 3,
} complete_mesh_hole_kind;

// What became of a hole.
typedef enum complete_mesh_hole_status {
  // Found and measured, and selected; nothing was to be filled.
  COMPLETE_MESH_HOLE_STATUS_OPEN = 0,
  // Filled.
  COMPLETE_MESH_HOLE_STATUS_FILLED = 1,
  // Not selected.
  COMPLETE_MESH_HOLE_STATUS_NOT_SELECTED = 2,
  // Left open because it cannot be filled safely (only with skip_unsafe).
  COMPLETE_MESH_HOLE_STATUS_UNSAFE = 3,
  // Left open because no fill kept the contract (only with skip_unsafe).
  COMPLETE_MESH_HOLE_STATUS_FAILED = 4,
} complete_mesh_hole_status;

// What finds the holes of a cloud: one bit each, to be added up.
typedef enum complete_mesh_detector {
  // The mesh that is laid through the points has a rim there. It finds all holes that are listed.
  COMPLETE_MESH_DETECTOR_SURFACE = 1,
  // Points that are likely to lie on a boundary close a loop there (Bendels et al. 2005).
  COMPLETE_MESH_DETECTOR_BOUNDARY = 2,
  // Contours of the distance field that are inside and outside meet there (Park et al. 2006). Where the
  // surface is open it cannot say, and counts as not asked.
  COMPLETE_MESH_DETECTOR_FIELD = 4,
} complete_mesh_detector;

// Why points of a cloud were not looked at. They stay where they are.
typedef enum complete_mesh_ignored {
  // They have no coordinates: three NaN.
  COMPLETE_MESH_IGNORED_MISSING = 0,
  // They are at the place of an earlier point, or within a quarter of the spacing of it.
  COMPLETE_MESH_IGNORED_DUPLICATE = 1,
  // They lie beside the surface.
  COMPLETE_MESH_IGNORED_OUTLIER = 2,
  // They lie inside a loop that was given.
  COMPLETE_MESH_IGNORED_INSIDE = 3,
} complete_mesh_ignored;

// The kinds of elements that an error or a hole's problem can name.
typedef enum complete_mesh_element_kind {
  // Indices of input vertices, one number each.
  COMPLETE_MESH_ELEMENT_KIND_VERTEX = 0,
  // Edges, two numbers each: the indices of their two input vertices.
  COMPLETE_MESH_ELEMENT_KIND_EDGE = 1,
  // Indices of input faces, one number each.
  COMPLETE_MESH_ELEMENT_KIND_FACE = 2,
  // Ids of holes, one number each.
  COMPLETE_MESH_ELEMENT_KIND_HOLE = 3,
} complete_mesh_element_kind;

// The holes of a mesh or a cloud and everything odd that was found there. Opaque; read by the
// functions complete_mesh_holes_..., from any number of threads.
typedef struct complete_mesh_holes complete_mesh_holes;

// A mesh whose holes are known, for filling them more than once with different options. Opaque;
// free it with complete_mesh_completer_free.
typedef struct complete_mesh_completer complete_mesh_completer;

// A completed mesh. Opaque; read by the functions complete_mesh_result_..., from any number of
// threads; free it with complete_mesh_result_free.
typedef struct complete_mesh_result complete_mesh_result;

// Reports progress and asks whether to go on: return 0 to go on, anything else to cancel. The
// call then returns COMPLETE_MESH_STATUS_CANCELLED, frees everything and does not call again.
//
// user: progress_user of the options.
// fraction: how much is done, 0 to 1, never falling.
// stage: what is being done, an English word or two; valid during the call only.
//
// Called on the thread that called the library, at least once by every call. It must not throw an
// exception or jump out; it may call the library.
typedef int (*complete_mesh_progress_fn)(void *user, double fraction, const char *stage);

// The options of every call. Initialise with complete_mesh_options_init, then change what you
// need. Where a call takes options, NULL means the defaults.
//
// The struct grows at its end in later versions. A program compiled with an older, shorter struct
// keeps working with a newer library; a newer program with an older library gets
// COMPLETE_MESH_STATUS_UNSUPPORTED once it sets a field that the library does not know.
typedef struct complete_mesh_options {
  // sizeof(complete_mesh_options) as your program was compiled; complete_mesh_options_init sets
  // it.
  uint32_t struct_size;
  // A complete_mesh_vertex_type. Default: COMPLETE_MESH_VERTEX_TYPE_F32, so double vertices
  // need this set.
  uint32_t vertex_type;
  // Bytes from one vertex to the next; any number from 12 (F32) or 24 (F64), alignment does not
  // matter. Default: 0, packed.
  size_t vertex_stride;
  // Bytes from one face to the next; any number from 12. Default: 0, packed.
  size_t face_stride;
  // A complete_mesh_method. Default: COMPLETE_MESH_METHOD_COHERENT.
  uint32_t method;
  // A complete_mesh_fairing. Default: COMPLETE_MESH_FAIRING_AUTO.
  uint32_t fairing;
  // A complete_mesh_sizing. Default: COMPLETE_MESH_SIZING_SURROUNDINGS.
  uint32_t sizing;
  // A complete_mesh_grouping. Default: COMPLETE_MESH_GROUPING_AUTOMATIC.
  uint32_t grouping;
  // Read by COMPLETE_MESH_SIZING_SCALED (a factor) and COMPLETE_MESH_SIZING_EDGE_LENGTH (mesh
  // units). Default: 1.
  double sizing_value;
  // A complete_mesh_selection. Default: COMPLETE_MESH_SELECTION_ALL.
  uint32_t selection;
  // 0: a selected hole that cannot be filled is an error for the whole call. 1: it is left open
  // and its complete_mesh_hole says why. Default: 0.
  uint32_t skip_unsafe;
  // Read by COMPLETE_MESH_SELECTION_IDS (ids of holes) and COMPLETE_MESH_SELECTION_NEAR_VERTICES
  // (indices of vertices): selection_count numbers, yours; NULL if selection_count is 0.
  const uint32_t *selection_ids;
  // How many numbers selection_ids has. Default: 0.
  size_t selection_count;
  // Read by COMPLETE_MESH_SELECTION_MAX_EDGES. Default: 0.
  size_t selection_max_edges;
  // Read by COMPLETE_MESH_SELECTION_MAX_CIRCUMFERENCE and _MAX_DIAMETER: mesh units, greater
  // than 0. Default: 0.
  double selection_length;
  // Read by COMPLETE_MESH_SELECTION_NEAR_POINT: mesh units. Default: the origin.
  double selection_point[3];
  // Read by COMPLETE_MESH_GROUPING_JOIN: one list of vertices for each hole, one after the
  // other; any vertex of a loop stands for the loop. Yours; NULL if join_count is 0.
  const uint32_t *join_vertices;
  // How many vertices each list has: join_count numbers, yours; NULL if join_count is 0.
  const uint32_t *join_sizes;
  // How many lists there are. Default: 0.
  size_t join_count;
  // Worker threads, 0 to 1024; 0: as many as the machine has cores. The result is the same, to
  // the bit, for any number. Default: 0.
  uint32_t threads;
  // A complete_mesh_output. Default: COMPLETE_MESH_OUTPUT_WHOLE_MESH.
  uint32_t output;
  // Reports progress and can cancel; NULL: neither. Default: NULL.
  complete_mesh_progress_fn progress;
  // Handed to progress as it is; the library does not look at it. Default: NULL.
  void *progress_user;
  // What coherent fills may copy from: a byte for each face of the mesh, 0 where it may not be
  // copied from. Yours; NULL: all may. Default: NULL.
  const uint8_t *source_faces;
  // Another mesh to copy from, in any position and of the same scale, e.g. an intact twin: three
  // numbers a vertex, of vertex_type, packed. Yours; NULL: none. Origins on it have face numbers
  // from the mesh's face count on. Default: NULL.
  const void *exemplar_vertices;
  // How many vertices the exemplar has. Default: 0.
  size_t exemplar_vertex_count;
  // Its faces, three 32-bit vertex indices each, packed. Yours. Default: NULL.
  const uint32_t *exemplar_faces;
  // How many faces the exemplar has. Default: 0.
  size_t exemplar_face_count;
  // 1: copy from the exemplar alone. Default: 0.
  uint32_t exemplar_only;
  // 1: copy nothing mirrored. Default: 0.
  uint32_t unmirrored;
  // An initial completion to start from instead of a smooth one, numbered as results are: its new
  // vertices, three numbers each, of vertex_type, packed. A hole that it does not fill fails. Yours.
  // Default: NULL.
  const void *initial_vertices;
  // How many vertices it has, those of the mesh not counted. Default: 0.
  size_t initial_vertex_count;
  // Its faces, three 32-bit vertex indices each, packed, those of the mesh not among them; new
  // vertices are numbered from the mesh's vertex count on. Yours. Default: NULL.
  const uint32_t *initial_faces;
  // How many faces it has; 0: no initial completion. Default: 0.
  size_t initial_face_count;
  // What the vertices carry besides their place, colours or any numbers, to be completed with the
  // shape: value_channels numbers a vertex, finite, packed, vertex_stride does not apply. Yours;
  // NULL: nothing. Read back with complete_mesh_result_new_vertex_values. Default: NULL.
  const double *vertex_values;
  // The same of the exemplar's vertices. Yours; NULL: not known. Default: NULL.
  const double *exemplar_values;
  // How many numbers a vertex has. Default: 0.
  uint32_t value_channels;
  // How many of them, from the first on, help to find what is copied: 3 for red, green and blue;
  // at most value_channels. They share one unit, whichever. Default: 0.
  uint32_t steering_channels;
  // The one place to copy from, given by hand: a transform from the source to the hole, three rows
  // and four columns, row by row, as in complete_mesh_source. It may turn, mirror, scale (0.001 to
  // 1000) and shift; strains of up to 15 % are taken, too. With an exemplar it is the exemplar that
  // is placed, else the mesh itself; it holds for every hole that is filled. Twelve numbers, yours;
  // NULL: places are searched for. Default: NULL.
  const double *placement;
  // 1: placement is improved by ICP on what is known around the hole, from as far as half a hole's
  // radius; with its scale, unless that is 1. Default: 0.
  uint32_t refine;
  // Which of the places found a fill is made from, counted from 1, the best first, in each hole; 0:
  // all of them together. A hole that has fewer gets a smooth fill; candidate_count of its
  // complete_mesh_hole says how many there are. A completer searches once for all. Default: 0.
  uint32_t candidate;
  // Least factor by which sources may be scaled, 0.001 to 1000; 0 as greatest_scale is: they are not
  // scaled. A search takes as much longer as there are steps of 10 % in the range; an exemplar that
  // is an exact twin is found at once. Default: 0.
  double least_scale;
  // Greatest factor. Default: 0.
  double greatest_scale;
  // How many vertices each of several exemplars has that stand one after the other in the
  // exemplar's arrays, faces in the same order: each may lie anywhere, on top of another, too. Yours;
  // NULL: they are one. Default: NULL.
  const uint32_t *exemplar_parts;
  // How many exemplars there are; 0: one. Default: 0.
  size_t exemplar_part_count;
  // Points that fills pass through, smooth ones, too: scan points that float inside a hole. Three
  // numbers each, packed, always double. Each belongs to the nearest hole that is filled; one that is
  // farther from its middle than its diameter is refused. Yours; NULL if constraint_count is 0.
  // Default: NULL.
  const double *constraint_points;
  // How many points. Default: 0.
  size_t constraint_count;
  // How far the fill may stay off the points, 0 (it passes through them) to 1; 0.1 halves the height of
  // a bump over the whole hole. Default: 0.
  double softness;
  // 1: each hole is filled with a part taken whole, with the source's own triangles: a missing hand, foot
  // or spout, which no smooth surface comes near to. The part is what lies over the hole, at placement or
  // at the first of the places found that has one. Default: 0.
  uint32_t part;
  // Vertices of rims where the fill need only be joined: neither tangents nor relief nor values go on
  // from what lies beyond them. Yours; NULL if loose_count is 0. Default: NULL.
  const uint32_t *loose_vertices;
  // How many there are. Default: 0.
  size_t loose_count;
  // 1: complete_mesh_points completes a cleaned copy of the cloud: points beside the surface and
  // doubles are left out, noise is smoothed; see complete_mesh_result_cleaned_points. The input stays
  // what it is. Refused for a mesh. Default: 0.
  uint32_t clean;
  // Times that noise is smoothed, 0 to 100; each time about half of what is left goes, and relief below
  // two spacings with it. Read if clean is 1. Default: 3.
  uint32_t clean_rounds;
  // Holes of a cloud that you give as loops; if any hole is given no others are looked for. One list of
  // points, 3 or more, for each loop, one list after the other, in order around the hole, either way
  // round. Where the surface through the points has no edge between two of them the loop follows its rims
  // and edges, without a detour. Inside is the smaller part; points there stay, and are not looked at.
  // Refused for a mesh. Yours; NULL if given_loop_count is 0. Default: NULL.
  const uint32_t *given_loop_points;
  // How many points each loop has: given_loop_count numbers, yours; NULL if given_loop_count is 0.
  // Default: NULL.
  const uint32_t *given_loop_sizes;
  // How many loops there are. Default: 0.
  size_t given_loop_count;
  // Regions of a cloud: the holes whose rims lie in one; if there are none, the largest gap that
  // shows. If any hole is given no others are looked for. Four numbers each: the centre and the radius of a
  // ball, in cloud units. Refused for a mesh. Yours; NULL if given_region_count is 0. Default: NULL.
  const double *given_regions;
  // How many regions there are. Default: 0.
  size_t given_region_count;
} complete_mesh_options;

// One hole. Lengths and positions are in mesh units. Edges of a cloud's hole are those between the
// points of its rim.
typedef struct complete_mesh_hole {
  // How many bytes of the struct the library has written: at most what was asked for.
  uint32_t struct_size;
  // The hole's id, which is also its index.
  uint32_t id;
  // A complete_mesh_hole_kind.
  uint32_t kind;
  // A complete_mesh_hole_status.
  uint32_t status;
  // The complete_mesh_fairing that was used; COMPLETE_MESH_FAIRING_AUTO if not filled.
  uint32_t fairing;
  // 1: something at the rim keeps it from being filled safely, see
  // complete_mesh_holes_reason and complete_mesh_holes_problem_elements. Else 0.
  uint32_t is_unsafe;
  // Boundary loops.
  size_t loop_count;
  // Boundary edges of all loops.
  size_t edge_count;
  // Length of all loops.
  double circumference;
  // Diameter of the longest loop.
  double diameter;
  // Centre of the longest loop.
  double centre[3];
  // The hole's first new vertex, counted among the new vertices.
  size_t first_new_vertex;
  // How many new vertices it has, one after the other.
  size_t new_vertex_count;
  // The hole's first new face, counted among the new faces.
  size_t first_new_face;
  // How many new faces it has, one after the other.
  size_t new_face_count;
  // Wall seconds that its fill took.
  double seconds;
  // The complete_mesh_method that made the fill: COMPLETE_MESH_METHOD_SMOOTH where nothing on
  // the object served, and if not filled.
  uint32_t method;
  // How many sources the fill was continued from, see complete_mesh_holes_source; 0 for a smooth
  // fill.
  uint32_t source_count;
  // 0 to 1, as of complete_mesh_result_new_vertex_confidences; 0 for a smooth fill.
  double confidence;
  // Coherence error of the initial, smooth completion (Harary et al. 2014, Eq. 3, root mean
  // square); NaN where it was not measured.
  double coherence_error_before;
  // Coherence error of the fill; NaN where it was not measured.
  double coherence_error_after;
  // How many candidates the hole has, if one was asked for by the option candidate; else 0.
  uint32_t candidate_count;
  // 1: the outer border of an open cloud, which is filled only if it is named. Else 0.
  uint32_t is_border;
  // Which detectors could judge this hole of a cloud, complete_mesh_detector added up. 0 for a mesh.
  uint32_t detectors_asked;
  // Which of them find this hole. One that not all agree on may be a sparse place.
  uint32_t detectors_agreed;
  // Of a cloud: the mean probability, 0 to 1, that the points of the rim lie on a boundary (Bendels et
  // al. 2005); from 0.4 a rim is plain to see. NaN for a mesh.
  double boundary_probability;
  // Of a cloud: an estimate of how many points are missing. NaN for a mesh.
  double missing_points;
} complete_mesh_hole;

// A place on the object that a hole's fill was continued from. Lengths are in mesh units.
typedef struct complete_mesh_source {
  // How many bytes of the struct the library has written: at most what was asked for.
  uint32_t struct_size;
  // 1: the transform mirrors. Else 0.
  uint32_t mirrored;
  // From the place to the hole: a matrix of three rows and four columns, row by row. The first
  // three columns are a rotation, or a rotation and a reflection, in some with a stretch of a few
  // per cent, or scaled if that was allowed; the last is the translation.
  double transform[12];
  // Root mean square error at known vertices near the rim that were hidden from the fit.
  double error;
  // Share in the low frequencies of the fill, 0 to 1; a hole's sources sum to 1.
  double weight;
  // How many new vertices have their detail from here.
  size_t vertex_count;
  // How many new vertices have their values (vertex_values of the options), but not their shape, from here.
  size_t coloured_count;
} complete_mesh_source;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// COMPLETE_MESH_VERSION of the library that is running.
uint32_t complete_mesh_version(void);

// The version of the library that is running, e.g. "0.1.0". A static string.
const char *complete_mesh_version_string(void);

// COMPLETE_MESH_ABI_VERSION of the library that is running.
uint32_t complete_mesh_abi_version(void);

// Fills the holes of a triangle mesh. The input is only read, and only while the call lasts.
//
// vertices: positions, three numbers each; float unless vertex_type of the options says double.
// Any alignment. NULL if vertex_count is 0.
// vertex_count: how many vertices.
// faces: three 32-bit vertex indices each, counter-clockwise seen from outside. Any alignment.
// NULL if face_count is 0.
// face_count: how many faces.
// opts: NULL for the defaults: packed float vertices, every hole, coherent fills.
// result: receives the new result, to be freed with complete_mesh_result_free; NULL on failure.
//
// Returns COMPLETE_MESH_STATUS_OK, also for a mesh without holes, or what was wrong. May be called
// by any number of threads at once.
enum complete_mesh_status complete_mesh(const void *vertices,
                                        size_t vertex_count,
                                        const uint32_t *faces,
                                        size_t face_count,
                                        const struct complete_mesh_options *opts,
                                        struct complete_mesh_result **result);

// Finds and measures the holes of a mesh and fills nothing.
//
// vertices, vertex_count, faces, face_count: as for complete_mesh.
// opts: vertex_type, the strides, grouping, selection and progress count, but all are checked; NULL
// for the defaults. Holes outside the selection are listed as COMPLETE_MESH_HOLE_STATUS_NOT_SELECTED.
// holes: receives the new list, to be freed with complete_mesh_holes_free; NULL on failure.
//
// Returns COMPLETE_MESH_STATUS_OK or what was wrong. May be called by any number of threads at
// once.
enum complete_mesh_status complete_mesh_find_holes(const void *vertices,
                                                   size_t vertex_count,
                                                   const uint32_t *faces,
                                                   size_t face_count,
                                                   const struct complete_mesh_options *opts,
                                                   struct complete_mesh_holes **holes);

// Makes a completer: checks a mesh and finds its holes once, for many fills. It keeps pointers to
// the arrays, not a copy: they must stay as they are until complete_mesh_completer_free.
//
// vertices, vertex_count, faces, face_count: as for complete_mesh.
// opts: only vertex_type, the strides, grouping and progress count, but all are checked; NULL for
// the defaults.
// completer: receives the new completer, to be freed with complete_mesh_completer_free; NULL on
// failure.
//
// Returns COMPLETE_MESH_STATUS_OK or what was wrong.
enum complete_mesh_status complete_mesh_completer_new(const void *vertices,
                                                      size_t vertex_count,
                                                      const uint32_t *faces,
                                                      size_t face_count,
                                                      const struct complete_mesh_options *opts,
                                                      struct complete_mesh_completer **completer);

// Fills holes of a completer's mesh.
//
// completer: not NULL. Any number of threads may use one completer at once.
// opts: as for complete_mesh, but vertex_type, the strides and grouping were settled by
// complete_mesh_completer_new and are not used; NULL for the defaults.
// result: receives the new result, to be freed with complete_mesh_result_free, before or after the
// completer; NULL on failure.
//
// Returns COMPLETE_MESH_STATUS_OK or what was wrong.
enum complete_mesh_status complete_mesh_completer_complete(const struct complete_mesh_completer *completer,
                                                           const struct complete_mesh_options *opts,
                                                           struct complete_mesh_result **result);

// The holes of a completer's mesh, to be read with complete_mesh_holes_.... They belong to the
// completer: do not free them. NULL for NULL.
const struct complete_mesh_holes *complete_mesh_completer_holes(const struct complete_mesh_completer *completer);

// Frees a completer; NULL is allowed. Its results live on.
void complete_mesh_completer_free(struct complete_mesh_completer *completer);

// What went wrong in the last call that failed on this thread: what, in which element, what to
// do about it; English, UTF-8. Empty before the first failure. Calls that succeed leave it alone.
// The string belongs to the library and is valid until the next failure on this thread.
// Never NULL.
const char *complete_mesh_last_error_message(void);

// The elements of one kind that the last failure on this thread named, so that a host can select
// or draw them: an unsafe hole names itself and the vertices or edges that are in the way.
//
// kind: a complete_mesh_element_kind.
// count: receives how many elements there are, 0 if none; NULL is allowed. Edges take two
// numbers each, so the array then has 2 * count of them.
//
// Returns NULL if there are none or kind is unknown. The array belongs to the library and is
// valid until the next failure on this thread.
const uint32_t *complete_mesh_last_error_elements(uint32_t kind, size_t *count);

// A short English name of a status, e.g. "invalid mesh"; "unknown status" for any other number.
// A static string, never NULL.
const char *complete_mesh_status_name(int32_t status);

// How many holes there are; their ids are 0 to this number less one. 0 for NULL.
size_t complete_mesh_holes_count(const struct complete_mesh_holes *holes);

// One hole's measures and what became of it.
//
// hole: id of the hole.
// info: receives them.
// info_size: sizeof(complete_mesh_hole) as your program was compiled; not a byte beyond is
// written.
//
// Returns 1; or 0 for NULL, for a hole that does not exist and for an info_size under 8, and then
// nothing is written.
int32_t complete_mesh_holes_get(const struct complete_mesh_holes *holes,
                                size_t hole,
                                struct complete_mesh_hole *info,
                                size_t info_size);

// One of the places that a hole's fill was continued from, the greatest weight first.
//
// hole: id of the hole.
// source: 0 to source_count of the hole's complete_mesh_hole, less one.
// info: receives it.
// info_size: sizeof(complete_mesh_source) as your program was compiled; not a byte beyond is
// written.
//
// Returns 1; or 0 for NULL, for a hole or a source that does not exist and for an info_size under
// 8, and then nothing is written.
int32_t complete_mesh_holes_source(const struct complete_mesh_holes *holes,
                                   size_t hole,
                                   size_t source,
                                   struct complete_mesh_source *info,
                                   size_t info_size);

// The vertices of one boundary loop of a hole, in the order in which a filling face runs.
//
// hole: id of the hole.
// loop_index: 0 to loop_count of the hole's complete_mesh_hole, less one; the longest loop is first.
// count: receives the number of vertices, 0 if there is no such loop; NULL is allowed.
//
// Returns indices of input vertices, NULL if there is no such loop. The array belongs to holes.
const uint32_t *complete_mesh_holes_loop(const struct complete_mesh_holes *holes,
                                         size_t hole,
                                         size_t loop_index,
                                         size_t *count);

// Why a hole was not filled or cannot be filled safely: English, UTF-8; empty if there is no
// reason. The string belongs to holes; an empty one, never NULL, for a hole that does not exist.
const char *complete_mesh_holes_reason(const struct complete_mesh_holes *holes, size_t hole);

// The elements of one kind that keep a hole from being filled safely.
//
// hole: id of the hole.
// kind: a complete_mesh_element_kind.
// count: receives how many elements there are; NULL is allowed. Edges take two numbers each.
//
// Returns NULL if there are none. The array belongs to holes.
const uint32_t *complete_mesh_holes_problem_elements(const struct complete_mesh_holes *holes,
                                                     size_t hole,
                                                     uint32_t kind,
                                                     size_t *count);

// Edges with more than two faces, found at or near the boundary of the mesh.
//
// count: receives how many edges there are; NULL is allowed.
//
// Returns two input vertices for each edge, NULL if there are none. The array belongs to holes.
const uint32_t *complete_mesh_holes_non_manifold_edges(const struct complete_mesh_holes *holes,
                                                       size_t *count);

// Edges whose two faces run the same way: the mesh is not oriented consistently there.
//
// count: receives how many edges there are; NULL is allowed.
//
// Returns two input vertices for each edge, NULL if there are none. The array belongs to holes.
const uint32_t *complete_mesh_holes_inconsistent_edges(const struct complete_mesh_holes *holes,
                                                       size_t *count);

// Faces that name a vertex twice; they are passed through and otherwise ignored.
//
// count: receives how many faces there are; NULL is allowed.
//
// Returns indices of input faces, NULL if there are none. The array belongs to holes.
const uint32_t *complete_mesh_holes_degenerate_faces(const struct complete_mesh_holes *holes,
                                                     size_t *count);

// Pairs of boundary vertices at the same position: the mesh is not welded there, and what looks
// closed is a slit.
//
// count: receives how many pairs there are; NULL is allowed.
//
// Returns two input vertices for each pair, NULL if there are none. The array belongs to holes.
const uint32_t *complete_mesh_holes_duplicate_vertices(const struct complete_mesh_holes *holes,
                                                       size_t *count);

// Frees what complete_mesh_find_holes or complete_mesh_find_point_holes gave; NULL is allowed. Not for
// the holes of a result or a completer, which free their own: those are const.
void complete_mesh_holes_free(struct complete_mesh_holes *holes);

// Sets an options struct to the defaults.
//
// opts: receives the defaults; its old content is not read.
// struct_size: sizeof(complete_mesh_options) as your program was compiled; not a byte beyond is
// written.
//
// Returns COMPLETE_MESH_STATUS_OK, or COMPLETE_MESH_STATUS_INVALID_ARGUMENT for NULL or a size
// that cannot be; then nothing is written.
enum complete_mesh_status complete_mesh_options_init(struct complete_mesh_options *opts,
                                                     size_t struct_size);

// Fills the holes of a point cloud with new points. Outer borders of open surfaces stay open unless
// they are selected by id, point or vertices. The input is only read, and only while the call lasts.
//
// points: positions, three numbers each; float unless vertex_type of the options says double.
// Three NaN are a point without coordinates, which is passed through. NULL if point_count is 0.
// point_count: how many points.
// normals: packed, of the number type of the points, any length, zero where unknown: which side is
// out; NULL: guessed.
// opts: as for complete_mesh, vertices being points; source_faces and the initial completion must
// not be set. NULL for the defaults.
// result: receives the new result, whose vertices are the points and which has no faces, to be
// freed with complete_mesh_result_free; NULL on failure.
//
// Returns COMPLETE_MESH_STATUS_OK, also for a cloud without holes, or what was wrong. May be called
// by any number of threads at once.
enum complete_mesh_status complete_mesh_points(const void *points,
                                               size_t point_count,
                                               const void *normals,
                                               const struct complete_mesh_options *opts,
                                               struct complete_mesh_result **result);

// Finds and measures the holes of a point cloud and fills nothing; detectors_agreed of a
// complete_mesh_hole says which detectors find it.
//
// points, point_count, normals: as for complete_mesh_points.
// opts: vertex_type, vertex_stride, grouping, selection, clean, the given holes, threads and progress count,
// but all are checked; NULL for the defaults. Holes outside the selection, and outer borders that are not named,
// are listed as COMPLETE_MESH_HOLE_STATUS_NOT_SELECTED.
// holes: receives the new list, whose vertices are points, to be freed with complete_mesh_holes_free;
// NULL on failure.
//
// Returns COMPLETE_MESH_STATUS_OK or what was wrong. May be called by any number of threads at
// once.
enum complete_mesh_status complete_mesh_find_point_holes(const void *points,
                                                         size_t point_count,
                                                         const void *normals,
                                                         const struct complete_mesh_options *opts,
                                                         struct complete_mesh_holes **holes);

// How far apart the points of a cloud lie: the middle one of the distances to the sixth neighbour. 0
// for a mesh.
double complete_mesh_holes_spacing(const struct complete_mesh_holes *holes);

// The places that only the distance field takes for holes of a cloud.
//
// count: receives how many places there are; NULL is allowed.
//
// Returns their centres, three numbers each, in cloud units; NULL if there are none. The array belongs to
// holes.
const double *complete_mesh_holes_only_in_field(const struct complete_mesh_holes *holes,
                                                size_t *count);

// Points of a cloud that were not looked at.
//
// kind: why, a complete_mesh_ignored.
// count: receives how many points there are; NULL is allowed.
//
// Returns indices of input points, NULL if there are none. The array belongs to holes.
const uint32_t *complete_mesh_holes_ignored_points(const struct complete_mesh_holes *holes,
                                                   uint32_t kind,
                                                   size_t *count);

// The number type of the result's vertices, a complete_mesh_vertex_type: that of the input.
uint32_t complete_mesh_result_vertex_type(const struct complete_mesh_result *result);

// How many vertices the input has: the index of the first new vertex in faces.
size_t complete_mesh_result_input_vertex_count(const struct complete_mesh_result *result);

// How many faces the input has: the index of the first new face in the whole mesh.
size_t complete_mesh_result_input_face_count(const struct complete_mesh_result *result);

// How many vertices the whole mesh has; 0 if only the new elements were asked for.
size_t complete_mesh_result_vertex_count(const struct complete_mesh_result *result);

// How many faces the whole mesh has; 0 if only the new elements were asked for.
size_t complete_mesh_result_face_count(const struct complete_mesh_result *result);

// The whole mesh's vertices: the input's bit for bit, in order, then the new ones. Three numbers a
// vertex, packed; float or double as complete_mesh_result_vertex_type says. NULL if only the new
// elements were asked for. The array belongs to the result.
const void *complete_mesh_result_vertices(const struct complete_mesh_result *result);

// The whole mesh's faces: the input's, in order, then the new ones. Three indices a face, packed.
// NULL if only the new elements were asked for. The array belongs to the result.
const uint32_t *complete_mesh_result_faces(const struct complete_mesh_result *result);

// How many vertices are new.
size_t complete_mesh_result_new_vertex_count(const struct complete_mesh_result *result);

// How many faces are new.
size_t complete_mesh_result_new_face_count(const struct complete_mesh_result *result);

// The new vertices alone: three numbers a vertex, packed; float or double as
// complete_mesh_result_vertex_type says. NULL if there are none. The array belongs to the result.
const void *complete_mesh_result_new_vertices(const struct complete_mesh_result *result);

// The new faces alone: three indices a face, packed. An index below
// complete_mesh_result_input_vertex_count is an input vertex; that count less is the index of a
// new one. NULL if there are none. The array belongs to the result.
const uint32_t *complete_mesh_result_new_faces(const struct complete_mesh_result *result);

// For each new vertex the id of the hole that it fills. NULL if there are none. The array belongs
// to the result.
const uint32_t *complete_mesh_result_new_vertex_holes(const struct complete_mesh_result *result);

// For each new vertex the input face that its detail was copied from; UINT32_MAX if from nowhere
// (a smooth fill, a gap in the source). NULL if there are no new vertices. The array belongs to the
// result.
const uint32_t *complete_mesh_result_new_vertex_source_faces(const struct complete_mesh_result *result);

// For each new vertex where on its source face it was copied from: three numbers, the weights of
// the face's corners in the face's order, which sum to 1; three zeros without a source face. The
// source's transform takes that point near the new vertex: what is between them is the smooth
// deformation that joins the copy to the rim. NULL if there are no new vertices. The array belongs
// to the result.
const double *complete_mesh_result_new_vertex_barycentrics(const struct complete_mesh_result *result);

// For each new vertex the source that gave its detail, an index for complete_mesh_holes_source
// with the vertex's own hole; UINT32_MAX without one. NULL if there are no new vertices. The array
// belongs to the result.
const uint32_t *complete_mesh_result_new_vertex_sources(const struct complete_mesh_result *result);

// For each new vertex a confidence, 0 (nothing on the object backs it) to 1. From 0.8 the source
// predicted known surface that was hidden from it with at most half the error of a smooth surface;
// below 0.5 it did worse than one. NULL if there are no new vertices. The array belongs to the
// result.
const double *complete_mesh_result_new_vertex_confidences(const struct complete_mesh_result *result);

// For each new vertex the face that its values (vertex_values of the options) were copied from, where they
// were copied: that of complete_mesh_result_new_vertex_source_faces, unless the place that the shape comes
// from does not have the colours around the hole and another has. UINT32_MAX if from nowhere. NULL if there
// are no new vertices. The array belongs to the result.
const uint32_t *complete_mesh_result_new_vertex_colour_faces(const struct complete_mesh_result *result);

// For each new vertex where on that face, as complete_mesh_result_new_vertex_barycentrics. NULL if there
// are no new vertices. The array belongs to the result.
const double *complete_mesh_result_new_vertex_colour_barycentrics(const struct complete_mesh_result *result);

// For each new vertex the source that gave its values, as complete_mesh_result_new_vertex_sources. NULL if
// there are no new vertices. The array belongs to the result.
const uint32_t *complete_mesh_result_new_vertex_colour_sources(const struct complete_mesh_result *result);

// For each new vertex a confidence in where its values come from, 0 to 1: of a place of their own
// 1 / (1 + r²), r² what it leaves of the variance of the colours around the hole; else that of the shape.
// NULL if there are no new vertices. The array belongs to the result.
const double *complete_mesh_result_new_vertex_colour_confidences(const struct complete_mesh_result *result);

// For each new point of a cloud the input point nearest to where its detail was copied from;
// UINT32_MAX if from nowhere. NULL for a mesh, and if there are no new points. The array belongs to
// the result.
const uint32_t *complete_mesh_result_new_vertex_source_points(const struct complete_mesh_result *result);

// For each new point of a cloud its unit normal, three numbers, on the side of the normals given, or
// else outside. NULL for a mesh, and if there are no new points. The array belongs to the result.
const double *complete_mesh_result_new_vertex_normals(const struct complete_mesh_result *result);

// For each point of the input, if the option clean was set, where it lies in the cleaned copy that was
// completed: three numbers; what was removed is where it was. NULL otherwise. The array belongs to the
// result.
const double *complete_mesh_result_cleaned_points(const struct complete_mesh_result *result);

// For each point of the input, if the option clean was set, 1 if it is not in the cleaned copy (it lies
// beside the surface, is a double of an earlier one or has no coordinates), else 0. NULL otherwise. The
// array belongs to the result.
const uint8_t *complete_mesh_result_removed_points(const struct complete_mesh_result *result);

// For each new vertex the numbers that vertex_values of the options gave the input's, value_channels
// of them: copied from where the shape was copied from, else carried in from the rim. Between the
// least and the greatest of the input's. NULL without vertex_values or new vertices. The array belongs
// to the result.
const double *complete_mesh_result_new_vertex_values(const struct complete_mesh_result *result);

// For each new face the id of the hole that it fills. NULL if there are none. The array belongs to
// the result.
const uint32_t *complete_mesh_result_new_face_holes(const struct complete_mesh_result *result);

// All holes of the input, filled or not, to be read with complete_mesh_holes_.... They belong to
// the result: do not free them. NULL for NULL.
const struct complete_mesh_holes *complete_mesh_result_holes(const struct complete_mesh_result *result);

// How many holes were filled.
size_t complete_mesh_result_filled_count(const struct complete_mesh_result *result);

// Wall seconds that the completion took.
double complete_mesh_result_seconds(const struct complete_mesh_result *result);

// CPU seconds that the process spent, in all its threads, while the completion ran.
double complete_mesh_result_cpu_seconds(const struct complete_mesh_result *result);

// Frees a result and everything that belongs to it; NULL is allowed.
void complete_mesh_result_free(struct complete_mesh_result *result);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* COMPLETE_MESH_H */
