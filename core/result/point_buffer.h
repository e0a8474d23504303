#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace plumbline {

// The plane id of points on things that move.
inline constexpr int kMovingPlaneId = -2;

// MapPoint is one point of a map.
struct MapPoint {
  Eigen::Vector3f p_world;
  double time_s = 0.0;  // since the recording's first scan line
  int scanner = 0;
  int plane_id = -1;        // -1: on no plane
  float residual_m = 0.0f;  // signed distance to its plane; NaN where plane_id is negative
  // The unit normal of its plane there, towards the side that was seen; zero where plane_id is
  // negative.
  Eigen::Vector3f normal_world = Eigen::Vector3f::Zero();
};

// PointBuffer holds the bytes of points as they stand in map.ply:
//   float x, y, z; double time; uint8 scanner; int32 plane_id; float residual;
//   uint8 red, green, blue, alpha; float normal x, y, z
// The colour is that of the surface (surface_colour.h).
class PointBuffer {
 public:
  // Offset of the colour in a point's bytes, and their number.
  static constexpr size_t kColourOffset =
      3 * sizeof(float) + sizeof(double) + sizeof(uint8_t) + sizeof(int32_t) + sizeof(float);
  static constexpr size_t kPointBytes =
      kColourOffset + 4 * sizeof(uint8_t) + 3 * sizeof(float);

  void Add(const MapPoint& point);
  void Clear() { num_bytes_ = 0; }  // keeps the memory

  MapPoint At(int64_t index) const;

  const char* data() const { return bytes_.data(); }
  size_t num_bytes() const { return num_bytes_; }
  int64_t num_points() const { return static_cast<int64_t>(num_bytes_ / kPointBytes); }

 private:
  std::vector<char> bytes_;  // the first num_bytes_ are in use
  size_t num_bytes_ = 0;
  // Neighbours lie on the same plane, mostly.
  int colour_plane_id_ = -1;
  std::array<uint8_t, 4> colour_ = ColourBytes(-1);

  // Red, green, blue, alpha.
  static std::array<uint8_t, 4> ColourBytes(int plane_id);
};

}  // namespace plumbline
