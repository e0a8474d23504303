#include "core/outputs/plan_texts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "core/outputs/plan_dxf.h"
#include "core/outputs/plan_svg.h"
#include "core/outputs/room_outlines.h"
#include "test/testing/svg_texts.h"

namespace plumbline {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

// A room between two corners, with a dimension in each direction that crosses its middle,
// where the label would stand.
Room MakeRoom(int number, const Eigen::Vector2d& low, const Eigen::Vector2d& high) {
  Room room;
  room.number = number;
  room.entered = number % 2 == 1;
  const Eigen::Vector2d corners[] = {low, {high.x(), low.y()}, high, {low.x(), high.y()}};
  RoomLoop& loop = room.loops.emplace_back();
  for (const Eigen::Vector2d& corner : corners) loop.emplace_back().from = corner;
  const Eigen::Vector2d middle = 0.5 * (low + high);
  const Eigen::Vector2d size = high - low;
  room.area_m2 = size.x() * size.y();
  room.area_stddev_m2 = 0.0012;
  room.label = middle;
  room.dimensions.push_back(
      {{low.x(), middle.y()}, {high.x(), middle.y()}, 1, 2, size.x(), 0.0004});
  room.dimensions.push_back(
      {{middle.x(), low.y()}, {middle.x(), high.y()}, 3, 4, size.y(), 0.0011});
  return room;
}

PlanDoor MakeDoor(const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  PlanDoor door;
  door.from = from;
  door.to = to;
  door.normal = Eigen::Vector2d::UnitY();
  door.depth_m = 0.1;
  door.width_m = (to - from).norm();
  return door;
}

// Narrow rooms side by side, a corridor above them with a door to each.
FloorPlans NarrowRooms(double width_m, double depth_m, int count) {
  FloorPlans plan;
  StoreyPlan& storey = plan.storeys.emplace_back();
  for (int i = 0; i < count; ++i) {
    const double x = i * (width_m + 0.1);
    storey.rooms.push_back(MakeRoom(i + 1, {x, 0.0}, {x + width_m, depth_m}));
    storey.doors.push_back(
        MakeDoor({x + 0.1, depth_m + 0.1}, {x + 0.1 + 0.6 * width_m, depth_m + 0.1}));
  }
  storey.rooms.push_back(
      MakeRoom(count + 1, {0.0, depth_m + 0.1}, {count * (width_m + 0.1), depth_m + 1.2}));
  return plan;
}

TEST(PlanTexts, NoneLiesOnAnotherOne) {
  for (const double width_m : {0.9, 1.8}) {
    for (const double depth_m : {0.9, 5.0}) {
      for (const int count : {1, 4}) {
        const std::string svg = FormatSvg(NarrowRooms(width_m, depth_m, count), 0);
        EXPECT_THAT(OverlapsIn(svg), IsEmpty()) << width_m << " " << depth_m << " " << count;
      }
    }
  }
}

TEST(PlanTexts, TheTestSeesTextsThatOverlap) {
  const std::string texts =
      "<text x=\"10.00\" y=\"20.00\" font-size=\"2.00\" text-anchor=\"middle\">1.234</text>\n"
      "<text x=\"12.00\" y=\"21.00\" font-size=\"2.00\" text-anchor=\"middle\" "
      "transform=\"rotate(-90.00 12.00 21.00)\">5.678</text>\n"
      "<text x=\"10.00\" y=\"27.00\" font-size=\"2.00\" text-anchor=\"middle\">9.012</text>\n";
  EXPECT_THAT(OverlapsIn(texts), ::testing::ElementsAre("1.234 | 5.678"));
}

TEST(PlanTexts, OfTwoDoorsInOnePlaceOneShowsItsWidth) {
  FloorPlans plan = NarrowRooms(3.0, 5.0, 1);
  StoreyPlan& storey = plan.storeys[0];
  storey.doors.push_back(storey.doors[0]);
  const PlanTexts texts = PlaceTexts(storey, Paper(plan));
  EXPECT_TRUE(texts.doors.at(0).has_value());
  EXPECT_FALSE(texts.doors.at(1).has_value());
}

TEST(PlanTexts, StandInTheirRooms) {
  const FloorPlans plan = NarrowRooms(1.8, 3.0, 4);
  const StoreyPlan& storey = plan.storeys[0];
  const Paper paper(plan);
  const PlanTexts texts = PlaceTexts(storey, paper);
  ASSERT_THAT(texts.dimensions, SizeIs(storey.rooms.size()));
  for (size_t i = 0; i < storey.rooms.size(); ++i) {
    std::vector<RoomLoop> loops = storey.rooms[i].loops;
    for (RoomEdge& edge : loops[0]) edge.from = paper.At(edge.from);
    ASSERT_TRUE(texts.labels[i].has_value());
    EXPECT_TRUE(IsInside(loops, texts.labels[i]->at));
    for (const auto& text : texts.dimensions[i]) {
      ASSERT_TRUE(text.has_value());
      for (const double end : {-0.5, 0.5}) {
        EXPECT_TRUE(
            IsInside(loops, text->box.centre + end * text->box.width * text->box.Along()));
      }
    }
  }
}

TEST(PlanTexts, AWideRoomShowsAllAlongItsLines) {
  const FloorPlans plan = NarrowRooms(6.0, 5.0, 1);
  const PlanTexts texts = PlaceTexts(plan.storeys[0], Paper(plan));
  EXPECT_EQ(texts.labels[0]->area, "30.00 m\u00b2");
  EXPECT_EQ(texts.labels[0]->stddev, "\u00b10.001 m\u00b2");
  for (const auto& text : texts.dimensions[0]) {
    ASSERT_TRUE(text.has_value());
    EXPECT_FALSE(text->leader_to.has_value());
    EXPECT_NE(text->stddev, "");
  }
}

TEST(PlanTexts, WithoutPlaceALengthGoesBeforeItIsHidden) {
  // 0.9 m at 1:200 are 4.5 mm: not even the label fits.
  const FloorPlans plan = NarrowRooms(0.9, 0.9, 60);
  const PlanTexts texts = PlaceTexts(plan.storeys[0], Paper(plan));
  for (size_t i = 0; i + 1 < texts.dimensions.size(); ++i) {
    for (const auto& text : texts.dimensions[i]) EXPECT_FALSE(text.has_value());
  }
}

TEST(Paper, ModelAtIsTheInverse) {
  // Deeper than wide, so that it is turned.
  const Paper turned(NarrowRooms(0.9, 5.0, 2));
  EXPECT_EQ(turned.Direction(Eigen::Vector2d::UnitY()), Eigen::Vector2d(1.0, 0.0));
  const Paper unturned(75);
  EXPECT_EQ(unturned.Direction(Eigen::Vector2d::UnitY()), Eigen::Vector2d(0.0, -1.0));
  const Eigen::Vector2d p(1.25, -3.5);
  for (const Paper& paper : {turned, unturned}) {
    EXPECT_LT((paper.ModelAt(paper.At(p)) - p).norm(), 1e-12);
    const Eigen::Vector2d step = paper.At(p + Eigen::Vector2d(0.1, 0.2)) - paper.At(p);
    EXPECT_LT((step - paper.mm_per_m() * paper.Direction({0.1, 0.2})).norm(), 1e-9);
  }
}

TEST(PlanTexts, TheDxfFileHasThemInItsOwnAlphabet) {
  const std::string dxf = FormatDxf(NarrowRooms(3.0, 5.0, 1).storeys[0], {});
  EXPECT_THAT(dxf, ::testing::HasSubstr("\n15.00 m2\n"));
  EXPECT_THAT(dxf, ::testing::HasSubstr("\n%%p0.001 m2\n"));
  EXPECT_THAT(dxf, ::testing::HasSubstr("\n5.000 %%p1.1 mm\n"));
  EXPECT_TRUE(std::all_of(dxf.begin(), dxf.end(), [](char c) { return c > 0; }));
}

TEST(ReadableAngle, ReadsFromBelowOrFromTheRight) {
  EXPECT_NEAR(ReadableAngle({1.0, 0.0}), 0.0, 1e-9);
  EXPECT_NEAR(ReadableAngle({-1.0, 0.0}), 0.0, 1e-9);
  EXPECT_NEAR(ReadableAngle({0.0, 1.0}), -90.0, 1e-9);
  EXPECT_NEAR(ReadableAngle({0.01, 1.0}), -90.57, 0.01);  // nearly upright: the same
  EXPECT_NEAR(ReadableAngle({0.01, -1.0}), -89.43, 0.01);
  EXPECT_NEAR(ReadableAngle({1.0, 1.0}), 45.0, 1e-9);
}

TEST(TextWidth, CountsCharactersNotBytes) {
  EXPECT_NEAR(TextWidth("\u00b1", 2.0), 2.0 * 0.84, 1e-9);
  EXPECT_GT(TextWidth("4.150", 2.0), 2.0 * (4 * 0.636 + 0.318));  // DejaVu Sans
}

}  // namespace
}  // namespace plumbline
