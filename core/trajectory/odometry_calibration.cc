#include "core/trajectory/odometry_calibration.h"

#include <algorithm>
#include <cmath>

#include "core/util/quantiles.h"

namespace plumbline {
namespace {

// Way and turn that wheels tell from none: less does not show scale and noise.
constexpr double kSmallLength = 0.02;              // m
constexpr double kSmallTurn = 0.5 * M_PI / 180.0;  // rad
constexpr double kTurnPerLength = 0.1;             // rad/m
// Prior standard deviation of the scales.
constexpr double kScaleStddev = 0.05;
// Number of motions as which the options' noise counts.
constexpr double kPriorMotions = 30.0;
// The estimate is held by the wheels, too: it can not tell that they have next to no noise.
constexpr double kMinNoise = 0.02;

}  // namespace

OdometryCalibration::OdometryCalibration(const OdometryOptions& options) {
  const auto begin = [](double noise) {
    Ratio ratio;
    // A regression that knows the scale 1 to kScaleStddev, in units of its noise.
    ratio.stated2 = 1.0 / (kScaleStddev * kScaleStddev);
    ratio.stated_estimated = ratio.stated2;
    ratio.weight = kPriorMotions;
    ratio.squares = kPriorMotions * noise * noise;
    return ratio;
  };
  length_ = begin(options.length_noise);
  turn_ = begin(options.turn_noise);
}

double OdometryCalibration::Ratio::ScaleStddev() const { return 1.0 / std::sqrt(stated2); }

double OdometryCalibration::Ratio::Noise() const {
  return std::max(kMinNoise, std::sqrt(squares / weight));
}

void OdometryCalibration::Ratio::Add(double stated, double estimated, double amount) {
  const double stddev = Noise() * amount;
  const double deviation = std::abs(estimated - Scale() * stated) / stddev;
  // Beyond that, a residual is of wheels that slip, or of wrong poses.
  const double robust = std::min(1.0, kSignificantStddevs / std::max(deviation, 1e-9));
  stated_estimated += robust * stated * estimated / (stddev * stddev);
  stated2 += robust * stated * stated / (stddev * stddev);
}

void OdometryCalibration::Ratio::AddResidual(double residual, double amount) {
  // Clipped at one and a half of its own standard deviations: a third of the residuals may be
  // slips, or poses that are wrong, before they carry it away. Of a normal variable the share
  // `left` of the variance remains.
  const double clip = 0.5 * kSignificantStddevs;
  const double left = std::erf(clip / std::sqrt(2.0)) +
                      clip * clip * std::erfc(clip / std::sqrt(2.0)) -
                      clip * std::sqrt(2.0 / M_PI) * std::exp(-0.5 * clip * clip);
  const double share = std::min(std::abs(residual) / amount, clip * Noise());
  squares += share * share / left;
  weight += 1.0;
}

double OdometryCalibration::LengthAmount(const PlanarMotion& stated) {
  return stated.translation.norm() + kSmallLength;
}

double OdometryCalibration::TurnAmount(const PlanarMotion& stated) {
  return std::abs(stated.turn) + kTurnPerLength * stated.translation.norm() + kSmallTurn;
}

void OdometryCalibration::Add(const PlanarMotion& stated, const PlanarMotion& estimated) {
  const double length = stated.translation.norm();
  if (length < kSmallLength && std::abs(stated.turn) < kSmallTurn) return;
  ++num_motions_;
  if (length >= kSmallLength) {
    const double along = estimated.translation.dot(stated.translation) / length;
    const double amount = LengthAmount(stated);
    length_.Add(length, along, amount);
    for (int axis = 0; axis < 2; ++axis) {
      length_.AddResidual(
          estimated.translation[axis] - length_scale() * stated.translation[axis], amount);
    }
  }
  const double amount = TurnAmount(stated);
  if (std::abs(stated.turn) >= kSmallTurn) turn_.Add(stated.turn, estimated.turn, amount);
  turn_.AddResidual(estimated.turn - turn_scale() * stated.turn, amount);
}

OdometryMeasurement OdometryCalibration::Measure(const PlanarMotion& stated) const {
  OdometryMeasurement measurement;
  measurement.translation = length_scale() * stated.translation;
  measurement.turn = turn_scale() * stated.turn;
  measurement.translation_stddev = length_noise() * LengthAmount(stated);
  measurement.turn_stddev = turn_noise() * TurnAmount(stated);
  return measurement;
}

}  // namespace plumbline
