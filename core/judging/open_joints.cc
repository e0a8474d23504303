#include "core/judging/open_joints.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <deque>
#include <optional>
#include <vector>

#include "core/geometry/matrix_types.h"
#include "core/geometry/unknown_pose.h"
#include "core/judging/degeneracy.h"
#include "core/judging/evidence.h"
#include "core/judging/sightings.h"
#include "core/judging/verdict_levels.h"
#include "core/surface/landmark_view.h"
#include "core/util/time.h"

namespace plumbline {
namespace {

// Standard deviation of the heading by these observations on wide surfaces alone, rad.
double HeadingStddev(const MapState& state,
                     const std::vector<LandmarkView>& views,
                     size_t first,
                     size_t last,
                     SharedPoses* poses) {
  Matrix6d information = Matrix6d::Zero();
  information.diagonal() << Eigen::Vector3d::Constant(1.0 / (kUnknownTurn * kUnknownTurn)),
      Eigen::Vector3d::Constant(1.0 / (kUnknownPosition * kUnknownPosition));
  for (size_t i = first; i < last; ++i) {
    const Observation& observation = state.observations[i];
    if (observation.landmark_id < 0) continue;
    const auto id = static_cast<size_t>(observation.landmark_id);
    if (!IsWide(state.landmarks[id])) continue;
    AddInformation(observation, poses->Of(observation), views[id], &information);
  }
  const Matrix6d covariance = information.ldlt().solve(Matrix6d::Identity());
  return std::sqrt(std::max(0.0, covariance(2, 2)));
}

// In which the heading is open.
struct Stretch {
  int64_t first_ns;
  int64_t last_ns;
};

// Whether walls that were known before the stretch are seen after it: by more than an
// exception of the points there that are on walls. A false heading puts a few of them on one,
// too.
bool IsTied(const Stretch& stretch, const MapState& state) {
  Share unknown;
  for (const Observation& observation : state.observations) {
    if (observation.landmark_id < 0 || observation.middle_time_ns() < stretch.last_ns)
      continue;
    const Landmark& landmark = state.landmarks[static_cast<size_t>(observation.landmark_id)];
    if (!TraitsOf(landmark).has_doorways || !IsWide(landmark)) continue;
    unknown.comparable += observation.num_points;
    if (landmark.first_time_ns > stretch.first_ns)
      unknown.contradicted += observation.num_points;
  }
  return unknown.comparable > 0.0 && unknown.value() < 1.0 - kExceptionShare;
}

}  // namespace

std::vector<bool> FindOpenJoints(const Rig& rig, const MapState& state, int64_t start_ns) {
  const std::deque<Observation>& observations = state.observations;
  std::vector<LandmarkView> views;
  for (const Landmark& landmark : state.landmarks) views.emplace_back(landmark);
  SharedPoses poses(rig, state.trajectory);
  std::vector<bool> is_open;
  const auto mark = [&](const Stretch& stretch) {
    if (IsTied(stretch, state)) return;
    const auto second = static_cast<size_t>(SecondOf(start_ns, stretch.first_ns));
    if (second >= is_open.size()) is_open.resize(second + 1, false);
    is_open[second] = true;
  };
  std::optional<Stretch> open;
  for (size_t first = 0; first < observations.size();) {
    const int64_t first_ns = observations[first].middle_time_ns();
    const int64_t last_ns = first_ns + NanosecondsFromSeconds(kSlipTime);
    size_t last = first;
    while (last < observations.size() && observations[last].middle_time_ns() < last_ns) ++last;
    // Across the narrowest wall the heading then moves what it sees to another surface.
    if (kMaxNarrow * HeadingStddev(state, views, first, last, &poses) > kSameSurface) {
      open = {open ? open->first_ns : first_ns, last_ns};
    } else if (open) {
      mark(*open);
      open.reset();
    }
    first = last;
  }
  if (open) mark(*open);
  return is_open;
}

}  // namespace plumbline
