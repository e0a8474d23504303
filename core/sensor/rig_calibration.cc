#include "core/sensor/rig_calibration.h"

#include <algorithm>
#include <utility>

#include "factors/spline/so3.h"

namespace plumbline {
namespace {

bool IsExact(const Scanner& scanner) {
  const ScannerUncertainty& uncertainty = scanner.uncertainty;
  return uncertainty.rotation_rad == 0.0 && uncertainty.translation_m == 0.0 &&
         uncertainty.time_s == 0.0;
}

// Of what is estimated.
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
          uncertainty.range_m};
}

bool ScannerEstimate::IsEstimated() const {
  return std::any_of(
      prior_sigma.begin(), prior_sigma.end(), [](double sigma) { return sigma > 0.0; });
}

RigCalibration::RigCalibration(const Rig& rig, bool planar) {
  const auto exact = std::find_if(rig.scanners.begin(), rig.scanners.end(), IsExact);
  const auto body = exact == rig.scanners.end() ? rig.scanners.begin() : exact;
  for (auto scanner = rig.scanners.begin(); scanner != rig.scanners.end(); ++scanner) {
    ScannerEstimate estimate;
    estimate.stated = scanner->body_from_scanner;
    if (scanner == body) {
      estimate.is_body = true;
      estimate.prior_sigma[kScannerRangeAt] = scanner->uncertainty.range_m;
    } else {
      estimate.prior_sigma = PriorSigmas(scanner->uncertainty, planar);
    }
    for (int i = 0; i < kScannerBlockSize; ++i) {
      const double sigma = estimate.prior_sigma[static_cast<size_t>(i)];
      estimate.covariance(i, i) = sigma * sigma;
    }
    scanners.push_back(estimate);
  }
  const bool any = std::any_of(
      scanners.begin(), scanners.end(), [](const auto& s) { return s.IsEstimated(); });
  if (!any) scanners.clear();
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
  }
}

Rig RigCalibration::Posed(Rig rig) const {
  ApplyTo(&rig);
  return rig;
}

Rig RigCalibration::Calibrated(Rig rig) const {
  ApplyTo(&rig);
  for (size_t i = 0; i < scanners.size(); ++i) {
    rig.scanners[i].time_offset_s += std::exchange(rig.scanners[i].delay_s, 0.0);
    rig.scanners[i].range_bias_m += std::exchange(rig.scanners[i].range_excess_m, 0.0);
  }
  return rig;
}

}  // namespace plumbline
