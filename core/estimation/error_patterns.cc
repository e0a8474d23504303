#include "core/estimation/error_patterns.h"

#include <glog/logging.h>

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "core/estimation/segment_groups.h"
#include "core/geometry/cell_key.h"
#include "core/geometry/rigid3.h"
#include "core/surface/landmark_view.h"
#include "factors/segment/segment_measurement.h"

namespace plumbline {
namespace {

// Between the nodes of a surface. Interpolated like this, white noise is about as steep and as
// far correlated as unevenness of which exp(-d^2 / (2 (0.5 m)^2)) is left at a distance d.
constexpr double kCellM = 0.7;
constexpr double kStepM = 0.25;  // along a segment
constexpr int kMaxSteps = 80;
constexpr double kMinMoment = 1e-6;  // m^2, below which a segment has no slope
constexpr size_t kNumNodesKept = 4;  // scan lines; a scan's are asked for in any order

// The next state of a generator of random signs (Knuth's MMIX).
uint64_t NextRandom(uint64_t state) {
  return state * 6364136223846793005u + 1442695040888963407u;
}

// Slopes and offset, in the segment's frame, of a distance that is linear in the scan plane.
Eigen::Vector3d InFrame(const SegmentFrame& frame, double by_x, double by_y, double constant) {
  return frame.Matrix().transpose() * Eigen::Vector3d(by_x, by_y, constant);
}

// By scanner: the scanner by whose mounting it errs, itself or the first row of its camera.
std::vector<size_t> OwnersOf(const Rig& rig) {
  std::vector<size_t> owners;
  for (const Scanner& scanner : rig.scanners) {
    const auto first = std::find_if(
        rig.scanners.begin(), rig.scanners.end(), [&scanner](const Scanner& other) {
          return scanner.camera_row && other.camera_row &&
                 scanner.camera_row->camera == other.camera_row->camera;
        });
    owners.push_back(scanner.camera_row ? static_cast<size_t>(first - rig.scanners.begin())
                                        : owners.size());
  }
  return owners;
}

int NumDifferent(const std::vector<size_t>& owners) {
  return static_cast<int>(std::set<size_t>(owners.begin(), owners.end()).size());
}

}  // namespace

ErrorPatterns::ErrorPatterns(const Rig& rig,
                             const RigCalibration& calibration,
                             const Trajectory& trajectory,
                             const std::deque<Landmark>& landmarks,
                             const BlockLayout& layout,
                             bool planar)
    : rig_(rig),
      calibration_(calibration),
      trajectory_(trajectory),
      landmarks_(landmarks),
      layout_(layout),
      planar_(planar),
      num_band_(layout.NumBandColumns()),
      has_scanners_(calibration.scanners.empty()),
      owners_(OwnersOf(rig)),
      num_scanner_patterns_(has_scanners_ ? kPerScanner * NumDifferent(owners_) : 0),
      rotation_columns_(static_cast<size_t>(trajectory.num_control_points()), -1),
      landmark_columns_(landmarks.size(), -1),
      scanner_columns_(rig.scanners.size(), -1) {
  for (const Landmark& landmark : landmarks) {
    axes_.push_back(landmark.Tangents(landmark.Normal()));
  }
  for (size_t i = 0; i < layout.blocks.size(); ++i) {
    const auto index = static_cast<size_t>(layout.blocks[i].index);
    if (layout.blocks[i].kind == BlockId::Kind::kRotation) {
      rotation_columns_[index] = layout.offsets[i];
    }
    if (IsScanner(layout.blocks[i])) scanner_columns_[index] = layout.offsets[i];
    if (IsLandmark(layout.blocks[i])) landmark_columns_[index] = layout.offsets[i];
  }
  int column = 0;
  for (size_t i = 0; i < owners_.size(); ++i) {
    own_columns_.push_back(owners_[i] == i ? column : own_columns_[owners_[i]]);
    if (owners_[i] == i) column += kPerScanner;
  }
  const int num_products = num_scanner_patterns_ + kNumTraceProbes;
  products_ = Eigen::MatrixXd::Zero(num_products, num_products);
  scanner_scores_ = Eigen::VectorXd::Zero(num_scanner_patterns_);
  Resize(kNumTraceProbes);
}

ErrorPatterns::ErrorPatterns(const Rig& rig,
                             const RigCalibration& calibration,
                             const Trajectory& trajectory,
                             const std::deque<Landmark>& landmarks,
                             const BlockLayout& layout,
                             bool planar,
                             const ArrowheadCholesky& factor)
    : ErrorPatterns(rig, calibration, trajectory, landmarks, layout, planar) {
  Resize(kNumProbes);
  cell_effects_.emplace(factor);
}

void ErrorPatterns::Resize(int num_probes) {
  const int num_columns = num_scanner_patterns_ + num_probes;
  coefficients_.resize(3, num_columns);
  loads_ = Eigen::MatrixXd::Zero(layout_.size(), num_columns);
}

const ErrorPatterns::Nodes& ErrorPatterns::NodesOf(const Observation& observation) {
  const std::array<int64_t, 3> times_ns = observation.measurement.node_times_ns();
  const double delay_s = rig_.scanners[static_cast<size_t>(observation.scanner_index)].delay_s;
  for (const Nodes& nodes : nodes_) {
    if (nodes.times_ns == times_ns && nodes.delay_s == delay_s) return nodes;
  }
  if (nodes_.size() < kNumNodesKept) nodes_.emplace_back();
  Nodes& nodes = nodes_[next_nodes_];
  next_nodes_ = (next_nodes_ + 1) % kNumNodesKept;
  nodes.times_ns = times_ns;
  nodes.delay_s = delay_s;
  PoseSampler sampler(trajectory_);
  for (size_t k = 0; k < 3; ++k) {
    nodes.at[k] = trajectory_.Locate(times_ns[k]);
    const Rigid3d world_from_body = sampler.WorldFromBody(times_ns[k], delay_s);
    nodes.poses.world_from_body[k] = world_from_body.rotation.toRotationMatrix();
    nodes.poses.position[k] = world_from_body.translation;
    nodes.poses.splines[k] = trajectory_.PoseJacobian(nodes.at[k]);
    if (k == 1) nodes.middle = world_from_body;
    trajectory_.Velocity(times_ns[k], &nodes.angular[k], &nodes.linear[k]);
  }
  return nodes;
}

// Adds the load of a node's pose, by the chain rule through the spline, to the rows of its
// control points, which begin with a column's.
void ErrorPatterns::AddPoseLoad(const Nodes& nodes,
                                int k,
                                const Eigen::Matrix<double, kNodePoseSize, 1>& by_node,
                                int first_column,
                                Eigen::Ref<Eigen::VectorXd> load) const {
  const int rotation_size = planar_ ? 1 : 3;
  const auto node = static_cast<size_t>(k);
  for (int j = 0; j < kSplineOrder; ++j) {
    const auto index = static_cast<size_t>(j);
    const int row =
        rotation_columns_[static_cast<size_t>(nodes.at[node].first + j)] - first_column;
    const Eigen::Vector3d by_rotation =
        nodes.poses.splines[node].rotation_wrt_control[index].transpose() * by_node.head<3>();
    load.segment(row, rotation_size) += by_rotation.tail(rotation_size);
    load.segment<3>(row + rotation_size) +=
        nodes.poses.splines[node].position_weights[index] * by_node.tail<3>();
    if (planar_) load[row + rotation_size + 2] = 0.0;
  }
}

Rigid3d ErrorPatterns::BodyFromScanner(const Nodes& nodes, size_t k, int scanner) const {
  return rig_.scanners[static_cast<size_t>(scanner)].BodyFromScanner(nodes.times_ns[k]);
}

Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, kMountedBlockSize> ErrorPatterns::ByScanner(
    const Nodes& nodes, int k, int scanner) const {
  Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, kMountedBlockSize> by_scanner;
  const auto node = static_cast<size_t>(k);
  const auto index = static_cast<size_t>(scanner);
  const int column = scanner_columns_[index];
  if (column < 0) {
    by_scanner.setZero(6, kScannerBlockSize);
    return by_scanner;
  }
  const Scanner& described = rig_.scanners[index];
  const ScannerEstimate& estimate = calibration_.scanners[index];
  const Rigid3d& body_from_scanner = described.body_from_scanner;
  const ScannerPose at_zero = {body_from_scanner.rotation.toRotationMatrix(),
                               body_from_scanner.translation};
  if (estimate.is_mounted) {
    by_scanner = BodyMotionByMounted(
        nodes.poses.world_from_body[node],
        at_zero,
        estimate.stated_mount,
        MotionOf(*described.mount, nodes.times_ns[node], described.delay_s),
        estimate.block.data(),
        nodes.angular[node],
        nodes.linear[node]);
  } else {
    by_scanner = BodyMotionByScanner(nodes.poses.world_from_body[node],
                                     at_zero,
                                     estimate.block.data(),
                                     nodes.angular[node],
                                     nodes.linear[node]);
  }
  return by_scanner;
}

template <typename Model>
ErrorPatterns::Basis ErrorPatterns::BasisOn(const Model& model,
                                            const Observation& observation,
                                            const SegmentWeights& weights,
                                            const Nodes& nodes) const {
  const Landmark& landmark = landmarks_[static_cast<size_t>(observation.landmark_id)];
  const auto scanner = static_cast<size_t>(observation.scanner_index);
  const PackedSegment& segment = observation.measurement;
  const int num_nodes = segment.num_nodes();
  Basis basis;
  basis.scanner_column = scanner_columns_[scanner];
  ScannerAtNodes at_nodes;
  for (size_t k = 0; k < kNumSegmentNodes; ++k) {
    const Rigid3d body_from_scanner = BodyFromScanner(nodes, k, observation.scanner_index);
    at_nodes[k] = nodes.poses.world_from_body[k] *
                  AxesAndOrigin({body_from_scanner.rotation.toRotationMatrix(),
                                 body_from_scanner.translation});
  }
  SegmentRows<Model::kSize> rows;
  Differentiate(model,
                segment,
                weights,
                at_nodes,
                nodes.poses,
                landmark.parameters.data(),
                DerivativesNear(model, landmark.parameters.data(), landmark.chart.anchor),
                basis.scanner_column < 0
                    ? nullptr
                    : &calibration_.scanners[scanner].block[kScannerRangeAt],
                &rows);
  // What slopes and offset do, the same at all nodes; nothing in rows beyond the segment's.
  const SegmentMeasurement::Rows stored = segment.rows().cast<double>();
  Eigen::Matrix<double, Eigen::Dynamic, 3, 0, SegmentRows<Model::kSize>::kMaxRows, 3> root;
  root.setZero(rows.residuals.size(), 3);
  for (int k = 0; k < num_nodes; ++k) {
    root.topRows(stored.rows()) += weights.scale * stored.middleCols<3>(3 * k);
  }
  basis.product = root.transpose() * root;
  basis.score = root.transpose() * rows.residuals;
  basis.plane_load.setZero();
  basis.plane_load.template topRows<Model::kSize>() =
      rows.jacobian.template rightCols<Model::kSize>().transpose() * root;
  if (landmark.heading_fixed) basis.plane_load.row(0).setZero();
  basis.first_column = rotation_columns_[static_cast<size_t>(nodes.at[0].first)];
  const int end_column =
      rotation_columns_[static_cast<size_t>(nodes.at[2].first + kSplineOrder - 1)] +
      (planar_ ? 4 : 6);
  CHECK_LE(end_column - basis.first_column, PoseLoad::MaxRowsAtCompileTime);
  basis.pose_load = PoseLoad::Zero(end_column - basis.first_column, 3);
  const int scanner_size = basis.scanner_column < 0
                               ? kScannerBlockSize
                               : calibration_.scanners[scanner].BlockSize();
  basis.scanner_load.setZero(scanner_size, 3);
  for (int k = 0; k < num_nodes; ++k) {
    const Eigen::Matrix<double, kNodePoseSize, 3> load =
        rows.jacobian.template middleCols<kNodePoseSize>(kNodePoseSize * k).transpose() * root;
    for (int j = 0; j < 3; ++j) {
      AddPoseLoad(nodes, k, load.col(j), basis.first_column, basis.pose_load.col(j));
    }
    basis.scanner_load += ByScanner(nodes, k, observation.scanner_index).transpose() * load;
  }
  if (basis.scanner_column >= 0) {
    basis.scanner_load.middleRows<kNumRangeErrors>(kScannerRangeAt) =
        rows.by_range.transpose() * root;
    for (int i = 0; i < scanner_size; ++i) {
      const auto column = static_cast<size_t>(basis.scanner_column + i);
      if (!layout_.is_free[column]) basis.scanner_load.row(i).setZero();
    }
  }
  return basis;
}

ErrorPatterns::Basis ErrorPatterns::BasisOf(const Observation& observation,
                                            const Nodes& nodes) const {
  const Landmark& landmark = landmarks_[static_cast<size_t>(observation.landmark_id)];
  const Rigid3d world_from_scanner =
      nodes.middle * BodyFromScanner(nodes, 1, observation.scanner_index);
  const Eigen::Vector2d centroid = observation.centroid();
  const SegmentWeights weights =
      WeightsOn(observation,
                world_from_scanner.rotation,
                landmark.NormalNear(world_from_scanner *
                                    Eigen::Vector3d(centroid.x(), centroid.y(), 0.0)));
  return VisitPlaneModel(landmark.model, landmark.chart, [&](const auto& model) {
    return BasisOn(model, observation, weights, nodes);
  });
}

int ErrorPatterns::CellAt(const Landmark& landmark, int u, int v) {
  const auto [found, is_new] =
      cells_.try_emplace(CellKey({landmark.id, u, v}), static_cast<int>(cells_.size()));
  if (is_new) {
    uint64_t state = NextRandom(static_cast<uint64_t>(found->second) * 0x9e3779b97f4a7c15u);
    signs_.emplace_back();
    for (double& sign : signs_.back()) {
      state = NextRandom(state);
      sign = (state >> 63) != 0 ? 1.0 : -1.0;
    }
    cell_scores_.push_back(0.0);
    surfaces_.push_back(landmark.id);
  }
  return found->second;
}

std::array<int, 4> ErrorPatterns::CellsAround(const Landmark& landmark, int u, int v) {
  return {CellAt(landmark, u, v),
          CellAt(landmark, u, v + 1),
          CellAt(landmark, u + 1, v),
          CellAt(landmark, u + 1, v + 1)};
}

void ErrorPatterns::Share(const Landmark& landmark,
                          const Eigen::Vector3d& p_world,
                          double offset,
                          double slope) {
  const Eigen::Vector2d on_surface =
      landmark.IsCurved()
          ? landmark.extent.Project(p_world)
          : Eigen::Vector2d(axes_[static_cast<size_t>(landmark.id)].transpose() * p_world);
  const double u = on_surface.x() / kCellM;
  const double v = on_surface.y() / kCellM;
  const int first_u = static_cast<int>(std::floor(u));
  const int first_v = static_cast<int>(std::floor(v));
  const double by_u = u - first_u;
  const double by_v = v - first_v;
  const std::array<double, 4> weights = {
      (1.0 - by_u) * (1.0 - by_v), (1.0 - by_u) * by_v, by_u * (1.0 - by_v), by_u * by_v};
  if (shares_.empty() || first_u != shares_u_ || first_v != shares_v_) {
    for (const int cell : CellsAround(landmark, first_u, first_v)) {
      shares_.push_back({cell, 0.0, 0.0});
    }
    shares_u_ = first_u;
    shares_v_ = first_v;
  }
  const double deviation =
      deviations_.empty() ? 1.0 : deviations_[static_cast<size_t>(landmark.id)];
  for (size_t i = 0; i < 4; ++i) {
    CellShare& share = shares_[shares_.size() - 4 + i];
    share.offset += deviation * weights[i] * offset;
    share.slope += deviation * weights[i] * slope;
  }
}

Eigen::Vector3d ErrorPatterns::WalkAlong(const Observation& observation,
                                         const Rigid3d& world_from_scanner,
                                         const Landmark& landmark) {
  shares_.clear();
  const SegmentFrame& frame = observation.measurement.frame();
  const Eigen::Vector2d origin = frame.origin.cast<double>();
  const Eigen::Vector2d tangent = frame.tangent.cast<double>();
  const double from = tangent.dot(observation.start() - origin);
  const double length = tangent.dot(observation.end() - origin) - from;
  const int steps =
      std::clamp(static_cast<int>(std::ceil(std::abs(length) / kStepM)), 2, kMaxSteps);
  const double step = length / steps;
  const double middle = from + 0.5 * length;
  // A beam's weight grows with the square of its range as the beams thin out: the information
  // is spread evenly along the segment.
  const double moment = (steps * steps - 1) * steps * step * step / 12.0;
  const double height = landmark.SignedDistance(world_from_scanner.translation);
  double bias_offset = 0.0;
  double bias_slope = 0.0;
  for (int i = 0; i < steps; ++i) {
    const double along = from + (i + 0.5) * step;
    const Eigen::Vector2d p = origin + along * tangent;
    const double slope = moment > kMinMoment ? (along - middle) / moment : 0.0;  // one beam
    Share(landmark,
          world_from_scanner * Eigen::Vector3d(p.x(), p.y(), 0.0),
          1.0 / steps - slope * middle,
          slope);
    const double bias = -height / p.norm();
    bias_offset += bias / steps;
    bias_slope += bias * slope;
  }
  return {bias_slope, 0.0, bias_offset - bias_slope * middle};
}

bool ErrorPatterns::Has(const Observation& observation) const {
  return landmark_columns_[static_cast<size_t>(observation.landmark_id)] >= 0;
}

void ErrorPatterns::SetScannerCoefficients(const Observation& observation,
                                           const Nodes& nodes) {
  const Landmark& landmark = landmarks_[static_cast<size_t>(observation.landmark_id)];
  const Rigid3d world_from_scanner =
      nodes.middle * BodyFromScanner(nodes, 1, observation.scanner_index);
  const auto scanner = static_cast<size_t>(observation.scanner_index);
  const int own = own_columns_[scanner];
  coefficients_.leftCols(num_scanner_patterns_).setZero();
  const Eigen::Vector3d by_range = WalkAlong(observation, world_from_scanner, landmark);
  if (!has_scanners_) return;
  coefficients_.col(own) = by_range;
  const Eigen::Vector2d centroid = observation.centroid();
  const Eigen::Vector3d m =
      world_from_scanner.rotation.conjugate() *
      landmark.NormalNear(world_from_scanner *
                          Eigen::Vector3d(centroid.x(), centroid.y(), 0.0));
  const SegmentFrame& frame = observation.measurement.frame();
  coefficients_.col(own + 1) = InFrame(frame, 0.0, m.z(), 0.0);
  coefficients_.col(own + 2) = InFrame(frame, -m.z(), 0.0, 0.0);
  coefficients_.col(own + 3) = InFrame(frame, m.y(), -m.x(), 0.0);
  for (int i = 0; i < 3; ++i) coefficients_(2, own + 4 + i) = m[i];
  if (owners_[scanner] == scanner) return;
  // The turns and shifts of the owner, along the scanner's axes.
  const Eigen::Matrix3d scanner_from_owner =
      (rig_.scanners[scanner].body_from_scanner.rotation.conjugate() *
       rig_.scanners[owners_[scanner]].body_from_scanner.rotation)
          .toRotationMatrix();
  coefficients_.middleCols<3>(own + 1) *= scanner_from_owner;
  coefficients_.middleCols<3>(own + 4) *= scanner_from_owner;
}

void ErrorPatterns::Explain(const Eigen::VectorXd& errors, const Eigen::VectorXd& moved) {
  explained_errors_ = errors;
  explained_move_ = moved;
  std::fill(cell_scores_.begin(), cell_scores_.end(), 0.0);
}

Eigen::Matrix3Xd ErrorPatterns::SeenOf(const Observation& observation,
                                       const Basis& basis,
                                       const Eigen::Ref<const Eigen::MatrixXd>& shifts) const {
  const auto id = static_cast<size_t>(observation.landmark_id);
  const int plane_size = landmarks_[id].num_parameters();
  Eigen::Matrix3Xd seen = basis.pose_load.transpose() *
                          shifts.middleRows(basis.first_column, basis.pose_load.rows());
  seen += basis.plane_load.topRows(plane_size).transpose() *
          shifts.middleRows(landmark_columns_[id], plane_size);
  if (basis.scanner_column >= 0) {
    seen += basis.scanner_load.transpose() *
            shifts.middleRows(basis.scanner_column, basis.scanner_load.rows());
  }
  return seen;
}

void ErrorPatterns::RescoreCells(const Observation& observation) {
  if (!Has(observation)) return;
  const Nodes& nodes = NodesOf(observation);
  const Basis basis = BasisOf(observation, nodes);
  SetScannerCoefficients(observation, nodes);
  const Eigen::Vector3d score =
      basis.score + SeenOf(observation, basis, explained_move_) -
      basis.product * (coefficients_.leftCols(num_scanner_patterns_) * explained_errors_);
  for (const CellShare& share : shares_) {
    cell_scores_[static_cast<size_t>(share.cell)] +=
        share.slope * score[0] + share.offset * score[2];
  }
}

void ErrorPatterns::SetProbeCoefficients() {
  auto by_probe = coefficients_.rightCols(num_probes());
  by_probe.setZero();
  for (const CellShare& share : shares_) {
    const auto signs = signs_[static_cast<size_t>(share.cell)].head(num_probes()).transpose();
    by_probe.row(0) += share.slope * signs;
    by_probe.row(2) += share.offset * signs;
  }
}

void ErrorPatterns::ScoreProbes(const Observation& observation,
                                const Eigen::MatrixXd& shifts) {
  if (!Has(observation)) return;
  const Nodes& nodes = NodesOf(observation);
  const Basis basis = BasisOf(observation, nodes);
  SetScannerCoefficients(observation, nodes);
  SetProbeCoefficients();
  probe_scores_.resize(cell_scores_.size(), Eigen::Matrix<double, kNumTraceProbes, 1>::Zero());
  const Eigen::Matrix3Xd scores =
      basis.product * coefficients_.middleCols<kNumTraceProbes>(num_scanner_patterns_) -
      SeenOf(observation, basis, shifts);
  for (const CellShare& share : shares_) {
    probe_scores_[static_cast<size_t>(share.cell)] +=
        (share.slope * scores.row(0) + share.offset * scores.row(2)).transpose();
  }
}

std::vector<ErrorPatterns::SurfaceScores> ErrorPatterns::ScoresBySurface() const {
  using ByProbe = Eigen::Array<double, kNumTraceProbes, 1>;
  std::vector<SurfaceScores> by_surface(landmarks_.size());
  std::vector<ByProbe> sums(landmarks_.size(), ByProbe::Zero());
  std::vector<double> of_single_cells(landmarks_.size(), 0.0);
  for (size_t cell = 0; cell < probe_scores_.size(); ++cell) {
    const auto id = static_cast<size_t>(surfaces_[cell]);
    const double by_itself =
        probe_scores_[cell].dot(signs_[cell].head<kNumTraceProbes>()) / kNumTraceProbes;
    by_surface[id].squares += cell_scores_[cell] * cell_scores_[cell];
    by_surface[id].by_noise += by_itself;
    sums[id] += probe_scores_[cell].array().square();
    of_single_cells[id] += std::pow(by_itself, 4);
  }
  for (size_t id = 0; id < by_surface.size(); ++id) {
    by_surface[id].by_deviation = sums[id].mean();
    // The probes are signs, whose squares do not scatter as those of a normal distribution do.
    by_surface[id].stddev =
        std::sqrt((sums[id] - sums[id].mean()).square().mean() + 2.0 * of_single_cells[id]);
  }
  return by_surface;
}

double ErrorPatterns::MeanSquareDeviation() const {
  if (deviations_.empty() || surfaces_.empty()) return 1.0;
  double sum = 0.0;
  for (const int surface : surfaces_) {
    const double deviation = deviations_[static_cast<size_t>(surface)];
    sum += deviation * deviation;
  }
  return sum / static_cast<double>(surfaces_.size());
}

void ErrorPatterns::Add(const Observation& observation) {
  if (!Has(observation)) return;
  const Landmark& landmark = landmarks_[static_cast<size_t>(observation.landmark_id)];
  const int plane_column = landmark_columns_[static_cast<size_t>(landmark.id)];
  const Nodes& nodes = NodesOf(observation);
  const Basis basis = BasisOf(observation, nodes);
  SetScannerCoefficients(observation, nodes);
  SetProbeCoefficients();
  const int num_pose_rows = static_cast<int>(basis.pose_load.rows());
  const int plane_size = landmark.num_parameters();
  for (const CellShare& share : shares_) {
    cell_scores_[static_cast<size_t>(share.cell)] +=
        share.slope * basis.score[0] + share.offset * basis.score[2];
  }
  if (cell_effects_) AddCellEffects(basis, plane_column, plane_size);
  loads_.middleRows(basis.first_column, num_pose_rows).noalias() +=
      basis.pose_load.lazyProduct(coefficients_);
  loads_.middleRows(plane_column, plane_size).noalias() +=
      basis.plane_load.topRows(plane_size).lazyProduct(coefficients_);
  if (basis.scanner_column >= 0) {
    loads_.middleRows(basis.scanner_column, basis.scanner_load.rows()).noalias() +=
        basis.scanner_load.lazyProduct(coefficients_);
  }
  const auto leading = coefficients_.leftCols(products_.cols());
  products_.noalias() += leading.transpose().lazyProduct(basis.product * leading);
  scanner_scores_.noalias() +=
      coefficients_.leftCols(num_scanner_patterns_).transpose() * basis.score;
}

void ErrorPatterns::AddCellEffects(const Basis& basis, int plane_column, int plane_size) {
  Eigen::Matrix3Xd by_share = Eigen::Matrix3Xd::Zero(3, static_cast<int>(shares_.size()));
  std::vector<int> cells;
  for (const CellShare& share : shares_) {
    const auto j = static_cast<Eigen::Index>(cells.size());
    by_share(0, j) = share.slope;
    by_share(2, j) = share.offset;
    cells.push_back(share.cell);
  }
  cell_effects_->AddToBand(basis.first_column, basis.pose_load * by_share, cells);
  cell_effects_->AddToBorder(
      plane_column - num_band_, basis.plane_load.topRows(plane_size) * by_share, cells);
  if (basis.scanner_column < 0) return;
  cell_effects_->AddToBorder(
      basis.scanner_column - num_band_, basis.scanner_load * by_share, cells);
}

Eigen::MatrixXd ErrorPatterns::TakeCellEffectsOnLandmarks() {
  return cell_effects_->TakeSolution();
}

Eigen::MatrixXd ErrorPatterns::CommonScannerPatterns() const {
  if (!has_scanners_) return Eigen::MatrixXd::Zero(num_scanner_patterns_, 0);
  Eigen::MatrixXd common = Eigen::MatrixXd::Zero(num_scanner_patterns_, 6);
  for (size_t i = 0; i < rig_.scanners.size(); ++i) {
    if (owners_[i] != i) continue;
    const Rigid3d& body_from_scanner = rig_.scanners[i].body_from_scanner;
    const Eigen::Matrix3d scanner_from_body =
        body_from_scanner.rotation.toRotationMatrix().transpose();
    const Eigen::Vector3d& at = body_from_scanner.translation;
    const auto row = static_cast<Eigen::Index>(own_columns_[i]) + 1;
    for (int j = 0; j < 3; ++j) {
      const Eigen::Vector3d axis = Eigen::Vector3d::Unit(j);
      common.block<3, 1>(row, j) = scanner_from_body * axis;
      common.block<3, 1>(row + 3, j) = scanner_from_body * axis.cross(at);
      common.block<3, 1>(row + 3, 3 + j) = scanner_from_body * axis;
    }
  }
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(common);
  return qr.householderQ() * Eigen::MatrixXd::Identity(num_scanner_patterns_, 6);
}

}  // namespace plumbline
