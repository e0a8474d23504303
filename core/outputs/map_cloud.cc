#include "core/outputs/map_cloud.h"

#include <algorithm>

#include "core/result/ply_reader.h"
#include "core/util/time.h"

namespace plumbline {
namespace {

constexpr double kMaxPoseGapS = 0.2;

}  // namespace

std::vector<CloudPoint> ReadMapCloud(const std::string& path) {
  PlyReader reader(path);
  std::vector<CloudPoint> points;
  for (PointBuffer block; reader.Next(&block);) {
    for (int64_t i = 0; i < block.num_points(); ++i) {
      const MapPoint point = block.At(i);
      points.push_back({point.p_world,
                        point.residual_m,
                        point.time_s,
                        point.plane_id,
                        static_cast<uint8_t>(point.scanner)});
    }
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

}  // namespace plumbline
