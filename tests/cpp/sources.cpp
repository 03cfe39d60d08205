// What may be copied from, and an initial completion, by coordinates.
#include <algorithm>
#include <cmath>
#include <complete_mesh_attributes.hpp>

#include "suite.hpp"

namespace {

// A ball with bumps, and the same without holes elsewhere.
template <class Scalar>
struct Bumpy {
  Ball<Scalar> ball;
  mc::Surface twin;
  // Of both: where a vertex is on the ball, x then z.
  std::vector<double> values, twin_values;

  explicit Bumpy(bool mirrored) {
    static struct ball c;
    static struct whole_ball whole;
    make_ball(&c, 1);
    add_bumps(c.vertices, VERTICES);
    for (const auto& p : c.vertices) ball.vertices.push_back({p[0], p[1], p[2]});
    ball.faces = make_ball_of<Scalar>().faces;
    for (const auto& p : ball.vertices) values.insert(values.end(), {p[0], p[2]});
    make_whole_ball(&whole);
    add_bumps(whole.vertices, WHOLE_VERTICES);
    for (const auto& p : whole.vertices) twin_values.insert(twin_values.end(), {p[0], p[2]});
    move_away(&whole, mirrored);
    twin = mc::surface(whole.vertices, whole.faces);
  }
};

template <class Scalar>
void input_comes_first(const mc::Result<Scalar>& result, const Ball<Scalar>& ball) {
  if (!CHECK(result.vertices().size() > ball.vertices.size())) return;
  CHECK(std::memcmp(result.vertices().data(), ball.vertices.data(), VERTICES * sizeof ball.vertices[0]) == 0);
  CHECK(std::memcmp(result.faces().data(), ball.faces.data(), FACES * sizeof ball.faces[0]) == 0);
}

template <class Scalar>
double worst(const mc::Result<Scalar>& result) {
  double most = 0;
  CHECK(!result.new_vertices().empty());
  for (const auto& [x, y, z] : result.new_vertices()) most = std::max(most, off_bumps(x, y, z));
  return most;
}

// The twin gives back what is missing; mirrored and not to be mirrored it does not.
template <class Scalar>
void check_exemplar(bool mirrored, bool unmirrored) {
  const Bumpy<Scalar> bumpy(mirrored);
  mc::Options options;
  options.exemplar = bumpy.twin;
  options.exemplar_only = true;
  options.unmirrored = unmirrored;
  const auto result = mc::complete(mc::view(bumpy.ball.vertices, bumpy.ball.faces), options);
  input_comes_first(result, bumpy.ball);
  CHECK(mirrored && unmirrored ? worst(result) > 0.02 : worst(result) < 0.015);
  std::size_t outside = 0, reflecting = 0;
  for (const std::uint32_t f : result.new_vertex_source_faces())
    outside += f != mc::none && !(f >= FACES && f < FACES + WHOLE_FACES);
  for (std::size_t hole = 0; hole < result.holes().size(); ++hole)
    for (const mc::Source& source : result.holes().sources(hole)) reflecting += source.mirrored;
  CHECK(outside == 0);
  CHECK(!unmirrored || reflecting == 0);
  CHECK(result.new_vertex_values().empty());
  if (!(mirrored && unmirrored)) {
    options.vertex_values = bumpy.values;
    options.exemplar_values = bumpy.twin_values;
    options.value_channels = 2;
    options.steering_channels = 2;
    const auto painted = mc::complete(mc::view(bumpy.ball.vertices, bumpy.ball.faces), options);
    const auto points = painted.new_vertices();
    const auto got = painted.new_vertex_values();
    CHECK(!got.empty() && got.size() == 2 * points.size());
    double off = 0;
    std::size_t copied = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      // a hole of a few vertices stays smooth: values from its rim
      if (painted.new_vertex_source_faces()[i] == mc::none) continue;
      ++copied;
      off = std::max({off, std::abs(got[2 * i] - points[i][0]), std::abs(got[2 * i + 1] - points[i][2])});
    }
    CHECK(off < 0.03 && copied > points.size() / 2);
  }
  // the exemplar has no colours: the rim's are taken
  const mc::Carrier carrier(result);
  const auto height = [&](std::uint32_t v) { return std::array<double, 1>{bumpy.ball.vertices[v][2]}; };
  const auto corners = [&](std::uint32_t f) { return bumpy.ball.faces.at(f); };
  CHECK(carrier.from_source<1>(result, height, corners) == carrier.from_rim<1>(height));
}

void check_source_faces() {
  const Ball<double> ball = make_ball_of<double>();
  const auto mesh = mc::view(ball.vertices, ball.faces);
  const auto may = [&](std::uint32_t f) {
    const auto& face = ball.faces.at(f);
    return std::all_of(face.begin(), face.end(), [&](std::uint32_t v) { return ball.vertices[v][0] > 0; });
  };
  const auto count = [&](const mc::Result<double>& result) {
    std::array<std::size_t, 2> places = {0, 0};  // not from there, from there
    for (const std::uint32_t f : result.new_vertex_source_faces())
      if (f != mc::none) ++places[may(f)];
    return places;
  };
  CHECK(count(mc::complete(mesh))[0] > 0);
  mc::Options options;
  for (std::uint32_t f = 0; f < FACES; ++f) options.source_faces.push_back(may(f));
  const auto result = mc::complete(mesh, options);
  CHECK(count(result)[0] == 0 && count(result)[1] > 0);
  const mc::Completer<double> completer(mesh);
  const auto again = completer.complete(options);
  CHECK(same_bytes(again.vertices(), result.vertices().data(), result.vertices().size(), 3 * sizeof(double)));
  // one flag too few is not read beyond
  options.source_faces.pop_back();
  CHECK(mc::try_complete(mesh, options).status() == mc::Status::invalid_argument);
  CHECK(mc::try_list_holes(mesh, options).status() == mc::Status::invalid_argument);
  CHECK(mc::Completer<double>::make(mesh, options).status() == mc::Status::invalid_argument);
  CHECK(completer.try_complete(options).status() == mc::Status::invalid_argument);
  options.source_faces.assign(FACES, 0);
  CHECK(mc::try_complete(mesh, options).status() == mc::Status::invalid_option);
}

// A membrane comes back as it was given, where a smooth fill would be another.
template <class Scalar>
void check_initial() {
  const Bumpy<Scalar> bumpy(false);
  const auto mesh = mc::view(bumpy.ball.vertices, bumpy.ball.faces);
  const auto sorted = [](const mc::Result<Scalar>& result) {
    Points<Scalar> points(result.new_vertices().begin(), result.new_vertices().end());
    std::sort(points.begin(), points.end());
    return points;
  };
  mc::Options options;
  options.method = mc::Method::smooth;
  const auto other = mc::complete(mesh, options);
  options.fairing = mc::Fairing::c0;
  const auto given = mc::complete(mesh, options);
  options.fairing = mc::Fairing::automatic;
  options.initial = mc::surface(given.new_vertices(), given.new_faces());
  const auto again = mc::complete(mesh, options);
  input_comes_first(again, bumpy.ball);
  CHECK(sorted(again) == sorted(given) && again.new_faces().size() == given.new_faces().size());
  CHECK(sorted(other) != sorted(given));
  options.initial.faces.resize(1);
  CHECK(mc::try_complete(mesh, options).status() == mc::Status::hole_failed);
  options.initial.faces[0] = {0, 1, UINT32_MAX};
  CHECK(mc::try_complete(mesh, options).status() == mc::Status::invalid_option);
}

}  // namespace

void test_sources() {
  check_exemplar<float>(false, false);
  check_exemplar<double>(false, true);
  check_exemplar<double>(true, false);
  check_exemplar<float>(true, true);
  check_source_faces();
  check_initial<float>();
  check_initial<double>();
}
