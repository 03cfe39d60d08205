// SPDX-License-Identifier: MIT OR Apache-2.0
//
// Fills the holes of a mesh file through OpenMesh: reads and writes what OpenMesh reads and writes. Colours
// are completed with the shape and steer the search, as in the command line.
//
//   fill_openmesh IN OUT [--double] [--smooth] [--colours-from-rim]
#include <OpenMesh/Core/IO/MeshIO.hh>  // before the mesh types

#include <complete_mesh_openmesh.hpp>
#include <cstdio>
#include <string>

namespace mc = mesh_completion;

namespace {

struct DoubleTraits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
  using Normal = OpenMesh::Vec3d;
};

struct Request {
  std::string in, out;
  mc::Options options;
  mc::openmesh::Extras extras;
};

// Only what the file has is written again.
template <class Mesh>
int run(const Request& request) {
  Mesh mesh;
  mesh.request_vertex_colors();
  mesh.request_vertex_normals();
  OpenMesh::IO::Options has(OpenMesh::IO::Options::VertexColor | OpenMesh::IO::Options::VertexNormal);
  if (!OpenMesh::IO::read_mesh(mesh, request.in, has)) {
    std::fprintf(stderr, "cannot read %s\n", request.in.c_str());
    return 3;
  }
  if (!has.vertex_has_color()) mesh.release_vertex_colors();
  try {
    const auto fill = mc::openmesh::complete(mesh, request.options, request.extras);
    std::printf("%zu holes filled, %zu new vertices, %zu new faces\n", fill.result.filled_count(),
                fill.vertices.size(), fill.faces.size());
  } catch (const mc::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  OpenMesh::IO::Options write(OpenMesh::IO::Options::Binary);
  if (has.vertex_has_color()) write += OpenMesh::IO::Options::VertexColor;
  if (has.vertex_has_normal()) write += OpenMesh::IO::Options::VertexNormal;
  if (!OpenMesh::IO::write_mesh(mesh, request.out, write)) {
    std::fprintf(stderr, "cannot write %s\n", request.out.c_str());
    return 3;
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Request request;
  request.extras.colours = mc::openmesh::Colours::with_shape;
  bool is_double = false, bad = false;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--double") is_double = true;
    else if (argument == "--smooth") request.options.method = mc::Method::smooth;
    else if (argument == "--colours-from-rim")
      request.extras.colours = mc::openmesh::Colours::from_rim;
    else if (request.in.empty()) request.in = argument;
    else if (request.out.empty()) request.out = argument;
    else bad = true;
  }
  if (bad || request.out.empty()) {
    std::fprintf(stderr, "usage: fill_openmesh IN OUT [--double] [--smooth] [--colours-from-rim]\n");
    return 2;
  }
  return is_double ? run<OpenMesh::TriMesh_ArrayKernelT<DoubleTraits>>(request)
                   : run<OpenMesh::TriMesh_ArrayKernelT<>>(request);
}
