#include "core/local_map/scan_matching.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "core/geometry/matrix_types.h"
#include "core/sensor/beam_instant.h"
#include "factors/linear_algebra/square_root_marginalisation.h"
#include "factors/spline/so3.h"

namespace plumbline {
namespace {

// What deviates by more than this many standard deviations hardly counts (Geman-McClure).
constexpr double kRobustWidth = 3.0;
// Points within so many standard deviations agree with the local map.
constexpr double kNear = 3.0;
// A surface's deviation is the same for so long: a beam's spot moves on by a cell's side with
// a rig at walking pace.
constexpr double kRepeatTime = 0.4;  // s
// Turns to either side that are tried: what lies between two of them moves points 4 m away by
// less than what the cells of this level take as near.
constexpr double kTurnStep = 1.5 * M_PI / 180.0;
constexpr double kMaxTurn = 30.0 * M_PI / 180.0;
constexpr double kTurnSigmas = 2.5;
constexpr int kTurnLevel = 1;
// Gauss-Newton steps with the cells of one level.
constexpr int kRoundsPerLevel = 6;
constexpr double kSmallStep = 1e-3;      // rad and m
constexpr double kTinyVariance = 1e-12;  // rad^2 and m^2
// Every how many-th scan the local map forgets.
constexpr int kForgetPeriod = 64;

// Collects the normal equations of a pose's error: rotation (rad, world frame), position (m).
class PoseEquations {
 public:
  explicit PoseEquations(const Rigid3d& world_from_body) : world_from_body_(world_from_body) {}

  void Add(const Eigen::Vector3d& p_world,
           const Eigen::Vector3d& normal,
           double residual,
           double weight) {
    Eigen::Matrix<double, 6, 1> row;
    row << (p_world - world_from_body_.translation).cross(normal), normal;
    hessian_.noalias() += weight * row * row.transpose();
    gradient_ += weight * residual * row;
  }

  const Matrix6d& hessian() const { return hessian_; }
  const Eigen::Matrix<double, 6, 1>& gradient() const { return gradient_; }
  PoseConstraint ConstraintAt(int64_t time_ns, double weight) const {
    PoseConstraint constraint;
    constraint.time_ns = time_ns;
    constraint.measurement.world_from_body = world_from_body_.rotation;
    constraint.measurement.position = world_from_body_.translation;
    const MarginalisedSystem root = Marginalise(weight * hessian_, weight * gradient_, 0);
    const Eigen::Index rank = root.root.rows();
    constraint.measurement.root.topRows(rank) = root.root;
    constraint.measurement.offset.head(rank) = root.offset;
    return constraint;
  }

 private:
  Rigid3d world_from_body_;
  Matrix6d hessian_ = Matrix6d::Zero();
  Eigen::Matrix<double, 6, 1> gradient_ = Eigen::Matrix<double, 6, 1>::Zero();
};

// The motion that turns about a point by a rotation vector and shifts.
Rigid3d About(const Eigen::Vector3d& p_world,
              const Eigen::Vector3d& rotation,
              const Eigen::Vector3d& shift) {
  const Eigen::Quaterniond turn = Exp(rotation);
  return {turn, p_world + shift - turn * p_world};
}

// The points of a scan line that follow each other in one cell.
struct CellPoints {
  const LocalCell* cell = nullptr;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  int num = 0;
};

}  // namespace

ScanMatcher::ScanMatcher(const Rig& rig,
                         bool planar,
                         const PointOptions& options,
                         double scan_period_s)
    : rig_(rig),
      options_(options),
      repeated_weight_(std::min(1.0, scan_period_s / kRepeatTime)),
      max_age_scans_(static_cast<int>(options.max_age_s / std::max(1e-3, scan_period_s))),
      maps_() {
  for (int level = 0; level < kNumLevels; ++level) {
    maps_.emplace_back(options.cell_m * (1 << level), planar);
  }
}

void ScanMatcher::Take(const Scan& scan) {
  lines_.resize(scan.scan_lines.size());
  for (size_t i = 0; i < lines_.size(); ++i) {
    const ScanLine& scan_line = scan.scan_lines[i];
    Line& line = lines_[i];
    line.scanner_index = scan_line.scanner_index;
    line.scan_line_index = scan.scan_line_indices[i];
    line.num_beams = scan_line.num_beams();
    line.beams.clear();
    line.p_scanner.clear();
    line.times_ns.clear();
    const Scanner& scanner = rig_.scanners[static_cast<size_t>(scan_line.scanner_index)];
    for (int beam = 0; beam < scan_line.num_beams(); ++beam) {
      const double range = scan_line.ranges[static_cast<size_t>(beam)];
      if (!scanner.IsValidRange(range)) continue;
      line.beams.push_back(beam);
      line.p_scanner.push_back(range * scan_line.BeamDirection(beam));
      line.times_ns.push_back(BeamInstant(scan_line, beam, rig_));
    }
  }
}

ScanMotion ScanMatcher::MotionOf(const Line& line, PoseSampler* poses) const {
  const Rigid3d& body_from_scanner =
      rig_.scanners[static_cast<size_t>(line.scanner_index)].body_from_scanner;
  const std::array<int64_t, 3> times_ns = {
      line.times_ns.front(), line.middle_ns(), line.times_ns.back()};
  std::array<Rigid3d, 3> world_from_scanner;
  for (size_t k = 0; k < 3; ++k) {
    world_from_scanner[k] = poses->WorldFromBody(times_ns[k]) * body_from_scanner;
  }
  return {times_ns, world_from_scanner};
}

void ScanMatcher::MatchLine(const Line& line,
                            int level,
                            const std::vector<bool>* chosen,
                            const Rigid3d& correction,
                            PoseSampler* poses,
                            ScanMatch* match) const {
  const double noise_m =
      rig_.scanners[static_cast<size_t>(line.scanner_index)].range_noise_m;
  const double surface_stddev_m = options_.surface_stddev_m * (1 << level);
  const double surface_variance = surface_stddev_m * surface_stddev_m;
  const ScanMotion motion = MotionOf(line, poses);
  PoseEquations equations(correction * poses->WorldFromBody(line.middle_ns()));
  const Eigen::Matrix3d turn = correction.rotation.toRotationMatrix();
  CellPoints current;
  int num_cells = 0;
  const auto take = [&] {
    if (current.cell == nullptr || current.cell->num_directions() == 0) return;
    const Eigen::Vector3d p_world = current.sum / current.num;
    const Eigen::Vector3d deviation = p_world - current.cell->Mean();
    match->num_known += current.num;
    bool is_near = true;
    for (int i = 0; i < current.cell->num_directions(); ++i) {
      const SurfaceDirection& direction = current.cell->direction(i);
      const double variance =
          surface_variance + (direction.variance + noise_m * noise_m) / current.num;
      const double residual = direction.normal.dot(deviation);
      const double share = residual * residual / (kRobustWidth * kRobustWidth * variance);
      is_near = is_near && residual * residual < kNear * kNear * variance;
      equations.Add(p_world,
                    direction.normal,
                    residual,
                    1.0 / (variance * (1.0 + share) * (1.0 + share)));
    }
    if (is_near) match->num_near += current.num;
    ++num_cells;
  };
  for (size_t i = 0; i < line.p_scanner.size(); ++i) {
    if (chosen != nullptr && !(*chosen)[static_cast<size_t>(line.beams[i])]) continue;
    const Eigen::Vector3d p_world =
        turn * motion.ToWorld(line.p_scanner[i], line.times_ns[i]) + correction.translation;
    const LocalCell* cell = maps_[static_cast<size_t>(level)].Find(p_world);
    if (cell != current.cell) {
      take();
      current = {cell, Eigen::Vector3d::Zero(), 0};
    }
    current.sum += p_world;
    ++current.num;
    ++match->num_points;
  }
  take();
  match->num_cells += num_cells;
  if (num_cells == 0) return;
  match->constraints.push_back(equations.ConstraintAt(line.middle_ns(), repeated_weight_));
  match->hessian += repeated_weight_ * equations.hessian();
  match->gradient += repeated_weight_ * equations.gradient();
}

ScanMatch ScanMatcher::MatchMoved(const Trajectory& trajectory,
                                  int level,
                                  const BeamMask* chosen,
                                  const Rigid3d& correction) const {
  PoseSampler poses(trajectory);
  ScanMatch match;
  for (size_t i = 0; i < lines_.size(); ++i) {
    if (lines_[i].beams.empty()) continue;
    MatchLine(lines_[i],
              level,
              chosen == nullptr ? nullptr : &(*chosen)[i],
              correction,
              &poses,
              &match);
  }
  return match;
}

Rigid3d ScanMatcher::BestTurn(const Trajectory& trajectory,
                              const Eigen::Vector3d& body_world,
                              double stddev_rad) const {
  const int num_steps =
      static_cast<int>(std::min(kMaxTurn, kTurnSigmas * stddev_rad) / kTurnStep);
  Rigid3d best;
  if (num_steps == 0) return best;
  int best_num_near = -1;
  for (int step = -num_steps; step <= num_steps; ++step) {
    const Rigid3d turn =
        About(body_world, Eigen::Vector3d(0.0, 0.0, step * kTurnStep), Eigen::Vector3d::Zero());
    const int num_near = MatchMoved(trajectory, kTurnLevel, nullptr, turn).num_near;
    if (num_near <= best_num_near) continue;
    best_num_near = num_near;
    best = turn;
  }
  return best;
}

ScanMatch ScanMatcher::Register(const Trajectory& trajectory,
                                const Matrix6d& covariance) const {
  const Eigen::Vector3d body_world = trajectory.WorldFromBody(middle_ns()).translation;
  // Planar rigs have no errors out of the plane.
  const Matrix6d information = (covariance + kTinyVariance * Matrix6d::Identity()).inverse();
  Rigid3d correction = BestTurn(trajectory, body_world, std::sqrt(covariance(2, 2)));
  Eigen::Matrix<double, 6, 1> error = Eigen::Matrix<double, 6, 1>::Zero();
  error.head<3>() = Log(correction.rotation);
  for (int level = kNumLevels - 1; level >= 0; --level) {
    for (int round = 0; round < kRoundsPerLevel; ++round) {
      const ScanMatch match = MatchMoved(trajectory, level, nullptr, correction);
      const Matrix6d hessian = match.hessian + information;
      const Eigen::Matrix<double, 6, 1> step =
          hessian.ldlt().solve(-(match.gradient + information * error));
      error += step;
      correction = About(correction * body_world, step.head<3>(), step.tail<3>()) * correction;
      if (step.norm() < kSmallStep) break;
    }
  }
  return MatchMoved(trajectory, 0, nullptr, correction);
}

int ScanMatcher::num_points() const {
  int num = 0;
  for (const Line& line : lines_) num += static_cast<int>(line.beams.size());
  return num;
}

int64_t ScanMatcher::middle_ns() const {
  const auto has_points = [](const Line& line) { return !line.beams.empty(); };
  const auto line = std::find_if(lines_.begin(), lines_.end(), has_points);
  return line == lines_.end() ? 0 : line->middle_ns();
}

BeamMask ScanMatcher::AllBeams() const {
  BeamMask mask;
  for (const Line& line : lines_)
    mask.emplace_back(static_cast<size_t>(line.num_beams), true);
  return mask;
}

void ScanMatcher::Exclude(int scan_line_index,
                          int first_beam,
                          int last_beam,
                          BeamMask* mask) const {
  for (size_t i = 0; i < lines_.size(); ++i) {
    if (lines_[i].scan_line_index != scan_line_index) continue;
    std::fill((*mask)[i].begin() + first_beam, (*mask)[i].begin() + last_beam + 1, false);
  }
}

void ScanMatcher::Remember(const Trajectory& trajectory) {
  PoseSampler poses(trajectory);
  for (const Line& line : lines_) {
    if (line.beams.empty()) continue;
    const ScanMotion motion = MotionOf(line, &poses);
    const Eigen::Matrix3d placement = motion.nodes()[1];
    const Eigen::Vector3d normal = placement.col(0).cross(placement.col(1));
    for (size_t i = 0; i < line.p_scanner.size(); ++i) {
      const Eigen::Vector3d p_world = motion.ToWorld(line.p_scanner[i], line.times_ns[i]);
      for (LocalMap& map : maps_) map.Add(p_world, normal, scan_index_);
    }
  }
  if (++scan_index_ % kForgetPeriod != 0) return;
  for (LocalMap& map : maps_) map.ForgetBefore(scan_index_ - max_age_scans_);
}

}  // namespace plumbline
