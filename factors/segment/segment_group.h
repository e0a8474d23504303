#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <optional>
#include <vector>

#include "factors/manifold/plane_model.h"
#include "factors/segment/packed_segment.h"
#include "factors/segment/scanner_block.h"
#include "factors/segment/segment_measurement.h"
#include "factors/spline/spline.h"

namespace plumbline {

struct LineSystem;  // of a scan line
struct NodePoses;
class Spread;

// All segments of one stretch of the trajectory as one least squares term. Its cost is the sum
// of the segments' costs (CreateSegmentFactor, with Huber's loss where asked for); what they
// share, the spline's steps above all, is computed once.
//
// A scanner is constant, or a parameter block about the pose that is stated for it
// (factors/segment/scanner_block.h). One on a mount has its own motion at the nodes.
class SegmentGroup {
 public:
  struct Scanner {
    ScannerPose body_from_scanner;  // at angle zero of its mount
    bool estimated = false;
    std::optional<MountPose> mount = std::nullopt;

    int BlockSize() const { return mount ? kMountedBlockSize : kScannerBlockSize; }
  };
  struct Plane {
    PlaneModel model = PlaneModel::kVertical;
    PlaneChart chart;
  };
  struct Segment {
    const PackedSegment* measurement = nullptr;  // outlives the group
    std::array<SplineNode, 3> nodes;
    int scanner = 0;  // position in scanners
    int plane = 0;    // position in planes
    SegmentWeights weights;
    int mount_motion = -1;  // position in mount_motions; -1: its scanner has no mount
  };
  using MountAtNodes = std::array<MountMotion, 3>;

  // Quadratic model at some parameters: cost(delta) = cost + gradient.delta + delta^T hessian
  // delta / 2. Rows: rotation tangent (3) and position (3) of one control point after the
  // other, then the planes' parameters, then those of the estimated scanners.
  struct Quadratic {
    double cost = 0.0;
    bool has_outliers = false;  // segments beyond Huber's width
    Eigen::VectorXd gradient;
    Eigen::MatrixXd hessian;  // lower triangle
  };

  // huber_width: in standard deviations of the norm of a segment's residuals; 0: plain least
  // squares. knot_interval_s: what a scanner's delay is measured by. mount_motions: at the
  // nodes of the segments of scanners on mounts.
  SegmentGroup(int num_control_points,
               double knot_interval_s,
               std::vector<Scanner> scanners,
               std::vector<Plane> planes,
               std::vector<Segment> segments,
               double huber_width,
               std::vector<MountAtNodes> mount_motions = {});

  int num_control_points() const { return num_control_points_; }
  int num_estimated_scanners() const { return num_estimated_scanners_; }
  const std::vector<Plane>& planes() const { return planes_; }
  // First row of a plane's parameters; the last element is the number of rows.
  const std::vector<int>& plane_offsets() const { return plane_offsets_; }
  // First row of an estimated scanner's parameters, counted among the estimated ones.
  int ScannerOffset(int scanner) const {
    return scanner_offsets_[static_cast<size_t>(scanner)];
  }
  int ScannerSize(int scanner) const {
    return ScannerOffset(scanner + 1) - ScannerOffset(scanner);
  }
  int size() const { return scanner_offsets_.back(); }
  // The largest turn of the estimated scanner's mount by a second of its angles' delay, and by
  // its whole rate: rad. 1 where it has none.
  const Eigen::Vector2d& MountReach(int scanner) const {
    return mount_reaches_[static_cast<size_t>(scanner)];
  }

  // parameters: [ q_0 .. q_{m-1} | p_0 .. p_{m-1} | planes | estimated scanners ].
  // Gauss-Newton, each segment weighted by its loss' first derivative.
  void Linearise(double const* const* parameters, Quadratic* quadratic) const;
  // LinearisePoses holds planes and scanners: the model has the rows of the poses alone.
  void LinearisePoses(double const* const* parameters, Quadratic* quadratic) const;

 private:
  // Segments that share their nodes; those of an estimated scanner are of no other one.
  struct ScanLine {
    std::array<SplineNode, 3> nodes;
    int num_nodes;
    int estimated_scanner;  // among the estimated ones; -1: none
    int mount_motion;       // -1: none
    size_t end;             // of its members
  };
  struct Member {
    const PackedSegment* measurement;
    float scale;  // the weights', in the precision of what they multiply
    float offset;
    int scanner;
    int plane;
  };

  struct Values;

  Values ValuesOf(double const* const* parameters) const;
  void AddOwnScanner(const ScanLine& scan_line,
                     const Values& at,
                     const NodePoses& poses,
                     const LineSystem& line,
                     const Spread& spread,
                     size_t scanner,
                     Quadratic* quadratic) const;
  void SetMountReaches(const std::vector<int>& among_estimated,
                       const std::vector<Segment>& segments);
  template <bool kPlanesHeld>
  void Sum(double const* const* parameters, Quadratic* quadratic) const;
  // Adds up a scan line's members, from this one on; poses: of the body at its nodes.
  template <bool kPlanesHeld>
  void SumMembers(size_t begin,
                  const ScanLine& scan_line,
                  const Values& at,
                  const NodePoses& poses,
                  LineSystem* line,
                  Quadratic* quadratic) const;

  int num_control_points_;
  double knot_interval_s_;
  std::vector<Scanner> scanners_;
  int num_estimated_scanners_ = 0;
  std::vector<Plane> planes_;
  std::vector<int> plane_offsets_;
  std::vector<int> scanner_offsets_;
  std::vector<MountAtNodes> mount_motions_;
  std::vector<Eigen::Vector2d> mount_reaches_;  // by estimated scanner
  std::vector<ScanLine> scan_lines_;  // by their first node
  std::vector<Member> members_;       // by scan line
  double huber_width_;
};

}  // namespace plumbline
