#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <string>
#include <vector>

#include "core/recording/byte_source.h"

namespace plumbline {

// Writes CDR by hand, in either byte order.
class CdrText {
 public:
  explicit CdrText(bool is_big_endian) : is_big_endian_(is_big_endian) {
    bytes_ = {0, static_cast<uint8_t>(is_big_endian ? 0 : 1), 0, 0};
  }

  template <typename Number>
  CdrText& Add(Number number) {
    while ((bytes_.size() - 4) % sizeof(Number) != 0) bytes_.push_back(0xee);
    uint8_t ordered[sizeof(Number)];
    std::memcpy(ordered, &number, sizeof(Number));
    if (is_big_endian_) std::reverse(std::begin(ordered), std::end(ordered));
    bytes_.insert(bytes_.end(), std::begin(ordered), std::end(ordered));
    return *this;
  }
  CdrText& Add(const std::string& text) {
    Add(static_cast<uint32_t>(text.size() + 1));
    bytes_.insert(bytes_.end(), text.begin(), text.end());
    bytes_.push_back(0);
    return *this;
  }
  CdrText& AddBytes(const std::vector<uint8_t>& bytes) {
    Add(static_cast<uint32_t>(bytes.size()));
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    return *this;
  }
  ByteView view() const { return {bytes_.data(), bytes_.size()}; }

 private:
  bool is_big_endian_;
  std::vector<uint8_t> bytes_;
};

}  // namespace plumbline
