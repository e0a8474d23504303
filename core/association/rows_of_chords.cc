#include "core/association/rows_of_chords.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "core/association/bend_test.h"
#include "core/association/surface_levels.h"
#include "core/geometry/angles.h"
#include "core/map/observation_poses.h"
#include "core/surface/landmark_view.h"

namespace plumbline {
namespace {

constexpr double kMaxWidth = 5.0;    // m, of a chord that does not show its own bow
constexpr double kMaxBetween = 0.3;  // m
// From one chord to the next.
constexpr double kMinTurn = 2.0 * kRadiansPerDegree;
constexpr double kMaxTurn = 60.0 * kRadiansPerDegree;
constexpr int kMaxIterations = 6;

// A segment with the poses that it was seen from.
struct Seen {
  const Observation* observation;
  ObservationPoses poses;
};

struct Circle {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  double radius = 0.0;
};

// The circle whose power is least at the points (Kasa 1976).
std::optional<Circle> CircleThrough(const std::vector<Eigen::Vector2d>& points) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& p : points) mean += p / static_cast<double>(points.size());
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (const Eigen::Vector2d& point : points) {
    const Eigen::Vector2d p = point - mean;
    const Eigen::Vector3d row(p.x(), p.y(), 1.0);
    normal += row * row.transpose();
    right += row * p.squaredNorm();
  }
  const Eigen::FullPivLU<Eigen::Matrix3d> solver(normal);
  if (!solver.isInvertible()) return std::nullopt;
  const Eigen::Vector3d solution = solver.solve(right);
  const double radius2 = solution.z() + 0.25 * solution.head<2>().squaredNorm();
  if (!(radius2 > 0.0)) return std::nullopt;
  return Circle{mean + 0.5 * solution.head<2>(), std::sqrt(radius2)};
}

// The cylinder through all ends and middles, whose normal is about that of a chord.
std::optional<Landmark> FirstCylinder(const std::vector<Seen>& seen, const Landmark& chord) {
  std::vector<Eigen::Vector2d> points;
  for (const Seen& one : seen) {
    const Observation& observation = *one.observation;
    const ScanMotion& motion = one.poses.motion;
    points.push_back(
        motion.ToWorld(observation.start(), observation.start_time_ns()).head<2>());
    points.push_back(
        motion.ToWorld(observation.centroid(), observation.middle_time_ns()).head<2>());
    points.push_back(motion.ToWorld(observation.end(), observation.end_time_ns()).head<2>());
  }
  const std::optional<Circle> circle = CircleThrough(points);
  if (!circle || circle->radius < kMinRadius || circle->radius > kMaxRadius) {
    return std::nullopt;
  }
  const Eigen::Vector3d at = chord.extent.Centre();
  const Eigen::Vector2d outwards = (at.head<2>() - circle->centre).normalized();
  const double side = outwards.dot(chord.Normal().head<2>()) < 0.0 ? -1.0 : 1.0;
  Eigen::Vector3d anchor;
  anchor << circle->centre + circle->radius * outwards, at.z();
  return MakeCylinderLandmark(
      {side * outwards.x(), side * outwards.y(), 0.0}, side / circle->radius, anchor);
}

struct Fit {
  Landmark cylinder;
  double mean_chi2 = 0.0;
};

std::optional<Fit> FitCylinder(const std::vector<Seen>& seen,
                               const Landmark& chord,
                               double flatness_m) {
  const std::optional<Landmark> first = FirstCylinder(seen, chord);
  if (!first) return std::nullopt;
  Fit fit{*first};
  for (int iteration = 0; iteration <= kMaxIterations; ++iteration) {
    const LandmarkView view(fit.cylinder);
    CylinderEquations equations;
    for (const Seen& one : seen) {
      equations.Add(*one.observation, one.poses, view, Eigen::Matrix2d::Zero(), flatness_m);
    }
    const std::optional<CylinderEquations::Solution> solution = equations.Solve();
    if (!solution) return std::nullopt;
    for (size_t i = 0; i < 3; ++i) {
      fit.cylinder.parameters[i] += solution->step[static_cast<Eigen::Index>(i)];
    }
    fit.cylinder.covariance = solution->covariance;
    fit.mean_chi2 = solution->mean_chi2;
  }
  const double curvature = std::abs(fit.cylinder.Curvature());
  const bool is_bent = curvature * kMaxRadius > 1.0 && curvature * kMinRadius < 1.0;
  return is_bent ? std::make_optional(fit) : std::nullopt;
}

bool IsGood(const Fit& fit) {
  return fit.mean_chi2 < kMaxMeanChi2 &&
         std::abs(fit.cylinder.Curvature()) >
             kCurvatureSigmas * std::sqrt(fit.cylinder.covariance(Cylinder::kCurvatureAt,
                                                                  Cylinder::kCurvatureAt));
}

bool FollowEachOther(const Landmark& a, const Landmark& b) {
  const double cosine = a.Normal().dot(b.Normal());
  return cosine < std::cos(kMinTurn) && cosine > std::cos(kMaxTurn) &&
         (a.extent.IsNear(b.extent, kMaxBetween) || b.extent.IsNear(a.extent, kMaxBetween));
}

class RowFinder {
 public:
  RowFinder(const Rig& rig, const AssociationOptions& options, const MapState& state)
      : options_(options), state_(state) {
    for (const Landmark& landmark : state.landmarks) {
      if (TraitsOf(landmark).has_heading && !landmark.heading_fixed &&
          landmark.num_segments > 0 && landmark.Width() < kMaxWidth) {
        chords_[landmark.id];
      }
    }
    std::vector<int> num_met(state.landmarks.size(), 0);
    SharedPoses poses(rig, state.trajectory);
    for (const Observation& observation : state.observations) {
      const auto chord = chords_.find(observation.landmark_id);
      if (chord == chords_.end()) continue;
      const auto id = static_cast<size_t>(chord->first);
      if (num_met[id]++ % (1 + state.landmarks[id].num_segments / kFittedSegments) != 0)
        continue;
      chord->second.push_back({&observation, poses.Of(observation)});
    }
  }

  std::vector<RowOfChords> Find() {
    std::vector<RowOfChords> rows;
    while (!chords_.empty()) {
      std::vector<int> row = {chords_.begin()->first};
      std::vector<Seen> seen = chords_.begin()->second;
      chords_.erase(chords_.begin());
      std::optional<Fit> fit;
      while (const std::optional<int> next = Next(row, seen, &fit)) {
        row.push_back(*next);
        for (const Seen& one : chords_.at(*next)) seen.push_back(one);
        chords_.erase(*next);
      }
      if (static_cast<int>(row.size()) < kMinWitnesses || !fit || !IsGood(*fit)) continue;
      rows.push_back({row, fit->cylinder});
    }
    return rows;
  }

 private:
  const Landmark& At(int id) const { return state_.landmarks[static_cast<size_t>(id)]; }

  // A chord beside the row that one cylinder explains together with it.
  std::optional<int> Next(const std::vector<int>& row,
                          const std::vector<Seen>& seen,
                          std::optional<Fit>* fit) const {
    for (const auto& [id, more] : chords_) {
      const Landmark& candidate = At(id);
      if (std::none_of(row.begin(), row.end(), [&](int one) {
            return FollowEachOther(At(one), candidate);
          })) {
        continue;
      }
      std::vector<Seen> together = seen;
      for (const Seen& one : more) together.push_back(one);
      const std::optional<Fit> found =
          FitCylinder(together, At(row.front()), options_.surface_flatness_m);
      if (!found || found->mean_chi2 > kMaxMeanChi2) continue;
      *fit = found;
      return id;
    }
    return std::nullopt;
  }

  const AssociationOptions& options_;
  const MapState& state_;
  std::map<int, std::vector<Seen>> chords_;  // not in a row yet, by id
};

}  // namespace

std::vector<RowOfChords> FindRowsOfChords(const Rig& rig,
                                          const AssociationOptions& options,
                                          const MapState& state) {
  return RowFinder(rig, options, state).Find();
}

}  // namespace plumbline
