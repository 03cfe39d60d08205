/* Fills guided by hand: a transform, a candidate, a range of scales. */
#include "suite.h"
#include <math.h>

static struct ball bumpy;
static struct whole_ball whole, twin;

/* The whole ball, moved away and made larger, is the exemplar. */
static complete_mesh_options with_twin(int mirrored, float scale) {
  complete_mesh_options opts = defaults();
  int i, k;
  twin = whole;
  move_away(&twin, mirrored);
  for (i = 0; i < WHOLE_VERTICES; ++i)
    for (k = 0; k < 3; ++k) twin.vertices[i][k] *= scale;
  copy_only_from(&opts, &twin);
  return opts;
}

/* The way back from there, by rows. */
static void way_back(double *rows, int mirrored, double scale) {
  const double c = cos(0.6), s = sin(0.6), d = cos(2.1), t = sin(2.1);
  const double turn[3][3] = {{c, -s, 0}, {d * s, d * c, -t}, {t * s, t * c, d}};
  const double shift[3] = {3, -7, 0.5};
  int i, k;
  for (i = 0; i < 3; ++i) {
    const double sign = mirrored && i == 0 ? -1 : 1;
    rows[4 * i + 3] = 0;
    for (k = 0; k < 3; ++k) {
      rows[4 * i + k] = sign * turn[k][i] / scale;
      rows[4 * i + 3] -= sign * turn[k][i] * shift[k];
    }
  }
}

static complete_mesh_result *complete_bumpy(const complete_mesh_options *opts) {
  complete_mesh_result *result = NULL;
  CHECK(complete_mesh(bumpy.vertices, VERTICES, bumpy.faces[0], FACES, opts, &result) ==
        COMPLETE_MESH_STATUS_OK);
  return result;
}

/* Of the hole with the most new vertices: the other has too few to be anything but smooth. */
static double error_of(const complete_mesh_result *result) {
  const complete_mesh_holes *holes = complete_mesh_result_holes(result);
  complete_mesh_hole hole = get_hole(holes, 0);
  if (get_hole(holes, 1).new_vertex_count > hole.new_vertex_count) hole = get_hole(holes, 1);
  return off_whole(&whole,
                   (const float *)complete_mesh_result_new_vertices(result) + 3 * hole.first_new_vertex,
                   hole.new_vertex_count);
}

/* The source of the hole that has the most new vertices. */
static complete_mesh_source main_source(const complete_mesh_result *result, complete_mesh_hole *hole) {
  const complete_mesh_holes *holes = complete_mesh_result_holes(result);
  complete_mesh_source source;
  size_t i;
  memset(&source, 0, sizeof source);
  *hole = get_hole(holes, 0);
  for (i = 1; i < complete_mesh_holes_count(holes); ++i)
    if (get_hole(holes, i).new_vertex_count > hole->new_vertex_count) *hole = get_hole(holes, i);
  if (FINE) CHECK(complete_mesh_holes_source(holes, hole->id, 0, &source, sizeof source) == 1);
  return source;
}

/* What is given by hand is used and nothing else, whatever its size; a degree off it is, and is not once
 * it is refined. */
static void placement(int mirrored, float scale) {
  complete_mesh_options opts = with_twin(mirrored, scale);
  complete_mesh_result *result;
  complete_mesh_hole hole;
  complete_mesh_source source;
  double rows[12], exact, off;
  int k;
  way_back(rows, mirrored, scale);
  opts.placement = rows;
  result = complete_bumpy(&opts);
  exact = error_of(result);
  source = main_source(result, &hole);
  if (FINE) {
    CHECK(exact < 1e-4 && hole.source_count == 1 && hole.confidence > 0.95);
    CHECK((int)source.mirrored == mirrored);
    for (k = 0; k < 12; ++k) CHECK(fabs(source.transform[k] - rows[k]) < 1e-12);
  }
  complete_mesh_result_free(result);
  for (k = 3; k < 12; k += 4) rows[k] += 0.03;
  result = complete_bumpy(&opts);
  off = error_of(result);
  if (FINE) CHECK(off > 10 * exact);
  complete_mesh_result_free(result);
  opts.refine = 1;
  result = complete_bumpy(&opts);
  if (FINE) CHECK(error_of(result) < 0.3 * off);
  complete_mesh_result_free(result);
}

/* A twin of three times the size is found if it may be, and is not if not. */
static void scales(void) {
  complete_mesh_options opts = with_twin(1, 3);
  complete_mesh_result *result;
  double without;
  result = complete_bumpy(&opts);
  without = error_of(result);
  complete_mesh_result_free(result);
  opts.least_scale = 0.3;
  opts.greatest_scale = 0.4;
  result = complete_bumpy(&opts);
  if (FINE) CHECK(error_of(result) < 0.1 * without);
  complete_mesh_result_free(result);
}

/* Each candidate of a completer has one source, other than that of the one before. */
static void candidates(void) {
  complete_mesh_options opts = defaults();
  complete_mesh_completer *completer = NULL;
  complete_mesh_source last;
  uint32_t count = 1;
  memset(&last, 0, sizeof last);
  CHECK(complete_mesh_completer_new(bumpy.vertices, VERTICES, bumpy.faces[0], FACES, NULL,
                                    &completer) == COMPLETE_MESH_STATUS_OK);
  for (opts.candidate = 1; opts.candidate <= count && opts.candidate <= 3; ++opts.candidate) {
    complete_mesh_result *result = NULL;
    complete_mesh_hole hole;
    complete_mesh_source source;
    CHECK(complete_mesh_completer_complete(completer, &opts, &result) == COMPLETE_MESH_STATUS_OK);
    source = main_source(result, &hole);
    count = hole.candidate_count;
    CHECK(hole.is_border == 0 && hole.detectors_asked == 0);
    if (FINE && opts.candidate <= count) {
      CHECK(hole.source_count == 1 && fabs(source.weight - 1) < 1e-9);
      CHECK(memcmp(source.transform, last.transform, sizeof last.transform) != 0);
    }
    last = source;
    complete_mesh_result_free(result);
  }
  if (FINE) CHECK(count >= 2);
  complete_mesh_completer_free(completer);
}

/* A bump over the cap that nothing shows: the fill goes through its top. */
static void points(void) {
  const double top[3] = {0, 0, 1.3};
  complete_mesh_options opts = defaults();
  complete_mesh_result *result;
  const float *p;
  double nearest = 9;
  size_t i;
  opts.method = COMPLETE_MESH_METHOD_SMOOTH;
  opts.constraint_points = top;
  opts.constraint_count = 1;
  result = complete_bumpy(&opts);
  p = (const float *)complete_mesh_result_new_vertices(result);
  for (i = 0; i < complete_mesh_result_new_vertex_count(result); ++i, p += 3) {
    const double d = sqrt(p[0] * p[0] + p[1] * p[1] + (p[2] - 1.3) * (p[2] - 1.3));
    nearest = d < nearest ? d : nearest;
  }
  /* within an edge: the top lies on a face */
  CHECK(nearest < (FINE ? 0.15 : 0.5));
  complete_mesh_result_free(result);
}

/* A ball without bumps, where the twin is, is the other exemplar: the twin is copied from. */
static void parts(void) {
  static float both[2 * WHOLE_VERTICES][3];
  static uint32_t all[2 * WHOLE_FACES][3];
  static const uint32_t sizes[2] = {WHOLE_VERTICES, WHOLE_VERTICES};
  static struct whole_ball plain;
  complete_mesh_options opts = with_twin(0, 1);
  complete_mesh_result *result;
  const uint32_t *faces;
  size_t i, from_plain = 0;
  int k;
  make_whole_ball(&plain);
  move_away(&plain, 0);
  memcpy(both[0], plain.vertices, sizeof plain.vertices);
  memcpy(both[WHOLE_VERTICES], twin.vertices, sizeof twin.vertices);
  memcpy(all[0], plain.faces, sizeof plain.faces);
  for (i = 0; i < WHOLE_FACES; ++i)
    for (k = 0; k < 3; ++k) all[WHOLE_FACES + i][k] = twin.faces[i][k] + WHOLE_VERTICES;
  opts.exemplar_vertices = both;
  opts.exemplar_vertex_count = 2 * WHOLE_VERTICES;
  opts.exemplar_faces = all[0];
  opts.exemplar_face_count = 2 * WHOLE_FACES;
  opts.exemplar_parts = sizes;
  opts.exemplar_part_count = 2;
  result = complete_bumpy(&opts);
  faces = complete_mesh_result_new_vertex_source_faces(result);
  for (i = 0; i < complete_mesh_result_new_vertex_count(result); ++i)
    from_plain += faces[i] != UINT32_MAX && faces[i] < FACES + WHOLE_FACES;
  if (FINE) CHECK(from_plain * 10 < complete_mesh_result_new_vertex_count(result));
  complete_mesh_result_free(result);
}

static void refused(complete_mesh_options opts, complete_mesh_status expected, const char *name) {
  complete_mesh_result *result = NULL;
  CHECK(complete_mesh(bumpy.vertices, VERTICES, bumpy.faces[0], FACES, &opts, &result) == expected);
  CHECK(result == NULL && strstr(complete_mesh_last_error_message(), name) != NULL);
}

/* The twin's own vertices and triangles. */
static void part(void) {
  complete_mesh_options opts = with_twin(1, 1);
  complete_mesh_result *result;
  const uint32_t cap = 0;
  double rows[12];
  way_back(rows, 1, 1);
  opts.placement = rows;
  opts.part = 1;
  /* the cap: of the other hole next to nothing is missing */
  opts.selection = COMPLETE_MESH_SELECTION_IDS;
  opts.selection_ids = &cap;
  opts.selection_count = 1;
  result = complete_bumpy(&opts);
  CHECK(error_of(result) < 1e-4);
  complete_mesh_result_free(result);
}

static void errors(void) {
  const uint32_t nowhere[1] = {UINT32_MAX};
  const complete_mesh_status option = COMPLETE_MESH_STATUS_INVALID_OPTION;
  const double far[3] = {0, 0, 30};
  const uint32_t sizes[2] = {5, 5};
  double rows[12] = {1, 0, 0, 0, 0, 3, 0, 0, 0, 0, 1, 0};
  complete_mesh_options opts = defaults();
  opts.placement = rows;
  refused(opts, option, "no similarity");
  rows[5] = 1;
  opts.candidate = 1;
  refused(opts, option, "candidate");
  opts.candidate = 0;
  opts.refine = 2;
  refused(opts, COMPLETE_MESH_STATUS_INVALID_ARGUMENT, "refine");
  opts = defaults();
  opts.refine = 1;
  refused(opts, option, "placement");
  opts = defaults();
  opts.least_scale = 1;
  refused(opts, option, "scales");
  opts = defaults();
  opts.constraint_count = 1;
  refused(opts, COMPLETE_MESH_STATUS_INVALID_ARGUMENT, "constraint_points is NULL");
  opts.constraint_points = far;
  refused(opts, option, "point 0");
  opts = defaults();
  opts.softness = 2;
  refused(opts, option, "softness");
  opts = defaults();
  opts.loose_count = 1;
  refused(opts, COMPLETE_MESH_STATUS_INVALID_ARGUMENT, "loose_vertices is NULL");
  opts.loose_vertices = nowhere;
  refused(opts, option, "on no rim");
  opts = defaults();
  opts.part = 1;
  opts.method = COMPLETE_MESH_METHOD_WARP;
  refused(opts, option, "part");
  opts = with_twin(0, 1);
  opts.exemplar_part_count = 2;
  refused(opts, COMPLETE_MESH_STATUS_INVALID_ARGUMENT, "exemplar_parts is NULL");
  opts.exemplar_parts = sizes;
  refused(opts, option, "parts");
  opts = defaults();
  opts.least_scale = 1;
  opts.greatest_scale = 2;
  opts.method = COMPLETE_MESH_METHOD_SMOOTH;
  refused(opts, option, "scales");
}

void test_guidance(void) {
  bumpy = ball;
  add_bumps(bumpy.vertices, VERTICES);
  make_whole_ball(&whole);
  add_bumps(whole.vertices, WHOLE_VERTICES);
  placement(0, 1);
  placement(1, 0.25f);
  scales();
  candidates();
  points();
  parts();
  part();
  errors();
}
