#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/estimation/arrowhead_cholesky.h"
#include "core/estimation/block_layout.h"
#include "core/estimation/border_solver.h"
#include "core/map/observation.h"
#include "core/map/observation_poses.h"
#include "core/map/rig_calibration.h"
#include "core/sensor/rig.h"
#include "core/surface/landmark.h"
#include "core/trajectory/trajectory.h"
#include "factors/segment/segment_rows.h"
#include "factors/spline/spline.h"

namespace plumbline {

// ErrorPatterns sums up what errors that repeat from scan to scan would do to the residuals of
// a recording and, through them, to its estimate. Two kinds of patterns:
//
//   scanners: range bias (m), rotation (rad) and translation (m) of the mounting, in the
//             scanner's frame; constant for the recording. A depth camera has one mounting,
//             that of its first row. A rig whose scanners are estimated has none: the estimate
//             adapts to them
//   cells:    a surface that deviates from its plane by some distance (m) at one node of a
//             grid, falling off to none at the next nodes (bilinear)
//
// A pattern v changes the whitened residuals of a segment by U (v, v, v), v being the
// deviation's ( slope along, slope across, offset ) in the segment's frame (PackedSegment).
// The cells are too many to have columns of their own: random combinations of them stand in
// ("probes", each cell with a random sign).
class ErrorPatterns {
 public:
  static constexpr int kPerScanner = 7;       // range, 3 rotation, 3 translation
  static constexpr int kNumProbes = 96;       // 14 % of a variance that they alone give
  static constexpr int kNumTraceProbes = 24;  // of these, for sums over all pairs of cells

  // rig: with the scanners' poses of the calibration. All of them outlive the patterns, which
  // have probes for the sums over pairs of cells only.
  ErrorPatterns(const Rig& rig,
                const RigCalibration& calibration,
                const Trajectory& trajectory,
                const std::deque<Landmark>& landmarks,
                const BlockLayout& layout,
                bool planar);
  // Makes patterns with all probes, and with the effects of single cells on the landmarks.
  // factor: of the normal matrix, in the layout's columns.
  ErrorPatterns(const Rig& rig,
                const RigCalibration& calibration,
                const Trajectory& trajectory,
                const std::deque<Landmark>& landmarks,
                const BlockLayout& layout,
                bool planar,
                const ArrowheadCholesky& factor);

  // What a surface's cells deviate by where a pattern is 1, by landmark; 1 unless set, before
  // any segment is taken in.
  void SetDeviations(std::vector<double> deviations) { deviations_ = std::move(deviations); }
  // Takes in one more segment, which has a landmark. Near the last ones in time, for speed.
  void Add(const Observation& observation);

  int num_scanner_patterns() const { return num_scanner_patterns_; }
  // Returns an orthonormal basis of the patterns that turn and shift all scanners together, as
  // the body would.
  Eigen::MatrixXd CommonScannerPatterns() const;
  // J^T V by column: the scanners' patterns, then the probes. May be taken away.
  const Eigen::MatrixXd& loads() const { return loads_; }
  Eigen::MatrixXd TakeLoads() { return std::move(loads_); }
  // V^T V of the scanners' patterns and the first kNumTraceProbes probes.
  const Eigen::MatrixXd& products() const { return products_; }
  // V^T r.
  const Eigen::VectorXd& scanner_scores() const { return scanner_scores_; }
  const std::vector<double>& cell_scores() const { return cell_scores_; }
  // Scanners' errors, and how they have moved the estimate, that later RescoreCells() take
  // away.
  void Explain(const Eigen::VectorXd& errors, const Eigen::VectorXd& moved);
  // Sums up a segment's scores of its cells anew, without what has been explained.
  void RescoreCells(const Observation& observation);
  // Sums up a segment's scores of its cells for the probes' deviations instead of residuals,
  // as far as the estimate does not adapt to them. shifts: of the estimate, by the probes for
  // traces.
  void ScoreProbes(const Observation& observation, const Eigen::MatrixXd& shifts);
  // Squares of a surface's scores, summed over its cells.
  struct SurfaceScores {
    double squares = 0.0;   // of the residuals
    double by_noise = 0.0;  // expected of the noise alone
    // Without noise, of the probes' deviations: the expected sum for all cells' deviations by
    // 1, and its standard deviation.
    double by_deviation = 0.0;
    double stddev = 0.0;
  };
  // By landmark, after ScoreProbes() for all segments.
  std::vector<SurfaceScores> ScoresBySurface() const;
  // Mean square of the cells' deviations where their patterns are 1.
  double MeanSquareDeviation() const;
  // Returns the effect of each cell's pattern on the landmarks: their parameters x
  // cells. To be called once.
  Eigen::MatrixXd TakeCellEffectsOnLandmarks();

 private:
  // Poses at the nodes of a scan line.
  struct Nodes {
    std::array<int64_t, 3> times_ns = {};
    double delay_s = 0.0;  // of the scanner, at which the poses are looked up
    Rigid3d middle;        // world_from_body at the second
    NodePoses poses;
    std::array<Eigen::Vector3d, 3> angular;  // rad/s, world
    std::array<Eigen::Vector3d, 3> linear;   // m/s, world
    std::array<Trajectory::Location, 3> at;
  };
  // Six control points at most have a part in a segment, and two nodes of the IMU's biases lie
  // among them.
  using PoseLoad = Eigen::Matrix<double, Eigen::Dynamic, 3, 0, 48, 3>;
  // A segment's rows with respect to (slope along, slope across, offset), the same at all
  // nodes.
  struct Basis {
    int first_column = 0;  // of the control points
    PoseLoad pose_load;    // J^T U, their rows x 3
    Eigen::Matrix3d plane_load;
    Eigen::Matrix<double, Eigen::Dynamic, 3, 0, kMountedBlockSize, 3> scanner_load;
    int scanner_column = -1;  // of the scanner's block; -1: not estimated
    Eigen::Matrix3d product;  // U^T U
    Eigen::Vector3d score;    // U^T r
  };
  // The share of a cell in a segment: its pattern moves the line that fits the segment best by
  // this.
  struct CellShare {
    int cell = 0;
    double offset = 0.0;
    double slope = 0.0;
  };
  using Coefficients = Eigen::Matrix<double, 3, Eigen::Dynamic>;
  bool Has(const Observation& observation) const;
  int num_probes() const {
    return static_cast<int>(coefficients_.cols()) - num_scanner_patterns_;
  }
  void Resize(int num_probes);
  const Nodes& NodesOf(const Observation& observation);
  Basis BasisOf(const Observation& observation, const Nodes& nodes) const;
  template <typename Model>
  Basis BasisOn(const Model& model,
                const Observation& observation,
                const SegmentWeights& weights,
                const Nodes& nodes) const;
  // How a scanner's block moves the body at a node.
  Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, kMountedBlockSize> ByScanner(
      const Nodes& nodes, int k, int scanner) const;
  // A scanner's pose in the body at a node.
  Rigid3d BodyFromScanner(const Nodes& nodes, size_t k, int scanner) const;
  void AddPoseLoad(const Nodes& nodes,
                   int k,
                   const Eigen::Matrix<double, kNodePoseSize, 1>& by_node,
                   int first_column,
                   Eigen::Ref<Eigen::VectorXd> load) const;
  // What of shifts of the estimate a segment's slopes and offset see, 3 x shifts.
  Eigen::Matrix3Xd SeenOf(const Observation& observation,
                          const Basis& basis,
                          const Eigen::Ref<const Eigen::MatrixXd>& shifts) const;
  // Sets the columns of the probes by the shares of the cells.
  void SetProbeCoefficients();
  // The columns of a scanner's own patterns and the shares of the cells.
  void SetScannerCoefficients(const Observation& observation, const Nodes& nodes);
  // Adds what the shares of the segment in work do to the landmarks.
  void AddCellEffects(const Basis& basis, int plane_column, int plane_size);
  // Walks along the segment: the cells it crosses and its pattern of a range bias.
  Eigen::Vector3d WalkAlong(const Observation& observation,
                            const Rigid3d& world_from_scanner,
                            const Landmark& landmark);
  // The cells around a place on the grid of a landmark's surface.
  std::array<int, 4> CellsAround(const Landmark& landmark, int u, int v);
  int CellAt(const Landmark& landmark, int u, int v);
  // Adds a place's part in a segment's line to the cells around it.
  void Share(const Landmark& landmark,
             const Eigen::Vector3d& p_world,
             double offset,
             double slope);

  const Rig& rig_;
  const RigCalibration& calibration_;
  const Trajectory& trajectory_;
  const std::deque<Landmark>& landmarks_;
  const BlockLayout& layout_;
  const bool planar_;
  const int num_band_;
  const bool has_scanners_;
  const std::vector<size_t> owners_;  // by scanner: the one whose patterns it has
  std::vector<int> own_columns_;      // by scanner: of its first pattern
  const int num_scanner_patterns_;
  std::vector<Eigen::Matrix<double, 3, 2>> axes_;  // of a surface's grid, by landmark
  std::vector<int> rotation_columns_;              // by control point
  std::vector<int> landmark_columns_;              // by id; -1: not estimated
  std::vector<int> scanner_columns_;               // by scanner; -1: not estimated
  std::optional<BorderSolver> cell_effects_;       // on the landmarks; column: a cell
  std::vector<Nodes> nodes_;                       // of the last scan lines
  size_t next_nodes_ = 0;
  std::vector<double> deviations_;           // by landmark; empty: 1
  std::unordered_map<uint64_t, int> cells_;  // by landmark and node
  std::vector<int> surfaces_;                // by cell: its landmark
  std::vector<CellShare> shares_;            // of the segment in work
  int shares_u_ = 0;                         // the node of the last four
  int shares_v_ = 0;
  Coefficients coefficients_;
  Eigen::VectorXd explained_errors_;
  Eigen::VectorXd explained_move_;
  Eigen::MatrixXd loads_;
  Eigen::MatrixXd products_;
  Eigen::VectorXd scanner_scores_;
  std::vector<double> cell_scores_;
  std::vector<Eigen::Matrix<double, kNumProbes, 1>> signs_;  // by cell
  std::vector<Eigen::Matrix<double, kNumTraceProbes, 1>> probe_scores_;
};

}  // namespace plumbline
