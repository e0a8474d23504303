#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include "core/atomic_file.h"
#include "core/result_writer.h"

namespace plumbline {

// Writes the same points as a binary PLY and as a binary PCD file, at a constant cost in
// memory: both hold the same bytes after their headers, that of the PCD file by PCL.
class PointCloudWriter {
 public:
  // Throws Error naming the file when it can not be created.
  PointCloudWriter(const std::string& ply_path, const std::string& pcd_path);

  void Add(const MapPoint& point);
  // Completes both files under their temporary names. Call once, after the last point.
  void Finish();
  // Gives both files their names.
  void Commit();

 private:
  // A file of which the beginning is written last.
  class File {
   public:
    explicit File(const std::string& path);
    ~File();
    File(const File&) = delete;
    File& operator=(const File&) = delete;

    void Write(const void* data, size_t size);
    void Rewind();
    void Close();
    void Commit() { file_.Commit(); }

   private:
    [[noreturn]] void Fail() const;

    AtomicFile file_;
    std::FILE* stream_;
  };

  void WriteHeaders();
  void Flush();

  File ply_;
  File pcd_;
  std::vector<char> buffer_;  // the first num_buffered_: packed points not yet in the files
  size_t num_buffered_ = 0;
  int64_t num_points_ = 0;
  bool finished_ = false;
};

}  // namespace plumbline
