#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/geometry/rigid3.h"
#include "core/judging/levels.h"
#include "core/judging/sampled_line.h"
#include "core/sensor/rig.h"

namespace plumbline {

// MountedScanner is a scanner as the rig file states it, or as it is tried otherwise.
struct MountedScanner {
  size_t source = 0;  // position of its lines in the sample
  Rigid3d body_from_scanner;
  bool mirrored = false;        // its beams come the other way round
  double scale = 1.0;           // by which its ranges have to be multiplied
  double time_offset_s = 0.0;   // added to its stamps
  double range_offset_m = 0.0;  // added to its ranges
};
using MountedRig = std::vector<MountedScanner>;

// The rig file's own. sources: by scanner.
MountedRig AsRigFileSays(const Rig& rig, const std::vector<size_t>& sources);

// ViewComparison is a place that two scanners see at about the same time: where the scan
// planes of both cross, both measure the very same point of a surface. Body frame.
struct ViewComparison {
  double distance_m = 0.0;  // normal . (p_a - p_b), both at the instant of a
  Eigen::Vector3d p_a = Eigen::Vector3d::Zero();
  Eigen::Vector3d p_b = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitX();  // of the surface
  double rate_m_s = 0.0;                              // of normal . p, as time goes on
};

// Compares what scanners a and b of a rig see, at up to max_lines lines of a. Where the scan
// planes are parallel, every beam is compared with the other's view in its direction, as of
// upright walls. Lines of a and b that both see the same to min_motion_m as those compared
// before are passed over: a rig that stands shows one place, with one error, however often it
// is measured.
std::vector<ViewComparison> CompareViews(const std::vector<std::vector<SampledLine>>& sample,
                                         const MountedRig& rig,
                                         size_t a,
                                         size_t b,
                                         int max_lines,
                                         double min_motion_m = 0.0);

// The median of the distances' sizes, m; 0 without any.
double MedianDistance(const std::vector<ViewComparison>& comparisons);

// The share of the places whose distance is smaller than this; 0 without any.
double ShareWithin(const std::vector<ViewComparison>& comparisons, double distance_m);

}  // namespace plumbline
