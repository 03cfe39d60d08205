/* What may be copied from, and an initial completion, by coordinates. */
#include "suite.h"
#include <math.h>
#include <stdlib.h>

static struct ball bumpy;
static struct whole_ball whole, twin;

static complete_mesh_result *complete_bumpy(const complete_mesh_options *opts,
                                            complete_mesh_status *status) {
  complete_mesh_result *result = NULL;
  *status = complete_mesh(bumpy.vertices, VERTICES, bumpy.faces[0], FACES, opts, &result);
  CHECK((*status == COMPLETE_MESH_STATUS_OK) == (result != NULL));
  return result;
}

/* How far the new vertices are from what is missing. */
static double error_of(const complete_mesh_result *result) {
  const size_t count = complete_mesh_result_new_vertex_count(result);
  CHECK(count > 0);
  return off_whole(&whole, (const float *)complete_mesh_result_new_vertices(result), count);
}

static double smooth_error(void) {
  complete_mesh_options opts = defaults();
  complete_mesh_status status;
  complete_mesh_result *result;
  double error;
  opts.method = COMPLETE_MESH_METHOD_SMOOTH;
  result = complete_bumpy(&opts, &status);
  error = error_of(result);
  complete_mesh_result_free(result);
  return error;
}

static void input_comes_first(const complete_mesh_result *result) {
  const void *vertices = complete_mesh_result_vertices(result);
  const uint32_t *faces = complete_mesh_result_faces(result);
  CHECK(vertices && memcmp(vertices, bumpy.vertices, sizeof bumpy.vertices) == 0);
  CHECK(faces && memcmp(faces, bumpy.faces, sizeof bumpy.faces) == 0);
}

static complete_mesh_options with_twin(int mirrored) {
  complete_mesh_options opts = defaults();
  twin = whole;
  move_away(&twin, mirrored);
  copy_only_from(&opts, &twin);
  return opts;
}

/* The whole ball, elsewhere and mirrored or not, gives back what is missing, to a tenth of the error
 * of a smooth fill; mirrored and not to be mirrored it does not, and is off by three quarters of it. */
static void exemplar(int mirrored, uint32_t unmirrored) {
  complete_mesh_options opts = with_twin(mirrored);
  complete_mesh_status status;
  complete_mesh_result *result;
  const uint32_t *faces;
  size_t i, outside = 0, reflecting = 0, hole, source;
  opts.unmirrored = unmirrored;
  result = complete_bumpy(&opts, &status);
  if (!CHECK(status == COMPLETE_MESH_STATUS_OK)) return;
  input_comes_first(result);
  if (FINE && mirrored && unmirrored) CHECK(error_of(result) > 0.4 * smooth_error());
  else if (FINE) CHECK(error_of(result) < 0.25 * smooth_error());
  faces = complete_mesh_result_new_vertex_source_faces(result);
  for (i = 0; i < complete_mesh_result_new_vertex_count(result); ++i)
    outside += faces[i] != UINT32_MAX && !(faces[i] >= FACES && faces[i] < FACES + WHOLE_FACES);
  CHECK(outside == 0);
  for (hole = 0; hole < 2; ++hole) {
    complete_mesh_source info;
    for (source = 0; complete_mesh_holes_source(complete_mesh_result_holes(result), hole, source,
                                                &info, sizeof info);
         ++source)
      reflecting += info.mirrored;
  }
  if (unmirrored) CHECK(reflecting == 0);
  complete_mesh_result_free(result);
}

/* What the twin's vertices carry comes with their shape: where they were on the ball. */
static void values(int mirrored) {
  static double of_ball[2 * VERTICES], of_twin[2 * WHOLE_VERTICES];
  complete_mesh_options opts = with_twin(mirrored);
  complete_mesh_status status;
  complete_mesh_result *result;
  const double *got;
  const float *p;
  const uint32_t *faces;
  size_t i;
  int k;
  for (i = 0; i < VERTICES; ++i)
    for (k = 0; k < 2; ++k) of_ball[2 * i + k] = bumpy.vertices[i][2 * k];
  for (i = 0; i < WHOLE_VERTICES; ++i)
    for (k = 0; k < 2; ++k) of_twin[2 * i + k] = whole.vertices[i][2 * k];
  opts.vertex_values = of_ball;
  opts.exemplar_values = of_twin;
  opts.value_channels = opts.steering_channels = 2;
  result = complete_bumpy(&opts, &status);
  if (!CHECK(status == COMPLETE_MESH_STATUS_OK)) return;
  got = complete_mesh_result_new_vertex_values(result);
  p = (const float *)complete_mesh_result_new_vertices(result);
  faces = complete_mesh_result_new_vertex_source_faces(result);
  CHECK(got != NULL);
  for (i = 0; FINE && got && i < complete_mesh_result_new_vertex_count(result); ++i)
    /* a hole of a few vertices stays smooth: values from its rim */
    for (k = 0; k < 2 && faces[i] != UINT32_MAX; ++k)
      CHECK(fabs(got[2 * i + k] - p[3 * i + 2 * k]) < 0.03);
  complete_mesh_result_free(result);
  opts.vertex_values = opts.exemplar_values = NULL;
  opts.value_channels = opts.steering_channels = 0;
  result = complete_bumpy(&opts, &status);
  CHECK(complete_mesh_result_new_vertex_values(result) == NULL);
  complete_mesh_result_free(result);
  opts.vertex_values = of_ball;
  opts.value_channels = 2;
  opts.steering_channels = 3;
  complete_bumpy(&opts, &status);
  CHECK(status == COMPLETE_MESH_STATUS_INVALID_OPTION);
}

static int is_low(const uint32_t *face) {
  int k;
  for (k = 0; k < 3; ++k)
    if (ball.vertices[face[k]][2] >= -0.2f) return 0;
  return 1;
}

/* How many new vertices were copied from the low part of the ball, and how many from elsewhere. */
static void count_places(const complete_mesh_options *opts, size_t *low, size_t *high) {
  complete_mesh_result *result = complete_ball(opts, NULL);
  const uint32_t *faces = complete_mesh_result_new_vertex_source_faces(result);
  size_t i;
  *low = *high = 0;
  for (i = 0; i < complete_mesh_result_new_vertex_count(result); ++i)
    if (faces[i] != UINT32_MAX) ++*(is_low(ball.faces[faces[i]]) ? low : high);
  complete_mesh_result_free(result);
}

/* Whichever part is copied from more when all may be, it is forbidden: nothing comes from there any
 * more, and something comes from the other. */
static void source_faces(void) {
  static uint8_t may[FACES];
  complete_mesh_options opts = defaults();
  size_t low, high, f;
  int forbid_low;
  count_places(&opts, &low, &high);
  if (FINE) CHECK(low + high > 0);
  forbid_low = low > high;
  for (f = 0; f < FACES; ++f) may[f] = is_low(ball.faces[f]) != forbid_low ? 255 : 0;
  opts.source_faces = may;
  count_places(&opts, &low, &high);
  CHECK((forbid_low ? low : high) == 0);
  if (FINE) CHECK((forbid_low ? high : low) > 0);
}

static int by_coordinates(const void *a, const void *b) {
  const float *p = (const float *)a, *q = (const float *)b;
  int k;
  for (k = 0; k < 3; ++k)
    if (p[k] != q[k]) return p[k] < q[k] ? -1 : 1;
  return 0;
}

static float *sorted_vertices(const complete_mesh_result *result) {
  const size_t size = 3 * sizeof(float), count = complete_mesh_result_new_vertex_count(result);
  float *copy = (float *)malloc(count * size);
  memcpy(copy, complete_mesh_result_new_vertices(result), count * size);
  qsort(copy, count, size, by_coordinates);
  return copy;
}

/* A membrane comes back as it was given, where a smooth fill would be another. */
static void initial(void) {
  complete_mesh_options opts = defaults();
  complete_mesh_status status;
  complete_mesh_result *given, *again, *other;
  opts.method = COMPLETE_MESH_METHOD_SMOOTH;
  other = complete_bumpy(&opts, &status);
  opts.fairing = COMPLETE_MESH_FAIRING_C0;
  given = complete_bumpy(&opts, &status);
  opts.fairing = COMPLETE_MESH_FAIRING_AUTO;
  opts.initial_vertices = complete_mesh_result_new_vertices(given);
  opts.initial_vertex_count = complete_mesh_result_new_vertex_count(given);
  opts.initial_faces = complete_mesh_result_new_faces(given);
  opts.initial_face_count = complete_mesh_result_new_face_count(given);
  again = complete_bumpy(&opts, &status);
  if (CHECK(given && again && other)) {
    const size_t count = complete_mesh_result_new_vertex_count(given);
    float *a = sorted_vertices(given), *b = sorted_vertices(again), *c = sorted_vertices(other);
    input_comes_first(again);
    CHECK(count > 0 && complete_mesh_result_new_vertex_count(again) == count);
    CHECK(complete_mesh_result_new_face_count(again) == opts.initial_face_count);
    CHECK(memcmp(a, b, count * 3 * sizeof *a) == 0);
    CHECK(complete_mesh_result_new_vertex_count(other) != count ||
          memcmp(a, c, count * 3 * sizeof *a) != 0);
    free(a);
    free(b);
    free(c);
    /* a hole that it does not fill */
    opts.initial_face_count = 1;
    CHECK(complete_bumpy(&opts, &status) == NULL && status == COMPLETE_MESH_STATUS_HOLE_FAILED);
  }
  complete_mesh_result_free(given);
  complete_mesh_result_free(again);
  complete_mesh_result_free(other);
}

static void refused(const complete_mesh_options *opts, complete_mesh_status expected,
                    const char *name) {
  complete_mesh_status status;
  complete_mesh_result_free(complete_bumpy(opts, &status));
  CHECK(status == expected);
  CHECK(strstr(complete_mesh_last_error_message(), name) != NULL);
}

static void errors(void) {
  static const uint8_t none[FACES] = {0};
  const complete_mesh_status argument = COMPLETE_MESH_STATUS_INVALID_ARGUMENT;
  const complete_mesh_status option = COMPLETE_MESH_STATUS_INVALID_OPTION;
  const float point[3] = {0, 0, 0};
  const uint32_t beyond[3] = {0, 1, UINT32_MAX};
  complete_mesh_options opts = with_twin(0);
  opts.exemplar_vertices = NULL;
  refused(&opts, argument, "exemplar_vertices is NULL");
  opts = with_twin(0);
  opts.exemplar_faces = NULL;
  refused(&opts, argument, "exemplar_faces is NULL");
  opts = with_twin(0);
  opts.exemplar_vertex_count = 5;
  refused(&opts, option, "exemplar");
  opts = with_twin(0);
  opts.exemplar_only = 2;
  refused(&opts, argument, "exemplar_only");
  opts = defaults();
  opts.exemplar_only = 1;
  refused(&opts, option, "exemplar");
  opts = defaults();
  opts.unmirrored = 7;
  refused(&opts, argument, "unmirrored");
  opts = defaults();
  opts.source_faces = none;
  refused(&opts, option, "no face");
  opts = defaults();
  opts.initial_face_count = 1;
  refused(&opts, argument, "initial_faces is NULL");
  opts.initial_faces = beyond;
  refused(&opts, option, "initial");
  opts.initial_vertex_count = 1;
  refused(&opts, argument, "initial_vertices is NULL");
  opts.initial_vertices = point;
  refused(&opts, option, "initial");
}

void test_sources(void) {
  bumpy = ball;
  add_bumps(bumpy.vertices, VERTICES);
  make_whole_ball(&whole);
  add_bumps(whole.vertices, WHOLE_VERTICES);
  exemplar(0, 0);
  exemplar(0, 1);
  exemplar(1, 0);
  exemplar(1, 1);
  values(0);
  values(1);
  source_faces();
  initial();
  errors();
}
