#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <string>

namespace plumbline {

// CRC-32C, bit by bit.
inline uint32_t Crc32c(const std::string& bytes) {
  uint32_t remainder = 0xFFFFFFFFu;
  for (const char byte : bytes) {
    remainder ^= static_cast<uint8_t>(byte);
    for (int bit = 0; bit < 8; ++bit) {
      remainder = (remainder >> 1) ^ ((remainder & 1u) != 0 ? 0x82F63B78u : 0u);
    }
  }
  return ~remainder;
}

// The bytes of an E57 file without the checksums of its pages, which must be right.
inline std::string PayloadOfE57(const std::string& file) {
  std::string payload;
  for (size_t page = 0; page < file.size(); page += 1024) {
    const std::string bytes = file.substr(page, 1020);
    uint32_t stated = 0;  // the most significant byte first
    for (size_t i = 1020; i < 1024; ++i) {
      stated = (stated << 8) | static_cast<uint8_t>(file[page + i]);
    }
    EXPECT_EQ(stated, Crc32c(bytes)) << page;
    payload += bytes;
  }
  return payload;
}

}  // namespace plumbline
