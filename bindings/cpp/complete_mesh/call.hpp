/* SPDX-License-Identifier: MIT OR Apache-2.0
 *
 * Options and failures over to the C ABI and back.
 * Part of complete_mesh.hpp: include that.
 */
#ifndef COMPLETE_MESH_CALL_HPP
#define COMPLETE_MESH_CALL_HPP

#include <cstddef>
#include <cstdint>
#include <exception>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "failure.hpp"
#include "options.hpp"

namespace mesh_completion {

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
    set_guidance(options);
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
    join_.set(options.join_vertices, c_.join_vertices, c_.join_sizes, c_.join_count);
    loops_.set(options.given_loops, c_.given_loop_points, c_.given_loop_sizes, c_.given_loop_count);
    c_.given_regions = options.given_regions.empty() ? nullptr : options.given_regions[0].data();
    c_.given_region_count = options.given_regions.size();
    c_.skip_unsafe = options.skip_unsafe ? 1 : 0;
    c_.clean = options.clean ? 1 : 0;
    if (options.clean) c_.clean_rounds = *options.clean;
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
  void set_guidance(const Options& options) {
    c_.placement = options.placement ? options.placement->data() : nullptr;
    c_.refine = options.refine ? 1 : 0;
    c_.candidate = options.candidate;
    c_.exemplar_parts = options.exemplar_parts.empty() ? nullptr : options.exemplar_parts.data();
    c_.exemplar_part_count = options.exemplar_parts.size();
    c_.constraint_points =
        options.constraint_points.empty() ? nullptr : options.constraint_points[0].data();
    c_.constraint_count = options.constraint_points.size();
    c_.softness = options.softness;
    c_.part = options.part;
    c_.loose_vertices = options.loose_vertices.empty() ? nullptr : options.loose_vertices.data();
    c_.loose_count = options.loose_vertices.size();
    if (!options.scale_range) return;
    c_.least_scale = (*options.scale_range)[0];
    c_.greatest_scale = (*options.scale_range)[1];
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
  // Lists of indices as C takes them.
  struct Lists {
    std::vector<std::uint32_t> numbers, sizes;
    void set(const std::vector<std::vector<std::uint32_t>>& all, const std::uint32_t*& c_numbers,
             const std::uint32_t*& c_sizes, std::size_t& c_count) {
      for (const auto& list : all) {
        sizes.push_back(static_cast<std::uint32_t>(list.size()));
        numbers.insert(numbers.end(), list.begin(), list.end());
      }
      c_numbers = numbers.empty() ? nullptr : numbers.data();
      c_sizes = sizes.empty() ? nullptr : sizes.data();
      c_count = sizes.size();
    }
  };
  Lists join_, loops_;
  std::vector<float> exemplar_, initial_;
  std::optional<Failure> refused_;
  std::exception_ptr thrown_;
};

}  // namespace detail

}  // namespace mesh_completion

#endif
