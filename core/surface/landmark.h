#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "core/geometry/plane_tangents.h"
#include "core/geometry/rigid3.h"
#include "core/surface/patch_extent.h"
#include "factors/manifold/plane_model.h"

namespace plumbline {

// Planes whose normals' cosine is larger form no corner: where they intersect is hardly known.
inline constexpr double kMaxCornerCosine = 0.7;

// The squared deviation of a segment from its plane that is expected where the noise is as
// stated: it has two degrees of freedom.
inline constexpr double kExpectedDeviation = 2.0;

// A surface of the building that is being estimated, and what is known of it: a plane, or an
// upright cylinder.
struct Landmark {
  int id = 0;
  PlaneModel model = PlaneModel::kVertical;
  PlaneChart chart;
  std::array<double, 3> parameters = {};  // see factors/manifold/plane_model.h
  bool heading_fixed = false;             // the gauge's wall: its angle is not estimated
  PatchExtent extent;
  // The covariance of the parameters, given the rig's current pose, as association tests need
  // it; rows beyond num_parameters() are zero.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  int first_scan = 0;
  int last_scan = 0;
  int64_t first_time_ns = 0;
  int64_t last_time_ns = 0;
  int num_segments = 0;
  int64_t num_points = 0;
  // The sum of the squared deviations of the first segments that were found on the plane, each
  // over its variance as stated then, with two degrees of freedom; and their number.
  double sum_deviations = 0.0;
  int num_judged = 0;

  // Whether the deviations of enough segments are known.
  bool IsJudged() const;
  // Takes in the deviation of one more segment.
  void Judge(double squared_deviation) {
    sum_deviations += squared_deviation;
    ++num_judged;
  }
  // Whether the mean of the deviations is at most this, where kExpectedDeviation is expected.
  // An oblique false plane across a corner, which short segments suggest, lies elsewhere as
  // soon as the rig does.
  bool AgreesWithin(double mean_deviation) const;
  // An empty extent with its axes on the surface as it is estimated now.
  PatchExtent EmptyExtent() const;
  // How wide what has been seen of it is, m: along the floor, of what is level across its
  // shorter side.
  double Width() const;
  int num_parameters() const { return PlaneModelSize(model); }
  bool IsCurved() const { return model == PlaneModel::kCylinder; }
  // Curvature of a cylinder, 1/m, negative if the axis lies on the side that was seen; else 0.
  double Curvature() const {
    return VisitPlaneModel(
        model, chart, [&](const auto& kind) { return CurvatureOf(kind, parameters.data()); });
  }
  // The unit normal and the distance d of n.x = d; of a cylinder, of the plane that stands for
  // it near a point (factors/manifold/plane_model.h).
  Eigen::Vector4d PlaneNear(const Eigen::Vector3d& p_world) const;
  // Normal and distance of a plane; of a cylinder at its chart's anchor.
  Eigen::Vector4d Plane() const { return PlaneNear(chart.anchor); }
  Eigen::Vector3d Normal() const { return Plane().head<3>(); }
  Eigen::Vector3d NormalNear(const Eigen::Vector3d& p_world) const {
    return PlaneNear(p_world).head<3>();
  }
  double Distance() const { return Plane()[3]; }
  // Signed distance; of a cylinder to first order, with the right sign everywhere.
  double SignedDistance(const Eigen::Vector3d& p_world) const {
    const Eigen::Vector4d plane = PlaneNear(p_world);
    return plane.head<3>().dot(p_world) - plane[3];
  }
  // The derivative of n.p - d (at a point, per metre along a direction) by the parameters;
  // columns beyond num_parameters() are zero.
  Eigen::Matrix<double, 2, 3> DeviationJacobian(const Eigen::Vector3d& p_world,
                                                const Eigen::Vector3d& direction_world) const;
  // Two unit vectors along it where this is its normal: of floors and ceilings alike x and y.
  Eigen::Matrix<double, 3, 2> Tangents(const Eigen::Vector3d& normal) const {
    return PlaneTangents(chart.sign * normal);
  }
  // Takes it to another frame, which is turned about the vertical; its extent gets axes there,
  // and is empty.
  void Move(const Rigid3d& to_from);
  // Its parameters for an origin at this point of the floor plan, and the derivative of the
  // parameters by those. Charts with an anchor do not change.
  Eigen::Vector3d ParametersAbout(const Eigen::Vector2d& origin) const;
  Eigen::Matrix3d ByParametersAbout(const Eigen::Vector2d& origin) const;
  // Becomes the surface that another landmark is; what was seen of it stays.
  void TakeShapeOf(const Landmark& other);
  // Sets the parameters to those of a plane of its model, n.x = d. CHECKs that it is one.
  void SetPlane(const Eigen::Vector3d& normal, double distance);
  // The derivatives of the normal (rows 0 to 2) and the distance of PlaneNear by the
  // parameters; columns beyond num_parameters() are zero.
  Eigen::Matrix<double, 4, 3> PlaneByParameters(const Eigen::Vector3d& p_world) const;
  Eigen::Matrix<double, 4, 3> PlaneByParameters() const {
    return PlaneByParameters(chart.anchor);
  }

 private:
  Eigen::Vector3d AlongDistance() const;
};

// What a surface is to those that look at it, by its kind.
struct SurfaceTraits {
  // It is one straight line on the floor plan, whose heading is its first parameter: the gauge
  // may hold it, whole turns do not change it, and a row of such lines may be chords of an
  // arc.
  bool has_heading = false;
  // Walls stand on it or end at it, and hide what lies behind them.
  bool goes_on_behind_walls = false;
  // Floors and ceilings end at it, or go on behind it unseen.
  bool bounds_floors = false;
  // Its gaps are doors and windows, through which beams are seen to pass. A floor's are where
  // something stands on it, those of slopes and arcs are not told apart.
  bool has_doorways = false;
  // Other surfaces go over into it without a clear edge, a floor into a ramp, a wall into an
  // arc, and pieces of it pass for them: strips of a slope for walls, chords for planes.
  bool has_soft_edges = false;
  // A trace along it, where a scan plane hardly cuts it, looks like a trace of a wall.
  bool passes_for_wall = false;
  // Its segments may show that it is an arc, or how much of one.
  bool may_bend = false;
};
SurfaceTraits TraitsOf(const Landmark& landmark);

// A horizontal landmark through a point; sign +1 seen from above.
Landmark MakeHorizontalLandmark(double sign, const Eigen::Vector3d& p_world);
// A general landmark through a point, which is the anchor of its chart.
Landmark MakeGeneralLandmark(const Eigen::Vector3d& normal_world,
                             const Eigen::Vector3d& p_world);
// A cylinder through a point, which is the anchor of its chart, with its normal there.
Landmark MakeCylinderLandmark(const Eigen::Vector3d& normal_world,
                              double curvature,
                              const Eigen::Vector3d& p_world);
// A vertical landmark through a point with the given horizontal normal.
Landmark MakeVerticalLandmark(const Eigen::Vector3d& normal_world,
                              const Eigen::Vector3d& p_world);

}  // namespace plumbline
