#include "factors/segment/segment_group.h"

#include <ceres/jet.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <type_traits>
#include <utility>

#include "factors/linear_algebra/square_root_marginalisation.h"
#include "factors/manifold/manifolds.h"
#include "factors/segment/segment_measurement.h"
#include "factors/segment/segment_rows.h"
#include "factors/spline/so3.h"
#include "factors/spline/spline.h"

namespace plumbline {
namespace {

constexpr int kMaxControlPoints = 9;
using Steps = std::array<RotationStep, kMaxControlPoints - 1>;

using LineVector = Eigen::Matrix<double, kNodePosesSize, 1>;
using LineMatrix = Eigen::Matrix<double, kNodePosesSize, kNodePosesSize, Eigen::RowMajor>;

}  // namespace

// Normal equations of a scan line's segments in the poses at its nodes, [ rotation tangent |
// position ] each, and in the planes' parameters.
struct LineSystem {
  void Clear(size_t num_planes, int num_plane_columns) {
    poses.setZero();
    gradient.setZero();
    cross.setZero(kNodePosesSize, num_plane_columns);
    sees_plane.assign(num_planes, false);
    range_with_poses.setZero();
    range_with_planes.setZero(num_plane_columns, kNumRangeErrors);
    range2.setZero();
    range_gradient.setZero();
  }

  LineMatrix poses;
  LineVector gradient;
  // Columns: planes' parameters.
  Eigen::Matrix<double, kNodePosesSize, Eigen::Dynamic> cross;
  std::vector<bool> sees_plane;
  // Terms of the range errors of the line's scanner, where those are estimated: products with
  // the poses, with the planes' parameters, with each other and with the residuals.
  Eigen::Matrix<double, kNodePosesSize, kNumRangeErrors> range_with_poses;
  Eigen::Matrix<double, Eigen::Dynamic, kNumRangeErrors> range_with_planes;
  Eigen::Matrix<double, kNumRangeErrors, kNumRangeErrors> range2;
  Eigen::Matrix<double, kNumRangeErrors, 1> range_gradient;
};

// The values that a linearisation is at, by what they are of, and what all scan lines share.
struct SegmentGroup::Values {
  double const* const* rotations;
  double const* const* positions;
  double const* const* planes;
  double const* const* scanner_blocks;  // of those that are estimated
  std::vector<ScannerPose> scanners;    // at angle zero of their mounts
  std::vector<PlaneDerivatives> plane_derivatives;
};

namespace {

// Adds the products of a segment's range errors to the line's system.
template <int kPlaneSize>
void AddRange(const SegmentRows<kPlaneSize>& rows, int plane_column, LineSystem* line) {
  if constexpr (kPlaneSize > 0) {
    const auto by_poses = rows.jacobian.template leftCols<kNodePosesSize>();
    const auto by_plane = rows.jacobian.template rightCols<kPlaneSize>();
    line->range_with_poses += by_poses.transpose().lazyProduct(rows.by_range);
    line->range_with_planes.template middleRows<kPlaneSize>(plane_column) +=
        by_plane.transpose().lazyProduct(rows.by_range);
    line->range2 += rows.by_range.transpose().lazyProduct(rows.by_range);
    line->range_gradient += rows.by_range.transpose().lazyProduct(rows.residuals);
  }
}

// Returns the derivatives of a plane, which are the same wherever it is seen.
PlaneDerivatives DerivativesOf(const SegmentGroup::Plane& plane, const double* parameters) {
  return VisitPlaneModel(plane.model, plane.chart, [&](const auto& model) {
    return DerivativesNear(model, parameters, plane.chart.anchor);
  });
}

// Weighs the rows by Huber's loss of their norm; returns the cost.
template <int kPlaneSize>
double Weigh(double huber_width, SegmentRows<kPlaneSize>* rows, bool* is_outlier) {
  const double squared = rows->residuals.squaredNorm();
  if (huber_width <= 0.0 || squared <= huber_width * huber_width) return 0.5 * squared;
  *is_outlier = true;
  const double norm = std::sqrt(squared);
  const double weight = std::sqrt(huber_width / norm);
  rows->residuals *= weight;
  rows->jacobian *= weight;
  rows->by_range *= weight;
  return huber_width * (norm - 0.5 * huber_width);
}

// Adds the rows of the poses' normal matrix that belong to one node, up to its diagonal block.
template <int kNode, typename Jacobian>
void AddNode(const Jacobian& jacobian, LineSystem* line) {
  constexpr int kWidth = kNodePoseSize * (kNode + 1);
  for (int i = kNodePoseSize * kNode; i < kWidth; ++i) {
    Eigen::Matrix<double, 1, kWidth> sum = line->poses.template block<1, kWidth>(i, 0);
    for (Eigen::Index row = 0; row < jacobian.rows(); ++row) {
      sum += jacobian(row, i) * jacobian.template block<1, kWidth>(row, 0);
    }
    line->poses.template block<1, kWidth>(i, 0) = sum;
  }
}

// Adds a segment to the line's system (the poses' matrix in its lower triangle of blocks) and,
// for the plane alone, to the group's.
template <int kPlaneSize>
void AddRows(const SegmentRows<kPlaneSize>& rows,
             int plane_column,
             int plane_row,
             LineSystem* line,
             SegmentGroup::Quadratic* quadratic) {
  AddNode<0>(rows.jacobian, line);
  AddNode<1>(rows.jacobian, line);
  AddNode<2>(rows.jacobian, line);
  const auto by_poses = rows.jacobian.template leftCols<kNodePosesSize>();
  line->gradient += by_poses.transpose().lazyProduct(rows.residuals);
  if constexpr (kPlaneSize > 0) {
    const auto by_plane = rows.jacobian.template rightCols<kPlaneSize>();
    for (int i = 0; i < kPlaneSize; ++i) {
      LineVector sum = line->cross.col(plane_column + i);
      for (Eigen::Index row = 0; row < by_plane.rows(); ++row) {
        sum += by_plane(row, i) * by_poses.row(row).transpose();
      }
      line->cross.col(plane_column + i) = sum;
    }
    quadratic->gradient.template segment<kPlaneSize>(plane_row) +=
        by_plane.transpose().lazyProduct(rows.residuals);
    quadratic->hessian.template block<kPlaneSize, kPlaneSize>(plane_row, plane_row) +=
        by_plane.transpose().lazyProduct(by_plane);
  }
}

void FillUpperBlocks(LineSystem* line) {
  for (int k = 0; k < kNumSegmentNodes; ++k) {
    for (int l = 0; l < k; ++l) {
      line->poses.block<kNodePoseSize, kNodePoseSize>(kNodePoseSize * l, kNodePoseSize * k) =
          line->poses.block<kNodePoseSize, kNodePoseSize>(kNodePoseSize * k, kNodePoseSize * l)
              .transpose();
    }
  }
}

}  // namespace

// The chain rule through the spline, from the nodes' poses to the control points: adds a
// line's system to the group's.
class Spread {
 public:
  // first: of the control points that each node uses.
  Spread(const std::array<int, kNumSegmentNodes>& first,
         const NodePoses& poses,
         int num_nodes) {
    const auto [begin, last] = std::minmax_element(first.begin(), first.begin() + num_nodes);
    begin_ = *begin;
    end_ = *last + kSplineOrder;
    for (int control_point = begin_; control_point < end_; ++control_point) {
      NodesByControlPoint& nodes = nodes_[static_cast<size_t>(control_point)];
      for (size_t k = 0; k < kNumSegmentNodes; ++k) {
        const int j = control_point - first[k];
        const bool is_used = static_cast<int>(k) < num_nodes && j >= 0 && j < kSplineOrder;
        const SplinePoseJacobian& spline = poses.splines[k];
        nodes.weights[k] = is_used ? spline.position_weights[static_cast<size_t>(j)] : 0.0;
        if (is_used) {
          nodes.rotations[k] = spline.rotation_wrt_control[static_cast<size_t>(j)];
        } else {
          nodes.rotations[k].setZero();
        }
      }
    }
  }

  void Add(const LineSystem& line,
           const std::vector<int>& plane_offsets,
           SegmentGroup::Quadratic* quadratic) const {
    for (int column = begin_; column < end_; ++column) {
      const NodesByControlPoint& nodes = nodes_[static_cast<size_t>(column)];
      const int at = kNodePoseSize * column;
      quadratic->gradient.segment<kNodePoseSize>(at) += Gather(nodes, line.gradient);
      const Product product = Multiply(line.poses, nodes);
      for (int row = begin_; row < end_; ++row) {
        AddPair(row, column, product, &quadratic->hessian);
      }
      for (size_t i = 0; i < line.sees_plane.size(); ++i) {
        if (!line.sees_plane[i]) continue;
        for (int row = plane_offsets[i]; row < plane_offsets[i + 1]; ++row) {
          quadratic->hessian.block<1, kNodePoseSize>(row, at) +=
              Gather(nodes, line.cross.col(row - plane_offsets[0])).transpose();
        }
      }
    }
  }

  // Adds a row of the group's matrix, given by its products with the nodes' poses.
  void AddRow(const LineVector& by_nodes, int row, Eigen::MatrixXd* hessian) const {
    for (int column = begin_; column < end_; ++column) {
      hessian->block<1, kNodePoseSize>(row, kNodePoseSize * column) +=
          Gather(nodes_[static_cast<size_t>(column)], by_nodes).transpose();
    }
  }

 private:
  using PoseVector = Eigen::Matrix<double, kNodePoseSize, 1>;

  // The nodes' poses differentiated by one control point; zero where a node does not use it.
  struct NodesByControlPoint {
    std::array<Eigen::Matrix3d, kNumSegmentNodes> rotations;
    std::array<double, kNumSegmentNodes> weights;  // of the position
  };

  // Columns of a control point, rows of the nodes' poses: those of the rotation, and those of
  // the position for the nodes' positions.
  struct Product {
    std::array<Eigen::Matrix<double, kNodePoseSize, 3>, kNumSegmentNodes> rotation;
    std::array<Eigen::Matrix3d, kNumSegmentNodes> position;
  };

  // Converts a linear form in the nodes' poses to one in a control point.
  template <typename Vector>
  static PoseVector Gather(const NodesByControlPoint& nodes, const Vector& by_nodes) {
    PoseVector sum = PoseVector::Zero();
    for (size_t k = 0; k < kNumSegmentNodes; ++k) {
      const auto at = kNodePoseSize * static_cast<int>(k);
      sum.head<3>() += nodes.rotations[k].transpose() * by_nodes.template segment<3>(at);
      sum.tail<3>() += nodes.weights[k] * by_nodes.template segment<3>(at + 3);
    }
    return sum;
  }

  static Product Multiply(const LineMatrix& poses, const NodesByControlPoint& nodes) {
    Product product;
    for (size_t k = 0; k < kNumSegmentNodes; ++k) {
      const auto row = kNodePoseSize * static_cast<int>(k);
      product.rotation[k].setZero();
      product.position[k].setZero();
      for (size_t l = 0; l < kNumSegmentNodes; ++l) {
        const auto column = kNodePoseSize * static_cast<int>(l);
        product.rotation[k] +=
            poses.block<kNodePoseSize, 3>(row, column).lazyProduct(nodes.rotations[l]);
        product.position[k] += nodes.weights[l] * poses.block<3, 3>(row + 3, column + 3);
      }
    }
    return product;
  }

  // The blocks of two control points that lie in the lower triangle.
  void AddPair(int row, int column, const Product& product, Eigen::MatrixXd* hessian) const {
    const NodesByControlPoint& nodes = nodes_[static_cast<size_t>(row)];
    const int row_at = kNodePoseSize * row;
    const int column_at = kNodePoseSize * column;
    Eigen::Matrix3d mixed = nodes.weights[0] * product.rotation[0].bottomRows<3>();
    for (size_t k = 1; k < kNumSegmentNodes; ++k) {
      mixed += nodes.weights[k] * product.rotation[k].bottomRows<3>();
    }
    if (row < column) {
      hessian->block<3, 3>(column_at, row_at + 3) += mixed.transpose();
      return;
    }
    hessian->block<3, 3>(row_at + 3, column_at) += mixed;
    for (size_t k = 0; k < kNumSegmentNodes; ++k) {
      hessian->block<3, 3>(row_at, column_at) +=
          nodes.rotations[k].transpose().lazyProduct(product.rotation[k].topRows<3>());
      hessian->block<3, 3>(row_at + 3, column_at + 3) +=
          nodes.weights[k] * product.position[k];
    }
  }

  int begin_;
  int end_;
  std::array<NodesByControlPoint, kMaxControlPoints> nodes_;
};

namespace {

// Velocities of the body at the nodes of a scan line, in the world's axes.
struct NodeVelocities {
  std::array<Eigen::Vector3d, kNumSegmentNodes> angular;  // rad/s
  std::array<Eigen::Vector3d, kNumSegmentNodes> linear;   // m/s
};

// later: in knot intervals.
NodeVelocities VelocitiesAt(const std::array<SplineNode, kNumSegmentNodes>& nodes,
                            double const* const* q,
                            double const* const* p,
                            double later,
                            double knot_interval_s) {
  NodeVelocities velocities;
  for (size_t k = 0; k < kNumSegmentNodes; ++k) {
    EvaluateVelocity(q + nodes[k].first,
                     p + nodes[k].first,
                     nodes[k].u + later,
                     knot_interval_s,
                     &velocities.angular[k],
                     &velocities.linear[k]);
  }
  return velocities;
}

// The derivative of the nodes' poses by the scanner's block.
template <int kSize>
using NodesByScanner = Eigen::Matrix<double, kNodePosesSize, kSize>;

NodesByScanner<kScannerBlockSize> ByScanner(const ScannerPose& scanner,
                                            const double* block,
                                            const NodePoses& poses,
                                            const NodeVelocities& velocities) {
  NodesByScanner<kScannerBlockSize> by_scanner;
  for (size_t k = 0; k < kNumSegmentNodes; ++k) {
    by_scanner.middleRows<kNodePoseSize>(kNodePoseSize * static_cast<int>(k)) = BodyMotionByScanner(
        poses.world_from_body[k], scanner, block, velocities.angular[k], velocities.linear[k]);
  }
  return by_scanner;
}

NodesByScanner<kMountedBlockSize> ByMounted(const ScannerPose& at_zero,
                                            const MountPose& mount,
                                            const MountAtNodes& motion,
                                            const double* block,
                                            const NodePoses& poses,
                                            const NodeVelocities& velocities) {
  NodesByScanner<kMountedBlockSize> by_scanner;
  for (size_t k = 0; k < kNumSegmentNodes; ++k) {
    by_scanner.middleRows<kNodePoseSize>(kNodePoseSize * static_cast<int>(k)) =
        BodyMotionByMounted(poses.world_from_body[k],
                            at_zero,
                            mount,
                            motion[k],
                            block,
                            velocities.angular[k],
                            velocities.linear[k]);
  }
  return by_scanner;
}

// Adds a line's system to the rows of its scanner, which begin at this one.
template <int kSize>
void AddScanner(const LineSystem& line,
                const NodesByScanner<kSize>& by_scanner,
                const std::vector<int>& plane_offsets,
                const Spread& spread,
                int row,
                SegmentGroup::Quadratic* quadratic) {
  NodesByScanner<kSize> by_nodes = line.poses * by_scanner;
  quadratic->gradient.template segment<kSize>(row) += by_scanner.transpose() * line.gradient;
  quadratic->gradient.template segment<kNumRangeErrors>(row + kScannerRangeAt) +=
      line.range_gradient;
  auto own = quadratic->hessian.template block<kSize, kSize>(row, row);
  own += by_scanner.transpose() * by_nodes;
  const Eigen::Matrix<double, kNumRangeErrors, kSize> range_by_scanner =
      line.range_with_poses.transpose() * by_scanner;
  own.template middleRows<kNumRangeErrors>(kScannerRangeAt) += range_by_scanner;
  own.template block<kNumRangeErrors, kNumRangeErrors>(kScannerRangeAt, kScannerRangeAt) +=
      line.range2;
  if constexpr (kSize > kScannerBlockSize) {
    own.template middleCols<kNumRangeErrors>(kScannerRangeAt)
        .template bottomRows<kSize - kScannerBlockSize>() +=
        range_by_scanner.template rightCols<kSize - kScannerBlockSize>().transpose();
  }
  by_nodes.template middleCols<kNumRangeErrors>(kScannerRangeAt) += line.range_with_poses;
  for (int i = 0; i < kSize; ++i) {
    spread.AddRow(by_nodes.col(i), row + i, &quadratic->hessian);
  }
  for (size_t i = 0; i < line.sees_plane.size(); ++i) {
    if (!line.sees_plane[i]) continue;
    for (int column = plane_offsets[i]; column < plane_offsets[i + 1]; ++column) {
      quadratic->hessian.template block<kSize, 1>(row, column) +=
          by_scanner.transpose() * line.cross.col(column - plane_offsets[0]);
      quadratic->hessian.template block<kNumRangeErrors, 1>(row + kScannerRangeAt, column) +=
          line.range_with_planes.row(column - plane_offsets[0]).transpose();
    }
  }
}

bool SameNodes(const std::array<SplineNode, kNumSegmentNodes>& a,
               const std::array<SplineNode, kNumSegmentNodes>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), [](const auto& x, const auto& y) {
    return x.first == y.first && x.u == y.u;
  });
}

}  // namespace

SegmentGroup::SegmentGroup(int num_control_points,
                           double knot_interval_s,
                           std::vector<Scanner> scanners,
                           std::vector<Plane> planes,
                           std::vector<Segment> segments,
                           double huber_width,
                           std::vector<MountAtNodes> mount_motions)
    : num_control_points_(num_control_points),
      knot_interval_s_(knot_interval_s),
      scanners_(std::move(scanners)),
      planes_(std::move(planes)),
      plane_offsets_(1, 6 * num_control_points),
      mount_motions_(std::move(mount_motions)),
      huber_width_(huber_width) {
  CHECK_GE(num_control_points, kSplineOrder);
  CHECK_LE(num_control_points, kMaxControlPoints);
  for (const Plane& plane : planes_) {
    plane_offsets_.push_back(plane_offsets_.back() + PlaneModelSize(plane.model));
  }
  for (const Segment& segment : segments) {
    CHECK(segment.scanner >= 0 && segment.scanner < static_cast<int>(scanners_.size()));
    CHECK(segment.plane >= 0 && segment.plane < static_cast<int>(planes_.size()));
    CHECK_EQ(scanners_[static_cast<size_t>(segment.scanner)].mount.has_value(),
             segment.mount_motion >= 0);
    for (const SplineNode& node : segment.nodes) {
      CHECK(node.first >= 0 && node.first + kSplineOrder <= num_control_points) << node.first;
    }
  }
  scanner_offsets_.push_back(plane_offsets_.back());
  std::vector<int> among_estimated;  // by scanner; -1: constant
  for (const Scanner& scanner : scanners_) {
    among_estimated.push_back(scanner.estimated ? num_estimated_scanners_++ : -1);
    if (!scanner.estimated) continue;
    scanner_offsets_.push_back(scanner_offsets_.back() + scanner.BlockSize());
  }
  SetMountReaches(among_estimated, segments);
  const auto estimated = [&](const Segment& segment) {
    return among_estimated[static_cast<size_t>(segment.scanner)];
  };
  // Segments with the same nodes stand one after the other.
  std::stable_sort(segments.begin(), segments.end(), [&](const auto& a, const auto& b) {
    return std::make_tuple(a.nodes[0].first, a.nodes[0].u, estimated(a), a.mount_motion) <
           std::make_tuple(b.nodes[0].first, b.nodes[0].u, estimated(b), b.mount_motion);
  });
  members_.reserve(segments.size());
  for (const Segment& segment : segments) {
    const int num_nodes = segment.measurement->num_nodes();
    if (scan_lines_.empty() || num_nodes != scan_lines_.back().num_nodes ||
        estimated(segment) != scan_lines_.back().estimated_scanner ||
        segment.mount_motion != scan_lines_.back().mount_motion ||
        !SameNodes(segment.nodes, scan_lines_.back().nodes)) {
      scan_lines_.push_back(
          {segment.nodes, num_nodes, estimated(segment), segment.mount_motion, 0});
    }
    members_.push_back({segment.measurement,
                        static_cast<float>(segment.weights.scale),
                        static_cast<float>(segment.weights.offset),
                        segment.scanner,
                        segment.plane});
    scan_lines_.back().end = members_.size();
  }
  scan_lines_.shrink_to_fit();
}

void SegmentGroup::SetMountReaches(const std::vector<int>& among_estimated,
                                   const std::vector<Segment>& segments) {
  mount_reaches_.assign(static_cast<size_t>(num_estimated_scanners_), Eigen::Vector2d::Ones());
  for (const Segment& segment : segments) {
    const int estimated = among_estimated[static_cast<size_t>(segment.scanner)];
    if (estimated < 0 || segment.mount_motion < 0) continue;
    Eigen::Vector2d& reach = mount_reaches_[static_cast<size_t>(estimated)];
    for (const MountMotion& motion :
         mount_motions_[static_cast<size_t>(segment.mount_motion)]) {
      const Eigen::Vector2d by(1.0, motion.since_start_s);
      reach = reach.cwiseMax((motion.rate_rad_s * by).cwiseAbs());
    }
  }
}

void SegmentGroup::Linearise(double const* const* parameters, Quadratic* quadratic) const {
  Sum<false>(parameters, quadratic);
}

void SegmentGroup::LinearisePoses(double const* const* parameters,
                                  Quadratic* quadratic) const {
  Sum<true>(parameters, quadratic);
}

SegmentGroup::Values SegmentGroup::ValuesOf(double const* const* parameters) const {
  Values at;
  at.rotations = parameters;
  at.positions = parameters + num_control_points_;
  at.planes = parameters + 2 * num_control_points_;
  at.scanner_blocks = at.planes + planes_.size();
  double const* const* next_block = at.scanner_blocks;
  for (const Scanner& scanner : scanners_) {
    at.scanners.push_back(scanner.estimated
                              ? PoseOfScanner(scanner.body_from_scanner, *next_block++)
                              : scanner.body_from_scanner);
  }
  at.plane_derivatives.reserve(planes_.size());
  for (size_t i = 0; i < planes_.size(); ++i) {
    at.plane_derivatives.push_back(DerivativesOf(planes_[i], at.planes[i]));
  }
  return at;
}

template <bool kPlanesHeld>
void SegmentGroup::SumMembers(size_t begin,
                              const ScanLine& scan_line,
                              const Values& at,
                              const NodePoses& poses,
                              LineSystem* line,
                              Quadratic* quadratic) const {
  const bool is_estimated = scan_line.estimated_scanner >= 0;
  const double* const scanner_block =
      is_estimated ? at.scanner_blocks[scan_line.estimated_scanner] : nullptr;
  const double* const range_errors = is_estimated ? scanner_block + kScannerRangeAt : nullptr;
  ScannerAtNodes scanner;
  int scanner_at_nodes = -1;
  for (size_t next = begin; next < scan_line.end; ++next) {
    const Member& segment = members_[next];
    const auto plane = static_cast<size_t>(segment.plane);
    line->sees_plane[plane] = !kPlanesHeld;
    if (segment.scanner != scanner_at_nodes) {
      scanner_at_nodes = segment.scanner;
      const auto index = static_cast<size_t>(segment.scanner);
      if (scan_line.mount_motion < 0) {
        scanner = AtNodes(at.scanners[index], poses);
      } else {
        scanner = AtNodes(at.scanners[index],
                          is_estimated ? PoseOfMount(*scanners_[index].mount, scanner_block)
                                       : *scanners_[index].mount,
                          mount_motions_[static_cast<size_t>(scan_line.mount_motion)],
                          scanner_block,
                          poses);
      }
    }
    VisitPlaneModel(planes_[plane].model, planes_[plane].chart, [&](const auto& model) {
      using Model = std::decay_t<decltype(model)>;
      SegmentRows<kPlanesHeld ? 0 : Model::kSize> rows;
      Differentiate(model,
                    *segment.measurement,
                    {segment.scale, segment.offset},
                    scanner,
                    poses,
                    at.planes[plane],
                    at.plane_derivatives[plane],
                    range_errors,
                    &rows);
      quadratic->cost += Weigh(huber_width_, &rows, &quadratic->has_outliers);
      const int column = plane_offsets_[plane] - plane_offsets_.front();
      AddRows(rows, column, plane_offsets_[plane], line, quadratic);
      if (is_estimated) AddRange(rows, column, line);
    });
  }
}

// Adds a line's system to the rows of its estimated scanner.
void SegmentGroup::AddOwnScanner(const ScanLine& scan_line,
                                 const Values& at,
                                 const NodePoses& poses,
                                 const LineSystem& line,
                                 const Spread& spread,
                                 size_t scanner,
                                 Quadratic* quadratic) const {
  const double* const block = at.scanner_blocks[scan_line.estimated_scanner];
  const NodeVelocities velocities = VelocitiesAt(scan_line.nodes,
                                                 at.rotations,
                                                 at.positions,
                                                 block[kScannerDelayAt] / knot_interval_s_,
                                                 knot_interval_s_);
  const int row = ScannerOffset(scan_line.estimated_scanner);
  if (scan_line.mount_motion < 0) {
    AddScanner<kScannerBlockSize>(line,
                                  ByScanner(at.scanners[scanner], block, poses, velocities),
                                  plane_offsets_,
                                  spread,
                                  row,
                                  quadratic);
    return;
  }
  AddScanner<kMountedBlockSize>(
      line,
      ByMounted(at.scanners[scanner],
                *scanners_[scanner].mount,
                mount_motions_[static_cast<size_t>(scan_line.mount_motion)],
                block,
                poses,
                velocities),
      plane_offsets_,
      spread,
      row,
      quadratic);
}

template <bool kPlanesHeld>
void SegmentGroup::Sum(double const* const* parameters, Quadratic* quadratic) const {
  const Values at = ValuesOf(parameters);
  Steps steps;
  for (int j = 0; j + 1 < num_control_points_; ++j) {
    steps[static_cast<size_t>(j)] = MakeRotationStep(at.rotations[j], at.rotations[j + 1]);
  }
  const int num_rows = kPlanesHeld ? plane_offsets_.front() : size();
  quadratic->cost = 0.0;
  quadratic->has_outliers = false;
  quadratic->gradient.setZero(num_rows);
  quadratic->hessian.setZero(num_rows, num_rows);
  LineSystem line;
  NodePoses poses;
  size_t begin = 0;
  for (const ScanLine& scan_line : scan_lines_) {
    const double* const scanner_block = scan_line.estimated_scanner < 0
                                            ? nullptr
                                            : at.scanner_blocks[scan_line.estimated_scanner];
    const double later =
        scanner_block == nullptr ? 0.0 : scanner_block[kScannerDelayAt] / knot_interval_s_;
    std::array<int, kNumSegmentNodes> first;
    for (size_t k = 0; k < kNumSegmentNodes; ++k) {
      const SplineNode& node = scan_line.nodes[k];
      const SplinePose pose = EvaluatePose(&steps[static_cast<size_t>(node.first)],
                                           at.rotations[node.first],
                                           at.positions + node.first,
                                           node.u + later,
                                           &poses.splines[k]);
      poses.world_from_body[k] = pose.world_from_body.toRotationMatrix();
      poses.position[k] = pose.position;
      first[k] = node.first;
    }
    line.Clear(planes_.size(),
               kPlanesHeld ? 0 : plane_offsets_.back() - plane_offsets_.front());
    SumMembers<kPlanesHeld>(begin, scan_line, at, poses, &line, quadratic);
    FillUpperBlocks(&line);
    const Spread spread(first, poses, scan_line.num_nodes);
    spread.Add(line, plane_offsets_, quadratic);
    if (!kPlanesHeld && scanner_block != nullptr) {
      AddOwnScanner(scan_line,
                    at,
                    poses,
                    line,
                    spread,
                    static_cast<size_t>(members_[begin].scanner),
                    quadratic);
    }
    begin = scan_line.end;
  }
}

}  // namespace plumbline
