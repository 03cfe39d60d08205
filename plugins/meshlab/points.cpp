// SPDX-License-Identifier: GPL-3.0-or-later
#include "points.h"

#include <cmath>

#include "report.h"

namespace mc = mesh_completion;
using vcg::tri::UpdateSelection;

namespace {

// Packed; none if no point has one. A file without them leaves zeros, which are unknown.
std::vector<Scalarm> normals_of(const CMeshO& mesh) {
  std::vector<Scalarm> normals;
  bool known = false;
  for (const CVertexO& vertex : mesh.vert) {
    const Point3m normal = vertex.cN();
    known = known || normal.Norm() > 0;
    for (int k = 0; k < 3; ++k) normals.push_back(normal[k]);
  }
  if (!known) normals.clear();
  return normals;
}

// By the number of points of the rim, and by selected points on it. A border is closed only if one of
// its points is selected.
std::vector<std::uint32_t> choose_holes(const CMeshO& mesh, const mc::Holes& holes, int max_size,
                                        bool selected) {
  std::vector<std::uint32_t> chosen;
  for (const mc::Hole& hole : holes) {
    bool touches = false;
    for (std::size_t l = 0; l < hole.loop_count; ++l)
      for (const std::uint32_t v : holes.loop(hole.id, l)) touches = touches || mesh.vert[v].IsS();
    if ((selected ? touches : !hole.is_border) &&
        (max_size <= 0 || hole.edge_count <= std::size_t(max_size)))
      chosen.push_back(hole.id);
  }
  return chosen;
}

void add_points(MeshModel& model, const mc::Result<Scalarm>& result) {
  CMeshO& mesh = model.cm;
  const std::size_t old = mesh.vert.size();
  const auto points = result.new_vertices();
  const auto normals = result.new_point_normals();
  if (points.empty()) return;
  vcg::tri::Allocator<CMeshO>::AddVertices(mesh, int(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      mesh.vert[old + i].P()[k] = points[i][k];
      mesh.vert[old + i].N()[k] = Scalarm(normals[i][k]);
    }
  vcg::tri::UpdateBounding<CMeshO>::Box(mesh);
}

}  // namespace

Outcome fill_points(MeshModel& model, const RichParameterList& parameters, const Carried& carried,
                    mc::Options options) {
  CMeshO& mesh = model.cm;
  const auto coloring = Coloring(parameters.getEnum("Color"));
  Outcome outcome;
  if (coloring == Coloring::rim) {
    outcome.error = "\"Color of the new vertices\": without faces there is no rim to continue colors "
                    "from; choose \"With the shape\"";
    return outcome;
  }
  const auto normals = normals_of(mesh);
  const Scalarm* given = normals.empty() ? nullptr : normals.data();
  const auto cloud = view_of(mesh, {});
  const int max_size = parameters.getInt("MaxHoleSize");
  const bool selected = parameters.getBool("Selected");
  if (max_size > 0 || selected) {
    const auto holes = mc::try_list_point_holes(cloud, given, options);
    if (!holes) return failed(mesh, holes.failure());
    options.selection = mc::Selection::ids;
    options.selection_ids = choose_holes(mesh, *holes, max_size, selected);
  }
  const auto result = mc::try_complete_points(cloud, given, options);
  if (!result) return failed(mesh, result.failure());

  add_points(model, *result);
  carried.take(mesh, *result);
  color_by_result(model, *result, coloring, [&result](std::size_t i) {
    const std::uint32_t point = result->new_point_source_points()[i];
    return point == mc::none ? std::vector<std::uint32_t>() : std::vector<std::uint32_t>{point};
  });
  if (parameters.getBool("NewFaceSelected")) {
    UpdateSelection<CMeshO>::VertexClear(mesh);
    for (std::size_t v = result->input_vertex_count(); v < mesh.vert.size(); ++v) mesh.vert[v].SetS();
  }
  report(*result, "points", outcome);
  return outcome;
}
