#pragma once

#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include "core/atomic_file.h"
#include "core/result_writer.h"

namespace plumbline {

// Writes the same points as a binary PLY and as a binary PCD file, at a constant cost in
// memory: points go straight to the PLY file; the PCD file is PCL's header before the same
// bytes.
class PointCloudWriter {
 public:
  // Throws Error naming the file when it can not be created.
  PointCloudWriter(const std::string& ply_path, const std::string& pcd_path);
  ~PointCloudWriter();
  PointCloudWriter(const PointCloudWriter&) = delete;
  PointCloudWriter& operator=(const PointCloudWriter&) = delete;

  void Add(const MapPoint& point);
  // Completes both files under their temporary names. Call once, after the last point.
  void Finish();
  // Gives both files their names.
  void Commit();

 private:
  void Flush();
  void WriteToPly(const void* data, size_t size);
  void CopyToPcd();
  [[noreturn]] void Fail(const AtomicFile& file) const;

  AtomicFile ply_;
  AtomicFile pcd_;
  std::FILE* stream_ = nullptr;  // of ply_
  std::vector<char> buffer_;     // packed points not yet in stream_
  int64_t num_points_ = 0;
};

}  // namespace plumbline
