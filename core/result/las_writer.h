#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>

#include "core/result/point_cloud_writer.h"
#include "core/util/large_file.h"

namespace plumbline {

enum class LasVersion { k12, k14 };

// Writes points as a LAS file (ASPRS): version 1.2 with point format 3, or 1.4 with point
// format 7 and the extra bytes scanner, plane_id and residual. Coordinates are multiples of
// 0.1 mm. GPS time is seconds since the recording's first scan line. Points on surfaces have
// the class "building", the others are unclassified.
//
// LAS 1.2 has no fields for the scanner and the surface: they stand as user data, and as point
// source ID, which is plane_id + 1, or 0 on no surface.
class LasWriter : public PointCloudWriter {
 public:
  LasWriter(LasVersion version, const std::string& path, const std::string& name);
  // Throws Error, too, where a coordinate is beyond 214 km, and in version 1.2 where there are
  // more than 65534 surfaces or 2^32 - 1 points.
  void Add(const PointBuffer& points) override;
  void Finish() override;

 private:
  using Vector3i = Eigen::Matrix<int32_t, 3, 1>;

  // The header block with the records that describe the points, as long for every number.
  std::string Header() const;
  void AppendPoint(const MapPoint& point);

  LasVersion version_;
  std::string name_;
  LargeFile file_;
  std::string records_;  // of the points that are being added
  uint64_t num_points_ = 0;
  Vector3i min_ = Vector3i::Zero();
  Vector3i max_ = Vector3i::Zero();
};

}  // namespace plumbline
