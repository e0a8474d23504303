#include "core/registration/place_groups.h"

#include <gtest/gtest.h>

#include <cmath>

namespace plumbline {
namespace {

constexpr double kStride = 4.0;  // m

// A rig that goes straight on for 200 m and believes it; visits every 4 m.
class PlaceGroupsTest : public testing::Test {
 protected:
  PlaceGroupsTest() {
    for (int i = 0; i < 50; ++i) {
      Visit visit;
      visit.way_m = kStride * i;
      visit.world_from_visit = {0.0, {kStride * i, 0.0}};
      visits_.push_back(visit);
      if (i == 0) continue;
      PoseGraphEdge edge;
      edge.from = static_cast<size_t>(i - 1);
      edge.to = static_cast<size_t>(i);
      edge.from_from_to = {0.0, {kStride, 0.0}};
      edge.information = Eigen::Vector3d(1e4, 1e4, 1e4).asDiagonal();
      motion_.push_back(edge);
    }
  }

  // The later visits lie where the earlier ones are, as if the way had led back there.
  void Close(size_t earlier, size_t later, size_t count, double off_m = 0.0) {
    for (size_t i = 0; i < count; ++i) {
      PoseGraphEdge closure;
      closure.from = earlier + i;
      closure.to = later + i;
      closure.from_from_to = {0.0, {off_m * static_cast<double>(i), 0.1}};
      closure.information = Eigen::Vector3d(1e3, 1e3, 1e4).asDiagonal();
      closures_.push_back(closure);
    }
  }

  std::vector<PlaceGroup> Find() const {
    return ConsistentGroups(closures_, motion_, visits_, 12.0);
  }

  std::vector<Visit> visits_;
  std::vector<PoseGraphEdge> motion_;
  std::vector<PoseGraphEdge> closures_;
};

TEST_F(PlaceGroupsTest, AStretchThatAgreesIsAPlace) {
  Close(2, 30, 6);
  const std::vector<PlaceGroup> groups = Find();
  ASSERT_EQ(groups.size(), 1u);
  EXPECT_EQ(groups[0].size(), 6u);
}

TEST_F(PlaceGroupsTest, AFewClosuresAreNone) {
  Close(2, 30, 3);
  EXPECT_TRUE(Find().empty());
}

TEST_F(PlaceGroupsTest, ClosuresThatContradictEachOtherAreNone) {
  Close(2, 30, 6, 1.5);
  EXPECT_TRUE(Find().empty());
}

TEST_F(PlaceGroupsTest, PlacesThatLookAlikeAreRefused) {
  Close(2, 30, 6);
  Close(15, 30, 5);
  EXPECT_TRUE(Find().empty());
}

TEST_F(PlaceGroupsTest, AFewThatContradictDoNotRefuteMany) {
  Close(2, 30, 8);
  Close(15, 32, 2);
  const std::vector<PlaceGroup> groups = Find();
  ASSERT_EQ(groups.size(), 1u);
  EXPECT_EQ(groups[0].front().from, 2u);
}

TEST_F(PlaceGroupsTest, WithoutClosuresThereIsNone) { EXPECT_TRUE(Find().empty()); }

}  // namespace
}  // namespace plumbline
