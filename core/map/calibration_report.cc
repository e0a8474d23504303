#include "core/map/calibration_report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "core/geometry/angles.h"
#include "core/util/error.h"
#include "factors/spline/so3.h"

namespace plumbline {
namespace {

struct ParameterName {
  const char* name;
  const char* words;
  double unit;  // in the block's
};
constexpr std::array<ParameterName, kMountedBlockSize> kParameters = {{
    {"roll_deg", "roll", kRadiansPerDegree},
    {"pitch_deg", "pitch", kRadiansPerDegree},
    {"yaw_deg", "yaw", kRadiansPerDegree},
    {"x_m", "position along x", 1.0},
    {"y_m", "position along y", 1.0},
    {"z_m", "height", 1.0},
    {"time_s", "clock", 1.0},
    {"range_m", "range bias", 1.0},
    {"range_scale", "range scale", 1.0},
    {"mount_zero_deg", "zero of the mount", kRadiansPerDegree},
    {"mount_time_s", "clock of the mount", 1.0},
    {"mount_rate", "rate of the mount", 1.0},
    {"mount_tilt_1_deg", "first tilt of the mount's axis", kRadiansPerDegree},
    {"mount_tilt_2_deg", "second tilt of the mount's axis", kRadiansPerDegree},
    {"mount_shift_1_m", "first shift of the mount's axis", 1.0},
    {"mount_shift_2_m", "second shift of the mount's axis", 1.0},
}};

const ParameterName* FindParameter(const std::string& name) {
  const auto found =
      std::find_if(kParameters.begin(), kParameters.end(), [&](const ParameterName& known) {
        return name == known.name;
      });
  return found == kParameters.end() ? nullptr : &*found;
}

// What drives a mount is faster in the other by this share.
double RateBetween(const Mount& from, const Mount& to) {
  if (from.swing) return from.swing->period_s / to.swing->period_s - 1.0;
  return from.rate_rad_s == 0.0 ? 0.0 : to.rate_rad_s / from.rate_rad_s - 1.0;
}

// Adds what makes one mount of the other.
void AddMountBetween(const Mount& from, const Mount& to, ScannerBlock* block) {
  const Eigen::Matrix<double, 3, 2> across = AcrossAxis(from.axis);
  const Eigen::Vector2d tilts = across.transpose() * to.axis / from.axis.dot(to.axis);
  const Eigen::Vector2d shifts = across.transpose() * (to.point - from.point);
  (*block)[kMountZeroAt] = to.zero_rad - from.zero_rad;
  (*block)[kMountDelayAt] = to.time_offset_s - from.time_offset_s;
  (*block)[kMountRateAt] = RateBetween(from, to);
  for (size_t i = 0; i < 2; ++i) {
    (*block)[kMountTiltAt + i] = tilts[static_cast<Eigen::Index>(i)];
    (*block)[kMountShiftAt + i] = shifts[static_cast<Eigen::Index>(i)];
  }
}

// The block that makes one scanner of the other.
ScannerBlock BlockBetween(const Scanner& from, const Scanner& to) {
  const Eigen::Vector3d turn =
      Log(to.body_from_scanner.rotation * from.body_from_scanner.rotation.conjugate());
  const Eigen::Vector3d shift =
      to.body_from_scanner.translation - from.body_from_scanner.translation;
  ScannerBlock block = {turn.x(),
                        turn.y(),
                        turn.z(),
                        shift.x(),
                        shift.y(),
                        shift.z(),
                        to.time_offset_s - from.time_offset_s,
                        (to.range_bias_m - from.range_bias_m) * from.range_scale,
                        1.0 - to.range_scale / from.range_scale};
  if (from.mount) AddMountBetween(*from.mount, *to.mount, &block);
  return block;
}

double LargestSigma(const ScannerMatrix& covariance, int first, int count) {
  return std::sqrt(covariance.diagonal().segment(first, count).maxCoeff());
}

}  // namespace

std::string ParameterInWords(const std::string& name) {
  const ParameterName* found = FindParameter(name);
  return found == nullptr ? "" : found->words;
}

Calibration DescribeCalibration(const Rig& stated,
                                const Rig& rig,
                                const RigCalibration& calibration,
                                const Eigen::MatrixXd& covariance) {
  const Rig calibrated = calibration.Calibrated(rig);
  Calibration described;
  std::vector<int> rows;  // of what is not held by definition
  std::vector<double> to_units;
  int row = 0;
  for (size_t i = 0; i < calibration.scanners.size(); ++i) {
    const ScannerEstimate& scanner = calibration.scanners[i];
    if (!scanner.IsEstimated()) continue;
    CalibratedScanner found;
    found.name = rig.scanners[i].name;
    const ScannerBlock off = BlockBetween(stated.scanners[i], calibrated.scanners[i]);
    const ScannerBlock start = BlockBetween(stated.scanners[i], rig.scanners[i]);
    const auto size = static_cast<size_t>(scanner.BlockSize());
    const ScannerBlock stated_sigmas = StatedSigmas(rig.scanners[i]);
    for (size_t k = 0; k < size; ++k, ++row) {
      const auto& [name, words, unit] = kParameters[k];
      // Held parameters are as uncertain as the rig file states.
      const bool is_of_body = scanner.is_body && (k < kScannerRangeAt ||
                                                  k == kScannerScaleAt || k == kMountZeroAt);
      const double prior_sigma = is_of_body ? 0.0 : stated_sigmas[k];
      const double sigma =
          scanner.prior_sigma[k] > 0.0 ? std::sqrt(covariance(row, row)) : prior_sigma;
      found.parameters.push_back(
          {name, words, off[k] / unit, sigma / unit, prior_sigma / unit, start[k] / unit});
      if (found.parameters.back().IsHeld()) continue;
      rows.push_back(row);
      to_units.push_back(1.0 / unit);
    }
    described.scanners.push_back(std::move(found));
  }
  const Eigen::Map<const Eigen::VectorXd> scale(to_units.data(),
                                                static_cast<Eigen::Index>(to_units.size()));
  described.covariance = scale.asDiagonal() * covariance(rows, rows) * scale.asDiagonal();
  // Unobservable parameters are as the rig file states.
  Eigen::Index at = 0;
  for (const CalibratedScanner& scanner : described.scanners) {
    for (const CalibratedParameter& parameter : scanner.parameters) {
      if (parameter.IsHeld()) continue;
      described.covariance(at, at) = parameter.sigma * parameter.sigma;
      ++at;
    }
  }
  return described;
}

void TakeCalibration(const Rig& rig,
                     const Calibration& described,
                     RigCalibration* calibration) {
  for (const CalibratedScanner& scanner : described.scanners) {
    const auto found = std::find_if(rig.scanners.begin(),
                                    rig.scanners.end(),
                                    [&](const Scanner& s) { return s.name == scanner.name; });
    const auto index = static_cast<size_t>(found - rig.scanners.begin());
    if (index >= calibration->scanners.size()) {
      throw Error("the rig file has no scanner " + scanner.name + " to be calibrated");
    }
    ScannerEstimate& estimate = calibration->scanners[index];
    for (const CalibratedParameter& parameter : scanner.parameters) {
      const ParameterName* named = FindParameter(parameter.name);
      if (named == nullptr) {
        throw Error("scanner " + scanner.name + " has no parameter " + parameter.name);
      }
      const auto k = static_cast<size_t>(named - kParameters.data());
      const double unit = named->unit;
      estimate.block[k] = parameter.value * unit;
      const auto row = static_cast<Eigen::Index>(k);
      estimate.covariance(row, row) = std::pow(parameter.sigma * unit, 2);
    }
  }
}

Rig CalibratedRig(const Rig& rig, const RigCalibration& calibration) {
  Rig calibrated = calibration.Calibrated(rig);
  for (size_t i = 0; i < calibration.scanners.size(); ++i) {
    const ScannerEstimate& scanner = calibration.scanners[i];
    ScannerUncertainty& uncertainty = calibrated.scanners[i].uncertainty;
    ScannerMatrix covariance = scanner.covariance;
    const ScannerBlock stated = StatedSigmas(calibrated.scanners[i]);
    if (scanner.is_body) {
      const double of_range = covariance(kScannerRangeAt, kScannerRangeAt);
      covariance.setZero();
      covariance(kScannerRangeAt, kScannerRangeAt) = of_range;
    } else {
      for (int k = 0; k < scanner.BlockSize(); ++k) {
        const auto index = static_cast<size_t>(k);
        if (scanner.prior_sigma[index] > 0.0) continue;
        covariance(k, k) = stated[index] * stated[index];
      }
    }
    uncertainty.rotation_rad = LargestSigma(covariance, kScannerTurnAt, 3);
    uncertainty.translation_m = LargestSigma(covariance, kScannerShiftAt, 3);
    uncertainty.time_s = LargestSigma(covariance, kScannerDelayAt, 1);
    uncertainty.range_m = LargestSigma(covariance, kScannerRangeAt, 1);
    uncertainty.range_scale = LargestSigma(covariance, kScannerScaleAt, 1);
    if (!scanner.is_mounted) continue;
    calibrated.scanners[i].mount->uncertainty = {LargestSigma(covariance, kMountZeroAt, 1),
                                                 LargestSigma(covariance, kMountDelayAt, 1),
                                                 LargestSigma(covariance, kMountRateAt, 1),
                                                 LargestSigma(covariance, kMountTiltAt, 2),
                                                 LargestSigma(covariance, kMountShiftAt, 2)};
  }
  return calibrated;
}

}  // namespace plumbline
