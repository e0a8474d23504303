#include "core/judging/start_search.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <utility>

#include "core/association/model_frame.h"
#include "core/geometry/angles.h"
#include "core/map/observation.h"
#include "core/segmentation/segmentation.h"
#include "core/util/quantiles.h"

namespace plumbline {
namespace {

constexpr size_t kNumScans = 60;
constexpr double kMaxApart = 0.1;  // s, between the lines of a scan

// The line of a scanner nearest to an instant; null where none is near.
const ScanLine* LineNear(const std::vector<ScanLine>& lines, int64_t instant_ns) {
  const auto apart = [instant_ns](const ScanLine& line) {
    return std::llabs(line.stamp_ns - instant_ns);
  };
  const auto nearest =
      std::min_element(lines.begin(), lines.end(), [&](const ScanLine& a, const ScanLine& b) {
        return apart(a) < apart(b);
      });
  if (nearest == lines.end()) return nullptr;
  return apart(*nearest) > NanosecondsFromSeconds(kMaxApart) ? nullptr : &*nearest;
}

}  // namespace

StartSearch FindStarts(const Rig& rig,
                       const std::vector<const std::vector<ScanLine>*>& lines) {
  StartSearch search;
  const bool planar = IsPlanar(rig);
  const auto most =
      std::max_element(lines.begin(), lines.end(), [](const auto* a, const auto* b) {
        return a->size() < b->size();
      });
  if (most == lines.end() || (*most)->empty()) return search;
  const std::vector<ScanLine>& reference = **most;
  std::vector<double> tilts_deg;
  const size_t stride = std::max<size_t>(1, reference.size() / kNumScans);
  for (size_t at = 0; at < reference.size(); at += stride) {
    std::vector<Observation> scan;
    for (size_t i = 0; i < rig.scanners.size(); ++i) {
      const ScanLine* near = LineNear(*lines[i], reference[at].stamp_ns);
      if (near == nullptr) continue;
      ScanLine line = *near;
      line.scanner_index = static_cast<int>(i);
      for (const Segment& segment : SegmentScanLine(line, rig.scanners[i], {}, {})) {
        scan.push_back(MakeObservation(line, rig.scanners[i], segment, false));
      }
    }
    ++search.num_scans;
    const std::optional<ModelFrame> frame = FindModelFrame(rig, planar, scan);
    if (!frame) continue;
    ++search.num_starts;
    const Eigen::Vector3d up = frame->world_from_body * Eigen::Vector3d::UnitZ();
    tilts_deg.push_back(std::acos(std::clamp(up.z(), -1.0, 1.0)) * kDegreesPerRadian);
  }
  search.tilt_deg = Median(std::move(tilts_deg));
  return search;
}

}  // namespace plumbline
