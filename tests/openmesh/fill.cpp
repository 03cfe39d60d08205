// The fill is the C call's, to the bit; what was there is as it was; it survives OpenMesh's files.
#include <cstdio>

#include "suite.hpp"

namespace {

using om::detail::ScalarOf;

// The C function, from arrays that the adapter has not seen.
template <class Mesh>
complete_mesh_result* fill_in_c() {
  using Scalar = ScalarOf<Mesh>;
  static struct ball ball;
  make_ball(&ball, 1);
  std::vector<Scalar> vertices(&ball.vertices[0][0], &ball.vertices[0][0] + 3 * VERTICES);
  complete_mesh_options opts;
  complete_mesh_options_init(&opts, sizeof opts);
  opts.vertex_type = sizeof(Scalar) == 8 ? COMPLETE_MESH_VERTEX_TYPE_F64 : COMPLETE_MESH_VERTEX_TYPE_F32;
  complete_mesh_result* result = nullptr;
  CHECK(complete_mesh(vertices.data(), VERTICES, ball.faces[0], FACES, &opts, &result) == COMPLETE_MESH_STATUS_OK);
  return result;
}

template <class Mesh>
void check_against_c(const Mesh& mesh, const om::Fill<Mesh>& fill, const complete_mesh_result* c) {
  using Scalar = ScalarOf<Mesh>;
  const std::size_t nv = complete_mesh_result_vertex_count(c), nf = complete_mesh_result_face_count(c);
  const auto* points = static_cast<const Scalar*>(complete_mesh_result_vertices(c));
  const std::uint32_t* faces = complete_mesh_result_faces(c);
  if (!CHECK(nv > VERTICES && mesh.n_vertices() == nv && mesh.n_faces() == nf)) return;
  CHECK(fill.vertices.size() == nv - VERTICES && fill.faces.size() == nf - FACES);
  std::size_t wrong_points = 0, wrong_faces = 0, wrong_handles = 0;
  for (std::size_t i = 0; i < nv; ++i) {
    const auto& p = mesh.point(VertexHandle(static_cast<int>(i)));
    wrong_points += std::memcmp(&p[0], points + 3 * i, 3 * sizeof(Scalar)) != 0;
    wrong_handles += fill.vertex(static_cast<std::uint32_t>(i)).idx() != static_cast<int>(i);
    if (i >= VERTICES) wrong_handles += fill.vertices[i - VERTICES].idx() != static_cast<int>(i);
  }
  for (std::size_t i = 0; i < nf; ++i) {
    const FaceHandle f = fill.face(static_cast<std::uint32_t>(i));
    if (i >= FACES) wrong_handles += f != fill.faces[i - FACES];
    // a face may begin at another corner, but must run the same way
    auto got = corners(mesh, f);
    for (int turn = 0; turn < 3 && got[0].idx() != static_cast<int>(faces[3 * i]); ++turn)
      got = {got[1], got[2], got[0]};
    for (std::size_t k = 0; k < 3; ++k) wrong_faces += got[k].idx() != static_cast<int>(faces[3 * i + k]);
  }
  CHECK(wrong_points == 0);
  CHECK(wrong_faces == 0);
  CHECK(wrong_handles == 0);
}

template <class Mesh>
void check_files(const Mesh& mesh, const char* ending) {
  const std::string path = std::string("written_") + (sizeof(ScalarOf<Mesh>) == 8 ? "double." : "float.") + ending;
  Mesh read;
  CHECK(OpenMesh::IO::write_mesh(mesh, path, OpenMesh::IO::Options::Binary, 17));
  if (!CHECK(OpenMesh::IO::read_mesh(read, path))) return;
  CHECK(read.n_vertices() == mesh.n_vertices() && read.n_faces() == mesh.n_faces());
  std::size_t wrong = 0;
  for (const auto v : mesh.vertices())  // files have floats
    for (std::size_t k = 0; k < 3; ++k)
      wrong += static_cast<float>(read.point(v)[k]) != static_cast<float>(mesh.point(v)[k]);
  CHECK(wrong == 0 && count_boundary(read) == 0);
  std::remove(path.c_str());
}

}  // namespace

template <class Mesh>
void test_fill() {
  Mesh mesh;
  const Custom<Mesh> custom = make_ball_mesh(mesh);
  CHECK(count_boundary(mesh) == CAP_EDGES + PATCH_EDGES);
  const Snapshot<Mesh> before(mesh, custom, VERTICES, FACES);
  const om::HoleList list = om::list_holes(mesh);
  CHECK(list.holes.size() == 2 && list.loop(list.holes, 0, 0).size() == list.holes[0].edge_count);

  const om::Fill<Mesh> fill = om::complete(mesh);
  CHECK(before == Snapshot<Mesh>(mesh, custom, VERTICES, FACES));
  CHECK(count_boundary(mesh) == 0 && fill.result.filled_count() == 2);
  complete_mesh_result* c = fill_in_c<Mesh>();
  check_against_c(mesh, fill, c);
  complete_mesh_result_free(c);
  for (const char* ending : {"ply", "off", "om"}) check_files(mesh, ending);

  const auto nothing = om::complete(mesh);
  CHECK(nothing.vertices.empty() && nothing.faces.empty() && nothing.result.filled_count() == 0);
}

template void test_fill<FloatMesh>();
template void test_fill<DoubleMesh>();
