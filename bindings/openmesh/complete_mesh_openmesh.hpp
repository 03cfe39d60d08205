/* SPDX-License-Identifier: MIT OR Apache-2.0
 *
 * complete-mesh for OpenMesh: fills the holes of a triangle mesh of any kernel with float or double
 * coordinates, in place. Header-only; tested with OpenMesh 9.0.
 *
 *   #include <OpenMesh/Core/IO/MeshIO.hh>   // before the mesh types, as OpenMesh wants it
 *   #include <complete_mesh_openmesh.hpp>
 *   const auto fill = mesh_completion::openmesh::complete(mesh);
 *   for (auto face : fill.faces) mesh.set_color(face, red);
 *
 * All handles stay valid and everything that belongs to them stays as it is; new elements come after
 * the old ones. If a call fails the mesh is as it was. Deleted elements that have not been collected
 * are not part of the surface: their faces are holes. Hidden ones are.
 */
#ifndef COMPLETE_MESH_OPENMESH_HPP
#define COMPLETE_MESH_OPENMESH_HPP

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>

#include "complete_mesh_attributes.hpp"

namespace mesh_completion {
namespace openmesh {

using OpenMesh::FaceHandle;
using OpenMesh::VertexHandle;

// Where the colours of new vertices come from. with_shape: they are the vertex_values of the options, as
// far as those are empty, steer the search, and are completed with the shape.
enum class Colours { from_rim, from_source, with_shape };

// What is done beside the fill itself.
struct Extras {
  Colours colours = Colours::from_rim;
  // New faces are selected and no others; needs face status.
  bool select_new = false;
  // Every new vertex gets an Origin, in the property named origin_property.
  bool origins = false;
  // garbage_collection() before the fill, which changes handles.
  bool collect_garbage = false;
};

// Where a new vertex comes from; no face and no hole for the mesh's own vertices.
struct Origin {
  FaceHandle face = FaceHandle();  // invalid without a source on the mesh
  std::array<double, 3> barycentric = {0, 0, 0};
  std::uint32_t source = none;
  std::uint32_t hole = none;
  double confidence = 0;
  std::uint32_t exemplar_face = none;  // instead of face, if it was copied from the exemplar
};
inline constexpr const char* origin_property = "complete_mesh:origin";

namespace detail {

template <class Mesh>
using ScalarOf = typename OpenMesh::vector_traits<typename Mesh::Point>::value_type;

// A mesh as the library wants it. Only a mesh with deleted elements has its points copied.
template <class Mesh>
class Input {
 public:
  using Scalar = ScalarOf<Mesh>;
  static_assert(OpenMesh::vector_traits<typename Mesh::Point>::size_ == 3, "points have 3 numbers");

  explicit Input(const Mesh& mesh) : all_faces_(mesh.n_faces()) {
    const auto deleted = [&mesh](auto handle, bool has) { return has && mesh.status(handle).deleted(); };
    for (const auto v : mesh.all_vertices())
      if (!deleted(v, mesh.has_vertex_status())) vertex_of_.push_back(v);
    for (const auto f : mesh.all_faces())
      if (!deleted(f, mesh.has_face_status())) face_of_.push_back(f);
    index_of_.assign(mesh.n_vertices(), none);
    for (std::size_t i = 0; i < vertex_of_.size(); ++i)
      index_of_[static_cast<std::size_t>(vertex_of_[i].idx())] = static_cast<std::uint32_t>(i);
    faces_.reserve(face_of_.size());
    for (const FaceHandle f : face_of_) faces_.push_back(corners_in(mesh, f));
    if (vertex_of_.size() < mesh.n_vertices())
      for (const VertexHandle v : vertex_of_) points_.push_back(mesh.point(v));
    const auto* points = points_.empty() ? mesh.points() : points_.data();
    view_.vertices = vertex_of_.empty() ? nullptr : &(*points)[0];
    view_.vertex_count = vertex_of_.size();
    view_.vertex_stride = sizeof(typename Mesh::Point);
    view_.faces = faces_.empty() ? nullptr : faces_[0].data();
    view_.face_count = faces_.size();
  }
  Input(const Input&) = delete;
  Input& operator=(const Input&) = delete;

  const MeshView<Scalar>& view() const { return view_; }
  const std::vector<std::array<std::uint32_t, 3>>& faces() const { return faces_; }
  const std::vector<VertexHandle>& vertex_of() const { return vertex_of_; }
  const std::vector<FaceHandle>& face_of() const { return face_of_; }

  // Options whose elements are indices of the mesh's handles; a failure if one does not exist.
  std::optional<Failure> translate(Options& options) const {
    if (options.selection == Selection::near_vertices)
      if (auto failure = translate(options.selection_ids)) return failure;
    for (auto& list : options.join_vertices)
      if (auto failure = translate(list)) return failure;
    if (auto failure = translate(options.loose_vertices)) return failure;
    if (auto failure = translate_flags(options.source_faces)) return failure;
    if (auto failure = translate_values(options.vertex_values, options.value_channels)) return failure;
    for (auto& face : options.initial.faces)
      if (auto failure = translate_initial(face)) return failure;
    return {};
  }
  // A failure's elements as indices of the mesh's handles.
  Failure translate_back(Failure failure) const {
    const auto vertex = [this](std::uint32_t& v) { v = static_cast<std::uint32_t>(vertex_of_[v].idx()); };
    for (std::uint32_t& v : failure.vertices) vertex(v);
    for (Edge& edge : failure.edges)
      for (std::uint32_t& v : edge) vertex(v);
    for (std::uint32_t& f : failure.faces) f = static_cast<std::uint32_t>(face_of_[f].idx());
    return failure;
  }

 private:
  std::array<std::uint32_t, 3> corners_in(const Mesh& mesh, FaceHandle f) const {
    std::array<std::uint32_t, 3> corners{};
    std::size_t k = 0;
    for (auto v = mesh.cfv_begin(f); v.is_valid() && k < 3; ++v)
      corners[k++] = index_of_[static_cast<std::size_t>(v->idx())];
    return corners;
  }
  static Failure wrong_argument(std::string message) {
    Failure failure;
    failure.status = Status::invalid_argument;
    failure.message = std::move(message);
    return failure;
  }
  std::optional<Failure> translate(std::uint32_t& vertex) const {
    if (vertex >= index_of_.size() || index_of_[vertex] == none)
      return wrong_argument("vertex " + std::to_string(vertex) +
                            " of the options does not exist or is deleted");
    vertex = index_of_[vertex];
    return {};
  }
  std::optional<Failure> translate(std::vector<std::uint32_t>& vertices) const {
    for (std::uint32_t& v : vertices)
      if (auto failure = translate(v)) return failure;
    return {};
  }
  std::optional<Failure> translate_values(std::vector<double>& values, std::size_t channels) const {
    if (values.empty()) return {};
    if (values.size() != channels * index_of_.size())
      return wrong_argument("vertex_values has " + std::to_string(values.size()) + " numbers, not " +
                            std::to_string(channels) + " for each vertex handle");
    std::vector<double> kept;
    for (const VertexHandle v : vertex_of_) {
      const auto first = values.begin() + static_cast<std::ptrdiff_t>(channels) * v.idx();
      kept.insert(kept.end(), first, first + static_cast<std::ptrdiff_t>(channels));
    }
    values.swap(kept);
    return {};
  }
  std::optional<Failure> translate_flags(std::vector<std::uint8_t>& flags) const {
    if (flags.empty()) return {};
    if (flags.size() != all_faces_)
      return wrong_argument("source_faces has " + std::to_string(flags.size()) +
                            " flags, but the mesh has " + std::to_string(all_faces_) + " face handles");
    std::vector<std::uint8_t> live;
    for (const FaceHandle f : face_of_) live.push_back(flags[static_cast<std::size_t>(f.idx())]);
    flags = std::move(live);
    return {};
  }
  // New vertices are numbered from the handles' count on: here from that of the live ones.
  std::optional<Failure> translate_initial(std::array<std::uint32_t, 3>& face) const {
    for (std::uint32_t& v : face) {
      if (v >= index_of_.size()) v -= static_cast<std::uint32_t>(index_of_.size() - vertex_of_.size());
      else if (auto failure = translate(v)) return failure;
    }
    return {};
  }

  MeshView<Scalar> view_;
  std::vector<VertexHandle> vertex_of_;
  std::vector<FaceHandle> face_of_;
  std::vector<std::uint32_t> index_of_;
  std::size_t all_faces_;
  std::vector<std::array<std::uint32_t, 3>> faces_;
  std::vector<typename Mesh::Point> points_;
};

// Puts a mesh back as it was unless told to keep it. Adding faces changes, of what is there, no more
// than the boundary's halfedges and the halfedge that a vertex of the boundary names.
template <class Mesh>
class Undo {
 public:
  explicit Undo(Mesh& mesh)
      : mesh_(mesh), vertices_(mesh.n_vertices()), edges_(mesh.n_edges()), faces_(mesh.n_faces()) {
    for (const auto h : mesh.all_halfedges()) {
      if (!mesh.is_boundary(h)) continue;
      // What a deleted edge links to has moved on.
      if (mesh.has_edge_status() && mesh.status(mesh.edge_handle(h)).deleted()) continue;
      const VertexHandle from = mesh.from_vertex_handle(h);
      links_.push_back({h, mesh.next_halfedge_handle(h), from, mesh.halfedge_handle(from)});
    }
  }
  ~Undo() {
    if (kept_) return;
    for (const Link& link : links_) {
      mesh_.set_boundary(link.halfedge);
      mesh_.set_next_halfedge_handle(link.halfedge, link.next);
      mesh_.set_halfedge_handle(link.from, link.of_from);
    }
    mesh_.resize(vertices_, edges_, faces_);
  }
  Undo(const Undo&) = delete;
  Undo& operator=(const Undo&) = delete;
  void keep() { kept_ = true; }

 private:
  struct Link {
    OpenMesh::HalfedgeHandle halfedge, next;
    VertexHandle from;
    OpenMesh::HalfedgeHandle of_from;
  };
  Mesh& mesh_;
  std::size_t vertices_, edges_, faces_;
  std::vector<Link> links_;
  bool kept_ = false;
};

using Triangle = std::array<VertexHandle, 3>;

// Adds faces, in the order given; handles[i] is that of triangles[i]. OpenMesh refuses a face now and
// then that it takes once its neighbours are there, so what was refused is tried again. The triangle
// that it refuses for good, if any.
template <class Mesh>
std::optional<Triangle> add_faces(Mesh& mesh, const std::vector<Triangle>& triangles,
                                  std::vector<FaceHandle>& handles) {
  handles.assign(triangles.size(), FaceHandle());
  std::size_t left = triangles.size(), before;
  do {
    before = left;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      if (handles[i].is_valid()) continue;
      const Triangle& t = triangles[i];
      handles[i] = mesh.add_face(t[0], t[1], t[2]);
      left -= handles[i].is_valid() ? 1 : 0;
    }
  } while (left > 0 && left < before);
  for (std::size_t i = 0; i < triangles.size(); ++i)
    if (!handles[i].is_valid()) return triangles[i];
  return {};
}

template <class T>
T component(double value) {
  if constexpr (std::is_integral_v<T>) {
    const double top = static_cast<double>(std::numeric_limits<T>::max());
    return static_cast<T>(std::lround(std::min(std::max(value, 0.0), top)));
  } else {
    return static_cast<T>(value);
  }
}

}  // namespace detail

// What the library counts are the elements that are not deleted; these are their handles.
struct Handles {
  std::vector<VertexHandle> vertex_of;
  std::vector<FaceHandle> face_of;

  VertexHandle vertex(std::uint32_t index) const { return vertex_of.at(index); }
  FaceHandle face(std::uint32_t index) const { return face_of.at(index); }
  // A boundary loop, in the order in which a filling face runs.
  std::vector<VertexHandle> loop(const Holes& holes, std::size_t hole, std::size_t loop_index) const {
    std::vector<VertexHandle> handles;
    for (const std::uint32_t v : holes.loop(hole, loop_index)) handles.push_back(vertex(v));
    return handles;
  }
};

struct HoleList : Handles {
  Holes holes;
};

// What was added. The handles go on with the new elements, so they are those of all of the result's
// indices.
template <class Mesh>
struct Fill : Handles {
  std::vector<VertexHandle> vertices;  // new, in the result's order
  std::vector<FaceHandle> faces;       // new, in the result's order
  Result<detail::ScalarOf<Mesh>> result;
  // Valid only if asked for, or there before.
  OpenMesh::VPropHandleT<Origin> origins = OpenMesh::VPropHandleT<Origin>();
};

namespace detail {

template <class Mesh>
inline constexpr std::size_t colour_size = OpenMesh::vector_traits<typename Mesh::Color>::size_;

// The colours as values that steer.
template <class Mesh>
void give_colours(const Mesh& mesh, Options& options) {
  for (const auto v : mesh.all_vertices())
    for (std::size_t c = 0; c < colour_size<Mesh>; ++c)
      options.vertex_values.push_back(static_cast<double>(mesh.color(v)[c]));
  options.value_channels = colour_size<Mesh>;
  options.steering_channels = colour_size<Mesh> < 3 ? colour_size<Mesh> : 3;
}

// Those that came back.
template <class Mesh>
void take_colours(Mesh& mesh, const Fill<Mesh>& fill) {
  using Colour = typename Mesh::Color;
  using Component = typename OpenMesh::vector_traits<Colour>::value_type;
  const auto values = fill.result.new_vertex_values();
  for (std::size_t i = 0; i < fill.vertices.size() && !values.empty(); ++i) {
    Colour colour;
    for (std::size_t c = 0; c < colour_size<Mesh>; ++c)
      colour[c] = component<Component>(values[colour_size<Mesh> * i + c]);
    mesh.set_color(fill.vertices[i], colour);
  }
}

template <class Mesh>
void set_colours(Mesh& mesh, const Fill<Mesh>& fill, const Input<Mesh>& input, const Carrier& carrier,
                 Colours colours) {
  using Colour = typename Mesh::Color;
  using Component = typename OpenMesh::vector_traits<Colour>::value_type;
  constexpr std::size_t size = OpenMesh::vector_traits<Colour>::size_;
  const auto get = [&](std::uint32_t v) {
    std::array<double, size> row{};
    const Colour& colour = mesh.color(fill.vertex(v));
    for (std::size_t c = 0; c < size; ++c) row[c] = static_cast<double>(colour[c]);
    return row;
  };
  const auto corners = [&](std::uint32_t f) { return input.faces()[f]; };
  const auto rows = colours == Colours::from_source
                        ? carrier.from_source<size>(fill.result, get, corners)
                        : carrier.from_rim<size>(get);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    Colour colour;
    for (std::size_t c = 0; c < size; ++c) colour[c] = component<Component>(rows[i][c]);
    mesh.set_color(fill.vertices[i], colour);
  }
}

// Custom properties from the rim, colours, normals, selection.
template <class Mesh>
void set_attributes(Mesh& mesh, const Fill<Mesh>& fill, const Input<Mesh>& input, const Extras& extras) {
  const Carrier carrier(fill.result);
  const auto nearest = carrier.nearest();
  for (std::size_t i = 0; i < nearest.size(); ++i)
    if (nearest[i] != none) mesh.copy_all_properties(fill.vertex(nearest[i]), fill.vertices[i]);
  const auto like = face_templates(fill.result, [&](std::uint32_t f) { return input.faces()[f]; });
  for (std::size_t i = 0; i < like.size(); ++i) {
    if (like[i] == none) continue;
    mesh.copy_all_properties(fill.face(like[i]), fill.faces[i]);
    if (mesh.has_face_colors()) mesh.set_color(fill.faces[i], mesh.color(fill.face(like[i])));
  }
  if (mesh.has_vertex_colors()) set_colours(mesh, fill, input, carrier, extras.colours);
  if (mesh.has_face_normals())
    for (const FaceHandle f : fill.faces) mesh.set_normal(f, mesh.calc_face_normal(f));
  if (mesh.has_vertex_normals()) {
    for (const VertexHandle v : fill.vertices) {
      typename Mesh::Normal normal;
      mesh.calc_vertex_normal_correct(v, normal);
      using OpenMesh::norm;
      const auto length = norm(normal);
      mesh.set_normal(v, length > 0 ? typename Mesh::Normal(normal / length) : normal);
    }
  }
  if (extras.select_new && mesh.has_face_status()) {
    for (const auto f : mesh.all_faces()) mesh.status(f).set_selected(false);
    for (const FaceHandle f : fill.faces) mesh.status(f).set_selected(true);
  }
}

template <class Mesh>
void set_origins(Mesh& mesh, Fill<Mesh>& fill) {
  if (!mesh.get_property_handle(fill.origins, origin_property))
    mesh.add_property(fill.origins, origin_property);
  const auto& result = fill.result;
  for (std::size_t i = 0; i < fill.vertices.size(); ++i) {
    Origin origin;
    const std::uint32_t face = result.new_vertex_source_faces()[i];
    const auto input = static_cast<std::uint32_t>(result.input_face_count());
    if (face < input) origin.face = fill.face(face);
    else if (face != none) origin.exemplar_face = face - input;
    origin.barycentric = result.new_vertex_barycentrics()[i];
    origin.source = result.new_vertex_sources()[i];
    origin.hole = result.new_vertex_holes()[i];
    origin.confidence = result.new_vertex_confidences()[i];
    mesh.property(fill.origins, fill.vertices[i]) = origin;
  }
}

}  // namespace detail

// Fills the holes of a mesh. Vertices in the options are indices of handles, source_faces has a flag for
// each face handle, and the elements of a failure are indices of handles, too. options.output is not used.
template <class Mesh>
Outcome<Fill<Mesh>> try_complete(Mesh& mesh, Options options = {}, const Extras& extras = {}) {
  if (extras.collect_garbage) mesh.garbage_collection();
  const bool with_shape = extras.colours == Colours::with_shape && mesh.has_vertex_colors() &&
                          options.vertex_values.empty();
  if (with_shape) detail::give_colours(mesh, options);
  const detail::Input<Mesh> input(mesh);
  if (auto failure = input.translate(options)) return *failure;
  options.output = Output::new_only;
  auto outcome = mesh_completion::try_complete(input.view(), options);
  if (!outcome) return input.translate_back(outcome.failure());
  Fill<Mesh> fill{{input.vertex_of(), input.face_of()}, {}, {}, *outcome, OpenMesh::VPropHandleT<Origin>()};

  detail::Undo<Mesh> undo(mesh);
  for (const auto& p : fill.result.new_vertices()) {
    typename Mesh::Point point;
    for (std::size_t k = 0; k < 3; ++k) point[k] = p[k];
    fill.vertices.push_back(mesh.add_vertex(point));
    fill.vertex_of.push_back(fill.vertices.back());
  }
  std::vector<detail::Triangle> triangles;
  for (const auto& f : fill.result.new_faces())
    triangles.push_back({fill.vertex(f[0]), fill.vertex(f[1]), fill.vertex(f[2])});
  if (const auto refused = detail::add_faces(mesh, triangles, fill.faces)) {
    Failure failure;
    failure.status = Status::hole_failed;
    failure.message = "OpenMesh cannot add a face of the fill; the mesh is as it was";
    for (const VertexHandle v : *refused)
      if (static_cast<std::size_t>(v.idx()) < mesh.n_vertices() - fill.vertices.size())
        failure.vertices.push_back(static_cast<std::uint32_t>(v.idx()));
    return failure;
  }
  fill.face_of.insert(fill.face_of.end(), fill.faces.begin(), fill.faces.end());
  detail::set_attributes(mesh, fill, input, extras);
  if (with_shape) detail::take_colours(mesh, fill);
  // Once they are there they must be right: copied from the rim they would not be.
  if (extras.origins || mesh.get_property_handle(fill.origins, origin_property))
    detail::set_origins(mesh, fill);
  undo.keep();
  return fill;
}

// The holes of a mesh.
template <class Mesh>
Outcome<HoleList> try_list_holes(const Mesh& mesh, Options options = {}) {
  const detail::Input<Mesh> input(mesh);
  if (auto failure = input.translate(options)) return *failure;
  auto outcome = mesh_completion::try_list_holes(input.view(), options);
  if (!outcome) return input.translate_back(outcome.failure());
  return HoleList{{input.vertex_of(), input.face_of()}, *outcome};
}

#if COMPLETE_MESH_HPP_EXCEPTIONS
template <class Mesh>
Fill<Mesh> complete(Mesh& mesh, const Options& options = {}, const Extras& extras = {}) {
  return try_complete(mesh, options, extras).take();
}

template <class Mesh>
HoleList list_holes(const Mesh& mesh, const Options& options = {}) {
  return try_list_holes(mesh, options).take();
}
#endif

}  // namespace openmesh
}  // namespace mesh_completion

#endif
