#include "core/window/inactive_landmarks.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <map>
#include <random>
#include <vector>

#include "core/estimation/block_layout.h"
#include "core/estimation/normal_equations.h"

namespace plumbline {
namespace {

// A marginal prior of all blocks beside one whose planes rest; both are the same Gaussian.
class InactiveLandmarksTest : public testing::Test {
 protected:
  static constexpr int kNumPlanes = 7;

  InactiveLandmarksTest() {
    for (int id = 0; id < kNumPlanes; ++id) {
      Landmark landmark = id == 3
                              ? MakeHorizontalLandmark(1.0, {0.0, 0.0, 1.0})
                              : MakeVerticalLandmark({1.0, 0.1 * id, 0.0}, {2.0, 1.0, 0.0});
      landmark.id = id;
      landmarks_.push_back(landmark);
    }
    std::map<BlockId, int> sizes;
    for (int i = 0; i < 3; ++i) sizes[RotationBlock(i)] = sizes[PositionBlock(i)] = 3;
    for (const Landmark& landmark : landmarks_) {
      sizes[LandmarkBlock(landmark.id)] = landmark.num_parameters();
    }
    all_.equations = ZeroSystem(sizes);
    for (const BlockId& block : all_.equations.blocks) all_.at.push_back(Value(block));
    some_ = all_;
    AddInformation(all_.equations.blocks);
  }

  // Where a block is linearised: for planes their parameters.
  Eigen::VectorXd Value(const BlockId& block) {
    if (!IsLandmark(block)) return Eigen::VectorXd::Constant(4, 0.5);
    return AnchoredParameters(landmarks_[static_cast<size_t>(block.index)]);
  }

  // Of a landmark's parameters, from that of the marginal prior's coordinates.
  static Eigen::MatrixXd CovarianceOf(const Landmark& landmark,
                                      const Eigen::MatrixXd& anchored) {
    const Eigen::MatrixXd by_anchored = ParametersByAnchored(landmark);
    return by_anchored * anchored * by_anchored.transpose();
  }

  Eigen::MatrixXd Random(Eigen::Index rows, Eigen::Index columns) {
    Eigen::MatrixXd values(rows, columns);
    for (double& value : values.reshaped()) value = normal_(random_);
    return values;
  }

  // Measurements of these blocks, which both histories have.
  void AddInformation(const std::vector<BlockId>& blocks) {
    std::map<BlockId, int> sizes;
    for (const BlockId& block : blocks) {
      sizes[block] = BlockSize(all_.equations, FindBlock(all_.equations, block));
    }
    NormalEquations part = ZeroSystem(sizes);
    const Eigen::MatrixXd jacobian = Random(2 * part.size(), part.size());
    part.hessian = jacobian.transpose() * jacobian;
    part.gradient = 0.1 * jacobian.transpose() * Random(2 * part.size(), 1);
    for (MarginalPrior* prior : {&all_, &some_}) AddTo(part, part.blocks, &prior->equations);
  }

  void MoveInAll(const BlockId& block, const Eigen::VectorXd& step) {
    const size_t at = FindBlock(all_.equations, block);
    all_.equations.gradient +=
        all_.equations.hessian.middleCols(all_.equations.offsets[at], step.size()) * step;
    if (IsLandmark(block)) all_.at[at] += step;
  }

  // A step of the window: everything that is active has moved a little.
  void Rebase() {
    Eigen::VectorXd moved(some_.equations.size());
    for (size_t i = 0; i < some_.equations.blocks.size(); ++i) {
      const BlockId& block = some_.equations.blocks[i];
      const int size = BlockSize(some_.equations, i);
      const Eigen::VectorXd step = 0.1 * Random(size, 1);
      moved.segment(some_.equations.offsets[i], size) = step;
      MoveInAll(block, step);
      if (IsLandmark(block)) some_.at[i] += step;
    }
    some_.equations.gradient += some_.equations.hessian * moved;
    inactive_.Rebase(some_, moved);
  }

  // The planes' estimates and covariances by both.
  void ExpectSameEstimate() {
    const Eigen::MatrixXd expected = all_.equations.hessian.inverse();
    const Eigen::VectorXd minimum = -expected * all_.equations.gradient;
    const Eigen::MatrixXd covariance = some_.equations.hessian.inverse();
    const Eigen::VectorXd steps = -covariance * some_.equations.gradient;
    inactive_.Update(some_, steps, covariance, &landmarks_);
    for (size_t i = 0; i < all_.equations.blocks.size(); ++i) {
      const BlockId& block = all_.equations.blocks[i];
      if (!IsLandmark(block)) continue;
      const int size = BlockSize(all_.equations, i);
      const int row = all_.equations.offsets[i];
      const Eigen::VectorXd value = all_.at[i] + minimum.segment(row, size);
      const Eigen::MatrixXd spread = expected.block(row, row, size, size);
      if (inactive_.Contains(block.index)) {
        const Landmark& landmark = landmarks_[static_cast<size_t>(block.index)];
        EXPECT_LT((Value(block) - value).norm(), 1e-9) << block.index;
        EXPECT_LT(
            (landmark.covariance.topLeftCorner(size, size) - CovarianceOf(landmark, spread))
                .norm(),
            1e-9);
      } else {
        const size_t at = FindBlock(some_.equations, block);
        ASSERT_LT(at, some_.equations.blocks.size());
        const int own = some_.equations.offsets[at];
        EXPECT_LT((some_.at[at] + steps.segment(own, size) - value).norm(), 1e-9);
        EXPECT_LT((covariance.block(own, own, size, size) - spread).norm(), 1e-9);
      }
    }
  }

  std::mt19937_64 random_{5};
  std::normal_distribution<double> normal_;
  std::deque<Landmark> landmarks_;
  MarginalPrior all_;
  MarginalPrior some_;
  InactiveLandmarks inactive_;
};

TEST_F(InactiveLandmarksTest, HistoryAndConditionalAreTheWholeHistory) {
  inactive_.Deactivate({1, 3, 4}, 0, &some_);
  EXPECT_TRUE(inactive_.Contains(3));
  EXPECT_FALSE(inactive_.Contains(2));
  EXPECT_TRUE(inactive_.DependsOn(RotationBlock(0)));
  EXPECT_FALSE(inactive_.DependsOn(LandmarkBlock(3)));
  ExpectSameEstimate();
  AddInformation({PositionBlock(1), LandmarkBlock(0), LandmarkBlock(2)});
  Rebase();
  ExpectSameEstimate();
}

TEST_F(InactiveLandmarksTest, PlanesComeAndGo) {
  inactive_.Deactivate({1, 3, 4}, 0, &some_);
  AddInformation({PositionBlock(1), PositionBlock(2), LandmarkBlock(0), LandmarkBlock(2)});
  Rebase();
  inactive_.Deactivate({0, 5}, 0, &some_);
  ExpectSameEstimate();
  AddInformation({PositionBlock(2), LandmarkBlock(2)});
  Rebase();
  // Their loop closes: what is learnt of them reaches the others that rest.
  inactive_.Activate({0, 3, 4}, landmarks_, &some_);
  for (const int id : {0, 3, 4}) {
    const BlockId block = LandmarkBlock(id);
    MoveInAll(block, Value(block) - all_.at[FindBlock(all_.equations, block)]);
  }
  EXPECT_FALSE(inactive_.Contains(0));
  EXPECT_TRUE(inactive_.Contains(1));
  ExpectSameEstimate();
  AddInformation({PositionBlock(2), LandmarkBlock(0), LandmarkBlock(4)});
  ExpectSameEstimate();
  inactive_.Deactivate({0, 2, 4}, 0, &some_);
  ExpectSameEstimate();
}

// Control points that the window has left are of no use but to the inactive landmarks; the
// next time that planes are taken in they go.
TEST_F(InactiveLandmarksTest, AnchorsGoWithTheNextPlanes) {
  inactive_.Deactivate({1, 3}, 0, &some_);
  AddInformation({RotationBlock(2), PositionBlock(2), LandmarkBlock(0), LandmarkBlock(2)});
  inactive_.Deactivate({0}, 2, &some_);
  EXPECT_FALSE(inactive_.DependsOn(PositionBlock(1)));
  EXPECT_EQ(FindBlock(some_.equations, PositionBlock(1)), some_.equations.blocks.size());
  EXPECT_LT(FindBlock(some_.equations, PositionBlock(2)), some_.equations.blocks.size());
  ExpectSameEstimate();
  inactive_.Activate({0, 1, 3}, landmarks_, &some_);
  EXPECT_TRUE(inactive_.empty());
  ExpectSameEstimate();
}

// As if planes 2 and 5 had been measured to be the same one.
TEST_F(InactiveLandmarksTest, MergedPlanesShareTheirParameters) {
  for (const bool both_given : {true, false}) {
    MarginalPrior all = all_;
    MarginalPrior some = some_;
    InactiveLandmarks inactive = inactive_;
    inactive.Deactivate({1, 3}, 0, &some);
    if (!both_given) inactive.Deactivate({5}, 0, &some);
    if (!both_given) inactive.Activate({5}, landmarks_, &some);
    const Eigen::VectorXd shift = all.at[FindBlock(all.equations, LandmarkBlock(2))] -
                                  all.at[FindBlock(all.equations, LandmarkBlock(5))];
    const Eigen::Matrix2d by_into = (Eigen::Matrix2d() << 1.0, 0.0, 1.7, 1.0).finished();
    const auto merge = [&](MarginalPrior* prior) {
      NormalEquations& equations = prior->equations;
      const size_t from = FindBlock(equations, LandmarkBlock(5));
      const Eigen::VectorXd own_shift =
          prior->at[FindBlock(equations, LandmarkBlock(2))] - prior->at[from];
      equations.gradient +=
          equations.hessian.middleCols(equations.offsets[from], 2) * own_shift;
      equations.hessian.middleCols(equations.offsets[from], 2) *= by_into;
      equations.hessian.middleRows(equations.offsets[from], 2)
          .applyOnTheLeft(by_into.transpose());
      equations.gradient.segment(equations.offsets[from], 2)
          .applyOnTheLeft(by_into.transpose());
      std::vector<BlockId> names = equations.blocks;
      names[from] = LandmarkBlock(2);
      std::map<BlockId, int> sizes;
      for (size_t i = 0; i < names.size(); ++i) sizes[names[i]] = BlockSize(equations, i);
      NormalEquations merged = ZeroSystem(sizes);
      AddTo(equations, names, &merged);
      equations = merged;
      prior->at.erase(prior->at.begin() + static_cast<std::ptrdiff_t>(from));
    };
    merge(&all);
    merge(&some);
    inactive.Merge(2, 5, shift, by_into, false);
    const Eigen::MatrixXd expected = all.equations.hessian.inverse();
    const Eigen::VectorXd minimum = -expected * all.equations.gradient;
    const Eigen::MatrixXd covariance = some.equations.hessian.inverse();
    std::deque<Landmark> landmarks = landmarks_;
    inactive.Update(some, -covariance * some.equations.gradient, covariance, &landmarks);
    const size_t at = FindBlock(all.equations, LandmarkBlock(1));
    const int row = all.equations.offsets[at];
    EXPECT_LT((AnchoredParameters(landmarks[1]) - all.at[at] - minimum.segment(row, 2)).norm(),
              1e-9);
    EXPECT_LT((landmarks[1].covariance.topLeftCorner<2, 2>() -
               CovarianceOf(landmarks[1], expected.block<2, 2>(row, row)))
                  .norm(),
              1e-9);
  }
}

// The gauge's wall takes in another plane: its heading still has no say and stays held.
TEST_F(InactiveLandmarksTest, HeldDirectionsStayHeld) {
  const auto held = [&] {
    return some_.equations.offsets[FindBlock(some_.equations, LandmarkBlock(2))];
  };
  const auto hold = [&] {
    some_.equations.hessian.row(held()).setZero();
    some_.equations.hessian.col(held()).setZero();
    some_.equations.gradient[held()] = 0.0;
  };
  hold();
  inactive_.Deactivate({1, 3}, 0, &some_);
  inactive_.Merge(2, 5, Eigen::Vector2d(0.01, 0.02), Eigen::Matrix2d::Identity(), true);
  inactive_.Activate({1, 3}, landmarks_, &some_);
  EXPECT_EQ(some_.equations.hessian.row(held()).norm(), 0.0);
  EXPECT_EQ(some_.equations.hessian.col(held()).norm(), 0.0);
  EXPECT_EQ(some_.equations.gradient[held()], 0.0);
}

}  // namespace
}  // namespace plumbline
