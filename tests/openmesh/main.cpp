#include "suite.hpp"

int main() {
  test_fill<FloatMesh>();
  test_fill<DoubleMesh>();
  test_attributes<FloatMesh>();
  test_attributes<DoubleMesh>();
  test_deleted<FloatMesh>();
  test_deleted<DoubleMesh>();
  test_sources<FloatMesh>();
  test_sources<DoubleMesh>();
  test_failures<FloatMesh>();
  test_failures<DoubleMesh>();
  return finish();
}
