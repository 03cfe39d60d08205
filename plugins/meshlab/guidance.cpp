// SPDX-License-Identifier: GPL-3.0-or-later
#include "guidance.h"

#include <algorithm>
#include <cstring>

namespace mc = mesh_completion;

namespace {

using Point = std::array<double, 3>;

// Points of another layer as the current one has them.
class Frame {
 public:
  Frame(const MeshModel& current, const MeshModel& other) {
    // Layers that lie alike keep their numbers.
    same_ = std::memcmp(&current.cm.Tr, &other.cm.Tr, sizeof current.cm.Tr) == 0;
    vcg::Matrix44d to_world, ours;
    to_world.Import(other.cm.Tr);
    ours.Import(current.cm.Tr);
    matrix_ = vcg::Inverse(ours) * to_world;
  }
  // Faces of a mirrored layer run the other way round.
  bool mirrors() const { return !same_ && matrix_.Determinant() < 0; }
  Point operator()(const Point3m& p) const {
    vcg::Point3d q(p[0], p[1], p[2]);
    if (!same_) q = matrix_ * q;
    return {q[0], q[1], q[2]};
  }

 private:
  bool same_;
  vcg::Matrix44d matrix_;
};

// The alive elements of a layer, numbered anew.
void append(const Frame& frame, const CMeshO& mesh, mc::Surface& surface) {
  std::vector<std::uint32_t> number(mesh.vert.size(), mc::none);
  for (std::size_t v = 0; v < mesh.vert.size(); ++v) {
    if (mesh.vert[v].IsD()) continue;
    number[v] = std::uint32_t(surface.vertices.size());
    surface.vertices.push_back(frame(mesh.vert[v].cP()));
  }
  for (const CFaceO& face : mesh.face) {
    if (face.IsD()) continue;
    std::array<std::uint32_t, 3> corners;
    for (int k = 0; k < 3; ++k) corners[k] = number[vcg::tri::Index(mesh, face.cV(k))];
    if (frame.mirrors()) std::swap(corners[1], corners[2]);
    surface.faces.push_back(corners);
  }
}

void append_source(const MeshModel& current, const MeshModel& source, const Carried& carried,
                   mc::Options& options) {
  const std::size_t before = options.exemplar.vertices.size();
  append(Frame(current, source), source.cm, options.exemplar);
  options.exemplar_parts.push_back(std::uint32_t(options.exemplar.vertices.size() - before));
  for (const CVertexO& vertex : source.cm.vert)
    if (!vertex.IsD() && carried.of_sources) carried.append(vertex, options.exemplar_values);
}

// What a layer has beyond the current one, each in its own coordinates.
std::string set_initial(const MeshModel& current, const MeshModel& layer, mc::Options& options) {
  mc::Surface whole, own;
  append(Frame(current, current), layer.cm, whole);
  append(Frame(current, current), current.cm, own);
  const std::size_t n = own.vertices.size(), m = own.faces.size();
  if (whole.vertices.size() < n || whole.faces.size() < m ||
      !std::equal(own.vertices.begin(), own.vertices.end(), whole.vertices.begin()) ||
      !std::equal(own.faces.begin(), own.faces.end(), whole.faces.begin()))
    return layer.label().toStdString() +
           " does not begin with the vertices and faces of this layer; choose a duplicate whose holes "
           "were closed, and nothing else changed";
  if (whole.faces.size() == m)
    return layer.label().toStdString() + " has no more faces than this layer";
  options.initial.vertices.assign(whole.vertices.begin() + n, whole.vertices.end());
  options.initial.faces.assign(whole.faces.begin() + m, whole.faces.end());
  return "";
}

// Calls for each layer that is shown.
template <class Function>
void for_visible(const MeshDocument& document, Function function) {
#if ML_API < 202100
  for (const MeshModel* layer : document.meshList)
    if (layer->isVisible()) function(*layer);
#else
  for (const MeshModel& layer : document.meshIterator())
    if (layer.isVisible()) function(layer);
#endif
}

}  // namespace

const MeshModel* other_layer(const MeshDocument& document, const RichParameterList& parameters,
                             const char* name) {
#if ML_API < 202100
  const MeshModel* layer = parameters.getMesh(name);
#else
  const MeshModel* layer = document.getMesh(parameters.getMeshId(name));
#endif
  return layer == document.mm() ? nullptr : layer;
}

std::vector<const MeshModel*> source_layers(const MeshDocument& document,
                                            const RichParameterList& parameters) {
  std::vector<const MeshModel*> layers;
  if (const MeshModel* one = other_layer(document, parameters, "Source")) {
    layers.push_back(one);
  } else if (parameters.getBool("VisibleLayers")) {
    const MeshModel* points = other_layer(document, parameters, "Points");
    const MeshModel* initial = other_layer(document, parameters, "Initial");
    for_visible(document, [&](const MeshModel& layer) {
      if (&layer != document.mm() && &layer != points && &layer != initial) layers.push_back(&layer);
    });
  }
  return layers;
}

std::string set_guidance(const MeshDocument& document, const RichParameterList& parameters,
                         const std::vector<const MeshModel*>& sources, const Carried& carried,
                         mc::Options& options) {
  const MeshModel& current = *document.mm();
  options.unmirrored = !parameters.getBool("Mirror");
  options.candidate = std::uint32_t(std::max(parameters.getInt("Candidate"), 0));
  options.part = parameters.getBool("Part");
  const double least = parameters.getFloat("LeastScale"), most = parameters.getFloat("GreatestScale");
  if (least != 1 || most != 1) options.scale_range = {{least, most}};

  const bool of_mesh = parameters.getBool("AndMesh"), visible = parameters.getBool("VisibleLayers");
  if (visible && other_layer(document, parameters, "Source"))
    return "\"Copy from all other visible layers\": choose the current layer in \"Copy from layer\", or "
           "switch it off";
  if (visible && sources.empty())
    return "\"Copy from all other visible layers\": there is none";
  if (of_mesh && sources.empty())
    return "\"Copy from the mesh itself, too\": choose another layer in \"Copy from layer\"";
  for (const MeshModel* source : sources) {
    if (source->cm.fn == 0)
      return "\"Copy from layer\": " + source->label().toStdString() +
             " is a point layer; choose one with faces";
    append_source(current, *source, carried, options);
  }
  if (sources.size() < 2) options.exemplar_parts.clear();
  options.exemplar_only = !sources.empty() && !of_mesh;
  const int place = parameters.getEnum("Place");
  if (place < 0 || place > 2) return "\"Place of the source\": there is no choice " + std::to_string(place);
  if (place > 0) {
    if (sources.empty())
      return "\"Place of the source\": choose another layer in \"Copy from layer\"";
    if (of_mesh)
      return "\"Copy from the mesh itself, too\": what was put over the hole by hand is the only copy";
    // Its points lie there already.
    options.placement = {{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}};
    options.refine = place == 2;
  }
  if (const MeshModel* points = other_layer(document, parameters, "Points")) {
    const Frame frame(current, *points);
    for (const CVertexO& vertex : points->cm.vert)
      if (!vertex.IsD()) options.constraint_points.push_back(frame(vertex.cP()));
    options.softness = parameters.getFloat("Softness");
  } else if (parameters.getFloat("Softness") != 0) {
    return "\"Softness\": choose a layer in \"Pass through points of layer\"";
  }
  return "";
}

std::string set_rims(const MeshDocument& document, const RichParameterList& parameters,
                     mc::Options& options) {
  const CMeshO& mesh = document.mm()->cm;
  const int from = parameters.getEnum("SourceFaces");
  const bool loose = parameters.getBool("Loose");
  const MeshModel* initial = other_layer(document, parameters, "Initial");
  if (from < 0 || from > 2) return "\"Faces to copy from\": there is no choice " + std::to_string(from);
  if (mesh.fn == 0 && (from > 0 || loose || initial || options.part))
    return "a point layer has no faces to copy from, no loose rim, no missing part and no layer to start "
           "from";
  if (from > 0) {
    bool some = false;
    for (const CFaceO& face : mesh.face) {
      some = some || face.IsS();
      options.source_faces.push_back(face.IsS() == (from == 1));
    }
    if (!some) return "\"Faces to copy from\": no face is selected";
  }
  if (loose) {
    for (std::size_t v = 0; v < mesh.vert.size(); ++v)
      if (mesh.vert[v].IsS()) options.loose_vertices.push_back(std::uint32_t(v));
    if (options.loose_vertices.empty())
      return "\"Loose rim at selected vertices\": no vertex is selected";
  }
  if (initial) {
    const std::string why = set_initial(*document.mm(), *initial, options);
    if (!why.empty()) return "\"Start from layer\": " + why;
  }
  return "";
}
