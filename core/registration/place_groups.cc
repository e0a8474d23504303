#include "core/registration/place_groups.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <set>
#include <utility>

#include "core/util/quantiles.h"

namespace plumbline {
namespace {

// Says which closures agree with each other.
class Agreement {
 public:
  Agreement(const std::vector<PoseGraphEdge>& closures,
            const std::vector<PoseGraphEdge>& motion)
      : closures_(closures), poses_(1), drift_(1) {
    for (const PoseGraphEdge& edge : motion) {
      poses_.push_back(poses_.back() * edge.from_from_to);
      const Eigen::Matrix3d covariance = edge.information.inverse();
      drift_.push_back({drift_.back().position + covariance(0, 0),
                        drift_.back().heading + covariance(2, 2)});
    }
    for (const PoseGraphEdge& closure : closures) {
      const Eigen::Matrix3d covariance = closure.information.inverse();
      errors_.push_back({covariance.topLeftCorner<2, 2>().trace(), covariance(2, 2)});
    }
    const size_t size = closures.size();
    agree_.assign(size, std::vector<bool>(size, true));
    for (size_t a = 0; a < size; ++a) {
      for (size_t b = 0; b < a; ++b) agree_[a][b] = agree_[b][a] = Test(a, b);
    }
  }

  bool operator()(size_t a, size_t b) const { return agree_[a][b]; }

 private:
  // Variances of position (m^2) and heading (rad^2).
  struct Variances {
    double position = 0.0;
    double heading = 0.0;
  };

  // Of the motion between two visits.
  Variances DriftBetween(size_t a, size_t b) const {
    const double heading = std::abs(drift_[b].heading - drift_[a].heading);
    const Eigen::Vector2d way = poses_[b].position - poses_[a].position;
    return {std::abs(drift_[b].position - drift_[a].position) + heading * way.squaredNorm(),
            heading};
  }

  bool Test(size_t a, size_t b) const {
    const PoseGraphEdge& first = closures_[a];
    const PoseGraphEdge& second = closures_[b];
    const auto motion = [this](size_t from, size_t to) {
      return poses_[from].Inverse() * poses_[to];
    };
    const PlanarPose by_first = first.from_from_to * motion(first.to, second.to);
    const PlanarPose by_second = motion(first.from, second.from) * second.from_from_to;
    const PlanarPose off = by_second.Inverse() * by_first;
    const Variances of_earlier = DriftBetween(first.from, second.from);
    const Variances of_later = DriftBetween(first.to, second.to);
    const double heading =
        of_earlier.heading + of_later.heading + errors_[a].heading + errors_[b].heading;
    const double position =
        of_earlier.position + of_later.position + errors_[a].position + errors_[b].position;
    const double turn = std::remainder(off.heading, 2.0 * M_PI);
    return off.position.squaredNorm() / position + turn * turn / heading <
           kSignificantStddevs * kSignificantStddevs;
  }

  const std::vector<PoseGraphEdge>& closures_;
  std::vector<PlanarPose> poses_;  // of the visits by the motion
  std::vector<Variances> drift_;   // from the first visit to each
  std::vector<Variances> errors_;  // of the closures
  std::vector<std::vector<bool>> agree_;
};

using Indices = std::vector<size_t>;  // of closures

// How many visits were found again: each counts once.
size_t NumVisits(const Indices& group, const std::vector<PoseGraphEdge>& closures) {
  std::set<size_t> visits;
  for (const size_t i : group) visits.insert(closures[i].to);
  return visits.size();
}

// The largest group of those left that one of them can be the first of, by taking in what
// agrees with all so far.
Indices LargestGroup(const Indices& left,
                     const std::vector<PoseGraphEdge>& closures,
                     const Agreement& agree) {
  Indices largest;
  for (const size_t first : left) {
    Indices group = {first};
    for (const size_t other : left) {
      if (other != first && std::all_of(group.begin(), group.end(), [&](size_t member) {
            return agree(member, other);
          })) {
        group.push_back(other);
      }
    }
    if (NumVisits(group, closures) > NumVisits(largest, closures)) largest = std::move(group);
  }
  return largest;
}

}  // namespace

std::vector<PlaceGroup> ConsistentGroups(const std::vector<PoseGraphEdge>& closures,
                                         const std::vector<PoseGraphEdge>& motion,
                                         const std::vector<Visit>& visits,
                                         double min_way_m) {
  const Agreement agree(closures, motion);
  const auto way_of = [&](const Indices& group, size_t PoseGraphEdge::*end) {
    const auto [least, most] =
        std::minmax_element(group.begin(), group.end(), [&](size_t a, size_t b) {
          return closures[a].*end < closures[b].*end;
        });
    return visits[closures[*most].*end].way_m - visits[closures[*least].*end].way_m;
  };
  Indices left;
  for (size_t i = 0; i < closures.size(); ++i) left.push_back(i);
  std::vector<Indices> found;
  while (!left.empty()) {
    Indices group = LargestGroup(left, closures, agree);
    if (way_of(group, &PoseGraphEdge::to) < min_way_m) break;
    const auto is_taken = [&](size_t i) {
      return std::find(group.begin(), group.end(), i) != group.end();
    };
    left.erase(std::remove_if(left.begin(), left.end(), is_taken), left.end());
    found.push_back(std::move(group));
  }
  // What is left may still contradict.
  for (const size_t i : left) found.push_back({i});
  const auto is_refused = [&](const Indices& group) {
    if (way_of(group, &PoseGraphEdge::to) < min_way_m ||
        way_of(group, &PoseGraphEdge::from) < min_way_m) {
      return true;
    }
    size_t num_against = 0;
    for (const Indices& rival : found) {
      if (&rival == &group) continue;
      Indices against;
      for (const size_t other : rival) {
        // A rival speaks of the same stretch, and contradicts.
        const bool contradicts = std::any_of(group.begin(), group.end(), [&](size_t member) {
          const double apart_m =
              visits[closures[member].to].way_m - visits[closures[other].to].way_m;
          return std::abs(apart_m) < min_way_m && !agree(member, other);
        });
        if (contradicts) against.push_back(other);
      }
      num_against = std::max(num_against, NumVisits(against, closures));
    }
    return 4 * num_against > NumVisits(group, closures);
  };
  std::vector<PlaceGroup> groups;
  for (const Indices& group : found) {
    if (is_refused(group)) continue;
    PlaceGroup& kept = groups.emplace_back();
    for (const size_t i : group) kept.push_back(closures[i]);
  }
  return groups;
}

}  // namespace plumbline
