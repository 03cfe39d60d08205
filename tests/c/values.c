/* What comes out, by value: the same for every form of the same input. */
#include "suite.h"
#include <pthread.h>
#include <stdlib.h>

void test_versions(void) {
  char text[64];
  CHECK(COMPLETE_MESH_VERSION == COMPLETE_MESH_VERSION_MAJOR * 1000000 +
                                     COMPLETE_MESH_VERSION_MINOR * 1000 +
                                     COMPLETE_MESH_VERSION_PATCH);
  CHECK(complete_mesh_version() == COMPLETE_MESH_VERSION);
  CHECK(complete_mesh_abi_version() == COMPLETE_MESH_ABI_VERSION);
  snprintf(text, sizeof text, "%d.%d.%d", COMPLETE_MESH_VERSION_MAJOR, COMPLETE_MESH_VERSION_MINOR,
           COMPLETE_MESH_VERSION_PATCH);
  CHECK(strcmp(complete_mesh_version_string(), text) == 0);
  /* given by the build from Cargo.toml, which the header does not see */
  CHECK(strcmp(complete_mesh_version_string(), PACKAGE_VERSION) == 0);
}

/* Every edge has one face on each side: as many a->b as b->a, one of each. */
static int is_closed(const uint32_t *faces, size_t count) {
  size_t f, g;
  int k, l;
  for (f = 0; f < count; ++f) {
    for (k = 0; k < 3; ++k) {
      const uint32_t a = faces[3 * f + k], b = faces[3 * f + (k + 1) % 3];
      int there = 0, back = 0;
      for (g = 0; g < count; ++g) {
        for (l = 0; l < 3; ++l) {
          const uint32_t c = faces[3 * g + l], d = faces[3 * g + (l + 1) % 3];
          there += a == c && b == d;
          back += a == d && b == c;
        }
      }
      if (there != 1 || back != 1) return 0;
    }
  }
  return 1;
}

static double volume(const float (*p)[3], const uint32_t *faces, size_t count) {
  double six = 0;
  size_t f;
  for (f = 0; f < count; ++f) {
    const float *a = p[faces[3 * f]], *b = p[faces[3 * f + 1]], *c = p[faces[3 * f + 2]];
    six += (double)a[0] * ((double)b[1] * c[2] - (double)b[2] * c[1]) +
           (double)a[1] * ((double)b[2] * c[0] - (double)b[0] * c[2]) +
           (double)a[2] * ((double)b[0] * c[1] - (double)b[1] * c[0]);
  }
  return six / 6;
}

static double farthest_from_sphere(const float *p, size_t count) {
  double worst = 0;
  size_t i;
  for (i = 0; i < count; ++i) {
    const double r = sqrt((double)p[3 * i] * p[3 * i] + (double)p[3 * i + 1] * p[3 * i + 1] +
                          (double)p[3 * i + 2] * p[3 * i + 2]);
    if (!(fabs(r - 1) <= worst)) worst = fabs(r - 1);
  }
  return worst;
}

void test_values(void) {
  const double chord = 1 - cos(PI / AROUND);
  complete_mesh_result *result = complete_ball(NULL, NULL);
  const float *vertices = (const float *)complete_mesh_result_vertices(result);
  const float *fresh = (const float *)complete_mesh_result_new_vertices(result);
  const uint32_t *faces = complete_mesh_result_faces(result);
  const size_t nv = complete_mesh_result_vertex_count(result);
  const size_t nf = complete_mesh_result_face_count(result);
  const size_t fresh_count = complete_mesh_result_new_vertex_count(result);
  if (!CHECK(vertices != NULL && faces != NULL && fresh != NULL)) return;
  CHECK(complete_mesh_result_vertex_type(result) == COMPLETE_MESH_VERTEX_TYPE_F32);
  CHECK(complete_mesh_result_input_vertex_count(result) == VERTICES);
  CHECK(complete_mesh_result_input_face_count(result) == FACES);
  CHECK(complete_mesh_result_filled_count(result) == 2);
  CHECK(nv == VERTICES + fresh_count && fresh == vertices + 3 * VERTICES);
  CHECK(nf == FACES + complete_mesh_result_new_face_count(result));
  CHECK(complete_mesh_result_new_faces(result) == faces + 3 * FACES);
  CHECK(memcmp(vertices, ball.vertices, sizeof ball.vertices) == 0);
  CHECK(memcmp(faces, ball.faces, sizeof ball.faces) == 0);
  CHECK(is_closed(faces, nf));
  /* A smooth fill of these holes stays within twice the chord error of the input's own edges, 0.01;
   * a flat cap misses the sphere by 0.13. */
  CHECK(farthest_from_sphere(fresh, fresh_count) < 2 * chord);
  /* The polyhedron of the whole ball has 1.6 % less than the sphere; a cap turned inside out takes
   * away 13 %, a missing one half of that. */
  CHECK(fabs(volume((const float(*)[3])(const void *)vertices, faces, nf) / (4 * PI / 3) - 1) <
        6 * chord);
  CHECK(complete_mesh_result_seconds(result) > 0);
  CHECK(complete_mesh_result_cpu_seconds(result) >= 0);
  complete_mesh_result_free(result);
}

/* Two results of the same mesh and number type, to the bit. */
static int same_fill(const complete_mesh_result *a, const complete_mesh_result *b, size_t size) {
  const size_t nv = complete_mesh_result_new_vertex_count(a);
  const size_t nf = complete_mesh_result_new_face_count(a);
  return a != NULL && b != NULL && nv > 0 && nf > 0 &&
         nv == complete_mesh_result_new_vertex_count(b) &&
         nf == complete_mesh_result_new_face_count(b) &&
         memcmp(complete_mesh_result_new_vertices(a), complete_mesh_result_new_vertices(b),
                nv * 3 * size) == 0 &&
         memcmp(complete_mesh_result_new_faces(a), complete_mesh_result_new_faces(b),
                nf * 3 * sizeof(uint32_t)) == 0 &&
         memcmp(complete_mesh_result_new_vertex_holes(a), complete_mesh_result_new_vertex_holes(b),
                nv * sizeof(uint32_t)) == 0 &&
         memcmp(complete_mesh_result_new_face_holes(a), complete_mesh_result_new_face_holes(b),
                nf * sizeof(uint32_t)) == 0 &&
         memcmp(complete_mesh_result_new_vertex_source_faces(a),
                complete_mesh_result_new_vertex_source_faces(b), nv * sizeof(uint32_t)) == 0 &&
         memcmp(complete_mesh_result_new_vertex_barycentrics(a),
                complete_mesh_result_new_vertex_barycentrics(b), nv * 3 * sizeof(double)) == 0 &&
         memcmp(complete_mesh_result_new_vertex_sources(a),
                complete_mesh_result_new_vertex_sources(b), nv * sizeof(uint32_t)) == 0 &&
         memcmp(complete_mesh_result_new_vertex_confidences(a),
                complete_mesh_result_new_vertex_confidences(b), nv * sizeof(double)) == 0;
}

/* The ball between other data, on odd addresses; `size` bytes a number. */
static complete_mesh_result *complete_interleaved(uint32_t method, size_t size, size_t gap,
                                                  size_t offset) {
  const size_t vertex_stride = 3 * size + gap, face_stride = 12 + gap;
  unsigned char *v = (unsigned char *)malloc(VERTICES * vertex_stride + offset);
  unsigned char *f = (unsigned char *)malloc(FACES * face_stride + offset);
  complete_mesh_options opts = defaults();
  complete_mesh_result *result = NULL;
  int i, k;
  if (!v || !f) abort();
  memset(v, 0xEE, VERTICES * vertex_stride + offset);
  memset(f, 0xEE, FACES * face_stride + offset);
  for (i = 0; i < VERTICES; ++i) {
    for (k = 0; k < 3; ++k) {
      const float single = ball.vertices[i][k];
      const double wide = single;
      memcpy(v + offset + i * vertex_stride + k * size,
             size == sizeof single ? (const void *)&single : (const void *)&wide, size);
    }
  }
  for (i = 0; i < FACES; ++i) memcpy(f + offset + i * face_stride, ball.faces[i], 12);
  opts.method = method;
  opts.vertex_type =
      size == sizeof(float) ? COMPLETE_MESH_VERTEX_TYPE_F32 : COMPLETE_MESH_VERTEX_TYPE_F64;
  opts.vertex_stride = gap ? vertex_stride : 0;
  opts.face_stride = gap ? face_stride : 0;
  /* The pointer's type asks for an alignment that the library does not need. */
  CHECK(complete_mesh(v + offset, VERTICES, (const uint32_t *)(const void *)(f + offset), FACES,
                      &opts, &result) == COMPLETE_MESH_STATUS_OK);
  free(v);
  free(f);
  return result;
}

/* float against double: the fill is the same up to the rounding of the new vertices to float. */
static void compare_types(const complete_mesh_result *single, const complete_mesh_result *wide) {
  const size_t nv = complete_mesh_result_vertex_count(single);
  const float *s = (const float *)complete_mesh_result_vertices(single);
  const double *d = (const double *)complete_mesh_result_vertices(wide);
  size_t i, wrong = 0, unlike = 0;
  CHECK(complete_mesh_result_vertex_type(wide) == COMPLETE_MESH_VERTEX_TYPE_F64);
  if (!CHECK(s && d && nv == complete_mesh_result_vertex_count(wide))) return;
  CHECK(complete_mesh_result_face_count(single) == complete_mesh_result_face_count(wide));
  CHECK(memcmp(complete_mesh_result_faces(single), complete_mesh_result_faces(wide),
               complete_mesh_result_face_count(single) * 12) == 0);
  for (i = 0; i < 3 * nv; ++i) {
    unlike += i < 3 * VERTICES && (double)s[i] != d[i];
    wrong += !(fabs((double)s[i] - d[i]) <= 1e-6);
  }
  CHECK(unlike == 0);
  CHECK(wrong == 0);
}

void test_inputs(void) {
  const uint32_t coherent = COMPLETE_MESH_METHOD_COHERENT, smooth = COMPLETE_MESH_METHOD_SMOOTH;
  complete_mesh_options opts = defaults();
  complete_mesh_result *packed = complete_ball(NULL, NULL);
  complete_mesh_result *gaps = complete_interleaved(coherent, sizeof(float), 20, 0);
  complete_mesh_result *odd = complete_interleaved(coherent, sizeof(float), 1, 3);
  complete_mesh_result *wide = complete_interleaved(coherent, sizeof(double), 0, 0);
  complete_mesh_result *wide_odd = complete_interleaved(coherent, sizeof(double), 5, 1);
  complete_mesh_result *packed_smooth = complete_interleaved(smooth, sizeof(float), 0, 0);
  complete_mesh_result *wide_smooth = complete_interleaved(smooth, sizeof(double), 5, 1);
  complete_mesh_result *fresh;
  CHECK(same_fill(packed, gaps, sizeof(float)));
  CHECK(same_fill(packed, odd, sizeof(float)));
  CHECK(same_fill(wide, wide_odd, sizeof(double)));
  CHECK(memcmp(complete_mesh_result_vertices(odd), ball.vertices, sizeof ball.vertices) == 0);
  CHECK(memcmp(complete_mesh_result_faces(odd), ball.faces, sizeof ball.faces) == 0);
  /* All parts of a ball are alike: which of them a coherent fill comes from is decided by the last
   * bits, so that only the smooth one is the same in both types. */
  compare_types(packed_smooth, wide_smooth);
  opts.output = COMPLETE_MESH_OUTPUT_NEW_ONLY;
  fresh = complete_ball(&opts, NULL);
  CHECK(same_fill(packed, fresh, sizeof(float)));
  CHECK(complete_mesh_result_vertices(fresh) == NULL && complete_mesh_result_faces(fresh) == NULL);
  CHECK(complete_mesh_result_vertex_count(fresh) == 0);
  CHECK(complete_mesh_result_face_count(fresh) == 0);
  CHECK(complete_mesh_result_input_vertex_count(fresh) == VERTICES);
  complete_mesh_result_free(packed);
  complete_mesh_result_free(packed_smooth);
  complete_mesh_result_free(wide_smooth);
  complete_mesh_result_free(gaps);
  complete_mesh_result_free(odd);
  complete_mesh_result_free(wide);
  complete_mesh_result_free(wide_odd);
  complete_mesh_result_free(fresh);
}

struct job {
  uint32_t threads;
  complete_mesh_result *result;
  char message[200];
};

static void *run_job(void *user) {
  struct job *job = (struct job *)user;
  complete_mesh_options opts;
  complete_mesh_options_init(&opts, sizeof opts);
  opts.threads = job->threads;
  /* one failure and one success each: the messages must not mix */
  complete_mesh(NULL, 100 + job->threads, ball.faces[0], FACES, NULL, &job->result);
  snprintf(job->message, sizeof job->message, "%s", complete_mesh_last_error_message());
  complete_mesh(sieve.vertices, VERTICES, sieve.faces[0], SIEVE_FACES, &opts, &job->result);
  return NULL;
}

/* Four calls at once, with 0 to 3 threads each: all give the bytes of a lone one of one thread. */
void test_threads(void) {
  complete_mesh_options opts = defaults();
  complete_mesh_result *alone;
  pthread_t threads[4];
  struct job jobs[4];
  char number[16];
  int i;
  opts.threads = 1;
  alone = complete_sieve(&opts, NULL);
  CHECK(complete_mesh_result_filled_count(alone) == MANY + 1);
  for (i = 0; i < 4; ++i) {
    memset(&jobs[i], 0, sizeof jobs[i]);
    jobs[i].threads = (uint32_t)i;
    CHECK(pthread_create(&threads[i], NULL, run_job, &jobs[i]) == 0);
  }
  for (i = 0; i < 4; ++i) {
    pthread_join(threads[i], NULL);
    snprintf(number, sizeof number, "%d", 100 + i);
    CHECK(strstr(jobs[i].message, number) != NULL);
    CHECK(same_fill(alone, jobs[i].result, sizeof(float)));
    complete_mesh_result_free(jobs[i].result);
  }
  complete_mesh_result_free(alone);
}
