#include "core/batch/batch_policies.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <numeric>
#include <optional>

#include "core/association/association.h"
#include "core/association/bend_test.h"
#include "core/association/plane_kind.h"
#include "core/association/plane_merging.h"
#include "core/association/plane_through_lines.h"
#include "core/association/rows_of_chords.h"
#include "core/association/seen_together.h"
#include "core/association/surface_levels.h"
#include "core/batch/visit_levels.h"
#include "core/geometry/angles.h"
#include "core/geometry/matrix_types.h"
#include "core/map/observation_poses.h"
#include "core/surface/landmark_view.h"
#include "core/visibility/free_space.h"

namespace plumbline {
namespace {

// A plane's points in sub-minimum segments are at most this many times those in segments. For
// a plane the ratio is below one half; for the underside of a door's lintel, which is mostly
// edges, it is three halves.
constexpr int64_t kMaxSubMinimumRatio = 3;
// A plane's segments deviate by at most this many times what is expected: furniture's, on a
// real robot, by two and a half.
constexpr double kMaxDeviationRatio = 3.0;
// The normal of a general plane is known to this by its own segments, and is theirs.
constexpr double kMaxNormalSigma = 2.0 * kRadiansPerDegree;

// Whether an observation is the only one of its landmark where it lies.
bool IsAlone(const Observation& observation,
             const ObservationPoses& poses,
             double max_gap_m,
             const MapState& state) {
  const Landmark& landmark = state.landmarks[static_cast<size_t>(observation.landmark_id)];
  return !landmark.extent.OthersAreNear(
      poses.motion.ToWorld(observation.start(), observation.start_time_ns()),
      poses.motion.ToWorld(observation.end(), observation.end_time_ns()),
      max_gap_m);
}

// The landmarks that observations of a scan may lie on, scan by scan in the order of time.
class ViewsOfScans {
 public:
  ViewsOfScans(const Rig& rig, const MapperOptions& options, const MapState& state)
      : rig_(rig), options_(options), state_(state) {}

  // The views for the scan of an observation; poses: the observation's. Valid until the next
  // call.
  const std::vector<LandmarkView>& Of(size_t observation_index,
                                      const ObservationPoses& poses,
                                      const Matrix6d& pose_covariance) {
    const int scan_index = state_.observations[observation_index].scan_index;
    if (scan_index == scan_index_) return of_scan_;
    if (scan_index_ < 0 || !options_.loop_closure.enabled) {
      within_gap_ = ViewsWithinGap(state_.landmarks, scan_index, options_.loop_closure);
    }
    scan_index_ = scan_index;
    of_scan_ = ViewsWithin(ReachOfScan(rig_,
                                       state_.observations,
                                       observation_index,
                                       poses.world_from_body.translation,
                                       pose_covariance,
                                       options_.association),
                           within_gap_);
    return of_scan_;
  }

 private:
  const Rig& rig_;
  const MapperOptions& options_;
  const MapState& state_;
  int scan_index_ = -1;
  std::vector<LandmarkView> within_gap_;
  std::vector<LandmarkView> of_scan_;
};

}  // namespace

int Reassociate(const Rig& rig,
                const MapperOptions& options,
                const PoseCovarianceAt& pose_covariance,
                MapState* state) {
  int num_changed = 0;
  SharedPoses shared_poses(rig, state->trajectory);
  ViewsOfScans views(rig, options, *state);
  int scan_index = -1;
  Matrix6d of_pose = Matrix6d::Zero();
  for (size_t i = 0; i < state->observations.size(); ++i) {
    Observation& observation = state->observations[i];
    const ObservationPoses& poses = shared_poses.Of(observation);
    if (observation.scan_index != scan_index) {
      scan_index = observation.scan_index;
      of_pose = pose_covariance(observation.middle_time_ns());
    }
    const std::vector<LandmarkView>& of_scan = views.Of(i, poses, of_pose);
    if (observation.num_points == 0) continue;  // all of its beams are left out
    int id = FindLandmark(observation, poses, of_pose, of_scan, options.association);
    if (id >= 0 && id == observation.landmark_id &&
        IsAlone(observation, poses, options.association.max_gap_m, *state)) {
      id = -1;
    }
    num_changed += id != observation.landmark_id ? 1 : 0;
    observation.landmark_id = id;
  }
  return num_changed;
}

std::vector<int> MergePlanes(const Rig& rig,
                             const MapperOptions& options,
                             const std::set<std::pair<int, int>>& apart,
                             MapState* state) {
  std::vector<int> merged_into;
  // A landmark that was itself merged away passes its share on.
  std::vector<int> target(state->landmarks.size());
  std::iota(target.begin(), target.end(), 0);
  for (const auto& [into, from] : FindMergeable(rig, *state, options, 0)) {
    const int end = target[static_cast<size_t>(into)];
    if (apart.count({into, from}) > 0 || apart.count({end, from}) > 0) continue;
    const Landmark& a =
        state->landmarks[static_cast<size_t>(end)];  // has the segments of into
    const Landmark& b = state->landmarks[static_cast<size_t>(from)];
    if (LieApart(rig, *state, a, b, options.association.surface_flatness_m)) continue;
    target[static_cast<size_t>(from)] = end;
    MergeInto(end, from, state);
    merged_into.push_back(end);
  }
  return merged_into;
}

int DropContradictedPlanes(MapState* state) {
  double sum = 0.0;
  int num_judged = 0;
  for (const Landmark& landmark : state->landmarks) {
    sum += landmark.sum_deviations;
    num_judged += landmark.num_judged;
  }
  const double expected = std::max(kExpectedDeviation, sum / std::max(1, num_judged));
  std::vector<bool> is_contradicted;
  for (const Landmark& landmark : state->landmarks) {
    is_contradicted.push_back(!landmark.AgreesWithin(kMaxDeviationRatio * expected));
  }
  return ReleaseObservations(is_contradicted, state);
}

int DropRedundantPlanes(const Rig& rig,
                        const MapperOptions& options,
                        const std::set<std::pair<int, int>>& apart,
                        MapState* state) {
  const double range_noise_m = MaxRangeNoise(rig);
  std::vector<bool> is_redundant;
  for (const Landmark& weak : state->landmarks) {
    const auto is_repeated_by = [&](const Landmark& strong) {
      return weak.num_points > 0 && weak.num_points < strong.num_points &&
             IsWithinGap(strong, weak.first_scan, options.loop_closure) &&
             apart.count(std::minmax(weak.id, strong.id)) == 0 &&
             IsRedundant(weak, strong, range_noise_m) &&
             Meet(weak, strong, options.association);
    };
    is_redundant.push_back(
        std::any_of(state->landmarks.begin(), state->landmarks.end(), is_repeated_by));
  }
  return ReleaseObservations(is_redundant, state);
}

int DropPassedThrough(const Rig& rig, MapState* state) {
  return ReleaseObservations(FindPassedThrough(rig, *state), state);
}

int DecideGeneralPlanes(const Rig& rig, const AssociationOptions& options, MapState* state) {
  std::map<int, PlaneThroughLines> lines;
  SharedPoses poses(rig, state->trajectory);
  for (const Observation& observation : state->observations) {
    if (observation.landmark_id < 0) continue;
    const Landmark& landmark = state->landmarks[static_cast<size_t>(observation.landmark_id)];
    if (landmark.model != PlaneModel::kGeneral) continue;
    lines[landmark.id].Add(MeasureLine(
        observation, poses.Of(observation), Matrix6d::Zero(), options.surface_flatness_m));
  }
  std::vector<bool> is_none(state->landmarks.size(), false);
  std::vector<bool> is_changed(state->landmarks.size(), false);
  for (const auto& [id, of_plane] : lines) {
    Landmark& landmark = state->landmarks[static_cast<size_t>(id)];
    const PlaneThroughLines::Fit fit = of_plane.Solve();
    if (fit.normal_covariance.trace() > kMaxNormalSigma * kMaxNormalSigma ||
        std::abs(fit.normal.dot(landmark.Normal())) < kSameNormalCosine) {
      is_none[static_cast<size_t>(id)] = true;
      continue;
    }
    const std::optional<Landmark> decided =
        DecideKind(fit, fit.centre_world + landmark.Normal());
    if (!decided || decided->model == landmark.model) continue;
    landmark.TakeShapeOf(*decided);
    is_changed[static_cast<size_t>(id)] = true;
  }
  RebuildLandmarks(rig, is_changed, state);
  return ReleaseObservations(is_none, state);
}

int BendWalls(const Rig& rig, const AssociationOptions& options, MapState* state) {
  std::vector<BendTest> tests;
  for (const Landmark& wall : state->landmarks) {
    tests.emplace_back(wall, options.surface_flatness_m, MaxRangeNoise(rig));
  }
  std::vector<int> num_met(state->landmarks.size(), 0);
  SharedPoses poses(rig, state->trajectory);
  for (const Observation& observation : state->observations) {
    if (observation.landmark_id < 0) continue;
    const auto id = static_cast<size_t>(observation.landmark_id);
    const Landmark& wall = state->landmarks[id];
    if (!MayBend(wall)) continue;
    const int step = 1 + wall.num_segments / kFittedSegments;
    if (num_met[id]++ % step != 0) continue;
    tests[id].Add(observation, poses.Of(observation), Matrix6d::Zero());
  }
  std::vector<bool> is_changed(state->landmarks.size(), false);
  int num_changed = 0;
  for (Landmark& wall : state->landmarks) {
    if (num_met[static_cast<size_t>(wall.id)] == 0) continue;
    std::optional<Landmark> shape = tests[static_cast<size_t>(wall.id)].Solve();
    if (!shape) {
      const Eigen::Vector3d centre = wall.extent.Centre();
      shape = MakeVerticalLandmark(wall.NormalNear(centre).normalized(), centre);
    }
    if (shape->model == wall.model) continue;
    VLOG(1) << "wall " << wall.id << " of " << wall.num_segments << " segments, "
            << wall.Width() << " m wide: curvature " << wall.Curvature() << " -> "
            << shape->Curvature() << " 1/m";
    wall.TakeShapeOf(*shape);
    is_changed[static_cast<size_t>(wall.id)] = true;
    num_changed += wall.num_segments;
  }
  RebuildLandmarks(rig, is_changed, state);
  return num_changed;
}

int BendRowsOfChords(const Rig& rig, const AssociationOptions& options, MapState* state) {
  int num_changed = 0;
  std::vector<bool> is_changed(state->landmarks.size(), false);
  for (const RowOfChords& row : FindRowsOfChords(rig, options, *state)) {
    const int into = *std::min_element(row.landmarks.begin(), row.landmarks.end());
    for (const int id : row.landmarks) {
      num_changed += state->landmarks[static_cast<size_t>(id)].num_segments;
      if (id != into) MergeInto(into, id, state);
    }
    state->landmarks[static_cast<size_t>(into)].TakeShapeOf(row.cylinder);
    is_changed[static_cast<size_t>(into)] = true;
  }
  RebuildLandmarks(rig, is_changed, state);
  return num_changed;
}

int DropWeakPlanes(const PlaneOptions& options, MapState* state) {
  std::vector<int> num_scans(state->landmarks.size(), 0);
  std::vector<int> last_scan(state->landmarks.size(), -1);
  for (const Observation& observation : state->observations) {
    if (observation.landmark_id < 0) continue;
    // Resegmentation may leave a segment a single beam, which says nothing of a direction.
    if (observation.num_points < 2) continue;
    const auto id = static_cast<size_t>(observation.landmark_id);
    if (observation.scan_index != last_scan[id]) ++num_scans[id];
    last_scan[id] = observation.scan_index;
  }
  std::vector<bool> is_weak;
  for (const int num : num_scans) is_weak.push_back(num < options.min_scans);
  return ReleaseObservations(is_weak, state);
}

int DropPlanesWithoutLines(MapState* state) {
  std::vector<bool> has_none(state->landmarks.size(), true);
  for (const Observation& observation : state->observations) {
    if (observation.landmark_id < 0 || observation.num_points < 2) continue;
    has_none[static_cast<size_t>(observation.landmark_id)] = false;
  }
  return ReleaseObservations(has_none, state);
}

int DropVanishedCylinders(MapState* state) {
  std::vector<bool> has_vanished;
  for (const Landmark& landmark : state->landmarks) {
    // The square of the radius, in units of that at the anchor.
    const double square = 1.0 + 2.0 * landmark.Curvature() * landmark.parameters[2];
    has_vanished.push_back(landmark.num_segments > 0 && !(square > 0.0));
  }
  return ReleaseObservations(has_vanished, state);
}

int DropObliqueFalsePlanes(MapState* state) {
  std::vector<int64_t> in_segments(state->landmarks.size(), 0);
  std::vector<int64_t> in_sub_minimum(state->landmarks.size(), 0);
  for (const Observation& observation : state->observations) {
    if (observation.landmark_id < 0) continue;
    in_segments[static_cast<size_t>(observation.landmark_id)] += observation.num_points;
  }
  for (const Observation& segment : state->sub_minimum_segments) {
    in_sub_minimum[static_cast<size_t>(segment.landmark_id)] += segment.num_points;
  }
  std::vector<bool> is_false;
  for (size_t i = 0; i < in_segments.size(); ++i) {
    is_false.push_back(in_sub_minimum[i] > kMaxSubMinimumRatio * in_segments[i]);
  }
  return ReleaseObservations(is_false, state);
}

}  // namespace plumbline
