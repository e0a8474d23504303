#pragma once

#include "core/options/mapper_options.h"
#include "core/sensor/odometry.h"
#include "factors/cost/odometry_factor.h"

namespace plumbline {

// OdometryCalibration relates the motion stated by wheels to that of the rig: by a scale of
// lengths and one of turns (the wheels' radius and distance are not quite what the robot
// believes), and by the noise that is left. It is estimated from motions that the scans have
// determined: of the scales by robust regression, the noise by the mean square of what is
// left, both with the options' values as what is known beforehand.
//
// The standard deviations of one motion, about a knot interval long, are
//   translation   length_noise (|translation| + 2 cm)
//   turn          turn_noise (|turn| + 0.1 rad/m |translation| + 0.5 deg)
// since slipping wheels and stamps that are not quite right both show in proportion to the
// motion; the small constants stand for the samples' rounding.
class OdometryCalibration {
 public:
  OdometryCalibration() = default;
  explicit OdometryCalibration(const OdometryOptions& options);

  // Takes in a motion as the wheels state it and as it is estimated.
  void Add(const PlanarMotion& stated, const PlanarMotion& estimated);

  double length_scale() const { return length_.Scale(); }  // true over stated length
  double turn_scale() const { return turn_.Scale(); }      // true over stated turn
  // Standard deviations of the scales, as far as the motions' noise is independent, and where
  // the scans, not the wheels themselves, have determined the motions.
  double length_scale_stddev() const { return length_.ScaleStddev(); }
  double turn_scale_stddev() const { return turn_.ScaleStddev(); }
  double length_noise() const { return length_.Noise(); }  // shares, see above
  double turn_noise() const { return turn_.Noise(); }
  int num_motions() const { return num_motions_; }  // that it has taken in

  // Returns the calibrated measurement of a motion that the wheels state.
  OdometryMeasurement Measure(const PlanarMotion& stated) const;

  // Calls visit(member) for each: to keep them in a file and take them back.
  template <typename Visit>
  void VisitMembers(Visit& visit) {
    for (Ratio* ratio : {&length_, &turn_}) {
      visit(ratio->stated_estimated);
      visit(ratio->stated2);
      visit(ratio->squares);
      visit(ratio->weight);
    }
    visit(num_motions_);
  }

 private:
  // Sums for the scale of one quantity and for its noise.
  struct Ratio {
    double stated_estimated = 1.0;
    double stated2 = 1.0;
    double squares = 1.0;  // of residuals over what they are proportional to
    double weight = 1.0;

    double Scale() const { return stated_estimated / stated2; }
    double ScaleStddev() const;
    double Noise() const;
    void Add(double stated, double estimated, double amount);
    void AddResidual(double residual, double amount);
  };

  static double LengthAmount(const PlanarMotion& stated);
  static double TurnAmount(const PlanarMotion& stated);

  Ratio length_;
  Ratio turn_;
  int num_motions_ = 0;
};

}  // namespace plumbline
