// The mesh of the tests and what they need of it; each test runs for both kernels.
#ifndef SUITE_HPP
#define SUITE_HPP

#include <OpenMesh/Core/IO/MeshIO.hh>  // before the mesh types

#include <complete_mesh_openmesh.hpp>

#include "check.hpp"

extern "C" {
#include "ball.h"
}

namespace mc = mesh_completion;
namespace om = mesh_completion::openmesh;
using om::FaceHandle;
using om::VertexHandle;

// Float: as OpenMesh has it by default. Double: with colours of another type, too.
using FloatMesh = OpenMesh::TriMesh_ArrayKernelT<>;
struct DoubleTraits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
  using Normal = OpenMesh::Vec3d;
  using Color = OpenMesh::Vec4f;
};
using DoubleMesh = OpenMesh::TriMesh_ArrayKernelT<DoubleTraits>;

// A custom property of each kind of element, as an application has them.
template <class Mesh>
inline constexpr std::size_t colour_size = OpenMesh::vector_traits<typename Mesh::Color>::size_;
template <class Mesh>
inline constexpr bool colours_are_bytes = sizeof(typename OpenMesh::vector_traits<typename Mesh::Color>::value_type) == 1;

template <class Mesh>
struct Custom {
  OpenMesh::VPropHandleT<int> label;
  OpenMesh::FPropHandleT<std::string> material;
};

// The ball of the C tests with everything that a mesh can carry, each value from its index.
template <class Mesh>
Custom<Mesh> make_ball_mesh(Mesh& mesh) {
  static struct ball ball;
  make_ball(&ball, 1);
  mesh.request_vertex_colors();
  mesh.request_vertex_normals();
  mesh.request_vertex_status();
  mesh.request_edge_status();
  mesh.request_face_colors();
  mesh.request_face_normals();
  mesh.request_face_status();
  Custom<Mesh> custom;
  mesh.add_property(custom.label, "label");
  mesh.add_property(custom.material, "material");
  for (int i = 0; i < VERTICES; ++i) {
    const float* p = ball.vertices[i];
    const VertexHandle v = mesh.add_vertex(typename Mesh::Point(p[0], p[1], p[2]));
    typename Mesh::Color colour;
    for (std::size_t c = 0; c < OpenMesh::vector_traits<typename Mesh::Color>::size_; ++c)
      colour[c] = static_cast<decltype(colour[c] + 0)>((i * 7 + static_cast<int>(c) * 31) % 200 + 20);
    mesh.set_color(v, colour);
    // not the geometry's normal, to see that it is kept
    mesh.set_normal(v, typename Mesh::Normal(p[2], p[0], p[1]));
    mesh.status(v).set_tagged(i % 3 == 0);
    mesh.property(custom.label, v) = i % 5;
  }
  for (int f = 0; f < FACES; ++f) {
    const std::uint32_t* c = ball.faces[f];
    const FaceHandle face = mesh.add_face(VertexHandle(static_cast<int>(c[0])), VertexHandle(static_cast<int>(c[1])),
                                          VertexHandle(static_cast<int>(c[2])));
    CHECK(face.idx() == f);
    typename Mesh::Color colour;
    for (std::size_t k = 0; k < OpenMesh::vector_traits<typename Mesh::Color>::size_; ++k)
      colour[k] = static_cast<decltype(colour[k] + 0)>((f * 11 + static_cast<int>(k)) % 250);
    mesh.set_color(face, colour);
    mesh.set_normal(face, typename Mesh::Normal(0, 0, 1));
    mesh.status(face).set_tagged(f % 4 == 0);
    mesh.property(custom.material, face) = "material " + std::to_string(f % 6);
  }
  return custom;
}

template <class Mesh>
std::array<VertexHandle, 3> corners(const Mesh& mesh, FaceHandle f) {
  std::array<VertexHandle, 3> all;
  std::size_t k = 0;
  for (auto v = mesh.cfv_begin(f); v.is_valid() && k < 3; ++v) all[k++] = *v;
  return all;
}

template <class Mesh>
std::size_t count_boundary(const Mesh& mesh) {
  std::size_t n = 0;
  for (const auto e : mesh.edges()) n += mesh.is_boundary(e);
  return n;
}

// Everything that a mesh says of itself, to compare before and after.
template <class Mesh>
struct Snapshot {
  std::vector<typename Mesh::Point> points;
  std::vector<typename Mesh::Normal> normals, face_normals;
  std::vector<typename Mesh::Color> colours, face_colours;
  std::vector<unsigned> status, face_status;
  std::vector<int> labels, links;
  std::vector<std::string> materials;
  std::vector<std::array<VertexHandle, 3>> faces;

  Snapshot(const Mesh& mesh, const Custom<Mesh>& custom, int vertices, int face_count) {
    for (int i = 0; i < vertices; ++i) {
      const VertexHandle v(i);
      points.push_back(mesh.point(v));
      normals.push_back(mesh.normal(v));
      colours.push_back(mesh.color(v));
      status.push_back(mesh.status(v).bits());
      labels.push_back(mesh.property(custom.label, v));
    }
    for (int i = 0; i < face_count; ++i) {
      const FaceHandle f(i);
      faces.push_back(corners(mesh, f));
      face_normals.push_back(mesh.normal(f));
      face_colours.push_back(mesh.color(f));
      face_status.push_back(mesh.status(f).bits());
      materials.push_back(mesh.property(custom.material, f));
    }
  }
  bool operator==(const Snapshot& o) const {
    return points == o.points && normals == o.normals && face_normals == o.face_normals &&
           colours == o.colours && face_colours == o.face_colours && status == o.status &&
           face_status == o.face_status && labels == o.labels && materials == o.materials &&
           faces == o.faces;
  }
};

// How everything is linked, for a mesh that must be as it was.
template <class Mesh>
std::vector<int> all_links(const Mesh& mesh) {
  std::vector<int> links = {int(mesh.n_vertices()), int(mesh.n_edges()), int(mesh.n_faces())};
  for (const auto v : mesh.all_vertices()) links.push_back(mesh.halfedge_handle(v).idx());
  for (const auto h : mesh.all_halfedges()) {
    links.push_back(mesh.next_halfedge_handle(h).idx());
    links.push_back(mesh.prev_halfedge_handle(h).idx());
    links.push_back(mesh.face_handle(h).idx());
    links.push_back(mesh.to_vertex_handle(h).idx());
  }
  for (const auto f : mesh.all_faces()) links.push_back(mesh.halfedge_handle(f).idx());
  return links;
}

template <class Mesh>
void test_fill();
template <class Mesh>
void test_attributes();
template <class Mesh>
void test_deleted();
template <class Mesh>
void test_sources();
template <class Mesh>
void test_failures();

#endif
