#include "core/util/checksum.h"

#include <gtest/gtest.h>

#include <string>

namespace plumbline {
namespace {

uint64_t ValueOf(const std::string& text, size_t bytes_per_call) {
  Checksum checksum;
  for (size_t at = 0; at < text.size(); at += bytes_per_call) {
    const std::string part = text.substr(at, bytes_per_call);
    checksum.Add(part.data(), part.size());
  }
  return checksum.value();
}

TEST(ChecksumTest, DoesNotDependOnTheCalls) {
  const std::string text = "what is kept of a map until it is written";
  const uint64_t whole = ValueOf(text, text.size());
  for (const size_t bytes : {1U, 3U, 7U, 8U, 9U, 16U}) EXPECT_EQ(ValueOf(text, bytes), whole);
}

TEST(ChecksumTest, EveryBitAndTheLengthCount) {
  const std::string text(21, '\0');
  const uint64_t value = ValueOf(text, text.size());
  for (size_t bit = 0; bit < 8 * text.size(); ++bit) {
    std::string changed = text;
    changed[bit / 8] = static_cast<char>(1U << (bit % 8));
    EXPECT_NE(ValueOf(changed, changed.size()), value) << bit;
  }
  EXPECT_NE(ValueOf(text + '\0', text.size() + 1), value);
}

}  // namespace
}  // namespace plumbline
