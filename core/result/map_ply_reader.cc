#include "core/result/map_ply_reader.h"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <sstream>
#include <system_error>

#include "core/util/error.h"

namespace plumbline {
namespace {

constexpr int64_t kBlockPoints = 1 << 16;

constexpr char kFields[] =
    "property float x\n"
    "property float y\n"
    "property float z\n"
    "property double time\n"
    "property uchar scanner\n"
    "property int plane_id\n"
    "property float residual\n"
    "end_header\n";

// Reads the header up to its last line; throws Error where it is none.
int64_t ReadHeader(const std::string& path, std::istream* file) {
  constexpr int kMaxLines = 100;
  std::string line;
  std::string fields;
  int64_t num_points = -1;
  for (int i = 0; i < kMaxLines && std::getline(*file, line); ++i) {
    if (i == 0 && line != "ply") break;
    if (i == 1 && line != "format binary_little_endian 1.0") break;
    if (line.rfind("element vertex ", 0) == 0) {
      char* end = nullptr;
      num_points = std::strtoll(line.c_str() + 15, &end, 10);
      if (*end != '\0') break;
    } else if (i > 1 && line.rfind("comment", 0) != 0) {
      fields += line + "\n";
    }
    if (line != "end_header") continue;
    if (num_points < 0 || fields != kFields) break;
    return num_points;
  }
  throw Error(path + ": is not a map that plumbline_map wrote: its header is another one");
}

MapPoint Unpack(const char* bytes) {
  MapPoint point;
  const auto take = [&bytes](auto* value) {
    std::memcpy(value, bytes, sizeof(*value));
    bytes += sizeof(*value);
  };
  uint8_t scanner = 0;
  int32_t plane_id = 0;
  for (int i = 0; i < 3; ++i) take(&point.p_world[i]);
  take(&point.time_s);
  take(&scanner);
  take(&plane_id);
  take(&point.residual_m);
  point.scanner = scanner;
  point.plane_id = plane_id;
  return point;
}

}  // namespace

MapPlyReader::MapPlyReader(const std::string& path)
    : path_(path), file_(path, std::ios::binary) {
  if (!file_) throw Error(path + ": can not be read: " + std::strerror(errno));
  num_points_ = ReadHeader(path, &file_);
  std::error_code error;
  const uintmax_t size = std::filesystem::file_size(path, error);
  const auto header = static_cast<uintmax_t>(file_.tellg());
  const auto points = static_cast<uintmax_t>(num_points_);
  if (error || points > size || size - header < points * PointBuffer::kPointBytes) {
    throw Error(path + ": ends before its last point");
  }
}

bool MapPlyReader::Next(std::vector<MapPoint>* block) {
  const int64_t count = std::min(kBlockPoints, num_points_ - num_read_);
  block->clear();
  if (count == 0) return false;
  bytes_.resize(static_cast<size_t>(count) * PointBuffer::kPointBytes);
  file_.read(bytes_.data(), static_cast<std::streamsize>(bytes_.size()));
  if (!file_) throw Error(path_ + ": can not be read: " + std::strerror(errno));
  for (size_t at = 0; at < bytes_.size(); at += PointBuffer::kPointBytes) {
    block->push_back(Unpack(bytes_.data() + at));
  }
  num_read_ += count;
  return true;
}

}  // namespace plumbline
