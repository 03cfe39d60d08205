/* SPDX-License-Identifier: MIT OR Apache-2.0
 *
 * complete-mesh for C++17: the C ABI with owners, ranges, enums and exceptions; header-only.
 *
 *   namespace mc = mesh_completion;
 *   std::vector<std::array<float, 3>> vertices = ...;
 *   std::vector<std::array<std::uint32_t, 3>> faces = ...;
 *   const auto result = mc::complete(mc::view(vertices, faces));
 *   for (auto [x, y, z] : result.new_vertices()) ...
 *
 * complete_mesh.h is the manual: names here are its names without the prefix, and what is not said
 * here is said there. A call that fails throws mesh_completion::Error; the calls whose names begin
 * with try_ return an Outcome instead. Without exceptions (-fno-exceptions) only those are there.
 *
 * Ranges point into the object that they were asked of and live as long as it or a copy of it does;
 * a copy shares, it costs nothing. Everything may be read by many threads at once.
 */
#ifndef COMPLETE_MESH_HPP
#define COMPLETE_MESH_HPP

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "complete_mesh/call.hpp"
#include "complete_mesh/enums.hpp"
#include "complete_mesh/failure.hpp"
#include "complete_mesh/options.hpp"
#include "complete_mesh/ranges.hpp"
#include "complete_mesh/result.hpp"

namespace mesh_completion {

namespace detail {
inline Holes owned(complete_mesh_holes* holes) {
  return Holes(std::shared_ptr<const complete_mesh_holes>(holes, [](const complete_mesh_holes* h) {
    complete_mesh_holes_free(const_cast<complete_mesh_holes*>(h));
  }));
}
}  // namespace detail

// Fills the holes of a mesh.
template <class Scalar>
Outcome<Result<Scalar>> try_complete(const MeshView<Scalar>& mesh, const Options& options = {}) {
  detail::Call call(options, mesh);
  if (call.refused()) return *call.refused();
  complete_mesh_result* result = nullptr;
  const complete_mesh_status status = ::complete_mesh(mesh.vertices, mesh.vertex_count, mesh.faces,
                                                      mesh.face_count, call.options(), &result);
  if (status != COMPLETE_MESH_STATUS_OK) return call.failure(status);
  return Result<Scalar>(result, options.value_channels);
}

// Fills the holes of a point cloud: complete_mesh_points. The view's faces are not used; its vertices
// are the points, and so are those of the result. normals: as many, packed, or nullptr.
template <class Scalar>
Outcome<Result<Scalar>> try_complete_points(const MeshView<Scalar>& cloud,
                                            const Scalar* normals = nullptr,
                                            const Options& options = {}) {
  detail::Call call(options, cloud);
  if (call.refused()) return *call.refused();
  complete_mesh_result* result = nullptr;
  const complete_mesh_status status = complete_mesh_points(
      cloud.vertices, cloud.vertex_count, normals, call.options(), &result);
  if (status != COMPLETE_MESH_STATUS_OK) return call.failure(status);
  return Result<Scalar>(result, options.value_channels);
}

// Finds and measures the holes of a mesh and fills nothing: complete_mesh_find_holes.
template <class Scalar>
Outcome<Holes> try_list_holes(const MeshView<Scalar>& mesh, const Options& options = {}) {
  detail::Call call(options, mesh);
  if (call.refused()) return *call.refused();
  complete_mesh_holes* holes = nullptr;
  const complete_mesh_status status = complete_mesh_find_holes(
      mesh.vertices, mesh.vertex_count, mesh.faces, mesh.face_count, call.options(), &holes);
  if (status != COMPLETE_MESH_STATUS_OK) return call.failure(status);
  return detail::owned(holes);
}

// Finds and measures the holes of a point cloud and fills nothing: complete_mesh_find_point_holes. The
// view's faces are not used. normals: as many as points, packed, or nullptr.
template <class Scalar>
Outcome<Holes> try_list_point_holes(const MeshView<Scalar>& cloud, const Scalar* normals = nullptr,
                                    const Options& options = {}) {
  detail::Call call(options, cloud);
  if (call.refused()) return *call.refused();
  complete_mesh_holes* holes = nullptr;
  const complete_mesh_status status = complete_mesh_find_point_holes(
      cloud.vertices, cloud.vertex_count, normals, call.options(), &holes);
  if (status != COMPLETE_MESH_STATUS_OK) return call.failure(status);
  return detail::owned(holes);
}

// A mesh whose holes are known, for filling them more than once. It borrows the arrays of the
// MeshView: they must stay as they are while it, or a copy, is used. Any number of threads may use it.
template <class Scalar>
class Completer {
 public:
#if COMPLETE_MESH_HPP_EXCEPTIONS
  explicit Completer(const MeshView<Scalar>& mesh, const Options& options = {})
      : Completer(make(mesh, options).take()) {}
  Result<Scalar> complete(const Options& options = {}) const { return try_complete(options).take(); }
  std::vector<Result<Scalar>> candidates(std::size_t count, const Options& options = {}) const {
    return try_candidates(count, options).take();
  }
#endif
  static Outcome<Completer> make(const MeshView<Scalar>& mesh, const Options& options = {}) {
    detail::Call call(options, mesh);
    if (call.refused()) return *call.refused();
    complete_mesh_completer* completer = nullptr;
    const complete_mesh_status status =
        complete_mesh_completer_new(mesh.vertices, mesh.vertex_count, mesh.faces, mesh.face_count,
                                    call.options(), &completer);
    if (status != COMPLETE_MESH_STATUS_OK) return call.failure(status);
    return Completer(completer, mesh.vertex_count, mesh.face_count);
  }

  // options.grouping and join_vertices were settled by the constructor and are not used.
  Outcome<Result<Scalar>> try_complete(const Options& options = {}) const {
    MeshView<Scalar> mesh;
    mesh.vertex_count = vertex_count_;
    mesh.face_count = face_count_;
    detail::Call call(options, mesh);
    if (call.refused()) return *call.refused();
    complete_mesh_result* result = nullptr;
    const complete_mesh_status status =
        complete_mesh_completer_complete(get(), call.options(), &result);
    if (status != COMPLETE_MESH_STATUS_OK) return call.failure(status);
    return Result<Scalar>(result, options.value_channels);
  }
  // The completions that the best places alone make, best first, `count` at most; the places are
  // searched for once. options.candidate is not used.
  Outcome<std::vector<Result<Scalar>>> try_candidates(std::size_t count, Options options = {}) const {
    std::vector<Result<Scalar>> made;
    while (made.size() < count) {
      options.candidate = static_cast<std::uint32_t>(made.size() + 1);
      auto result = try_complete(options);
      if (!result) return result.failure();
      bool more = false;
      for (const Hole& hole : result->holes()) more = more || hole.candidate_count >= options.candidate;
      if (!more) break;
      made.push_back(std::move(*result));
    }
    return made;
  }
  Holes holes() const {
    return Holes(std::shared_ptr<const complete_mesh_holes>(completer_,
                                                            complete_mesh_completer_holes(get())));
  }
  const complete_mesh_completer* get() const { return completer_.get(); }

 private:
  Completer(complete_mesh_completer* completer, std::size_t vertex_count, std::size_t face_count)
      : completer_(completer, complete_mesh_completer_free),
        vertex_count_(vertex_count),
        face_count_(face_count) {}

  std::shared_ptr<complete_mesh_completer> completer_;
  std::size_t vertex_count_;
  std::size_t face_count_;
};

#if COMPLETE_MESH_HPP_EXCEPTIONS
template <class Scalar>
Result<Scalar> complete(const MeshView<Scalar>& mesh, const Options& options = {}) {
  return try_complete(mesh, options).take();
}

template <class Scalar>
Result<Scalar> complete_points(const MeshView<Scalar>& cloud, const Scalar* normals = nullptr,
                               const Options& options = {}) {
  return try_complete_points(cloud, normals, options).take();
}

template <class Scalar>
Holes list_holes(const MeshView<Scalar>& mesh, const Options& options = {}) {
  return try_list_holes(mesh, options).take();
}

template <class Scalar>
Holes list_point_holes(const MeshView<Scalar>& cloud, const Scalar* normals = nullptr,
                       const Options& options = {}) {
  return try_list_point_holes(cloud, normals, options).take();
}
#endif

}  // namespace mesh_completion

#endif
