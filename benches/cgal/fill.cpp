// Fills every hole of a mesh file with CGAL's triangulate_refine_and_fair_hole and prints the CPU
// seconds of those calls alone: neither reading, nor the building of the half-edge structure, nor
// the search for the holes is counted.
//
//   cgal_fill IN.ply [OUT.ply]
//
// Prints one line: CPU seconds, holes, holes that failed, holes that could not be faired, new
// vertices, new faces.

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/border.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/boost/graph/IO/polygon_mesh_io.h>

#include <cstdio>
#include <ctime>
#include <iterator>
#include <vector>

namespace pmp = CGAL::Polygon_mesh_processing;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;

static double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return now.tv_sec + 1e-9 * now.tv_nsec;
}

int main(int argc, char **argv) {
  Mesh mesh;
  if (argc < 2 || !CGAL::IO::read_polygon_mesh(argv[1], mesh)) {
    std::fprintf(stderr, "usage: cgal_fill IN.ply [OUT.ply]\n");
    return 1;
  }
  std::vector<Mesh::Halfedge_index> rims;
  pmp::extract_boundary_cycles(mesh, std::back_inserter(rims));

  std::vector<Mesh::Vertex_index> vertices;
  std::vector<Mesh::Face_index> faces;
  int failed = 0, unfair = 0;
  const double start = cpu_seconds();
  for (Mesh::Halfedge_index rim : rims) {
    const std::size_t before = faces.size();
    // The defaults: density factor sqrt(2), C1, Eigen's solver.
    const bool fair = std::get<0>(pmp::triangulate_refine_and_fair_hole(
        mesh, rim, std::back_inserter(faces), std::back_inserter(vertices)));
    failed += faces.size() == before;
    unfair += !fair;
  }
  const double seconds = cpu_seconds() - start;

  std::printf("%.6f %zu %d %d %zu %zu\n", seconds, rims.size(), failed, unfair, vertices.size(),
              faces.size());
  if (argc > 2 && !CGAL::IO::write_polygon_mesh(argv[2], mesh)) return 1;
  return failed ? 2 : 0;
}
