#pragma once

#include <cstdint>
#include <string>

#include "core/result/point_cloud_writer.h"
#include "core/util/large_file.h"

namespace plumbline {

// Writes points as a binary little-endian PLY file: the bytes of PointBuffer after a header.
class PlyWriter : public PointCloudWriter {
 public:
  PlyWriter(const std::string& path, const std::string& name);
  void Add(const PointBuffer& points) override;
  void Finish() override;

 private:
  LargeFile file_;
  int64_t num_points_ = 0;
};

}  // namespace plumbline
