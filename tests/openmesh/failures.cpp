// After a failure, a cancel or an exception the mesh is as it was, links and all.
#include "suite.hpp"

namespace {

struct Stop {};

template <class Mesh>
void cancel_and_throw() {
  Mesh mesh;
  const Custom<Mesh> custom = make_ball_mesh(mesh);
  const Snapshot<Mesh> before(mesh, custom, VERTICES, FACES);
  const auto links = all_links(mesh);
  int calls = 0;
  mc::Options options;
  options.method = mc::Method::smooth;
  options.progress = [&calls](double, const char* stage) { calls += stage[0] != 0; };
  Mesh other = mesh;
  CHECK(om::try_complete(other, options).has_value() && calls >= 4);
  int at = 0;
  options.progress = [&](double, const char*) { return ++at == 3 ? mc::Next::cancel : mc::Next::go_on; };
  const auto cancelled = om::try_complete(mesh, options);
  CHECK(cancelled.status() == mc::Status::cancelled && at == 3);
  CHECK(om::try_list_holes(mesh, options).has_value() && at > 3);
  bool caught = false;
  options.progress = [](double, const char*) { throw Stop(); };
  try {
    om::complete(mesh, options);
  } catch (const Stop&) {
    caught = true;
  }
  CHECK(caught);
  options.progress = nullptr;
  options.selection = mc::Selection::ids;
  options.selection_ids = {7};
  caught = false;
  try {
    om::complete(mesh, options);
  } catch (const mc::Error& error) {
    caught = error.status() == mc::Status::no_such_hole;
  }
  CHECK(caught);
  CHECK(all_links(mesh) == links && before == Snapshot<Mesh>(mesh, custom, VERTICES, FACES));
}

// Faces that OpenMesh refuses: the whole fill is undone. OpenMesh says so on standard error.
template <class Mesh>
void refused_faces() {
  for (const bool with_deleted : {false, true}) {
    Mesh mesh;
    const Custom<Mesh> custom = make_ball_mesh(mesh);
    if (with_deleted) mesh.delete_vertex(VertexHandle(RINGS / 2 * AROUND + 20), false);
    const Snapshot<Mesh> before(mesh, custom, VERTICES, 0);
    const auto links = all_links(mesh);
    const auto rim = om::list_holes(mesh);
    const auto loop = rim.loop(rim.holes, 0, 0);
    std::vector<FaceHandle> handles;
    {
      om::detail::Undo<Mesh> undo(mesh);
      const VertexHandle top = mesh.add_vertex(typename Mesh::Point(0, 0, 1));
      std::vector<om::detail::Triangle> triangles;
      for (std::size_t i = 0; i < loop.size(); ++i)
        triangles.push_back({top, loop[i], loop[(i + 1) % loop.size()]});
      triangles.push_back(triangles[2]);
      const auto refused = om::detail::add_faces(mesh, triangles, handles);
      CHECK(refused.has_value() && (*refused)[1] == loop[2] && handles[4].is_valid());
      CHECK(all_links(mesh) != links);
    }
    CHECK(all_links(mesh) == links && before == Snapshot<Mesh>(mesh, custom, VERTICES, 0));
    // and it can be filled as if nothing had been
    mc::Options smooth;
    smooth.method = mc::Method::smooth;
    CHECK(om::try_complete(mesh, smooth).has_value() && count_boundary(mesh) == 0);
  }
}

// An order in which OpenMesh takes each face only after the others have been tried.
template <class Mesh>
void any_order() {
  Mesh mesh;
  make_ball_mesh(mesh);
  const auto rim = om::list_holes(mesh);
  for (std::size_t hole = 0; hole < rim.holes.size(); ++hole) {
    const auto loop = rim.loop(rim.holes, hole, 0);
    const VertexHandle top = mesh.add_vertex(typename Mesh::Point(0, 0, 1));
    std::vector<om::detail::Triangle> triangles;
    for (std::size_t step = 0; step < 7; ++step)
      for (std::size_t i = step; i < loop.size(); i += 7)
        triangles.push_back({top, loop[i], loop[(i + 1) % loop.size()]});
    std::vector<FaceHandle> handles;
    CHECK(!om::detail::add_faces(mesh, triangles, handles));
  }
  CHECK(count_boundary(mesh) == 0);
}

}  // namespace

template <class Mesh>
void test_failures() {
  cancel_and_throw<Mesh>();
  refused_faces<Mesh>();
  any_order<Mesh>();
}

template void test_failures<FloatMesh>();
template void test_failures<DoubleMesh>();
