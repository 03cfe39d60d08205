/* What a caller can get wrong: NULL, garbage, numbers out of range, structs of other versions. */
#include "suite.h"
#include <stdlib.h>

/* For functions that must leave NULL behind when they fail. */
#define NOT_NULL(type) ((type *)(void *)&ball)

static int message_has(const char *part) {
  return strstr(complete_mesh_last_error_message(), part) != NULL;
}

static complete_mesh_status run(const void *v, size_t nv, const uint32_t *f, size_t nf,
                                const complete_mesh_options *opts) {
  complete_mesh_result *result = NOT_NULL(complete_mesh_result);
  const complete_mesh_status status = complete_mesh(v, nv, f, nf, opts, &result);
  CHECK((status == COMPLETE_MESH_STATUS_OK) == (result != NULL));
  complete_mesh_result_free(result);
  return status;
}

static void null_accessors(void) {
  size_t n = 7;
  complete_mesh_hole hole;
  CHECK(complete_mesh_result_vertex_count(NULL) == 0);
  CHECK(complete_mesh_result_face_count(NULL) == 0);
  CHECK(complete_mesh_result_input_vertex_count(NULL) == 0);
  CHECK(complete_mesh_result_input_face_count(NULL) == 0);
  CHECK(complete_mesh_result_new_vertex_count(NULL) == 0);
  CHECK(complete_mesh_result_new_face_count(NULL) == 0);
  CHECK(complete_mesh_result_filled_count(NULL) == 0);
  CHECK(complete_mesh_result_vertex_type(NULL) == 0);
  CHECK(complete_mesh_result_vertices(NULL) == NULL);
  CHECK(complete_mesh_result_faces(NULL) == NULL);
  CHECK(complete_mesh_result_new_vertices(NULL) == NULL);
  CHECK(complete_mesh_result_new_faces(NULL) == NULL);
  CHECK(complete_mesh_result_new_vertex_holes(NULL) == NULL);
  CHECK(complete_mesh_result_new_vertex_source_faces(NULL) == NULL);
  CHECK(complete_mesh_result_new_vertex_barycentrics(NULL) == NULL);
  CHECK(complete_mesh_result_new_vertex_sources(NULL) == NULL);
  CHECK(complete_mesh_result_new_vertex_confidences(NULL) == NULL);
  CHECK(complete_mesh_result_new_face_holes(NULL) == NULL);
  CHECK(complete_mesh_result_holes(NULL) == NULL);
  CHECK(complete_mesh_result_seconds(NULL) == 0);
  CHECK(complete_mesh_result_cpu_seconds(NULL) == 0);
  CHECK(complete_mesh_completer_holes(NULL) == NULL);
  CHECK(complete_mesh_holes_count(NULL) == 0);
  CHECK(complete_mesh_holes_get(NULL, 0, &hole, sizeof hole) == 0);
  CHECK(complete_mesh_holes_loop(NULL, 0, 0, &n) == NULL && n == 0);
  CHECK(complete_mesh_holes_loop(NULL, 0, 0, NULL) == NULL);
  CHECK(strcmp(complete_mesh_holes_reason(NULL, 0), "") == 0);
  CHECK(complete_mesh_holes_problem_elements(NULL, 0, 0, &n) == NULL && n == 0);
  CHECK(complete_mesh_holes_non_manifold_edges(NULL, &n) == NULL && n == 0);
  CHECK(complete_mesh_holes_inconsistent_edges(NULL, &n) == NULL && n == 0);
  CHECK(complete_mesh_holes_degenerate_faces(NULL, &n) == NULL && n == 0);
  CHECK(complete_mesh_holes_duplicate_vertices(NULL, NULL) == NULL);
  CHECK(complete_mesh_holes_spacing(NULL) == 0);
  CHECK(complete_mesh_holes_ignored_points(NULL, 0, &n) == NULL && n == 0);
  CHECK(complete_mesh_result_new_vertex_source_points(NULL) == NULL);
  CHECK(complete_mesh_result_new_vertex_normals(NULL) == NULL);
  CHECK(complete_mesh_result_new_vertex_values(NULL) == NULL);
  complete_mesh_result_free(NULL);
  complete_mesh_holes_free(NULL);
  complete_mesh_completer_free(NULL);
}

static void null_entries(void) {
  complete_mesh_result *result = NOT_NULL(complete_mesh_result);
  complete_mesh_holes *holes = NOT_NULL(complete_mesh_holes);
  complete_mesh_completer *completer = NOT_NULL(complete_mesh_completer);
  const complete_mesh_status bad = COMPLETE_MESH_STATUS_INVALID_ARGUMENT;
  CHECK(complete_mesh(ball.vertices, VERTICES, ball.faces[0], FACES, NULL, NULL) == bad);
  CHECK(message_has("result is NULL"));
  CHECK(complete_mesh(NULL, VERTICES, ball.faces[0], FACES, NULL, &result) == bad && !result);
  CHECK(message_has("vertices is NULL"));
  CHECK(run(ball.vertices, VERTICES, NULL, FACES, NULL) == bad && message_has("faces is NULL"));
  CHECK(run(NULL, 0, NULL, 0, NULL) == COMPLETE_MESH_STATUS_INVALID_MESH);
  CHECK(run(ball.vertices, VERTICES, NULL, 0, NULL) == COMPLETE_MESH_STATUS_INVALID_MESH);
  CHECK(complete_mesh_find_holes(NULL, 1, ball.faces[0], FACES, NULL, &holes) == bad && !holes);
  CHECK(complete_mesh_find_holes(ball.vertices, VERTICES, ball.faces[0], FACES, NULL, NULL) == bad);
  CHECK(complete_mesh_points(NULL, 3, NULL, NULL, &result) == bad && !result);
  CHECK(complete_mesh_points(ball.vertices, VERTICES, NULL, NULL, NULL) == bad);
  holes = NOT_NULL(complete_mesh_holes);
  CHECK(complete_mesh_find_point_holes(NULL, 3, NULL, NULL, &holes) == bad && !holes);
  CHECK(complete_mesh_find_point_holes(ball.vertices, VERTICES, NULL, NULL, NULL) == bad);
  CHECK(message_has("holes is NULL"));
  CHECK(complete_mesh_completer_new(NULL, 1, ball.faces[0], FACES, NULL, &completer) == bad);
  CHECK(completer == NULL);
  CHECK(complete_mesh_completer_new(ball.vertices, 3, ball.faces[0], FACES, NULL, NULL) == bad);
  result = NOT_NULL(complete_mesh_result);
  CHECK(complete_mesh_completer_complete(NULL, NULL, &result) == bad && result == NULL);
  CHECK(message_has("completer is NULL"));
  CHECK(complete_mesh_options_init(NULL, sizeof(complete_mesh_options)) == bad);
}

void test_null(void) {
  null_accessors();
  null_entries();
  CHECK(strcmp(complete_mesh_status_name(COMPLETE_MESH_STATUS_OK), "ok") == 0);
  CHECK(strcmp(complete_mesh_status_name(COMPLETE_MESH_STATUS_CANCELLED), "cancelled") == 0);
  CHECK(strcmp(complete_mesh_status_name(12345), "unknown status") == 0);
}

/* Sets one number of the options and expects the error to name it. */
static void expect_refused(size_t offset, uint32_t value, const char *field,
                           complete_mesh_status expected) {
  complete_mesh_options opts = defaults();
  complete_mesh_holes *holes = NULL;
  memcpy((char *)&opts + offset, &value, sizeof value);
  CHECK(run(ball.vertices, VERTICES, ball.faces[0], FACES, &opts) == expected);
  if (!CHECK(message_has(field))) printf("  for %s = %lu\n", field, (unsigned long)value);
  /* All options are checked by all entries. */
  CHECK(complete_mesh_find_holes(ball.vertices, VERTICES, ball.faces[0], FACES, &opts, &holes) ==
        expected);
  CHECK(holes == NULL);
}

#define REFUSED(field, first_unknown)                                                           \
  do {                                                                                          \
    expect_refused(offsetof(complete_mesh_options, field), (uint32_t)(first_unknown), #field,   \
                   COMPLETE_MESH_STATUS_INVALID_ARGUMENT);                                      \
    expect_refused(offsetof(complete_mesh_options, field), 0xFFFFFFFFu, #field,                 \
                   COMPLETE_MESH_STATUS_INVALID_ARGUMENT);                                      \
  } while (0)

static void impossible_sizes(void) {
  const size_t huge = (size_t)-1;
  const complete_mesh_status bad = COMPLETE_MESH_STATUS_INVALID_ARGUMENT;
  complete_mesh_options opts = defaults();
  CHECK(run(ball.vertices, huge, ball.faces[0], FACES, NULL) == bad && message_has("vertices"));
  CHECK(run(ball.vertices, VERTICES, ball.faces[0], huge / 4, NULL) == bad && message_has("faces"));
  /* count * stride wraps round to something small */
  opts.vertex_stride = huge / 2 + 13;
  CHECK(run(ball.vertices, 3, ball.faces[0], FACES, &opts) == bad);
  opts.vertex_stride = 11;
  CHECK(run(ball.vertices, VERTICES, ball.faces[0], FACES, &opts) == bad && message_has("stride"));
  opts.vertex_type = COMPLETE_MESH_VERTEX_TYPE_F64;
  opts.vertex_stride = 23;
  CHECK(run(ball.vertices, 2, ball.faces[0], FACES, &opts) == bad && message_has("stride"));
  opts = defaults();
  opts.face_stride = 11;
  CHECK(run(ball.vertices, VERTICES, ball.faces[0], FACES, &opts) == bad && message_has("stride"));
  opts = defaults();
  opts.selection = COMPLETE_MESH_SELECTION_IDS;
  opts.selection_count = 2;
  CHECK(run(ball.vertices, VERTICES, ball.faces[0], FACES, &opts) == bad);
  CHECK(message_has("selection_ids is NULL"));
  opts.selection_ids = ball.faces[0];
  opts.selection_count = huge;
  CHECK(run(ball.vertices, VERTICES, ball.faces[0], FACES, &opts) == bad);
  opts = defaults();
  opts.grouping = COMPLETE_MESH_GROUPING_JOIN;
  opts.join_count = 1;
  CHECK(run(ball.vertices, VERTICES, ball.faces[0], FACES, &opts) == bad);
  CHECK(message_has("join_sizes is NULL"));
}

void test_enums(void) {
  const complete_mesh_status range = COMPLETE_MESH_STATUS_INVALID_OPTION;
  complete_mesh_options opts;
  REFUSED(vertex_type, COMPLETE_MESH_VERTEX_TYPE_F64 + 1);
  REFUSED(method, COMPLETE_MESH_METHOD_WARP + 1);
  REFUSED(fairing, COMPLETE_MESH_FAIRING_SMOOTHED_PLATE + 1);
  REFUSED(sizing, COMPLETE_MESH_SIZING_NONE + 1);
  REFUSED(grouping, COMPLETE_MESH_GROUPING_JOIN + 1);
  REFUSED(selection, COMPLETE_MESH_SELECTION_NEAR_VERTICES + 1);
  REFUSED(output, COMPLETE_MESH_OUTPUT_NEW_ONLY + 1);
  REFUSED(skip_unsafe, 2);
  REFUSED(clean, 2);
  expect_refused(offsetof(complete_mesh_options, threads), 1025, "threads", range);
  opts = defaults();
  opts.sizing = COMPLETE_MESH_SIZING_SCALED;
  opts.sizing_value = 100;
  CHECK(run(ball.vertices, VERTICES, ball.faces[0], FACES, &opts) == range && message_has("sizing"));
  opts.sizing = COMPLETE_MESH_SIZING_EDGE_LENGTH;
  opts.sizing_value = -1;
  CHECK(run(ball.vertices, VERTICES, ball.faces[0], FACES, &opts) == range && message_has("sizing"));
  opts = defaults();
  opts.selection = COMPLETE_MESH_SELECTION_MAX_DIAMETER;
  CHECK(run(ball.vertices, VERTICES, ball.faces[0], FACES, &opts) == range);
  CHECK(message_has("selection"));
  impossible_sizes();
}

/* The options of a program that was compiled when there was nothing behind the grouping. */
struct old_options {
  uint32_t struct_size, vertex_type;
  size_t vertex_stride, face_stride;
  uint32_t method, fairing, sizing, grouping;
};

/* On the heap, where valgrind watches the byte behind. */
static void shorter_struct(void) {
  struct old_options *old = (struct old_options *)malloc(sizeof *old);
  const complete_mesh_options *as_now = (const complete_mesh_options *)(void *)old;
  complete_mesh_result *with_old = NULL, *with_new = NULL;
  complete_mesh_options opts = defaults();
  if (!CHECK(old != NULL)) return;
  CHECK(sizeof *old == offsetof(complete_mesh_options, sizing_value));
  CHECK(complete_mesh_options_init((complete_mesh_options *)(void *)old, sizeof *old) ==
        COMPLETE_MESH_STATUS_OK);
  CHECK(old->struct_size == sizeof *old && old->grouping == 0);
  old->fairing = opts.fairing = COMPLETE_MESH_FAIRING_C0;
  with_old = complete_ball(as_now, NULL);
  with_new = complete_ball(&opts, NULL);
  CHECK(complete_mesh_result_vertex_count(with_old) > VERTICES);
  CHECK(complete_mesh_result_vertex_count(with_old) == complete_mesh_result_vertex_count(with_new));
  CHECK(memcmp(complete_mesh_result_vertices(with_old), complete_mesh_result_vertices(with_new),
               complete_mesh_result_vertex_count(with_new) * sizeof(float[3])) == 0);
  complete_mesh_result_free(with_old);
  complete_mesh_result_free(with_new);
  free(old);
}

/* A caller of a later version whose struct has 16 bytes more. */
static void longer_struct(void) {
  struct {
    complete_mesh_options known;
    double later;
    uint32_t more, still_more;
  } opts;
  CHECK(complete_mesh_options_init(&opts.known, sizeof opts) == COMPLETE_MESH_STATUS_OK);
  CHECK(opts.known.struct_size == sizeof opts && opts.later == 0 && opts.more == 0);
  CHECK(run(ball.vertices, VERTICES, ball.faces[0], FACES, &opts.known) ==
        COMPLETE_MESH_STATUS_OK);
  opts.still_more = 1;
  CHECK(run(ball.vertices, VERTICES, ball.faces[0], FACES, &opts.known) ==
        COMPLETE_MESH_STATUS_UNSUPPORTED);
}

void test_options_size(void) {
  const uint32_t wrong[] = {0, 4, 7, 9, 12, 100000, 0xFFFFFFFFu};
  unsigned char guarded[sizeof(complete_mesh_options)];
  complete_mesh_options opts = defaults();
  complete_mesh_hole hole;
  complete_mesh_holes *holes = NULL;
  size_t i;
  shorter_struct();
  longer_struct();
  for (i = 0; i < sizeof wrong / sizeof wrong[0]; ++i) {
    opts.struct_size = wrong[i];
    CHECK(run(ball.vertices, VERTICES, ball.faces[0], FACES, &opts) ==
          COMPLETE_MESH_STATUS_INVALID_ARGUMENT);
    CHECK(message_has("struct_size"));
    CHECK(complete_mesh_options_init(&opts, wrong[i]) == COMPLETE_MESH_STATUS_INVALID_ARGUMENT);
  }
  /* not a byte beyond the size that was given */
  memset(guarded, 0xAB, sizeof guarded);
  CHECK(complete_mesh_options_init((complete_mesh_options *)(void *)guarded, 8) ==
        COMPLETE_MESH_STATUS_OK);
  CHECK(guarded[0] == 8 && guarded[7] == 0 && guarded[8] == 0xAB);
  for (i = 8; i < sizeof guarded; ++i) {
    if (guarded[i] != 0xAB) break;
  }
  CHECK(i == sizeof guarded);
  CHECK(complete_mesh_find_holes(ball.vertices, VERTICES, ball.faces[0], FACES, NULL, &holes) ==
        COMPLETE_MESH_STATUS_OK);
  memset(&hole, 0xAB, sizeof hole);
  CHECK(complete_mesh_holes_get(holes, 0, &hole, offsetof(complete_mesh_hole, status)) == 1);
  CHECK(hole.struct_size == offsetof(complete_mesh_hole, status) && hole.status == 0xABABABABu);
  CHECK(complete_mesh_holes_get(holes, 0, &hole, 7) == 0);
  CHECK(complete_mesh_holes_get(holes, 0, NULL, sizeof hole) == 0);
  CHECK(complete_mesh_holes_get(holes, 99, &hole, sizeof hole) == 0);
  complete_mesh_holes_free(holes);
}

static size_t named(uint32_t kind) {
  size_t n = 7;
  const uint32_t *elements = complete_mesh_last_error_elements(kind, &n);
  CHECK((elements != NULL) == (n > 0));
  return n;
}

static int first_named(uint32_t kind, uint32_t expected) {
  const uint32_t *elements = complete_mesh_last_error_elements(kind, NULL);
  return elements != NULL && elements[0] == expected;
}

/* Two triangles that share only vertex 2: both loops pass through it. */
static void touching_loops(void) {
  const float v[5][3] = {{0, 0, 0}, {1, 0, 0}, {0.5f, 1, 0}, {0, 2, 0}, {1, 2, 0}};
  const uint32_t f[] = {0, 1, 2, 2, 4, 3};
  complete_mesh_options opts = defaults();
  complete_mesh_result *result = NULL;
  complete_mesh_holes *holes = NULL;
  const complete_mesh_holes *reported;
  size_t n = 0, id, unsafe = 0;
  const uint32_t *vertices;
  CHECK(run(v, 5, f, 2, NULL) == COMPLETE_MESH_STATUS_UNSAFE_HOLE);
  CHECK(named(COMPLETE_MESH_ELEMENT_KIND_HOLE) == 1);
  CHECK(first_named(COMPLETE_MESH_ELEMENT_KIND_HOLE, 0));
  CHECK(named(COMPLETE_MESH_ELEMENT_KIND_VERTEX) == 1);
  CHECK(first_named(COMPLETE_MESH_ELEMENT_KIND_VERTEX, 2));
  CHECK(named(COMPLETE_MESH_ELEMENT_KIND_EDGE) == 0);
  CHECK(named(99) == 0);
  CHECK(complete_mesh_find_holes(v, 5, f, 2, NULL, &holes) == COMPLETE_MESH_STATUS_OK);
  CHECK(complete_mesh_holes_count(holes) >= 1);
  CHECK(get_hole(holes, 0).is_unsafe == 1);
  CHECK(get_hole(holes, 0).status == COMPLETE_MESH_HOLE_STATUS_OPEN);
  CHECK(strstr(complete_mesh_holes_reason(holes, 0), "vertex 2") != NULL);
  vertices = complete_mesh_holes_problem_elements(holes, 0, COMPLETE_MESH_ELEMENT_KIND_VERTEX, &n);
  CHECK(n == 1 && vertices != NULL && vertices[0] == 2);
  complete_mesh_holes_free(holes);
  opts.skip_unsafe = 1;
  CHECK(complete_mesh(v, 5, f, 2, &opts, &result) == COMPLETE_MESH_STATUS_OK);
  reported = complete_mesh_result_holes(result);
  for (id = 0; id < complete_mesh_holes_count(reported); ++id)
    unsafe += get_hole(reported, id).status == COMPLETE_MESH_HOLE_STATUS_UNSAFE;
  CHECK(unsafe == complete_mesh_holes_count(reported) && unsafe > 0);
  CHECK(complete_mesh_result_new_face_count(result) == 0);
  CHECK(complete_mesh_result_new_faces(result) == NULL);
  CHECK(complete_mesh_result_face_count(result) == 2);
  complete_mesh_result_free(result);
}

void test_error_elements(void) {
  static struct ball broken; /* static: too big for small stacks */
  const uint32_t no_such[] = {1, 17};
  complete_mesh_options opts = defaults();
  broken = ball;
  broken.vertices[5][1] = (float)NAN;
  CHECK(run(broken.vertices, VERTICES, broken.faces[0], FACES, NULL) ==
        COMPLETE_MESH_STATUS_INVALID_MESH);
  CHECK(named(COMPLETE_MESH_ELEMENT_KIND_VERTEX) == 1);
  CHECK(first_named(COMPLETE_MESH_ELEMENT_KIND_VERTEX, 5));
  /* a success leaves the last failure alone */
  CHECK(run(ball.vertices, VERTICES, ball.faces[0], FACES, NULL) == COMPLETE_MESH_STATUS_OK);
  CHECK(message_has("vertex 5"));
  broken = ball;
  broken.faces[9][2] = VERTICES;
  CHECK(run(broken.vertices, VERTICES, broken.faces[0], FACES, NULL) ==
        COMPLETE_MESH_STATUS_INVALID_MESH);
  CHECK(named(COMPLETE_MESH_ELEMENT_KIND_VERTEX) == 0);
  CHECK(named(COMPLETE_MESH_ELEMENT_KIND_FACE) == 1);
  CHECK(first_named(COMPLETE_MESH_ELEMENT_KIND_FACE, 9));
  opts.selection = COMPLETE_MESH_SELECTION_IDS;
  opts.selection_ids = no_such;
  opts.selection_count = 2;
  CHECK(run(ball.vertices, VERTICES, ball.faces[0], FACES, &opts) ==
        COMPLETE_MESH_STATUS_NO_SUCH_HOLE);
  CHECK(first_named(COMPLETE_MESH_ELEMENT_KIND_HOLE, 17));
  touching_loops();
}
