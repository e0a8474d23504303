#include "core/judging/sightings.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "core/geometry/plan_grid.h"
#include "core/surface/landmark_view.h"
#include "core/util/quantiles.h"
#include "core/util/time.h"

namespace plumbline {
namespace {

// A segment's end is known far better than one range, but real surfaces are not flat, and
// frames and skirting boards stand off their wall by some centimetres.
constexpr double kMinMargin = 0.06;  // m
// A segment's point lies on its plane within this; farther off it is another's.
constexpr double kOnPlane = 0.1;  // m
// Number of points of a segment for each beam that is followed; at most kMaxBeams.
constexpr int kPointsPerBeam = 6;
constexpr int kMaxBeams = 8;

auto KeyOf(const Sighting& sighting) {
  return std::make_tuple(sighting.landmark_id, sighting.cell.first, sighting.cell.second);
}

// Whether the plane has been seen on the cell and on those beside it: at its rim an opening or
// an edge may lie within the cell. Of what level scan planes alone have seen, one or two rows,
// those above and below do not count.
bool IsInside(const PatchExtent& extent, const CellGrid::Cell& cell) {
  const CellGrid& cells = extent.cells();
  const auto is_seen = [&](int i, int j) {
    return cells.Count({cell.first + i, cell.second + j}) > 0;
  };
  if (!is_seen(0, 0) || !is_seen(-1, 0) || !is_seen(1, 0)) return false;
  const double height_m = extent.max_corner().y() - extent.min_corner().y();
  return height_m < PatchExtent::kCellSize || (is_seen(0, -1) && is_seen(0, 1));
}

// Casts the beams of one second.
class SecondCaster {
 public:
  SecondCaster(const Rig& rig,
               const MapState& state,
               const std::vector<LandmarkView>& planes,
               PlanGrid* grid)
      : state_(state),
        planes_(planes),
        margin_m_(std::max(kMinMargin, kSignificantStddevs * MaxRangeNoise(rig))),
        grid_(grid),
        poses_(rig, state.trajectory) {}

  std::vector<Sighting> Cast(int second, const std::pair<size_t, size_t>& range) {
    for (size_t i = range.first; i < range.second; ++i) Follow(state_.observations[i]);
    return Sum(second);
  }

 private:
  void Follow(const Observation& observation) {
    const PlacedSegment segment = Place(observation, state_.landmarks, &poses_);
    const int num_beams = std::clamp(observation.num_points / kPointsPerBeam, 1, kMaxBeams);
    for (int i = 0; i < num_beams; ++i) {
      const Eigen::Vector3d end = segment.At((i + 0.5) / num_beams);
      if (observation.landmark_id >= 0) CountHit(observation.landmark_id, end);
      grid_->ForEachNear(segment.scanner_world.head<2>(), end.head<2>(), [&](int index) {
        const LandmarkView& plane = planes_[static_cast<size_t>(index)];
        if (plane.landmark->id != observation.landmark_id) {
          CountPassage(plane, segment.scanner_world, end);
        }
      });
    }
  }

  void CountHit(int landmark_id, const Eigen::Vector3d& p_world) {
    const Landmark& landmark = state_.landmarks[static_cast<size_t>(landmark_id)];
    if (std::abs(landmark.SignedDistance(p_world)) > kOnPlane) return;
    const CellGrid::Cell cell = PatchExtent::CellAt(landmark.extent.Project(p_world));
    counted_.push_back({landmark_id, cell, 0, 1, 0});
  }

  void CountPassage(const LandmarkView& plane,
                    const Eigen::Vector3d& start_world,
                    const Eigen::Vector3d& end_world) {
    const double start = plane.SignedDistance(start_world);
    const double end = plane.SignedDistance(end_world);
    if (std::abs(start) < margin_m_ || std::abs(end) < margin_m_ || start * end > 0.0) return;
    // Along the beam the distance is start + slope s + bend s^2, with s from 0 to 1.
    const Eigen::Vector3d along = end_world - start_world;
    const double bend = 0.5 * plane.curvature * along.head<2>().squaredNorm();
    const double slope = end - start - bend;
    const double root = std::sqrt(std::max(0.0, slope * slope - 4.0 * bend * start));
    const double share = 2.0 * start / (std::copysign(root, start) - slope);
    const Eigen::Vector3d at = start_world + share * along;
    const PatchExtent& extent = plane.landmark->extent;
    const CellGrid::Cell cell = PatchExtent::CellAt(extent.Project(at));
    if (!IsInside(extent, cell)) return;
    counted_.push_back({plane.landmark->id, cell, 0, 0, 1});
  }

  // Adds up what was counted.
  std::vector<Sighting> Sum(int second) {
    std::sort(counted_.begin(), counted_.end(), [](const auto& a, const auto& b) {
      return KeyOf(a) < KeyOf(b);
    });
    std::vector<Sighting> sums;
    for (const Sighting& one : counted_) {
      if (sums.empty() || KeyOf(sums.back()) != KeyOf(one)) {
        sums.push_back({one.landmark_id, one.cell, second, 0, 0});
      }
      sums.back().num_hits += one.num_hits;
      sums.back().num_passages += one.num_passages;
    }
    return sums;
  }

  const MapState& state_;
  const std::vector<LandmarkView>& planes_;
  double margin_m_;
  PlanGrid* grid_;
  SharedPoses poses_;
  std::vector<Sighting> counted_;
};

}  // namespace

Sightings::Sightings(std::vector<Sighting> all) : all_(std::move(all)) {
  std::sort(all_.begin(), all_.end(), [](const Sighting& a, const Sighting& b) {
    return KeyOf(a) != KeyOf(b) ? KeyOf(a) < KeyOf(b) : a.second < b.second;
  });
  for (const Sighting& sighting : all_) {
    num_seconds_ = std::max(num_seconds_, sighting.second + 1);
  }
}

std::pair<const Sighting*, const Sighting*> Sightings::Of(int landmark_id,
                                                          const CellGrid::Cell& cell) const {
  const auto key = std::make_tuple(landmark_id, cell.first, cell.second);
  const auto first =
      std::lower_bound(all_.begin(), all_.end(), key, [](const Sighting& a, const auto& b) {
        return KeyOf(a) < b;
      });
  auto last = first;
  while (last != all_.end() && KeyOf(*last) == key) ++last;
  const Sighting* base = all_.data();
  return {base + (first - all_.begin()), base + (last - all_.begin())};
}

std::pair<const Sighting*, const Sighting*> Sightings::Of(int landmark_id) const {
  const auto first =
      std::lower_bound(all_.begin(), all_.end(), landmark_id, [](const Sighting& a, int id) {
        return a.landmark_id < id;
      });
  const auto last =
      std::upper_bound(first, all_.end(), landmark_id, [](int id, const Sighting& a) {
        return id < a.landmark_id;
      });
  const Sighting* base = all_.data();
  return {base + (first - all_.begin()), base + (last - all_.begin())};
}

PlacedSegment Place(const Observation& observation,
                    const std::deque<Landmark>& landmarks,
                    SharedPoses* poses) {
  const ScanMotion& motion = poses->Of(observation).motion;
  PlacedSegment segment;
  segment.scanner_world = motion.At(observation.middle_time_ns()).col(2);
  segment.start_world = motion.ToWorld(observation.start(), observation.start_time_ns());
  segment.end_world = motion.ToWorld(observation.end(), observation.end_time_ns());
  if (observation.landmark_id < 0) return segment;
  const Landmark& landmark = landmarks[static_cast<size_t>(observation.landmark_id)];
  if (observation.taken_to == observation.landmark_id) segment.at_middle = 1.0;
  const double level2 = (segment.end_world - segment.start_world).head<2>().squaredNorm();
  segment.bow_world = landmark.Curvature() * level2 / 8.0 *
                      landmark.NormalNear(0.5 * (segment.start_world + segment.end_world));
  return segment;
}

int SecondOf(int64_t start_ns, int64_t time_ns) {
  return std::max(0, static_cast<int>(std::floor(SecondsBetween(start_ns, time_ns))));
}

std::vector<std::pair<size_t, size_t>> ObservationsBySecond(int64_t start_ns,
                                                            const MapState& state) {
  std::vector<std::pair<size_t, size_t>> ranges;
  size_t first = 0;
  for (size_t i = 0; i < state.observations.size(); ++i) {
    const auto second =
        static_cast<size_t>(SecondOf(start_ns, state.observations[i].middle_time_ns()));
    // Scan lines that overlap in time may step back by less than a second.
    while (ranges.size() < second) {
      ranges.emplace_back(first, i);
      first = i;
    }
  }
  ranges.emplace_back(first, state.observations.size());
  return ranges;
}

Sightings CollectSightings(const Rig& rig, const MapState& state, int64_t start_ns) {
  std::vector<LandmarkView> planes;
  std::vector<Eigen::AlignedBox2d> boxes;
  for (const Landmark& landmark : state.landmarks) {
    if (landmark.num_segments == 0 || landmark.extent.empty()) continue;
    planes.emplace_back(landmark);
    boxes.push_back(planes.back().PlanBox(PatchExtent::kCellSize));
  }
  const PlanGrid grid(boxes);
  tbb::enumerable_thread_specific<PlanGrid> grids(grid);
  const auto ranges = ObservationsBySecond(start_ns, state);
  std::vector<std::vector<Sighting>> by_second(ranges.size());
  tbb::parallel_for(size_t{0}, ranges.size(), [&](size_t second) {
    SecondCaster caster(rig, state, planes, &grids.local());
    by_second[second] = caster.Cast(static_cast<int>(second), ranges[second]);
  });
  std::vector<Sighting> all;
  for (std::vector<Sighting>& sightings : by_second) {
    all.insert(all.end(), sightings.begin(), sightings.end());
    sightings = {};
  }
  return Sightings(std::move(all));
}

}  // namespace plumbline
