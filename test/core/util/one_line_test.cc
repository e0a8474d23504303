#include "core/util/one_line.h"

#include <gtest/gtest.h>

#include "core/util/error.h"

namespace plumbline {
namespace {

TEST(OnOneLine, LeavesTextAlone) {
  EXPECT_EQ(OnOneLine("topic /top_scan 'x' \\"), "topic /top_scan 'x' \\");
  EXPECT_EQ(OnOneLine("B\xc3\xbcro \xe2\x82\xac \xf0\x9f\x8f\xa0"),
            "B\xc3\xbcro \xe2\x82\xac \xf0\x9f\x8f\xa0");
}

TEST(OnOneLine, EscapesControlCharacters) {
  EXPECT_EQ(OnOneLine("a\nb\rc\td"), "a\\nb\\rc\\td");
  EXPECT_EQ(OnOneLine(std::string("\0\x1b[2J\x7f", 6)), "\\x00\\x1b[2J\\x7f");
  EXPECT_EQ(OnOneLine("\xc2\x85"), "\\xc2\\x85");           // next line
  EXPECT_EQ(OnOneLine("\xe2\x80\xa8"), "\\xe2\\x80\\xa8");  // line separator
}

TEST(OnOneLine, EscapesWhatIsNoUtf8) {
  EXPECT_EQ(OnOneLine("\xff"), "\\xff");
  EXPECT_EQ(OnOneLine("\xc3"), "\\xc3");  // breaks off
  EXPECT_EQ(OnOneLine("\xc3(\x80"), "\\xc3(\\x80");
  EXPECT_EQ(OnOneLine("\xc0\xaf"), "\\xc0\\xaf");                    // two bytes for one
  EXPECT_EQ(OnOneLine("\xed\xa0\x80"), "\\xed\\xa0\\x80");           // surrogate
  EXPECT_EQ(OnOneLine("\xf4\x90\x80\x80"), "\\xf4\\x90\\x80\\x80");  // beyond Unicode
}

TEST(OnOneLine, ShortensBetweenCharacters) {
  EXPECT_EQ(OnOneLine("abcdef", 6), "abcdef");
  EXPECT_EQ(OnOneLine("abcdefg", 6), "abcdef...");
  EXPECT_EQ(OnOneLine("abc\xc3\xbc", 4), "abc...");
}

TEST(OnOneLine, HoldsForEveryError) {
  EXPECT_STREQ(Error("rig\n.yaml: \x01").what(), "rig\\n.yaml: \\x01");
}

}  // namespace
}  // namespace plumbline
