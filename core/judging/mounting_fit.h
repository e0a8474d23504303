#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/judging/view_comparison.h"

namespace plumbline {

// The correction of one scanner that brings what it sees best onto what the others see. What
// the scans leave open is zero.
struct MountingCorrection {
  int num_compared = 0;
  Eigen::Vector3d rotation_rad = Eigen::Vector3d::Zero();  // about the body's axes
  Eigen::Vector3d translation_m = Eigen::Vector3d::Zero();
  double time_offset_s = 0.0;   // to be added to its stamps
  double range_offset_m = 0.0;  // to be added to its ranges
  // Standard deviations of these eight, in this order; cautious, since neighbouring lines
  // share their errors.
  Eigen::Matrix<double, 8, 1> stddev = Eigen::Matrix<double, 8, 1>::Zero();
  double near_share = 0.0;   // of the places, within 1.5 cm, as the rig file says
  double moved_share = 0.0;  // after the correction
  MountedScanner corrected;
};

// Fits the correction of one scanner, as if the others were right.
MountingCorrection FitMounting(const std::vector<std::vector<SampledLine>>& sample,
                               const MountedRig& rig,
                               size_t scanner);

// Brings all scanners but the one that is held near to where they agree, by corrections of one
// after the other, in turns. planar: tilts and heights, which level scanners do not show, are
// held as well.
MountedRig FitInTurns(const std::vector<std::vector<SampledLine>>& sample,
                      const MountedRig& rig,
                      size_t held,
                      bool planar);

// One element for each scanner, each as if the others were right.
std::vector<MountingCorrection> FitMountings(
    const std::vector<std::vector<SampledLine>>& sample, const MountedRig& rig);

}  // namespace plumbline
