#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "core/result/point_buffer.h"
#include "core/util/atomic_file.h"
#include "core/util/large_file.h"

namespace plumbline {

// Writes the same points as a binary PLY and as a binary PCD file, at a constant cost in
// memory: both hold the same bytes after their headers, that of the PCD file by PCL.
class PointCloudWriter {
 public:
  // Throws Error naming the file when it can not be created.
  PointCloudWriter(const std::string& ply_path, const std::string& pcd_path);

  void Add(const PointBuffer& points);
  // Completes both files under their temporary names. Call once, after the last point.
  void Finish();
  // Gives both files their names.
  void Commit();

 private:
  class File {
   public:
    explicit File(const std::string& path);

    void Append(const std::string& text) { Append(text.data(), text.size()); }
    void Append(const void* data, size_t size) { stream_.Append(data, size); }
    void Finish(const std::string& beginning) { stream_.Finish(beginning); }
    void Commit() { file_.Commit(); }

   private:
    AtomicFile file_;
    LargeFile stream_;
  };

  File ply_;
  File pcd_;
  int64_t num_points_ = 0;
  bool finished_ = false;
};

}  // namespace plumbline
