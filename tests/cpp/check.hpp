// Counts checks over all files of a test program.
#ifndef CHECK_HPP
#define CHECK_HPP

#include <cstdio>
#include <cstring>

inline int checks_passed = 0, checks_failed = 0;

inline bool check_at(bool ok, const char* what, const char* file, int line) {
  ++(ok ? checks_passed : checks_failed);
  if (!ok) std::printf("%s:%d: FAILED: %s\n", file, line, what);
  return ok;
}

#define CHECK(...) check_at(static_cast<bool>(__VA_ARGS__), #__VA_ARGS__, __FILE__, __LINE__)

// Prints the count, which the calling script reads; what main returns.
inline int finish() {
  std::printf("%d passed, %d failed\n", checks_passed, checks_failed);
  return checks_failed > 0;
}

// The same count of the same bytes, and some.
template <class A, class B>
bool same_bytes(const A& a, const B* b, std::size_t count, std::size_t size) {
  return count > 0 && b != nullptr && a.size() == count && std::memcmp(a.data(), b, count * size) == 0;
}

#endif
