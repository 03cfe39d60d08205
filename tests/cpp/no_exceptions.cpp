// Compiled with -fno-exceptions: what begins with try_ is there and works.
#include "suite.hpp"

int main() {
  const Ball<float> ball = make_ball_of<float>();
  const auto mesh = mc::view(ball.vertices, ball.faces);
  int calls = 0;
  mc::Options options;
  options.progress = [&](double, const char*) { ++calls; };
  const auto result = mc::try_complete(mesh, options);
  CHECK(result && calls > 3 && result->filled_count() == 2);
  const auto completer = mc::Completer<float>::make(mesh);
  if (CHECK(completer)) {
    const auto again = completer->try_complete();
    CHECK(again && same_bytes(again->vertices(), result->vertices().data(), result->vertices().size(), 12));
  }
  options.progress = [](double, const char*) { return mc::Next::cancel; };
  CHECK(mc::try_complete(mesh, options).status() == mc::Status::cancelled);
  const auto holes = mc::try_list_holes(mesh);
  CHECK(holes && holes->size() == 2);
  return finish();
}
