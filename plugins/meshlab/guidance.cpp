// SPDX-License-Identifier: GPL-3.0-or-later
#include "guidance.h"

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

void set_source(const MeshModel& current, const MeshModel& source, const Carried& carried,
                mc::Options& options) {
  const Frame frame(current, source);
  const CMeshO& mesh = source.cm;
  std::vector<std::uint32_t> number(mesh.vert.size(), mc::none);
  for (std::size_t v = 0; v < mesh.vert.size(); ++v) {
    if (mesh.vert[v].IsD()) continue;
    number[v] = std::uint32_t(options.exemplar.vertices.size());
    options.exemplar.vertices.push_back(frame(mesh.vert[v].cP()));
    carried.append(mesh.vert[v], options.exemplar_values);
  }
  for (const CFaceO& face : mesh.face) {
    if (face.IsD()) continue;
    std::array<std::uint32_t, 3> corners;
    for (int k = 0; k < 3; ++k) corners[k] = number[vcg::tri::Index(mesh, face.cV(k))];
    if (frame.mirrors()) std::swap(corners[1], corners[2]);
    options.exemplar.faces.push_back(corners);
  }
  options.exemplar_only = true;
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

std::string set_guidance(const MeshDocument& document, const RichParameterList& parameters,
                         const Carried& carried, mc::Options& options) {
  const MeshModel& current = *document.mm();
  options.unmirrored = !parameters.getBool("Mirror");
  options.candidate = std::uint32_t(std::max(parameters.getInt("Candidate"), 0));
  const double least = parameters.getFloat("LeastScale"), most = parameters.getFloat("GreatestScale");
  if (least != 1 || most != 1) options.scale_range = {{least, most}};

  const MeshModel* source = other_layer(document, parameters, "Source");
  if (source) {
    if (source->cm.fn == 0)
      return "\"Copy from layer\": " + source->label().toStdString() +
             " is a point layer; choose one with faces";
    set_source(current, *source, carried, options);
  }
  const int place = parameters.getEnum("Place");
  if (place < 0 || place > 2) return "\"Place of the source\": there is no choice " + std::to_string(place);
  if (place > 0) {
    if (!source) return "\"Place of the source\": choose another layer in \"Copy from layer\"";
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
