#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <new>
#include <utility>
#include <vector>

namespace plumbline {

// An array whose length does not change, for objects that there are millions of: it takes one
// pointer, and one block of memory unless it is empty.
template <typename T>
class CompactArray {
 public:
  CompactArray() = default;
  CompactArray(const std::vector<T>& values) : CompactArray(values.data(), values.size()) {}
  CompactArray(const T* values, size_t size) {
    if (size == 0) return;
    block_ = static_cast<std::byte*>(::operator new(kHeader + size * sizeof(T)));
    new (block_) size_t(size);
    std::uninitialized_copy_n(values, size, begin());
  }
  CompactArray(const CompactArray& other) : CompactArray(other.begin(), other.size()) {}
  CompactArray(CompactArray&& other) noexcept : block_(std::exchange(other.block_, nullptr)) {}
  CompactArray& operator=(CompactArray other) noexcept {
    std::swap(block_, other.block_);
    return *this;
  }
  ~CompactArray() {
    if (block_ == nullptr) return;
    std::destroy(begin(), end());
    ::operator delete(block_);
  }

  size_t size() const { return block_ == nullptr ? 0 : *reinterpret_cast<size_t*>(block_); }
  bool empty() const { return block_ == nullptr; }
  T* begin() { return First(); }
  T* end() { return First() + size(); }
  const T* begin() const { return First(); }
  const T* end() const { return First() + size(); }
  const T& operator[](size_t i) const { return First()[i]; }

  bool operator==(const std::vector<T>& other) const {
    return std::equal(begin(), end(), other.begin(), other.end());
  }

 private:
  static constexpr size_t kHeader = sizeof(size_t) > alignof(T) ? sizeof(size_t) : alignof(T);

  T* First() const {
    return block_ == nullptr ? nullptr : reinterpret_cast<T*>(block_ + kHeader);
  }

  std::byte* block_ = nullptr;  // the length, then the elements
};

}  // namespace plumbline
