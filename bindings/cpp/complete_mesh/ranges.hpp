/* SPDX-License-Identifier: MIT OR Apache-2.0
 *
 * Arrays that belong to somebody else, to go through.
 * Part of complete_mesh.hpp: include that.
 */
#ifndef COMPLETE_MESH_RANGES_HPP
#define COMPLETE_MESH_RANGES_HPP

#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>

namespace mesh_completion {

namespace detail {
// Goes through anything that has operator[].
template <class Range>
class IndexIterator {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = std::decay_t<decltype(std::declval<const Range&>()[0])>;
  using difference_type = std::ptrdiff_t;
  using pointer = const value_type*;
  using reference = value_type;

  IndexIterator() = default;
  IndexIterator(const Range* range, std::size_t at) : range_(range), at_(at) {}
  value_type operator*() const { return (*range_)[at_]; }
  IndexIterator& operator++() { return ++at_, *this; }
  IndexIterator operator++(int) { return IndexIterator(range_, at_++); }
  bool operator==(const IndexIterator& other) const { return at_ == other.at_; }
  bool operator!=(const IndexIterator& other) const { return at_ != other.at_; }

 private:
  const Range* range_ = nullptr;
  std::size_t at_ = 0;
};
}  // namespace detail

// Numbers in a row that belong to somebody else: C++20's span in short.
template <class T>
class View {
 public:
  View() = default;
  View(const T* data, std::size_t size) : data_(data), size_(data ? size : 0) {}
  const T* data() const { return data_; }
  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  const T& operator[](std::size_t i) const { return data_[i]; }
  const T* begin() const { return data_; }
  const T* end() const { return data_ + size_; }

 private:
  const T* data_ = nullptr;
  std::size_t size_ = 0;
};

// Rows of N numbers each, packed: points, faces, edges. data() is the first number of the first.
template <class T, std::size_t N>
class Rows {
 public:
  using iterator = detail::IndexIterator<Rows>;
  Rows() = default;
  Rows(const T* data, std::size_t size) : data_(data), size_(data ? size : 0) {}
  const T* data() const { return data_; }
  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  std::array<T, N> operator[](std::size_t i) const {
    std::array<T, N> row{};
    for (std::size_t k = 0; k < N; ++k) row[k] = data_[N * i + k];
    return row;
  }
  iterator begin() const { return iterator(this, 0); }
  iterator end() const { return iterator(this, size_); }

 private:
  const T* data_ = nullptr;
  std::size_t size_ = 0;
};

using Edge = std::array<std::uint32_t, 2>;

}  // namespace mesh_completion

#endif
