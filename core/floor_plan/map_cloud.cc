#include "core/floor_plan/map_cloud.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <limits>
#include <unordered_map>

#include "core/cloud/point_buffer.h"
#include "core/util/error.h"
#include "core/util/time.h"

namespace plumbline {
namespace {

constexpr double kMaxPoseGapS = 0.2;

// Reads the header and returns the number of points; the stream is then at the first one.
int64_t ReadHeader(const std::string& path, std::istream* stream) {
  static const char* const kProperties[] = {"property float x",
                                            "property float y",
                                            "property float z",
                                            "property double time",
                                            "property uchar scanner",
                                            "property int plane_id",
                                            "property float residual"};
  std::string line;
  int64_t num_points = -1;
  size_t num_properties = 0;
  for (int number = 1; std::getline(*stream, line) && line != "end_header"; ++number) {
    const std::string place = path + ":" + std::to_string(number) + ": ";
    if (number == 1 && line != "ply") throw Error(place + "not a PLY file");
    if (number == 2 && line != "format binary_little_endian 1.0") {
      throw Error(place + "not binary little-endian");
    }
    if (line.rfind("element vertex ", 0) == 0) num_points = std::atoll(line.c_str() + 15);
    if (line.rfind("property ", 0) != 0) continue;
    if (num_properties >= std::size(kProperties) || line != kProperties[num_properties]) {
      throw Error(place + "'" + line + "' is not what plumbline_map writes there");
    }
    ++num_properties;
  }
  if (line != "end_header" || num_points < 0 || num_properties != std::size(kProperties)) {
    throw Error(path + ": has no complete header of a map.ply");
  }
  return num_points;
}

CloudPoint Parse(const char* bytes) {
  CloudPoint point;
  const auto take = [&bytes](void* to, size_t size) {
    std::memcpy(to, bytes, size);
    bytes += size;
  };
  take(point.p_world.data(), 3 * sizeof(float));
  take(&point.time_s, sizeof(double));
  take(&point.scanner, sizeof(uint8_t));
  take(&point.plane_id, sizeof(int32_t));
  take(&point.residual_m, sizeof(float));
  return point;
}

}  // namespace

std::vector<CloudPoint> ReadMapCloud(const std::string& path) {
  errno = 0;
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw Error(path + ": can not be read: " + std::strerror(errno));
  const int64_t num_points = ReadHeader(path, &stream);
  std::vector<CloudPoint> points;
  constexpr int64_t kBlock = 1 << 16;
  std::vector<char> bytes(static_cast<size_t>(kBlock) * PointBuffer::kPointBytes);
  for (int64_t done = 0; done < num_points;) {
    const auto count = static_cast<size_t>(std::min(kBlock, num_points - done));
    const size_t size = count * PointBuffer::kPointBytes;
    if (!stream.read(bytes.data(), static_cast<std::streamsize>(size))) {
      throw Error(path + ": ends before its " + std::to_string(num_points) + " points");
    }
    for (size_t i = 0; i < count; ++i) {
      points.push_back(Parse(bytes.data() + i * PointBuffer::kPointBytes));
    }
    done += static_cast<int64_t>(count);
  }
  return points;
}

BeamOrigins::BeamOrigins(const Rig& rig, std::vector<StampedPose> poses, int64_t start_ns)
    : poses_(std::move(poses)), start_ns_(start_ns) {
  for (const Scanner& scanner : rig.scanners) {
    body_from_scanner_.push_back(scanner.body_from_scanner);
  }
}

std::optional<Eigen::Vector3d> BeamOrigins::At(size_t scanner, double time_s) const {
  if (scanner >= body_from_scanner_.size() || poses_.empty()) return std::nullopt;
  const int64_t time_ns = start_ns_ + NanosecondsFromSeconds(time_s);
  const auto after = std::lower_bound(
      poses_.begin(), poses_.end(), time_ns, [](const StampedPose& pose, int64_t time) {
        return pose.time_ns < time;
      });
  const StampedPose& next = after == poses_.end() ? poses_.back() : *after;
  const StampedPose& previous = after == poses_.begin() ? next : *(after - 1);
  const double since_s = SecondsBetween(previous.time_ns, time_ns);
  const double until_s = SecondsBetween(time_ns, next.time_ns);
  if (std::abs(since_s) > kMaxPoseGapS || std::abs(until_s) > kMaxPoseGapS) {
    return std::nullopt;
  }
  const double span_s = since_s + until_s;
  const double share = span_s > 0.0 ? std::clamp(since_s / span_s, 0.0, 1.0) : 0.0;
  const Eigen::Vector3d from =
      previous.world_from_body * body_from_scanner_[scanner].translation;
  const Eigen::Vector3d to = next.world_from_body * body_from_scanner_[scanner].translation;
  return from + share * (to - from);
}

int64_t RecordingStart(const std::vector<PlanePatch>& planes,
                       const std::vector<CloudPoint>& points) {
  std::unordered_map<int, double> first_s;
  for (const CloudPoint& point : points) {
    if (point.plane_id < 0) continue;
    const auto [at, is_new] = first_s.try_emplace(point.plane_id, point.time_s);
    if (!is_new) at->second = std::min(at->second, point.time_s);
  }
  int64_t start_ns = std::numeric_limits<int64_t>::max();
  for (const PlanePatch& plane : planes) {
    const auto at = first_s.find(plane.id);
    if (at == first_s.end()) continue;
    start_ns = std::min(start_ns, plane.first_time_ns - NanosecondsFromSeconds(at->second));
  }
  if (start_ns == std::numeric_limits<int64_t>::max()) {
    throw Error("no point of the map lies on any of its planes: there is nothing to plan");
  }
  return start_ns;
}

}  // namespace plumbline
