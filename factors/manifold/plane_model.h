#pragma once

#include <cmath>

namespace plumbline {

// Landmarks n.x = d and how they are parametrised. A model is a struct with the size of its
// parameter block and a templated Evaluate; a surface that is no plane would bring its own
// factors and leave these alone.
//
//   kHorizontal  [ d ]             n = sign e_z, sign = +1 (floor) or -1 (ceiling), constant
//   kVertical    [ a, d ]          n = (cos a, sin a, 0), a in rad
//   kGeneral     [ nx, ny, nz, d ] |n| = 1, needs CreateGeneralPlaneManifold()
enum class PlaneModel { kHorizontal, kVertical, kGeneral };

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
  static constexpr int kSize = 4;

  template <typename T>
  void Evaluate(const T* params, T normal[3], T* distance) const {
    normal[0] = params[0];
    normal[1] = params[1];
    normal[2] = params[2];
    *distance = params[3];
  }
};

// Calls visitor with the model's struct and returns what it returns.
template <typename Visitor>
auto VisitPlaneModel(PlaneModel model, double sign, Visitor&& visitor) {
  switch (model) {
    case PlaneModel::kHorizontal:
      return visitor(HorizontalPlane{sign});
    case PlaneModel::kVertical:
      return visitor(VerticalPlane{});
    case PlaneModel::kGeneral:
      break;
  }
  return visitor(GeneralPlane{});
}

// Number of parameters.
inline int PlaneModelSize(PlaneModel model) {
  return VisitPlaneModel(model, 1.0, [](const auto& plane) { return plane.kSize; });
}

// Number of degrees of freedom.
inline int PlaneModelTangentSize(PlaneModel model) {
  return model == PlaneModel::kGeneral ? 3 : PlaneModelSize(model);
}

}  // namespace plumbline
