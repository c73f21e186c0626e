#pragma once
// A vector whose room is part of it: for the temporaries of a step, which may not touch the heap. Holds at most N
// elements; one more is a programming error (PELORUS_CHECK). Elements must be cheap to construct.

#include <algorithm>
#include <array>
#include <cstddef>

#include "core/base/check.h"

namespace pelorus {

template <class T, std::size_t N>
class FixedVector {
 public:
  using value_type = T;  // NOLINT(readability-identifier-naming): the name of the standard containers
  FixedVector() {}  // NOLINT(modernize-use-equals-default): with "= default", FixedVector{} would zero the elements
  explicit FixedVector(std::size_t size) { resize(size); }
  FixedVector(std::size_t size, const T& value) { assign(size, value); }

  void push_back(const T& value) {
    PELORUS_CHECK(size_ < N, "a fixed vector is full");
    items_[size_++] = value;
  }
  void pop_back() { --size_; }
  void clear() { size_ = 0; }
  void resize(std::size_t size) {
    PELORUS_CHECK(size <= N, "a fixed vector has too little room");
    size_ = size;
  }
  void assign(std::size_t size, const T& value) {
    resize(size);
    std::fill(begin(), end(), value);
  }

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] bool empty() const { return size_ == 0; }
  [[nodiscard]] T& operator[](std::size_t i) { return items_[i]; }
  [[nodiscard]] const T& operator[](std::size_t i) const { return items_[i]; }
  [[nodiscard]] T& back() { return items_[size_ - 1]; }
  [[nodiscard]] T* data() { return items_.data(); }
  [[nodiscard]] const T* data() const { return items_.data(); }
  [[nodiscard]] T* begin() { return items_.data(); }
  [[nodiscard]] T* end() { return items_.data() + size_; }
  [[nodiscard]] const T* begin() const { return items_.data(); }
  [[nodiscard]] const T* end() const { return items_.data() + size_; }

 private:
  std::array<T, N> items_;
  std::size_t size_ = 0;
};

}  // namespace pelorus
