#include "core/point_cloud_writer.h"

#include <glog/logging.h>
#include <pcl/PCLPointCloud2.h>
#include <pcl/io/pcd_io.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <limits>

#include "core/error.h"

namespace plumbline {

namespace {

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "points are written as they lie");

constexpr size_t kPointBytes =
    3 * sizeof(float) + sizeof(double) + sizeof(uint8_t) + sizeof(int32_t) + sizeof(float);
constexpr size_t kBufferBytes = 10'000 * kPointBytes;

// Returns where the next value goes.
template <typename Value>
char* Put(Value value, char* at) {
  std::memcpy(at, &value, sizeof(value));
  return at + sizeof(value);
}

// Of the same length for every number of points, so that it can be filled in at the end.
std::string PlyHeader(int64_t num_points) {
  const std::string count = std::to_string(num_points);
  const std::string padding(
      static_cast<size_t>(std::numeric_limits<int64_t>::digits10 + 1) - count.size(), ' ');
  return "ply\n"
         "format binary_little_endian 1.0\n"
         "comment metres; time in s since the first scan line; plane_id -1: on no plane" +
         padding +
         "\n"
         "element vertex " +
         count +
         "\n"
         "property float x\n"
         "property float y\n"
         "property float z\n"
         "property double time\n"
         "property uchar scanner\n"
         "property int plane_id\n"
         "property float residual\n"
         "end_header\n";
}

std::string PcdHeader(int64_t num_points) {
  pcl::PCLPointCloud2 cloud;
  cloud.width = static_cast<pcl::uindex_t>(num_points);
  cloud.height = 1;
  const auto add_field = [&cloud](const std::string& name, uint8_t type, size_t size) {
    pcl::PCLPointField field;
    field.name = name;
    field.offset = cloud.point_step;
    field.datatype = type;
    field.count = 1;
    cloud.fields.push_back(field);
    cloud.point_step += static_cast<pcl::uindex_t>(size);
  };
  for (const char* name : {"x", "y", "z"}) {
    add_field(name, pcl::PCLPointField::FLOAT32, sizeof(float));
  }
  add_field("time", pcl::PCLPointField::FLOAT64, sizeof(double));
  add_field("scanner", pcl::PCLPointField::UINT8, sizeof(uint8_t));
  add_field("plane_id", pcl::PCLPointField::INT32, sizeof(int32_t));
  add_field("residual", pcl::PCLPointField::FLOAT32, sizeof(float));
  CHECK_EQ(cloud.point_step, kPointBytes);
  cloud.row_step = cloud.point_step * cloud.width;
  return pcl::PCDWriter().generateHeaderBinary(
             cloud, Eigen::Vector4f::Zero(), Eigen::Quaternionf::Identity()) +
         "DATA binary\n";
}

}  // namespace

PointCloudWriter::PointCloudWriter(const std::string& ply_path, const std::string& pcd_path)
    : ply_(ply_path), pcd_(pcd_path) {
  stream_ = std::fopen(ply_.temporary_path().c_str(), "w+b");
  if (stream_ == nullptr) Fail(ply_);
  buffer_.reserve(kBufferBytes + kPointBytes);
  const std::string header = PlyHeader(0);
  WriteToPly(header.data(), header.size());
}

PointCloudWriter::~PointCloudWriter() {
  if (stream_ != nullptr) std::fclose(stream_);
}

void PointCloudWriter::Fail(const AtomicFile& file) const {
  throw Error(file.path() + ": can not be written: " + std::strerror(errno));
}

void PointCloudWriter::WriteToPly(const void* data, size_t size) {
  if (std::fwrite(data, 1, size, stream_) != size) Fail(ply_);
}

void PointCloudWriter::Flush() {
  WriteToPly(buffer_.data(), buffer_.size());
  buffer_.clear();
}

void PointCloudWriter::Add(const MapPoint& point) {
  CHECK(stream_ != nullptr) << "Add() after Finish()";
  CHECK_GE(point.scanner, 0);
  CHECK_LE(point.scanner, std::numeric_limits<uint8_t>::max());
  std::array<char, kPointBytes> bytes;
  char* at = bytes.data();
  at = Put(point.p_world.x(), at);
  at = Put(point.p_world.y(), at);
  at = Put(point.p_world.z(), at);
  at = Put(point.time_s, at);
  at = Put(static_cast<uint8_t>(point.scanner), at);
  at = Put(static_cast<int32_t>(point.plane_id), at);
  Put(point.residual_m, at);
  buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
  ++num_points_;
  if (buffer_.size() >= kBufferBytes) Flush();
}

void PointCloudWriter::Finish() {
  CHECK(stream_ != nullptr) << "Finish() twice";
  Flush();
  if (std::fseek(stream_, 0, SEEK_SET) != 0) Fail(ply_);
  const std::string header = PlyHeader(num_points_);
  WriteToPly(header.data(), header.size());
  if (std::fflush(stream_) != 0) Fail(ply_);
  CopyToPcd();
  std::FILE* stream = stream_;
  stream_ = nullptr;
  if (std::fclose(stream) != 0) Fail(ply_);
}

// The points follow the header in stream_.
void PointCloudWriter::CopyToPcd() {
  if (std::fseek(stream_, static_cast<long>(PlyHeader(num_points_).size()), SEEK_SET) != 0) {
    Fail(ply_);
  }
  std::FILE* pcd = std::fopen(pcd_.temporary_path().c_str(), "wb");
  if (pcd == nullptr) Fail(pcd_);
  const std::string header = PcdHeader(num_points_);
  bool good = std::fwrite(header.data(), 1, header.size(), pcd) == header.size();
  std::vector<char> block(kBufferBytes);
  int64_t num_bytes = 0;
  while (good) {
    const size_t size = std::fread(block.data(), 1, block.size(), stream_);
    if (size == 0) break;
    good = std::fwrite(block.data(), 1, size, pcd) == size;
    num_bytes += static_cast<int64_t>(size);
  }
  const int write_error = errno;
  const bool closed = std::fclose(pcd) == 0;
  if (!good) errno = write_error;
  if (!good || !closed) Fail(pcd_);
  if (num_bytes != num_points_ * static_cast<int64_t>(kPointBytes)) {
    throw Error(ply_.path() + ": can not be read back");
  }
}

void PointCloudWriter::Commit() {
  ply_.Commit();
  pcd_.Commit();
}

}  // namespace plumbline
