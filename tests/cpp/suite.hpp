// The parts of the suite, and the mesh that all of them fill: the ball of the C tests.
#ifndef SUITE_HPP
#define SUITE_HPP

#include <array>
#include <complete_mesh.hpp>
#include <cstdint>
#include <vector>

#include "check.hpp"

extern "C" {
#include "ball.h"
}

namespace mc = mesh_completion;

template <class Scalar>
using Points = std::vector<std::array<Scalar, 3>>;
using Faces = std::vector<std::array<std::uint32_t, 3>>;

template <class Scalar>
struct Ball {
  Points<Scalar> vertices;
  Faces faces;
};

// With one patch missing besides the cap, or MANY.
template <class Scalar>
Ball<Scalar> make_ball_of(int patches = 1) {
  static struct ball c;
  make_ball(&c, patches);
  Ball<Scalar> ball;
  for (const auto& p : c.vertices) ball.vertices.push_back({p[0], p[1], p[2]});
  const std::size_t count = patches == 1 ? FACES : SIEVE_FACES;
  for (std::size_t f = 0; f < count; ++f)
    ball.faces.push_back({c.faces[f][0], c.faces[f][1], c.faces[f][2]});
  return ball;
}

void test_values();
void test_options();
void test_sources();
void test_guidance();
void test_failures();
void test_progress();
void test_completer();
void test_attributes();

#endif
