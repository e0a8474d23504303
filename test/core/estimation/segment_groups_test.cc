#include "core/estimation/segment_groups.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "core/estimation/estimation_problem.h"
#include "core/estimation/linearisation.h"
#include "core/estimation/normal_equations.h"
#include "test/testing/plane_scene.h"

namespace plumbline {
namespace {

constexpr int64_t kStart = 1'600'000'000'000'000'000;
constexpr int64_t kKnot = 100'000'000;

// A scanner at rest before a wall, one scan line every 40 ms.
class SegmentGroupsTest : public testing::Test {
 protected:
  SegmentGroupsTest() {
    rig_.scanners.resize(1);
    rig_.scanners[0].beams = 61;
    rig_.scanners[0].field_of_view_deg = 60.0;
    rig_.scanners[0].range_noise_m = 0.02;
    landmarks_.push_back(MakeVerticalLandmark(wall_.normal, {3.0, 0.0, 0.0}));
    trajectory_.ExtendTo(kStart + 15 * 40'000'000);
    std::mt19937_64 random(3);
    for (int scan = 0; scan < 14; ++scan) {
      const ScanLine line = TakeScanLine(
          {wall_},
          rig_.scanners[0],
          0,
          kStart + scan * 40'000'000,
          [](int64_t) { return Rigid3d(); },
          0.02,
          &random);
      observations_.push_back(ObservePlane(line, rig_.scanners[0], Rigid3d(), wall_, 0, 60));
      observations_.back().landmark_id = 0;
    }
    for (const Observation& observation : observations_) pointers_.push_back(&observation);
  }

  NormalEquations Equations(SegmentGroupCache* cache) {
    EstimationProblem problem(rig_, false, &trajectory_, &landmarks_);
    problem.AddSegments(pointers_, 0.0, cache);
    return LineariseDense(problem, problem.Layout());
  }

  const ScenePlane wall_ = {-Eigen::Vector3d::UnitX(), -3.0};
  Rig rig_;
  Trajectory trajectory_{kStart, kKnot, Rigid3d()};
  std::deque<Landmark> landmarks_;
  std::deque<Observation> observations_;
  std::vector<const Observation*> pointers_;
};

TEST_F(SegmentGroupsTest, LargerGroupsAreTheSameProblem) {
  SegmentGroupCache single(LinearisedGroup::kFine, 1);
  SegmentGroupCache pairs(LinearisedGroup::kFine, 2);
  const NormalEquations expected = Equations(&single);
  const NormalEquations found = Equations(&pairs);
  ASSERT_EQ(found.blocks, expected.blocks);
  EXPECT_LT((found.hessian - expected.hessian).norm(), 1e-9 * expected.hessian.norm());
  EXPECT_LT((found.gradient - expected.gradient).norm(), 1e-9 * expected.gradient.norm());
  const auto groups = [&](SegmentGroupCache* cache) {
    return cache->Update(rig_, nullptr, trajectory_, landmarks_, pointers_, {});
  };
  EXPECT_EQ(groups(&single).size(), 6u) << "14 scan lines in 0.54 s";
  ASSERT_EQ(groups(&pairs).size(), 3u);
  EXPECT_EQ(groups(&pairs)[1]->first_control_point, 2);
}

TEST_F(SegmentGroupsTest, OnlyWhatHasChangedIsMadeAnew) {
  SegmentGroupCache cache(LinearisedGroup::kFine, 2);
  Equations(&cache);
  const auto linearisations = [&] {
    std::vector<int> counts;
    for (const auto* entry :
         cache.Update(rig_, nullptr, trajectory_, landmarks_, pointers_, {})) {
      counts.push_back(entry->group->num_linearisations());
    }
    return counts;
  };
  EXPECT_EQ(linearisations(), (std::vector<int>{1, 1, 1}));
  ++observations_[6].revision;  // at 0.24 s, in the second group
  EXPECT_EQ(linearisations(), (std::vector<int>{1, 0, 1}));
}

// Of the same observations on a wall that has been found to bend, with parameters of its own.
TEST_F(SegmentGroupsTest, AWallThatHasBecomeACylinderIsMadeAnew) {
  SegmentGroupCache cache(LinearisedGroup::kFine, 2);
  Equations(&cache);
  landmarks_[0].TakeShapeOf(MakeCylinderLandmark(wall_.normal, 0.1, {3.0, 0.0, 0.0}));
  SegmentGroupCache fresh(LinearisedGroup::kFine, 2);
  const NormalEquations expected = Equations(&fresh);
  const NormalEquations found = Equations(&cache);
  ASSERT_EQ(found.hessian.rows(), expected.hessian.rows());
  EXPECT_EQ(found.hessian, expected.hessian);
  EXPECT_EQ(found.gradient, expected.gradient);
}

}  // namespace
}  // namespace plumbline
