#include "core/consistency/mounting.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/geometry/plan_grid.h"
#include "core/map/landmark_view.h"
#include "core/util/time.h"

namespace plumbline {
namespace {

using Vector7d = Eigen::Matrix<double, 7, 1>;  // rotation, translation, time
using Matrix7d = Eigen::Matrix<double, 7, 7>;

constexpr double kReach = 0.5;         // m, between a segment and the plane it may lie on
constexpr double kRobustScale = 0.05;  // m, of Cauchy's loss
constexpr double kOnPlane = 0.03;      // m
constexpr double kMinLength = 0.3;     // m
const double kMaxSlope = std::sin(12.0 * M_PI / 180.0);  // between segment and plane
// The other scanners have seen a plane well if they have so many segments on it.
constexpr int kMinOthers = 20;
constexpr int kMinSegments = 100;
// So many segments of a scanner say all that is to be known; more would cost time.
constexpr size_t kMaxSegments = 20000;
constexpr int kIterations = 6;
// Standard deviations of the prior about what the rig file says: they hold what is open.
constexpr double kPriorTurn = 0.2;   // rad
constexpr double kPriorShift = 0.2;  // m
constexpr double kPriorTime = 0.1;   // s
// Smaller errors are those of a rig measured by hand.
constexpr double kNamedTurn = 0.5 * M_PI / 180.0;
constexpr double kNamedShift = 0.03;  // m
constexpr double kNamedTime = 0.004;  // s

// A segment against a plane: distance and its derivative by the correction.
struct Row {
  Vector7d jacobian;
  double distance_m;
};

Vector7d Fit(const std::vector<Row>& rows, bool planar) {
  Vector7d prior;
  prior << Eigen::Vector3d::Constant(1.0 / (kPriorTurn * kPriorTurn)),
      Eigen::Vector3d::Constant(1.0 / (kPriorShift * kPriorShift)),
      1.0 / (kPriorTime * kPriorTime);
  if (planar) {
    constexpr double kHeld = 1e12;
    for (const int held : {0, 1, 5}) prior(held) += kHeld;
  }
  Vector7d correction = Vector7d::Zero();
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    Matrix7d normal_matrix = prior.asDiagonal();
    Vector7d right = Vector7d::Zero();
    for (const Row& row : rows) {
      const double left = row.distance_m + row.jacobian.dot(correction);
      const double scaled = left / kRobustScale;
      const double weight = 1.0 / ((1.0 + scaled * scaled) * kRobustScale * kRobustScale);
      normal_matrix += weight * row.jacobian * row.jacobian.transpose();
      right -= weight * row.distance_m * row.jacobian;
    }
    correction = normal_matrix.ldlt().solve(right);
  }
  return correction;
}

// Finds the planes of the others for the segments of one scanner.
class MountingComparer {
 public:
  // num_segments: by landmark, by scanner.
  MountingComparer(const Rig& rig,
                   const MapState& state,
                   const std::vector<std::vector<int>>& num_segments,
                   int scanner_index)
      : state_(state),
        scanner_index_(scanner_index),
        poses_(rig, state.trajectory),
        grid_(PlanesOfOthers(num_segments)) {}

  MountingError Compare(bool planar, size_t stride) {
    size_t number = 0;
    for (const Observation& observation : state_.observations) {
      if (observation.scanner_index != scanner_index_) continue;
      if (observation.length_m() < kMinLength || number++ % stride != 0) continue;
      Add(observation);
    }
    MountingError error;
    error.num_segments = static_cast<int>(rows_.size());
    if (error.num_segments < kMinSegments) return error;
    const Vector7d correction = Fit(rows_, planar);
    error.rotation_rad = correction.head<3>();
    error.translation_m = correction.segment<3>(3);
    error.time_offset_s = correction(6);
    int num_near = 0;
    int num_moved = 0;
    for (const Row& row : rows_) {
      const double moved = row.distance_m + row.jacobian.dot(correction);
      num_near += std::abs(row.distance_m) < kOnPlane ? 1 : 0;
      num_moved += std::abs(moved) < kOnPlane ? 1 : 0;
    }
    error.near_share = static_cast<double>(num_near) / error.num_segments;
    error.moved_share = static_cast<double>(num_moved) / error.num_segments;
    return error;
  }

 private:
  std::vector<Eigen::AlignedBox2d> PlanesOfOthers(
      const std::vector<std::vector<int>>& num_segments) {
    std::vector<Eigen::AlignedBox2d> boxes;
    for (const Landmark& landmark : state_.landmarks) {
      if (landmark.num_segments == 0 || landmark.extent.empty()) continue;
      const std::vector<int>& counts = num_segments[static_cast<size_t>(landmark.id)];
      int others = 0;
      for (size_t i = 0; i < counts.size(); ++i) {
        if (static_cast<int>(i) != scanner_index_) others += counts[i];
      }
      if (others < kMinOthers) continue;
      planes_.emplace_back(landmark);
      const LandmarkView& plane = planes_.back();
      Eigen::AlignedBox2d box;
      for (const double u : {-1.0, 1.0}) {
        for (const double v : {-1.0, 1.0}) {
          box.extend(Eigen::Vector2d(
              (plane.centre_world + u * plane.half_u + v * plane.half_v).head<2>()));
        }
      }
      const Eigen::Vector2d rim = Eigen::Vector2d::Constant(kReach);
      boxes.emplace_back(box.min() - rim, box.max() + rim);
    }
    return boxes;
  }

  // The nearest plane of the others that the segment may lie on.
  const LandmarkView* PlaneOf(const PlacedSegment& segment) {
    const Eigen::Vector3d middle = segment.At(0.5);
    const Eigen::Vector3d along = (segment.end_world - segment.start_world).normalized();
    const LandmarkView* nearest = nullptr;
    double least = kReach;
    grid_.ForEachNear(middle.head<2>(), middle.head<2>(), [&](int index) {
      const LandmarkView& plane = planes_[static_cast<size_t>(index)];
      const double distance = std::abs(plane.SignedDistance(middle));
      if (distance >= least || std::abs(plane.Near(middle).normal.dot(along)) > kMaxSlope ||
          plane.SignedDistance(segment.scanner_world) < 0.0 ||
          !plane.landmark->extent.IsSeenAt(middle, 0.0)) {
        return;
      }
      least = distance;
      nearest = &plane;
    });
    return nearest;
  }

  void Add(const Observation& observation) {
    const PlacedSegment segment = Place(observation, state_.landmarks, &poses_);
    const LandmarkView* plane = PlaneOf(segment);
    if (plane == nullptr) return;
    const LandmarkView near = plane->Near(segment.At(0.5));
    const ObservationPoses& poses = poses_.Of(observation);
    const Eigen::Vector2d middle = 0.5 * (observation.start() + observation.end());
    const Eigen::Vector3d p_scanner(middle.x(), middle.y(), 0.0);
    const Eigen::Vector3d normal_scanner =
        poses.world_from_scanner.rotation.conjugate() * near.normal;
    Row row;
    row.distance_m = plane->SignedDistance(segment.At(0.5));
    row.jacobian.head<3>() = p_scanner.cross(normal_scanner);
    row.jacobian.segment<3>(3) = normal_scanner;
    row.jacobian(6) = RateOf(observation, middle, near);
    rows_.push_back(row);
  }

  // The rate at which the point's distance from the plane changes when its instant does, m/s.
  double RateOf(const Observation& observation,
                const Eigen::Vector2d& p_scanner,
                const LandmarkView& plane) {
    constexpr int64_t kStep = 1'000'000;  // ns
    const int64_t now_ns = observation.middle_time_ns();
    const ScanMotion& motion = poses_.Of(observation).motion;
    const Eigen::Vector3d moved =
        motion.ToWorld(p_scanner, now_ns + kStep) - motion.ToWorld(p_scanner, now_ns - kStep);
    return plane.normal.dot(moved) / SecondsBetween(now_ns - kStep, now_ns + kStep);
  }

  const MapState& state_;
  int scanner_index_;
  SharedPoses poses_;
  std::vector<LandmarkView> planes_;
  PlanGrid grid_;  // of the planes
  std::vector<Row> rows_;
};

}  // namespace

std::vector<MountingError> CompareMountings(const Rig& rig,
                                            bool planar,
                                            const MapState& state) {
  const size_t num_scanners = rig.scanners.size();
  std::vector<MountingError> errors(num_scanners);
  if (num_scanners < 2) return errors;
  std::vector<std::vector<int>> num_segments(state.landmarks.size(),
                                             std::vector<int>(num_scanners, 0));
  std::vector<size_t> num_long(num_scanners, 0);
  for (const Observation& observation : state.observations) {
    const auto scanner = static_cast<size_t>(observation.scanner_index);
    if (observation.length_m() >= kMinLength) ++num_long[scanner];
    if (observation.landmark_id < 0) continue;
    ++num_segments[static_cast<size_t>(observation.landmark_id)][scanner];
  }
  for (size_t i = 0; i < num_scanners; ++i) {
    MountingComparer comparer(rig, state, num_segments, static_cast<int>(i));
    errors[i] = comparer.Compare(planar, 1 + num_long[i] / kMaxSegments);
  }
  return errors;
}

std::string MountingInWords(const MountingError& error) {
  std::string words;
  const auto add = [&words](const char* format, double value) {
    char text[60];
    std::snprintf(text, sizeof(text), format, value);
    words += (words.empty() ? "" : ", ") + std::string(text);
  };
  const double turn = error.rotation_rad.norm();
  const double shift = error.translation_m.norm();
  if (turn > kNamedTurn) add("turned by %.1f deg", turn * 180.0 / M_PI);
  if (shift > kNamedShift) add("shifted by %.0f mm", 1e3 * shift);
  if (std::abs(error.time_offset_s) > kNamedTime) {
    add("its clock off by %.0f ms", 1e3 * error.time_offset_s);
  }
  return words;
}

}  // namespace plumbline
