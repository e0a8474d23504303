#include "core/recording/decoder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "test/core/recording/byte_text.h"
#include "test/core/recording/packing.h"

namespace plumbline {
namespace {

std::string LongText() {
  std::string text;
  for (int i = 0; i < 3000; ++i) text += std::to_string(i * 7919 % 100003);
  return text;
}

struct Outcome {
  std::string text;
  size_t num_taken = 0;
  bool at_end = false;
  bool failed = false;
};

// Unpacks in pieces of so many bytes in and out, until it ends, fails or stands still.
Outcome Decode(const std::string& compression,
               const std::string& packed,
               size_t in_bytes,
               size_t out_bytes) {
  const std::unique_ptr<Decoder> decoder = MakeDecoder(compression);
  Outcome outcome;
  std::vector<uint8_t> out(out_bytes);
  for (Decoder::Step step = {1, 0, false, false};
       step.num_taken + step.num_given > 0 && !outcome.at_end && !outcome.failed;) {
    const std::string piece = packed.substr(outcome.num_taken, in_bytes);
    step = decoder->Run(ViewOf(piece), out.data(), out.size());
    EXPECT_LE(step.num_taken, piece.size());
    EXPECT_LE(step.num_given, out.size());
    outcome.num_taken += step.num_taken;
    outcome.text.append(reinterpret_cast<const char*>(out.data()), step.num_given);
    outcome.at_end = step.at_end;
    outcome.failed = step.failed;
  }
  return outcome;
}

class DecoderTest : public ::testing::TestWithParam<const char*> {};

TEST_P(DecoderTest, PiecesOfAnySizeGiveTheText) {
  const std::string text = LongText();
  const std::string packed = Pack(GetParam(), text);
  for (const size_t in_bytes : {size_t{1}, size_t{100}, packed.size() + 100}) {
    for (const size_t out_bytes : {size_t{1}, size_t{333}, text.size() + 100}) {
      const Outcome outcome = Decode(GetParam(), packed + "behind", in_bytes, out_bytes);
      EXPECT_TRUE(outcome.at_end);
      EXPECT_FALSE(outcome.failed);
      EXPECT_TRUE(outcome.text == text);
      EXPECT_EQ(outcome.num_taken, packed.size());
    }
  }
}

TEST_P(DecoderTest, EmptyTextEndsToo) {
  const std::string packed = Pack(GetParam(), "");
  const Outcome outcome = Decode(GetParam(), packed, packed.size(), 10);
  EXPECT_TRUE(outcome.at_end);
  EXPECT_EQ(outcome.text, "");
  EXPECT_EQ(outcome.num_taken, packed.size());
}

TEST_P(DecoderTest, WhatBreaksOffNeitherEndsNorFails) {
  const std::string text = LongText();
  const std::string packed = Pack(GetParam(), text);
  const Outcome outcome =
      Decode(GetParam(), packed.substr(0, packed.size() - 5), packed.size(), text.size());
  EXPECT_FALSE(outcome.at_end);
  EXPECT_FALSE(outcome.failed);
}

TEST_P(DecoderTest, OtherBytesFail) {
  const Outcome outcome = Decode(GetParam(), "no packed bytes at all", 100, 100);
  EXPECT_TRUE(outcome.failed);
  EXPECT_FALSE(outcome.at_end);
  EXPECT_EQ(outcome.text, "");
}

INSTANTIATE_TEST_SUITE_P(All, DecoderTest, ::testing::Values("bz2", "lz4", "zstd"));

// A frame of one block that is not packed, whose header asks for 2^log_bytes of memory.
std::string ZstdFrame(int log_bytes) {
  return std::string("\x28\xb5\x2f\xfd\x00", 5) + static_cast<char>((log_bytes - 10) << 3) +
         std::string("\x19\x00\x00", 3) + "abc";
}

TEST(DecoderLimitTest, ZstdFrameMayAskForSoMuchMemory) {
  EXPECT_EQ(Decode("zstd", ZstdFrame(27), 100, 100).text, "abc");
  for (const int log_bytes : {28, 31, 41}) {
    EXPECT_TRUE(Decode("zstd", ZstdFrame(log_bytes), 100, 100).failed) << log_bytes;
  }
}

TEST(DecoderLimitTest, OtherCompressionsHaveNoDecoder) {
  for (const char* name : {"", "none", "gzip", "BZ2"}) EXPECT_EQ(MakeDecoder(name), nullptr);
}

}  // namespace
}  // namespace plumbline
