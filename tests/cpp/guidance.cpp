// Fills guided by hand: a transform, a candidate, a range of scales.
#include <algorithm>
#include <cmath>

#include "suite.hpp"

namespace {

struct ball bumpy;
struct whole_ball whole;

template <class Scalar>
Ball<Scalar> broken() {
  Ball<Scalar> ball = make_ball_of<Scalar>();
  for (std::size_t v = 0; v < ball.vertices.size(); ++v)
    for (std::size_t k = 0; k < 3; ++k) ball.vertices[v][k] = bumpy.vertices[v][k];
  return ball;
}

template <class Scalar>
std::uint32_t large_hole(const mc::Result<Scalar>& result) {
  const auto& all = result.holes();
  return all[0].new_vertex_count > all[1].new_vertex_count ? 0 : 1;
}

template <class Scalar>
double error_of(const mc::Result<Scalar>& result) {
  std::vector<float> places;
  // of the large hole: the other has too few vertices to be anything but smooth
  for (std::size_t v = 0; v < result.new_vertices().size(); ++v) {
    const auto p = result.new_vertices()[v];
    if (result.new_vertex_holes()[v] == large_hole(result)) places.insert(places.end(), p.begin(), p.end());
  }
  CHECK(!places.empty());
  return off_whole(&whole, places.data(), places.size() / 3);
}

// The twin lies 5 farther along x and is three times as large.
mc::Surface make_twin() {
  struct whole_ball elsewhere = whole;
  for (auto& p : elsewhere.vertices)
    for (std::size_t k = 0; k < 3; ++k) p[k] = 3 * (p[k] + (k == 0 ? 5.0f : 0.0f));
  return mc::surface(elsewhere.vertices, elsewhere.faces);
}

template <class Scalar>
void check_placement() {
  const Ball<Scalar> ball = broken<Scalar>();
  const auto mesh = mc::view(ball.vertices, ball.faces);
  mc::Options options;
  options.exemplar = make_twin();
  options.placement = {1. / 3, 0, 0, -5, 0, 1. / 3, 0, 0, 0, 0, 1. / 3, 0};
  const auto exact = mc::complete(mesh, options);
  CHECK(error_of(exact) < 1e-4);
  for (const mc::Hole& hole : exact.holes())
    for (const mc::Source& source : exact.holes().sources(hole.id))
      CHECK(source.transform == *options.placement && !source.mirrored);
  (*options.placement)[7] += 0.03;
  const double off = error_of(mc::complete(mesh, options));
  options.refine = true;
  CHECK(off > 1e-3 && error_of(mc::complete(mesh, options)) < 0.3 * off);
  (*options.placement)[5] = 2;
  CHECK(mc::try_complete(mesh, options).status() == mc::Status::invalid_option);
  options.placement.reset();
  CHECK(mc::try_complete(mesh, options).status() == mc::Status::invalid_option);
  options.refine = false;
  options.exemplar_only = true;
  const double without = error_of(mc::complete(mesh, options));
  options.scale_range = {0.3, 0.4};
  CHECK(error_of(mc::complete(mesh, options)) < 0.1 * without);
}

void check_candidates() {
  const Ball<double> ball = broken<double>();
  const mc::Completer<double> completer(mc::view(ball.vertices, ball.faces));
  const auto all = completer.candidates(3);
  CHECK(all.size() >= 2);
  mc::Options options;
  for (const auto& made : all) {
    ++options.candidate;
    const auto again = completer.complete(options);
    CHECK(again.new_vertices().size() == made.new_vertices().size());
    for (std::size_t v = 0; v < again.new_vertices().size(); ++v)
      CHECK(again.new_vertices()[v] == made.new_vertices()[v]);
    for (const mc::Hole& hole : made.holes()) CHECK(hole.source_count <= 1);
  }
  options.candidate = UINT32_MAX;
  CHECK(completer.complete(options).holes()[0].source_count == 0);
}

// A bump over the cap that nothing shows: the fill goes through its top.
template <class Scalar>
void check_points() {
  const Ball<Scalar> ball = broken<Scalar>();
  const auto mesh = mc::view(ball.vertices, ball.faces);
  mc::Options options;
  options.method = mc::Method::smooth;
  options.constraint_points = {{0, 0, 1.3}};
  const auto nearest = [&] {
    double least = 9;
    const auto made = mc::complete(mesh, options);
    for (const auto& p : made.new_vertices())
      least = std::min(least, std::hypot(p[0], std::hypot(p[1], p[2] - 1.3)));
    return least;
  };
  const double hard = nearest();
  options.softness = 0.5;
  CHECK(hard < 0.15 && nearest() > 2 * hard);
  options.constraint_points = {{0, 0, 30}};
  CHECK(mc::try_complete(mesh, options).status() == mc::Status::invalid_option);
  options.constraint_points.clear();
  options.softness = 0;
  options.method = mc::Method::coherent;
  options.exemplar = make_twin();
  options.exemplar_parts = {5, 5};
  CHECK(mc::try_complete(mesh, options).status() == mc::Status::invalid_option);
  options.exemplar_parts = {static_cast<std::uint32_t>(options.exemplar.vertices.size())};
  CHECK(mc::complete(mesh, options).filled_count() == 2);
}

// The twin's own vertices; and rim vertices that are none.
void check_part() {
  const Ball<double> ball = broken<double>();
  const auto mesh = mc::view(ball.vertices, ball.faces);
  mc::Options options;
  options.part = true;
  options.method = mc::Method::warp;
  CHECK(mc::try_complete(mesh, options).status() == mc::Status::invalid_option);
  options.part = false;
  CHECK(mc::complete(mesh, options).filled_count() == 2);
  options.loose_vertices = {UINT32_MAX};
  CHECK(mc::try_complete(mesh, options).status() == mc::Status::invalid_option);
}

}  // namespace

void test_guidance() {
  make_ball(&bumpy, 1);
  add_bumps(bumpy.vertices, VERTICES);
  make_whole_ball(&whole);
  add_bumps(whole.vertices, WHOLE_VERTICES);
  check_placement<float>();
  check_placement<double>();
  check_candidates();
  check_points<float>();
  check_points<double>();
  check_part();
}
