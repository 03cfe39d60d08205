/* A unit sphere with holes: the cap at the north pole, whose measures are known in closed form, and
 * one or more patches along the equator. The sphere itself says where new vertices have to be. */
#ifndef BALL_H
#define BALL_H

#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#define PI 3.14159265358979323846

/* For the memory check, which runs some fifty times slower. */
#ifdef SMALL_BALL
enum { AROUND = 12, STACKS = 8, CAP = 2, PATCH_ROW = 3, PATCH_SIZE = 2, MANY = 4 };
enum { FINE = 0 }; /* whether it is fine enough to hold bumps */
#else
enum { AROUND = 32, STACKS = 24, CAP = 4, PATCH_ROW = 11, PATCH_SIZE = 3, MANY = 8 };
enum { FINE = 1 };
#endif
enum {
  RINGS = STACKS - CAP, /* rings at CAP, CAP + 1, ..., STACKS - 1 of STACKS */
  VERTICES = RINGS * AROUND + 1,
  PATCH_FACES = 2 * PATCH_SIZE * PATCH_SIZE,
  /* with one patch, and with many: enough holes for several threads to share */
  FACES = 2 * (RINGS - 1) * AROUND + AROUND - PATCH_FACES,
  SIEVE_FACES = FACES - (MANY - 1) * PATCH_FACES,
  CAP_EDGES = AROUND,
  PATCH_EDGES = 4 * PATCH_SIZE,
  WHOLE_VERTICES = (STACKS - 1) * AROUND + 2,
  WHOLE_FACES = 2 * (STACKS - 1) * AROUND
};

struct ball {
  float vertices[VERTICES][3];
  uint32_t faces[FACES][3];
};

/* Angle from the north pole of a ring of vertices, in radians. */
double ball_angle(int ring);

/* Length of one edge of the cap's rim, of its polygon and not of the circle. */
double cap_edge(void);

/* With 1 patch or MANY. The vertices inside a patch stay in the array, named by no face: they must
 * come back, too. */
void make_ball(struct ball *ball, int patches);

/* The same without holes. */
struct whole_ball {
  float vertices[WHOLE_VERTICES][3];
  uint32_t faces[WHOLE_FACES][3];
};
void make_whole_ball(struct whole_ball *ball);

/* Gives a sphere bumps, no two of them alike: moves each vertex along its ray from the centre. */
void add_bumps(float (*vertices)[3], int count);

/* How far points are from the faces of a whole ball, along their rays from its centre: the root of
 * the mean square. The faces and not the bumps, for the mesh shows those only that well. */
double off_whole(const struct whole_ball *whole, const float *points, size_t count);

/* Turns and moves a whole ball, and mirrors it first if asked to. */
void move_away(struct whole_ball *ball, int mirrored);

#endif
