#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <deque>
#include <map>
#include <random>
#include <vector>

#include "core/estimation/estimation_problem.h"
#include "core/sensor/rig.h"
#include "core/surface/landmark.h"
#include "core/trajectory/trajectory.h"

namespace plumbline {

// A problem of which the solution is known: priors on neighbouring control points and two
// planes, with the same mean and full random roots. The unknowns stand at the mean.
class PriorProblem {
 public:
  static constexpr int64_t kStartNs = 1'600'000'000'000'000'000;
  static constexpr int64_t kKnotNs = 100'000'000;
  static constexpr int kNumControlPoints = 11;  // of two tiles

  explicit PriorProblem(bool planar = false)
      : trajectory_(kStartNs, kKnotNs, Rigid3d()),
        problem_(rig_, planar, &trajectory_, &landmarks_) {
    trajectory_.ExtendTo(kStartNs + (kNumControlPoints - 4) * kKnotNs);
    for (int i = 0; i < kNumControlPoints; ++i) {
      ControlPoint& point = trajectory_.control_point(i);
      point.position = {0.1 * i, 0.02 * i * i, 0.0};
      const double half = 0.1 * i;
      point.rotation = {0.0, 0.0, std::sin(half), std::cos(half)};
    }
    landmarks_.push_back(MakeHorizontalLandmark(1.0, {0.0, 0.0, -1.2}));
    landmarks_.push_back(MakeGeneralLandmark({0.6, 0.0, 0.8}, {2.0, 1.0, 0.5}));
    landmarks_.back().id = 1;
  }

  // Blocks of a control point and the next one, and of both planes.
  static std::vector<BlockId> Neighbours(int control_point) {
    return {RotationBlock(control_point),
            PositionBlock(control_point),
            RotationBlock(control_point + 1),
            PositionBlock(control_point + 1),
            LandmarkBlock(0),
            LandmarkBlock(1)};
  }

  // Adds all priors, so that every unknown is determined.
  void AddAllPriors() {
    for (int i = 0; i + 1 < kNumControlPoints; ++i) AddPrior(Neighbours(i));
  }
  // Adds one with a random root. Its mean is where the unknowns stand now.
  void AddPrior(const std::vector<BlockId>& blocks) {
    Eigen::Index size = 0;
    for (const BlockId& block : blocks) size += problem_.unknowns().TangentSize(block);
    Eigen::MatrixXd root(size, size);
    for (double& value : root.reshaped()) value = normal_(random_);
    AddPrior(blocks, root);
  }
  void AddPrior(const std::vector<BlockId>& blocks, const Eigen::MatrixXd& root) {
    Prior prior;
    prior.blocks = blocks;
    for (const BlockId& block : blocks) {
      const int size = problem_.unknowns().AmbientSize(block);
      prior.linear.blocks.push_back(
          {problem_.unknowns().KindOf(block),
           size,
           Eigen::Map<const Eigen::VectorXd>(problem_.unknowns().Data(block), size)});
    }
    prior.linear.root = root;
    prior.linear.offset.setZero(root.rows());
    problem_.AddPrior(prior);
    priors_.push_back(prior);
  }

  // Hessian of all priors at their mean, in the layout's columns: S^T S of each.
  Eigen::MatrixXd Hessian() const {
    const BlockLayout layout = problem_.Layout();
    std::map<BlockId, int> first;
    for (size_t i = 0; i < layout.blocks.size(); ++i) {
      first[layout.blocks[i]] = layout.offsets[i];
    }
    Eigen::MatrixXd hessian = Eigen::MatrixXd::Zero(layout.size(), layout.size());
    for (const Prior& prior : priors_) {
      std::vector<int> columns;
      for (const BlockId& block : prior.blocks) {
        for (int k = 0; k < problem_.unknowns().TangentSize(block); ++k) {
          columns.push_back(first.at(block) + k);
        }
      }
      hessian(columns, columns) += prior.linear.root.transpose() * prior.linear.root;
    }
    return hessian;
  }

  // Moves all free unknowns a little, at random.
  void Disturb(double size) {
    const BlockLayout layout = problem_.Layout();
    Eigen::VectorXd step(static_cast<Eigen::Index>(layout.FreeColumns().size()));
    for (double& value : step) value = size * normal_(random_);
    problem_.unknowns().Move(layout, step);
  }

  // How far the unknowns are from the mean of the priors, by the largest number.
  double DistanceFromMean() const {
    double distance = 0.0;
    for (const Prior& prior : priors_) {
      for (size_t i = 0; i < prior.blocks.size(); ++i) {
        const Eigen::VectorXd& x0 = prior.linear.blocks[i].x0;
        const Eigen::Map<const Eigen::VectorXd> now(problem_.unknowns().Data(prior.blocks[i]),
                                                    x0.size());
        distance = std::max(distance, (now - x0).lpNorm<Eigen::Infinity>());
      }
    }
    return distance;
  }

  EstimationProblem& problem() { return problem_; }
  Trajectory& trajectory() { return trajectory_; }
  std::deque<Landmark>& landmarks() { return landmarks_; }

 private:
  Rig rig_;
  Trajectory trajectory_;
  std::deque<Landmark> landmarks_;
  EstimationProblem problem_;
  std::vector<Prior> priors_;
  std::mt19937_64 random_{7};
  std::normal_distribution<double> normal_;
};

}  // namespace plumbline
