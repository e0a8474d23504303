#include "core/recording/unpack.h"

#include <gtest/gtest.h>

#include <string>

#include "test/core/recording/byte_text.h"
#include "test/core/recording/packing.h"

namespace plumbline {
namespace {

struct Outcome {
  std::string problem;
  std::string text;
  uint64_t num_taken = 0;
};

Outcome UnpackText(const std::string& compression,
                   const std::string& packed,
                   uint32_t expected_size) {
  MemorySource source(ViewOf(packed));
  std::vector<uint8_t> unpacked;
  Outcome outcome;
  outcome.problem = Unpack(compression, &source, expected_size, &unpacked, &outcome.num_taken);
  outcome.text.assign(unpacked.begin(), unpacked.end());
  return outcome;
}

// Hardly to be packed, so that it takes many pieces.
std::string LongText() {
  std::string text;
  for (int i = 0; i < 60000; ++i) text += std::to_string(i * 7919 % 100003);
  return text;
}

class UnpackTest : public ::testing::TestWithParam<const char*> {
 protected:
  std::string Pack(const std::string& text) const { return plumbline::Pack(GetParam(), text); }
};

TEST_P(UnpackTest, GivesBackWhatWasPackedWhateverSizeIsStated) {
  for (const std::string& text : {std::string(), std::string("scan"), LongText()}) {
    const std::string packed = Pack(text);
    for (const uint32_t stated : {static_cast<uint32_t>(text.size()), 0u, 0xffffffffu}) {
      const Outcome outcome = UnpackText(GetParam(), packed + "what follows", stated);
      EXPECT_EQ(outcome.problem, "");
      EXPECT_TRUE(outcome.text == text);
      EXPECT_EQ(outcome.num_taken, packed.size());
    }
  }
}

TEST_P(UnpackTest, WhatBreaksOffIsUnpackedSoFar) {
  const std::string text = LongText() + LongText() + LongText() + LongText();
  const std::string packed = Pack(text);
  const Outcome outcome =
      UnpackText(GetParam(), packed.substr(0, packed.size() * 9 / 10), 100);
  EXPECT_EQ(outcome.problem, "it breaks off");
  EXPECT_GT(outcome.text.size(), text.size() / 4);
  EXPECT_TRUE(outcome.text == text.substr(0, outcome.text.size()));
  EXPECT_EQ(UnpackText(GetParam(), "", 100).problem, "it breaks off");
}

TEST_P(UnpackTest, WhatIsDamagedIsLeftOut) {
  std::string packed = Pack(LongText());
  packed[packed.size() / 2] ^= '\x10';
  const Outcome outcome = UnpackText(GetParam(), packed, 100);
  EXPECT_EQ(outcome.problem, "its bytes are damaged");
  EXPECT_EQ(outcome.text, "");
  EXPECT_EQ(UnpackText(GetParam(), "no such bytes", 100).problem, "its bytes are damaged");
}

INSTANTIATE_TEST_SUITE_P(Both, UnpackTest, ::testing::Values("bz2", "lz4"));

TEST(UnpackLimitTest, FewBytesDoNotBecomeManyMegabytes) {
  const std::string packed = PackBz2(std::string(5'000'000, '\0'));
  EXPECT_LT(packed.size(), 100u);
  const Outcome outcome = UnpackText("bz2", packed, 5'000'000);
  EXPECT_EQ(outcome.problem, "it holds more than any recorder packs");
  EXPECT_LT(outcome.text.size(), 2'000'000u);
}

TEST(UnpackLimitTest, OtherMethodsAreNotKnown) {
  EXPECT_EQ(UnpackText("zip", "PK", 2).problem, "it is packed in an unknown way");
}

}  // namespace
}  // namespace plumbline
