#include "ball.h"

double ball_angle(int ring) { return PI * (CAP + ring) / STACKS; }

static void ball_face(struct ball *ball, int *n, int a, int b, int c) {
  ball->faces[*n][0] = (uint32_t)a;
  ball->faces[*n][1] = (uint32_t)b;
  ball->faces[*n][2] = (uint32_t)c;
  ++*n;
}

void make_ball(struct ball *ball, int patches) {
  int n = 0, ring, i;
  const int south = VERTICES - 1;
  for (ring = 0; ring < RINGS; ++ring) {
    for (i = 0; i < AROUND; ++i) {
      float *p = ball->vertices[ring * AROUND + i];
      p[0] = (float)(sin(ball_angle(ring)) * cos(2 * PI * i / AROUND));
      p[1] = (float)(sin(ball_angle(ring)) * sin(2 * PI * i / AROUND));
      p[2] = (float)cos(ball_angle(ring));
    }
  }
  ball->vertices[south][0] = ball->vertices[south][1] = 0;
  ball->vertices[south][2] = -1;
  for (ring = 0; ring + 1 < RINGS; ++ring) {
    for (i = 0; i < AROUND; ++i) {
      const int a = ring * AROUND + i, b = ring * AROUND + (i + 1) % AROUND;
      const int row = ring + CAP - PATCH_ROW;
      if (row >= 0 && row < PATCH_SIZE && i % (AROUND / patches) < PATCH_SIZE) continue;
      ball_face(ball, &n, a, a + AROUND, b);
      ball_face(ball, &n, b, a + AROUND, b + AROUND);
    }
  }
  for (i = 0; i < AROUND; ++i)
    ball_face(ball, &n, (RINGS - 1) * AROUND + i, south, (RINGS - 1) * AROUND + (i + 1) % AROUND);
}

double cap_edge(void) { return 2 * sin(PI / AROUND) * sin(ball_angle(0)); }
