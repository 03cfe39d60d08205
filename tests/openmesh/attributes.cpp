// What new elements carry, by value.
#include <algorithm>
#include <cmath>
#include <map>

#include "suite.hpp"

namespace {

// Each new vertex is the mean of its neighbours, up to the rounding of bytes.
template <class Mesh>
void colours_from_rim(const Mesh& mesh, const om::Fill<Mesh>& fill) {
  double worst = 0;
  std::size_t different = 0;
  for (const VertexHandle v : fill.vertices) {
    for (std::size_t c = 0; c < colour_size<Mesh>; ++c) {
      double sum = 0, n = 0;
      for (auto other = mesh.cvv_begin(v); other.is_valid(); ++other) {
        sum += static_cast<double>(mesh.color(*other)[c]);
        ++n;
      }
      worst = std::max(worst, std::fabs(sum / n - static_cast<double>(mesh.color(v)[c])));
    }
    different += mesh.color(v) != mesh.color(fill.vertices[0]);
  }
  CHECK(worst < (colours_are_bytes<Mesh> ? 1.01 : 1e-3));
  CHECK(different > 0);
}

template <class Mesh>
void colours_from_source() {
  Mesh mesh;
  make_ball_mesh(mesh);
  om::Extras extras;
  extras.colours = om::Colours::from_source;
  extras.origins = true;
  const auto fill = om::complete(mesh, {}, extras);
  std::size_t copied = 0, wrong = 0;
  for (const VertexHandle v : fill.vertices) {
    const om::Origin& origin = mesh.property(fill.origins, v);
    if (!origin.face.is_valid()) continue;
    ++copied;
    const auto at = corners(mesh, origin.face);
    for (std::size_t c = 0; c < colour_size<Mesh>; ++c) {
      double expected = 0;
      for (std::size_t k = 0; k < 3; ++k)
        expected += origin.barycentric[k] * static_cast<double>(mesh.color(at[k])[c]);
      wrong += !(std::fabs(expected - static_cast<double>(mesh.color(v)[c])) < (colours_are_bytes<Mesh> ? 0.51 : 1e-3));
    }
  }
  CHECK(copied > 0 && wrong == 0);
}

// The values of the library's own call, colours steering; a mesh with deleted vertices gets the same.
template <class Mesh>
void colours_with_shape() {
  Mesh mesh;
  make_ball_mesh(mesh);
  const std::size_t size = colour_size<Mesh>;
  mc::Options options;
  for (const auto v : mesh.vertices())
    for (std::size_t c = 0; c < size; ++c) options.vertex_values.push_back(static_cast<double>(mesh.color(v)[c]));
  options.value_channels = static_cast<std::uint32_t>(size);
  options.steering_channels = 3;
  Mesh other = mesh;
  const auto expected = om::complete(other, options).result;
  om::Extras extras;
  extras.colours = om::Colours::with_shape;
  const auto fill = om::complete(mesh, {}, extras);
  const auto values = expected.new_vertex_values();
  std::size_t wrong = 0;
  CHECK(values.size() == size * fill.vertices.size() && !values.empty());
  for (std::size_t i = 0; i < fill.vertices.size(); ++i)
    for (std::size_t c = 0; c < size; ++c)
      wrong += !(std::fabs(values[size * i + c] - static_cast<double>(mesh.color(fill.vertices[i])[c])) <
                 (colours_are_bytes<Mesh> ? 0.51 : 1e-3));
  CHECK(wrong == 0);
  options.vertex_values.pop_back();
  CHECK(om::try_complete(other, options).status() == mc::Status::invalid_argument);
}

template <class Mesh>
void normals(const Mesh& mesh, const om::Fill<Mesh>& fill) {
  std::size_t wrong = 0;
  for (const VertexHandle v : fill.vertices) {  // the sphere's own, within 25 degrees
    const auto n = mesh.normal(v);
    const auto p = mesh.point(v);
    wrong += !(std::fabs(n.norm() - 1) < 1e-5) || !(n[0] * p[0] + n[1] * p[1] + n[2] * p[2] > 0.9 * p.norm());
  }
  CHECK(wrong == 0);
  for (const FaceHandle f : fill.faces) wrong += (mesh.normal(f) - mesh.calc_face_normal(f)).norm() > 1e-6;
  CHECK(wrong == 0);
}

// Labels and materials are some of the rim's, and of a face at an edge that of the face beyond.
template <class Mesh>
void custom_properties(const Mesh& mesh, const om::Fill<Mesh>& fill, const Custom<Mesh>& custom) {
  std::map<int, int> labels;
  for (const VertexHandle v : fill.vertices) ++labels[mesh.property(custom.label, v)];
  CHECK(labels.size() > 2 && labels.begin()->first >= 0 && labels.rbegin()->first < 5);
  std::size_t wrong = 0, wrong_colour = 0, at_rim = 0;
  for (const FaceHandle f : fill.faces) {
    wrong += mesh.property(custom.material, f).empty();
    bool some = false, same = false, same_colour = false;
    for (auto other = mesh.cff_begin(f); other.is_valid(); ++other) {
      if (other->idx() >= FACES) continue;
      some = true;
      same = same || mesh.property(custom.material, *other) == mesh.property(custom.material, f);
      same_colour = same_colour || mesh.color(*other) == mesh.color(f);
    }
    at_rim += some;
    wrong += some && !same;
    wrong_colour += some && !same_colour;
  }
  CHECK(at_rim > 0 && wrong == 0 && wrong_colour == 0);
}

template <class Mesh>
void origins(const Mesh& mesh, const om::Fill<Mesh>& fill) {
  const auto& r = fill.result;
  OpenMesh::VPropHandleT<om::Origin> by_name;
  CHECK(mesh.get_property_handle(by_name, om::origin_property) && by_name == fill.origins);
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < fill.vertices.size(); ++i) {
    const om::Origin& origin = mesh.property(fill.origins, fill.vertices[i]);
    const std::uint32_t face = r.new_vertex_source_faces()[i];
    wrong += origin.face.idx() != (face == mc::none ? -1 : static_cast<int>(face));
    wrong += origin.barycentric != r.new_vertex_barycentrics()[i] || origin.source != r.new_vertex_sources()[i];
    wrong += origin.hole != r.new_vertex_holes()[i] || origin.confidence != r.new_vertex_confidences()[i];
  }
  for (int i = 0; i < VERTICES; ++i) {
    const om::Origin& origin = mesh.property(fill.origins, VertexHandle(i));
    wrong += origin.hole != mc::none || origin.face.is_valid();
  }
  CHECK(wrong == 0);
}

template <class Mesh>
void selection(const Mesh& mesh, const om::Fill<Mesh>& fill) {
  std::size_t selected = 0, wrong = 0;
  for (const auto f : mesh.all_faces()) selected += mesh.status(f).selected();
  for (const FaceHandle f : fill.faces) wrong += !mesh.status(f).selected();
  CHECK(wrong == 0 && selected == fill.faces.size());
}

// A mesh that carries nothing is not made to carry something.
template <class Mesh>
void bare() {
  Mesh full, mesh;
  make_ball_mesh(full);
  for (const auto v : full.vertices()) mesh.add_vertex(full.point(v));
  for (const auto f : full.faces()) {
    const auto c = corners(full, f);
    mesh.add_face(c[0], c[1], c[2]);
  }
  mc::Options smooth;
  smooth.method = mc::Method::smooth;
  const auto fill = om::complete(mesh, smooth);
  CHECK(fill.result.filled_count() == 2 && count_boundary(mesh) == 0);
  CHECK(!mesh.has_vertex_colors() && !mesh.has_vertex_normals() && !mesh.has_face_status());
  OpenMesh::VPropHandleT<om::Origin> handle;
  CHECK(!mesh.get_property_handle(handle, om::origin_property));
}

// The property of an earlier fill is right for the next one, too.
template <class Mesh>
void origins_twice() {
  Mesh mesh;
  make_ball_mesh(mesh);
  mc::Options one;
  one.selection = mc::Selection::ids;
  one.selection_ids = {0};
  om::Extras extras;
  extras.origins = true;
  const auto first = om::complete(mesh, one, extras);
  const auto second = om::complete(mesh);
  CHECK(!second.vertices.empty() && second.origins == first.origins);
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < second.vertices.size(); ++i)
    wrong += mesh.property(second.origins, second.vertices[i]).confidence != second.result.new_vertex_confidences()[i] ||
             mesh.property(second.origins, second.vertices[i]).hole != 0;
  CHECK(wrong == 0);
}

}  // namespace

template <class Mesh>
void test_attributes() {
  Mesh mesh;
  const Custom<Mesh> custom = make_ball_mesh(mesh);
  mesh.status(FaceHandle(3)).set_selected(true);
  om::Extras extras;
  extras.origins = extras.select_new = true;
  const auto fill = om::complete(mesh, {}, extras);
  colours_from_rim(mesh, fill);
  normals(mesh, fill);
  custom_properties(mesh, fill, custom);
  origins(mesh, fill);
  selection(mesh, fill);
  colours_from_source<Mesh>();
  colours_with_shape<Mesh>();
  bare<Mesh>();
  origins_twice<Mesh>();
}

template void test_attributes<FloatMesh>();
template void test_attributes<DoubleMesh>();
