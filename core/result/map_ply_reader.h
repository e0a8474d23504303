#pragma once

#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

#include "core/result/point_buffer.h"

namespace plumbline {

// Reads the points of a map.ply that plumbline_map wrote, block by block, in the file's order.
class MapPlyReader {
 public:
  // Throws Error, naming the file, where it can not be read, is not a PLY file with the fields
  // that PointBuffer names, or is shorter than its header says.
  explicit MapPlyReader(const std::string& path);

  int64_t num_points() const { return num_points_; }

  // Fills the block with the next points; false, and an empty block, after the last one.
  // Throws Error where reading fails.
  bool Next(std::vector<MapPoint>* block);

 private:
  std::string path_;
  std::ifstream file_;
  int64_t num_points_ = 0;
  int64_t num_read_ = 0;
  std::vector<char> bytes_;
};

}  // namespace plumbline
