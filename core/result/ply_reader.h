#pragma once

#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

#include "core/result/point_buffer.h"

namespace plumbline {

// Reads the points of a map.ply, a block at a time. Fields are found by name, so that files
// with more of them, or without normals, are read too.
class PlyReader {
 public:
  // Reads the header. Throws Error naming the file where it is not that of a map.
  explicit PlyReader(const std::string& path);

  int64_t num_points() const { return num_points_; }
  // Replaces the points by the next ones, at most 100 000; false where there are no more.
  // Throws Error where the file ends within them.
  bool Next(PointBuffer* points);

 private:
  struct Field {
    std::string name;
    std::string type;
    size_t offset = 0;  // of its bytes in a record
  };

  [[noreturn]] void Fail(const std::string& why) const;
  std::string ReadLine();
  void ReadHeader();
  void AddField(const std::string& type, const std::string& name);
  // Returns the offset of the field in a record. Throws Error where it is missing.
  size_t OffsetOf(const std::string& name, const std::string& type) const;
  bool Has(const std::string& name) const;

  std::string path_;
  std::ifstream file_;
  std::vector<Field> fields_;
  size_t record_bytes_ = 0;
  int64_t num_points_ = 0;
  int64_t num_read_ = 0;
  std::string block_;
  // Offsets of what a map has: x, y, z; time; scanner; plane_id; residual; normal.
  size_t x_ = 0, y_ = 0, z_ = 0, time_ = 0, scanner_ = 0, plane_id_ = 0, residual_ = 0;
  bool has_normals_ = false;
  size_t nx_ = 0, ny_ = 0, nz_ = 0;
};

}  // namespace plumbline
