#include "suite.hpp"

int main() {
  test_values();
  test_options();
  test_sources();
  test_guidance();
  test_failures();
  test_progress();
  test_completer();
  test_attributes();
  return finish();
}
