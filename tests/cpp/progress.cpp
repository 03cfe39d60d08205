// Progress arrives; cancel and exceptions stop the call, at every report, and leave nothing behind.
#include <stdexcept>
#include <string>

#include "suite.hpp"

namespace {

struct Seen {
  int calls = 0;
  bool fell = false, no_stage = false;
  double last = 0;
  void note(double fraction, const char* stage) {
    ++calls;
    fell = fell || !(fraction >= last) || fraction > 1;
    last = fraction;
    no_stage = no_stage || stage == nullptr || *stage == 0;
  }
};

// An exception of a kind that only this program knows.
struct Stop {
  int at;
};

const Ball<float>& sieve() {
  static const Ball<float> ball = make_ball_of<float>(MANY);
  return ball;
}

mc::Options quick(mc::Progress progress) {
  mc::Options options;
  options.method = mc::Method::smooth;
  options.threads = 1;  // with more, how often the caller is asked depends on their speed
  options.progress = std::move(progress);
  return options;
}

mc::Outcome<mc::Result<float>> fill(mc::Progress progress) {
  return mc::try_complete(mc::view(sieve().vertices, sieve().faces), quick(std::move(progress)));
}

int count_calls() {
  Seen seen;
  const auto result = fill([&seen](double fraction, const char* stage) { seen.note(fraction, stage); });
  CHECK(result.has_value() && seen.calls >= 4 && !seen.fell && !seen.no_stage && seen.last > 0.5);
  return seen.calls;
}

void cancel(int total) {
  for (int at = 1; at <= total; ++at) {
    int calls = 0;
    const auto result = fill([&](double, const char*) {
      return ++calls == at ? mc::Next::cancel : mc::Next::go_on;
    });
    CHECK(!result && result.status() == mc::Status::cancelled && calls == at && !result.failure().thrown);
  }
}

void throws(int total) {
  for (int at = 1; at <= total; ++at) {
    int calls = 0, caught = 0;
    const mc::Options options = quick([&](double, const char*) {
      if (++calls == at) throw Stop{at};
    });
    try {
      mc::complete(mc::view(sieve().vertices, sieve().faces), options);
    } catch (const Stop& stop) {
      caught = stop.at;
    }
    CHECK(caught == at && calls == at);
  }
  // the calls that do not throw hand it over
  const auto outcome = fill([](double, const char*) { throw std::runtime_error("mine"); });
  if (!CHECK(outcome.status() == mc::Status::cancelled && outcome.failure().thrown)) return;
  std::string what;
  try {
    std::rethrow_exception(outcome.failure().thrown);
  } catch (const std::runtime_error& error) {
    what = error.what();
  }
  CHECK(what == "mine");
}

void cancelled_throws_error() {
  bool caught = false;
  try {
    mc::complete(mc::view(sieve().vertices, sieve().faces),
                 quick([](double, const char*) { return mc::Next::cancel; }));
  } catch (const mc::Error& error) {
    caught = error.status() == mc::Status::cancelled;
  }
  CHECK(caught);
}

void other_calls() {
  const auto mesh = mc::view(sieve().vertices, sieve().faces);
  int calls = 0;
  const mc::Options stop = quick([&](double, const char*) { return ++calls, mc::Next::cancel; });
  CHECK(mc::try_list_holes(mesh, stop).status() == mc::Status::cancelled && calls == 1);
  CHECK(mc::Completer<float>::make(mesh, stop).status() == mc::Status::cancelled && calls == 2);
  const mc::Completer<float> completer(mesh);
  CHECK(completer.try_complete(stop).status() == mc::Status::cancelled && calls == 3);
  // and the completer is as good as new
  CHECK(completer.complete(quick(nullptr)).filled_count() == MANY + 1);
}

// A function object with state of its own, an lvalue, a function pointer.
int pointer_calls = 0;
mc::Next by_pointer(double, const char*) { return ++pointer_calls, mc::Next::go_on; }

void kinds_of_callables(int total) {
  CHECK(fill(by_pointer).has_value() && pointer_calls == total);
  pointer_calls = 0;
  const mc::Progress kept = by_pointer;
  const mc::Progress copy = kept;
  CHECK(fill(copy).has_value() && pointer_calls == total && kept && !mc::Progress());
  int calls = 0;
  auto lvalue = [&calls, own = 0](double, std::string_view stage) mutable { calls = ++own + (stage == ""); };
  CHECK(fill(lvalue).has_value() && calls == total);
}

}  // namespace

void test_progress() {
  const int total = count_calls();
  cancel(total);
  throws(total);
  cancelled_throws_error();
  other_calls();
  kinds_of_callables(total);
  CHECK(count_calls() == total);
}
