#include "core/association/plane_merging.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/association/association.h"
#include "core/association/surface_levels.h"
#include "core/sensor/rig.h"
#include "core/surface/patch_extent.h"
#include "core/util/quantiles.h"

namespace plumbline {
namespace {

// The normals of planes that face the same side have at least this cosine.
constexpr double kMinFacingCosine = 0.8;

// The variance of the distance between two surfaces at a point, along a normal.
double DistanceVariance(const Landmark& a,
                        const Landmark& b,
                        const Eigen::Vector3d& point,
                        const Eigen::Vector3d& normal) {
  const Eigen::RowVector3d by_a = a.DeviationJacobian(point, normal).row(0);
  const Eigen::RowVector3d by_b = b.DeviationJacobian(point, normal).row(0);
  return by_a.dot(by_a * a.covariance) + by_b.dot(by_b * b.covariance);
}

// Whether two surfaces do not differ significantly at a point, given that variance.
bool MeetAt(const Landmark& a,
            const Landmark& b,
            const Eigen::Vector3d& point,
            double variance,
            const AssociationOptions& options) {
  const double flatness2 = options.surface_flatness_m * options.surface_flatness_m;
  const double difference = a.SignedDistance(point) - b.SignedDistance(point);
  return difference * difference <=
         TwoDegreesQuantile(options.significance) * (variance + 2.0 * flatness2);
}

// Tells whether two surfaces of one kind are one: what each kind answers is an overload.
struct SurfacePair {
  const Landmark& a;
  const Landmark& b;  // the smaller one
  double range_noise_m;
  const AssociationOptions& options;

  bool AreOne() const {
    // Cheap first: the patches' cells are looked at last.
    return a.extent.MayBeNear(b.extent, options.max_gap_m) &&
           VisitPlaneModel(a.model, a.chart, [&](const auto& kind) { return Agree(kind); }) &&
           a.extent.IsNear(b.extent, options.max_gap_m);
  }

 private:
  // Whether they agree in position and direction where b was seen.
  bool Agree(const HorizontalPlane&) const {
    const Eigen::Vector2d size = b.extent.max_corner() - b.extent.min_corner();
    return AgreeAlong(size.x() > size.y());
  }
  bool Agree(const VerticalPlane&) const { return AgreeAlong(true); }
  // Two slopes may meet in a line along one side.
  bool Agree(const GeneralPlane&) const { return AgreeAlong(true) && AgreeAlong(false); }
  // What agrees at three points of an arc has one direction there.
  bool Agree(const Cylinder&) const {
    const std::vector<Eigen::Vector3d> points = ComparedPoints(b.extent);
    return std::all_of(points.begin(), points.end(), [&](const Eigen::Vector3d& p) {
      const Eigen::Vector3d normal = b.NormalNear(p);
      if (a.NormalNear(p).dot(normal) < kMinFacingCosine) return false;
      const double variance = DistanceVariance(a, b, p, normal);
      return variance <= range_noise_m * range_noise_m && MeetAt(a, b, p, variance, options);
    });
  }
  // Whether planes agree at the middle of b, along one of its sides.
  bool AgreeAlong(bool along_u) const;
};

bool SurfacePair::AgreeAlong(bool along_u) const {
  const PatchExtent& extent = b.extent;
  const Eigen::Vector2d size = extent.max_corner() - extent.min_corner();
  const Eigen::Vector2d middle = 0.5 * (extent.max_corner() + extent.min_corner());
  const Eigen::Vector3d direction = along_u ? extent.axes().u : extent.axes().v;
  const Eigen::Vector3d on_axes = extent.ToWorld(middle);
  const Eigen::Vector3d point = on_axes - b.SignedDistance(on_axes) * b.Normal();
  const Eigen::Vector2d difference(a.SignedDistance(point),
                                   a.Normal().dot(direction) - b.Normal().dot(direction));
  const Eigen::Matrix<double, 2, 3> by_a = a.DeviationJacobian(point, direction);
  const Eigen::Matrix<double, 2, 3> by_b = b.DeviationJacobian(point, direction);
  const Eigen::Matrix2d covariance =
      by_a * a.covariance * by_a.transpose() + by_b * b.covariance * by_b.transpose();
  if (covariance(0, 0) > range_noise_m * range_noise_m) return false;
  const Eigen::Matrix2d total =
      covariance +
      2.0 * FlatnessCovariance(along_u ? size.x() : size.y(), options.surface_flatness_m);
  return difference.dot(total.inverse() * difference) <
         TwoDegreesQuantile(options.significance);
}

// A landmark that is compared with others.
struct Compared {
  const Landmark* landmark;
  Eigen::Vector3d normal;
  bool is_recent;  // seen since the scan in question

  // Whether they are of one kind and may face the same side: cylinders face many.
  bool MayBeOne(const Compared& other) const {
    return landmark->model == other.landmark->model &&
           (normal.dot(other.normal) >= kMinFacingCosine || landmark->IsCurved());
  }
};

// Points of a patch on its surface, across it from side to side.
std::array<Eigen::Vector3d, 5> PointsAcross(const Landmark& landmark) {
  const Eigen::Vector2d low = landmark.extent.min_corner();
  const Eigen::Vector2d size = landmark.extent.max_corner() - low;
  std::array<Eigen::Vector3d, 5> points;
  for (size_t i = 0; i < points.size(); ++i) {
    const double share = static_cast<double>(i) / (points.size() - 1);
    const Eigen::Vector3d on_axes = landmark.extent.ToWorld(low + share * size);
    points[i] = on_axes - landmark.SignedDistance(on_axes) * landmark.NormalNear(on_axes);
  }
  return points;
}

}  // namespace

std::vector<std::pair<int, int>> FindMergeable(const Rig& rig,
                                               const MapState& state,
                                               const MapperOptions& options,
                                               int since_scan) {
  const double range_noise_m = MaxRangeNoise(rig);
  std::vector<std::pair<int, int>> pairs;
  std::vector<Compared> all;
  std::vector<Compared> recent;
  for (const Landmark& landmark : state.landmarks) {
    if (landmark.num_segments == 0) continue;
    all.push_back({&landmark, landmark.Normal(), landmark.last_scan >= since_scan});
    if (all.back().is_recent) recent.push_back(all.back());
  }
  for (const Compared& newer_at : all) {
    const Landmark& newer = *newer_at.landmark;
    for (const Compared& older_at : newer_at.is_recent ? all : recent) {
      const Landmark& older = *older_at.landmark;
      if (older.id >= newer.id) break;
      if (!older_at.MayBeOne(newer_at)) continue;
      if (!IsWithinGap(older, newer.first_scan, options.loop_closure)) continue;
      const bool newer_is_smaller = newer.extent.area_m2() < older.extent.area_m2();
      const SurfacePair pair{newer_is_smaller ? older : newer,
                             newer_is_smaller ? newer : older,
                             range_noise_m,
                             options.association};
      if (pair.AreOne()) {
        pairs.emplace_back(older.id, newer.id);
        break;
      }
    }
  }
  return pairs;
}

bool IsRedundant(const Landmark& weak, const Landmark& strong, double range_noise_m) {
  constexpr double kMinOverlap = 0.5;  // of the weak one's cells
  // A strip of a roof that level traces show looks like a wall's: it repeats the roof, too.
  // So does a chord of an arc.
  const bool may_be_piece = weak.model != strong.model && TraitsOf(strong).has_soft_edges;
  const Eigen::Vector3d& anchor = weak.extent.axes().anchor;
  if (!may_be_piece &&
      weak.NormalNear(anchor).dot(strong.NormalNear(anchor)) < kMinFacingCosine) {
    return false;
  }
  const std::array<Eigen::Vector3d, 5> points = PointsAcross(weak);
  double sum_squares = 0.0;
  for (const Eigen::Vector3d& point : points) {
    const double distance = strong.SignedDistance(point);
    sum_squares += distance * distance;
  }
  // Single ranges do not tell planes apart that are nearer than this.
  const double limit = kOutlierSigmas * range_noise_m;
  return sum_squares < static_cast<double>(points.size()) * limit * limit &&
         weak.extent.OverlapWith(strong.extent) > kMinOverlap;
}

bool Meet(const Landmark& weak, const Landmark& strong, const AssociationOptions& options) {
  const std::array<Eigen::Vector3d, 5> points = PointsAcross(weak);
  return std::any_of(points.begin(), points.end(), [&](const Eigen::Vector3d& point) {
    const double variance =
        DistanceVariance(weak, strong, point, weak.NormalNear(point).normalized());
    return MeetAt(weak, strong, point, variance, options);
  });
}

void MergeInto(int into_id, int from_id, MapState* state) {
  Landmark& into = state->landmarks[static_cast<size_t>(into_id)];
  Landmark& from = state->landmarks[static_cast<size_t>(from_id)];
  // It has no observations before its first scan.
  auto observation = std::partition_point(
      state->observations.begin(), state->observations.end(), [&](const Observation& earlier) {
        return earlier.scan_index < from.first_scan;
      });
  for (; observation != state->observations.end(); ++observation) {
    if (observation->landmark_id == from_id) observation->landmark_id = into_id;
  }
  into.extent.Merge(from.extent);
  into.first_scan = std::min(into.first_scan, from.first_scan);
  into.last_scan = std::max(into.last_scan, from.last_scan);
  into.first_time_ns = std::min(into.first_time_ns, from.first_time_ns);
  into.last_time_ns = std::max(into.last_time_ns, from.last_time_ns);
  into.num_segments += from.num_segments;
  into.num_points += from.num_points;
  into.sum_deviations += from.sum_deviations;
  into.num_judged += from.num_judged;
  from.num_segments = 0;
  from.num_points = 0;
  from.extent = from.EmptyExtent();
}

}  // namespace plumbline
