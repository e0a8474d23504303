#include "core/util/xml_text.h"

#include <gtest/gtest.h>

namespace plumbline {
namespace {

TEST(XmlEscaped, LeavesNoMarkup) {
  EXPECT_EQ(XmlEscaped("<a href=\"b\">&</a>"), "&lt;a href=&quot;b&quot;&gt;&amp;&lt;/a&gt;");
}

// What is escaped already is a text like any other.
TEST(XmlEscaped, EscapesTwiceWhatIsEscapedTwice) {
  EXPECT_EQ(XmlEscaped(XmlEscaped("&")), "&amp;amp;");
}

TEST(XmlEscaped, KeepsOtherBytes) {
  EXPECT_EQ(XmlEscaped("B\xc3\xbcro 1'"), "B\xc3\xbcro 1'");
}

}  // namespace
}  // namespace plumbline
