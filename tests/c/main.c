#include "suite.h"
#include <stdlib.h>

int checks_passed, checks_failed;
struct ball ball, sieve;

int check_at(int ok, const char *what, const char *file, int line) {
  if (ok) {
    ++checks_passed;
  } else {
    ++checks_failed;
    printf("%s:%d: FAILED: %s (last error: \"%s\")\n", file, line, what,
           complete_mesh_last_error_message());
  }
  return ok;
}

complete_mesh_options defaults(void) {
  complete_mesh_options opts;
  CHECK(complete_mesh_options_init(&opts, sizeof opts) == COMPLETE_MESH_STATUS_OK);
  return opts;
}

void copy_only_from(complete_mesh_options *opts, const struct whole_ball *twin) {
  opts->exemplar_vertices = twin->vertices;
  opts->exemplar_vertex_count = WHOLE_VERTICES;
  opts->exemplar_faces = twin->faces[0];
  opts->exemplar_face_count = WHOLE_FACES;
  opts->exemplar_only = 1;
}

static complete_mesh_result *complete(const struct ball *mesh, size_t faces,
                                      const complete_mesh_options *opts,
                                      complete_mesh_status *status) {
  complete_mesh_result *result = NULL;
  const complete_mesh_status got =
      complete_mesh(mesh->vertices, VERTICES, mesh->faces[0], faces, opts, &result);
  if (status) *status = got;
  else CHECK(got == COMPLETE_MESH_STATUS_OK);
  CHECK((got == COMPLETE_MESH_STATUS_OK) == (result != NULL));
  return result;
}

complete_mesh_result *complete_ball(const complete_mesh_options *opts,
                                    complete_mesh_status *status) {
  return complete(&ball, FACES, opts, status);
}

complete_mesh_result *complete_sieve(const complete_mesh_options *opts,
                                     complete_mesh_status *status) {
  return complete(&sieve, SIEVE_FACES, opts, status);
}

complete_mesh_hole get_hole(const complete_mesh_holes *holes, size_t id) {
  complete_mesh_hole hole;
  memset(&hole, 0, sizeof hole);
  CHECK(complete_mesh_holes_get(holes, id, &hole, sizeof hole) == 1);
  return hole;
}

/* With the word "memory", only the tests that valgrind can find more in. */
int main(int argc, char **argv) {
  const int memory_only = argc > 1 && strcmp(argv[1], "memory") == 0;
  make_ball(&ball, 1);
  make_ball(&sieve, MANY);
  test_null();
  test_enums();
  test_options_size();
  test_error_elements();
  test_cancel();
  test_panic();
  test_completer();
  test_inputs();
  test_holes();
  test_selection();
  test_provenance();
  test_sources();
  test_guidance();
  test_points();
  if (!memory_only) {
    test_versions();
    test_values();
    test_threads();
  }
  printf("%d passed, %d failed\n", checks_passed, checks_failed);
  return checks_failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
