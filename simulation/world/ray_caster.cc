#include "simulation/world/ray_caster.h"

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>
#include <glog/logging.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace plumbline {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Triangles = std::vector<Kernel::Triangle_3>;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>;
using Traits = CGAL::AABB_traits<Kernel, Primitive>;
using Tree = CGAL::AABB_tree<Traits>;
using TreeNode = CGAL::AABB_node<Traits>;

// Enlargement of boxes (m) and triangles (share of a side), so that no ray slips through
// between two of them.
constexpr double kOverlap = 1e-9;

Kernel::Point_3 ToPoint(const Eigen::Vector3d& p) { return {p.x(), p.y(), p.z()}; }

// A triangle in the form that meets rays fastest.
struct RayTarget {
  Eigen::Vector3d normal;  // and distance: plane of the face
  double distance = 0.0;
  // Barycentric coordinates of p: u = u_axis . p - u_origin, v alike.
  Eigen::Vector3d u_axis, v_axis;
  double u_origin = 0.0;
  double v_origin = 0.0;
  int face_id = 0;
  bool glass = false;
};

RayTarget MakeTarget(const Face& face, const std::array<Eigen::Vector3d, 3>& triangle) {
  RayTarget target;
  target.normal = face.normal;
  target.distance = face.distance;
  if (face.curvature != 0.0) {  // each facet has its own
    const Eigen::Vector3d side = triangle[1] - triangle[0];
    target.normal = side.cross(triangle[2] - triangle[0]).normalized();
    target.distance = target.normal.dot(triangle[0]);
  }
  target.face_id = face.id;
  target.glass = face.glass;
  Eigen::Matrix3d sides;
  sides << triangle[1] - triangle[0], triangle[2] - triangle[0], target.normal;
  const Eigen::Matrix3d dual = sides.inverse();
  target.u_axis = dual.row(0);
  target.v_axis = dual.row(1);
  target.u_origin = target.u_axis.dot(triangle[0]);
  target.v_origin = target.v_axis.dot(triangle[0]);
  return target;
}

struct Ray {
  Eigen::Vector3d origin;
  Eigen::Vector3d direction;
  Eigen::Vector3d inverse_direction;
};

// Visitor for CGAL's traversal: nearer boxes first, and none beyond the best hit. CGAL's own
// first_intersection() computes general intersections and takes three times as long.
class NearestHit {
 public:
  using Priority = double;

  NearestHit(const Triangles& triangles,
             const std::vector<RayTarget>& targets,
             bool through_glass)
      : triangles_(triangles), targets_(targets), through_glass_(through_glass) {}

  bool go_further() const { return true; }

  void intersection(const Ray& ray, const Primitive& primitive) {
    const RayTarget& target =
        targets_[static_cast<size_t>(primitive.id() - triangles_.cbegin())];
    if (target.glass && through_glass_) return;
    const double approach = target.normal.dot(ray.direction);
    if (approach == 0.0) return;
    const double range = (target.distance - target.normal.dot(ray.origin)) / approach;
    if (!(range > 0.0 && range < hit_.range)) return;
    const Eigen::Vector3d p = ray.origin + range * ray.direction;
    const double u = target.u_axis.dot(p) - target.u_origin;
    const double v = target.v_axis.dot(p) - target.v_origin;
    if (u < -kOverlap || v < -kOverlap || u + v > 1 + kOverlap) return;
    hit_ = {range, target.face_id, approach > 0.0, target.glass};
  }

  bool do_intersect(const Ray& ray, const TreeNode& node) const {
    return do_intersect_with_priority(ray, node).first;
  }

  std::pair<bool, double> do_intersect_with_priority(const Ray& ray,
                                                     const TreeNode& node) const {
    const CGAL::Bbox_3& box = node.bbox();
    double begin = 0.0;
    double end = hit_.range;
    for (int axis = 0; axis < 3; ++axis) {
      const double low =
          (box.min(axis) - kOverlap - ray.origin[axis]) * ray.inverse_direction[axis];
      const double high =
          (box.max(axis) + kOverlap - ray.origin[axis]) * ray.inverse_direction[axis];
      begin = std::max(begin, std::min(low, high));
      end = std::min(end, std::max(low, high));
    }
    return {begin <= end, -begin};
  }

  std::optional<RayHit> hit() const {
    if (!std::isfinite(hit_.range)) return std::nullopt;
    return hit_;
  }

 private:
  const Triangles& triangles_;
  const std::vector<RayTarget>& targets_;
  const bool through_glass_;
  RayHit hit_{std::numeric_limits<double>::infinity(), kNoFace, false, false};
};

}  // namespace

struct RayCaster::Impl {
  Triangles triangles;
  std::vector<RayTarget> targets;  // of the triangles
  std::vector<bool> face_is_floor;
  Tree tree;
};

RayCaster::RayCaster(const Building& building) : impl_(std::make_unique<Impl>()) {
  for (const Face& face : building.faces) {
    CHECK_EQ(face.id, static_cast<int>(impl_->face_is_floor.size()));
    impl_->face_is_floor.push_back(face.normal.z() > 0.5);
    for (const auto& triangle : face.triangles) {
      impl_->triangles.emplace_back(
          ToPoint(triangle[0]), ToPoint(triangle[1]), ToPoint(triangle[2]));
      impl_->targets.push_back(MakeTarget(face, triangle));
    }
  }
  impl_->tree.insert(impl_->triangles.cbegin(), impl_->triangles.cend());
  impl_->tree.build();
  impl_->tree.accelerate_distance_queries();
}

RayCaster::~RayCaster() = default;

std::optional<RayHit> RayCaster::Cast(const Eigen::Vector3d& origin_world,
                                      const Eigen::Vector3d& direction_world,
                                      bool through_glass) const {
  // Infinities would give NaN where a ray runs along the side of a box.
  const Ray ray{origin_world, direction_world, direction_world.unaryExpr([](double d) {
                  return 1.0 / (std::abs(d) < 1e-200 ? 1e-200 : d);
                })};
  NearestHit nearest(impl_->triangles, impl_->targets, through_glass);
  impl_->tree.traversal_with_priority(ray, nearest);
  return nearest.hit();
}

double RayCaster::Clearance(const Eigen::Vector3d& p_world) const {
  return std::sqrt(impl_->tree.squared_distance(ToPoint(p_world)));
}

bool RayCaster::IsInFreeSpace(const Eigen::Vector3d& p_world) const {
  const std::optional<RayHit> hit = Cast(p_world, -Eigen::Vector3d::UnitZ());
  return hit && impl_->face_is_floor[static_cast<size_t>(hit->face_id)];
}

}  // namespace plumbline
