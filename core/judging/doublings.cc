#include "core/judging/doublings.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>

#include "core/judging/levels.h"

namespace plumbline {
namespace {

// Least number of beams with a return in both topics. As many lines are compared: one such
// beam a line is enough.
constexpr int64_t kMinBoth = 200;
constexpr double kCopiedShare = 0.5;  // of these; chance leaves a few per cent of ranges in mm

// The line whose stamp is nearest.
const ScanLine& NearestOf(const std::vector<ScanLine>& lines, int64_t stamp_ns) {
  const auto after = std::lower_bound(
      lines.begin(), lines.end(), stamp_ns, [](const ScanLine& line, int64_t stamp) {
        return line.stamp_ns < stamp;
      });
  if (after == lines.end()) return lines.back();
  if (after == lines.begin()) return *after;
  const auto before = after - 1;
  return stamp_ns - before->stamp_ns < after->stamp_ns - stamp_ns ? *before : *after;
}

}  // namespace

std::vector<Doubling> FindDoublings(const std::vector<std::vector<ScanLine>>& lines) {
  std::vector<Doubling> doublings;
  for (size_t a = 0; a < lines.size(); ++a) {
    for (size_t b = a + 1; b < lines.size(); ++b) {
      if (lines[a].empty() || lines[b].empty()) continue;
      int64_t num_both = 0;
      int64_t num_same = 0;
      const size_t stride = 1 + lines[b].size() / size_t{kMinBoth};
      for (size_t i = 0; i < lines[b].size(); i += stride) {
        const ScanLine& copy = lines[b][i];
        const ScanLine& original = NearestOf(lines[a], copy.stamp_ns);
        for (int beam = 0; beam < copy.num_beams(); ++beam) {
          const double at =
              (copy.BeamAngle(beam) - original.angle_min) / original.angle_increment;
          const double nearest = std::round(at);
          if (std::abs(at - nearest) > kSome || nearest < 0.0 ||
              nearest >= original.num_beams()) {
            continue;
          }
          const float range = copy.ranges[static_cast<size_t>(beam)];
          const float other = original.ranges[static_cast<size_t>(nearest)];
          if (!std::isfinite(range) || !std::isfinite(other)) continue;
          ++num_both;
          if (range == other) ++num_same;
        }
      }
      const double share =
          static_cast<double>(num_same) / static_cast<double>(std::max<int64_t>(1, num_both));
      if (num_both >= kMinBoth && share > kCopiedShare) doublings.push_back({a, b, share});
    }
  }
  return doublings;
}

}  // namespace plumbline
