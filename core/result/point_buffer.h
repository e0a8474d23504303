#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace plumbline {

// The plane id of points on things that move.
inline constexpr int kMovingPlaneId = -2;

// MapPoint is one point of map.ply and map.pcd.
struct MapPoint {
  Eigen::Vector3f p_world;
  double time_s = 0.0;  // since the recording's first scan line
  int scanner = 0;
  int plane_id = -1;        // -1: on no plane
  float residual_m = 0.0f;  // signed distance to its plane; NaN where plane_id is negative
};

// PointBuffer holds the bytes of points as they stand in map.ply and map.pcd:
//   float x, y, z; double time; uint8 scanner; int32 plane_id; float residual
class PointBuffer {
 public:
  static constexpr size_t kPointBytes =
      3 * sizeof(float) + sizeof(double) + sizeof(uint8_t) + sizeof(int32_t) + sizeof(float);

  void Add(const MapPoint& point);
  void Clear() { num_bytes_ = 0; }  // keeps the memory

  const char* data() const { return bytes_.data(); }
  size_t num_bytes() const { return num_bytes_; }
  int64_t num_points() const { return static_cast<int64_t>(num_bytes_ / kPointBytes); }

 private:
  std::vector<char> bytes_;  // the first num_bytes_ are in use
  size_t num_bytes_ = 0;
};

}  // namespace plumbline
