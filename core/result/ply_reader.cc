#include "core/result/ply_reader.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <map>
#include <sstream>

#include "core/util/error.h"

namespace plumbline {
namespace {

constexpr int64_t kMaxBlockPoints = 100'000;
constexpr size_t kMaxLineBytes = 1000;

template <typename Value>
Value Take(const char* record, size_t offset) {
  Value value;
  std::memcpy(&value, record + offset, sizeof(value));
  return value;
}

}  // namespace

PlyReader::PlyReader(const std::string& path) : path_(path), file_(path, std::ios::binary) {
  if (!file_) throw Error(path + ": can not be read: " + std::strerror(errno));
  ReadHeader();
  x_ = OffsetOf("x", "float");
  y_ = OffsetOf("y", "float");
  z_ = OffsetOf("z", "float");
  time_ = OffsetOf("time", "double");
  scanner_ = OffsetOf("scanner", "uchar");
  plane_id_ = OffsetOf("plane_id", "int");
  residual_ = OffsetOf("residual", "float");
  has_normals_ = Has("nx");
  if (has_normals_) {
    nx_ = OffsetOf("nx", "float");
    ny_ = OffsetOf("ny", "float");
    nz_ = OffsetOf("nz", "float");
  }
}

void PlyReader::Fail(const std::string& why) const {
  throw Error(path_ + ": is not a map that plumbline_map wrote: " + why);
}

std::string PlyReader::ReadLine() {
  std::string line;
  for (char character = 0; file_.get(character) && character != '\n';) {
    line.push_back(character);
    if (line.size() > kMaxLineBytes) Fail("a line of its header has no end");
  }
  if (!file_) Fail("its header has no end");
  return line;
}

void PlyReader::ReadHeader() {
  if (ReadLine() != "ply") Fail("it does not begin with 'ply'");
  if (ReadLine() != "format binary_little_endian 1.0") Fail("it is not binary, little-endian");
  bool has_vertices = false;
  for (std::string line = ReadLine(); line != "end_header"; line = ReadLine()) {
    std::istringstream words(line);
    std::string keyword;
    std::string first;
    std::string second;
    words >> keyword >> first >> second;
    if (keyword == "comment") continue;
    if (keyword == "element" && first == "vertex" && !has_vertices) {
      std::istringstream number(second);
      if (!(number >> num_points_) || num_points_ < 0) Fail("'" + line + "'");
      has_vertices = true;
    } else if (keyword == "property" && has_vertices) {
      AddField(first, second);
    } else {
      Fail("'" + line + "'");
    }
  }
}

void PlyReader::AddField(const std::string& type, const std::string& name) {
  static const std::map<std::string, size_t> kSizes = {{"char", 1},
                                                       {"uchar", 1},
                                                       {"short", 2},
                                                       {"ushort", 2},
                                                       {"int", 4},
                                                       {"uint", 4},
                                                       {"float", 4},
                                                       {"double", 8}};
  const auto size = kSizes.find(type);
  if (size == kSizes.end()) Fail("'property " + type + " " + name + "'");
  fields_.push_back({name, type, record_bytes_});
  record_bytes_ += size->second;
}

bool PlyReader::Has(const std::string& name) const {
  return std::any_of(
      fields_.begin(), fields_.end(), [&](const Field& field) { return field.name == name; });
}

size_t PlyReader::OffsetOf(const std::string& name, const std::string& type) const {
  for (const Field& field : fields_) {
    if (field.name == name && field.type == type) return field.offset;
  }
  Fail("it has no 'property " + type + " " + name + "'");
}

bool PlyReader::Next(PointBuffer* points) {
  points->Clear();
  const int64_t num_points = std::min(kMaxBlockPoints, num_points_ - num_read_);
  if (num_points == 0) return false;
  block_.resize(static_cast<size_t>(num_points) * record_bytes_);
  if (!file_.read(block_.data(), static_cast<std::streamsize>(block_.size()))) {
    throw Error(path_ + ": ends within its points: it was not written to the end");
  }
  const char* end = block_.data() + block_.size();
  for (const char* record = block_.data(); record < end; record += record_bytes_) {
    MapPoint point;
    point.p_world = {
        Take<float>(record, x_), Take<float>(record, y_), Take<float>(record, z_)};
    point.time_s = Take<double>(record, time_);
    point.scanner = Take<uint8_t>(record, scanner_);
    point.plane_id = Take<int32_t>(record, plane_id_);
    point.residual_m = Take<float>(record, residual_);
    if (has_normals_) {
      point.normal_world = {
          Take<float>(record, nx_), Take<float>(record, ny_), Take<float>(record, nz_)};
    }
    if (!point.p_world.allFinite() || !std::isfinite(point.time_s)) {
      Fail("point " + std::to_string(num_read_ + points->num_points()) +
           " has a position or time that is no number");
    }
    points->Add(point);
  }
  num_read_ += num_points;
  return true;
}

}  // namespace plumbline
