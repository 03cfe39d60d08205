/* Where new vertices come from, by value. */
#include "suite.h"

static complete_mesh_source get_source(const complete_mesh_holes *holes, size_t hole, size_t i) {
  complete_mesh_source source;
  memset(&source, 0xAB, sizeof source);
  CHECK(complete_mesh_holes_source(holes, hole, i, &source, sizeof source) == 1);
  return source;
}

/* Rows of a rotation, or of a rotation and a reflection as `mirrored` says, and a stretch of at most
   15 %. */
static int is_nearly_rigid(const complete_mesh_source *source) {
  const double *m = source->transform;
  double determinant = 0;
  int i, j, k;
  for (i = 0; i < 3; ++i) {
    for (j = 0; j < 3; ++j) {
      double dot = 0;
      for (k = 0; k < 3; ++k) dot += m[4 * i + k] * m[4 * j + k];
      if (!(fabs(dot - (i == j)) < 0.4)) return 0;
    }
    determinant += m[i] * (m[4 + (i + 1) % 3] * m[8 + (i + 2) % 3] -
                           m[4 + (i + 2) % 3] * m[8 + (i + 1) % 3]);
  }
  return (source->mirrored ? -determinant : determinant) > 0.6;
}

/* How far the copied point lies from the new vertex. */
static double replayed(const complete_mesh_source *source, uint32_t face, const double *weights,
                       const float *vertex) {
  double p[3] = {0, 0, 0}, square = 0;
  int i, k;
  for (i = 0; i < 3; ++i)
    for (k = 0; k < 3; ++k) p[k] += weights[i] * ball.vertices[ball.faces[face][i]][k];
  for (i = 0; i < 3; ++i) {
    const double *row = source->transform + 4 * i;
    const double there = row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3];
    square += (there - vertex[i]) * (there - vertex[i]);
  }
  return sqrt(square);
}

/* Without values where they would come from is where the shape does. */
static void check_colours(const complete_mesh_result *result) {
  const size_t n = complete_mesh_result_new_vertex_count(result);
  const uint32_t *faces = complete_mesh_result_new_vertex_colour_faces(result);
  const uint32_t *sources = complete_mesh_result_new_vertex_colour_sources(result);
  const double *weights = complete_mesh_result_new_vertex_colour_barycentrics(result);
  const double *confidences = complete_mesh_result_new_vertex_colour_confidences(result);
  CHECK(complete_mesh_result_new_vertex_colour_faces(NULL) == NULL);
  CHECK(complete_mesh_result_new_vertex_colour_sources(NULL) == NULL);
  CHECK(complete_mesh_result_new_vertex_colour_barycentrics(NULL) == NULL);
  CHECK(complete_mesh_result_new_vertex_colour_confidences(NULL) == NULL);
  if (!CHECK(faces && sources && weights && confidences)) return;
  CHECK(memcmp(faces, complete_mesh_result_new_vertex_source_faces(result), n * sizeof *faces) == 0);
  CHECK(memcmp(sources, complete_mesh_result_new_vertex_sources(result), n * sizeof *sources) == 0);
  CHECK(memcmp(weights, complete_mesh_result_new_vertex_barycentrics(result), 3 * n * sizeof *weights) == 0);
  CHECK(memcmp(confidences, complete_mesh_result_new_vertex_confidences(result), n * sizeof *confidences) == 0);
}

static void check_vertices(const complete_mesh_result *result, const complete_mesh_hole *hole) {
  const complete_mesh_holes *holes = complete_mesh_result_holes(result);
  const uint32_t *faces = complete_mesh_result_new_vertex_source_faces(result);
  const double *weights = complete_mesh_result_new_vertex_barycentrics(result);
  const uint32_t *sources = complete_mesh_result_new_vertex_sources(result);
  const double *confidences = complete_mesh_result_new_vertex_confidences(result);
  const float *vertices = (const float *)complete_mesh_result_new_vertices(result);
  size_t i, wrong = 0, far_off = 0, copied = 0;
  if (!CHECK(faces && weights && sources && confidences && vertices)) return;
  for (i = hole->first_new_vertex; i < hole->first_new_vertex + hole->new_vertex_count; ++i) {
    const double *w = weights + 3 * i;
    wrong += !(confidences[i] >= 0 && confidences[i] <= 1);
    if (sources[i] == UINT32_MAX) {
      wrong += faces[i] != UINT32_MAX || w[0] != 0 || w[1] != 0 || w[2] != 0 || confidences[i] != 0;
      continue;
    }
    ++copied;
    if (sources[i] >= hole->source_count ||
        faces[i] >= complete_mesh_result_input_face_count(result)) {
      ++wrong;
      continue;
    }
    wrong += !(fabs(w[0] + w[1] + w[2] - 1) < 1e-9 && w[0] > -1e-6 && w[1] > -1e-6 && w[2] > -1e-6);
    {
      const complete_mesh_source source = get_source(holes, hole->id, sources[i]);
      /* a tenth of the hole: the source is joined to the rim by a smooth deformation */
      far_off += !(replayed(&source, faces[i], w, vertices + 3 * i) < 0.1 * hole->diameter);
    }
  }
  CHECK(wrong == 0);
  CHECK(far_off == 0);
  CHECK((copied > 0) == (hole->source_count > 0));
}

static void check_hole(const complete_mesh_result *result, size_t id) {
  const complete_mesh_holes *holes = complete_mesh_result_holes(result);
  const complete_mesh_hole hole = get_hole(holes, id);
  double weights = 0, last = 2;
  size_t i, used = 0;
  CHECK(hole.method == (hole.source_count ? (uint32_t)COMPLETE_MESH_METHOD_COHERENT
                                          : (uint32_t)COMPLETE_MESH_METHOD_SMOOTH));
  CHECK(hole.source_count ? hole.confidence > 0 && hole.confidence <= 1 : hole.confidence == 0);
  CHECK(isnan(hole.coherence_error_before) || hole.coherence_error_before >= 0);
  CHECK(isnan(hole.coherence_error_before) == isnan(hole.coherence_error_after));
  for (i = 0; i < hole.source_count; ++i) {
    const complete_mesh_source source = get_source(holes, id, i);
    CHECK(source.struct_size == sizeof source && source.mirrored <= 1);
    CHECK(is_nearly_rigid(&source));
    CHECK(source.error >= 0 && source.weight >= 0 && source.weight <= last);
    last = source.weight;
    weights += source.weight;
    used += source.vertex_count;
    CHECK(source.coloured_count == 0);
  }
  CHECK(hole.source_count ? fabs(weights - 1) < 1e-9 : weights == 0);
  CHECK(used <= hole.new_vertex_count);
  check_vertices(result, &hole);
}

/* Nothing is written beyond the size that the caller knows, or of a source that does not exist. */
static void source_sizes(const complete_mesh_holes *holes) {
  complete_mesh_source source;
  memset(&source, 0xAB, sizeof source);
  CHECK(complete_mesh_holes_source(NULL, 0, 0, &source, sizeof source) == 0);
  CHECK(complete_mesh_holes_source(holes, 99, 0, &source, sizeof source) == 0);
  CHECK(complete_mesh_holes_source(holes, 0, 9999, &source, sizeof source) == 0);
  CHECK(source.struct_size == 0xABABABABu);
  if (get_hole(holes, 0).source_count == 0) return;
  CHECK(complete_mesh_holes_source(holes, 0, 0, NULL, sizeof source) == 0);
  CHECK(complete_mesh_holes_source(holes, 0, 0, &source, 7) == 0);
  CHECK(source.struct_size == 0xABABABABu);
  CHECK(complete_mesh_holes_source(holes, 0, 0, &source, 8) == 1);
  CHECK(source.struct_size == 8 && source.mirrored <= 1);
  CHECK(((const unsigned char *)&source)[8] == 0xAB);
}

static void smooth_has_none(void) {
  complete_mesh_options opts = defaults();
  complete_mesh_result *result;
  const uint32_t *faces, *sources;
  const double *confidences;
  complete_mesh_hole hole;
  size_t i, wrong = 0;
  opts.method = COMPLETE_MESH_METHOD_SMOOTH;
  result = complete_ball(&opts, NULL);
  hole = get_hole(complete_mesh_result_holes(result), 0);
  CHECK(hole.method == COMPLETE_MESH_METHOD_SMOOTH && hole.source_count == 0);
  CHECK(hole.confidence == 0 && isnan(hole.coherence_error_before));
  faces = complete_mesh_result_new_vertex_source_faces(result);
  sources = complete_mesh_result_new_vertex_sources(result);
  confidences = complete_mesh_result_new_vertex_confidences(result);
  if (CHECK(faces && sources && confidences)) {
    for (i = 0; i < complete_mesh_result_new_vertex_count(result); ++i)
      wrong += faces[i] != UINT32_MAX || sources[i] != UINT32_MAX || confidences[i] != 0;
    CHECK(wrong == 0);
  }
  complete_mesh_result_free(result);
}

void test_provenance(void) {
  complete_mesh_result *result = complete_ball(NULL, NULL);
  complete_mesh_holes *listed = NULL;
  complete_mesh_hole open;
  CHECK(defaults().method == COMPLETE_MESH_METHOD_COHERENT);
  check_hole(result, 0);
  check_hole(result, 1);
  check_colours(result);
#ifndef SMALL_BALL
  /* one part of a sphere looks like another */
  CHECK(get_hole(complete_mesh_result_holes(result), 0).source_count > 0);
#endif
  source_sizes(complete_mesh_result_holes(result));
  complete_mesh_result_free(result);
  CHECK(complete_mesh_find_holes(ball.vertices, VERTICES, ball.faces[0], FACES, NULL, &listed) ==
        COMPLETE_MESH_STATUS_OK);
  open = get_hole(listed, 0);
  CHECK(open.source_count == 0 && open.confidence == 0 && isnan(open.coherence_error_after));
  complete_mesh_holes_free(listed);
  smooth_has_none();
}
