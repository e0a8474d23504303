// How the tracker associates a scan's segments with planes.

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/association/joint_association.h"
#include "core/following/tracker.h"
#include "core/surface/landmark_view.h"

namespace plumbline {
namespace {

// A segment that knows its direction to no better than this (a right angle is five of them)
// may lie on a wall or across it. Where nothing else is in sight, as in a doorway, its plane
// would decide where the rig is.
constexpr double kMaxDirectionSigma = 0.3;  // rad

bool TellsDirection(const Observation& observation) {
  return observation.sigma_direction_rad < kMaxDirectionSigma;
}

// How strongly the rig may have accelerated since the last scan, in multiples of
// Tracker::UnsteadyScale, and how often to expect it. Tried in turn as long as what has been
// found explains less than max_length_share of the scan's segments (by length), and believed
// from min_length_share on.
struct MotionRegime {
  double scale;
  double share;
  double max_length_share;
  double min_length_share;
};
constexpr MotionRegime kMotionRegimes[] = {
    {0.0, 1.0, 1.0, 0.0},    // steady
    {1.0, 1e-3, 0.8, 0.0},   // a turn sets in
    {10.0, 1e-5, 0.5, 0.5},  // a jolt
};

}  // namespace

Tracker::Association Tracker::AssociateJointly(int first_observation,
                                               int last_observation,
                                               const LandmarksWithinGap& landmarks,
                                               bool by_points) const {
  std::vector<int> order;
  const auto at = [&](int index) -> const Observation& {
    return state_->observations[static_cast<size_t>(index)];
  };
  for (int index = first_observation; index <= last_observation; ++index) {
    if (TellsDirection(at(index))) order.push_back(index);
  }
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return at(a).length_m() > at(b).length_m();
  });
  double total_length = 0.0;
  for (const int index : order) total_length += at(index).length_m();
  Association best;
  double best_cost = std::numeric_limits<double>::infinity();
  for (const MotionRegime& regime : kMotionRegimes) {
    // The likelier explanation of the scan wins; once one leaves little over, there is no need
    // for the wilder ones.
    if (best.length_m >= regime.max_length_share * total_length) break;
    // The points have shown how the rig moved.
    if (by_points && regime.scale > 0.0) break;
    Association association =
        ChooseUnder(by_points ? PointsCovariance()
                              : UnsteadyCovariance(regime.scale * UnsteadyScale(), scan_s_),
                    order,
                    landmarks);
    if (association.length_m < regime.min_length_share * total_length) continue;
    const double cost = association.cost - 2.0 * std::log(regime.share);
    if (cost >= best_cost) continue;
    best_cost = cost;
    best = std::move(association);
    best.unsteady = regime.scale > 0.0;
  }
  return best;
}

std::vector<LandmarkView> Tracker::OfScan(int first_observation,
                                          const Matrix6d& pose_covariance,
                                          const LandmarksWithinGap& landmarks) const {
  const auto first = static_cast<size_t>(first_observation);
  const int64_t time_ns = state_->observations[first].middle_time_ns();
  return ViewsWithin(ReachOfScan(rig_,
                                 state_->observations,
                                 first,
                                 state_->trajectory.WorldFromBody(time_ns).translation,
                                 pose_covariance,
                                 options_.association),
                     landmarks);
}

Tracker::Association Tracker::ChooseUnder(const Matrix6d& unsteady,
                                          const std::vector<int>& observations,
                                          const LandmarksWithinGap& landmarks) const {
  const auto at = [&](int index) -> const Observation& {
    return state_->observations[static_cast<size_t>(index)];
  };
  if (observations.empty()) return {};
  int64_t begin_ns = std::numeric_limits<int64_t>::max();
  int64_t end_ns = std::numeric_limits<int64_t>::min();
  for (const int index : observations) {
    begin_ns = std::min(begin_ns, at(index).middle_time_ns());
    end_ns = std::max(end_ns, at(index).middle_time_ns());
  }
  MotionCovariance covariance = pose_uncertainty_.AtBoth(state_->trajectory, begin_ns, end_ns);
  // What the control points can not follow is the same all through the scan.
  covariance += unsteady.replicate<2, 2>();
  // The poses pass linearly between both ends: neither is less certain than these together.
  const std::vector<LandmarkView> near =
      OfScan(*std::min_element(observations.begin(), observations.end()),
             covariance.topLeftCorner<6, 6>() + covariance.bottomRightCorner<6, 6>(),
             landmarks);
  std::vector<JointHypothesis> hypotheses;
  int num_paired = 0;
  SharedPoses poses(rig_, state_->trajectory);
  for (const int index : observations) {
    const Observation& observation = at(index);
    const double share = end_ns > begin_ns
                             ? static_cast<double>(observation.middle_time_ns() - begin_ns) /
                                   static_cast<double>(end_ns - begin_ns)
                             : 0.0;
    const Eigen::Matrix<double, 6, 12> by_motion = PoseByMotion(share);
    const Matrix6d of_scanner = ScannerCovariance(rig_, *state_, observation);
    const size_t num_before = hypotheses.size();
    for (const Hypothesis& possible :
         HypothesesOf(observation,
                      poses.Of(observation),
                      PoseCovariance(covariance, share) + of_scanner,
                      near,
                      options_.association)) {
      hypotheses.push_back({index,
                            possible.id,
                            possible.deviation.value,
                            possible.noise + possible.deviation.by_pose * of_scanner *
                                                 possible.deviation.by_pose.transpose(),
                            possible.deviation.by_pose.lazyProduct(by_motion)});
    }
    if (hypotheses.size() > num_before) ++num_paired;
  }
  const JointChoice choice = ChooseJointly(hypotheses, covariance, options_.association);
  Association association;
  // Observations without any pairing are clutter too.
  association.cost = choice.cost + ClutterCost(options_.association) *
                                       (static_cast<int>(observations.size()) - num_paired);
  for (const size_t i : choice.hypotheses) {
    const int index = hypotheses[i].observation_index;
    association.chosen.emplace_back(index, hypotheses[i].landmark_id);
    association.length_m += state_->observations[static_cast<size_t>(index)].length_m();
  }
  return association;
}

bool Tracker::Associate(int first_observation,
                        int last_observation,
                        const LandmarksWithinGap& landmarks) {
  bool changed = false;
  if (first_observation > last_observation) return changed;
  const auto covariance_at = [&](int index) {
    const Observation& observation = state_->observations[static_cast<size_t>(index)];
    return pose_uncertainty_.At(state_->trajectory, observation.middle_time_ns());
  };
  const std::vector<LandmarkView> near =
      OfScan(first_observation,
             covariance_at(first_observation) + covariance_at(last_observation),
             landmarks);
  SharedPoses shared(rig_, state_->trajectory);
  int64_t middle_ns = 0;
  Matrix6d covariance = Matrix6d::Zero();  // of the pose then
  for (int index = first_observation; index <= last_observation; ++index) {
    Observation& observation = state_->observations[static_cast<size_t>(index)];
    const ObservationPoses& poses = shared.Of(observation);
    if (poses.times_ns[1] != middle_ns) {
      middle_ns = poses.times_ns[1];
      covariance = pose_uncertainty_.At(state_->trajectory, middle_ns);
    }
    const int id =
        TellsDirection(observation)
            ? FindLandmark(observation,
                           poses,
                           covariance + ScannerCovariance(rig_, *state_, observation),
                           near,
                           options_.association)
            : -1;
    changed |= id != observation.landmark_id;
    observation.landmark_id = id;
  }
  return changed;
}

}  // namespace plumbline
