#pragma once

#include <cstdint>
#include <string>

#include "core/result/point_buffer.h"
#include "core/util/large_file.h"

namespace plumbline {

// Writes the same points as a binary PLY and as a binary PCD file, at a constant cost in
// memory: both hold the same bytes after their headers, that of the PCD file by PCL.
class PointCloudWriter {
 public:
  // Creates map.ply and map.pcd in the directory; errors name these files in final_name. Throws
  // Error when a file can not be created.
  PointCloudWriter(const std::string& directory, const std::string& final_name);

  void Add(const PointBuffer& points);
  // Completes both files. Call once, after the last point.
  void Finish();

 private:
  LargeFile ply_;
  LargeFile pcd_;
  int64_t num_points_ = 0;
  bool finished_ = false;
};

}  // namespace plumbline
