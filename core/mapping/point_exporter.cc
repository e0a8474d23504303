#include "core/mapping/point_exporter.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>

#include "core/association/association.h"
#include "core/map/observation_poses.h"
#include "core/map/scan_line_batches.h"
#include "core/result/point_buffer.h"
#include "core/sensor/beam_instant.h"
#include "core/sensor/scan_reader.h"
#include "core/surface/landmark_view.h"
#include "core/util/ordered_pipeline.h"
#include "factors/segment/segment_measurement.h"

namespace plumbline {
namespace {

// Share of points on planes over time, to tell where the pose is doubtful: where the estimate
// went astray, segments no longer lie on the planes.
class SupportOverTime {
 public:
  // first_second: of the recording, from which the times count.
  explicit SupportOverTime(int first_second) : first_second_(first_second) {}

  void Add(double time_s, int64_t num_points, int64_t num_on_planes) {
    const auto bin = static_cast<size_t>(std::max(0.0, time_s) / kBinSeconds);
    if (bin >= bins_.size()) bins_.resize(bin + 1);
    bins_[bin].num_points += num_points;
    bins_[bin].num_on_planes += num_on_planes;
  }

  // One sentence for each stretch with less than half of the overall share.
  std::vector<std::string> Warnings() const {
    Bin total;
    for (const Bin& bin : bins_) {
      total.num_points += bin.num_points;
      total.num_on_planes += bin.num_on_planes;
    }
    std::vector<std::string> warnings;
    for (size_t i = 0; i < bins_.size(); ++i) {
      if (!IsDoubtful(bins_[i], total)) continue;
      const size_t first = i;
      while (i + 1 < bins_.size() && IsDoubtful(bins_[i + 1], total)) ++i;
      char text[160];
      std::snprintf(
          text,
          sizeof(text),
          "from %.2f to %.2f s less than half as many points as usual lie on planes: "
          "the pose is doubtful there",
          first_second_ + static_cast<double>(first) * kBinSeconds,
          first_second_ + static_cast<double>(i + 1) * kBinSeconds);
      warnings.emplace_back(text);
    }
    return warnings;
  }

 private:
  static constexpr double kBinSeconds = 0.25;
  struct Bin {
    int64_t num_points = 0;
    int64_t num_on_planes = 0;
  };

  static bool IsDoubtful(const Bin& bin, const Bin& total) {
    return 2 * bin.num_on_planes * total.num_points < bin.num_points * total.num_on_planes;
  }

  int first_second_;
  std::vector<Bin> bins_;
};

// How many of a scan line's points came into the map.
struct LineCount {
  int scanner_index = 0;
  uint64_t fingerprint = 0;
  double time_s = 0.0;     // of its middle, since the recording's start
  bool is_during_map = false;
  int64_t num_points = 0;  // valid ranges
  int64_t num_placed = 0;  // within the map's time
  int64_t num_used = 0;
  int64_t num_moving = 0;
  double sum_squares = 0.0;  // of the residuals, m^2
};

// A few scan lines on their way into the map.
struct Item {
  ScanLineBatch block;
  std::vector<LineCount> counts;  // of the block's lines
  PointBuffer points;
};

// Places the points of scan lines. Serves one block.
class LinePlacer {
 public:
  // planes: of the landmarks, by id.
  LinePlacer(const Rig& rig,
             const MapState& state,
             const std::vector<LandmarkView>& planes,
             int64_t start_ns)
      : rig_(rig),
        state_(state),
        planes_(planes),
        start_ns_(start_ns),
        sampler_(state.trajectory) {}

  LineCount Place(const ScanLineBatch::Line& line, PointBuffer* points) {
    plane_of_beam_.assign(line.scan_line.ranges.size(), nullptr);
    for (size_t i = line.first_observation; i < line.last_observation; ++i) {
      Assign(state_.observations[i]);
    }
    for (size_t i = line.first_run; i < line.last_run; ++i)
      Assign(state_.sub_minimum_segments[i]);
    moves_.assign(line.scan_line.ranges.size(), false);
    for (size_t i = line.first_moving; i < line.last_moving; ++i) {
      const MovingBeams& beams = state_.moving_beams[i];
      std::fill(moves_.begin() + beams.first_beam, moves_.begin() + beams.last_beam + 1, true);
    }
    return PlaceBeams(line.scan_line, points);
  }

 private:
  // Notes the plane of an observation's beams.
  void Assign(const Observation& observation) {
    if (observation.landmark_id < 0) return;
    const LandmarkView* plane = &planes_[static_cast<size_t>(observation.landmark_id)];
    for (int beam = observation.first_beam; beam <= observation.last_beam; ++beam) {
      plane_of_beam_[static_cast<size_t>(beam)] = plane;
    }
    for (const int beam : observation.excluded_beams) {
      plane_of_beam_[static_cast<size_t>(beam)] = nullptr;
    }
  }

  LineCount PlaceBeams(const ScanLine& scan_line, PointBuffer* points) {
    const Scanner& scanner = rig_.scanners[static_cast<size_t>(scan_line.scanner_index)];
    const int64_t map_end_ns = state_.trajectory.end_ns();
    int64_t span_end_ns = std::numeric_limits<int64_t>::min();
    std::optional<ScanMotion> motion;
    LineCount count;
    count.scanner_index = scan_line.scanner_index;
    count.fingerprint = FingerprintOf(scan_line.ranges);
    const int64_t middle_ns = BeamInstant(scan_line, scan_line.num_beams() / 2, rig_);
    count.time_s = SecondsBetween(start_ns_, middle_ns);
    count.is_during_map = middle_ns >= state_.trajectory.start_ns() && middle_ns < map_end_ns;
    for (int beam = 0; beam < scan_line.num_beams(); ++beam) {
      const double range = scan_line.ranges[static_cast<size_t>(beam)];
      if (!scanner.IsValidRange(range)) continue;
      ++count.num_points;
      const int64_t time_ns = BeamInstant(scan_line, beam, rig_);
      if (!state_.IsMapped(time_ns)) continue;
      if (time_ns > span_end_ns) {
        const int last = scan_line.num_beams() - 1;
        span_end_ns = std::min({BeamInstant(scan_line, last, rig_),
                                time_ns + kMaxQuadraticSpanNs,
                                map_end_ns - 1});
        motion =
            ObservationPoses(NodesOfSpan(time_ns, span_end_ns), scanner, &sampler_).motion;
      }
      const Eigen::Vector3d p_world =
          motion->ToWorld(scanner.TrueRange(range) * scan_line.BeamDirection(beam), time_ns);
      ++count.num_placed;
      MapPoint point;
      point.p_world = p_world.cast<float>();
      point.time_s = SecondsBetween(start_ns_, time_ns);
      point.scanner = scan_line.scanner_index;
      point.residual_m = std::numeric_limits<float>::quiet_NaN();
      if (const LandmarkView* plane = plane_of_beam_[static_cast<size_t>(beam)]) {
        const double residual = plane->SignedDistance(p_world);
        ++count.num_used;
        count.sum_squares += residual * residual;
        point.plane_id = plane->landmark->id;
        point.residual_m = static_cast<float>(residual);
        point.normal_world = plane->UnitNormalNear(p_world).cast<float>();
      } else if (moves_[static_cast<size_t>(beam)]) {
        point.plane_id = kMovingPlaneId;
        ++count.num_moving;
      }
      points->Add(point);
    }
    return count;
  }

  const Rig& rig_;
  const MapState& state_;
  const std::vector<LandmarkView>& planes_;
  int64_t start_ns_;
  PoseSampler sampler_;
  std::vector<const LandmarkView*> plane_of_beam_;
  std::vector<bool> moves_;  // by beam
};

}  // namespace

int FirstSecond(const MapState& state, int64_t start_ns) {
  const double start_s = SecondsBetween(start_ns, state.trajectory.start_ns());
  return static_cast<int>(std::max(0.0, std::floor(start_s)));
}

PointReport ExportPoints(const Rig& rig,
                         const MapState& state,
                         const ProgressCallback& progress,
                         RecordingReader* recording,
                         ResultWriter* writer) {
  std::vector<LandmarkView> planes;
  for (const Landmark& landmark : state.landmarks) planes.emplace_back(landmark);
  ScanLineBatchReader reader(recording, state);
  const int first_second = FirstSecond(state, recording->start_ns());
  SupportOverTime support(first_second);
  double sum_squares = 0.0;
  PointReport report;
  report.activity = ScannerActivity(first_second);
  RunOrderedPipeline<Item>(
      [&](Item* item) { return reader.Next(&item->block); },
      [&](Item* item) {
        LinePlacer placer(rig, state, planes, recording->start_ns());
        item->points.Clear();
        item->counts.clear();
        for (const ScanLineBatch::Line& line : item->block.lines) {
          item->counts.push_back(placer.Place(line, &item->points));
        }
      },
      [&](Item* item) {
        writer->AddMapPoints(item->points);
        for (const LineCount& count : item->counts) {
          report.num_points += count.num_points;
          report.num_used += count.num_used;
          report.num_moving += count.num_moving;
          sum_squares += count.sum_squares;
          const double time_s = count.time_s - first_second;
          if (count.num_placed > 0 || (count.num_points == 0 && count.is_during_map)) {
            report.activity.Add(count.scanner_index,
                                time_s,
                                count.num_placed,
                                count.num_used,
                                count.fingerprint);
          }
          if (count.num_placed > 0) {
            support.Add(time_s, count.num_placed, count.num_used);
          }
        }
        progress(static_cast<double>(item->block.end_index) / recording->num_scan_lines());
      });
  if (report.num_used > 0) {
    report.residual_rms_m = std::sqrt(sum_squares / static_cast<double>(report.num_used));
  }
  report.warnings = support.Warnings();
  return report;
}

}  // namespace plumbline
