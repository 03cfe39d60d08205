/* Point clouds: their holes listed, by value, and filled. */
#include "suite.h"

/* A relief on the nodes of a hexagonal lattice of spacing 1, with a round hole in its middle. */
enum { SIDE = FINE ? 40 : 24, NODES = SIDE * SIDE };
static const double hole_radius = FINE ? 5 : 4;

struct cloud {
  float points[NODES + 3][3];
  uint32_t count, removed;
};

static double middle_of(int axis) { return axis ? 0.5 * SIDE * sqrt(0.75) : 0.5 * SIDE; }

static void make_cloud(struct cloud *cloud) {
  int i, j;
  cloud->count = cloud->removed = 0;
  for (j = 0; j < SIDE; ++j) {
    for (i = 0; i < SIDE; ++i) {
      const double x = i + 0.5 * (j % 2), y = j * sqrt(0.75);
      const double dx = x - middle_of(0), dy = y - middle_of(1);
      float *p = cloud->points[cloud->count];
      if (dx * dx + dy * dy < hole_radius * hole_radius) {
        ++cloud->removed;
        continue;
      }
      p[0] = (float)x;
      p[1] = (float)y;
      p[2] = (float)(0.3 * sin(0.2 * x));
      ++cloud->count;
    }
  }
}

static complete_mesh_holes *list(const struct cloud *cloud, const complete_mesh_options *opts) {
  complete_mesh_holes *holes = NULL;
  CHECK(complete_mesh_find_point_holes(cloud->points, cloud->count, NULL, opts, &holes) ==
        COMPLETE_MESH_STATUS_OK);
  CHECK(complete_mesh_holes_count(holes) == 2);
  return holes;
}

/* The id of the hole, or of the border. */
static uint32_t id_of(const complete_mesh_holes *holes, uint32_t border) {
  return get_hole(holes, 0).is_border == border ? 0 : 1;
}

static int is_in(const uint32_t *list, size_t count, uint32_t number) {
  size_t i;
  for (i = 0; i < count; ++i) {
    if (list[i] == number) return 1;
  }
  return 0;
}

/* Every point of the rim lies where the hole ends, and every one that is the first there is on the rim. */
static void check_rim(const struct cloud *cloud, const complete_mesh_holes *holes, uint32_t id) {
  size_t n = 0, astray = 0, missing = 0;
  uint32_t i;
  const uint32_t *rim = complete_mesh_holes_loop(holes, id, 0, &n);
  for (i = 0; i < n; ++i) {
    const double x = cloud->points[rim[i]][0] - middle_of(0), y = cloud->points[rim[i]][1] - middle_of(1);
    const double r = sqrt(x * x + y * y);
    astray += !(r > hole_radius - 1e-4 && r < hole_radius + 1.2);
  }
  for (i = 0; i < cloud->count; ++i) {
    const double x = cloud->points[i][0] - middle_of(0), y = cloud->points[i][1] - middle_of(1);
    missing += sqrt(x * x + y * y) < hole_radius + 0.2 && !is_in(rim, n, i);
  }
  CHECK(rim != NULL && n > 12 && astray == 0 && missing == 0);
}

static void check_hole(const struct cloud *cloud, const complete_mesh_holes *holes) {
  const complete_mesh_hole hole = get_hole(holes, id_of(holes, 0));
  CHECK(hole.is_border == 0 && hole.loop_count == 1 && hole.struct_size == sizeof hole);
  CHECK(hole.status == COMPLETE_MESH_HOLE_STATUS_OPEN);
  CHECK(fabs(hole.centre[0] - middle_of(0)) < 0.3 && fabs(hole.centre[1] - middle_of(1)) < 0.3);
  CHECK(hole.diameter > 2 * hole_radius && hole.diameter < 2 * hole_radius + 2);
  CHECK(fabs(hole.missing_points - cloud->removed) < 0.15 * cloud->removed);
  CHECK(hole.boundary_probability > 0.4 && hole.boundary_probability <= 1);
  /* The distance field cannot say: the surface is open. */
  CHECK(hole.detectors_asked == (COMPLETE_MESH_DETECTOR_SURFACE | COMPLETE_MESH_DETECTOR_BOUNDARY));
  CHECK(hole.detectors_agreed == hole.detectors_asked);
  check_rim(cloud, holes, hole.id);
  CHECK(fabs(complete_mesh_holes_spacing(holes) - 1) < 0.02);
}

/* A border is listed, and chosen only by its name. */
static void check_border(const struct cloud *cloud, const complete_mesh_holes *holes) {
  complete_mesh_options opts = defaults();
  complete_mesh_holes *named;
  const complete_mesh_hole border = get_hole(holes, id_of(holes, 1));
  CHECK(border.is_border == 1 && border.status == COMPLETE_MESH_HOLE_STATUS_NOT_SELECTED);
  CHECK(2 * border.edge_count > 5 * SIDE);
  opts.selection = COMPLETE_MESH_SELECTION_IDS;
  opts.selection_ids = &border.id;
  opts.selection_count = 1;
  named = list(cloud, &opts);
  CHECK(get_hole(named, border.id).status == COMPLETE_MESH_HOLE_STATUS_OPEN);
  CHECK(get_hole(named, 1 - border.id).status == COMPLETE_MESH_HOLE_STATUS_NOT_SELECTED);
  complete_mesh_holes_free(named);
}

/* What was not looked at is named by why, point by point. */
static void check_ignored(struct cloud cloud, const complete_mesh_holes *without) {
  const uint32_t first = cloud.count;
  complete_mesh_holes *holes;
  const uint32_t *points;
  size_t n = 7;
  uint32_t kind;
  int k;
  for (kind = 0; kind <= COMPLETE_MESH_IGNORED_INSIDE + 1; ++kind) {
    CHECK(complete_mesh_holes_ignored_points(without, kind, &n) == NULL && n == 0);
  }
  for (k = 0; k < 3; ++k) {
    cloud.points[first][k] = (float)NAN;
    cloud.points[first + 1][k] = cloud.points[5][k];
    cloud.points[first + 2][k] = 60;
  }
  cloud.count += 3;
  holes = list(&cloud, NULL);
  for (kind = 0; kind <= COMPLETE_MESH_IGNORED_OUTLIER; ++kind) {
    points = complete_mesh_holes_ignored_points(holes, kind, &n);
    CHECK(n == 1 && points != NULL && points[0] == first + kind);
  }
  CHECK(get_hole(holes, 0).edge_count == get_hole(without, 0).edge_count);
  complete_mesh_holes_free(holes);
}

/* The fill names the same holes, by the same detectors, and lies on the relief. */
static void check_fill(const struct cloud *cloud, const complete_mesh_holes *listed) {
  complete_mesh_options opts = defaults();
  complete_mesh_result *result = NULL;
  const complete_mesh_holes *holes;
  const float *p;
  size_t i, n = 0, m = 0, off = 0;
  opts.method = COMPLETE_MESH_METHOD_SMOOTH;
  CHECK(complete_mesh_points(cloud->points, cloud->count, NULL, &opts, &result) ==
        COMPLETE_MESH_STATUS_OK);
  holes = complete_mesh_result_holes(result);
  CHECK(complete_mesh_holes_count(holes) == 2 && complete_mesh_result_filled_count(result) == 1);
  for (i = 0; i < 2; ++i) {
    const complete_mesh_hole a = get_hole(holes, i), b = get_hole(listed, i);
    const uint32_t *rim = complete_mesh_holes_loop(holes, i, 0, &n);
    const uint32_t *other = complete_mesh_holes_loop(listed, i, 0, &m);
    CHECK(n == m && rim != NULL && other != NULL && memcmp(rim, other, n * sizeof *rim) == 0);
    CHECK(a.is_border == b.is_border && fabs(a.missing_points - b.missing_points) < 1e-9);
    CHECK(fabs(a.boundary_probability - b.boundary_probability) < 1e-9);
    CHECK(a.detectors_asked == b.detectors_asked && a.detectors_agreed == b.detectors_agreed);
    CHECK((a.status == COMPLETE_MESH_HOLE_STATUS_FILLED) == (b.is_border == 0));
  }
  p = (const float *)complete_mesh_result_new_vertices(result);
  n = complete_mesh_result_new_vertex_count(result);
  for (i = 0; i < n; ++i, p += 3) off += !(fabs(p[2] - 0.3 * sin(0.2 * p[0])) < 0.1);
  CHECK(n > cloud->removed / 2 && off == 0);
  complete_mesh_result_free(result);
}

/* Points of the unit sphere on a spiral, without those within 0.4 of its pole. */
static void check_field(void) {
  static double points[2000][3];
  static const double region[4] = {0, 0, 1, 0.7}, nothing[4] = {1, 0, 0, 0.3};
  complete_mesh_options opts = defaults();
  complete_mesh_holes *holes = NULL;
  uint32_t count = 0, i;
  size_t n = 7;
  for (i = 0; i < 2000; ++i) {
    const double z = 1 - (2 * i + 1.0) / 2000, r = sqrt(1 - z * z), a = 2.39996322972865332 * i;
    if (2 - 2 * z < 0.16) continue;
    points[count][0] = r * cos(a);
    points[count][1] = r * sin(a);
    points[count++][2] = z;
  }
  opts.vertex_type = COMPLETE_MESH_VERTEX_TYPE_F64;
  CHECK(complete_mesh_find_point_holes(points, count, NULL, &opts, &holes) == COMPLETE_MESH_STATUS_OK);
  CHECK(complete_mesh_holes_count(holes) == 1 && get_hole(holes, 0).detectors_asked == 7);
  CHECK(get_hole(holes, 0).detectors_agreed == 7 && COMPLETE_MESH_DETECTOR_FIELD == 4);
  CHECK(complete_mesh_holes_only_in_field(holes, &n) == NULL && n == 0);
  complete_mesh_holes_free(holes);
  opts.given_regions = region;
  opts.given_region_count = 1;
  CHECK(complete_mesh_find_point_holes(points, count, NULL, &opts, &holes) == COMPLETE_MESH_STATUS_OK);
  CHECK(complete_mesh_holes_count(holes) == 1 && fabs(get_hole(holes, 0).centre[2] - 0.9) < 0.05);
  complete_mesh_holes_free(holes);
  opts.given_regions = nothing;
  CHECK(complete_mesh_find_point_holes(points, count, NULL, &opts, &holes) ==
        COMPLETE_MESH_STATUS_INVALID_OPTION);
  CHECK(holes == NULL && strstr(complete_mesh_last_error_message(), "region 0 has no rim") != NULL);
}

/* The hole's rim, every second point of it, backwards: the same fill as if it were found. Six points around
 * a node far from it: that one alone is inside. */
static void check_given(const struct cloud *cloud, const complete_mesh_holes *listed) {
  complete_mesh_options opts = defaults();
  complete_mesh_result *found = NULL, *given = NULL;
  uint32_t loop[NODES], size = 0, around[6], six = 6;
  size_t n = 0, m = 0, i;
  const uint32_t *rim = complete_mesh_holes_loop(listed, id_of(listed, 0), 0, &n), *inside;
  const uint32_t middle = 3 * SIDE + 3;
  opts.method = COMPLETE_MESH_METHOD_SMOOTH;
  CHECK(complete_mesh_points(cloud->points, cloud->count, NULL, &opts, &found) ==
        COMPLETE_MESH_STATUS_OK);
  for (i = 0; i < n; i += 2) loop[size++] = rim[n - 1 - i];
  opts.given_loop_points = loop;
  opts.given_loop_sizes = &size;
  opts.given_loop_count = 1;
  CHECK(complete_mesh_points(cloud->points, cloud->count, NULL, &opts, &given) ==
        COMPLETE_MESH_STATUS_OK);
  CHECK(complete_mesh_holes_count(complete_mesh_result_holes(given)) == 1);
  n = complete_mesh_result_new_vertex_count(found);
  CHECK(n > 0 && n == complete_mesh_result_new_vertex_count(given));
  CHECK(memcmp(complete_mesh_result_new_vertices(found), complete_mesh_result_new_vertices(given),
               n * 3 * sizeof(float)) == 0);
  complete_mesh_result_free(given);
  complete_mesh_result_free(found);
  /* Rows of odd numbers lie half a node farther. */
  around[0] = middle + 1;
  around[1] = middle + SIDE + 1;
  around[2] = middle + SIDE;
  around[3] = middle - 1;
  around[4] = middle - SIDE;
  around[5] = middle - SIDE + 1;
  opts.given_loop_points = around;
  opts.given_loop_sizes = &six;
  CHECK(complete_mesh_points(cloud->points, cloud->count, NULL, &opts, &given) ==
        COMPLETE_MESH_STATUS_OK);
  inside = complete_mesh_holes_ignored_points(complete_mesh_result_holes(given),
                                              COMPLETE_MESH_IGNORED_INSIDE, &m);
  CHECK(m == 1 && inside != NULL && inside[0] == middle);
  complete_mesh_result_free(given);
  around[5] = cloud->count;
  CHECK(complete_mesh_points(cloud->points, cloud->count, NULL, &opts, &given) ==
        COMPLETE_MESH_STATUS_INVALID_OPTION);
  CHECK(given == NULL && strstr(complete_mesh_last_error_message(), "loop 0 names point") != NULL);
  opts.given_loop_points = NULL;
  CHECK(complete_mesh_points(cloud->points, cloud->count, NULL, &opts, &given) ==
        COMPLETE_MESH_STATUS_INVALID_ARGUMENT);
  CHECK(strstr(complete_mesh_last_error_message(), "given_loop_points") != NULL);
}

/* Doubles, and positions within larger structs: the same loops. */
static void check_forms(const struct cloud *cloud, const complete_mesh_holes *listed) {
  static double wide[NODES][5];
  complete_mesh_options opts = defaults();
  complete_mesh_holes *holes = NULL;
  size_t n = 0, m = 0;
  const uint32_t *rim, *other;
  uint32_t i;
  int k;
  for (i = 0; i < cloud->count; ++i) {
    for (k = 0; k < 3; ++k) wide[i][k] = cloud->points[i][k];
  }
  opts.vertex_type = COMPLETE_MESH_VERTEX_TYPE_F64;
  opts.vertex_stride = sizeof wide[0];
  CHECK(complete_mesh_find_point_holes(wide, cloud->count, NULL, &opts, &holes) ==
        COMPLETE_MESH_STATUS_OK);
  rim = complete_mesh_holes_loop(holes, 0, 0, &n);
  other = complete_mesh_holes_loop(listed, 0, 0, &m);
  CHECK(n == m && n > 0 && memcmp(rim, other, n * sizeof *rim) == 0);
  complete_mesh_holes_free(holes);
}

static int stop(void *calls, double fraction, const char *stage) {
  (void)fraction;
  (void)stage;
  return --*(int *)calls == 0;
}

static void check_refused(const struct cloud *cloud) {
  static const uint8_t none[1] = {0};
  complete_mesh_options opts = defaults();
  complete_mesh_holes *holes = NULL;
  int calls, left;
  CHECK(complete_mesh_find_point_holes(cloud->points, 2, NULL, NULL, &holes) ==
        COMPLETE_MESH_STATUS_INVALID_MESH);
  CHECK(holes == NULL);
  opts.source_faces = none;
  CHECK(complete_mesh_find_point_holes(cloud->points, cloud->count, NULL, &opts, &holes) ==
        COMPLETE_MESH_STATUS_INVALID_OPTION);
  CHECK(holes == NULL && strstr(complete_mesh_last_error_message(), "cloud") != NULL);
  opts = defaults();
  opts.method = 99;
  CHECK(complete_mesh_find_point_holes(cloud->points, cloud->count, NULL, &opts, &holes) ==
        COMPLETE_MESH_STATUS_INVALID_ARGUMENT);
  opts = defaults();
  opts.progress = stop;
  opts.progress_user = &left;
  for (calls = 1; calls <= 3; ++calls) {
    left = calls;
    CHECK(complete_mesh_find_point_holes(cloud->points, cloud->count, NULL, &opts, &holes) ==
          COMPLETE_MESH_STATUS_CANCELLED);
    CHECK(holes == NULL);
  }
}

void test_points(void) {
  static struct cloud cloud;
  complete_mesh_holes *holes;
  make_cloud(&cloud);
  holes = list(&cloud, NULL);
  check_hole(&cloud, holes);
  check_border(&cloud, holes);
  check_ignored(cloud, holes);
  check_fill(&cloud, holes);
  check_forms(&cloud, holes);
  check_given(&cloud, holes);
  check_field();
  check_refused(&cloud);
  complete_mesh_holes_free(holes);
}
