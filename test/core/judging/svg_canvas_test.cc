#include "core/judging/svg_canvas.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace plumbline {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(SvgCanvas, IsOnePictureWithATitle) {
  const std::string svg = SvgCanvas().Finish(300.0, 200.5, "rig & <room>");
  EXPECT_THAT(svg, testing::StartsWith("<svg xmlns="));
  EXPECT_THAT(svg, testing::EndsWith("</svg>\n"));
  EXPECT_THAT(svg, HasSubstr("viewBox=\"0 0 300 200.5\""));
  EXPECT_THAT(svg, HasSubstr("<title>rig &amp; &lt;room&gt;</title>"));
}

// Names of topics come from recordings.
TEST(SvgCanvas, TextsStayTexts) {
  SvgCanvas canvas;
  canvas.Text({1.0, 2.0}, "</text><script>\n", 12.0);
  const std::string svg = canvas.Finish(10.0, 10.0, "");
  EXPECT_THAT(svg, Not(HasSubstr("<script")));
  EXPECT_THAT(svg, HasSubstr("&lt;script&gt;"));
}

TEST(SvgCanvas, RoundsToTenthsOfAPixel) {
  SvgCanvas canvas;
  canvas.Line({0.04, 1.25}, {10.0, -3.33}, "#000000", 1.0);
  EXPECT_THAT(canvas.Finish(10.0, 10.0, ""), HasSubstr("L10 -3.3\""));
}

TEST(SvgCanvas, DrawsADotForEachPointAndNothingForNone) {
  SvgCanvas canvas;
  canvas.Dots({}, "#ff0000", 2.0);
  EXPECT_THAT(canvas.Finish(10.0, 10.0, ""), Not(HasSubstr("#ff0000")));
  canvas.Dots({{1.0, 2.0}, {3.0, 4.0}}, "#ff0000", 2.0);
  EXPECT_THAT(canvas.Finish(10.0, 10.0, ""), HasSubstr("M1 2h0M3 4h0"));
}

}  // namespace
}  // namespace plumbline
