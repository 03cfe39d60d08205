// Deleted and hidden elements: the same fill as without them, in the mesh's own handles.
#include <algorithm>

#include "suite.hpp"

namespace {

using om::detail::ScalarOf;

// One more hole, around a vertex near the south pole, and a vertex with no face at the very front.
constexpr int FRONT = 0, SOUTH = (RINGS - 4) * AROUND + 5;

template <class Mesh>
Custom<Mesh> make_damaged(Mesh& mesh) {
  const Custom<Mesh> custom = make_ball_mesh(mesh);
  mesh.delete_vertex(VertexHandle(SOUTH), false);
  mesh.delete_vertex(VertexHandle(FRONT), false);
  return custom;
}

// The live elements as arrays, in the handles' order: what the ball is without them.
template <class Mesh>
struct Live {
  std::vector<std::array<ScalarOf<Mesh>, 3>> vertices;
  std::vector<std::array<std::uint32_t, 3>> faces;
  std::vector<int> vertex_of, face_of;

  Live() {
    static struct ball ball;
    make_ball(&ball, 1);
    std::vector<std::uint32_t> number(VERTICES);
    for (int i = 0; i < VERTICES; ++i) {
      if (i == FRONT || i == SOUTH) continue;
      number[static_cast<std::size_t>(i)] = static_cast<std::uint32_t>(vertices.size());
      vertices.push_back({ball.vertices[i][0], ball.vertices[i][1], ball.vertices[i][2]});
      vertex_of.push_back(i);
    }
    for (int f = 0; f < FACES; ++f) {
      const std::uint32_t* c = ball.faces[f];
      if (std::count(c, c + 3, FRONT) + std::count(c, c + 3, SOUTH) > 0) continue;
      faces.push_back({number[c[0]], number[c[1]], number[c[2]]});
      face_of.push_back(f);
    }
  }
};

template <class Mesh>
void same_as_live(const Mesh& mesh, const om::Fill<Mesh>& fill) {
  const Live<Mesh> live;
  const auto expected = mc::complete(mc::view(live.vertices, live.faces));
  const auto points = expected.new_vertices();
  const auto faces = expected.new_faces();
  CHECK(expected.filled_count() == 3 && fill.result.filled_count() == 3);
  if (!CHECK(fill.vertices.size() == points.size() && fill.faces.size() == faces.size())) return;
  std::size_t wrong = 0, wrong_faces = 0, wrong_origins = 0, with_source = 0;
  const auto handle = [&](std::uint32_t v) {
    return v < live.vertex_of.size() ? VertexHandle(live.vertex_of[v]) : fill.vertices[v - live.vertex_of.size()];
  };
  for (std::size_t i = 0; i < points.size(); ++i) {
    wrong += std::memcmp(&mesh.point(fill.vertices[i])[0], points[i].data(), sizeof points[i]) != 0;
    const om::Origin& origin = mesh.property(fill.origins, fill.vertices[i]);
    const std::uint32_t face = expected.new_vertex_source_faces()[i];
    wrong_origins += origin.face.idx() != (face == mc::none ? -1 : live.face_of[face]);
    with_source += face != mc::none;
  }
  for (std::size_t i = 0; i < faces.size(); ++i) {
    auto got = corners(mesh, fill.faces[i]);
    for (int turn = 0; turn < 3 && got[0] != handle(faces[i][0]); ++turn) got = {got[1], got[2], got[0]};
    for (std::size_t k = 0; k < 3; ++k) wrong_faces += got[k] != handle(faces[i][k]);
  }
  CHECK(wrong == 0);
  CHECK(wrong_faces == 0);
  CHECK(wrong_origins == 0 && with_source > 0);
}

// Only when asked for, since handles change.
template <class Mesh>
void garbage_is_collected() {
  Mesh mesh;
  make_damaged(mesh);
  om::Extras extras;
  extras.collect_garbage = true;
  const auto fill = om::complete(mesh, {}, extras);
  CHECK(fill.result.filled_count() == 3 && count_boundary(mesh) == 0);
  CHECK(mesh.n_vertices() == VERTICES - 2 + fill.vertices.size());
  CHECK(fill.vertices[0].idx() == VERTICES - 2);
}

template <class Mesh>
void handles_are_kept() {
  Mesh mesh;
  const Custom<Mesh> custom = make_damaged(mesh);
  const auto live_faces = [&mesh] {
    std::vector<std::array<VertexHandle, 3>> all;
    for (const auto f : mesh.faces())
      if (f.idx() < FACES) all.push_back(corners(mesh, f));
    return all;
  };
  const auto faces = live_faces();
  const Snapshot<Mesh> before(mesh, custom, VERTICES, 0);
  om::Extras extras;
  extras.origins = true;
  const auto fill = om::complete(mesh, {}, extras);
  CHECK(before == Snapshot<Mesh>(mesh, custom, VERTICES, 0));
  CHECK(faces == live_faces() && faces.size() < FACES);
  CHECK(mesh.status(VertexHandle(SOUTH)).deleted() && mesh.status(VertexHandle(FRONT)).deleted());
  CHECK(fill.vertices[0].idx() == VERTICES && fill.faces[0].idx() == FACES);
  CHECK(count_boundary(mesh) == 0);
  same_as_live(mesh, fill);
  // loops name the mesh's vertices: those of the hole around the one that was deleted
  std::size_t holes_at_south = 0;
  for (const mc::Hole& hole : fill.result.holes()) {
    const auto loop = fill.loop(fill.result.holes(), hole.id, 0);
    holes_at_south += loop.size() == 6 && std::count(loop.begin(), loop.end(), VertexHandle(SOUTH + 1)) == 1;
  }
  CHECK(holes_at_south == 1);
  mesh.garbage_collection();
  CHECK(mesh.n_vertices() == VERTICES - 2 + fill.vertices.size() && count_boundary(mesh) == 0);
}

// Vertices in options and failures are the mesh's own.
template <class Mesh>
void options_are_translated() {
  Mesh mesh;
  make_damaged(mesh);
  mc::Options near;
  near.method = mc::Method::smooth;
  near.selection = mc::Selection::near_vertices;
  near.selection_ids = {SOUTH + 1};
  const auto list = om::list_holes(mesh, near);
  std::size_t open = 0;
  for (const mc::Hole& hole : list.holes)
    if (hole.status == mc::HoleStatus::open) {
      ++open;
      const auto loop = list.loop(list.holes, hole.id, 0);
      CHECK(loop.size() == 6 && std::count(loop.begin(), loop.end(), VertexHandle(SOUTH + 1)) == 1);
    }
  CHECK(open == 1);
  const auto fill = om::complete(mesh, near);
  std::size_t wrong = 0;
  for (const VertexHandle v : fill.vertices) wrong += !(mesh.point(v)[2] < -0.7);
  CHECK(fill.result.filled_count() == 1 && !fill.vertices.empty() && wrong == 0);

  near.selection_ids = {SOUTH};
  const auto refused = om::try_complete(mesh, near);
  CHECK(refused.status() == mc::Status::invalid_argument);
  CHECK(refused.failure().message.find("vertex " + std::to_string(SOUTH)) != std::string::npos);
  near.selection_ids = {4000000};
  CHECK(om::try_list_holes(mesh, near).status() == mc::Status::invalid_argument);
  near.selection = mc::Selection::all;
  near.grouping = mc::Grouping::join;
  near.join_vertices = {{SOUTH}};
  CHECK(om::try_complete(mesh, near).status() == mc::Status::invalid_argument);

  mesh.point(VertexHandle(SOUTH + 2))[1] = std::numeric_limits<ScalarOf<Mesh>>::infinity();
  const auto failed = om::try_complete(mesh);
  CHECK(failed.status() == mc::Status::invalid_mesh);
  CHECK(failed.failure().vertices == std::vector<std::uint32_t>{SOUTH + 2});
}

// A loose rim is named by handles: the fill is that of the mesh without its deleted elements.
template <class Mesh>
void loose_vertices_are_translated() {
  Mesh mesh;
  make_damaged(mesh);
  const Live<Mesh> live;
  mc::Options own, others;
  own.method = others.method = mc::Method::smooth;
  const auto list = om::list_holes(mesh, own);
  for (const mc::Hole& hole : list.holes) {
    const auto loop = list.loop(list.holes, hole.id, 0);
    if (std::count(loop.begin(), loop.end(), VertexHandle(SOUTH + 1)) == 0) continue;
    for (const VertexHandle v : loop) {
      own.loose_vertices.push_back(static_cast<std::uint32_t>(v.idx()));
      const auto at = std::find(live.vertex_of.begin(), live.vertex_of.end(), v.idx());
      others.loose_vertices.push_back(static_cast<std::uint32_t>(at - live.vertex_of.begin()));
    }
  }
  if (!CHECK(own.loose_vertices.size() == 6 && own.loose_vertices != others.loose_vertices)) return;
  mc::Options refused = own;
  refused.loose_vertices.push_back(SOUTH);
  CHECK(om::try_complete(mesh, refused).status() == mc::Status::invalid_argument);
  const auto fill = om::complete(mesh, own);
  const auto expected = mc::complete(mc::view(live.vertices, live.faces), others);
  const auto points = expected.new_vertices();
  if (!CHECK(fill.vertices.size() == points.size())) return;
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
    wrong += std::memcmp(&mesh.point(fill.vertices[i])[0], points[i].data(), sizeof points[i]) != 0;
  CHECK(wrong == 0);
}

// A deleted vertex may lie anywhere, even nowhere.
template <class Mesh>
void deleted_points_do_not_count() {
  Mesh mesh;
  make_damaged(mesh);
  mesh.point(VertexHandle(SOUTH))[0] = std::numeric_limits<ScalarOf<Mesh>>::quiet_NaN();
  mc::Options smooth;
  smooth.method = mc::Method::smooth;
  CHECK(om::try_complete(mesh, smooth).has_value());
}

template <class Mesh>
void hidden_faces_are_no_holes() {
  Mesh mesh;
  make_ball_mesh(mesh);
  mesh.status(FaceHandle(FACES / 2)).set_hidden(true);
  mesh.status(VertexHandle(SOUTH)).set_hidden(true);
  CHECK(om::list_holes(mesh).holes.size() == 2);
}

}  // namespace

template <class Mesh>
void test_deleted() {
  handles_are_kept<Mesh>();
  garbage_is_collected<Mesh>();
  options_are_translated<Mesh>();
  loose_vertices_are_translated<Mesh>();
  deleted_points_do_not_count<Mesh>();
  hidden_faces_are_no_holes<Mesh>();
}

template void test_deleted<FloatMesh>();
template void test_deleted<DoubleMesh>();
