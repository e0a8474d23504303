#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

namespace plumbline {

// Pose of the body by wheels at an instant, in a frame of their own that drifts: seen from
// above, x ahead and y to the left of where they began to count.
struct OdometrySample {
  int64_t time_ns = 0;
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  // m
  double heading = 0.0;                                // rad
};

// A motion in the plane, seen from the pose where it begins.
struct PlanarMotion {
  Eigen::Vector2d translation = Eigen::Vector2d::Zero();  // m
  double turn = 0.0;                                      // rad
};

// Odometry holds the motion of a recording as wheels state it.
class Odometry {
 public:
  Odometry() = default;
  // Takes the samples in any order; of several of one instant it keeps the first one. Samples
  // whose numbers are not finite are left out. Headings may jump by whole turns.
  explicit Odometry(std::vector<OdometrySample> samples);

  // Returns the odometry with its samples later by this time.
  Odometry Later(double seconds) const;

  bool empty() const { return samples_.empty(); }
  size_t size() const { return samples_.size(); }
  // Whether it says how the body moved from one instant to a later one: there are samples
  // before and after, and none of the gaps between them is longer than kMaxGap.
  bool Covers(int64_t begin_ns, int64_t end_ns) const;
  // The motion between two instants, between samples at an even pace; nothing where it is not
  // covered.
  std::optional<PlanarMotion> Between(int64_t begin_ns, int64_t end_ns) const;
  // The instant of the first sample that is not before this one, and that of the last sample
  // before it.
  std::optional<int64_t> SampleFrom(int64_t time_ns) const;
  std::optional<int64_t> SampleBefore(int64_t time_ns) const;

  // Wheels that say nothing for longer may have been moved by something else.
  static constexpr double kMaxGap = 5.0;  // s

 private:
  OdometrySample At(int64_t time_ns) const;
  // The first sample at or after an instant.
  size_t FirstFrom(int64_t time_ns) const;

  std::vector<OdometrySample> samples_;  // by time
  std::vector<size_t> gap_ends_;         // samples that follow a gap that is too long
};

}  // namespace plumbline
