// A completer kept between calls gives the bytes of a call of its own.
#include <thread>

#include "suite.hpp"

namespace {

template <class Scalar>
bool same_fill(const mc::Result<Scalar>& a, const mc::Result<Scalar>& b) {
  return same_bytes(a.vertices(), b.vertices().data(), b.vertices().size(), 3 * sizeof(Scalar)) &&
         same_bytes(a.faces(), b.faces().data(), b.faces().size(), 12) &&
         same_bytes(a.new_vertex_source_faces(), b.new_vertex_source_faces().data(),
                    b.new_vertices().size(), 4);
}

template <class Scalar>
void check_kept() {
  const Ball<Scalar> ball = make_ball_of<Scalar>();
  const auto mesh = mc::view(ball.vertices, ball.faces);
  mc::Options smooth;
  smooth.method = mc::Method::smooth;
  mc::Completer<Scalar> completer(mesh);
  CHECK(completer.holes().size() == 2 && completer.holes()[0].status == mc::HoleStatus::open);
  const auto first = completer.complete();
  const auto second = completer.complete(smooth);
  CHECK(same_fill(first, mc::complete(mesh)) && same_fill(second, mc::complete(mesh, smooth)));
  CHECK(!same_fill(first, second));
  CHECK(same_fill(completer.complete(), first));

  const auto outcome = completer.try_complete(smooth);
  CHECK(outcome && same_fill(*outcome, second) && outcome->filled_count() == 2);
}

void check_threads() {
  const Ball<float> ball = make_ball_of<float>();
  const mc::Completer<float> completer(mc::view(ball.vertices, ball.faces));
  const auto alone = completer.complete();
  std::vector<mc::Result<float>> results(2, alone);
  std::vector<std::thread> threads;
  for (auto& result : results)
    threads.emplace_back([&result, completer] { result = completer.complete(); });
  for (auto& thread : threads) thread.join();
  for (const auto& result : results) CHECK(result.get() != alone.get() && same_fill(result, alone));
}

void check_lifetime() {
  const Ball<float> ball = make_ball_of<float>();
  const auto mesh = mc::view(ball.vertices, ball.faces);
  const mc::Holes holes = mc::Completer<float>(mesh).holes();
  CHECK(holes.size() == 2 && holes[0].loop_count == 1);
  const auto result = mc::Completer<float>(mesh).complete();
  CHECK(result.filled_count() == 2 && !result.new_vertices().empty());
  mc::Completer<float> moved(mesh), target = std::move(moved);
  CHECK(target.holes().size() == 2);
}

}  // namespace

void test_completer() {
  check_kept<float>();
  check_kept<double>();
  check_threads();
  check_lifetime();
}
