#pragma once

#include <cstdint>
#include <string>

#include "core/result/point_cloud_writer.h"
#include "core/util/large_file.h"

namespace plumbline {

// Writes points as a binary PCD file: a header, which PCL makes, and the bytes of PointBuffer
// with red and blue exchanged.
class PcdWriter : public PointCloudWriter {
 public:
  PcdWriter(const std::string& path, const std::string& name);
  void Add(const PointBuffer& points) override;
  void Finish() override;

 private:
  LargeFile file_;
  std::string records_;  // of the points that are being added
  int64_t num_points_ = 0;
};

}  // namespace plumbline
