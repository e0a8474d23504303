#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

#include "core/recording/byte_source.h"

namespace plumbline {

// The number whose bytes begin at `bytes`.
template <typename Number>
Number NumberAt(const uint8_t* bytes, bool is_big_endian) {
  std::array<uint8_t, sizeof(Number)> ordered;
  for (size_t i = 0; i < sizeof(Number); ++i) {
    ordered[i] = bytes[is_big_endian ? sizeof(Number) - 1 - i : i];
  }
  Number number;
  std::memcpy(&number, ordered.data(), sizeof(Number));
  return number;
}

// SerialReader takes numbers, texts and lists from the front of a message, and never more than
// it holds: false then.
//   ROS 1: numbers little endian without gaps; a text is its length (uint32) and its bytes, a
//     list its length and its elements.
//   CDR (ROS 2): four bytes say which byte order follows. A number begins at a multiple of its
//     size, counted from behind these four. A text's length counts the zero at its end.
class SerialReader {
 public:
  SerialReader() = default;  // of nothing
  static SerialReader ForRos1(ByteView message) { return SerialReader(message); }
  // False where the first four bytes announce no plain CDR.
  static bool ForCdr(ByteView message, SerialReader* reader);

  bool is_cdr() const { return is_cdr_; }
  // Bytes that have not been taken.
  size_t num_left() const { return bytes_.size - position_; }
  // Whether the message ends here. Writers of CDR may fill it up to a multiple of 4 or 8.
  bool IsAtEnd() const { return num_left() <= (is_cdr_ ? 7u : 0u); }

  template <typename Number>
  bool Take(Number* value) {
    static_assert(std::is_arithmetic_v<Number>);
    if (!Align(sizeof(Number)) || sizeof(Number) > num_left()) return false;
    *value = NumberAt<Number>(bytes_.data + position_);
    position_ += sizeof(Number);
    return true;
  }
  template <typename Number, size_t kCount>
  bool Take(std::array<Number, kCount>* values) {
    for (Number& value : *values) {
      if (!Take(&value)) return false;
    }
    return true;
  }
  bool TakeText(std::string* text);
  bool TakeBytes(size_t size, ByteView* bytes);
  // A list of floats; its elements are copied unless floats is null.
  bool TakeFloats(uint32_t* count, std::vector<float>* floats);
  // A std_msgs/Header. ROS 1's begins with a number (seq) that ROS 2's does not have.
  bool TakeHeader(int64_t* stamp_ns, std::string* frame_id);

  // The number at `bytes` in the message's byte order.
  template <typename Number>
  Number NumberAt(const uint8_t* bytes) const {
    return plumbline::NumberAt<Number>(bytes, is_big_endian_);
  }

 private:
  explicit SerialReader(ByteView message) : bytes_(message) {}

  bool Align(size_t size);

  ByteView bytes_;
  size_t position_ = 0;
  bool is_cdr_ = false;
  bool is_big_endian_ = false;
};

}  // namespace plumbline
