/* The parts of the suite; each file is compiled as C99 and as C++17. */
#ifndef SUITE_H
#define SUITE_H

#include "ball.h"
#include "check.h"

void test_versions(void);
void test_values(void);
void test_inputs(void);
void test_holes(void);
void test_selection(void);
void test_completer(void);
void test_null(void);
void test_enums(void);
void test_options_size(void);
void test_error_elements(void);
void test_cancel(void);
void test_threads(void);
void test_panic(void);
void test_provenance(void);
void test_sources(void);
void test_guidance(void);
void test_points(void);

/* Made once by main: with two holes, and with MANY + 1. */
extern struct ball ball, sieve;

/* Options at their defaults. */
complete_mesh_options defaults(void);

/* complete_mesh of the ball, and of the sieve; NULL on failure, with the status in *status unless that is NULL. */
complete_mesh_result *complete_ball(const complete_mesh_options *opts,
                                    complete_mesh_status *status);

complete_mesh_result *complete_sieve(const complete_mesh_options *opts,
                                     complete_mesh_status *status);

/* Makes a whole ball the exemplar, and nothing else to be copied from. */
void copy_only_from(complete_mesh_options *opts, const struct whole_ball *twin);

/* A hole of a list; all zero if there is none. */
complete_mesh_hole get_hole(const complete_mesh_holes *holes, size_t id);

#endif
