// Every accessor gives what the C function gives, to the bit.
#include <cmath>
#include <string>

#include "suite.hpp"

namespace {

template <class Scalar>
complete_mesh_result* fill_in_c(const Ball<Scalar>& ball) {
  complete_mesh_options opts;
  complete_mesh_options_init(&opts, sizeof opts);
  opts.vertex_type = sizeof(Scalar) == 8 ? COMPLETE_MESH_VERTEX_TYPE_F64 : COMPLETE_MESH_VERTEX_TYPE_F32;
  complete_mesh_result* result = nullptr;
  CHECK(complete_mesh(ball.vertices.data(), ball.vertices.size(), ball.faces[0].data(),
                      ball.faces.size(), &opts, &result) == COMPLETE_MESH_STATUS_OK);
  return result;
}

bool same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

void check_hole(const mc::Hole& hole, const complete_mesh_holes* c_holes, std::size_t id) {
  complete_mesh_hole c = {};
  CHECK(complete_mesh_holes_get(c_holes, id, &c, sizeof c) == 1);
  CHECK(hole.id == id && c.id == id);
  CHECK(hole.kind == mc::HoleKind(c.kind) && hole.status == mc::HoleStatus(c.status));
  CHECK(hole.status == mc::HoleStatus::filled);
  CHECK(hole.fairing == mc::Fairing(c.fairing) && hole.method == mc::Method(c.method));
  CHECK(hole.is_unsafe == (c.is_unsafe == 1));
  CHECK(hole.loop_count == c.loop_count && hole.edge_count == c.edge_count);
  CHECK(hole.circumference == c.circumference && hole.diameter == c.diameter);
  CHECK(std::memcmp(hole.centre.data(), c.centre, sizeof c.centre) == 0);
  CHECK(hole.first_new_vertex == c.first_new_vertex && hole.new_vertex_count == c.new_vertex_count);
  CHECK(hole.first_new_face == c.first_new_face && hole.new_face_count == c.new_face_count);
  CHECK(hole.source_count == c.source_count && hole.confidence == c.confidence);
  CHECK(same(hole.coherence_error_before, c.coherence_error_before));
  CHECK(same(hole.coherence_error_after, c.coherence_error_after));
  CHECK(hole.seconds > 0);
}

void check_sources(const mc::Holes& holes, const complete_mesh_holes* c_holes, std::size_t id) {
  const std::vector<mc::Source> sources = holes.sources(id);
  CHECK(sources.size() == holes[id].source_count);
  for (std::size_t i = 0; i < sources.size(); ++i) {
    complete_mesh_source c = {};
    CHECK(complete_mesh_holes_source(c_holes, id, i, &c, sizeof c) == 1);
    CHECK(sources[i].mirrored == (c.mirrored == 1) && sources[i].error == c.error);
    CHECK(sources[i].weight == c.weight && sources[i].vertex_count == c.vertex_count);
    CHECK(sources[i].coloured_count == c.coloured_count);
    CHECK(std::memcmp(sources[i].transform.data(), c.transform, sizeof c.transform) == 0);
    const auto q = sources[i].apply({2, 3, 5});
    for (std::size_t k = 0; k < 3; ++k) {
      const double* m = c.transform + 4 * k;
      CHECK(q[k] == m[0] * 2 + m[1] * 3 + m[2] * 5 + m[3]);
    }
  }
}

void check_holes(const mc::Holes& holes, const complete_mesh_holes* c_holes) {
  CHECK(holes.size() == 2 && !holes.empty());
  std::size_t seen = 0;
  for (const mc::Hole& hole : holes) {
    check_hole(hole, c_holes, seen);
    check_sources(holes, c_holes, seen);
    std::size_t n = 0;
    const std::uint32_t* loop = complete_mesh_holes_loop(c_holes, seen, 0, &n);
    CHECK(same_bytes(holes.loop(seen, 0), loop, n, 4));
    CHECK(holes.loop(seen, 1).empty() && holes.loop(99, 0).empty());
    CHECK(holes.reason(seen) == "" && holes.problem_vertices(seen).empty());
    ++seen;
  }
  CHECK(seen == 2);
  CHECK(holes.non_manifold_edges().empty() && holes.inconsistent_edges().empty());
  CHECK(holes.degenerate_faces().empty() && holes.duplicate_vertices().empty());
}

template <class Scalar>
void check_result(const mc::Result<Scalar>& r, const complete_mesh_result* c, std::size_t size) {
  const std::size_t nv = complete_mesh_result_new_vertex_count(c);
  const std::size_t nf = complete_mesh_result_new_face_count(c);
  const std::size_t all_vertices = complete_mesh_result_vertex_count(c);
  const std::size_t all_faces = complete_mesh_result_face_count(c);
  CHECK(complete_mesh_result_vertex_type(r.get()) == complete_mesh_result_vertex_type(c));
  CHECK(r.input_vertex_count() == VERTICES && r.input_face_count() == FACES);
  CHECK(r.filled_count() == 2 && r.seconds() > 0 && r.cpu_seconds() >= 0);
  CHECK(same_bytes(r.vertices(), complete_mesh_result_vertices(c), all_vertices, 3 * size));
  CHECK(same_bytes(r.faces(), complete_mesh_result_faces(c), all_faces, 12));
  CHECK(same_bytes(r.new_vertices(), complete_mesh_result_new_vertices(c), nv, 3 * size));
  CHECK(same_bytes(r.new_faces(), complete_mesh_result_new_faces(c), nf, 12));
  CHECK(same_bytes(r.new_vertex_holes(), complete_mesh_result_new_vertex_holes(c), nv, 4));
  CHECK(same_bytes(r.new_face_holes(), complete_mesh_result_new_face_holes(c), nf, 4));
  CHECK(same_bytes(r.new_vertex_source_faces(), complete_mesh_result_new_vertex_source_faces(c), nv, 4));
  CHECK(same_bytes(r.new_vertex_barycentrics(), complete_mesh_result_new_vertex_barycentrics(c), nv, 24));
  CHECK(same_bytes(r.new_vertex_sources(), complete_mesh_result_new_vertex_sources(c), nv, 4));
  CHECK(same_bytes(r.new_vertex_confidences(), complete_mesh_result_new_vertex_confidences(c), nv, 8));
  CHECK(same_bytes(r.new_vertex_colour_faces(), complete_mesh_result_new_vertex_colour_faces(c), nv, 4));
  CHECK(same_bytes(r.new_vertex_colour_barycentrics(),
                   complete_mesh_result_new_vertex_colour_barycentrics(c), nv, 24));
  CHECK(same_bytes(r.new_vertex_colour_sources(), complete_mesh_result_new_vertex_colour_sources(c), nv, 4));
  CHECK(same_bytes(r.new_vertex_colour_confidences(),
                   complete_mesh_result_new_vertex_colour_confidences(c), nv, 8));
  // without colours they are the shape's
  CHECK(same_bytes(r.new_vertex_colour_faces(), complete_mesh_result_new_vertex_source_faces(c), nv, 4));
  check_holes(r.holes(), complete_mesh_result_holes(c));
}

template <class Scalar>
void check_ball() {
  const Ball<Scalar> ball = make_ball_of<Scalar>();
  complete_mesh_result* c = fill_in_c(ball);
  const mc::Result<Scalar> result = mc::complete(mc::view(ball.vertices, ball.faces));
  check_result(result, c, sizeof(Scalar));
  // rows by value, in a loop and by index
  std::size_t i = 0, wrong = 0;
  for (const auto [x, y, z] : result.vertices()) {
    const auto p = result.vertices()[i];
    wrong += p[0] != x || p[1] != y || p[2] != z;
    if (i < ball.vertices.size()) wrong += ball.vertices[i] != p;
    ++i;
  }
  CHECK(wrong == 0 && i == result.vertices().size());
  complete_mesh_result_free(c);
}

// A wall with a relief on the left (x < 1), a hole in it, and around the hole the colours of the flat right side:
// the shape comes from the left, the colours from the right, and each says so.
void check_colours_from_elsewhere() {
  constexpr double tau = 6.283185307179586, step = 0.03;
  constexpr int nx = 180, ny = 80;
  const auto at = [&](double i, double j) { return std::array<double, 2>{step * i - 2.7, step * j - 1.2}; };
  const auto off = [](std::array<double, 2> p) { return std::hypot(p[0] + 1.9, p[1]); };
  mc::Options options;
  Points<double> vertices;
  std::vector<std::array<std::uint32_t, 3>> faces;
  std::vector<std::uint32_t> number((nx + 1) * (ny + 1), mc::none);
  const auto id = [&](int i, int j) {
    std::uint32_t& n = number[j * (nx + 1) + i];
    if (n != mc::none) return n;
    n = static_cast<std::uint32_t>(vertices.size());
    const auto p = at(i, j);
    const bool left = p[0] < 1;
    const double relief = 0.025 * std::sin(tau * p[0] / 0.3) * std::cos(tau * p[1] / 0.375) +
                          0.015 * std::sin(tau * (p[0] + p[1]) / 0.6);
    vertices.push_back({p[0], p[1], left ? relief : 0});
    const double v = p[0] > 1 || off(p) < 0.45 ? std::sin(11 * p[0]) * std::sin(9 * p[1])
                                               : std::sin(17 * (p[0] + 0.3 * p[1]));
    for (const double x : {0.5 + 0.4 * v, 0.5 - 0.2 * v, 0.3}) options.vertex_values.push_back(x);
    return n;
  };
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      if (off(at(i + 0.5, j + 0.5)) <= 0.25) continue;
      const std::uint32_t a = id(i, j), b = id(i + 1, j), c = id(i + 1, j + 1), d = id(i, j + 1);
      faces.push_back({a, b, c});
      faces.push_back({a, c, d});
    }
  options.value_channels = options.steering_channels = 3;
  options.selection = mc::Selection::near_point;
  options.selection_point = {-1.9, 0.25, 0};
  const auto result = mc::complete(mc::view(vertices, faces), options);
  const std::size_t count = result.new_vertices().size();
  std::size_t shape = 0, colour = 0, same = 0, coloured = 0;
  const auto right = [&](std::uint32_t f) { return f != mc::none && vertices[faces[f][0]][0] > 1; };
  for (std::size_t i = 0; i < count; ++i) {
    shape += right(result.new_vertex_source_faces()[i]);
    colour += right(result.new_vertex_colour_faces()[i]);
    same += result.new_vertex_colour_sources()[i] == result.new_vertex_sources()[i];
    const auto w = result.new_vertex_colour_barycentrics()[i];
    CHECK(std::abs(w[0] + w[1] + w[2] - 1) < 1e-9 && result.new_vertex_colour_confidences()[i] > 0.5);
  }
  for (const mc::Hole& hole : result.holes())
    for (const mc::Source& source : result.holes().sources(hole.id)) coloured += source.coloured_count;
  CHECK(count > 100 && shape == 0 && colour * 10 > 9 * count && same == count - coloured && coloured >= colour);
}

// Positions between other fields, and faces with a material.
void check_strides() {
  struct Vertex {
    double weight;
    float position[3];
    unsigned char colour[4];
  };
  struct Face {
    std::uint32_t material, corners[3];
  };
  const Ball<float> ball = make_ball_of<float>();
  std::vector<Vertex> vertices;
  std::vector<Face> faces;
  for (const auto& p : ball.vertices) vertices.push_back({7, {p[0], p[1], p[2]}, {1, 2, 3, 4}});
  for (const auto& f : ball.faces) faces.push_back({9, {f[0], f[1], f[2]}});
  mc::MeshView<float> view;
  view.vertices = vertices[0].position;
  view.vertex_count = vertices.size();
  view.vertex_stride = sizeof(Vertex);
  view.faces = faces[0].corners;
  view.face_count = faces.size();
  view.face_stride = sizeof(Face);
  complete_mesh_result* c = fill_in_c(ball);
  check_result(mc::complete(view), c, sizeof(float));
  complete_mesh_result_free(c);
}

// What was asked of a temporary, and of an object that is gone.
void check_lifetime() {
  const Ball<float> ball = make_ball_of<float>();
  mc::Options smooth;
  smooth.method = mc::Method::smooth;
  const auto make = [&] { return mc::complete(mc::view(ball.vertices, ball.faces), smooth); };
  const mc::Holes holes = make().holes();
  CHECK(holes.size() == 2 && holes[1].status == mc::HoleStatus::filled);
  auto first = make();
  const auto copy = first;
  const auto points = copy.new_vertices();
  const Points<float> before(points.begin(), points.end());
  first = make();
  CHECK(copy.get() != first.get());
  CHECK(same_bytes(copy.new_vertices(), before.data(), before.size(), 12));
}

// The list of a cloud's holes is that of the C call, and its rim runs round the cap.
template <class Scalar>
void check_listed(const mc::MeshView<Scalar>& cloud, const Scalar* normals,
                  const complete_mesh_options& opts) {
  complete_mesh_holes* c = nullptr;
  CHECK(complete_mesh_find_point_holes(cloud.vertices, cloud.vertex_count, normals, &opts, &c) ==
        COMPLETE_MESH_STATUS_OK);
  const mc::Holes holes = mc::list_point_holes(cloud, normals);
  std::size_t n = 0;
  const std::uint32_t* rim = complete_mesh_holes_loop(c, 0, 0, &n);
  CHECK(holes.size() == 1 && same_bytes(holes.loop(0, 0), rim, n, 4));
  for (const std::uint32_t v : holes.loop(0, 0)) {
    const double z = cloud.vertices[3 * v + 2];
    CHECK(z <= 0.92 && z > 0.85);
  }
  complete_mesh_hole hole;
  complete_mesh_holes_get(c, 0, &hole, sizeof hole);
  CHECK(holes[0].boundary_probability == hole.boundary_probability && hole.boundary_probability > 0.4);
  CHECK(holes[0].missing_points == hole.missing_points && std::abs(hole.missing_points - 80) < 16);
  CHECK(holes[0].agreed() && holes[0].is_found_by(mc::Detector::boundary) && !holes[0].is_border);
  CHECK(holes[0].is_found_by(mc::Detector::field) && holes.only_in_field().empty());
  CHECK(holes[0].status == mc::HoleStatus::open && holes[0].detectors_asked == hole.detectors_asked);
  CHECK(holes.spacing() == complete_mesh_holes_spacing(c) && std::abs(holes.spacing() - 0.09) < 0.02);
  CHECK(holes.ignored_points(mc::Ignored::outlier).empty());
  complete_mesh_holes_free(c);
  mc::MeshView<Scalar> less = cloud;
  less.vertex_count = 2;
  CHECK(mc::try_list_point_holes(less).failure().status == mc::Status::invalid_mesh);
}

// The hole's own rim, or a region around it: the fill is the same as if it were found.
template <class Scalar>
void check_given(const mc::MeshView<Scalar>& cloud, const mc::Result<Scalar>& found, const Scalar* normals) {
  mc::Options loop, region, nothing;
  const auto rim = found.holes().loop(0, 0);
  loop.given_loops = {std::vector<std::uint32_t>(rim.begin(), rim.end())};
  region.given_regions = {{0, 0, 1, 0.6}};
  for (const mc::Options& options : {loop, region}) {
    const auto given = mc::complete_points(cloud, normals, options);
    CHECK(given.holes().size() == 1 && given.new_vertices().size() == found.new_vertices().size());
    CHECK(same_bytes(given.new_vertices(), found.new_vertices().data(), found.new_vertices().size(),
                     3 * sizeof(Scalar)));
    CHECK(given.holes().ignored_points(mc::Ignored::inside).empty());
  }
  nothing.given_loops = {{3, 5}};
  CHECK(mc::try_complete_points(cloud, normals, nothing).failure().status == mc::Status::invalid_option);
  nothing.given_loops = {};
  nothing.given_regions = {{0, 0, -1, 0.6}};
  CHECK(mc::try_list_point_holes(cloud, normals, nothing).failure().message.find("region 0") !=
        std::string::npos);
}

// Points of the unit sphere on a spiral, the cap at its top missing.
template <class Scalar>
void check_points() {
  Points<Scalar> points, inward;
  const int count = 2000;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2 * i + 1.0) / count, r = std::sqrt(1 - z * z), a = 2.39996322972865332 * i;
    if (z > 0.92) continue;
    points.push_back({Scalar(r * std::cos(a)), Scalar(r * std::sin(a)), Scalar(z)});
    inward.push_back({-points.back()[0], -points.back()[1], -points.back()[2]});
  }
  mc::MeshView<Scalar> cloud;
  cloud.vertices = points[0].data();
  cloud.vertex_count = points.size();
  complete_mesh_options opts;
  complete_mesh_options_init(&opts, sizeof opts);
  opts.vertex_type = sizeof(Scalar) == 8 ? COMPLETE_MESH_VERTEX_TYPE_F64 : COMPLETE_MESH_VERTEX_TYPE_F32;
  complete_mesh_result* c = nullptr;
  CHECK(complete_mesh_points(points[0].data(), points.size(), inward[0].data(), &opts, &c) ==
        COMPLETE_MESH_STATUS_OK);
  const auto result = mc::complete_points(cloud, inward[0].data());
  const std::size_t n = points.size(), k = complete_mesh_result_new_vertex_count(c);
  CHECK(k > 50 && k < 120 && result.vertices().size() == n + k && result.faces().size() == 0);
  CHECK(std::memcmp(result.vertices().data(), points.data(), n * sizeof points[0]) == 0);
  CHECK(same_bytes(result.new_vertices(), complete_mesh_result_new_vertices(c), k, sizeof points[0]));
  CHECK(same_bytes(result.new_point_normals(), complete_mesh_result_new_vertex_normals(c), k, 24));
  CHECK(same_bytes(result.new_point_source_points(),
                   complete_mesh_result_new_vertex_source_points(c), k, 4));
  for (std::size_t i = 0; i < k; ++i) {
    const auto p = result.new_vertices()[i];
    const auto m = result.new_point_normals()[i];
    CHECK(std::abs(std::sqrt(double(p[0] * p[0] + p[1] * p[1] + p[2] * p[2])) - 1) < 0.01);
    CHECK(p[2] > 0.9 && m[0] * p[0] + m[1] * p[1] + m[2] * p[2] < -0.95);
  }
  complete_mesh_result_free(c);
  check_listed(cloud, inward[0].data(), opts);
  check_given(cloud, result, inward[0].data());
  const Ball<Scalar> ball = make_ball_of<Scalar>();
  const auto mesh = mc::complete(mc::view(ball.vertices, ball.faces));
  CHECK(mesh.new_point_normals().size() == 0 && mesh.new_point_source_points().size() == 0);
  cloud.vertex_count = 2;
  CHECK(mc::try_complete_points(cloud).failure().status == mc::Status::invalid_mesh);
}

}  // namespace

void test_values() {
  check_points<float>();
  check_points<double>();
  CHECK(mc::version() == COMPLETE_MESH_VERSION);
  CHECK(mc::abi_version() == COMPLETE_MESH_ABI_VERSION);
  CHECK(std::string(mc::version_string()) == PACKAGE_VERSION);
  check_ball<float>();
  check_ball<double>();
  check_strides();
  check_colours_from_elsewhere();
  check_lifetime();
}
