#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/sensor/rig.h"
#include "core/sensor/scan_line.h"
#include "core/sensor/scanner_motion.h"

namespace plumbline {

// A run of consecutive beams of one scan line that lie on one straight line: the trace of a
// plane in the scan plane. Line and end points refer to the scanner frame at the middle of the
// scan line, with the predicted motion taken out (ScannerMotion).
struct Segment {
  int first_beam = 0;
  int last_beam = 0;                // inclusive
  std::vector<int> excluded_beams;  // inside [first_beam, last_beam]: outliers and no returns
  int num_points = 0;               // beams that count
  Eigen::Vector2d normal = Eigen::Vector2d::UnitX();  // of the line, pointing to the scanner
  double distance = 0.0;  // normal . p = distance, negative for this orientation
  Eigen::Vector2d start = Eigen::Vector2d::Zero();  // first and last beam, moved onto the line
  Eigen::Vector2d end = Eigen::Vector2d::Zero();
  Eigen::Vector2d centroid = Eigen::Vector2d::Zero();  // weighted by information
  double spread_m = 0.0;        // weighted rms of the points along the line, about centroid
  double sigma_offset_m = 0.0;  // of the line along its normal, at the centroid
  double sigma_direction_rad = 0.0;  // of the line's direction
  double chi2 = 0.0;  // sum of squared whitened residuals, num_points - 2 degrees

  double length_m() const { return (end - start).norm(); }
};

struct SegmentationOptions {
  int min_points = 5;             // of a segment
  double significance = 1e-4;     // false alarm rate of the tests on runs of residuals
  double ambiguity_sigmas = 3.0;  // beams at a segment's end are left out while the two
                                  // adjacent lines differ by less than this many range sigmas
};

// Splits a scan line into straight segments, ordered by beam (paper, section 4.3): grows lines
// greedily with a sequential test on runs of residuals, then optimises the end points between
// adjacent segments and leaves out the beams that can not be told apart there.
std::vector<Segment> SegmentScanLine(const ScanLine& scan_line,
                                     const Scanner& scanner,
                                     const ScannerMotion& motion,
                                     const SegmentationOptions& options);

}  // namespace plumbline
