#include "core/judging/revisits.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/geometry/plan_grid.h"
#include "core/geometry/robust_fit.h"
#include "core/judging/verdict_levels.h"
#include "core/surface/landmark_view.h"

namespace plumbline {
namespace {

constexpr int kVisitGap = 10;                           // s between two visits of a place
constexpr double kReach = 0.6;                          // m, of a slip that is looked for
constexpr double kRobustScale = 0.05;                   // m, of Cauchy's loss
const double kMaxSlope = std::sin(4.0 * M_PI / 180.0);  // between segment and plane
constexpr double kMinLength = 0.3;  // m, of a segment that tells a wall from clutter
constexpr int kIterations = 8;
// Standard deviations of the prior about no motion: weak, it holds what is open.
constexpr double kPriorShift = 0.5;  // m
constexpr double kPriorTurn = 0.05;  // rad
// Turn of a place between two visits beyond which the map has slipped.
constexpr double kMaxTurn = 0.7 * M_PI / 180.0;  // rad

// A segment's middle and the earlier plane it is compared with.
struct Pair {
  Eigen::Vector3d p_world;  // from the scanner's position of the second's first segment
  Eigen::Vector3d normal;
  double distance_m;  // signed
  int landmark_id;
};

// Whether an earlier visit saw the plane near the point.
bool WasSeenBefore(const Sightings& sightings,
                   const Landmark& landmark,
                   const Eigen::Vector3d& p_world,
                   int second) {
  const CellGrid::Cell cell = PatchExtent::CellAt(landmark.extent.Project(p_world));
  if (landmark.extent.cells().Count(cell) == 0) return false;
  const auto [first, last] = sightings.Of(landmark.id, cell);
  return first != last && first->second <= second - kVisitGap &&
         std::any_of(first, last, [&](const Sighting& one) {
           return one.second <= second - kVisitGap && one.is_solid();
         });
}

// The derivative of a pair's distance by a shift and a turn.
Eigen::Vector4d RowOf(const Pair& pair) {
  Eigen::Vector4d row;
  row << pair.normal, Eigen::Vector3d::UnitZ().cross(pair.p_world).dot(pair.normal);
  return row;
}

RevisitOffset Fit(const std::vector<Pair>& pairs) {
  RevisitOffset offset;
  offset.num_segments = static_cast<int>(pairs.size());
  if (offset.num_segments < kMinAveraged) return offset;
  Eigen::Vector4d motion = Eigen::Vector4d::Zero();  // shift, turn
  Eigen::Vector4d prior;
  prior << Eigen::Vector3d::Constant(1.0 / (kPriorShift * kPriorShift)),
      1.0 / (kPriorTurn * kPriorTurn);
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    RobustFit<4> fit;
    fit.AddPrior(prior.asDiagonal(), motion);
    for (const Pair& pair : pairs) {
      const Eigen::Vector4d row = RowOf(pair);
      const double left = pair.distance_m + row.dot(motion);
      fit.Add(row, left, CauchyWeight(left, kRobustScale) / (kRobustScale * kRobustScale));
    }
    motion += fit.Step();
  }
  int num_near = 0;
  int num_moved = 0;
  std::map<int, int> num_taken;  // segments taken onto a plane, by its id
  for (const Pair& pair : pairs) {
    const double moved = pair.distance_m + RowOf(pair).dot(motion);
    num_near += std::abs(pair.distance_m) < kSameSurface ? 1 : 0;
    num_moved += std::abs(moved) < kSameSurface ? 1 : 0;
    if (std::abs(pair.distance_m) >= kSameSurface && std::abs(moved) < kSameSurface) {
      ++num_taken[pair.landmark_id];
    }
  }
  offset.num_surfaces = static_cast<int>(
      std::count_if(num_taken.begin(), num_taken.end(), [](const auto& taken) {
        return taken.second >= kMinAgreeing;
      }));
  offset.translation_m = motion.head<3>().norm();
  offset.rotation_rad = std::abs(motion(3));
  offset.near_share = static_cast<double>(num_near) / offset.num_segments;
  offset.moved_share = static_cast<double>(num_moved) / offset.num_segments;
  return offset;
}

class VisitComparer {
 public:
  VisitComparer(const Rig& rig,
                const MapState& state,
                const Sightings& sightings,
                const std::vector<LandmarkView>& planes,
                PlanGrid* grid)
      : state_(state),
        sightings_(sightings),
        planes_(planes),
        grid_(grid),
        poses_(rig, state.trajectory) {}

  RevisitOffset Compare(int second, const std::pair<size_t, size_t>& range) {
    if (second < kVisitGap) return {};
    std::vector<Pair> pairs;
    Eigen::Vector3d origin = Eigen::Vector3d::Zero();
    for (size_t i = range.first; i < range.second; ++i) {
      const Observation& observation = state_.observations[i];
      if (observation.length_m() < kMinLength) continue;
      const PlacedSegment segment = Place(observation, state_.landmarks, &poses_);
      if (pairs.empty()) origin = segment.scanner_world;
      AddPair(segment, second, origin, &pairs);
    }
    return Fit(pairs);
  }

 private:
  void AddPair(const PlacedSegment& segment,
               int second,
               const Eigen::Vector3d& origin,
               std::vector<Pair>* pairs) {
    const Eigen::Vector3d middle = segment.At(0.5);
    const Eigen::Vector3d along = (segment.end_world - segment.start_world).normalized();
    const LandmarkView* nearest = nullptr;
    double least = kReach;
    grid_->ForEachNear(middle.head<2>(), middle.head<2>(), [&](int index) {
      const LandmarkView& plane = planes_[static_cast<size_t>(index)];
      const double distance = std::abs(plane.SignedDistance(middle));
      if (distance >= least || std::abs(plane.UnitNormalNear(middle).dot(along)) > kMaxSlope ||
          plane.SignedDistance(segment.scanner_world) < 0.0 ||
          !WasSeenBefore(sightings_, *plane.landmark, middle, second)) {
        return;
      }
      least = distance;
      nearest = &plane;
    });
    if (nearest == nullptr) return;
    pairs->push_back({middle - origin,
                      nearest->landmark->NormalNear(middle),
                      nearest->SignedDistance(middle),
                      nearest->landmark->id});
  }

  const MapState& state_;
  const Sightings& sightings_;
  const std::vector<LandmarkView>& planes_;
  PlanGrid* grid_;
  SharedPoses poses_;
};

}  // namespace

bool RevisitOffset::is_shift() const {
  constexpr double kMaxNear = 0.75;  // in a right map it is 0.85 or more
  const bool is_large = translation_m > kSameSurface || rotation_rad > kMaxTurn;
  return is_large && near_share < kMaxNear && moved_share > near_share + kExceptionShare &&
         (num_surfaces > 1 || rotation_rad < kMaxTurn);
}

std::vector<RevisitOffset> CompareVisits(const Rig& rig,
                                         const MapState& state,
                                         const Sightings& sightings,
                                         int64_t start_ns) {
  std::vector<LandmarkView> planes;
  std::vector<Eigen::AlignedBox2d> boxes;
  for (const Landmark& landmark : state.landmarks) {
    if (landmark.num_segments == 0 || landmark.extent.empty()) continue;
    planes.emplace_back(landmark);
    boxes.push_back(planes.back().PlanBox(kReach));
  }
  const PlanGrid grid(boxes);
  tbb::enumerable_thread_specific<PlanGrid> grids(grid);
  const auto ranges = ObservationsBySecond(start_ns, state);
  std::vector<RevisitOffset> offsets(ranges.size());
  tbb::parallel_for(size_t{0}, ranges.size(), [&](size_t second) {
    VisitComparer comparer(rig, state, sightings, planes, &grids.local());
    offsets[second] = comparer.Compare(static_cast<int>(second), ranges[second]);
  });
  return offsets;
}

}  // namespace plumbline
