#include "core/outputs/plan_drawing.h"

#include <gtest/gtest.h>

namespace plumbline {
namespace {

TEST(PlanDrawingTest, NumbersHaveTheDigitsThatAreKnown) {
  Room room;
  room.area_m2 = 21.7349;
  room.area_stddev_m2 = 0.0126;
  EXPECT_EQ(AreaText(room), "21.73");
  EXPECT_EQ(AreaStddevText(room), "0.013");
  EXPECT_EQ(LengthText(4.15), "4.150");
  EXPECT_EQ(DoorWidthText(0.9249), "0.92");
  EXPECT_EQ(StddevText(0.00126), "1.3");  // mm
}

TEST(PlanDrawingTest, OriginIsSaidAsFarAsItIsKnown) {
  MapOrigin origin;
  EXPECT_EQ(OriginText(origin), "Map.");
  origin.recording = "office.bag";
  EXPECT_EQ(OriginText(origin), "Map of office.bag.");
  origin.verdict = "consistent";
  origin.date = "2026-11-27";
  origin.version = "0.1.0";
  EXPECT_EQ(OriginText(origin), "Map of office.bag, 2026-11-27: consistent. plumbline 0.1.0");
}

// Fonts of CAD programs have no others, and a line break would end the text.
TEST(PlanDrawingTest, NamesAreWrittenInAscii) {
  MapOrigin origin;
  origin.recording = "b\xc3\xbcro\n1~.bag";
  EXPECT_EQ(OriginText(origin), "Map of b??ro?1~.bag.");
}

TEST(PlanDrawingTest, OnlyMapsThatAreNotConsistentWarn) {
  MapOrigin origin;
  EXPECT_EQ(WarningText(origin), "");
  origin.verdict = "consistent";
  EXPECT_EQ(WarningText(origin), "");
  origin.verdict = "doubtful";
  const std::string doubtful = WarningText(origin);
  EXPECT_NE(doubtful.find("doubtful"), std::string::npos);
  origin.verdict = "contradictory";
  EXPECT_NE(WarningText(origin).find("do not use it"), std::string::npos);
}

TEST(PlanDrawingTest, GapGoesThroughTheWall) {
  PlanDoor door;
  door.from = {1.0, 2.0};
  door.to = {1.9, 2.0};
  door.normal = {0.0, 1.0};  // out of the wall: the second face lies below
  door.depth_m = 0.25;
  const std::vector<Eigen::Vector2d> corners = GapCorners(door);
  ASSERT_EQ(corners.size(), 4u);
  EXPECT_EQ(corners[0], Eigen::Vector2d(1.0, 2.0));
  EXPECT_EQ(corners[1], Eigen::Vector2d(1.9, 2.0));
  EXPECT_EQ(corners[2], Eigen::Vector2d(1.9, 1.75));
  EXPECT_EQ(corners[3], Eigen::Vector2d(1.0, 1.75));
  door.depth_m = 0.0;  // not known
  EXPECT_NEAR((GapCorners(door)[3] - door.from).norm(), kDrawnThicknessM, 1e-12);
}

}  // namespace
}  // namespace plumbline
