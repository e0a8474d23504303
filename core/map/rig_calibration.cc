#include "core/map/rig_calibration.h"

#include <algorithm>
#include <utility>

#include "factors/spline/so3.h"

namespace plumbline {
namespace {

// Returns the prior standard deviations of what is estimated; 0: held.
ScannerBlock PriorSigmas(const Scanner& scanner, bool planar) {
  ScannerBlock sigmas = StatedSigmas(scanner);
  if (planar) sigmas[0] = sigmas[1] = sigmas[5] = 0.0;  // roll, pitch, height
  if (scanner.mount && planar) sigmas[kMountTiltAt] = sigmas[kMountTiltAt + 1] = 0.0;
  return sigmas;
}

}  // namespace

ScannerBlock StatedSigmas(const Scanner& scanner) {
  const ScannerUncertainty& uncertainty = scanner.uncertainty;
  const double rotation = uncertainty.rotation_rad;
  const double translation = uncertainty.translation_m;
  ScannerBlock sigmas = {rotation,
                         rotation,
                         rotation,
                         translation,
                         translation,
                         translation,
                         uncertainty.time_s,
                         uncertainty.range_m,
                         uncertainty.range_scale};
  if (!scanner.mount) return sigmas;
  const MountUncertainty& mount = scanner.mount->uncertainty;
  Eigen::Index along_axis = 0;
  scanner.mount->axis.cwiseAbs().maxCoeff(&along_axis);
  sigmas[kScannerTurnAt + static_cast<size_t>(along_axis)] = 0.0;
  sigmas[kMountZeroAt] = mount.zero_rad;
  sigmas[kMountDelayAt] = mount.time_s;
  sigmas[kMountRateAt] = mount.rate;
  sigmas[kMountTiltAt] = sigmas[kMountTiltAt + 1] = mount.axis_rad;
  sigmas[kMountShiftAt] = sigmas[kMountShiftAt + 1] = mount.point_m;
  return sigmas;
}

MountPose PoseOf(const Mount& mount) { return {mount.axis, mount.point, mount.zero_rad}; }

MountMotion MotionOf(const Mount& mount, int64_t time_ns, double later_s) {
  later_s += mount.Earlier(time_ns);
  const MountAngle angle = mount.StatedAt(time_ns, later_s);
  return {angle.angle_rad,
          angle.rate_rad_s,
          angle.acceleration_rad_s2,
          mount.SinceStart(time_ns),
          later_s};
}

bool ScannerEstimate::IsEstimated() const {
  return std::any_of(
      prior_sigma.begin(), prior_sigma.end(), [](double sigma) { return sigma > 0.0; });
}

void ScannerEstimate::SetCovariance(const Eigen::MatrixXd& joint, Eigen::Index row) {
  const int size = BlockSize();
  covariance.topLeftCorner(size, size) = joint.block(row, row, size, size);
}

RigCalibration::RigCalibration(const Rig& rig, bool planar) {
  if (!EstimatesScanners(rig)) return;
  const size_t body = BodyScanner(rig);
  for (size_t i = 0; i < rig.scanners.size(); ++i) {
    const Scanner& scanner = rig.scanners[i];
    ScannerEstimate estimate;
    estimate.stated = scanner.body_from_scanner;
    estimate.is_body = i == body;
    estimate.is_mounted = scanner.mount.has_value();
    if (scanner.mount) estimate.stated_mount = PoseOf(*scanner.mount);
    estimate.prior_sigma = PriorSigmas(scanner, planar);
    if (estimate.is_body) {
      // Where all scanners move, the zero of the first one's mount is the body's attitude.
      std::fill_n(estimate.prior_sigma.begin(), kScannerRangeAt, 0.0);
      estimate.prior_sigma[kScannerScaleAt] = estimate.prior_sigma[kMountZeroAt] = 0.0;
    }
    for (size_t k = 0; k < kMountedBlockSize; ++k) {
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
    if (!scanner.is_mounted) continue;
    Mount& mount = *rig->scanners[i].mount;
    const MountPose on_mount = PoseOfMount(scanner.stated_mount, scanner.block.data());
    mount.axis = on_mount.axis;
    mount.point = on_mount.point;
    mount.zero_rad = on_mount.zero_rad;
    mount.delay_s = scanner.block[kMountDelayAt];
    mount.rate_excess = scanner.block[kMountRateAt];
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
    if (!scanner.mount) continue;
    Mount& mount = *scanner.mount;
    mount.time_offset_s += std::exchange(mount.delay_s, 0.0);
    const double faster = 1.0 + std::exchange(mount.rate_excess, 0.0);
    mount.rate_rad_s *= faster;
    if (mount.swing) mount.swing->period_s /= faster;
  }
  return rig;
}

}  // namespace plumbline
