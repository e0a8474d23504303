#pragma once

#include <cstddef>
#include <cstdint>

namespace plumbline {

// The checksum FNV-1a of 64 bits: it shows that bytes are not those they were, by accident, not by
// intent.
class Checksum {
 public:
  void Add(const void* data, size_t size) {
    const auto* bytes = static_cast<const unsigned char*>(data);
    for (size_t i = 0; i < size; ++i) value_ = (value_ ^ bytes[i]) * kPrime;
  }
  uint64_t value() const { return value_; }

 private:
  static constexpr uint64_t kPrime = 1099511628211ULL;
  uint64_t value_ = 14695981039346656037ULL;
};

}  // namespace plumbline
