/* Cancel at every call of the progress function, and a panic at every one. */
#include "suite.h"
#include <pthread.h>

struct progress {
  int calls, cancel_at, wrong_thread, went_back, no_stage;
  double last;
  pthread_t thread;
};

static int on_progress(void *user, double fraction, const char *stage) {
  struct progress *p = (struct progress *)user;
  ++p->calls;
  if (!(fraction >= p->last) || fraction > 1) p->went_back = 1;
  p->last = fraction;
  if (!stage || !stage[0]) p->no_stage = 1;
  if (!pthread_equal(p->thread, pthread_self())) p->wrong_thread = 1;
  return p->calls == p->cancel_at;
}

static void watch(complete_mesh_options *opts, struct progress *p, int cancel_at) {
  memset(p, 0, sizeof *p);
  p->cancel_at = cancel_at;
  p->thread = pthread_self();
  opts->progress = on_progress;
  opts->progress_user = p;
}

static int behaved(const struct progress *p) {
  return !p->wrong_thread && !p->went_back && !p->no_stage;
}

/* How fills are made that are made again and again: under valgrind a coherent one takes seconds, and
 * cancel_complete has those. */
static uint32_t repeated_method(void) {
#ifdef SMALL_BALL
  return COMPLETE_MESH_METHOD_SMOOTH;
#else
  return COMPLETE_MESH_METHOD_COHERENT;
#endif
}

/* From one call to the next at which a coherent fill is cancelled; there again a few must do. */
static int stride(int total) {
#ifdef SMALL_BALL
  return 1 + total / 8;
#else
  return total > 0;
#endif
}

static void cancel_complete(void) {
  complete_mesh_options opts = defaults();
  complete_mesh_status status;
  struct progress p;
  int at, total;
  opts.threads = 1;
  watch(&opts, &p, 0);
  complete_mesh_result_free(complete_ball(&opts, NULL));
  total = p.calls;
  CHECK(behaved(&p) && total >= 4);
  for (at = 1; at <= total; at += stride(total)) {
    complete_mesh_result *result;
    watch(&opts, &p, at);
    result = complete_ball(&opts, &status);
    CHECK(status == COMPLETE_MESH_STATUS_CANCELLED && result == NULL);
    /* not called again once it has said stop */
    CHECK(p.calls == at && behaved(&p));
    complete_mesh_result_free(result);
  }
  /* the thread is as good as new */
  watch(&opts, &p, total + 1);
  complete_mesh_result_free(complete_ball(&opts, &status));
  CHECK(status == COMPLETE_MESH_STATUS_OK && p.calls == total);
}

/* Several threads: how often the caller is asked depends on their speed. */
static void cancel_threads(void) {
  complete_mesh_options opts = defaults();
  complete_mesh_status status = COMPLETE_MESH_STATUS_CANCELLED;
  struct progress p;
  int at;
  opts.threads = 2;
  opts.method = repeated_method();
  for (at = 1; status == COMPLETE_MESH_STATUS_CANCELLED && at < 1000; ++at) {
    complete_mesh_result *result;
    watch(&opts, &p, at);
    result = complete_sieve(&opts, &status);
    CHECK(behaved(&p) && (status == COMPLETE_MESH_STATUS_CANCELLED) == (p.calls == at));
    complete_mesh_result_free(result);
  }
  CHECK(status == COMPLETE_MESH_STATUS_OK && at > 4);
}

/* Looking for holes may report only once or twice: cancel until it gets through. */
static void cancel_find_holes(void) {
  complete_mesh_options opts = defaults();
  complete_mesh_status status = COMPLETE_MESH_STATUS_CANCELLED;
  complete_mesh_holes *holes = NULL;
  struct progress p;
  int at;
  for (at = 1; status == COMPLETE_MESH_STATUS_CANCELLED && at < 1000; ++at) {
    watch(&opts, &p, at);
    status = complete_mesh_find_holes(ball.vertices, VERTICES, ball.faces[0], FACES, &opts, &holes);
    CHECK((status == COMPLETE_MESH_STATUS_OK) == (holes != NULL) && behaved(&p));
  }
  CHECK(status == COMPLETE_MESH_STATUS_OK && at > 2);
  complete_mesh_holes_free(holes);
}

static void cancel_completer(void) {
  complete_mesh_options opts = defaults();
  complete_mesh_status status = COMPLETE_MESH_STATUS_CANCELLED;
  complete_mesh_completer *completer = NULL;
  complete_mesh_result *result = NULL;
  struct progress p;
  int at;
  for (at = 1; status == COMPLETE_MESH_STATUS_CANCELLED && at < 1000; ++at) {
    watch(&opts, &p, at);
    status = complete_mesh_completer_new(ball.vertices, VERTICES, ball.faces[0], FACES, &opts,
                                         &completer);
    CHECK((status == COMPLETE_MESH_STATUS_OK) == (completer != NULL) && behaved(&p));
  }
  CHECK(status == COMPLETE_MESH_STATUS_OK && at > 2);
  /* a cancelled fill leaves the completer as good as it was */
  opts.method = repeated_method();
  for (at = 1, status = COMPLETE_MESH_STATUS_CANCELLED;
       status == COMPLETE_MESH_STATUS_CANCELLED && at < 1000; ++at) {
    watch(&opts, &p, at);
    status = complete_mesh_completer_complete(completer, &opts, &result);
    CHECK((status == COMPLETE_MESH_STATUS_OK) == (result != NULL) && behaved(&p));
  }
  CHECK(status == COMPLETE_MESH_STATUS_OK && at > 2);
  CHECK(complete_mesh_result_filled_count(result) == 2);
  complete_mesh_result_free(result);
  complete_mesh_completer_free(completer);
}

void test_cancel(void) {
  cancel_complete();
  cancel_threads();
  cancel_find_holes();
  cancel_completer();
}

#ifdef COMPLETE_MESH_TEST_PANIC
#ifdef __cplusplus
extern "C"
#endif
void complete_mesh_test_panic_at(uint32_t nth);

/* A fault of the library at every place that reports progress: a status, no result, no leak, and
 * the next call is as good as ever. */
void test_panic(void) {
  complete_mesh_options opts = defaults();
  complete_mesh_status status;
  complete_mesh_result *before = complete_ball(NULL, NULL), *after;
  complete_mesh_holes *holes = NULL;
  struct progress p;
  int at, total;
  /* one thread: with more, how often the caller is asked depends on their speed */
  opts.threads = 1;
  watch(&opts, &p, 0);
  complete_mesh_result_free(complete_ball(&opts, NULL));
  total = p.calls;
  opts.progress = NULL;
  for (at = 1; at <= total; at += stride(total)) {
    complete_mesh_test_panic_at((uint32_t)at);
    after = complete_ball(&opts, &status);
    CHECK(status == COMPLETE_MESH_STATUS_INTERNAL && after == NULL);
    CHECK(strstr(complete_mesh_last_error_message(), "panic on demand") != NULL);
  }
  /* beside workers that go on for a moment */
  opts = defaults();
  opts.threads = 2;
  opts.method = repeated_method();
  for (at = 1, status = COMPLETE_MESH_STATUS_INTERNAL;
       status == COMPLETE_MESH_STATUS_INTERNAL && at < 1000; ++at) {
    complete_mesh_test_panic_at((uint32_t)at);
    complete_mesh_result_free(complete_sieve(&opts, &status));
  }
  CHECK(status == COMPLETE_MESH_STATUS_OK && at > 4);
  complete_mesh_test_panic_at(1);
  CHECK(complete_mesh_find_holes(ball.vertices, VERTICES, ball.faces[0], FACES, NULL, &holes) ==
        COMPLETE_MESH_STATUS_INTERNAL);
  CHECK(holes == NULL);
  complete_mesh_test_panic_at(0);
  after = complete_ball(NULL, NULL);
  CHECK(complete_mesh_result_vertex_count(after) == complete_mesh_result_vertex_count(before));
  CHECK(memcmp(complete_mesh_result_vertices(after), complete_mesh_result_vertices(before),
               complete_mesh_result_vertex_count(before) * sizeof(float[3])) == 0);
  complete_mesh_result_free(before);
  complete_mesh_result_free(after);
}
#else
void test_panic(void) {}
#endif
