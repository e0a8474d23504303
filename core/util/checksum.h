#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

namespace plumbline {

// A checksum like FNV-1a, of words of 64 bits: it shows that bytes are not those they were, by
// accident, not by intent.
class Checksum {
 public:
  // The value does not depend on how the bytes are dealt out to calls.
  void Add(const void* data, size_t size) {
    const auto* bytes = static_cast<const unsigned char*>(data);
    for (; size > 0 && num_pending_ > 0; --size) AddByte(*bytes++);
    for (; size >= sizeof(uint64_t); size -= sizeof(uint64_t), bytes += sizeof(uint64_t)) {
      uint64_t word = 0;
      std::memcpy(&word, bytes, sizeof(word));
      Mix(word);
    }
    for (; size > 0; --size) AddByte(*bytes++);
  }
  uint64_t value() const {
    return num_pending_ == 0 ? value_ : (value_ ^ pending_) * kPrime + num_pending_;
  }

 private:
  static constexpr uint64_t kPrime = 1099511628211ULL;

  void Mix(uint64_t word) { value_ = (value_ ^ word) * kPrime; }
  void AddByte(unsigned char byte) {
    pending_ |= static_cast<uint64_t>(byte) << (8 * num_pending_);
    if (++num_pending_ < sizeof(uint64_t)) return;
    Mix(pending_);
    pending_ = 0;
    num_pending_ = 0;
  }

  uint64_t value_ = 14695981039346656037ULL;
  uint64_t pending_ = 0;  // bytes that do not make a word yet
  unsigned num_pending_ = 0;
};

}  // namespace plumbline
