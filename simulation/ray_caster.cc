#include "simulation/ray_caster.h"

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>
#include <glog/logging.h>

#include <cmath>
#include <vector>

namespace plumbline {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Triangles = std::vector<Kernel::Triangle_3>;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;

Kernel::Point_3 ToPoint(const Eigen::Vector3d& p) { return {p.x(), p.y(), p.z()}; }

struct PlaneOfFace {
  Eigen::Vector3d normal;
  double distance;
};

}  // namespace

struct RayCaster::Impl {
  Triangles triangles;
  std::vector<int> face_ids;        // of the triangles
  std::vector<PlaneOfFace> planes;  // of the faces
  Tree tree;
};

RayCaster::RayCaster(const Building& building) : impl_(std::make_unique<Impl>()) {
  for (const Face& face : building.faces) {
    CHECK_EQ(face.id, static_cast<int>(impl_->planes.size()));
    impl_->planes.push_back({face.normal, face.distance});
    for (const auto& [a, b, c] : face.triangles) {
      impl_->triangles.emplace_back(ToPoint(a), ToPoint(b), ToPoint(c));
      impl_->face_ids.push_back(face.id);
    }
  }
  impl_->tree.insert(impl_->triangles.begin(), impl_->triangles.end());
  impl_->tree.build();
  impl_->tree.accelerate_distance_queries();
}

RayCaster::~RayCaster() = default;

std::optional<RayHit> RayCaster::Cast(const Eigen::Vector3d& origin_world,
                                      const Eigen::Vector3d& direction_world) const {
  const Kernel::Vector_3 direction(
      direction_world.x(), direction_world.y(), direction_world.z());
  const auto hit =
      impl_->tree.first_intersected_primitive(Kernel::Ray_3(ToPoint(origin_world), direction));
  if (!hit) return std::nullopt;
  const auto triangle = static_cast<size_t>(*hit - impl_->triangles.cbegin());
  // The range comes from the face's plane, not from the rounded triangle.
  const int face_id = impl_->face_ids[triangle];
  const PlaneOfFace& plane = impl_->planes[static_cast<size_t>(face_id)];
  const double approach = plane.normal.dot(direction_world);
  if (approach == 0.0) return std::nullopt;  // the ray lies in the plane
  return RayHit{(plane.distance - plane.normal.dot(origin_world)) / approach, face_id};
}

double RayCaster::Clearance(const Eigen::Vector3d& p_world) const {
  return std::sqrt(impl_->tree.squared_distance(ToPoint(p_world)));
}

bool RayCaster::IsInFreeSpace(const Eigen::Vector3d& p_world) const {
  const std::optional<RayHit> hit = Cast(p_world, -Eigen::Vector3d::UnitZ());
  return hit && impl_->planes[static_cast<size_t>(hit->face_id)].normal.z() > 0.5;
}

}  // namespace plumbline
