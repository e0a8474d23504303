#include "simulation/world/furniture.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "simulation/world/building.h"

namespace plumbline {
namespace {

constexpr double kBoard = 0.03;         // m, thickness of tables and shelves
constexpr double kLeg = 0.05;           // m, width of a table's leg
constexpr double kBoardDistance = 0.4;  // m, between the boards of a shelf

// A box in the frame of its piece: origin in the middle of its floor, x along its length.
struct Box {
  Eigen::Vector3d low;
  Eigen::Vector3d high;
};

std::vector<Box> BoxesOf(const Furniture& piece) {
  const Eigen::Vector3d half(piece.size.x() / 2, piece.size.y() / 2, 0.0);
  const double top = piece.size.z();
  if (piece.kind == Furniture::Kind::kBox) return {{-half, {half.x(), half.y(), top}}};
  std::vector<Box> boxes;
  if (piece.kind == Furniture::Kind::kTable) {
    boxes.push_back({{-half.x(), -half.y(), top - kBoard}, {half.x(), half.y(), top}});
    for (const double x : {-half.x(), half.x() - kLeg}) {
      for (const double y : {-half.y(), half.y() - kLeg}) {
        boxes.push_back({{x, y, 0.0}, {x + kLeg, y + kLeg, top - kBoard}});
      }
    }
    return boxes;
  }
  for (const double x : {-half.x(), half.x() - kBoard}) {
    boxes.push_back({{x, -half.y(), 0.0}, {x + kBoard, half.y(), top}});
  }
  const int num_gaps = std::max(1, static_cast<int>(std::lround(top / kBoardDistance)));
  for (int i = 0; i <= num_gaps; ++i) {
    const double bottom = i * (top - kBoard) / num_gaps;
    boxes.push_back({{-half.x() + kBoard, -half.y(), bottom},
                     {half.x() - kBoard, half.y(), bottom + kBoard}});
  }
  return boxes;
}

void AddBox(const Box& box, const Furniture& piece, double floor, std::vector<Face>* faces) {
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(piece.yaw_rad, Eigen::Vector3d::UnitZ()));
  const Eigen::Vector3d origin(piece.position.x(), piece.position.y(), floor + piece.bottom_m);
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {-1.0, 1.0}) {
      // u, v and the outward normal are right-handed.
      const int u = (axis + (sign > 0 ? 1 : 2)) % 3;
      const int v = (axis + (sign > 0 ? 2 : 1)) % 3;
      Eigen::Vector3d corner = box.low;
      if (sign > 0) corner[axis] = box.high[axis];
      Face& face = faces->emplace_back();
      face.id = static_cast<int>(faces->size()) - 1;
      face.type = axis == 2 ? PlaneType::kHorizontal : PlaneType::kVertical;
      face.glass = piece.glass;
      face.normal = turn * (sign * Eigen::Vector3d::Unit(axis));
      for (const auto& [at_u, at_v] :
           {std::pair(false, false), {true, false}, {true, true}, {false, true}}) {
        corner[u] = at_u ? box.high[u] : box.low[u];
        corner[v] = at_v ? box.high[v] : box.low[v];
        face.outline.push_back(origin + turn * corner);
      }
      face.distance = face.normal.dot(face.outline.front());
      face.triangles = {{face.outline[0], face.outline[1], face.outline[2]},
                        {face.outline[0], face.outline[2], face.outline[3]}};
    }
  }
}

}  // namespace

void AddFurniture(const Furniture& piece, double floor_height, std::vector<Face>* faces) {
  for (const Box& box : BoxesOf(piece)) AddBox(box, piece, floor_height, faces);
}

}  // namespace plumbline
