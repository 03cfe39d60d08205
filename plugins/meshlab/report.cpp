// SPDX-License-Identifier: GPL-3.0-or-later
#include "report.h"

#include <cstdio>
#include <cstring>

namespace mc = mesh_completion;
using vcg::tri::UpdateSelection;

namespace {

// What the dialog calls an option that the library refuses.
std::string label_of(const std::string& message) {
  static const char* const labels[][2] = {
      {"option sizing", "Size of the new triangles"}, {"option candidate", "Candidate"},
      {"option scales", "Least and greatest scale"},  {"option placement", "Place of the source"},
      {"option points", "Pass through points of layer"}, {"option softness", "Softness"},
      {"option sources", "Copy from layer"}, {"option part", "Missing part"},
      {"option loose", "Loose rim at selected vertices"}, {"option initial", "Start from layer"}};
  for (const auto& label : labels)
    if (message.rfind(label[0], 0) == 0) return "\"" + std::string(label[1]) + "\": ";
  return "";
}

// Shows what is in the way.
void select_elements(CMeshO& mesh, const mc::Failure& failure) {
  UpdateSelection<CMeshO>::VertexClear(mesh);
  UpdateSelection<CMeshO>::FaceClear(mesh);
  for (const std::uint32_t v : failure.vertices) mesh.vert[v].SetS();
  for (const mc::Edge& edge : failure.edges)
    for (const std::uint32_t v : edge) mesh.vert[v].SetS();
  for (const std::uint32_t f : failure.faces) mesh.face[f].SetS();
}

// " and N faces" of a mesh.
std::string and_faces(std::size_t count, const char* kind) {
  return std::strcmp(kind, "points") == 0 ? "" : " and " + std::to_string(count) + " faces";
}

std::string describe(const mc::Hole& hole, const char* kind) {
  char line[200];
  const std::string faces = and_faces(hole.new_face_count, kind);
  if (hole.status != mc::HoleStatus::filled) {
    std::snprintf(line, sizeof line, "hole %u (%zu edges) is left open: ", hole.id, hole.edge_count);
  } else if (hole.source_count == 0) {
    std::snprintf(line, sizeof line, "hole %u (%zu edges): smooth, %zu %s%s new", hole.id,
                  hole.edge_count, hole.new_vertex_count, kind, faces.c_str());
  } else {
    std::snprintf(line, sizeof line,
                  "hole %u (%zu edges): coherent, %u sources, confidence %.2f, %zu %s%s new", hole.id,
                  hole.edge_count, hole.source_count, hole.confidence, hole.new_vertex_count, kind,
                  faces.c_str());
  }
  if (hole.status == mc::HoleStatus::filled && hole.candidate_count > 0) {
    const std::size_t end = std::strlen(line);
    std::snprintf(line + end, sizeof line - end, ", %u candidates found", hole.candidate_count);
  }
  return line;
}

}  // namespace

// P(), not cP(): in 2020.09 cP() returns a copy, whose address dangles.
mc::MeshView<Scalarm> view_of(CMeshO& mesh,
                              const std::vector<std::array<std::uint32_t, 3>>& faces) {
  mc::MeshView<Scalarm> view;
  view.vertices = mesh.vert.empty() ? nullptr : &mesh.vert[0].P()[0];
  view.vertex_count = mesh.vert.size();
  view.vertex_stride = sizeof(CVertexO);
  view.faces = faces.empty() ? nullptr : faces[0].data();
  view.face_count = faces.size();
  return view;
}

Outcome failed(CMeshO& mesh, const mc::Failure& failure) {
  Outcome outcome;
  outcome.error = failure.message;
  if (failure.status == mc::Status::invalid_option)
    outcome.error = label_of(failure.message) + failure.message;
  if (failure.status == mc::Status::unsafe_hole || failure.status == mc::Status::invalid_mesh) {
    select_elements(mesh, failure);
    if (!failure.vertices.empty() || !failure.edges.empty() || !failure.faces.empty())
      outcome.error += " (the elements in the way are selected)";
  }
  if (failure.status == mc::Status::unsafe_hole || failure.status == mc::Status::hole_failed)
    outcome.error += "; to close the other holes, check \"Leave holes open that cannot be closed\"";
  return outcome;
}

void report(const mc::Result<Scalarm>& result, const char* kind, Outcome& outcome) {
  outcome.holes = int(result.holes().size());
  outcome.filled = int(result.filled_count());
  outcome.new_vertices = int(result.new_vertices().size());
  outcome.new_faces = int(result.new_faces().size());
  char line[200];
  std::snprintf(line, sizeof line,
                "Closed %d of %d holes: %d %s%s new, in %.2f s (complete-mesh %s)",
                outcome.filled, outcome.holes, outcome.new_vertices, kind,
                and_faces(result.new_faces().size(), kind).c_str(), result.seconds(),
                mc::version_string());
  outcome.log.push_back(line);
  const std::size_t shown = 20;
  for (const mc::Hole& hole : result.holes()) {
    if (hole.status == mc::HoleStatus::not_selected || hole.status == mc::HoleStatus::open) continue;
    if (outcome.log.size() > shown) {
      outcome.log.push_back("  and more");
      break;
    }
    outcome.log.push_back("  " + describe(hole, kind) + std::string(result.holes().reason(hole.id)));
  }
}
