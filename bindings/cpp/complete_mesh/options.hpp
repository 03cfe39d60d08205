/* SPDX-License-Identifier: MIT OR Apache-2.0
 *
 * What a call is given: a mesh, options, a progress function.
 * Part of complete_mesh.hpp: include that.
 */
#ifndef COMPLETE_MESH_OPTIONS_HPP
#define COMPLETE_MESH_OPTIONS_HPP

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <iterator>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#include "enums.hpp"

namespace mesh_completion {

// A mesh that is somebody else's: pointers, counts, and bytes from one to the next (0: packed).
template <class Scalar>
struct MeshView {
  static_assert(std::is_same_v<Scalar, float> || std::is_same_v<Scalar, double>,
                "coordinates are float or double");
  const Scalar* vertices = nullptr;
  std::size_t vertex_count = 0;
  const std::uint32_t* faces = nullptr;
  std::size_t face_count = 0;
  std::size_t vertex_stride = 0;
  std::size_t face_stride = 0;
};

namespace detail {
template <class Element>
using Number = std::decay_t<decltype(std::declval<const Element&>()[0])>;

template <class Container>
using ElementOf = std::decay_t<decltype(*std::data(std::declval<const Container&>()))>;
}  // namespace detail

// Of containers of three packed numbers each, such as std::vector<std::array<float, 3>> or
// std::vector<Eigen::Vector3d>; indices are 32 bits wide.
template <class Vertices, class Faces>
auto view(const Vertices& vertices, const Faces& faces) {
  using Vertex = detail::ElementOf<Vertices>;
  using Face = detail::ElementOf<Faces>;
  using Scalar = detail::Number<Vertex>;
  using Index = detail::Number<Face>;
  static_assert(sizeof(Vertex) == 3 * sizeof(Scalar), "a vertex is three packed numbers");
  static_assert(std::is_integral_v<Index> && sizeof(Index) == 4 && sizeof(Face) == 12,
                "a face is three packed 32-bit indices");
  return MeshView<Scalar>{reinterpret_cast<const Scalar*>(std::data(vertices)), std::size(vertices),
                          reinterpret_cast<const std::uint32_t*>(std::data(faces)),
                          std::size(faces)};
}
// It would point into what is gone.
template <class Vertices, class Faces>
auto view(const Vertices&&, const Faces&) = delete;
template <class Vertices, class Faces>
auto view(const Vertices&, const Faces&&) = delete;
template <class Vertices, class Faces>
auto view(const Vertices&&, const Faces&&) = delete;

// What a progress function wants next.
enum class Next { go_on, cancel };

// Any callable of (double fraction, const char* stage) that returns Next or nothing. It may throw:
// the call is cancelled, cleans up, and the exception goes on to the caller.
class Progress {
 public:
  Progress() = default;
  Progress(std::nullptr_t) {}
  template <class F, class = std::enable_if_t<!std::is_same_v<std::decay_t<F>, Progress> &&
                                              std::is_invocable_v<F&, double, const char*>>>
  Progress(F&& function) {
    using Answer = std::invoke_result_t<F&, double, const char*>;
    // A bool would be read one way by one reader and the other way by the next.
    static_assert(std::is_void_v<Answer> || std::is_same_v<Answer, Next>,
                  "a progress function returns mesh_completion::Next or nothing");
    if constexpr (std::is_void_v<Answer>) {
      function_ = [f = std::forward<F>(function)](double fraction, const char* stage) mutable {
        f(fraction, stage);
        return Next::go_on;
      };
    } else {
      function_ = std::forward<F>(function);
    }
  }
  explicit operator bool() const { return static_cast<bool>(function_); }
  Next operator()(double fraction, const char* stage) const { return function_(fraction, stage); }

 private:
  std::function<Next(double, const char*)> function_;
};

// Triangles of one's own: an exemplar, an initial completion. The library gets the coordinates as the
// mesh has them: rounded for a mesh of floats.
struct Surface {
  std::vector<std::array<double, 3>> vertices = {};
  std::vector<std::array<std::uint32_t, 3>> faces = {};
};

// A copy of ranges of three numbers each, such as those of view() or of a Result.
template <class Vertices, class Faces>
Surface surface(const Vertices& vertices, const Faces& faces) {
  Surface copy;
  for (const auto& p : vertices)
    copy.vertices.push_back(
        {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])});
  for (const auto& f : faces)
    copy.faces.push_back({static_cast<std::uint32_t>(f[0]), static_cast<std::uint32_t>(f[1]),
                          static_cast<std::uint32_t>(f[2])});
  return copy;
}

// The options of every call; see complete_mesh_options. The number type and the strides come with
// the MeshView.
struct Options {
  Method method = Method::coherent;
  Fairing fairing = Fairing::automatic;
  Sizing sizing = Sizing::surroundings;
  double sizing_value = 1;
  Grouping grouping = Grouping::automatic;
  // One list of vertices for each hole, for Grouping::join.
  std::vector<std::vector<std::uint32_t>> join_vertices = {};
  Selection selection = Selection::all;
  std::vector<std::uint32_t> selection_ids = {};
  std::size_t selection_max_edges = 0;
  double selection_length = 0;
  std::array<double, 3> selection_point = {0, 0, 0};
  bool skip_unsafe = false;
  std::uint32_t threads = 0;
  Output output = Output::whole_mesh;
  Progress progress = {};
  // A flag for each face of the mesh, 0 where it may not be copied from; empty: all may.
  std::vector<std::uint8_t> source_faces = {};
  // Another mesh to copy from; no faces: none.
  Surface exemplar = {};
  bool exemplar_only = false;
  bool unmirrored = false;
  // New vertices and faces to start from, numbered as a result's are; no faces: none. What a result
  // has added: surface(result.new_vertices(), result.new_faces()).
  Surface initial = {};
  // What the vertices carry, value_channels numbers each, completed with the shape; empty: nothing.
  std::vector<double> vertex_values = {};
  // The same of the exemplar's vertices; empty: not known.
  std::vector<double> exemplar_values = {};
  std::uint32_t value_channels = 0;
  // How many of them, from the first on, help to find what is copied: 3 for red, green and blue.
  std::uint32_t steering_channels = 0;
  // The one place to copy from, given by hand: a transform as in Source; empty: places are searched for.
  std::optional<std::array<double, 12>> placement = {};
  // Improve the placement by what is known around the hole.
  bool refine = false;
  // Which of the places found a fill is made from, counted from 1; 0: all together. See
  // Hole::candidate_count and Completer::candidates.
  std::uint32_t candidate = 0;
  // Least and greatest factor by which sources may be scaled; empty: they are not.
  std::optional<std::array<double, 2>> scale_range = {};
  // How many vertices each of several exemplars has that stand one after the other; empty: one.
  std::vector<std::uint32_t> exemplar_parts = {};
  // Points inside holes that fills pass through, smooth ones, too.
  std::vector<std::array<double, 3>> constraint_points = {};
  // How far fills may stay off the points, 0 to 1.
  double softness = 0;
  // Take a missing part whole, with the source's own triangles: a hand, a foot, a spout.
  bool part = false;
  // Vertices of rims where the fill need only be joined, and goes on from nothing beyond them.
  std::vector<std::uint32_t> loose_vertices = {};
  // Of a point cloud: complete a cleaned copy, without outliers, its noise smoothed so many times, 3 as a
  // rule; empty: the points as they are. See Result::cleaned_points.
  std::optional<std::uint32_t> clean = {};
  // Holes of a point cloud that are given; if there are any, no others are looked for. Loops: points around
  // each in order, either way round. Regions: centre and radius of balls, in which holes, or the largest gap,
  // lie.
  std::vector<std::vector<std::uint32_t>> given_loops = {};
  std::vector<std::array<double, 4>> given_regions = {};
};

}  // namespace mesh_completion

#endif
