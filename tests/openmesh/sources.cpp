// What may be copied from, and an initial completion, in the mesh's own handles: with deleted elements
// in front of them, numbers and handles differ.
#include <algorithm>
#include <cmath>

#include "suite.hpp"

namespace {

template <class Mesh>
struct Damaged {
  Mesh mesh;

  Damaged() {
    make_ball_mesh(mesh);
    mesh.delete_vertex(VertexHandle(0), false);
  }
};

// The ball but for its left end, or its right one.
template <class Mesh>
bool may(const Mesh& mesh, FaceHandle f, int side) {
  for (const VertexHandle v : corners(mesh, f))
    if (!(side * mesh.point(v)[0] > -0.5)) return false;
  return true;
}

// How many new vertices were copied from there, and how many from the end that is left out.
template <class Mesh>
std::array<std::size_t, 2> count_places(const mc::Options& options, int side) {
  Mesh mesh = Damaged<Mesh>().mesh;
  om::Extras extras;
  extras.origins = true;
  const auto fill = om::complete(mesh, options, extras);
  std::array<std::size_t, 2> places = {0, 0};
  for (const VertexHandle v : fill.vertices) {
    const FaceHandle f = mesh.property(fill.origins, v).face;
    if (f.is_valid()) ++places[may(mesh, f, side) ? 0 : 1];
  }
  return places;
}

template <class Mesh>
void check_source_faces() {
  Mesh mesh = Damaged<Mesh>().mesh;
  std::size_t without = 0;
  for (const int side : {1, -1}) {
    mc::Options options;
    without += count_places<Mesh>(options, side)[1];
    // a flag is for a handle
    for (const auto f : mesh.all_faces())
      options.source_faces.push_back(!mesh.status(f).deleted() && may(mesh, f, side));
    const auto with = count_places<Mesh>(options, side);
    CHECK(with[0] > 0 && with[1] == 0);
    options.source_faces.pop_back();
    CHECK(om::try_complete(mesh, options).status() == mc::Status::invalid_argument);
  }
  CHECK(without > 0);
}

template <class Mesh>
std::vector<typename Mesh::Point> sorted(const Mesh& mesh, const om::Fill<Mesh>& fill) {
  std::vector<typename Mesh::Point> points;
  for (const VertexHandle v : fill.vertices) points.push_back(mesh.point(v));
  std::sort(points.begin(), points.end());
  return points;
}

// A membrane comes back as it was given, where a smooth fill would be another.
template <class Mesh>
void check_initial() {
  Mesh given = Damaged<Mesh>().mesh, again = given, other = given;
  mc::Options options;
  options.method = mc::Method::smooth;
  const auto of_other = om::complete(other, options);
  options.fairing = mc::Fairing::c0;
  const auto of_given = om::complete(given, options);
  options.fairing = mc::Fairing::automatic;
  for (const VertexHandle v : of_given.vertices) {
    const auto& p = given.point(v);
    options.initial.vertices.push_back({p[0], p[1], p[2]});
  }
  for (const FaceHandle f : of_given.faces) {
    std::array<std::uint32_t, 3> face{};
    const auto at = corners(given, f);
    for (std::size_t k = 0; k < 3; ++k) face[k] = static_cast<std::uint32_t>(at[k].idx());
    options.initial.faces.push_back(face);
  }
  const auto of_again = om::complete(again, options);
  CHECK(!of_given.vertices.empty() && sorted(again, of_again) == sorted(given, of_given));
  CHECK(sorted(other, of_other) != sorted(given, of_given));
  CHECK(count_boundary(again) == 0);
  Mesh refused = Damaged<Mesh>().mesh;
  options.initial.faces[0][0] = 0;  // deleted
  CHECK(om::try_complete(refused, options).status() == mc::Status::invalid_argument);
}

// Copied from another mesh: what its origin says, and colours from the rim.
template <class Mesh>
void check_exemplar() {
  Mesh mesh = Damaged<Mesh>().mesh;
  static struct whole_ball whole;
  make_whole_ball(&whole);
  move_away(&whole, 0);
  mc::Options options;
  options.exemplar = mc::surface(whole.vertices, whole.faces);
  options.exemplar_only = true;
  om::Extras extras;
  extras.origins = true;
  extras.colours = om::Colours::from_source;
  Mesh plain = mesh;
  const auto fill = om::complete(mesh, options, extras);
  extras.colours = om::Colours::from_rim;
  const auto from_rim = om::complete(plain, options, extras);
  std::size_t copied = 0, wrong = 0;
  for (const VertexHandle v : fill.vertices) {
    const om::Origin& origin = mesh.property(fill.origins, v);
    copied += origin.exemplar_face < WHOLE_FACES;
    wrong += origin.face.is_valid() || (origin.exemplar_face != mc::none && origin.exemplar_face >= WHOLE_FACES);
    wrong += mesh.color(v) != plain.color(v) || mesh.point(v) != plain.point(v);
    wrong += !(std::abs(OpenMesh::norm(mesh.point(v)) - 1) < 0.02);
  }
  CHECK(copied > 0);
  CHECK(wrong == 0);
}

// How far new vertices are from a ball with bumps that only its twin shows.
template <class Mesh>
double off_twin(const Mesh& mesh, const om::Fill<Mesh>& fill, const struct whole_ball& whole) {
  std::vector<float> places;
  for (const VertexHandle v : fill.vertices) {
    // the patch has too few vertices to be anything but smooth
    if (!(mesh.point(v)[2] > 0.8)) continue;
    for (std::size_t k = 0; k < 3; ++k) places.push_back(static_cast<float>(mesh.point(v)[k]));
  }
  CHECK(!places.empty());
  return off_whole(&whole, places.data(), places.size() / 3);
}

// The options that guide a fill reach it: a twin placed by hand, one of another size, a point.
template <class Mesh>
void check_guidance() {
  static struct ball ball;
  static struct whole_ball whole;
  make_ball(&ball, 1);
  add_bumps(ball.vertices, VERTICES);
  make_whole_ball(&whole);
  add_bumps(whole.vertices, WHOLE_VERTICES);
  Mesh bumpy = Damaged<Mesh>().mesh;
  for (int v = 0; v < VERTICES; ++v)
    for (std::size_t k = 0; k < 3; ++k)
      bumpy.point(VertexHandle(v))[k] = ball.vertices[v][k];
  mc::Options options;
  options.exemplar = mc::surface(whole.vertices, whole.faces);
  for (auto& p : options.exemplar.vertices)
    for (double& x : p) x = 2 * x + 6;
  options.exemplar_only = true;
  Mesh smooth = bumpy, placed = bumpy, scaled = bumpy;
  const double without = off_twin(smooth, om::complete(smooth, options), whole);
  options.placement = {{0.5, 0, 0, -3, 0, 0.5, 0, -3, 0, 0, 0.5, -3}};
  const auto by_hand = om::complete(placed, options);
  CHECK(off_twin(placed, by_hand, whole) < 1e-4 && without > 1e-3);
  // deleting a vertex has made a third hole; the cap is the one with the most vertices
  std::size_t from_there = 0;
  for (const mc::Hole& hole : by_hand.result.holes()) from_there += hole.source_count == 1;
  CHECK(from_there > 0);
  options.placement.reset();
  options.scale_range = {{0.45, 0.55}};
  CHECK(off_twin(scaled, om::complete(scaled, options), whole) < 0.2 * without);
  mc::Options through;
  through.method = mc::Method::smooth;
  through.constraint_points = {{0, 0, 1.3}};
  const auto bump = om::complete(bumpy, through);
  double nearest = 9;
  for (const VertexHandle v : bump.vertices) {
    const auto& p = bumpy.point(v);
    nearest = std::min(nearest, double(std::sqrt(p[0] * p[0] + p[1] * p[1] + (p[2] - 1.3) * (p[2] - 1.3))));
  }
  CHECK(nearest < 0.15);
}

// A grey mesh whose exemplar is brighter: at the rim what is known there, farther in what the exemplar
// has, as it comes from the library and not from the rim.
template <class Mesh>
void check_colours_of_exemplar() {
  using Component = typename OpenMesh::vector_traits<typename Mesh::Color>::value_type;
  const double unit = colours_are_bytes<Mesh> ? 255 : 1, grey = 0.4 * unit, bright = 0.8 * unit;
  typename Mesh::Color colour;
  for (std::size_t c = 0; c < colour_size<Mesh>; ++c) colour[c] = static_cast<Component>(grey);
  Mesh mesh = Damaged<Mesh>().mesh;
  for (const auto v : mesh.all_vertices()) mesh.set_color(v, colour);
  static struct whole_ball whole;
  make_whole_ball(&whole);
  move_away(&whole, 0);
  mc::Options options;
  options.exemplar = mc::surface(whole.vertices, whole.faces);
  options.exemplar_only = true;
  options.exemplar_values.assign(colour_size<Mesh> * WHOLE_VERTICES, bright);
  om::Extras extras;
  extras.colours = om::Colours::with_shape;
  const auto fill = om::complete(mesh, options, extras);
  double least = unit, most = 0;
  for (const VertexHandle v : fill.vertices)
    for (std::size_t c = 0; c < colour_size<Mesh>; ++c) {
      least = std::min(least, static_cast<double>(mesh.color(v)[c]));
      most = std::max(most, static_cast<double>(mesh.color(v)[c]));
    }
  CHECK(least > grey - 0.01 * unit && most > grey + 0.05 * unit && most < bright + 0.01 * unit);
}

}  // namespace

template <class Mesh>
void test_sources() {
  check_source_faces<Mesh>();
  check_initial<Mesh>();
  check_exemplar<Mesh>();
  check_guidance<Mesh>();
  check_colours_of_exemplar<Mesh>();
}

template void test_sources<FloatMesh>();
template void test_sources<DoubleMesh>();
