#pragma once

#include <cstddef>
#include <cstring>
#include <string>

namespace plumbline {

// The number that stands in the bytes of a file from the offset on, little endian.
template <typename Number>
Number NumberAt(const std::string& bytes, size_t offset) {
  Number number{};
  std::memcpy(&number, bytes.data() + offset, sizeof(number));
  return number;
}

}  // namespace plumbline
