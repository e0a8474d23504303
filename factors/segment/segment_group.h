#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "factors/manifold/plane_model.h"
#include "factors/segment/packed_segment.h"
#include "factors/segment/scanner_block.h"
#include "factors/segment/segment_measurement.h"
#include "factors/spline/spline.h"

namespace plumbline {

struct LineSystem;  // of a scan line
struct NodePoses;

// All segments of one stretch of the trajectory as one least squares term. Its cost is the sum
// of the segments' costs (CreateSegmentFactor, with Huber's loss where asked for); what they
// share, the spline's steps above all, is computed once.
//
// A scanner is constant, or a parameter block about the pose that is stated for it
// (factors/segment/scanner_block.h).
class SegmentGroup {
 public:
  struct Scanner {
    ScannerPose body_from_scanner;
    bool estimated = false;
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
  };

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
  // squares. knot_interval_s: what a scanner's delay is measured by.
  SegmentGroup(int num_control_points,
               double knot_interval_s,
               std::vector<Scanner> scanners,
               std::vector<Plane> planes,
               std::vector<Segment> segments,
               double huber_width);

  int num_control_points() const { return num_control_points_; }
  int num_estimated_scanners() const { return num_estimated_scanners_; }
  const std::vector<Plane>& planes() const { return planes_; }
  // First row of a plane's parameters; the last element is the number of rows.
  const std::vector<int>& plane_offsets() const { return plane_offsets_; }
  // First row of an estimated scanner's parameters, counted among the estimated ones.
  int ScannerOffset(int scanner) const {
    return plane_offsets_.back() + kScannerBlockSize * scanner;
  }
  int size() const { return ScannerOffset(num_estimated_scanners_); }

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
  std::vector<ScanLine> scan_lines_;  // by their first node
  std::vector<Member> members_;       // by scan line
  double huber_width_;
};

}  // namespace plumbline
