// SPDX-License-Identifier: GPL-3.0-or-later
//
// From a MeshLab layer to the library and back.
#include "fill.h"

#include <complete_mesh.hpp>
#include <cstdio>
#include <set>

#include "attributes.h"

namespace mc = mesh_completion;
using vcg::tri::Allocator;
using vcg::tri::UpdateSelection;

namespace {

std::vector<std::array<std::uint32_t, 3>> faces_of(const CMeshO& mesh) {
  std::vector<std::array<std::uint32_t, 3>> faces(mesh.face.size());
  // Faces hold pointers to their vertices.
  for (std::size_t i = 0; i < faces.size(); ++i)
    for (int k = 0; k < 3; ++k)
      faces[i][k] = std::uint32_t(vcg::tri::Index(mesh, mesh.face[i].cV(k)));
  return faces;
}

// The positions where they lie. P(), not cP(): in 2020.09 cP() returns a copy, whose address dangles.
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

// As "Close Holes" chooses: by the number of edges, and by the selected faces at the rim.
std::vector<std::uint32_t> choose_holes(const CMeshO& mesh, const mc::Holes& holes, int max_size,
                                        bool selected) {
  std::set<std::pair<std::size_t, std::size_t>> selected_edges;
  for (const CFaceO& face : mesh.face)
    for (int k = 0; face.IsS() && k < 3; ++k)
      selected_edges.insert({vcg::tri::Index(mesh, face.cV(k)),
                             vcg::tri::Index(mesh, face.cV((k + 1) % 3))});
  std::vector<std::uint32_t> chosen;
  for (const mc::Hole& hole : holes) {
    bool touches = !selected;
    for (std::size_t l = 0; l < hole.loop_count && !touches; ++l) {
      const auto loop = holes.loop(hole.id, l);
      // A loop runs as a new face does; the face beyond runs the other way.
      for (std::size_t i = 0; i < loop.size() && !touches; ++i)
        touches = selected_edges.count({loop[(i + 1) % loop.size()], loop[i]}) > 0;
    }
    if (touches && (max_size <= 0 || hole.edge_count <= std::size_t(max_size)))
      chosen.push_back(hole.id);
  }
  return chosen;
}

mc::Options options_of(const RichParameterList& parameters, vcg::CallBackPos* progress) {
  mc::Options options;
  const mc::Method methods[] = {mc::Method::coherent, mc::Method::smooth, mc::Method::harary};
  const int method = parameters.getEnum("Method");
  // A script may have any number there, which the library then refuses.
  options.method = method >= 0 && method < 3 ? methods[method] : mc::Method(method);
  const double scale = parameters.getFloat("EdgeScale");
  if (scale != 1) {
    options.sizing = mc::Sizing::scaled;
    options.sizing_value = scale;
  }
  options.skip_unsafe = parameters.getBool("SkipUnsafe");
  options.output = mc::Output::new_only;
  if (progress)
    options.progress = [progress](double fraction, const char* stage) {
      return progress(int(100 * fraction), stage) ? mc::Next::go_on : mc::Next::cancel;
    };
  return options;
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

Outcome failed(CMeshO& mesh, const mc::Failure& failure) {
  Outcome outcome;
  outcome.error = failure.message;
  // The one number of the dialog that has a range.
  if (failure.status == mc::Status::invalid_option)
    outcome.error = "\"Size of the new triangles\": " + failure.message;
  if (failure.status == mc::Status::unsafe_hole || failure.status == mc::Status::invalid_mesh) {
    select_elements(mesh, failure);
    if (!failure.vertices.empty() || !failure.edges.empty() || !failure.faces.empty())
      outcome.error += " (the elements in the way are selected)";
  }
  if (failure.status == mc::Status::unsafe_hole || failure.status == mc::Status::hole_failed)
    outcome.error += "; to close the other holes, check \"Leave holes open that cannot be closed\"";
  return outcome;
}

void add_elements(CMeshO& mesh, const mc::Result<Scalarm>& result) {
  const std::size_t old_vertices = mesh.vert.size(), old_faces = mesh.face.size();
  const auto points = result.new_vertices();
  const auto faces = result.new_faces();
  if (!points.empty()) Allocator<CMeshO>::AddVertices(mesh, int(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i)
    for (int k = 0; k < 3; ++k) mesh.vert[old_vertices + i].P()[k] = points[i][k];
  if (!faces.empty()) Allocator<CMeshO>::AddFaces(mesh, int(faces.size()));
  for (std::size_t i = 0; i < faces.size(); ++i)
    for (int k = 0; k < 3; ++k) mesh.face[old_faces + i].V(k) = &mesh.vert[faces[i][k]];
}

void update_topology(MeshModel& model) {
  if (model.hasDataMask(MeshModel::MM_FACEFACETOPO))
    vcg::tri::UpdateTopology<CMeshO>::FaceFace(model.cm);
  if (model.hasDataMask(MeshModel::MM_VERTFACETOPO))
    vcg::tri::UpdateTopology<CMeshO>::VertexFace(model.cm);
  vcg::tri::UpdateBounding<CMeshO>::Box(model.cm);
}

std::string describe(const mc::Hole& hole) {
  char line[200];
  if (hole.status != mc::HoleStatus::filled) {
    std::snprintf(line, sizeof line, "hole %u (%zu edges) is left open: ", hole.id, hole.edge_count);
  } else if (hole.source_count == 0) {
    std::snprintf(line, sizeof line, "hole %u (%zu edges): smooth, %zu vertices and %zu faces new",
                  hole.id, hole.edge_count, hole.new_vertex_count, hole.new_face_count);
  } else {
    std::snprintf(line, sizeof line,
                  "hole %u (%zu edges): coherent, %u sources, confidence %.2f, %zu vertices and "
                  "%zu faces new",
                  hole.id, hole.edge_count, hole.source_count, hole.confidence,
                  hole.new_vertex_count, hole.new_face_count);
  }
  return line;
}

void report(const mc::Result<Scalarm>& result, Outcome& outcome) {
  outcome.holes = int(result.holes().size());
  outcome.filled = int(result.filled_count());
  outcome.new_vertices = int(result.new_vertices().size());
  outcome.new_faces = int(result.new_faces().size());
  char line[200];
  std::snprintf(line, sizeof line,
                "Closed %d of %d holes: %d vertices and %d faces new, in %.2f s (complete-mesh %s)",
                outcome.filled, outcome.holes, outcome.new_vertices, outcome.new_faces,
                result.seconds(), mc::version_string());
  outcome.log.push_back(line);
  const std::size_t shown = 20;
  for (const mc::Hole& hole : result.holes()) {
    if (hole.status == mc::HoleStatus::not_selected || hole.status == mc::HoleStatus::open) continue;
    if (outcome.log.size() > shown) {
      outcome.log.push_back("  and more");
      break;
    }
    outcome.log.push_back("  " + describe(hole) + std::string(result.holes().reason(hole.id)));
  }
}

}  // namespace

Outcome fill_holes(MeshModel& model, const RichParameterList& parameters,
                   vcg::CallBackPos* progress) {
  CMeshO& mesh = model.cm;
  // Deleted elements stay in the arrays until then: an index must be a position.
  Allocator<CMeshO>::CompactEveryVector(mesh);
  const auto faces = faces_of(mesh);
  mc::Options options = options_of(parameters, progress);

  const auto completer = mc::Completer<Scalarm>::make(view_of(mesh, faces), options);
  if (!completer) return failed(mesh, completer.failure());
  const int max_size = parameters.getInt("MaxHoleSize");
  const bool selected = parameters.getBool("Selected");
  if (max_size > 0 || selected) {
    options.selection = mc::Selection::ids;
    options.selection_ids = choose_holes(mesh, completer->holes(), max_size, selected);
  }
  const auto coloring = Coloring(parameters.getEnum("Color"));
  give_values(model, coloring, options);
  const auto result = completer->try_complete(options);
  if (!result) return failed(mesh, result.failure());

  const Attributes attributes(model, *result, faces);
  add_elements(mesh, *result);
  attributes.apply(model, coloring);
  update_topology(model);
  if (parameters.getBool("NewFaceSelected")) {
    UpdateSelection<CMeshO>::FaceClear(mesh);
    for (std::size_t i = faces.size(); i < mesh.face.size(); ++i) mesh.face[i].SetS();
  }
  Outcome outcome;
  report(*result, outcome);
  return outcome;
}
