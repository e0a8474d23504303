#include "core/result/plane_covariance.h"

#include <glog/logging.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <utility>

#include "core/geometry/plane_tangents.h"
#include "core/util/error.h"

namespace plumbline {
namespace {

std::vector<int> Offsets(const std::vector<PlanePatch>& planes) {
  std::vector<int> offsets = {0};
  for (const PlanePatch& plane : planes) {
    offsets.push_back(offsets.back() +
                      static_cast<int>(FieldsOf(plane.type).parameters.size()));
  }
  return offsets;
}

}  // namespace

PlaneCovariance::PlaneCovariance(std::vector<PlanePatch> planes, Eigen::MatrixXd covariance)
    : planes_(std::move(planes)),
      offsets_(Offsets(planes_)),
      covariance_(std::move(covariance)) {
  CHECK_EQ(covariance_.rows(), offsets_.back());
  CHECK_EQ(covariance_.cols(), offsets_.back());
}

size_t PlaneCovariance::Find(int plane) const {
  const auto at = std::find_if(planes_.begin(), planes_.end(), [&](const PlanePatch& patch) {
    return patch.id == plane;
  });
  if (at == planes_.end()) throw Error("there is no plane " + std::to_string(plane));
  return static_cast<size_t>(at - planes_.begin());
}

Eigen::RowVectorXd PlaneCovariance::DistanceRow(size_t plane,
                                                const Eigen::Vector3d& point) const {
  Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(covariance_.cols());
  const PlanePatch& patch = planes_[plane];
  const int offset = offsets_[plane];
  const Eigen::Matrix<double, 3, 2> tangents = PlaneTangents(patch.normal);
  switch (patch.type) {
    case PlaneType::kHorizontal:
      row[offset] = -1.0;
      break;
    case PlaneType::kVertical:
      row[offset] = tangents.col(0).dot(point);
      row[offset + 1] = -1.0;
      break;
    case PlaneType::kGeneral:
      row.segment<2>(offset) = (point - patch.centre).transpose() * tangents;
      row[offset + 2] = -1.0;
      break;
    case PlaneType::kCylinder: {
      // The axis moves along with the centre and the radius.
      const Eigen::Vector3d normal = patch.NormalAt(point);
      const double side = std::copysign(1.0, patch.curvature);
      row[offset] = side * patch.Radius() * normal.dot(tangents.col(0));
      row[offset + 1] = side * (normal.dot(patch.normal) - 1.0);
      row[offset + 2] = -normal.dot(patch.normal);
      break;
    }
  }
  return row;
}

Eigen::MatrixXd PlaneCovariance::NormalRows(size_t plane) const {
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(3, covariance_.cols());
  const PlanePatch& patch = planes_[plane];
  const int num_turns = FieldsOf(patch.type).num_turns;
  rows.middleCols(offsets_[plane], num_turns) =
      PlaneTangents(patch.normal).leftCols(num_turns);
  return rows;
}

Eigen::RowVectorXd PlaneCovariance::AngleRow(size_t plane) const {
  const Eigen::MatrixXd turns =
      PlaneTangents(planes_[plane].normal).transpose() * NormalRows(plane);
  return Stddev(turns.row(0)) < Stddev(turns.row(1)) ? turns.row(1) : turns.row(0);
}

double PlaneCovariance::Stddev(const Eigen::RowVectorXd& row) const {
  return std::sqrt(std::max(0.0, row.dot(covariance_ * row.transpose())));
}

double PlaneCovariance::AngleStddev(int plane_a, int plane_b) const {
  const size_t a = Find(plane_a);
  const size_t b = Find(plane_b);
  const Eigen::Vector3d& normal_a = planes_[a].normal;
  const Eigen::Vector3d& normal_b = planes_[b].normal;
  const double cosine = normal_a.dot(normal_b);
  const double sine = normal_a.cross(normal_b).norm();
  constexpr double kParallel = 1e-3;  // sine below which the angle may open in any direction
  if (sine > kParallel) {
    return Stddev(normal_b.transpose() * NormalRows(a) +
                  normal_a.transpose() * NormalRows(b)) /
           sine;
  }
  const Eigen::MatrixXd turns = PlaneTangents(normal_a).transpose() *
                                (NormalRows(a) - std::copysign(1.0, cosine) * NormalRows(b));
  const Eigen::Matrix2d covariance = turns * covariance_ * turns.transpose();
  return std::sqrt(std::max(
      0.0, Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(covariance).eigenvalues()[1]));
}

double PlaneCovariance::DistanceStddev(const Eigen::Vector3d& point, int plane) const {
  return Stddev(DistanceRow(Find(plane), point));
}

double PlaneCovariance::SumStddev(const std::vector<WeightedDistance>& terms) const {
  Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(covariance_.cols());
  for (const WeightedDistance& term : terms) {
    row += term.weight * DistanceRow(Find(term.plane), term.point);
  }
  return Stddev(row);
}

double PlaneCovariance::SeparationStddev(const Eigen::Vector3d& point,
                                         int plane_a,
                                         int plane_b) const {
  const size_t a = Find(plane_a);
  const size_t b = Find(plane_b);
  const PlanePatch& first = planes_[a];
  const Eigen::Vector3d normal_a = first.NormalAt(point);
  const Eigen::Vector3d on_a = point - first.SignedDistance(point) * normal_a;
  // When a moves away from the point by e along its normal there, the point of a follows.
  const double follows = planes_[b].NormalAt(on_a).dot(normal_a);
  return Stddev(DistanceRow(b, on_a) - follows * DistanceRow(a, on_a));
}

std::vector<PlaneCovariance::Correlation> PlaneCovariance::LargestCorrelations(
    size_t count) const {
  struct Quantity {
    size_t plane;
    bool angle;
  };
  std::vector<Quantity> quantities;
  Eigen::MatrixXd rows(0, covariance_.cols());
  const auto add = [&](size_t plane, bool angle, const Eigen::RowVectorXd& row) {
    if (Stddev(row) == 0.0) return;  // held by the gauge
    quantities.push_back({plane, angle});
    rows.conservativeResize(rows.rows() + 1, Eigen::NoChange);
    rows.bottomRows<1>() = row / Stddev(row);
  };
  for (size_t i = 0; i < planes_.size(); ++i) {
    add(i, true, AngleRow(i));
    add(i, false, DistanceRow(i, planes_[i].centre));
  }
  const Eigen::MatrixXd values = rows * covariance_ * rows.transpose();
  std::vector<Correlation> correlations;
  for (size_t i = 0; i < quantities.size(); ++i) {
    for (size_t j = 0; j < i; ++j) {
      const Quantity& a = quantities[j];
      const Quantity& b = quantities[i];
      if (a.plane == b.plane) continue;
      correlations.push_back(
          {planes_[a.plane].id,
           planes_[b.plane].id,
           a.angle,
           b.angle,
           values(static_cast<Eigen::Index>(j), static_cast<Eigen::Index>(i))});
    }
  }
  const size_t num_kept = std::min(count, correlations.size());
  std::partial_sort(correlations.begin(),
                    correlations.begin() + static_cast<std::ptrdiff_t>(num_kept),
                    correlations.end(),
                    [](const Correlation& a, const Correlation& b) {
                      return std::abs(a.value) > std::abs(b.value);
                    });
  correlations.resize(num_kept);
  return correlations;
}

}  // namespace plumbline
