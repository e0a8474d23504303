#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/result/result_types.h"

namespace plumbline {

// PlaneCovariance is the joint covariance of a result's planes, and gives the standard
// deviations of what people measure in a map. Parameters of a plane n.x = d, in rad and m of
// the model frame: horizontal [ d ], vertical [ angle, d ] with n = (cos angle, sin angle, 0),
// general [ turn_u, turn_v, d_centre ], how far the normal turns towards its tangents
// (core/geometry/plane_tangents.h) and the plane moves along it at the patch's centre.
class PlaneCovariance {
 public:
  PlaneCovariance() = default;
  // covariance: of the parameters of the planes, in their order. CHECKs its size.
  PlaneCovariance(std::vector<PlanePatch> planes, Eigen::MatrixXd covariance);

  const std::vector<PlanePatch>& planes() const { return planes_; }
  const Eigen::MatrixXd& covariance() const { return covariance_; }

  // The methods below throw Error for an id that no plane has.

  // Standard deviation of the angle between two planes' normals, rad; of parallel ones, that
  // of the direction in which it is known worst.
  double AngleStddev(int plane_a, int plane_b) const;
  // Standard deviation of the distance between a plane and a fixed point of the model frame,
  // m.
  double DistanceStddev(const Eigen::Vector3d& point, int plane) const;
  // Standard deviation of the distance of plane b from the point of plane a that is nearest to
  // `point`, m: between two walls, wherever one likes to measure it. The way to plane a is
  // along its normal there.
  double SeparationStddev(const Eigen::Vector3d& point, int plane_a, int plane_b) const;

  // A plane's signed distance from a point of the model frame, times a weight.
  struct WeightedDistance {
    int plane = 0;
    Eigen::Vector3d point = Eigen::Vector3d::Zero();
    double weight = 1.0;
  };
  // Standard deviation of the sum of such terms: of an area, with the lengths of its edges as
  // weights.
  double SumStddev(const std::vector<WeightedDistance>& terms) const;

  // A correlation between two planes' parameters: each the plane's angle, or its distance at
  // the patch's centre.
  struct Correlation {
    int plane_a = 0;
    int plane_b = 0;
    bool angle_a = false;  // else its distance
    bool angle_b = false;
    double value = 0.0;
  };
  // Returns the correlations of largest absolute value between different planes, largest
  // first.
  std::vector<Correlation> LargestCorrelations(size_t count) const;

 private:
  size_t Find(int plane) const;
  // Derivatives by all parameters: of a plane's signed distance from a point, of its normal
  // (three rows), of its turn in the direction in which it is known worst.
  Eigen::RowVectorXd DistanceRow(size_t plane, const Eigen::Vector3d& point) const;
  Eigen::MatrixXd NormalRows(size_t plane) const;
  Eigen::RowVectorXd AngleRow(size_t plane) const;
  double Stddev(const Eigen::RowVectorXd& row) const;

  std::vector<PlanePatch> planes_;
  std::vector<int> offsets_;
  Eigen::MatrixXd covariance_;
};

}  // namespace plumbline
