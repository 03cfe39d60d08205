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

#include <array>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <iterator>
#include <memory>
#include <new>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "complete_mesh.h"

#if defined(__cpp_exceptions) || defined(_CPPUNWIND)
#define COMPLETE_MESH_HPP_EXCEPTIONS 1
#else
#define COMPLETE_MESH_HPP_EXCEPTIONS 0
#endif

namespace mesh_completion {

// ---- enums ------------------------------------------------------------------------------------

enum class Status : std::int32_t {
  ok = COMPLETE_MESH_STATUS_OK,
  invalid_argument = COMPLETE_MESH_STATUS_INVALID_ARGUMENT,
  invalid_option = COMPLETE_MESH_STATUS_INVALID_OPTION,
  invalid_mesh = COMPLETE_MESH_STATUS_INVALID_MESH,
  no_such_hole = COMPLETE_MESH_STATUS_NO_SUCH_HOLE,
  unsafe_hole = COMPLETE_MESH_STATUS_UNSAFE_HOLE,
  hole_failed = COMPLETE_MESH_STATUS_HOLE_FAILED,
  unsupported = COMPLETE_MESH_STATUS_UNSUPPORTED,
  cancelled = COMPLETE_MESH_STATUS_CANCELLED,
  out_of_memory = COMPLETE_MESH_STATUS_OUT_OF_MEMORY,
  internal = COMPLETE_MESH_STATUS_INTERNAL
};

enum class Method : std::uint32_t {
  smooth = COMPLETE_MESH_METHOD_SMOOTH,
  coherent = COMPLETE_MESH_METHOD_COHERENT,
  harary = COMPLETE_MESH_METHOD_HARARY,
  fragment = COMPLETE_MESH_METHOD_FRAGMENT
};

enum class Fairing : std::uint32_t {
  automatic = COMPLETE_MESH_FAIRING_AUTO,
  none = COMPLETE_MESH_FAIRING_NONE,
  c0 = COMPLETE_MESH_FAIRING_C0,
  c1 = COMPLETE_MESH_FAIRING_C1,
  c2 = COMPLETE_MESH_FAIRING_C2,
  least_squares = COMPLETE_MESH_FAIRING_LEAST_SQUARES,
  smoothed_plate = COMPLETE_MESH_FAIRING_SMOOTHED_PLATE
};

enum class Sizing : std::uint32_t {
  surroundings = COMPLETE_MESH_SIZING_SURROUNDINGS,
  scaled = COMPLETE_MESH_SIZING_SCALED,
  edge_length = COMPLETE_MESH_SIZING_EDGE_LENGTH,
  none = COMPLETE_MESH_SIZING_NONE
};

enum class Grouping : std::uint32_t {
  automatic = COMPLETE_MESH_GROUPING_AUTOMATIC,
  separate = COMPLETE_MESH_GROUPING_SEPARATE,
  join = COMPLETE_MESH_GROUPING_JOIN
};

enum class Selection : std::uint32_t {
  all = COMPLETE_MESH_SELECTION_ALL,
  ids = COMPLETE_MESH_SELECTION_IDS,
  max_edges = COMPLETE_MESH_SELECTION_MAX_EDGES,
  max_circumference = COMPLETE_MESH_SELECTION_MAX_CIRCUMFERENCE,
  max_diameter = COMPLETE_MESH_SELECTION_MAX_DIAMETER,
  all_but_largest = COMPLETE_MESH_SELECTION_ALL_BUT_LARGEST,
  near_point = COMPLETE_MESH_SELECTION_NEAR_POINT,
  near_vertices = COMPLETE_MESH_SELECTION_NEAR_VERTICES
};

enum class Output : std::uint32_t {
  whole_mesh = COMPLETE_MESH_OUTPUT_WHOLE_MESH,
  new_only = COMPLETE_MESH_OUTPUT_NEW_ONLY
};

enum class HoleKind : std::uint32_t {
  disc = COMPLETE_MESH_HOLE_KIND_DISC,
  islands = COMPLETE_MESH_HOLE_KIND_ISLANDS,
  ring = COMPLETE_MESH_HOLE_KIND_RING,
  several = COMPLETE_MESH_HOLE_KIND_SEVERAL
};

enum class HoleStatus : std::uint32_t {
  open = COMPLETE_MESH_HOLE_STATUS_OPEN,
  filled = COMPLETE_MESH_HOLE_STATUS_FILLED,
  not_selected = COMPLETE_MESH_HOLE_STATUS_NOT_SELECTED,
  unsafe = COMPLETE_MESH_HOLE_STATUS_UNSAFE,
  failed = COMPLETE_MESH_HOLE_STATUS_FAILED
};

inline const char* to_string(Status status) {
  return complete_mesh_status_name(static_cast<std::int32_t>(status));
}

// No face, no source: see Result::new_vertex_source_faces.
inline constexpr std::uint32_t none = UINT32_MAX;

// Of the library that is running.
inline std::uint32_t version() { return complete_mesh_version(); }
inline const char* version_string() { return complete_mesh_version_string(); }
inline std::uint32_t abi_version() { return complete_mesh_abi_version(); }

// ---- ranges -----------------------------------------------------------------------------------

namespace detail {
// Goes through anything that has operator[].
template <class Range>
class IndexIterator {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = std::decay_t<decltype(std::declval<const Range&>()[0])>;
  using difference_type = std::ptrdiff_t;
  using pointer = const value_type*;
  using reference = value_type;

  IndexIterator() = default;
  IndexIterator(const Range* range, std::size_t at) : range_(range), at_(at) {}
  value_type operator*() const { return (*range_)[at_]; }
  IndexIterator& operator++() { return ++at_, *this; }
  IndexIterator operator++(int) { return IndexIterator(range_, at_++); }
  bool operator==(const IndexIterator& other) const { return at_ == other.at_; }
  bool operator!=(const IndexIterator& other) const { return at_ != other.at_; }

 private:
  const Range* range_ = nullptr;
  std::size_t at_ = 0;
};
}  // namespace detail

// Numbers in a row that belong to somebody else: C++20's span in short.
template <class T>
class View {
 public:
  View() = default;
  View(const T* data, std::size_t size) : data_(data), size_(data ? size : 0) {}
  const T* data() const { return data_; }
  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  const T& operator[](std::size_t i) const { return data_[i]; }
  const T* begin() const { return data_; }
  const T* end() const { return data_ + size_; }

 private:
  const T* data_ = nullptr;
  std::size_t size_ = 0;
};

// Rows of N numbers each, packed: points, faces, edges. data() is the first number of the first.
template <class T, std::size_t N>
class Rows {
 public:
  using iterator = detail::IndexIterator<Rows>;
  Rows() = default;
  Rows(const T* data, std::size_t size) : data_(data), size_(data ? size : 0) {}
  const T* data() const { return data_; }
  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  std::array<T, N> operator[](std::size_t i) const {
    std::array<T, N> row{};
    for (std::size_t k = 0; k < N; ++k) row[k] = data_[N * i + k];
    return row;
  }
  iterator begin() const { return iterator(this, 0); }
  iterator end() const { return iterator(this, size_); }

 private:
  const T* data_ = nullptr;
  std::size_t size_ = 0;
};

using Edge = std::array<std::uint32_t, 2>;

// ---- input ------------------------------------------------------------------------------------

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

// ---- options ----------------------------------------------------------------------------------

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
};

// ---- failures ---------------------------------------------------------------------------------

// What went wrong and where: elements of the input, so that a host can select or draw them.
struct Failure {
  Status status = Status::internal;
  std::string message = {};
  std::vector<std::uint32_t> vertices = {};
  std::vector<Edge> edges = {};
  std::vector<std::uint32_t> faces = {};
  std::vector<std::uint32_t> holes = {};
  // What the progress function threw, if that is why the call was cancelled.
  std::exception_ptr thrown = nullptr;
};

class Error : public std::runtime_error {
 public:
  explicit Error(Failure failure)
      : std::runtime_error(failure.message),
        failure_(std::make_shared<const Failure>(std::move(failure))) {}
  Status status() const { return failure_->status; }
  const Failure& failure() const { return *failure_; }

 private:
  // Shared, since copying an exception must not throw.
  std::shared_ptr<const Failure> failure_;
};

// A value, or why there is none.
template <class T>
class Outcome {
 public:
  Outcome(T value) : value_(std::move(value)) {}
  Outcome(Failure failure) : failure_(std::move(failure)) {}
  bool has_value() const { return value_.has_value(); }
  explicit operator bool() const { return has_value(); }
  Status status() const { return has_value() ? Status::ok : failure_.status; }
  // Only with a value.
  T& operator*() { return *value_; }
  const T& operator*() const { return *value_; }
  T* operator->() { return &*value_; }
  const T* operator->() const { return &*value_; }
  // Empty, with a status of no meaning, beside a value.
  const Failure& failure() const { return failure_; }

#if COMPLETE_MESH_HPP_EXCEPTIONS
  // The value; throws Error, or what the progress function threw.
  T take() && {
    if (has_value()) return std::move(*value_);
    if (failure_.thrown) std::rethrow_exception(failure_.thrown);
    throw Error(std::move(failure_));
  }
#endif

 private:
  std::optional<T> value_;
  Failure failure_;
};

// ---- results ----------------------------------------------------------------------------------

// See complete_mesh_hole.
struct Hole {
  std::uint32_t id;
  HoleKind kind;
  HoleStatus status;
  Fairing fairing;
  Method method;
  bool is_unsafe;
  std::size_t loop_count;
  std::size_t edge_count;
  double circumference;
  double diameter;
  std::array<double, 3> centre;
  std::size_t first_new_vertex;
  std::size_t new_vertex_count;
  std::size_t first_new_face;
  std::size_t new_face_count;
  double seconds;
  std::uint32_t source_count;
  double confidence;
  double coherence_error_before;
  double coherence_error_after;
};

// See complete_mesh_source.
struct Source {
  bool mirrored;
  std::array<double, 12> transform;
  double error;
  double weight;
  std::size_t vertex_count;

  // A point of the object, taken to the hole.
  std::array<double, 3> apply(const std::array<double, 3>& p) const {
    std::array<double, 3> q{};
    for (std::size_t i = 0; i < 3; ++i) {
      const double* row = transform.data() + 4 * i;
      q[i] = row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3];
    }
    return q;
  }
};

// The holes of a mesh, by id, and everything odd that was found at its boundary.
class Holes {
 public:
  using iterator = detail::IndexIterator<Holes>;
  explicit Holes(std::shared_ptr<const complete_mesh_holes> holes) : holes_(std::move(holes)) {}

  std::size_t size() const { return complete_mesh_holes_count(get()); }
  bool empty() const { return size() == 0; }
  Hole operator[](std::size_t hole) const {
    complete_mesh_hole c = {};
    complete_mesh_holes_get(get(), hole, &c, sizeof c);
    return {c.id, static_cast<HoleKind>(c.kind), static_cast<HoleStatus>(c.status),
            static_cast<Fairing>(c.fairing), static_cast<Method>(c.method), c.is_unsafe != 0,
            c.loop_count, c.edge_count, c.circumference, c.diameter,
            {c.centre[0], c.centre[1], c.centre[2]}, c.first_new_vertex, c.new_vertex_count,
            c.first_new_face, c.new_face_count, c.seconds, c.source_count, c.confidence,
            c.coherence_error_before, c.coherence_error_after};
  }
  iterator begin() const { return iterator(this, 0); }
  iterator end() const { return iterator(this, size()); }

  // The places that the hole's fill was continued from, the greatest weight first.
  std::vector<Source> sources(std::size_t hole) const {
    std::vector<Source> all;
    complete_mesh_source c = {};
    while (complete_mesh_holes_source(get(), hole, all.size(), &c, sizeof c) == 1) {
      Source source = {c.mirrored != 0, {}, c.error, c.weight, c.vertex_count};
      for (std::size_t k = 0; k < 12; ++k) source.transform[k] = c.transform[k];
      all.push_back(source);
    }
    return all;
  }
  View<std::uint32_t> loop(std::size_t hole, std::size_t loop_index) const {
    std::size_t n = 0;
    const std::uint32_t* p = complete_mesh_holes_loop(get(), hole, loop_index, &n);
    return {p, n};
  }
  std::string_view reason(std::size_t hole) const { return complete_mesh_holes_reason(get(), hole); }
  View<std::uint32_t> problem_vertices(std::size_t hole) const {
    return problem<View<std::uint32_t>>(hole, COMPLETE_MESH_ELEMENT_KIND_VERTEX);
  }
  Rows<std::uint32_t, 2> problem_edges(std::size_t hole) const {
    return problem<Rows<std::uint32_t, 2>>(hole, COMPLETE_MESH_ELEMENT_KIND_EDGE);
  }
  View<std::uint32_t> problem_faces(std::size_t hole) const {
    return problem<View<std::uint32_t>>(hole, COMPLETE_MESH_ELEMENT_KIND_FACE);
  }
  Rows<std::uint32_t, 2> non_manifold_edges() const {
    return listed<Rows<std::uint32_t, 2>>(complete_mesh_holes_non_manifold_edges);
  }
  Rows<std::uint32_t, 2> inconsistent_edges() const {
    return listed<Rows<std::uint32_t, 2>>(complete_mesh_holes_inconsistent_edges);
  }
  View<std::uint32_t> degenerate_faces() const {
    return listed<View<std::uint32_t>>(complete_mesh_holes_degenerate_faces);
  }
  Rows<std::uint32_t, 2> duplicate_vertices() const {
    return listed<Rows<std::uint32_t, 2>>(complete_mesh_holes_duplicate_vertices);
  }
  const complete_mesh_holes* get() const { return holes_.get(); }

 private:
  template <class Range>
  Range problem(std::size_t hole, std::uint32_t kind) const {
    std::size_t n = 0;
    const std::uint32_t* p = complete_mesh_holes_problem_elements(get(), hole, kind, &n);
    return {p, n};
  }
  template <class Range, class Function>
  Range listed(Function function) const {
    std::size_t n = 0;
    const std::uint32_t* p = function(get(), &n);
    return {p, n};
  }

  std::shared_ptr<const complete_mesh_holes> holes_;
};

// A completed mesh. With Output::new_only vertices() and faces() are empty.
template <class Scalar>
class Result {
 public:
  explicit Result(complete_mesh_result* result, std::uint32_t value_channels = 0)
      : result_(result, complete_mesh_result_free), value_channels_(value_channels) {}

  std::size_t input_vertex_count() const { return complete_mesh_result_input_vertex_count(get()); }
  std::size_t input_face_count() const { return complete_mesh_result_input_face_count(get()); }
  Rows<Scalar, 3> vertices() const {
    return {static_cast<const Scalar*>(complete_mesh_result_vertices(get())),
            complete_mesh_result_vertex_count(get())};
  }
  Rows<std::uint32_t, 3> faces() const {
    return {complete_mesh_result_faces(get()), complete_mesh_result_face_count(get())};
  }
  Rows<Scalar, 3> new_vertices() const {
    return {static_cast<const Scalar*>(complete_mesh_result_new_vertices(get())), new_count()};
  }
  Rows<std::uint32_t, 3> new_faces() const {
    return {complete_mesh_result_new_faces(get()), new_face_count()};
  }
  View<std::uint32_t> new_vertex_holes() const {
    return {complete_mesh_result_new_vertex_holes(get()), new_count()};
  }
  View<std::uint32_t> new_face_holes() const {
    return {complete_mesh_result_new_face_holes(get()), new_face_count()};
  }
  // mesh_completion::none where there is no source; from the input's face count on: faces of the
  // exemplar.
  View<std::uint32_t> new_vertex_source_faces() const {
    return {complete_mesh_result_new_vertex_source_faces(get()), new_count()};
  }
  Rows<double, 3> new_vertex_barycentrics() const {
    return {complete_mesh_result_new_vertex_barycentrics(get()), new_count()};
  }
  View<std::uint32_t> new_vertex_sources() const {
    return {complete_mesh_result_new_vertex_sources(get()), new_count()};
  }
  View<double> new_vertex_confidences() const {
    return {complete_mesh_result_new_vertex_confidences(get()), new_count()};
  }
  // Of a cloud; empty for a mesh. mesh_completion::none where there is no source.
  View<std::uint32_t> new_point_source_points() const {
    return of_points<View<std::uint32_t>>(complete_mesh_result_new_vertex_source_points(get()));
  }
  Rows<double, 3> new_point_normals() const {
    return of_points<Rows<double, 3>>(complete_mesh_result_new_vertex_normals(get()));
  }
  // Options::value_channels numbers for each new vertex; empty without Options::vertex_values.
  View<double> new_vertex_values() const {
    return {complete_mesh_result_new_vertex_values(get()), new_count() * value_channels_};
  }
  // All holes of the input, filled or not: the report.
  Holes holes() const {
    return Holes(std::shared_ptr<const complete_mesh_holes>(result_,
                                                            complete_mesh_result_holes(get())));
  }
  std::size_t filled_count() const { return complete_mesh_result_filled_count(get()); }
  double seconds() const { return complete_mesh_result_seconds(get()); }
  double cpu_seconds() const { return complete_mesh_result_cpu_seconds(get()); }
  const complete_mesh_result* get() const { return result_.get(); }

 private:
  std::size_t new_count() const { return complete_mesh_result_new_vertex_count(get()); }
  std::size_t new_face_count() const { return complete_mesh_result_new_face_count(get()); }
  // NULL for a mesh.
  template <class Range, class Number>
  Range of_points(const Number* p) const {
    return {p, p ? new_count() : 0};
  }

  std::shared_ptr<complete_mesh_result> result_;
  std::size_t value_channels_;
};

// ---- calls ------------------------------------------------------------------------------------

namespace detail {

// The options as the C ABI wants them, and what must live while a call lasts.
class Call {
 public:
  template <class Scalar>
  Call(const Options& options, const MeshView<Scalar>& mesh) : progress_(options.progress) {
    complete_mesh_options_init(&c_, sizeof c_);
    c_.vertex_type = std::is_same_v<Scalar, double> ? COMPLETE_MESH_VERTEX_TYPE_F64
                                                    : COMPLETE_MESH_VERTEX_TYPE_F32;
    c_.vertex_stride = mesh.vertex_stride;
    c_.face_stride = mesh.face_stride;
    set(options);
    set_sources<Scalar>(options, mesh.face_count);
    set_values(options, mesh.vertex_count);
    if (progress_) {
      c_.progress = &Call::report;
      c_.progress_user = this;
    }
  }
  Call(const Call&) = delete;
  Call& operator=(const Call&) = delete;

  // What the C call could not see: it trusts the lists to be as long as the mesh's.
  const std::optional<Failure>& refused() const { return refused_; }
  const complete_mesh_options* options() const { return &c_; }

  // Of the call that has just failed on this thread.
  Failure failure(complete_mesh_status status) const {
    Failure failure;
    failure.status = static_cast<Status>(status);
    failure.message = complete_mesh_last_error_message();
    failure.vertices = named(COMPLETE_MESH_ELEMENT_KIND_VERTEX);
    failure.faces = named(COMPLETE_MESH_ELEMENT_KIND_FACE);
    failure.holes = named(COMPLETE_MESH_ELEMENT_KIND_HOLE);
    std::size_t n = 0;
    const std::uint32_t* p = complete_mesh_last_error_elements(COMPLETE_MESH_ELEMENT_KIND_EDGE, &n);
    for (std::size_t i = 0; i < n; ++i) failure.edges.push_back({p[2 * i], p[2 * i + 1]});
    failure.thrown = thrown_;
    return failure;
  }

 private:
  void set(const Options& options) {
    c_.method = static_cast<std::uint32_t>(options.method);
    c_.fairing = static_cast<std::uint32_t>(options.fairing);
    c_.sizing = static_cast<std::uint32_t>(options.sizing);
    c_.sizing_value = options.sizing_value;
    c_.grouping = static_cast<std::uint32_t>(options.grouping);
    c_.selection = static_cast<std::uint32_t>(options.selection);
    c_.selection_ids = options.selection_ids.empty() ? nullptr : options.selection_ids.data();
    c_.selection_count = options.selection_ids.size();
    c_.selection_max_edges = options.selection_max_edges;
    c_.selection_length = options.selection_length;
    for (std::size_t k = 0; k < 3; ++k) c_.selection_point[k] = options.selection_point[k];
    for (const auto& list : options.join_vertices) {
      join_sizes_.push_back(static_cast<std::uint32_t>(list.size()));
      join_vertices_.insert(join_vertices_.end(), list.begin(), list.end());
    }
    c_.join_vertices = join_vertices_.empty() ? nullptr : join_vertices_.data();
    c_.join_sizes = join_sizes_.empty() ? nullptr : join_sizes_.data();
    c_.join_count = join_sizes_.size();
    c_.skip_unsafe = options.skip_unsafe ? 1 : 0;
    c_.threads = options.threads;
    c_.output = static_cast<std::uint32_t>(options.output);
  }
  template <class Scalar>
  void set_sources(const Options& options, std::size_t face_count) {
    const auto& flags = options.source_faces;
    if (!flags.empty() && flags.size() != face_count) {
      refused_.emplace();
      refused_->status = Status::invalid_argument;
      refused_->message = "source_faces has " + std::to_string(flags.size()) + " flags, but the mesh has " +
                          std::to_string(face_count) + " faces";
      return;
    }
    c_.source_faces = flags.empty() ? nullptr : flags.data();
    c_.exemplar_vertices = numbers<Scalar>(options.exemplar, exemplar_);
    c_.exemplar_vertex_count = options.exemplar.vertices.size();
    c_.exemplar_faces = corners(options.exemplar);
    c_.exemplar_face_count = options.exemplar.faces.size();
    c_.exemplar_only = options.exemplar_only ? 1 : 0;
    c_.unmirrored = options.unmirrored ? 1 : 0;
    c_.initial_vertices = numbers<Scalar>(options.initial, initial_);
    c_.initial_vertex_count = options.initial.vertices.size();
    c_.initial_faces = corners(options.initial);
    c_.initial_face_count = options.initial.faces.size();
  }
  void set_values(const Options& options, std::size_t vertex_count) {
    fits("vertex_values", options.vertex_values, options.value_channels, vertex_count);
    fits("exemplar_values", options.exemplar_values, options.value_channels, options.exemplar.vertices.size());
    c_.vertex_values = options.vertex_values.empty() ? nullptr : options.vertex_values.data();
    c_.exemplar_values = options.exemplar_values.empty() ? nullptr : options.exemplar_values.data();
    c_.value_channels = options.value_channels;
    c_.steering_channels = options.steering_channels;
  }
  void fits(const char* name, const std::vector<double>& values, std::size_t channels, std::size_t count) {
    if (values.empty() || values.size() == channels * count || refused_) return;
    refused_.emplace();
    refused_->status = Status::invalid_argument;
    refused_->message = std::string(name) + " has " + std::to_string(values.size()) + " numbers, not " +
                        std::to_string(channels) + " for each of " + std::to_string(count) + " vertices";
  }
  // The coordinates as the mesh has them; `rounded` keeps those that are not as they were given.
  template <class Scalar>
  static const void* numbers(const Surface& from, std::vector<float>& rounded) {
    if (from.vertices.empty()) return nullptr;
    if constexpr (std::is_same_v<Scalar, double>) {
      return from.vertices.data();
    } else {
      for (const auto& p : from.vertices)
        for (const double x : p) rounded.push_back(static_cast<float>(x));
      return rounded.data();
    }
  }
  static const std::uint32_t* corners(const Surface& from) {
    return from.faces.empty() ? nullptr : from.faces[0].data();
  }
  static std::vector<std::uint32_t> named(std::uint32_t kind) {
    std::size_t n = 0;
    const std::uint32_t* p = complete_mesh_last_error_elements(kind, &n);
    return n ? std::vector<std::uint32_t>(p, p + n) : std::vector<std::uint32_t>();
  }

  // No exception may cross the C ABI.
  static int report(void* user, double fraction, const char* stage) noexcept {
    Call& call = *static_cast<Call*>(user);
#if COMPLETE_MESH_HPP_EXCEPTIONS
    try {
      return call.progress_(fraction, stage) == Next::cancel;
    } catch (...) {
      call.thrown_ = std::current_exception();
      return 1;
    }
#else
    return call.progress_(fraction, stage) == Next::cancel;
#endif
  }

  complete_mesh_options c_;
  const Progress& progress_;
  std::vector<std::uint32_t> join_vertices_;
  std::vector<std::uint32_t> join_sizes_;
  std::vector<float> exemplar_, initial_;
  std::optional<Failure> refused_;
  std::exception_ptr thrown_;
};

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
  return Holes(std::shared_ptr<const complete_mesh_holes>(holes, [](const complete_mesh_holes* h) {
    complete_mesh_holes_free(const_cast<complete_mesh_holes*>(h));
  }));
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
#endif

}  // namespace mesh_completion

#endif
