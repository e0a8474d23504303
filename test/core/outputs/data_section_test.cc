#include "core/outputs/data_section.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace plumbline {
namespace {

std::vector<uint8_t> Bytes(const std::string& text) { return {text.begin(), text.end()}; }

// RFC 4648, section 10.
TEST(DataSection, Base64HasTheStandardsExamples) {
  EXPECT_EQ(Base64(Bytes("")), "");
  EXPECT_EQ(Base64(Bytes("f")), "Zg==");
  EXPECT_EQ(Base64(Bytes("fo")), "Zm8=");
  EXPECT_EQ(Base64(Bytes("foo")), "Zm9v");
  EXPECT_EQ(Base64(Bytes("foob")), "Zm9vYg==");
  EXPECT_EQ(Base64(Bytes("fooba")), "Zm9vYmE=");
  EXPECT_EQ(Base64(Bytes("foobar")), "Zm9vYmFy");
  EXPECT_EQ(Base64({0xfb, 0xff, 0xfe}), "+//+");
}

TEST(DataSection, SectionsKeepTheirOrderAndPack) {
  const std::string text =
      FormatSections({{"first", std::vector<uint8_t>(100'000, 7)}, {"second", {}}});
  EXPECT_EQ(text.find("<script type=\"application/zlib\" id=\"first\">"), 0u);
  EXPECT_NE(text.find("</script>\n<script type=\"application/zlib\" id=\"second\">"),
            std::string::npos);
  EXPECT_LT(text.size(), 1000u);
}

}  // namespace
}  // namespace plumbline
