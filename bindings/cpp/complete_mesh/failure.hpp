/* SPDX-License-Identifier: MIT OR Apache-2.0
 *
 * What went wrong: as a value, or thrown.
 * Part of complete_mesh.hpp: include that.
 */
#ifndef COMPLETE_MESH_FAILURE_HPP
#define COMPLETE_MESH_FAILURE_HPP

#include <cstdint>
#include <exception>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "enums.hpp"
#include "ranges.hpp"

#if defined(__cpp_exceptions) || defined(_CPPUNWIND)
#define COMPLETE_MESH_HPP_EXCEPTIONS 1
#else
#define COMPLETE_MESH_HPP_EXCEPTIONS 0
#endif

namespace mesh_completion {

// What went wrong and where: elements of the input, so that a host can select or draw them.
struct Failure {
  Status status = Status::internal;
  std::string message = {};
  std::vector<std::uint32_t> vertices = {};
  std::vector<Edge> edges = {};
  std::vector<std::uint32_t> faces = {};
  std::vector<std::uint32_t> holes = {};
  // What the progress function threw, if that is why the call was cancelled.
  std::exception_ptr thrown = nullptr;
};

class Error : public std::runtime_error {
 public:
  explicit Error(Failure failure)
      : std::runtime_error(failure.message),
        failure_(std::make_shared<const Failure>(std::move(failure))) {}
  Status status() const { return failure_->status; }
  const Failure& failure() const { return *failure_; }

 private:
  // Shared, since copying an exception must not throw.
  std::shared_ptr<const Failure> failure_;
};

// A value, or why there is none.
template <class T>
class Outcome {
 public:
  Outcome(T value) : value_(std::move(value)) {}
  Outcome(Failure failure) : failure_(std::move(failure)) {}
  bool has_value() const { return value_.has_value(); }
  explicit operator bool() const { return has_value(); }
  Status status() const { return has_value() ? Status::ok : failure_.status; }
  // Only with a value.
  T& operator*() { return *value_; }
  const T& operator*() const { return *value_; }
  T* operator->() { return &*value_; }
  const T* operator->() const { return &*value_; }
  // Empty, with a status of no meaning, beside a value.
  const Failure& failure() const { return failure_; }

#if COMPLETE_MESH_HPP_EXCEPTIONS
  // The value; throws Error, or what the progress function threw.
  T take() && {
    if (has_value()) return std::move(*value_);
    if (failure_.thrown) std::rethrow_exception(failure_.thrown);
    throw Error(std::move(failure_));
  }
#endif

 private:
  std::optional<T> value_;
  Failure failure_;
};

}  // namespace mesh_completion

#endif
