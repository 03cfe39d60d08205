/* SPDX-License-Identifier: MIT OR Apache-2.0
 *
 * What a fill's elements carry besides their place: colours and other numbers of the vertices, taken
 * from the rim or from the source, and what new faces take after.
 *
 * From the rim: harmonic for the uniform Laplacian, as the command line has it: each new vertex has
 * the mean of its neighbours, the rim is fixed. No value appears that is not between the rim's.
 */
#ifndef COMPLETE_MESH_ATTRIBUTES_HPP
#define COMPLETE_MESH_ATTRIBUTES_HPP

#include <algorithm>
#include <cmath>
#include <map>

#include "complete_mesh.hpp"

namespace mesh_completion {

// The fill as a graph: its new vertices first, then the input vertices at its rim.
class Carrier {
 public:
  template <class Scalar>
  explicit Carrier(const Result<Scalar>& result)
      : new_count_(result.new_vertices().size()), input_count_(result.input_vertex_count()) {
    const auto faces = result.new_faces();
    for (const auto& face : faces)
      for (const std::uint32_t v : face)
        if (v < input_count_) rim_.push_back(v);
    std::sort(rim_.begin(), rim_.end());
    rim_.erase(std::unique(rim_.begin(), rim_.end()), rim_.end());
    link(faces);
    walk_inward();
  }

  // Input vertices that the fill touches, sorted.
  const std::vector<std::uint32_t>& rim() const { return rim_; }

  // For each new vertex the vertex of the rim that is the fewest edges away, for labels: between 3
  // and 7 there is no 5.
  std::vector<std::uint32_t> nearest() const {
    std::vector<std::uint32_t> found(new_count_, none);
    found.insert(found.end(), rim_.begin(), rim_.end());
    for (const Step& step : inward_) found[step.node] = found[step.from];
    found.resize(new_count_);
    return found;
  }

  // One row of N numbers for each new vertex; get(v) is the row, a std::array<double, N>, of input
  // vertex v.
  template <std::size_t N, class Get>
  std::vector<std::array<double, N>> from_rim(const Get& get) const {
    std::vector<std::array<double, N>> rows(new_count_, std::array<double, N>{});
    for (const std::uint32_t v : rim_) rows.push_back(get(v));
    for (const Step& step : inward_) rows[step.node] = rows[step.from];
    relax(rows);
    rows.resize(new_count_);
    return rows;
  }

  // The same; a vertex that was copied from somewhere on the mesh has the value of that place.
  // corners(f) are the vertices of input face f.
  template <std::size_t N, class Scalar, class Get, class Corners>
  std::vector<std::array<double, N>> from_source(const Result<Scalar>& result, const Get& get,
                                                 const Corners& corners) const {
    auto rows = from_rim<N>(get);
    const auto faces = result.new_vertex_colour_faces();
    const auto weights = result.new_vertex_colour_barycentrics();
    for (std::size_t i = 0; i < rows.size(); ++i) {
      // The exemplar's faces are numbered from there on; none is beyond, too.
      if (faces[i] >= result.input_face_count()) continue;
      const std::array<std::uint32_t, 3> at = corners(faces[i]);
      rows[i] = {};
      for (std::size_t k = 0; k < 3; ++k) {
        const std::array<double, N> value = get(at[k]);
        for (std::size_t c = 0; c < N; ++c) rows[i][c] += weights[i][k] * value[c];
      }
    }
    return rows;
  }

 private:
  // A new vertex and the neighbour through which the rim is nearest.
  struct Step {
    std::uint32_t node, from;
  };

  std::size_t node(std::uint32_t v) const {
    if (v >= input_count_) return v - input_count_;
    return new_count_ + static_cast<std::size_t>(
                            std::lower_bound(rim_.begin(), rim_.end(), v) - rim_.begin());
  }

  // An inner edge has two faces, so each neighbour of a new vertex comes up twice: all weights are
  // equal without looking for doubles.
  void link(const Rows<std::uint32_t, 3>& faces) {
    neighbours_.resize(new_count_ + rim_.size());
    for (const auto& face : faces)
      for (std::size_t k = 0; k < 3; ++k)
        for (const std::size_t other : {(k + 1) % 3, (k + 2) % 3})
          neighbours_[node(face[k])].push_back(static_cast<std::uint32_t>(node(face[other])));
  }

  // Breadth first from the whole rim.
  void walk_inward() {
    std::vector<std::size_t> distance(neighbours_.size(), none);
    std::vector<std::uint32_t> queue;
    for (std::size_t i = new_count_; i < neighbours_.size(); ++i) {
      distance[i] = 0;
      queue.push_back(static_cast<std::uint32_t>(i));
    }
    for (std::size_t at = 0; at < queue.size(); ++at) {
      for (const std::uint32_t next : neighbours_[queue[at]]) {
        if (distance[next] != none) continue;
        distance[next] = distance[queue[at]] + 1;
        depth_ = std::max(depth_, distance[next]);
        inward_.push_back({next, queue[at]});
        queue.push_back(next);
      }
    }
  }

  // Gauss-Seidel sweeps with over-relaxation (Young 1954), until a step is below 1e-7 of the range;
  // src/io/attributes.rs says where the numbers come from.
  template <std::size_t N>
  void relax(std::vector<std::array<double, N>>& rows) const {
    const double half_wave = 3.14159265358979323846 / (2.0 * (static_cast<double>(depth_) + 1));
    const double omega = 2 / (1 + std::sin(half_wave));
    double range = 0;
    for (std::size_t c = 0; c < N; ++c)
      for (std::size_t i = new_count_; i < rows.size(); ++i)
        range = std::max(range, std::fabs(rows[i][c] - rows[new_count_][c]));
    double largest = range;
    for (std::size_t sweep = 0; sweep < 100 + 20 * depth_ && largest > 1e-7 * range; ++sweep) {
      largest = 0;
      for (const Step& step : inward_) {
        const auto& around = neighbours_[step.node];
        std::array<double, N> sum{};
        for (const std::uint32_t n : around)
          for (std::size_t c = 0; c < N; ++c) sum[c] += rows[n][c];
        for (std::size_t c = 0; c < N; ++c) {
          double& value = rows[step.node][c];
          const double change = omega * (sum[c] / static_cast<double>(around.size()) - value);
          value += change;
          largest = std::max(largest, std::fabs(change));
        }
      }
    }
  }

  std::size_t new_count_, input_count_;
  std::vector<std::uint32_t> rim_;
  std::vector<std::vector<std::uint32_t>> neighbours_;
  std::vector<Step> inward_;
  std::size_t depth_ = 0;
};

// For each new face the input face at the rim that is the fewest faces away, for what faces carry;
// none where there is none. corners(f) are the vertices of input face f.
template <class Scalar, class Corners>
std::vector<std::uint32_t> face_templates(const Result<Scalar>& result, const Corners& corners) {
  const auto faces = result.new_faces();
  std::map<Edge, std::size_t> owner;
  std::vector<bool> on_rim(result.input_vertex_count());
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const auto face = faces[i];
    for (std::size_t k = 0; k < 3; ++k) {
      owner[{face[k], face[(k + 1) % 3]}] = i;
      if (face[k] < on_rim.size()) on_rim[face[k]] = true;
    }
  }
  std::vector<std::uint32_t> found(faces.size(), none);
  std::vector<std::size_t> queue;
  // The new face beyond each edge of a face takes after `like`.
  const auto spread = [&](const std::array<std::uint32_t, 3>& face, std::uint32_t like) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto there = owner.find({face[(k + 1) % 3], face[k]});
      if (there == owner.end() || found[there->second] != none) continue;
      found[there->second] = like;
      queue.push_back(there->second);
    }
  };
  for (std::uint32_t f = 0; f < result.input_face_count(); ++f) {
    const std::array<std::uint32_t, 3> face = corners(f);
    if (on_rim[face[0]] + on_rim[face[1]] + on_rim[face[2]] >= 2) spread(face, f);
  }
  for (std::size_t at = 0; at < queue.size(); ++at) spread(faces[queue[at]], found[queue[at]]);
  return found;
}

}  // namespace mesh_completion

#endif
