#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/result/result_types.h"

namespace plumbline {

// Names of a plane's parameters in plane_covariance.csv: "angle", "d". Throws Error for
// general planes, which have no covariance yet.
std::vector<std::string> ParameterNames(const PlanePatch& plane);

// Joint covariance of a result's planes, and the standard deviations of what people measure in
// a map. Parameters of a plane n.x = d: horizontal [ d ], vertical [ angle, d ] with n = (cos
// angle, sin angle, 0), in rad and m of the model frame.
class PlaneCovariance {
 public:
  PlaneCovariance() = default;
  // covariance: of the parameters of the planes, in their order. CHECKs its size.
  PlaneCovariance(std::vector<PlanePatch> planes, Eigen::MatrixXd covariance);

  const std::vector<PlanePatch>& planes() const { return planes_; }
  const Eigen::MatrixXd& covariance() const { return covariance_; }

  // The methods below throw Error for an id that no plane has, and for general planes.

  // Of the angle between two planes' normals, rad.
  double AngleStddev(int plane_a, int plane_b) const;
  // Of the distance between a plane and a fixed point of the model frame, m.
  double DistanceStddev(const Eigen::Vector3d& point, int plane) const;
  // Of the distance of plane b from the point of plane a that is nearest to `point`, m:
  // between two walls, wherever one likes to measure it.
  double SeparationStddev(const Eigen::Vector3d& point, int plane_a, int plane_b) const;

  // Two planes' parameters, their angles and their distances at the patches' centres, that
  // depend on each other.
  struct Correlation {
    int plane_a = 0;
    int plane_b = 0;
    bool angle_a = false;  // else its distance
    bool angle_b = false;
    double value = 0.0;
  };
  // Those of largest absolute value, between different planes, largest first.
  std::vector<Correlation> LargestCorrelations(size_t count) const;

 private:
  size_t Find(int plane) const;
  // Derivative of the plane's signed distance from a point; of its angle.
  Eigen::RowVectorXd DistanceRow(size_t plane, const Eigen::Vector3d& point) const;
  Eigen::RowVectorXd AngleRow(size_t plane) const;
  double Stddev(const Eigen::RowVectorXd& row) const;

  std::vector<PlanePatch> planes_;
  std::vector<int> offsets_;
  Eigen::MatrixXd covariance_;
};

}  // namespace plumbline
