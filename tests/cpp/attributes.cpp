// Colours carried into the fill, from the rim and from the source, by value.
#include <algorithm>
#include <complete_mesh_attributes.hpp>
#include <cmath>
#include <map>
#include <set>

#include "suite.hpp"

namespace {

using Row = std::array<double, 2>;

struct Filled {
  Ball<float> ball = make_ball_of<float>();
  mc::Result<float> result = mc::complete(mc::view(ball.vertices, ball.faces));
  Row value(std::uint32_t v) const { return {10.0 * ball.vertices[v][0] + 3, 1.0 * (v % 7)}; }
  std::array<std::uint32_t, 3> corners(std::uint32_t f) const { return ball.faces[f]; }
};

// Each new vertex is the mean of its neighbours, and no value leaves the rim's range.
void from_rim(const Filled& filled) {
  const mc::Carrier carrier(filled.result);
  const auto rows = carrier.from_rim<2>([&](std::uint32_t v) { return filled.value(v); });
  CHECK(rows.size() == filled.result.new_vertices().size());
  CHECK(carrier.rim().size() == CAP_EDGES + PATCH_EDGES);
  std::vector<std::set<std::uint32_t>> around(rows.size());
  for (const auto& face : filled.result.new_faces())
    for (const std::uint32_t v : face)
      if (v >= VERTICES)
        for (const std::uint32_t other : face)
          if (other != v) around[v - VERTICES].insert(other);
  double worst = 0, low = 99, high = -99;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    Row sum = {0, 0};
    for (const std::uint32_t v : around[i]) {
      const Row row = v < VERTICES ? filled.value(v) : rows[v - VERTICES];
      for (std::size_t c = 0; c < 2; ++c) sum[c] += row[c] / static_cast<double>(around[i].size());
    }
    for (std::size_t c = 0; c < 2; ++c) worst = std::fmax(worst, std::fabs(sum[c] - rows[i][c]));
    low = std::fmin(low, rows[i][1]);
    high = std::fmax(high, rows[i][1]);
  }
  CHECK(worst < 1e-4);
  CHECK(low > 0 && high < 6 && low < high);
}

// Breadth first from each vertex of the rim alone: none is nearer than the one that was named.
void nearest(const Filled& filled) {
  const mc::Carrier carrier(filled.result);
  const auto named = carrier.nearest();
  const std::size_t count = filled.result.vertices().size();
  std::vector<std::vector<std::uint32_t>> around(count);
  for (const auto& face : filled.result.new_faces())
    for (const std::uint32_t v : face)
      for (const std::uint32_t other : face)
        if (other != v) around[v].push_back(other);
  std::vector<std::size_t> least(count, count), of_named(count, count);
  for (const std::uint32_t start : carrier.rim()) {
    std::vector<std::size_t> distance(count, count);
    std::vector<std::uint32_t> queue = {start};
    distance[start] = 0;
    for (std::size_t at = 0; at < queue.size(); ++at)
      for (const std::uint32_t next : around[queue[at]])
        if (distance[next] == count) {
          distance[next] = distance[queue[at]] + 1;
          queue.push_back(next);
        }
    for (std::size_t v = VERTICES; v < count; ++v) {
      least[v] = std::min(least[v], distance[v]);
      if (named[v - VERTICES] == start) of_named[v] = distance[v];
    }
  }
  std::size_t wrong = 0;
  for (std::size_t v = VERTICES; v < count; ++v) wrong += least[v] != of_named[v] || least[v] == count;
  CHECK(named.size() == count - VERTICES && wrong == 0);
}

void from_source(const Filled& filled) {
  const mc::Carrier carrier(filled.result);
  const auto get = [&](std::uint32_t v) { return filled.value(v); };
  const auto rim = carrier.from_rim<2>(get);
  const auto rows = carrier.from_source<2>(filled.result, get, [&](std::uint32_t f) { return filled.corners(f); });
  std::size_t copied = 0, wrong = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::uint32_t f = filled.result.new_vertex_source_faces()[i];
    if (f == mc::none) {
      wrong += rows[i] != rim[i];
      continue;
    }
    ++copied;
    const auto w = filled.result.new_vertex_barycentrics()[i];
    double expected = 0;
    for (std::size_t k = 0; k < 3; ++k) expected += w[k] * filled.value(filled.ball.faces[f][k])[1];
    wrong += !(std::fabs(rows[i][1] - expected) < 1e-12);
  }
  CHECK(copied > 0 && wrong == 0);
}

// Next to the rim the face beyond the edge; everywhere a face that lies at the same hole's rim.
void templates(const Filled& filled) {
  const auto like = mc::face_templates(filled.result, [&](std::uint32_t f) { return filled.corners(f); });
  std::map<mc::Edge, std::uint32_t> owner;
  for (std::uint32_t f = 0; f < FACES; ++f)
    for (std::size_t k = 0; k < 3; ++k)
      owner[{filled.ball.faces[f][k], filled.ball.faces[f][(k + 1) % 3]}] = f;
  std::size_t at_rim = 0, wrong = 0;
  const auto faces = filled.result.new_faces();
  for (std::size_t i = 0; i < faces.size(); ++i) {
    bool beyond = false, touches = false;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto there = owner.find({faces[i][(k + 1) % 3], faces[i][k]});
      touches = touches || there != owner.end();
      beyond = beyond || (there != owner.end() && there->second == like[i]);
    }
    at_rim += touches;
    wrong += like[i] >= FACES || beyond != touches;
  }
  CHECK(like.size() == faces.size() && wrong == 0);
  CHECK(at_rim > 0 && at_rim < faces.size());
}

}  // namespace

void test_attributes() {
  const Filled filled;
  from_rim(filled);
  nearest(filled);
  from_source(filled);
  templates(filled);
}
