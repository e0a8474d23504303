#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "core/segmentation/beam_model.h"

namespace plumbline {

// Grows one line over the beams of a scan line as long as they agree with it. The line's
// points are numbered in the order in which they were taken up; running sums over them make
// every test of a run of points cost the same, however long the run.
class LineGrower {
 public:
  struct Thresholds {
    int min_points = 0;  // of a line; passed over are fewer beams in a row
    double run = 0.0;    // of the statistic of a run of points, chi square with 2 degrees
    double seed = 0.0;   // of the chi square of the first min_points points
  };

  LineGrower(const BeamModel& model, const Thresholds& thresholds);

  // Starts a line with the first min_points returns from beam `first` on. False when they do
  // not lie on one line.
  bool Seed(int first);

  // Takes up the beams from `begin` to before `end`, step 1 or -1, until min_points in a row
  // are not on the line or a run of points proves that the line has ended; the points after
  // the change are then given back, but not the first num_kept.
  void Grow(int begin, int end, int step, int num_kept);

  // Starts without points, and takes up the beams first .. last that are on the line q as they
  // are.
  void Clear();
  void TakeUpAll(int first, int last, const Eigen::Vector2d& q);

  // Looks for a run of points, begin to before end, that do not fit the others, be they before
  // it, after it or on both sides: a pillar or door leaf that stands out by no more than the
  // noise. A growing line sees only what came before and may have followed such a run.
  bool FindForeignRun(int* begin, int* end) const;

  // Keeps the first `num_points` points.
  void Truncate(int num_points);

  int num_points() const { return static_cast<int>(num_points_); }
  int PointBeam(int point) const { return point_beams_[static_cast<size_t>(point)]; }
  Eigen::Vector2d q() const { return line_.q(); }
  const LineEquations& equations() const { return sums_[num_points_]; }

 private:
  void TakeUp(int beam, const BeamModel::LineIntersection& at);
  bool EndAtChange(size_t num_kept);
  double SplitChi2(size_t begin, size_t end) const;

  const BeamModel& beams_;
  const Thresholds thresholds_;
  ScaledLine line_;
  std::vector<int> seed_beams_;
  size_t num_points_ = 0;
  // As long as there are beams. What follows the points is of no account.
  std::unique_ptr<int[]> point_beams_;
  std::unique_ptr<LineEquations[]> sums_;  // [k]: of the first k points
  std::unique_ptr<double[]> chi2_;         // [k]: of the first k points
};

}  // namespace plumbline
