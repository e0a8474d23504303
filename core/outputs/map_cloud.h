#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/result/result_types.h"
#include "core/sensor/rig.h"

namespace plumbline {

// CloudPoint is one point of map.ply, as far as a floor plan needs it.
struct CloudPoint {
  Eigen::Vector3f p_world = Eigen::Vector3f::Zero();
  float residual_m = 0.0f;  // NaN where plane_id is negative
  double time_s = 0.0;      // since the recording's first scan line
  int32_t plane_id = -1;
  uint8_t scanner = 0;
};

// Reads the points of a map.ply (docs/outputs.md). Throws Error where the file can not be
// read, is cut short, or is not that of a map.
std::vector<CloudPoint> ReadMapCloud(const std::string& path);

// BeamOrigins says where a scanner was when it took a point.
class BeamOrigins {
 public:
  // start_ns: the instant from which the points' times count. poses: in the order of time.
  BeamOrigins(const Rig& rig, std::vector<StampedPose> poses, int64_t start_ns);

  // The scanner's position in the model frame, m, of one on a mount that at angle 0; none
  // where there is no pose within 0.2 s, or no such scanner. Between poses it is interpolated:
  // the points' own spline is not part of a result.
  std::optional<Eigen::Vector3d> At(size_t scanner, double time_s) const;

 private:
  std::vector<Rigid3d> body_from_scanner_;
  std::vector<StampedPose> poses_;
  int64_t start_ns_;
};

}  // namespace plumbline
