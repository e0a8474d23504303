#include "core/mapping/calibration_report.h"

#include <array>
#include <cmath>
#include <vector>

#include "core/geometry/angles.h"

namespace plumbline {
namespace {

struct ParameterName {
  const char* name;
  const char* words;
  double unit;  // in the block's
};
constexpr std::array<ParameterName, kScannerBlockSize> kParameters = {{
    {"roll_deg", "roll", kRadiansPerDegree},
    {"pitch_deg", "pitch", kRadiansPerDegree},
    {"yaw_deg", "yaw", kRadiansPerDegree},
    {"x_m", "position along x", 1.0},
    {"y_m", "position along y", 1.0},
    {"z_m", "height", 1.0},
    {"time_s", "clock", 1.0},
}};

double LargestSigma(const ScannerMatrix& covariance, int first, int count) {
  return std::sqrt(covariance.diagonal().segment(first, count).maxCoeff());
}

}  // namespace

Calibration DescribeCalibration(const Rig& rig,
                                const RigCalibration& calibration,
                                const Eigen::MatrixXd& covariance) {
  Calibration described;
  Eigen::VectorXd to_units(covariance.rows());
  Eigen::Index row = 0;
  for (size_t i = 0; i < calibration.scanners.size(); ++i) {
    const ScannerEstimate& scanner = calibration.scanners[i];
    if (!scanner.IsEstimated()) continue;
    CalibratedScanner found;
    found.name = rig.scanners[i].name;
    for (size_t k = 0; k < kParameters.size(); ++k, ++row) {
      const auto& [name, words, unit] = kParameters[k];
      to_units[row] = 1.0 / unit;
      // What is held is as uncertain as the rig file has it.
      const Scanner& stated = rig.scanners[i];
      const double prior_sigma = StatedSigmas(stated.uncertainty)[k];
      const double sigma =
          scanner.prior_sigma[k] > 0.0 ? std::sqrt(covariance(row, row)) : prior_sigma;
      found.parameters.push_back(
          {name, words, scanner.block[k] / unit, sigma / unit, prior_sigma / unit});
    }
    described.scanners.push_back(std::move(found));
  }
  described.covariance = to_units.asDiagonal() * covariance * to_units.asDiagonal();
  return described;
}

Rig CalibratedRig(const Rig& rig, const RigCalibration& calibration) {
  Rig calibrated = calibration.Calibrated(rig);
  for (size_t i = 0; i < calibration.scanners.size(); ++i) {
    const ScannerEstimate& scanner = calibration.scanners[i];
    ScannerUncertainty& uncertainty = calibrated.scanners[i].uncertainty;
    if (!scanner.IsEstimated()) {
      uncertainty = {};  // the body's frame and clock are its own
      continue;
    }
    ScannerMatrix covariance = scanner.covariance;
    const ScannerBlock stated = StatedSigmas(rig.scanners[i].uncertainty);
    for (int k = 0; k < kScannerBlockSize; ++k) {
      const auto index = static_cast<size_t>(k);
      if (scanner.prior_sigma[index] == 0.0) covariance(k, k) = stated[index] * stated[index];
    }
    uncertainty.rotation_rad = LargestSigma(covariance, kScannerTurnAt, 3);
    uncertainty.translation_m = LargestSigma(covariance, kScannerShiftAt, 3);
    uncertainty.time_s = LargestSigma(covariance, kScannerDelayAt, 1);
  }
  return calibrated;
}

}  // namespace plumbline
