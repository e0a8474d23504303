#include "core/judging/mounting_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/geometry/angles.h"
#include "core/geometry/robust_fit.h"
#include "core/judging/levels.h"
#include "factors/spline/so3.h"

namespace plumbline {
namespace {

using Vector8d = Eigen::Matrix<double, 8, 1>;  // rotation, translation, time, range
using Matrix8d = Eigen::Matrix<double, 8, 8>;

// Scales of Cauchy's loss, one for each step: what is far off is to be caught first.
constexpr double kLossScales[] = {0.4, 0.4, 0.2, 0.2, 0.1, 0.05, 0.05, 0.05};  // m
// Standard deviations of the prior about the rig file.
constexpr double kPriorPose = 0.2;    // rad and m
constexpr double kPriorTime = 0.1;    // s
constexpr double kPriorRange = 0.05;  // m
// What keeps more than this share of the prior's standard deviation is unobservable and held
// at zero; so are turns and shifts whose standard deviation is kOpenRatio times that of the
// best axis: they are determined by the noise of the surfaces' directions.
constexpr double kOpenShare = 0.125;
constexpr double kOpenRatio = 5.0;
constexpr double kHeld = 1e12;  // information about what is held

Vector8d Stacked(double turn, double shift, double time, double range) {
  Vector8d stacked;
  stacked << turn, turn, turn, shift, shift, shift, time, range;
  return stacked;
}

using Sample = std::vector<std::vector<SampledLine>>;

// Fits the correction of one scanner, the others held.
class MountingFit {
 public:
  // stated: of the scanner, what the correction is about.
  MountingFit(const Sample& sample,
              const MountedRig& rig,
              size_t scanner,
              const MountedScanner& stated)
      : sample_(sample),
        rig_(rig),
        scanner_(scanner),
        stated_(stated),
        prior_(Stacked(kPriorPose, kPriorPose, kPriorTime, kPriorRange)
                   .cwiseAbs2()
                   .cwiseInverse()
                   .asDiagonal()) {
    const MountedScanner& now = rig[scanner];
    total_.head<3>() =
        Log(now.body_from_scanner.rotation * stated.body_from_scanner.rotation.conjugate());
    total_.segment<3>(3) =
        now.body_from_scanner.translation - stated.body_from_scanner.translation;
    total_(6) = now.time_offset_s - stated.time_offset_s;
    total_(7) = now.range_offset_m - stated.range_offset_m;
  }

  // Holds what level scanners do not show: turns about the body's x and y axes, and the
  // height.
  void HoldTiltsAndHeight() {
    for (const Eigen::Index index : {0, 1, 5}) prior_(index, index) = kHeld;
  }

  // hold_open: whether what the scans hardly show is held.
  MountingCorrection Run(bool hold_open) {
    MountingCorrection correction;
    correction.corrected = stated_;
    Compare();
    correction.num_compared = static_cast<int>(comparisons_.size());
    if (correction.num_compared < kMinPlaces) return correction;
    correction.near_share = ShareWithin(comparisons_, kOnePlace);
    Iterate();
    if (hold_open) {
      HoldOpen();
      Iterate();
    }
    correction.moved_share = ShareWithin(comparisons_, kOnePlace);
    correction.rotation_rad = total_.head<3>();
    correction.translation_m = total_.segment<3>(3);
    correction.time_offset_s = total_(6);
    correction.range_offset_m = total_(7);
    correction.stddev = covariance_.diagonal().cwiseSqrt();
    correction.corrected = rig_[scanner_];
    return correction;
  }

 private:
  void Compare() {
    comparisons_.clear();
    for (size_t other = 0; other < rig_.size(); ++other) {
      if (other == scanner_) continue;
      const auto some =
          CompareViews(sample_, rig_, scanner_, other, kComparedLines, kOnePlace);
      comparisons_.insert(comparisons_.end(), some.begin(), some.end());
    }
  }

  void Iterate() {
    for (const double loss_scale : kLossScales) {
      Step(loss_scale);
      Apply();
      Compare();
    }
  }

  // Holds what the scans do not show.
  void HoldOpen() {
    HoldAxes(0, kOpenShare * kPriorPose);
    HoldAxes(3, kOpenShare * kPriorPose);
    const auto hold = [&](Eigen::Index index, double open) {
      if (covariance_(index, index) <= open * open) return;
      prior_(index, index) = kHeld;
      total_(index) = 0.0;
    };
    hold(6, kOpenShare * kPriorTime);
    hold(7, kOpenShare * kPriorRange);
    Apply();
    Compare();
  }

  // Holds the axes, of any direction, of a turn or a shift that are known badly.
  void HoldAxes(Eigen::Index first, double open) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(
        covariance_.block<3, 3>(first, first));
    const Eigen::Vector3d stddev = axes.eigenvalues().cwiseMax(0.0).cwiseSqrt();
    for (Eigen::Index i = 0; i < 3; ++i) {
      if (stddev(i) < std::min(open, kOpenRatio * stddev(0))) continue;
      const Eigen::Vector3d axis = axes.eigenvectors().col(i);
      prior_.block<3, 3>(first, first) += kHeld * axis * axis.transpose();
      total_.segment<3>(first) -= axis.dot(total_.segment<3>(first)) * axis;
    }
  }

  void Step(double loss_scale) {
    RobustFit<8> fit;
    fit.AddPrior(prior_, total_);
    const Eigen::Vector3d origin = rig_[scanner_].body_from_scanner.translation;
    for (const ViewComparison& one : comparisons_) {
      const Eigen::Vector3d beam = one.p_a - origin;
      Vector8d jacobian;
      jacobian.head<3>() = beam.cross(one.normal);
      jacobian.segment<3>(3) = one.normal;
      jacobian(6) = -one.rate_m_s;
      jacobian(7) = one.normal.dot(beam.normalized());
      fit.Add(jacobian,
              one.distance_m,
              CauchyWeight(one.distance_m, loss_scale) / (loss_scale * loss_scale));
    }
    const double scatter = ScatterRatio(loss_scale);
    covariance_ = scatter * scatter * fit.hessian().ldlt().solve(Matrix8d::Identity());
    total_ += fit.Step();
  }

  // The standard deviation of a place's distance over the one that the loss stands for.
  // Neighbouring lines share their errors: twice what the distances show is right.
  double ScatterRatio(double loss_scale) const {
    constexpr double kShared = 2.0;
    const double scatter = std::max(kMinNoise, 1.4826 * MedianDistance(comparisons_));
    return std::min(1.0, kShared * scatter / loss_scale);
  }

  void Apply() {
    MountedScanner& moved = rig_[scanner_];
    moved = stated_;
    const double angle = total_.head<3>().norm();
    if (angle > 0.0) {
      moved.body_from_scanner.rotation =
          Eigen::Quaterniond(Eigen::AngleAxisd(angle, total_.head<3>() / angle)) *
          stated_.body_from_scanner.rotation;
    }
    moved.body_from_scanner.translation += total_.segment<3>(3);
    moved.time_offset_s += total_(6);
    moved.range_offset_m += total_(7);
  }

  const Sample& sample_;
  MountedRig rig_;
  size_t scanner_;
  MountedScanner stated_;
  Matrix8d prior_;  // information about the total
  Vector8d total_ = Vector8d::Zero();
  Matrix8d covariance_ = Matrix8d::Zero();
  std::vector<ViewComparison> comparisons_;
};

}  // namespace

MountingCorrection FitMounting(const Sample& sample, const MountedRig& rig, size_t scanner) {
  return MountingFit(sample, rig, scanner, rig[scanner]).Run(true);
}

MountedRig FitInTurns(const Sample& sample, const MountedRig& rig, size_t held, bool planar) {
  constexpr int kRounds = 4;
  MountedRig fitted = rig;
  for (int round = 0; round < kRounds; ++round) {
    for (size_t i = 0; i < rig.size(); ++i) {
      if (i == held) continue;
      MountingFit fit(sample, fitted, i, rig[i]);
      if (planar) fit.HoldTiltsAndHeight();
      // While the others are far off, scatter does not tell what the scans hardly show.
      const MountingCorrection correction = fit.Run(!planar && 2 * round >= kRounds);
      if (correction.moved_share > correction.near_share) fitted[i] = correction.corrected;
    }
  }
  return fitted;
}

std::vector<MountingCorrection> FitMountings(const Sample& sample, const MountedRig& rig) {
  std::vector<MountingCorrection> corrections(rig.size());
  for (size_t i = 0; i < rig.size() && rig.size() > 1; ++i) {
    corrections[i] = FitMounting(sample, rig, i);
  }
  return corrections;
}

}  // namespace plumbline
