#pragma once

#include <bzlib.h>
#include <gtest/gtest.h>
#include <lz4frame.h>
#include <zstd.h>

#include <string>

namespace plumbline {

inline std::string PackBz2(const std::string& text) {
  std::string packed(text.size() + text.size() / 100 + 1000, '\0');
  auto size = static_cast<unsigned>(packed.size());
  EXPECT_EQ(BZ2_bzBuffToBuffCompress(packed.data(),
                                     &size,
                                     const_cast<char*>(text.data()),
                                     static_cast<unsigned>(text.size()),
                                     9,
                                     0,
                                     0),
            BZ_OK);
  return packed.substr(0, size);
}

inline std::string PackLz4(const std::string& text) {
  LZ4F_preferences_t preferences = {};
  preferences.frameInfo.contentChecksumFlag = LZ4F_contentChecksumEnabled;
  std::string packed(LZ4F_compressFrameBound(text.size(), &preferences), '\0');
  return packed.substr(
      0,
      LZ4F_compressFrame(
          packed.data(), packed.size(), text.data(), text.size(), &preferences));
}

inline std::string PackZstd(const std::string& text) {
  std::string packed(ZSTD_compressBound(text.size()), '\0');
  return packed.substr(
      0, ZSTD_compress(packed.data(), packed.size(), text.data(), text.size(), 3));
}

inline std::string Pack(const std::string& compression, const std::string& text) {
  if (compression == "bz2") return PackBz2(text);
  return compression == "lz4" ? PackLz4(text) : PackZstd(text);
}

}  // namespace plumbline
