#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/outputs/data_section.h"
#include "core/result/point_buffer.h"

namespace plumbline {

// Points in 16 bits a field, in the order of the map. The page shows
//   p_world = origin + step_m * (x, y, z)     time = time_step_s * time
// A residual has no field: the page computes it from p_world and its plane.
class QuantisedPoints {
 public:
  static constexpr uint16_t kOnNoPlane = 0;
  static constexpr uint16_t kMoving = 1;
  static constexpr uint16_t kFirstPlane = 2;  // of the plane at index 0

  // Finer steps than this show nothing that scanners measure.
  static constexpr double kFinestStep = 0.0005;  // m
  static constexpr double kFinestTime = 0.001;   // s

  QuantisedPoints() = default;
  // plane_fields: kOnNoPlane, kMoving or kFirstPlane + index, of each point.
  QuantisedPoints(const std::vector<MapPoint>& points,
                  const std::vector<uint16_t>& plane_fields);

  int64_t size() const { return static_cast<int64_t>(scanner_.size()); }

  // Returns what the reader of the sections needs, as JSON: count, origin, step_m,
  // time_step_s.
  std::string HeaderJson() const;

  // Returns an even selection of `count` points; all, where there are fewer.
  QuantisedPoints Selection(int64_t count) const;

  // Makes a section of each byte of each field, named points-<field>-<byte>; differences from
  // point to point, those that may be negative as 0, -1, 1, -2, ...
  std::vector<DataSection> Sections() const;

 private:
  enum Field { kX, kY, kZ, kTime, kPlane, kNumFields };

  Eigen::Vector3d origin_ = Eigen::Vector3d::Zero();
  double step_m_ = kFinestStep;
  double time_step_s_ = kFinestTime;
  std::array<std::vector<uint16_t>, kNumFields> fields_;
  std::vector<uint8_t> scanner_;
};

}  // namespace plumbline
