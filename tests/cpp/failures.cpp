// Failures as exceptions and as outcomes, with the elements that they name.
#include <limits>
#include <string>

#include "suite.hpp"

namespace {

// Two triangles that touch in vertex 4, and so do their boundary loops.
struct Bow {
  Points<float> vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5f, 0.5f, 0}};
  Faces faces = {{0, 1, 4}, {2, 3, 4}};
};

void check_elements() {
  const Bow bow;
  const auto mesh = mc::view(bow.vertices, bow.faces);
  const auto outcome = mc::try_complete(mesh);
  CHECK(!outcome && !outcome.has_value() && outcome.status() == mc::Status::unsafe_hole);
  const mc::Failure& failure = outcome.failure();
  CHECK(failure.status == mc::Status::unsafe_hole && !failure.thrown);
  CHECK(failure.message == complete_mesh_last_error_message() && !failure.message.empty());
  CHECK(failure.vertices == std::vector<std::uint32_t>{4});
  CHECK(failure.holes == std::vector<std::uint32_t>{0});
  bool caught = false;
  try {
    mc::complete(mesh);
  } catch (const mc::Error& error) {
    caught = true;
    CHECK(error.status() == mc::Status::unsafe_hole && error.what() == failure.message);
    CHECK(error.failure().vertices == failure.vertices && error.failure().holes == failure.holes);
    const mc::Error copy = error;
    CHECK(copy.failure().message == failure.message);
  }
  CHECK(caught);
  const mc::Holes holes = mc::list_holes(mesh);
  CHECK(holes.size() == 2 && holes[1].is_unsafe && holes.reason(1) != "");
  CHECK(holes.problem_vertices(1).size() == 1 && holes.problem_vertices(1)[0] == 4);
}

// An edge with three faces at the rim; faces that run the wrong way, twice name a vertex, and
// vertices at one place: compared with the C functions.
void check_oddities() {
  Ball<float> ball = make_ball_of<float>();
  ball.vertices.push_back({0, 0, 2});
  const auto top = static_cast<std::uint32_t>(ball.vertices.size() - 1);
  ball.faces.push_back({0, 1, top});
  ball.faces.push_back({1, 0, top});
  ball.faces.push_back({5, 5, 6});
  ball.vertices.push_back(ball.vertices[8]);
  ball.faces.push_back({9, top + 1, 10});
  const auto outcome = mc::try_list_holes(mc::view(ball.vertices, ball.faces));
  if (!CHECK(outcome)) return;
  const mc::Holes& holes = *outcome;
  std::size_t n = 0;
  const std::uint32_t* p = complete_mesh_holes_non_manifold_edges(holes.get(), &n);
  CHECK(same_bytes(holes.non_manifold_edges(), p, n, 8));
  p = complete_mesh_holes_degenerate_faces(holes.get(), &n);
  CHECK(same_bytes(holes.degenerate_faces(), p, n, 4));
  CHECK(holes.degenerate_faces()[0] == FACES + 2);
  p = complete_mesh_holes_duplicate_vertices(holes.get(), &n);
  CHECK(same_bytes(holes.duplicate_vertices(), p, n, 8));
  p = complete_mesh_holes_inconsistent_edges(holes.get(), &n);
  CHECK(holes.inconsistent_edges().size() == n && holes.inconsistent_edges().data() == p);
  std::size_t problems = 0;
  for (std::size_t id = 0; id < holes.size(); ++id) {
    p = complete_mesh_holes_problem_elements(holes.get(), id, COMPLETE_MESH_ELEMENT_KIND_EDGE, &n);
    CHECK(holes.problem_edges(id).size() == n && holes.problem_edges(id).data() == p);
    problems += n;
    p = complete_mesh_holes_problem_elements(holes.get(), id, COMPLETE_MESH_ELEMENT_KIND_FACE, &n);
    CHECK(holes.problem_faces(id).size() == n && holes.problem_faces(id).data() == p);
  }
  CHECK(problems > 0);
  const auto filled = mc::try_complete(mc::view(ball.vertices, ball.faces));
  CHECK(filled.status() == mc::Status::unsafe_hole && !filled.failure().edges.empty());
  p = complete_mesh_last_error_elements(COMPLETE_MESH_ELEMENT_KIND_EDGE, &n);
  CHECK(same_bytes(filled.failure().edges, p, n, 8));
}

void check_statuses() {
  Ball<double> ball = make_ball_of<double>();
  mc::Options options;
  options.method = mc::Method::smooth;
  options.sizing = mc::Sizing::scaled;
  options.sizing_value = 1000;
  CHECK(mc::try_complete(mc::view(ball.vertices, ball.faces), options).status() == mc::Status::invalid_option);
  options.sizing_value = 1;
  options.selection = mc::Selection::ids;
  options.selection_ids = {42};
  const auto missing = mc::try_complete(mc::view(ball.vertices, ball.faces), options);
  CHECK(missing.status() == mc::Status::no_such_hole);
  ball.vertices[3][1] = std::numeric_limits<double>::quiet_NaN();
  const auto invalid = mc::try_complete(mc::view(ball.vertices, ball.faces));
  CHECK(invalid.status() == mc::Status::invalid_mesh);
  CHECK(invalid.failure().vertices == std::vector<std::uint32_t>{3});
  CHECK(mc::try_list_holes(mc::view(ball.vertices, ball.faces)).status() == mc::Status::invalid_mesh);
  CHECK(mc::Completer<double>::make(mc::view(ball.vertices, ball.faces)).status() == mc::Status::invalid_mesh);
  CHECK(mc::try_complete(mc::MeshView<double>{}).status() == mc::Status::invalid_mesh);
  CHECK(std::string(mc::to_string(mc::Status::unsafe_hole)) == "unsafe hole");
  CHECK(std::string(mc::to_string(mc::Status::ok)) == "ok");
  bool caught = false;
  try {
    mc::Completer<double>{mc::view(ball.vertices, ball.faces)};
  } catch (const mc::Error& error) {
    caught = error.status() == mc::Status::invalid_mesh;
  }
  CHECK(caught);
}

}  // namespace

void test_failures() {
  check_elements();
  check_oddities();
  check_statuses();
}
