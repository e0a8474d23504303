#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/result/point_buffer.h"

namespace plumbline {

// Statistics of all points of a map, for the report's plots.
class PointStatistics {
 public:
  // Width (m) of the bins of the histogram of residuals, and their number on either side of
  // zero; residuals beyond count in the outermost ones.
  static constexpr double kBinWidth = 0.001;
  static constexpr int kBinsPerSide = 250;

  struct Group {
    int64_t points = 0;
    int64_t on_planes = 0;
    double sum_squares_m2 = 0.0;  // of the residuals of points on planes
  };

  // Keeps a group for each second up to the point's: its time must be a recording's.
  void Add(const MapPoint& point);

  const std::array<int64_t, 2 * kBinsPerSide>& histogram() const { return histogram_; }
  const std::vector<Group>& by_scanner() const { return by_scanner_; }
  // Statistics by whole seconds since the recording's first scan line.
  const std::vector<Group>& by_second() const { return by_second_; }

 private:
  std::array<int64_t, 2 * kBinsPerSide> histogram_ = {};
  std::vector<Group> by_scanner_;
  std::vector<Group> by_second_;
};

}  // namespace plumbline
