#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "core/outputs/floor_plan.h"

namespace plumbline {

// MadeUpRooms is a small result without noise: walls in plan as faces that are seen from their
// left, a floor at 0 and a ceiling at 2.5 m, and beams from places on the rig's way.
class MadeUpRooms {
 public:
  static constexpr double kCeilingM = 2.5;
  static constexpr double kRigM = 1.5;
  static constexpr double kLintelM = 2.1;
  static constexpr double kFloorStddevM = 0.001;
  static constexpr double kWallStddevM = 0.002;  // of d; the angle is exact

  // A face from a to b, open from the floor up to the lintel between two distances from a.
  void AddFace(const Eigen::Vector2d& a,
               const Eigen::Vector2d& b,
               double door_from_m = 0.0,
               double door_to_m = 0.0) {
    Face face;
    face.a = a;
    face.along = (b - a).normalized();
    face.length_m = (b - a).norm();
    face.door_from_m = door_from_m;
    face.door_to_m = door_to_m;
    face.patch.id = static_cast<int>(faces_.size()) + 2;
    face.patch.type = PlaneType::kVertical;
    face.patch.normal = {-face.along.y(), face.along.x(), 0.0};
    face.patch.distance = face.patch.normal.head<2>().dot(a);
    face.patch.centre = {0.5 * (a + b).x(), 0.5 * (a + b).y(), 0.5 * kCeilingM};
    for (const double z : {0.0, kCeilingM}) {
      face.patch.outline.emplace_back(a.x(), a.y(), z);
      face.patch.outline.emplace_back(b.x(), b.y(), z);
    }
    faces_.push_back(face);
  }
  // A face from a to b with a window between two distances from a, from the sill up to the
  // lintel.
  void AddWindow(const Eigen::Vector2d& a,
                 const Eigen::Vector2d& b,
                 double from_m,
                 double to_m,
                 double sill_m) {
    AddFace(a, b, from_m, to_m);
    faces_.back().sill_m = sill_m;
  }
  // The front of a cupboard from a to b, open above its top.
  void AddFront(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double top_m) {
    AddFace(a, b);
    faces_.back().top_m = top_m;
  }
  // The faces of a room between two corners, seen from inside.
  void AddBox(const Eigen::Vector2d& low, const Eigen::Vector2d& high) {
    AddFace(low, {high.x(), low.y()});
    AddFace({high.x(), low.y()}, high);
    AddFace(high, {low.x(), high.y()});
    AddFace({low.x(), high.y()}, low);
  }
  // Beyond these corners there is no ceiling.
  void SetRoof(const Eigen::Vector2d& low, const Eigen::Vector2d& high) {
    roof_ = {low, high};
  }
  // The rig goes straight from each place to the next one.
  void AddWay(const std::vector<Eigen::Vector2d>& places) { way_ = places; }

  FloorPlanInput Input() const {
    FloorPlanInput input;
    input.rig.scanners.resize(1);
    input.rig.scanners[0].range_noise_m = 0.01;
    std::vector<PlanePatch> planes = {Level(0, 0.0, 1.0), Level(1, kCeilingM, -1.0)};
    for (const Face& face : faces_) planes.push_back(face.patch);
    Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(
        2 + 2 * static_cast<int>(faces_.size()), 2 + 2 * static_cast<int>(faces_.size()));
    covariance(0, 0) = covariance(1, 1) = kFloorStddevM * kFloorStddevM;
    for (int i = 0; i < static_cast<int>(faces_.size()); ++i) {
      covariance(3 + 2 * i, 3 + 2 * i) = kWallStddevM * kWallStddevM;
    }
    constexpr double kStepM = 0.25;
    for (size_t i = 0; i + 1 < way_.size(); ++i) {
      const Eigen::Vector2d step = way_[i + 1] - way_[i];
      const int count = std::max(1, static_cast<int>(step.norm() / kStepM));
      for (int k = 0; k < count; ++k) Scan(way_[i] + step * k / count, &input);
    }
    input.planes = PlaneCovariance(planes, covariance);
    return input;
  }

 private:
  struct Face {
    Eigen::Vector2d a;
    Eigen::Vector2d along;
    double length_m = 0.0;
    double door_from_m = 0.0;
    double door_to_m = 0.0;
    double sill_m = 0.0;
    double top_m = kCeilingM;
    PlanePatch patch;
  };

  static PlanePatch Level(int id, double z, double direction) {
    constexpr double kHalfSizeM = 50.0;
    PlanePatch plane;
    plane.id = id;
    plane.type = PlaneType::kHorizontal;
    plane.normal = {0.0, 0.0, direction};
    plane.distance = direction * z;
    plane.centre = {0.0, 0.0, z};
    plane.num_points = 1000;
    for (const auto& [x, y] : {std::pair(-1, -1), {1, -1}, {1, 1}, {-1, 1}}) {
      plane.outline.emplace_back(kHalfSizeM * x, kHalfSizeM * y, z);
    }
    return plane;
  }

  // A turn of level fans, at nine slopes.
  void Scan(const Eigen::Vector2d& at, FloorPlanInput* input) const {
    const int64_t time_ns = static_cast<int64_t>(input->poses.size()) * 100'000'000;
    const Eigen::Vector3d origin(at.x(), at.y(), kRigM);
    input->poses.push_back({time_ns, Rigid3d(Eigen::Quaterniond::Identity(), origin)});
    constexpr int kNumBeams = 720;
    for (int beam = 0; beam < kNumBeams; ++beam) {
      const double turn = 2.0 * M_PI * (beam + 0.5) / kNumBeams;
      for (int slope = -4; slope <= 4; ++slope) {
        const Eigen::Vector3d along(std::cos(turn), std::sin(turn), 0.2 * slope);
        AddPoint(origin, along, static_cast<double>(time_ns) * 1e-9, input);
      }
    }
  }

  void AddPoint(const Eigen::Vector3d& origin,
                const Eigen::Vector3d& along,
                double time_s,
                FloorPlanInput* input) const {
    const double level = along.z() < 0.0 ? 0.0 : kCeilingM;
    double range = along.z() == 0.0 ? std::numeric_limits<double>::max()
                                    : (level - origin.z()) / along.z();
    int plane_id = along.z() < 0.0 ? 0 : 1;
    for (const Face& face : faces_) {
      const double approach = face.patch.normal.dot(along);
      if (std::abs(approach) < 1e-9) continue;
      const double at = -face.patch.SignedDistance(origin) / approach;
      const Eigen::Vector3d p = origin + at * along;
      const double s = face.along.dot(p.head<2>() - face.a);
      const bool in_door = s > face.door_from_m && s < face.door_to_m &&
                           p.z() >= face.sill_m && p.z() < kLintelM;
      if (at <= 0.0 || at >= range || s < 0.0 || s > face.length_m || in_door) continue;
      if (p.z() > face.top_m) continue;
      range = at;
      plane_id = approach < 0.0 ? face.patch.id : -1;  // from behind it is something else
    }
    if (range > 100.0) return;
    const Eigen::Vector3d end = origin + range * along;
    if (plane_id == 1 && !roof_.contains(end.head<2>())) return;
    CloudPoint point;
    point.p_world = end.cast<float>();
    point.time_s = time_s;
    point.plane_id = plane_id;
    if (plane_id < 0) point.residual_m = std::numeric_limits<float>::quiet_NaN();
    input->points.push_back(point);
  }

  std::vector<Face> faces_;
  std::vector<Eigen::Vector2d> way_;
  Eigen::AlignedBox2d roof_{Eigen::Vector2d(-1e3, -1e3), Eigen::Vector2d(1e3, 1e3)};
};

// Two rooms of 4 m x 3 m and 3 m x 3 m with a wall of 0.2 m and a door of 0.9 m between them.
inline FloorPlanInput TwoMadeUpRooms() {
  MadeUpRooms rooms;
  rooms.AddFace({0, 0}, {4, 0});
  rooms.AddFace({4, 0}, {4, 3}, 1.0, 1.9);
  rooms.AddFace({4, 3}, {0, 3});
  rooms.AddFace({0, 3}, {0, 0});
  rooms.AddFace({4.2, 0}, {7.2, 0});
  rooms.AddFace({7.2, 0}, {7.2, 3});
  rooms.AddFace({7.2, 3}, {4.2, 3});
  rooms.AddFace({4.2, 3}, {4.2, 0}, 1.1, 2.0);
  rooms.AddFace({4, 1}, {4.2, 1});  // the jambs
  rooms.AddFace({4.2, 1.9}, {4, 1.9});
  rooms.AddWay({{1, 1}, {2, 1.45}, {6, 1.45}, {6, 2}});
  return rooms.Input();
}

}  // namespace plumbline
