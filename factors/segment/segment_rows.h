#pragma once

#include <ceres/jet.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>

#include "factors/manifold/plane_model.h"
#include "factors/segment/packed_segment.h"
#include "factors/segment/scanner_block.h"
#include "factors/segment/segment_measurement.h"
#include "factors/spline/spline.h"

namespace plumbline {

// A segment's residuals and their derivatives by the poses at its scan line's nodes and by its
// surface: what SegmentGroup sums, and what covariances hold errors that repeat against.

constexpr int kNumSegmentNodes = 3;
constexpr int kNodePoseSize = 6;  // [ rotation tangent | position ]
constexpr int kNodePosesSize = kNumSegmentNodes * kNodePoseSize;
constexpr int kMaxSurfaceSize = 3;

// The poses at the nodes of a scan line.
struct NodePoses {
  std::array<Eigen::Matrix3d, kNumSegmentNodes> world_from_body;
  std::array<Eigen::Vector3d, kNumSegmentNodes> position;
  std::array<SplinePoseJacobian, kNumSegmentNodes> splines;
};

// A scanner at the nodes of a scan line: columns x axis, y axis, each as long as a measured
// metre is, and origin, seen from the body's position, in the world's axes.
using ScannerAtNodes = std::array<Eigen::Matrix3d, kNumSegmentNodes>;

inline Eigen::Matrix3d AxesAndOrigin(const ScannerPose& body_from_scanner) {
  Eigen::Matrix3d in_body = body_from_scanner.rotation;
  in_body.leftCols<2>() *= body_from_scanner.range_scale;
  in_body.col(2) = body_from_scanner.translation;
  return in_body;
}

inline ScannerAtNodes AtNodes(const ScannerPose& body_from_scanner, const NodePoses& poses) {
  const Eigen::Matrix3d in_body = AxesAndOrigin(body_from_scanner);
  ScannerAtNodes nodes;
  for (size_t k = 0; k < kNumSegmentNodes; ++k) {
    nodes[k] = poses.world_from_body[k] * in_body;
  }
  return nodes;
}

// The motion of a scanner's mount at the nodes of a scan line.
using MountAtNodes = std::array<MountMotion, kNumSegmentNodes>;

// As above, of a scanner on a mount; block: nullptr where the scanner is not estimated.
inline ScannerAtNodes AtNodes(const ScannerPose& at_zero,
                              const MountPose& mount,
                              const MountAtNodes& motion,
                              const double* block,
                              const NodePoses& poses) {
  ScannerAtNodes nodes;
  for (size_t k = 0; k < kNumSegmentNodes; ++k) {
    const double angle_rad = MotionOfMount(mount, motion[k], block).angle_rad;
    nodes[k] = poses.world_from_body[k] * AxesAndOrigin(TurnedBy(angle_rad, mount, at_zero));
  }
  return nodes;
}

// A plane's normal and distance, differentiated by its parameters; columns beyond their number
// are zero.
struct PlaneDerivatives {
  Eigen::Vector3d normal;
  double distance = 0.0;
  Eigen::Matrix<double, 3, kMaxSurfaceSize> normal_by_plane;
  Eigen::Matrix<double, 1, kMaxSurfaceSize> distance_by_plane;
};

// The plane that a surface is near a point.
template <typename Model>
PlaneDerivatives DerivativesNear(const Model& model,
                                 const double* parameters,
                                 const Eigen::Vector3d& point) {
  constexpr int kSize = Model::kSize;
  using T = ceres::Jet<double, kSize>;
  T jets[kSize];
  for (int i = 0; i < kSize; ++i) jets[i] = T(parameters[i], i);
  T normal[3];
  T distance;
  EvaluateNear(model, jets, point.data(), normal, &distance);
  PlaneDerivatives derivatives;
  derivatives.normal_by_plane.setZero();
  derivatives.distance_by_plane.setZero();
  for (int i = 0; i < 3; ++i) {
    derivatives.normal[i] = normal[i].a;
    derivatives.normal_by_plane.template block<1, kSize>(i, 0) = normal[i].v.transpose();
  }
  derivatives.distance = distance.a;
  derivatives.distance_by_plane.template head<kSize>() = distance.v.transpose();
  return derivatives;
}

// A segment's whitened residuals and their derivatives by [ poses at the nodes | plane ];
// kPlaneSize 0: the plane is held.
template <int kPlaneSize>
struct SegmentRows {
  static constexpr int kColumns = kNodePosesSize + kPlaneSize;
  static constexpr int kMaxRows = 10;  // nine, and one for the bow or for the range
  Eigen::Matrix<double, Eigen::Dynamic, kColumns, Eigen::RowMajor, kMaxRows, kColumns>
      jacobian;
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxRows, 1> residuals;
  // Derivatives by the range errors of a scanner that is estimated, else empty.
  Eigen::Matrix<double, Eigen::Dynamic, kNumRangeErrors, 0, kMaxRows, kNumRangeErrors>
      by_range;
};

// Terms of the bend of the surface: the normal that turns as the segment is moved, and the bow
// of the segment itself (SegmentMeasurement).
template <int kPlaneSize>
void AddBend(const PackedSegment& measurement,
             const SegmentWeights& by,
             const ScannerAtNodes& scanner,
             double curvature,
             SegmentRows<kPlaneSize>* rows) {
  const auto stored = measurement.rows();
  const Eigen::Matrix3d frame = measurement.frame().Matrix();
  for (int k = 0; k < measurement.num_nodes(); ++k) {
    const Eigen::Matrix3d segment = scanner[static_cast<size_t>(k)] * frame;
    for (Eigen::Index row = 0; row < stored.rows(); ++row) {
      Eigen::Vector3d by_centroid =
          by.scale * curvature *
          (segment.leftCols<2>() *
           stored.template block<1, 2>(row, 3 * k).transpose().template cast<double>());
      by_centroid.z() = 0.0;
      auto jacobian = rows->jacobian.row(row);
      jacobian.template segment<3>(kNodePoseSize * k) +=
          segment.col(2).cross(by_centroid).transpose();
      jacobian.template segment<3>(kNodePoseSize * k + 3) += by_centroid.transpose();
    }
  }
  const size_t middle = measurement.num_nodes() == 1 ? 0 : 1;
  const double level2 = (scanner[middle] * frame).template block<2, 1>(0, 0).squaredNorm();
  const Eigen::Index last = stored.rows();
  rows->residuals.conservativeResize(last + 1);
  rows->jacobian.conservativeResize(last + 1, Eigen::NoChange);
  rows->residuals[last] = by.offset * measurement.bend_offset();
  rows->jacobian.row(last).setZero();
  using Column =
      Eigen::Matrix<double, Eigen::Dynamic, 1, 0, SegmentRows<kPlaneSize>::kMaxRows, 1>;
  Column bow(last + 1);
  bow << stored.col(10).template cast<double>(), measurement.bend_rest();
  bow *= by.scale * level2;
  rows->residuals += curvature * bow;
  if constexpr (kPlaneSize > 0) {
    rows->jacobian.col(kNodePosesSize + Cylinder::kCurvatureAt) += bow;
  }
}

// What a range bias takes away (SegmentMeasurement), with its own row or without: of a surface
// that bends a bow looks much the same. range_errors: nullptr: they are not estimated.
template <bool kOwnRow, int kPlaneSize>
void AddRangeBias(const PackedSegment& measurement,
                  const SegmentWeights& by,
                  const double* range_errors,
                  SegmentRows<kPlaneSize>* rows) {
  if (range_errors == nullptr) return;
  const auto stored = measurement.rows();
  const Eigen::Index num_rows = stored.rows();
  if constexpr (kOwnRow) {
    rows->residuals.conservativeResize(num_rows + 1);
    rows->jacobian.conservativeResize(num_rows + 1, Eigen::NoChange);
    rows->residuals[num_rows] = by.offset * measurement.range_offset();
    rows->jacobian.row(num_rows).setZero();
  }
  const Eigen::Index num_filled = rows->by_range.rows();
  rows->by_range.conservativeResize(rows->residuals.size(), Eigen::NoChange);
  rows->by_range.bottomRows(rows->residuals.size() - num_filled).setZero();
  rows->by_range.col(0).head(num_rows) = -by.offset * stored.col(11).template cast<double>();
  if constexpr (kOwnRow) rows->by_range(num_rows, 0) = -by.offset * measurement.range_rest();
  rows->residuals += range_errors[0] * rows->by_range.col(0);
}

// A row (a, b, c) of the compressed segment stands for c times the signed distance of one
// point, v from the body's position: of v = a along + b across + c origin and c alone, with
// the segment's frame in the world's axes. Turning the body by a small rotation moves v by the
// rotation's cross product with it.
//
// A range scale moves v by the part of it that lies in the scan plane.
//
// plane_at(body's position, segment's frame): the plane that the surface is near the segment's
// centroid at a node. range_errors: nullptr: they are not estimated.
template <int kPlaneSize, typename PlaneAt>
void DifferentiateNear(const PlaneAt& plane_at,
                       const PackedSegment& measurement,
                       const SegmentWeights& by,
                       const ScannerAtNodes& scanner,
                       const NodePoses& poses,
                       const double* range_errors,
                       SegmentRows<kPlaneSize>* rows) {
  const auto stored = measurement.rows();
  const Eigen::Matrix3d frame = measurement.frame().Matrix();
  rows->jacobian.setZero(stored.rows(), SegmentRows<kPlaneSize>::kColumns);
  rows->residuals.setZero(stored.rows());
  if (range_errors != nullptr) rows->by_range.setZero(stored.rows(), kNumRangeErrors);
  for (int k = 0; k < measurement.num_nodes(); ++k) {
    const Eigen::Vector3d& position = poses.position[static_cast<size_t>(k)];
    const Eigen::Matrix3d segment = scanner[static_cast<size_t>(k)] * frame;
    const PlaneDerivatives& plane = plane_at(position, segment);
    const double body_distance = plane.normal.dot(position) - plane.distance;
    for (Eigen::Index row = 0; row < stored.rows(); ++row) {
      const Eigen::Vector3d weights =
          by.scale *
          stored.template block<1, 3>(row, 3 * k).transpose().template cast<double>();
      const Eigen::Vector3d v = segment * weights;
      const double along_normal = plane.normal.dot(v);
      rows->residuals[row] += along_normal + weights.z() * body_distance;
      if (range_errors != nullptr) {
        const double of_origin = plane.normal.dot(scanner[static_cast<size_t>(k)].col(2));
        rows->by_range(row, 1) -=
            (along_normal - weights.z() * of_origin) / (1.0 - range_errors[1]);
      }
      auto jacobian = rows->jacobian.row(row);
      jacobian.template segment<3>(kNodePoseSize * k) = v.cross(plane.normal).transpose();
      jacobian.template segment<3>(kNodePoseSize * k + 3) =
          weights.z() * plane.normal.transpose();
      if constexpr (kPlaneSize > 0) {
        jacobian.template segment<kPlaneSize>(kNodePosesSize) +=
            (v + weights.z() * position).transpose() *
                plane.normal_by_plane.template leftCols<kPlaneSize>() -
            weights.z() * plane.distance_by_plane.template head<kPlaneSize>();
      }
    }
  }
  rows->residuals += by.offset * stored.col(9).template cast<double>();
}

// Fills the rows of a segment on a plane, whose derivatives are given. range_errors: of the
// scanner, bias (m) and scale; nullptr: they are not estimated.
template <typename Model, int kPlaneSize>
void Differentiate(const Model&,
                   const PackedSegment& measurement,
                   const SegmentWeights& by,
                   const ScannerAtNodes& scanner,
                   const NodePoses& poses,
                   const double* /*parameters*/,
                   const PlaneDerivatives& plane,
                   const double* range_errors,
                   SegmentRows<kPlaneSize>* rows) {
  const auto plane_at = [&](const Eigen::Vector3d&,
                            const Eigen::Matrix3d&) -> const PlaneDerivatives& {
    return plane;
  };
  DifferentiateNear(plane_at, measurement, by, scanner, poses, range_errors, rows);
  AddRangeBias<true>(measurement, by, range_errors, rows);
}
// Fills the rows of a segment on a cylinder with these parameters: another plane stands for it
// at each node.
template <int kPlaneSize>
void Differentiate(const Cylinder& cylinder,
                   const PackedSegment& measurement,
                   const SegmentWeights& by,
                   const ScannerAtNodes& scanner,
                   const NodePoses& poses,
                   const double* parameters,
                   const PlaneDerivatives& /*plane*/,
                   const double* range_errors,
                   SegmentRows<kPlaneSize>* rows) {
  PlaneDerivatives near;
  const auto plane_at = [&](const Eigen::Vector3d& position,
                            const Eigen::Matrix3d& segment) -> const PlaneDerivatives& {
    near = DerivativesNear(cylinder, parameters, position + segment.col(2));
    return near;
  };
  DifferentiateNear(plane_at, measurement, by, scanner, poses, range_errors, rows);
  AddBend(measurement, by, scanner, parameters[Cylinder::kCurvatureAt], rows);
  AddRangeBias<false>(measurement, by, range_errors, rows);
}

}  // namespace plumbline
