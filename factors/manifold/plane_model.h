#pragma once

#include <Eigen/Core>
#include <cmath>

namespace plumbline {

// Landmarks and how they are parametrised: planes n.x = d, and upright cylinders. A model is a
// struct with the size of its parameter block and a templated Evaluate, which gives the plane:
// of a cylinder, the plane that stands for it near a point.
//
//   kHorizontal  [ d ]          n = sign e_z, sign = +1 (floor) or -1 (ceiling), constant
//   kVertical    [ a, d ]       n = (cos a, sin a, 0), a in rad
//   kGeneral     [ s, t, e ]    n ~ w + s u + t v, n.(x - anchor) = e
//   kCylinder    [ a, k, e ]    n = (cos a, sin a), k / 2 |q - anchor|^2 + n.(q - anchor) = e,
//                               q = (x, y), k in 1/m
//
// A general plane's parameters are coordinates of the unit sphere and the line, about the
// normal w and the point that it was founded with: two slopes and the anchor's distance. All
// three are small, none is redundant, and e does not change where the plane turns about the
// place where it was seen. They reach a quarter turn from w.
//
// A cylinder's left side is its signed distance to first order: its gradient has the length
// sqrt(1 + 2 k e) on the surface, and e, the anchor's own distance, is small. The radius is
// that length over |k|; k is negative where the axis lies on the side that was seen. k = 0 is
// a plane, so that a wall that hardly bends is no special case.
enum class PlaneModel { kHorizontal, kVertical, kGeneral, kCylinder };

// The constant part of a surface's parametrisation.
struct PlaneChart {
  double sign = 1.0;                                   // horizontal planes
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  // general ones: columns u, v, w
  Eigen::Vector3d anchor = Eigen::Vector3d::Zero();    // those and cylinders: world, m
};

struct HorizontalPlane {
  static constexpr int kSize = 1;
  double sign = 1.0;

  template <typename T>
  void Evaluate(const T* params, T normal[3], T* distance) const {
    normal[0] = T(0.0);
    normal[1] = T(0.0);
    normal[2] = T(sign);
    *distance = params[0];
  }
};

struct VerticalPlane {
  static constexpr int kSize = 2;

  template <typename T>
  void Evaluate(const T* params, T normal[3], T* distance) const {
    using std::cos;
    using std::sin;
    normal[0] = cos(params[0]);
    normal[1] = sin(params[0]);
    normal[2] = T(0.0);
    *distance = params[1];
  }
};

struct GeneralPlane {
  static constexpr int kSize = 3;
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  Eigen::Vector3d anchor = Eigen::Vector3d::Zero();

  template <typename T>
  void Evaluate(const T* params, T normal[3], T* distance) const {
    using std::sqrt;
    const T scale = 1.0 / sqrt(1.0 + params[0] * params[0] + params[1] * params[1]);
    *distance = params[2];
    for (int i = 0; i < 3; ++i) {
      normal[i] = scale * (axes(i, 2) + params[0] * axes(i, 0) + params[1] * axes(i, 1));
      *distance += normal[i] * anchor[i];
    }
  }
};

struct Cylinder {
  static constexpr int kSize = 3;
  static constexpr int kCurvatureAt = 1;  // of the parameters
  Eigen::Vector3d anchor = Eigen::Vector3d::Zero();

  // The plane whose signed distance has the value and the gradient of the cylinder's left side
  // at a point: along a vector v from there, the left side grows by n.v + k / 2 |v|^2, the
  // vector seen from above. On the surface it is the tangent plane.
  template <typename T, typename P>
  void EvaluateAt(const T* params, const P* point, T normal[3], T* distance) const {
    using std::cos;
    using std::sin;
    const T x = point[0] - T(anchor[0]);
    const T y = point[1] - T(anchor[1]);
    normal[0] = cos(params[0]);
    normal[1] = sin(params[0]);
    const T value =
        normal[0] * x + normal[1] * y + T(0.5) * params[1] * (x * x + y * y) - params[2];
    normal[0] += params[1] * x;
    normal[1] += params[1] * y;
    normal[2] = T(0.0);
    *distance = normal[0] * point[0] + normal[1] * point[1] - value;
  }
  // Evaluates the cylinder at its anchor.
  template <typename T>
  void Evaluate(const T* params, T normal[3], T* distance) const {
    EvaluateAt(params, anchor.data(), normal, distance);
  }
};

// A surface's plane near a point: of a plane, itself.
template <typename Model, typename T, typename P>
void EvaluateNear(const Model& model, const T* params, const P*, T normal[3], T* distance) {
  model.Evaluate(params, normal, distance);
}
template <typename T, typename P>
void EvaluateNear(
    const Cylinder& cylinder, const T* params, const P* point, T normal[3], T* distance) {
  cylinder.EvaluateAt(params, point, normal, distance);
}

// The curvature, 1/m: of a plane zero.
template <typename Model, typename T>
T CurvatureOf(const Model&, const T*) {
  return T(0.0);
}
template <typename T>
T CurvatureOf(const Cylinder&, const T* params) {
  return params[Cylinder::kCurvatureAt];
}

// Calls visitor with the model's struct and returns what it returns.
template <typename Visitor>
auto VisitPlaneModel(PlaneModel model, const PlaneChart& chart, Visitor&& visitor) {
  switch (model) {
    case PlaneModel::kHorizontal:
      return visitor(HorizontalPlane{chart.sign});
    case PlaneModel::kVertical:
      return visitor(VerticalPlane{});
    case PlaneModel::kCylinder:
      return visitor(Cylinder{chart.anchor});
    case PlaneModel::kGeneral:
      break;
  }
  return visitor(GeneralPlane{chart.axes, chart.anchor});
}

// Number of parameters, each a degree of freedom.
inline int PlaneModelSize(PlaneModel model) {
  return VisitPlaneModel(model, {}, [](const auto& surface) { return surface.kSize; });
}

}  // namespace plumbline
