/* SPDX-License-Identifier: MIT OR Apache-2.0
 *
 * What a call gives back: the fill, its holes and sources.
 * Part of complete_mesh.hpp: include that.
 */
#ifndef COMPLETE_MESH_RESULT_HPP
#define COMPLETE_MESH_RESULT_HPP

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "enums.hpp"
#include "ranges.hpp"

namespace mesh_completion {

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
  std::uint32_t candidate_count;
  // Of a cloud.
  bool is_border;
  std::uint32_t detectors_asked;
  std::uint32_t detectors_agreed;
  double boundary_probability;
  double missing_points;

  bool is_found_by(Detector detector) const {
    return (detectors_agreed & static_cast<std::uint32_t>(detector)) != 0;
  }
  // Whether all detectors find it that can judge; one that they do not may be a sparse place.
  bool agreed() const { return detectors_agreed == detectors_asked; }
};

// See complete_mesh_source.
struct Source {
  bool mirrored;
  std::array<double, 12> transform;
  double error;
  double weight;
  std::size_t vertex_count;
  // New vertices that have their values, but not their shape, from here.
  std::size_t coloured_count;

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

// The holes of a mesh or a cloud, by id, and everything odd that was found there.
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
            c.coherence_error_before, c.coherence_error_after, c.candidate_count, c.is_border != 0,
            c.detectors_asked, c.detectors_agreed, c.boundary_probability, c.missing_points};
  }
  iterator begin() const { return iterator(this, 0); }
  iterator end() const { return iterator(this, size()); }

  // The places that the hole's fill was continued from, the greatest weight first.
  std::vector<Source> sources(std::size_t hole) const {
    std::vector<Source> all;
    complete_mesh_source c = {};
    while (complete_mesh_holes_source(get(), hole, all.size(), &c, sizeof c) == 1) {
      Source source = {c.mirrored != 0, {}, c.error, c.weight, c.vertex_count,
                       c.coloured_count};
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
  // Of a cloud; 0 for a mesh.
  double spacing() const { return complete_mesh_holes_spacing(get()); }
  // Centres of the places that only the distance field takes for holes of a cloud.
  Rows<double, 3> only_in_field() const {
    std::size_t n = 0;
    const double* p = complete_mesh_holes_only_in_field(get(), &n);
    return {p, n};
  }
  // Points of a cloud that were not looked at.
  View<std::uint32_t> ignored_points(Ignored kind) const {
    std::size_t n = 0;
    const std::uint32_t* p =
        complete_mesh_holes_ignored_points(get(), static_cast<std::uint32_t>(kind), &n);
    return {p, n};
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
  // The same of the values that the vertices carry, which may come from another place than the shape does.
  View<std::uint32_t> new_vertex_colour_faces() const {
    return {complete_mesh_result_new_vertex_colour_faces(get()), new_count()};
  }
  Rows<double, 3> new_vertex_colour_barycentrics() const {
    return {complete_mesh_result_new_vertex_colour_barycentrics(get()), new_count()};
  }
  View<std::uint32_t> new_vertex_colour_sources() const {
    return {complete_mesh_result_new_vertex_colour_sources(get()), new_count()};
  }
  View<double> new_vertex_colour_confidences() const {
    return {complete_mesh_result_new_vertex_colour_confidences(get()), new_count()};
  }
  // Of a cloud; empty for a mesh. mesh_completion::none where there is no source.
  View<std::uint32_t> new_point_source_points() const {
    return of_points<View<std::uint32_t>>(complete_mesh_result_new_vertex_source_points(get()));
  }
  Rows<double, 3> new_point_normals() const {
    return of_points<Rows<double, 3>>(complete_mesh_result_new_vertex_normals(get()));
  }
  // Of a cloud that Options::clean asked to clean, for each input point: where it lies in the copy, and
  // whether it is left out there; empty otherwise.
  Rows<double, 3> cleaned_points() const {
    const double* p = complete_mesh_result_cleaned_points(get());
    return {p, p ? input_vertex_count() : 0};
  }
  View<std::uint8_t> removed_points() const {
    const std::uint8_t* p = complete_mesh_result_removed_points(get());
    return {p, p ? input_vertex_count() : 0};
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

}  // namespace mesh_completion

#endif
