#include "core/outputs/plan_paper.h"

#include <gtest/gtest.h>

#include <cmath>

namespace plumbline {
namespace {

// A plan of one rectangular room.
FloorPlans PlanOf(const Eigen::Vector2d& low, const Eigen::Vector2d& high) {
  FloorPlans plan;
  RoomLoop& loop = plan.storeys.emplace_back().rooms.emplace_back().loops.emplace_back();
  for (const Eigen::Vector2d& corner :
       {low, Eigen::Vector2d(high.x(), low.y()), high, Eigen::Vector2d(low.x(), high.y())}) {
    loop.emplace_back().from = corner;
  }
  return plan;
}

TEST(PaperTest, UpperLeftCornerOfABroadBuildingStandsAtTheMargin) {
  const Paper paper(PlanOf({-3.0, 2.0}, {7.0, 6.0}));
  EXPECT_EQ(paper.scale(), 50);  // 200 mm wide
  EXPECT_EQ(paper.mm_per_m(), 20.0);
  EXPECT_LT((paper.At({-3.0, 6.0}) - Eigen::Vector2d(14.0, 14.0)).norm(), 1e-9);
  EXPECT_LT((paper.At({7.0, 2.0}) - Eigen::Vector2d(214.0, 94.0)).norm(), 1e-9);
  EXPECT_NEAR(paper.width_mm(), 228.0, 1e-9);
  EXPECT_NEAR(paper.height_mm(), 80.0 + 28.0 + 28.0, 1e-9);
  EXPECT_LT((paper.Direction({0.0, 1.0}) - Eigen::Vector2d(0.0, -1.0)).norm(), 1e-12);
}

TEST(PaperTest, BuildingThatIsLongerAlongYIsTurned) {
  const Paper paper(PlanOf({0.0, -10.0}, {4.0, 0.0}));
  EXPECT_EQ(paper.scale(), 50);
  EXPECT_NEAR(paper.width_mm(), 228.0, 1e-9);
  // y of the model frame points to the right, x downwards.
  EXPECT_LT((paper.Direction({0.0, 1.0}) - Eigen::Vector2d(1.0, 0.0)).norm(), 1e-12);
  EXPECT_LT((paper.Direction({1.0, 0.0}) - Eigen::Vector2d(0.0, 1.0)).norm(), 1e-12);
  EXPECT_LT((paper.At({0.0, -10.0}) - Eigen::Vector2d(14.0, 14.0)).norm(), 1e-9);
  EXPECT_LT((paper.At({4.0, 0.0}) - Eigen::Vector2d(214.0, 94.0)).norm(), 1e-9);
}

TEST(PaperTest, ModelAtIsTheInverse) {
  for (const Paper& paper : {Paper(PlanOf({-3.0, 2.0}, {7.0, 6.0})),
                             Paper(PlanOf({1.0, -10.0}, {4.0, 3.0})),
                             Paper(200)}) {
    for (const Eigen::Vector2d& p : {Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(-7.3, 11.1)}) {
      EXPECT_LT((paper.ModelAt(paper.At(p)) - p).norm(), 1e-9);
      // Lengths are in the scale.
      EXPECT_NEAR((paper.At(p + Eigen::Vector2d(3.0, 4.0)) - paper.At(p)).norm(),
                  5000.0 / paper.scale(),
                  1e-9);
    }
  }
}

TEST(PaperTest, ScaleIsTheLargestThatFits) {
  EXPECT_EQ(Paper(PlanOf({0.0, 0.0}, {7.6, 1.0})).scale(), 20);  // 380 mm
  EXPECT_EQ(Paper(PlanOf({0.0, 0.0}, {7.7, 1.0})).scale(), 50);
  EXPECT_EQ(Paper(PlanOf({0.0, 0.0}, {5.1, 5.1})).scale(), 50);  // 255 mm high
  EXPECT_EQ(Paper(PlanOf({0.0, 0.0}, {300.0, 10.0})).scale(), 1000);
  // No scale fits: the smallest one.
  EXPECT_EQ(Paper(PlanOf({0.0, 0.0}, {1e5, 10.0})).scale(), 5000);
  // The legend needs its width, however small the room.
  EXPECT_EQ(Paper(PlanOf({0.0, 0.0}, {1.0, 1.0})).width_mm(), 180.0);
}

TextBox Box(double x, double y, double width, double height, double angle_deg) {
  return {{x, y}, width, height, angle_deg};
}

TEST(TextBoxTest, IsReadAlongItsAngle) {
  const TextBox upright = Box(0.0, 0.0, 10.0, 2.0, 0.0);
  EXPECT_LT((upright.Along() - Eigen::Vector2d::UnitX()).norm(), 1e-12);
  EXPECT_LT((upright.Up() + Eigen::Vector2d::UnitY()).norm(), 1e-12);  // y goes downwards
  const TextBox turned = Box(0.0, 0.0, 10.0, 2.0, 90.0);
  EXPECT_LT((turned.Along() - Eigen::Vector2d::UnitY()).norm(), 1e-12);
  EXPECT_LT((turned.Up() - Eigen::Vector2d::UnitX()).norm(), 1e-12);
}

TEST(TextBoxTest, OverlapIsMoreThanABorder) {
  const TextBox box = Box(0.0, 0.0, 10.0, 2.0, 0.0);
  EXPECT_TRUE(Overlap(box, box));
  EXPECT_TRUE(Overlap(box, Box(9.9, 0.0, 10.0, 2.0, 0.0)));
  EXPECT_FALSE(Overlap(box, Box(10.0, 0.0, 10.0, 2.0, 0.0)));
  EXPECT_FALSE(Overlap(box, Box(0.0, 2.0, 10.0, 2.0, 0.0)));
  // An upright one beside it and across it.
  EXPECT_FALSE(Overlap(box, Box(6.1, 0.0, 10.0, 2.0, 90.0)));
  EXPECT_TRUE(Overlap(box, Box(5.9, 0.0, 10.0, 2.0, 90.0)));
  // Its bounding box has them, itself does not.
  EXPECT_FALSE(Overlap(Box(0.0, 0.0, 10.0, 0.5, 45.0), Box(4.0, -3.0, 4.0, 1.0, 0.0)));
  EXPECT_FALSE(Overlap(Box(4.0, -3.0, 4.0, 1.0, 0.0), Box(0.0, 0.0, 10.0, 0.5, 45.0)));
  EXPECT_TRUE(Overlap(Box(0.0, 0.0, 10.0, 0.5, 45.0), Box(3.0, 3.0, 4.0, 1.0, 0.0)));
}

TEST(TextWidthTest, CountsCharactersNotBytes) {
  EXPECT_EQ(TextWidth("", 3.0), 0.0);
  EXPECT_NEAR(TextWidth("22", 3.0), 2.0 * TextWidth("2", 3.0), 1e-12);
  EXPECT_NEAR(TextWidth("12.3", 6.0), 2.0 * TextWidth("12.3", 3.0), 1e-12);
  EXPECT_LT(TextWidth(".", 1.0), TextWidth("1", 1.0));
  EXPECT_LT(TextWidth("1", 1.0), TextWidth("m", 1.0));
  EXPECT_LT(TextWidth("\xc2\xb1", 1.0), 2.0 * TextWidth("1", 1.0));  // one sign: +-
}

}  // namespace
}  // namespace plumbline
