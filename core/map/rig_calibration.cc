#include "core/map/rig_calibration.h"

#include <algorithm>
#include <utility>

#include "factors/spline/so3.h"

namespace plumbline {
namespace {

// Returns the prior standard deviations of what is estimated; 0: held.
ScannerBlock PriorSigmas(const ScannerUncertainty& uncertainty, bool planar) {
  ScannerBlock sigmas = StatedSigmas(uncertainty);
  if (planar) sigmas[0] = sigmas[1] = sigmas[5] = 0.0;  // roll, pitch, height
  return sigmas;
}

}  // namespace

ScannerBlock StatedSigmas(const ScannerUncertainty& uncertainty) {
  const double rotation = uncertainty.rotation_rad;
  const double translation = uncertainty.translation_m;
  return {rotation,
          rotation,
          rotation,
          translation,
          translation,
          translation,
          uncertainty.time_s,
          uncertainty.range_m,
          uncertainty.range_scale};
}

bool ScannerEstimate::IsEstimated() const {
  return std::any_of(
      prior_sigma.begin(), prior_sigma.end(), [](double sigma) { return sigma > 0.0; });
}

RigCalibration::RigCalibration(const Rig& rig, bool planar) {
  if (!EstimatesScanners(rig)) return;
  const size_t body = BodyScanner(rig);
  for (size_t i = 0; i < rig.scanners.size(); ++i) {
    const Scanner& scanner = rig.scanners[i];
    ScannerEstimate estimate;
    estimate.stated = scanner.body_from_scanner;
    estimate.is_body = i == body;
    if (estimate.is_body) {
      estimate.prior_sigma[kScannerRangeAt] = scanner.uncertainty.range_m;
    } else {
      estimate.prior_sigma = PriorSigmas(scanner.uncertainty, planar);
    }
    for (size_t k = 0; k < kScannerBlockSize; ++k) {
      const auto row = static_cast<Eigen::Index>(k);
      estimate.covariance(row, row) = estimate.prior_sigma[k] * estimate.prior_sigma[k];
    }
    scanners.push_back(estimate);
  }
}

void RigCalibration::ApplyTo(Rig* rig) const {
  for (size_t i = 0; i < scanners.size(); ++i) {
    const ScannerEstimate& scanner = scanners[i];
    const ScannerPose pose =
        PoseOfScanner({scanner.stated.rotation.toRotationMatrix(), scanner.stated.translation},
                      scanner.block.data());
    if (!scanner.IsEstimated()) continue;
    rig->scanners[i].body_from_scanner = {Eigen::Quaterniond(pose.rotation), pose.translation};
    rig->scanners[i].delay_s = scanner.block[kScannerDelayAt];
    rig->scanners[i].range_excess_m = scanner.block[kScannerRangeAt];
    rig->scanners[i].range_excess_share = scanner.block[kScannerScaleAt];
  }
}

Rig RigCalibration::Posed(Rig rig) const {
  ApplyTo(&rig);
  return rig;
}

Rig RigCalibration::Calibrated(Rig rig) const {
  ApplyTo(&rig);
  for (size_t i = 0; i < scanners.size(); ++i) {
    Scanner& scanner = rig.scanners[i];
    scanner.time_offset_s += std::exchange(scanner.delay_s, 0.0);
    scanner.range_bias_m += std::exchange(scanner.range_excess_m, 0.0) / scanner.range_scale;
    scanner.range_scale *= 1.0 - std::exchange(scanner.range_excess_share, 0.0);
  }
  return rig;
}

}  // namespace plumbline
