// SPDX-License-Identifier: GPL-3.0-or-later
#include "attributes.h"

#include <algorithm>
#include <cmath>

namespace mc = mesh_completion;

namespace {

// As in the command line's pictures.
const vcg::Color4b palette[] = {{0, 158, 115, 255},  {204, 60, 140, 255}, {240, 228, 66, 255},
                                {120, 60, 160, 255}, {86, 180, 233, 255}, {200, 60, 0, 255},
                                {0, 114, 178, 255}};
constexpr std::size_t palette_size = sizeof palette / sizeof *palette;
// Of a mesh without colors, and of a new vertex without a source.
const vcg::Color4b plain(200, 200, 200, 255), no_source(150, 150, 150, 255);

// Sums of face normals, weighted by their angle at the vertex, as MeshLab has them; for marked
// vertices.
std::vector<Point3m> angle_weighted(const CMeshO& mesh, const std::vector<bool>& marked) {
  std::vector<Point3m> sums(mesh.vert.size(), Point3m(0, 0, 0));
  for (const CFaceO& face : mesh.face) {
    if (face.IsD()) continue;
    for (int k = 0; k < 3; ++k) {
      const std::size_t v = vcg::tri::Index(mesh, face.cV(k));
      if (!marked[v]) continue;
      const Point3m p = face.cP(k);
      const Point3m a = face.cP((k + 1) % 3) - p, b = face.cP((k + 2) % 3) - p;
      Point3m normal = a ^ b;
      const Scalarm sine = normal.Norm(), cosine = a * b;
      if (sine > 0) sums[v] += normal * (std::atan2(sine, cosine) / sine);
    }
  }
  for (Point3m& sum : sums)
    if (sum.Norm() > 0) sum.Normalize();
  return sums;
}

std::vector<bool> marks(std::size_t size, const std::vector<std::uint32_t>& vertices) {
  std::vector<bool> marked(size);
  for (const std::uint32_t v : vertices) marked[v] = true;
  return marked;
}

// 0: red, 0.5: yellow, 1: green.
vcg::Color4b ramp(double confidence) {
  const double t = std::min(std::max(confidence, 0.0), 1.0);
  return {static_cast<unsigned char>(t < 0.5 ? 220 : 440 * (1 - t)),
          static_cast<unsigned char>(t < 0.5 ? 400 * t : 200), 40, 255};
}

unsigned char byte(double value) {
  return static_cast<unsigned char>(std::lround(std::min(std::max(value, 0.0), 255.0)));
}

// Sources are numbered hole by hole, so that neighbours in the list differ.
void color_provenance(CMeshO& mesh, const mc::Result<Scalarm>& result, const Places& places) {
  std::vector<std::size_t> first;
  std::size_t count = 0;
  for (const mc::Hole& hole : result.holes()) {
    first.push_back(count);
    count += hole.source_count;
  }
  for (std::size_t i = 0; i < result.new_vertices().size(); ++i) {
    CVertexO& vertex = mesh.vert[result.input_vertex_count() + i];
    const std::uint32_t source = result.new_vertex_sources()[i];
    vertex.C() = no_source;
    if (source == mc::none) continue;
    vertex.C() = palette[(first[result.new_vertex_holes()[i]] + source) % palette_size];
    for (const std::uint32_t v : places(i)) mesh.vert[v].C() = vertex.C();
  }
}

}  // namespace

Carried::Carried(const MeshModel& model, const std::vector<const MeshModel*>& sources,
                 bool and_mesh, Coloring coloring) {
  const auto own = [&](int mask) { return model.hasDataMask(mask); };
  const auto shared = [&](int mask) {
    return own(mask) &&
           std::all_of(sources.begin(), sources.end(),
                       [&](const MeshModel* source) { return source->hasDataMask(mask); });
  };
  color = shared(MeshModel::MM_VERTCOLOR);
  quality = shared(MeshModel::MM_VERTQUALITY);
  of_sources = color || quality || !and_mesh;
  if (!of_sources) {
    color = own(MeshModel::MM_VERTCOLOR);
    quality = own(MeshModel::MM_VERTQUALITY);
  }
  color = color && coloring != Coloring::rim;
}

void Carried::append(const CVertexO& vertex, std::vector<double>& values) const {
  const vcg::Color4b c = vertex.cC();
  for (int k = 0; color && k < 4; ++k) values.push_back(c[k]);
  // A quality that is no number is none.
  const double q = double(vertex.cQ());
  if (quality) values.push_back(std::isfinite(q) ? q : 0);
}

void Carried::give(const CMeshO& mesh, mc::Options& options) const {
  options.value_channels = (color ? 4 : 0) + (quality ? 1 : 0);
  options.steering_channels = color ? 3 : 0;
  for (const CVertexO& vertex : mesh.vert) append(vertex, options.vertex_values);
}

void Carried::take(CMeshO& mesh, const mc::Result<Scalarm>& result) const {
  const auto values = result.new_vertex_values();
  const double* value = values.begin();
  for (std::size_t v = result.input_vertex_count(); v < mesh.vert.size() && value; ++v) {
    CVertexO& vertex = mesh.vert[v];
    for (int k = 0; color && k < 4; ++k) vertex.C()[k] = byte(*value++);
    if (quality) vertex.Q() = Scalarm(*value++);
  }
}

void color_by_result(MeshModel& model, const mc::Result<Scalarm>& result, Coloring coloring,
                     const Places& places) {
  CMeshO& mesh = model.cm;
  if (coloring != Coloring::provenance && coloring != Coloring::confidence) return;
  if (!model.hasDataMask(MeshModel::MM_VERTCOLOR)) {
    model.updateDataMask(MeshModel::MM_VERTCOLOR);
    for (CVertexO& vertex : mesh.vert) vertex.C() = plain;
  }
  if (coloring == Coloring::provenance) return color_provenance(mesh, result, places);
  for (std::size_t i = 0; i < result.new_vertices().size(); ++i)
    mesh.vert[result.input_vertex_count() + i].C() = ramp(result.new_vertex_confidences()[i]);
}

Attributes::Attributes(const MeshModel& model, const mc::Result<Scalarm>& result,
                       const Faces& faces)
    : result_(result), faces_(faces), carrier_(result) {
  const CMeshO& mesh = model.cm;
  const auto computed = angle_weighted(mesh, marks(mesh.vert.size(), carrier_.rim()));
  // A normal from a file is kept; one that MeshLab has computed must know of the fill, or the seam
  // would show in the shading. Within 0.8 degrees of the computed one it is taken for one.
  for (const std::uint32_t v : carrier_.rim()) {
    Point3m normal = mesh.vert[v].cN();
    if (normal.Norm() > 0 && normal.Normalize() * computed[v] > 0.9999) follow_.push_back(v);
  }
}

void Attributes::apply(MeshModel& model, const Carried& carried, Coloring coloring) const {
  carry_from_rim(model);
  carried.take(model.cm, result_);
  set_normals(model.cm);
  copy_face_attributes(model);
  color_by_result(model, result_, coloring, [this](std::size_t i) {
    const std::uint32_t face = result_.new_vertex_source_faces()[i];
    // From there on they are those of another layer.
    if (face >= faces_.size()) return std::vector<std::uint32_t>();
    return std::vector<std::uint32_t>(faces_[face].begin(), faces_[face].end());
  });
}

void Attributes::set_normals(CMeshO& mesh) const {
  for (std::size_t i = faces_.size(); i < mesh.face.size(); ++i) {
    CFaceO& face = mesh.face[i];
    face.N() = (face.P(1) - face.P(0)) ^ (face.P(2) - face.P(0));
    if (face.N().Norm() > 0) face.N().Normalize();
  }
  std::vector<std::uint32_t> vertices = follow_;
  for (std::size_t v = result_.input_vertex_count(); v < mesh.vert.size(); ++v)
    vertices.push_back(std::uint32_t(v));
  const auto normals = angle_weighted(mesh, marks(mesh.vert.size(), vertices));
  for (const std::uint32_t v : vertices) mesh.vert[v].N() = normals[v];
}

// Color and quality of the vertices, from the rim.
void Attributes::carry_from_rim(MeshModel& model) const {
  CMeshO& mesh = model.cm;
  const auto rows = carrier_.from_rim<5>([&mesh](std::uint32_t v) {
    const CVertexO& vertex = mesh.vert[v];
    const vcg::Color4b color = vertex.cC();
    return std::array<double, 5>{double(color[0]), double(color[1]), double(color[2]),
                                 double(color[3]), double(vertex.cQ())};
  });
  for (std::size_t i = 0; i < rows.size(); ++i) {
    CVertexO& vertex = mesh.vert[result_.input_vertex_count() + i];
    for (int k = 0; k < 4; ++k) vertex.C()[k] = byte(rows[i][std::size_t(k)]);
    vertex.Q() = Scalarm(rows[i][4]);
  }
}

// From the nearest face at the rim.
void Attributes::copy_face_attributes(MeshModel& model) const {
  const bool color = model.hasDataMask(MeshModel::MM_FACECOLOR);
  const bool quality = model.hasDataMask(MeshModel::MM_FACEQUALITY);
  if (!color && !quality) return;
  const auto like = mc::face_templates(result_, [this](std::uint32_t f) { return faces_[f]; });
  for (std::size_t i = 0; i < like.size(); ++i) {
    if (like[i] == mc::none) continue;
    CFaceO& face = model.cm.face[faces_.size() + i];
    if (color) face.C() = model.cm.face[like[i]].C();
    if (quality) face.Q() = model.cm.face[like[i]].Q();
  }
}
