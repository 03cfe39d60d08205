/* Holes found, measured, selected and filled, by value. */
#include "suite.h"

static int near(double a, double b) { return fabs(a - b) <= 1e-5; }

/* A loop of a hole that runs through exactly the vertices first to first + count - 1. */
static int runs_through(const complete_mesh_holes *holes, size_t id, uint32_t first, size_t count) {
  size_t n = 0, i;
  const uint32_t *loop = complete_mesh_holes_loop(holes, id, 0, &n);
  if (loop == NULL || n != count) return 0;
  for (i = 0; i < n; ++i) {
    if (loop[i] < first || loop[i] >= first + count) return 0;
  }
  /* the cap's faces go round with growing longitude, so the fill goes the same way */
  return loop[0] == first && loop[1] == first + 1;
}

static void check_measures(const complete_mesh_holes *holes, uint32_t expected_status) {
  const complete_mesh_hole cap = get_hole(holes, 0), patch = get_hole(holes, 1);
  size_t n = 7;
  CHECK(complete_mesh_holes_count(holes) == 2);
  CHECK(cap.struct_size == sizeof cap && cap.id == 0 && patch.id == 1);
  CHECK(cap.kind == COMPLETE_MESH_HOLE_KIND_DISC && patch.kind == COMPLETE_MESH_HOLE_KIND_DISC);
  CHECK(cap.status == expected_status && patch.status == expected_status);
  CHECK(cap.loop_count == 1 && cap.edge_count == CAP_EDGES);
  CHECK(patch.loop_count == 1 && patch.edge_count == PATCH_EDGES);
  CHECK(near(cap.circumference, AROUND * cap_edge()));
  CHECK(near(cap.diameter, 2 * sin(ball_angle(0))));
  CHECK(near(cap.centre[0], 0) && near(cap.centre[1], 0));
  CHECK(near(cap.centre[2], cos(ball_angle(0))));
  CHECK(patch.circumference < cap.circumference && patch.diameter < cap.diameter);
  CHECK(patch.centre[0] > 0.6 && fabs(patch.centre[2]) < 0.1);
  CHECK(cap.is_unsafe == 0 && strcmp(complete_mesh_holes_reason(holes, 0), "") == 0);
  CHECK(cap.is_border == 0 && cap.detectors_asked == 0 && cap.detectors_agreed == 0);
  CHECK(isnan(cap.boundary_probability) && isnan(cap.missing_points));
  CHECK(complete_mesh_holes_spacing(holes) == 0);
  CHECK(runs_through(holes, 0, 0, AROUND));
  CHECK(complete_mesh_holes_loop(holes, 1, 0, &n) != NULL && n == PATCH_EDGES);
  CHECK(complete_mesh_holes_loop(holes, 1, 1, &n) == NULL && n == 0);
  CHECK(complete_mesh_holes_loop(holes, 2, 0, &n) == NULL);
  CHECK(complete_mesh_holes_non_manifold_edges(holes, &n) == NULL && n == 0);
  CHECK(complete_mesh_holes_inconsistent_edges(holes, &n) == NULL && n == 0);
  CHECK(complete_mesh_holes_degenerate_faces(holes, &n) == NULL && n == 0);
  CHECK(complete_mesh_holes_duplicate_vertices(holes, &n) == NULL && n == 0);
}

/* The ranges of the holes tile the new elements, and each element says whose it is. */
static void check_ranges(const complete_mesh_result *result) {
  const complete_mesh_holes *holes = complete_mesh_result_holes(result);
  const uint32_t *vertex_hole = complete_mesh_result_new_vertex_holes(result);
  const uint32_t *face_hole = complete_mesh_result_new_face_holes(result);
  size_t id, i, vertices = 0, faces = 0, strangers = 0;
  for (id = 0; id < complete_mesh_holes_count(holes); ++id) {
    const complete_mesh_hole hole = get_hole(holes, id);
    CHECK(hole.seconds >= 0 && hole.fairing > COMPLETE_MESH_FAIRING_AUTO);
    CHECK(hole.first_new_vertex == vertices && hole.first_new_face == faces);
    vertices += hole.new_vertex_count;
    faces += hole.new_face_count;
    for (i = hole.first_new_vertex; i < vertices; ++i) strangers += vertex_hole[i] != id;
    for (i = hole.first_new_face; i < faces; ++i) strangers += face_hole[i] != id;
    /* Euler: a disc of e rim edges and v inner vertices has e + 2 v - 2 triangles */
    CHECK(hole.new_face_count == hole.edge_count + 2 * hole.new_vertex_count - 2);
  }
  CHECK(strangers == 0);
  CHECK(vertices == complete_mesh_result_new_vertex_count(result));
  CHECK(faces == complete_mesh_result_new_face_count(result));
}

/* A strip whose last face is turned over, a fin on one of its edges and a face without area. */
static void odd_mesh(void) {
  const float v[6][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0.5f, 0.5f, 1}, {2, 0, 0}};
  const uint32_t f[] = {0, 1, 2, 2, 1, 3, 1, 2, 4, 5, 3, 1, 0, 0, 1};
  const uint32_t turned[] = {0, 1, 2, 1, 2, 3};
  complete_mesh_holes *holes = NULL;
  const uint32_t *elements;
  size_t n = 0;
  CHECK(complete_mesh_find_holes(v, 6, f, 5, NULL, &holes) == COMPLETE_MESH_STATUS_OK);
  elements = complete_mesh_holes_non_manifold_edges(holes, &n);
  CHECK(n == 1 && elements && elements[0] + elements[1] == 3 && elements[0] * elements[1] == 2);
  elements = complete_mesh_holes_degenerate_faces(holes, &n);
  CHECK(n == 1 && elements && elements[0] == 4);
  complete_mesh_holes_free(holes);
  CHECK(complete_mesh_find_holes(v, 4, turned, 2, NULL, &holes) == COMPLETE_MESH_STATUS_OK);
  elements = complete_mesh_holes_inconsistent_edges(holes, &n);
  CHECK(n == 1 && elements && elements[0] + elements[1] == 3 && elements[0] * elements[1] == 2);
  complete_mesh_holes_free(holes);
}

void test_holes(void) {
  complete_mesh_holes *holes = NULL;
  complete_mesh_result *result = complete_ball(NULL, NULL);
  CHECK(complete_mesh_find_holes(ball.vertices, VERTICES, ball.faces[0], FACES, NULL, &holes) ==
        COMPLETE_MESH_STATUS_OK);
  check_measures(holes, COMPLETE_MESH_HOLE_STATUS_OPEN);
  complete_mesh_holes_free(holes);
  check_measures(complete_mesh_result_holes(result), COMPLETE_MESH_HOLE_STATUS_FILLED);
  check_ranges(result);
  complete_mesh_result_free(result);
  odd_mesh();
}

/* Lists and fills what the options select and expects one hole, or none for 2. */
static void expect_only(const complete_mesh_options *opts, size_t id) {
  complete_mesh_result *result = complete_ball(opts, NULL);
  const complete_mesh_holes *holes = complete_mesh_result_holes(result);
  complete_mesh_holes *listed = NULL;
  size_t i;
  CHECK(complete_mesh_find_holes(ball.vertices, VERTICES, ball.faces[0], FACES, opts, &listed) ==
        COMPLETE_MESH_STATUS_OK);
  for (i = 0; i < 2; ++i) {
    CHECK(get_hole(listed, i).status == (i == id ? COMPLETE_MESH_HOLE_STATUS_OPEN
                                                 : COMPLETE_MESH_HOLE_STATUS_NOT_SELECTED));
  }
  complete_mesh_holes_free(listed);
  for (i = 0; i < 2; ++i) {
    CHECK(get_hole(holes, i).status == (i == id ? COMPLETE_MESH_HOLE_STATUS_FILLED
                                                : COMPLETE_MESH_HOLE_STATUS_NOT_SELECTED));
    CHECK((get_hole(holes, i).new_face_count > 0) == (i == id));
  }
  CHECK(complete_mesh_result_filled_count(result) == (id < 2));
  CHECK((complete_mesh_result_new_face_count(result) > 0) == (id < 2));
  complete_mesh_result_free(result);
}

void test_selection(void) {
  const uint32_t id = 1, cap_vertex = 3;
  complete_mesh_holes *holes = NULL;
  complete_mesh_hole patch;
  complete_mesh_options opts = defaults();
  CHECK(complete_mesh_find_holes(ball.vertices, VERTICES, ball.faces[0], FACES, NULL, &holes) ==
        COMPLETE_MESH_STATUS_OK);
  patch = get_hole(holes, 1);
  complete_mesh_holes_free(holes);
  opts.selection = COMPLETE_MESH_SELECTION_IDS;
  opts.selection_ids = &id;
  opts.selection_count = 1;
  expect_only(&opts, 1);
  opts.selection = COMPLETE_MESH_SELECTION_NEAR_VERTICES;
  opts.selection_ids = &cap_vertex;
  expect_only(&opts, 0);
  opts = defaults();
  opts.selection = COMPLETE_MESH_SELECTION_MAX_EDGES;
  opts.selection_max_edges = PATCH_EDGES;
  if (PATCH_EDGES < CAP_EDGES) expect_only(&opts, 1);
  opts.selection_max_edges = PATCH_EDGES - 1;
  expect_only(&opts, 2);
  opts.selection = COMPLETE_MESH_SELECTION_MAX_CIRCUMFERENCE;
  opts.selection_length = patch.circumference * 1.001;
  expect_only(&opts, 1);
  opts.selection_length = patch.circumference * 0.999;
  expect_only(&opts, 2);
  opts.selection = COMPLETE_MESH_SELECTION_MAX_DIAMETER;
  opts.selection_length = patch.diameter * 1.001;
  expect_only(&opts, 1);
  opts.selection = COMPLETE_MESH_SELECTION_ALL_BUT_LARGEST;
  expect_only(&opts, 1);
  opts.selection = COMPLETE_MESH_SELECTION_NEAR_POINT;
  opts.selection_point[2] = 5;
  expect_only(&opts, 0);
  opts.selection_point[0] = 50;
  expect_only(&opts, 1);
}

/* The completer gives what the one-off call gives, as often as it is asked. */
void test_completer(void) {
  complete_mesh_completer *completer = NULL;
  complete_mesh_result *first = NULL, *second = NULL, *direct;
  complete_mesh_options opts = defaults();
  const uint32_t id = 1;
  CHECK(complete_mesh_completer_new(ball.vertices, VERTICES, ball.faces[0], FACES, NULL,
                                    &completer) == COMPLETE_MESH_STATUS_OK);
  check_measures(complete_mesh_completer_holes(completer), COMPLETE_MESH_HOLE_STATUS_OPEN);
  CHECK(complete_mesh_completer_complete(completer, NULL, &first) == COMPLETE_MESH_STATUS_OK);
  opts.selection = COMPLETE_MESH_SELECTION_IDS;
  opts.selection_ids = &id;
  opts.selection_count = 1;
  CHECK(complete_mesh_completer_complete(completer, &opts, &second) == COMPLETE_MESH_STATUS_OK);
  /* results outlive their completer */
  complete_mesh_completer_free(completer);
  direct = complete_ball(NULL, NULL);
  CHECK(complete_mesh_result_vertex_count(first) == complete_mesh_result_vertex_count(direct));
  CHECK(memcmp(complete_mesh_result_vertices(first), complete_mesh_result_vertices(direct),
               complete_mesh_result_vertex_count(direct) * sizeof(float[3])) == 0);
  CHECK(complete_mesh_result_filled_count(first) == 2);
  CHECK(complete_mesh_result_filled_count(second) == 1);
  CHECK(complete_mesh_result_new_face_holes(second) != NULL);
  CHECK(complete_mesh_result_new_face_holes(second)[0] == 1);
  complete_mesh_result_free(first);
  complete_mesh_result_free(second);
  complete_mesh_result_free(direct);
}
