#include "ball.h"

double ball_angle(int ring) { return PI * (CAP + ring) / STACKS; }

static void ball_face(uint32_t (*faces)[3], int *n, int a, int b, int c) {
  faces[*n][0] = (uint32_t)a;
  faces[*n][1] = (uint32_t)b;
  faces[*n][2] = (uint32_t)c;
  ++*n;
}

static void ball_vertex(float *p, double down, int i) {
  p[0] = (float)(sin(down) * cos(2 * PI * i / AROUND));
  p[1] = (float)(sin(down) * sin(2 * PI * i / AROUND));
  p[2] = (float)cos(down);
}

void make_ball(struct ball *ball, int patches) {
  int n = 0, ring, i;
  const int south = VERTICES - 1;
  for (ring = 0; ring < RINGS; ++ring)
    for (i = 0; i < AROUND; ++i) ball_vertex(ball->vertices[ring * AROUND + i], ball_angle(ring), i);
  ball->vertices[south][0] = ball->vertices[south][1] = 0;
  ball->vertices[south][2] = -1;
  for (ring = 0; ring + 1 < RINGS; ++ring) {
    for (i = 0; i < AROUND; ++i) {
      const int a = ring * AROUND + i, b = ring * AROUND + (i + 1) % AROUND;
      const int row = ring + CAP - PATCH_ROW;
      if (row >= 0 && row < PATCH_SIZE && i % (AROUND / patches) < PATCH_SIZE) continue;
      ball_face(ball->faces, &n, a, a + AROUND, b);
      ball_face(ball->faces, &n, b, a + AROUND, b + AROUND);
    }
  }
  for (i = 0; i < AROUND; ++i)
    ball_face(ball->faces, &n, (RINGS - 1) * AROUND + i, south, (RINGS - 1) * AROUND + (i + 1) % AROUND);
}

double cap_edge(void) { return 2 * sin(PI / AROUND) * sin(ball_angle(0)); }

void make_whole_ball(struct whole_ball *ball) {
  int n = 0, ring, i;
  const int north = WHOLE_VERTICES - 2, south = WHOLE_VERTICES - 1, last = (STACKS - 2) * AROUND;
  for (ring = 0; ring + 1 < STACKS; ++ring)
    for (i = 0; i < AROUND; ++i)
      ball_vertex(ball->vertices[ring * AROUND + i], PI * (ring + 1) / STACKS, i);
  ball_vertex(ball->vertices[north], 0, 0);
  ball_vertex(ball->vertices[south], PI, 0);
  for (i = 0; i < AROUND; ++i) {
    const int next = (i + 1) % AROUND;
    ball_face(ball->faces, &n, i, next, north);
    for (ring = 0; ring + 2 < STACKS; ++ring) {
      const int a = ring * AROUND + i, b = ring * AROUND + next;
      ball_face(ball->faces, &n, a, a + AROUND, b);
      ball_face(ball->faces, &n, b, a + AROUND, b + AROUND);
    }
    ball_face(ball->faces, &n, last + i, south, last + next);
  }
}

static double bumpy_radius(double x, double y, double z) {
  return 1 + 0.06 * sin(4 * x + 1) + 0.06 * sin(5 * y + 2 * z) + 0.05 * cos(6 * z + 3 * x * y);
}

void add_bumps(float (*vertices)[3], int count) {
  int i, k;
  for (i = 0; i < count; ++i) {
    const double radius = bumpy_radius(vertices[i][0], vertices[i][1], vertices[i][2]);
    for (k = 0; k < 3; ++k) vertices[i][k] = (float)(vertices[i][k] * radius);
  }
}

double off_bumps(double x, double y, double z) {
  const double length = sqrt(x * x + y * y + z * z);
  return fabs(length - bumpy_radius(x / length, y / length, z / length));
}

void move_away(struct whole_ball *ball, int mirrored) {
  /* a turn by 0.6 about z, then by 2.1 about x */
  const double c = cos(0.6), s = sin(0.6), d = cos(2.1), t = sin(2.1);
  int i;
  for (i = 0; i < WHOLE_VERTICES; ++i) {
    float *p = ball->vertices[i];
    const double x = mirrored ? -p[0] : p[0], y = p[1], z = p[2];
    const double u = s * x + c * y;
    p[0] = (float)(c * x - s * y + 3);
    p[1] = (float)(d * u - t * z - 7);
    p[2] = (float)(t * u + d * z + 0.5);
  }
  for (i = 0; mirrored && i < WHOLE_FACES; ++i) {
    const uint32_t first = ball->faces[i][0];
    ball->faces[i][0] = ball->faces[i][1];
    ball->faces[i][1] = first;
  }
}
