#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "test/core/visibility/resegmentation_fixture.h"

namespace plumbline {
namespace {

class SubMinimumSegmentTest : public ResegmentationTest {
 protected:
  // Other beams meet nothing.
  void SeeOnly(int first_beam, int last_beam) {
    for (int beam = 0; beam < line_.num_beams(); ++beam) {
      if (beam >= first_beam && beam <= last_beam) continue;
      line_.ranges[static_cast<size_t>(beam)] = 20.0f;
    }
  }
  // Of the side wall, too few beams for a segment are seen before the view opens.
  void See(int num_beams) {
    SeeOnly(40, kLast + num_beams);
    AddSideWall(2.0);
    AddObservation(kFront, 40, kLast);
  }
};

TEST_F(SubMinimumSegmentTest, BelongsToThePlaneMetThere) {
  for (const int num_beams : {1, 3}) {
    state_->observations.clear();
    See(num_beams);
    Resegment();
    ASSERT_EQ(state_->sub_minimum_segments.size(), 1u) << num_beams;
    const Observation& segment = state_->sub_minimum_segments[0];
    EXPECT_EQ(segment.landmark_id, kSide);
    EXPECT_EQ(segment.first_beam, kLast + 1);
    EXPECT_EQ(segment.last_beam, kLast + num_beams);
    EXPECT_EQ(segment.num_points, num_beams);
    for (size_t beam = kLast + 1; beam < line_.ranges.size(); ++beam) {
      line_.ranges[beam] = Range(static_cast<int>(beam));
    }
    state_->landmarks.pop_back();
  }
}

// Twelve centimetres of range farther, which no beam alone can tell.
TEST_F(SubMinimumSegmentTest, BelongsToThePlaneThatHidesTheOther) {
  See(3);
  AddWall({0.0, -1.0, 0.0}, {-2.0, 1.05, 0.0}, {2.0, 1.05, 0.0});
  Resegment();
  ASSERT_EQ(state_->sub_minimum_segments.size(), 1u);
  EXPECT_EQ(state_->sub_minimum_segments[0].landmark_id, kSide);
  EXPECT_EQ(state_->sub_minimum_segments[0].num_points, 3);
}

// Across the corner, as the noise of a few beams may have it.
TEST_F(SubMinimumSegmentTest, IsMadeOfASegmentOnNoPlane) {
  SeeOnly(kLast - 6, kLast + 3);
  AddSideWall(2.0);
  AddObservation(kFront, kLast - 6, kLast + 3);
  state_->observations[0].landmark_id = -1;
  line_.ranges[kLast - 3] += 0.12f;
  Resegment();
  ASSERT_EQ(state_->sub_minimum_segments.size(), 3u);
  const std::vector<std::pair<int, int>> beams = {
      {kLast - 6, kLast - 4}, {kLast - 2, kLast}, {kLast + 1, kLast + 3}};
  for (size_t i = 0; i < 3; ++i) {
    const Observation& segment = state_->sub_minimum_segments[i];
    EXPECT_EQ(segment.landmark_id, i < 2 ? kFront : kSide);
    EXPECT_EQ(segment.first_beam, beams[i].first);
    EXPECT_EQ(segment.last_beam, beams[i].second);
  }
}

// Segmentation has left these out between two segments on one wall, each of which ends for its
// own noise.
TEST_F(SubMinimumSegmentTest, IsMadeOfBeamsThatNoSegmentHas) {
  SeeOnly(40, kLast);
  AddObservation(kFront, 40, 60);
  AddObservation(kFront, 90, kLast);
  line_.ranges[75] += 0.12f;
  Resegment();
  std::vector<std::pair<int, int>> beams;
  for (const Observation& segment : state_->sub_minimum_segments) {
    EXPECT_EQ(segment.landmark_id, kFront);
    beams.emplace_back(segment.first_beam, segment.last_beam);
  }
  EXPECT_EQ(beams, (std::vector<std::pair<int, int>>{{61, 74}, {76, 89}}));
}

// It may lie on something behind the edge.
TEST_F(SubMinimumSegmentTest, EndsBeforeTheFreeEdgeOfItsPlane) {
  SeeOnly(kLast - 6, kLast);
  AddObservation(kFront, kLast - 6, kLast);
  state_->observations[0].landmark_id = -1;
  Resegment();
  ASSERT_EQ(state_->sub_minimum_segments.size(), 1u);
  EXPECT_EQ(state_->sub_minimum_segments[0].first_beam, kLast - 6);
  EXPECT_EQ(state_->sub_minimum_segments[0].last_beam, kLast - 1) << "2.5 cm from the edge";
}

TEST_F(SubMinimumSegmentTest, IsNotMadeOfWhatLiesElsewhere) {
  See(1);
  line_.ranges[kLast + 1] += 0.5f;
  Resegment();
  EXPECT_TRUE(state_->sub_minimum_segments.empty());
}

TEST_F(SubMinimumSegmentTest, EndsOnItsPlane) {
  See(3);
  line_.ranges[kLast + 3] += 0.12f;
  Resegment();
  ASSERT_EQ(state_->sub_minimum_segments.size(), 1u);
  EXPECT_EQ(state_->sub_minimum_segments[0].first_beam, kLast + 1);
  EXPECT_EQ(state_->sub_minimum_segments[0].last_beam, kLast + 2);
}

// The range noise is 3 cm. Where the pose is not known to it across the plane, beams would be
// chosen by the pose that they hold; along the plane it does not matter.
TEST_F(SubMinimumSegmentTest, IsNotMadeWhereThePoseIsOpenAcrossItsPlane) {
  const auto count_with = [&](double across_m, double along_m, double yaw_rad) {
    state_->observations.clear();
    pose_covariance_.setZero();
    pose_covariance_.diagonal() << 0.0, 0.0, yaw_rad * yaw_rad, along_m * along_m,
        across_m * across_m, 0.0;
    AddObservation(kFront, 40, kLast);
    Resegment();
    return state_->sub_minimum_segments.size();
  };
  See(3);
  EXPECT_EQ(count_with(0.02, 1.0, 0.0), 1u);
  EXPECT_EQ(count_with(0.05, 0.0, 0.0), 0u);
  // The beams meet the wall 1.9 m ahead of the rig.
  EXPECT_EQ(count_with(0.0, 0.0, 0.01), 1u);
  EXPECT_EQ(count_with(0.0, 0.0, 0.025), 0u);
}

TEST_F(SubMinimumSegmentTest, IsMadeAnewEachTime) {
  See(3);
  Resegment();
  const int revision = state_->sub_minimum_segments.at(0).revision;
  Resegment();
  ASSERT_EQ(state_->sub_minimum_segments.size(), 1u);
  EXPECT_GT(state_->sub_minimum_segments[0].revision, revision);
}

}  // namespace
}  // namespace plumbline
