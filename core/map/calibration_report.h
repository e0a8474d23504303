#pragma once

#include <Eigen/Core>
#include <string>

#include "core/map/rig_calibration.h"
#include "core/result/result_types.h"
#include "core/sensor/rig.h"

namespace plumbline {

// Returns a parameter of calibration.json in words; empty where there is none of that name.
std::string ParameterInWords(const std::string& name);

// Returns what has been found of the scanners, as users are told: what they are off the rig
// file by (stated). rig: that the estimates are about. covariance: of the estimated scanners'
// blocks together (MapCovariance::scanners()). Empty where none is estimated.
Calibration DescribeCalibration(const Rig& stated,
                                const Rig& rig,
                                const RigCalibration& calibration,
                                const Eigen::MatrixXd& covariance);

// Sets the estimates to what a description says of them (the reverse of DescribeCalibration).
// Throws Error where it is about scanners or parameters that are not estimated.
void TakeCalibration(const Rig& rig,
                     const Calibration& described,
                     RigCalibration* calibration);

// Returns the rig file's rig with poses and clocks as they are estimated, and what is still
// uncertain of them: for each kind the largest standard deviation of its directions.
Rig CalibratedRig(const Rig& rig, const RigCalibration& calibration);

}  // namespace plumbline
