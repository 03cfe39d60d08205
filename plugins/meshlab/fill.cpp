// SPDX-License-Identifier: GPL-3.0-or-later
//
// From a MeshLab layer to the library and back.
#include "fill.h"

#include <complete_mesh.hpp>
#include <set>

#include "attributes.h"
#include "guidance.h"
#include "points.h"
#include "report.h"

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

// Those of some vertices that lie on a rim.
std::vector<std::uint32_t> on_rims(const mc::Holes& holes, const std::vector<std::uint32_t>& vertices) {
  std::set<std::uint32_t> rims;
  for (const mc::Hole& hole : holes)
    for (std::size_t l = 0; l < hole.loop_count; ++l)
      for (const std::uint32_t v : holes.loop(hole.id, l)) rims.insert(v);
  std::vector<std::uint32_t> found;
  for (const std::uint32_t v : vertices)
    if (rims.count(v)) found.push_back(v);
  return found;
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

}  // namespace

Outcome fill_holes(MeshDocument& document, const RichParameterList& parameters,
                   vcg::CallBackPos* progress) {
  MeshModel& model = *document.mm();
  CMeshO& mesh = model.cm;
  // Deleted elements stay in the arrays until then: an index must be a position.
  Allocator<CMeshO>::CompactEveryVector(mesh);
  mc::Options options = options_of(parameters, progress);
  const auto coloring = Coloring(parameters.getEnum("Color"));
  const auto sources = source_layers(document, parameters);
  const Carried carried(model, sources, parameters.getBool("AndMesh"), coloring);
  Outcome outcome;
  outcome.error = set_guidance(document, parameters, sources, carried, options);
  if (outcome.error.empty()) outcome.error = set_rims(document, parameters, options);
  if (!outcome.error.empty()) return outcome;
  carried.give(mesh, options);
  if (mesh.fn == 0) return fill_points(model, parameters, carried, options);

  const auto faces = faces_of(mesh);
  const auto completer = mc::Completer<Scalarm>::make(view_of(mesh, faces), options);
  if (!completer) return failed(mesh, completer.failure());
  if (!options.loose_vertices.empty()) {
    options.loose_vertices = on_rims(completer->holes(), options.loose_vertices);
    if (options.loose_vertices.empty())
      outcome.error = "\"Loose rim at selected vertices\": no selected vertex lies on a rim";
  }
  if (!outcome.error.empty()) return outcome;
  const int max_size = parameters.getInt("MaxHoleSize");
  const bool selected = parameters.getBool("Selected");
  if (max_size > 0 || selected) {
    options.selection = mc::Selection::ids;
    options.selection_ids = choose_holes(mesh, completer->holes(), max_size, selected);
  }
  const auto result = completer->try_complete(options);
  if (!result) return failed(mesh, result.failure());

  const Attributes attributes(model, *result, faces);
  add_elements(mesh, *result);
  attributes.apply(model, carried, coloring);
  update_topology(model);
  if (parameters.getBool("NewFaceSelected")) {
    UpdateSelection<CMeshO>::FaceClear(mesh);
    for (std::size_t i = faces.size(); i < mesh.face.size(); ++i) mesh.face[i].SetS();
  }
  report(*result, "vertices", outcome);
  return outcome;
}
