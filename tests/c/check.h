/* Counts checks over all files of a test program. */
#ifndef CHECK_H
#define CHECK_H

#include <complete_mesh.h>
#include <stdio.h>

extern int checks_passed, checks_failed;

/* A failed check is reported and the program goes on: the count tells how much is broken. */
int check_at(int ok, const char *what, const char *file, int line);

#define CHECK(condition) check_at((condition) ? 1 : 0, #condition, __FILE__, __LINE__)

#endif
