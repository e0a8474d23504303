#pragma once

#include <Eigen/Core>
#include <cmath>

namespace plumbline {

// Landmarks n.x = d and how they are parametrised. A model is a struct with the size of its
// parameter block and a templated Evaluate; a surface that is no plane would bring its own
// factors and leave these alone.
//
//   kHorizontal  [ d ]          n = sign e_z, sign = +1 (floor) or -1 (ceiling), constant
//   kVertical    [ a, d ]       n = (cos a, sin a, 0), a in rad
//   kGeneral     [ s, t, e ]    n ~ w + s u + t v, n.(x - anchor) = e
//
// A general plane's parameters are coordinates of the unit sphere and the line, about the
// normal w and the point that it was founded with: two slopes and the anchor's distance. All
// three are small, none is redundant, and e does not change where the plane turns about the
// place where it was seen. They reach a quarter turn from w.
enum class PlaneModel { kHorizontal, kVertical, kGeneral };

// What of a plane's parameters is constant.
struct PlaneChart {
  double sign = 1.0;                                   // horizontal planes
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  // general ones: columns u, v, w
  Eigen::Vector3d anchor = Eigen::Vector3d::Zero();    // world, m
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

// Calls visitor with the model's struct and returns what it returns.
template <typename Visitor>
auto VisitPlaneModel(PlaneModel model, const PlaneChart& chart, Visitor&& visitor) {
  switch (model) {
    case PlaneModel::kHorizontal:
      return visitor(HorizontalPlane{chart.sign});
    case PlaneModel::kVertical:
      return visitor(VerticalPlane{});
    case PlaneModel::kGeneral:
      break;
  }
  return visitor(GeneralPlane{chart.axes, chart.anchor});
}

// Number of parameters, each a degree of freedom.
inline int PlaneModelSize(PlaneModel model) {
  switch (model) {
    case PlaneModel::kHorizontal:
      return HorizontalPlane::kSize;
    case PlaneModel::kVertical:
      return VerticalPlane::kSize;
    case PlaneModel::kGeneral:
      break;
  }
  return GeneralPlane::kSize;
}

}  // namespace plumbline
