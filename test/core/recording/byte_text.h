#pragma once

#include <cstdint>
#include <string>

#include "core/recording/byte_source.h"

namespace plumbline {

// The bytes of a text, which must outlive them.
inline ByteView ViewOf(const std::string& text) {
  return {reinterpret_cast<const uint8_t*>(text.data()), text.size()};
}

inline std::string TextOf(ByteView bytes) {
  return {reinterpret_cast<const char*>(bytes.data), bytes.size};
}

// A number as it stands in files, little endian.
template <typename Number>
std::string BytesOf(Number number) {
  return {reinterpret_cast<const char*>(&number), sizeof(Number)};
}

// A text behind its length.
inline std::string WithLength(const std::string& text) {
  return BytesOf(static_cast<uint32_t>(text.size())) + text;
}

}  // namespace plumbline
