#include "core/registration/scan_matching.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/geometry/matrix_types.h"
#include "core/geometry/robust_fit.h"
#include "core/sensor/beam_instant.h"
#include "core/util/quantiles.h"
#include "factors/linear_algebra/square_root_marginalisation.h"
#include "factors/spline/so3.h"

namespace plumbline {
namespace {

// Time over which a surface's deviation repeats: a beam's spot moves on by a cell's side with
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
// Longest time whose points are served by one correction of the pose, ns.
constexpr int64_t kMaxSpanNs = 25'000'000;
// Coarse levels take one point of this number.
constexpr size_t kCoarseStride = 3;
// Side of the cells that tell what moves: half of what a person is wide. Points lie off by up
// to half of that for the noise and the prediction of the poses.
constexpr double kOccupancyCell = 0.2;  // m
// Share of moving points below which the scans of the next moment are not tested.
constexpr double kStillShare = 0.01;
constexpr double kStillTime = 0.1;  // s
// Time over which SeesMotion() averages.
constexpr double kMotionTime = 2.0;  // s
// With a larger share of the points in the way, the pose is wrong.
constexpr double kMaxMovingShare = 0.4;
// Number of beams of a scan line that are traced through the cells, and how often: from scan
// to scan, somebody who walks has hardly moved.
constexpr size_t kTracedBeams = 60;
constexpr double kTracePeriod = 0.05;  // s
// The local map forgets at these intervals.
constexpr double kForgetPeriod = 5.0;  // s

// The constraint that a fit of a pose's error says: rotation (rad, world frame), position (m).
PoseConstraint ConstraintOf(const RobustFit<6>& fit,
                            const Rigid3d& world_from_body,
                            int64_t time_ns,
                            double weight) {
  PoseConstraint constraint;
  constraint.time_ns = time_ns;
  constraint.measurement.world_from_body = world_from_body.rotation;
  constraint.measurement.position = world_from_body.translation;
  const MarginalisedSystem root =
      Marginalise(weight * fit.hessian(), weight * fit.gradient(), 0);
  const Eigen::Index rank = root.root.rows();
  constraint.measurement.root.topRows(rank) = root.root;
  constraint.measurement.offset.head(rank) = root.offset;
  return constraint;
}

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

// At least one.
int NumScans(double duration_s, double scan_period_s) {
  return std::max(1, static_cast<int>(duration_s / std::max(1e-3, scan_period_s)));
}

// A turn about the end of the scan and a shift that were tried, and the beams that fit there.
struct TriedPlace {
  int num_near = 0;
  double turn = 0.0;
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();
};

// Returns the best of the places that are apart from each other, best first.
std::vector<TriedPlace> Peaks(std::vector<TriedPlace> places,
                              double step_m,
                              size_t num_peaks) {
  std::stable_sort(places.begin(), places.end(), [](const TriedPlace& a, const TriedPlace& b) {
    return a.num_near > b.num_near;
  });
  // Not the same one several times.
  std::vector<TriedPlace> peaks;
  for (const TriedPlace& place : places) {
    if (peaks.size() == num_peaks) break;
    if (std::none_of(peaks.begin(), peaks.end(), [&](const TriedPlace& peak) {
          return std::abs(peak.turn - place.turn) < 3.5 * kTurnStep &&
                 (peak.shift - place.shift).norm() < 1.5 * step_m;
        })) {
      peaks.push_back(place);
    }
  }
  return peaks;
}

}  // namespace

ScanMatcher::ScanMatcher(const Rig& rig,
                         bool planar,
                         const PointOptions& options,
                         double scan_period_s)
    : rig_(&rig),
      options_(options),
      scan_period_s_(scan_period_s),
      repeated_weight_(std::min(1.0, scan_period_s / kRepeatTime)),
      max_age_scans_(NumScans(options.max_age_s, scan_period_s)),
      forget_period_scans_(NumScans(kForgetPeriod, scan_period_s)),
      trace_period_scans_(NumScans(kTracePeriod, scan_period_s)),
      still_scans_(NumScans(kStillTime, scan_period_s)),
      maps_(),
      occupancy_(kOccupancyCell) {
  for (int level = 0; level < kNumLevels; ++level) {
    maps_.emplace_back(options.cell_m * (1 << level),
                       planar,
                       static_cast<int>(options.min_age_s / std::max(1e-3, scan_period_s)));
  }
}

void ScanMatcher::Take(const Scan& scan) {
  lines_.clear();
  for (size_t i = 0; i < scan.scan_lines.size(); ++i) {
    const ScanLine& scan_line = scan.scan_lines[i];
    const Scanner& scanner = rig_->scanners[static_cast<size_t>(scan_line.scanner_index)];
    bool is_new = true;
    for (int beam = 0; beam < scan_line.num_beams(); ++beam) {
      const double range = scan_line.ranges[static_cast<size_t>(beam)];
      if (!scanner.IsValidRange(range)) continue;
      const int64_t time_ns = BeamInstant(scan_line, beam, *rig_);
      if (is_new || time_ns - lines_.back().times_ns.front() > kMaxSpanNs) {
        lines_.emplace_back();
        lines_.back().scanner_index = scan_line.scanner_index;
        lines_.back().scan_line_index = scan.scan_line_indices[i];
        lines_.back().num_beams = scan_line.num_beams();
        is_new = false;
      }
      Line& line = lines_.back();
      line.beams.push_back(beam);
      line.p_scanner.push_back(scanner.TrueRange(range) * scan_line.BeamDirection(beam));
      line.times_ns.push_back(time_ns);
    }
  }
  begin_ns_ = std::numeric_limits<int64_t>::max();
  end_ns_ = std::numeric_limits<int64_t>::min();
  for (const Line& line : lines_) {
    begin_ns_ = std::min(begin_ns_, line.times_ns.front());
    end_ns_ = std::max(end_ns_, line.times_ns.back());
  }
}

ScanMotion ScanMatcher::MotionOf(const Line& line, PoseSampler* poses) const {
  const Scanner& scanner = rig_->scanners[static_cast<size_t>(line.scanner_index)];
  const std::array<int64_t, 3> times_ns = {
      line.times_ns.front(), line.middle_ns(), line.times_ns.back()};
  std::array<Rigid3d, 3> world_from_scanner;
  for (size_t k = 0; k < 3; ++k) {
    world_from_scanner[k] = poses->WorldFromBody(times_ns[k], scanner.delay_s) *
                            scanner.BodyFromScanner(times_ns[k]);
  }
  return {times_ns, world_from_scanner};
}

void ScanMatcher::MatchLine(const Line& line,
                            int level,
                            const std::vector<bool>* chosen,
                            const MotionVector& error,
                            PoseSampler* poses,
                            ScanMatch* match) const {
  const Scanner& scanner = rig_->scanners[static_cast<size_t>(line.scanner_index)];
  const double surface_stddev_m = options_.surface_stddev_m * (1 << level);
  const double surface_variance = surface_stddev_m * surface_stddev_m;
  const ScanMotion motion = MotionOf(line, poses);
  const Rigid3d predicted = poses->WorldFromBody(line.middle_ns());
  const Eigen::Matrix<double, 6, 12> by_motion = ByMotion(line);
  const Eigen::Matrix<double, 6, 1> of_line = by_motion * error;
  const Rigid3d correction =
      About(predicted.translation, of_line.head<3>(), of_line.tail<3>());
  const Rigid3d world_from_body = correction * predicted;
  RobustFit<6> fit;
  const Eigen::Matrix3d turn = correction.rotation.toRotationMatrix();
  const Eigen::Vector3d from_world = turn * motion.nodes()[1].col(2) + correction.translation;
  CellPoints current;
  int num_cells = 0;
  // Farther off than significant, a point hardly counts (Geman-McClure).
  const auto take = [&] {
    if (current.cell == nullptr || current.cell->num_directions() == 0) return;
    const Eigen::Vector3d p_world = current.sum / current.num;
    const Eigen::Vector3d deviation = p_world - current.cell->Mean();
    match->num_known += current.num;
    const double noise_m = scanner.RangeStddev((p_world - from_world).norm());
    bool is_near = true;
    for (int i = 0; i < current.cell->num_directions(); ++i) {
      const SurfaceDirection& direction = current.cell->direction(i);
      const double variance =
          surface_variance + (direction.variance + noise_m * noise_m) / current.num;
      const double residual = direction.normal.dot(deviation);
      const double significant = kSignificantStddevs * std::sqrt(variance);
      is_near = is_near && std::abs(residual) < significant;
      Eigen::Matrix<double, 6, 1> row;
      row << (p_world - world_from_body.translation).cross(direction.normal), direction.normal;
      fit.Add(row, residual, GemanMcClureWeight(residual, significant) / variance);
    }
    if (is_near) match->num_near += current.num;
    ++num_cells;
  };
  for (size_t i = 0; i < line.p_scanner.size(); ++i) {
    if (line.Moves(i)) continue;
    if (chosen != nullptr && !(*chosen)[static_cast<size_t>(line.beams[i])]) continue;
    const Eigen::Vector3d p_world =
        turn * motion.ToWorld(line.p_scanner[i], line.times_ns[i]) + correction.translation;
    const LocalCell* cell = maps_[static_cast<size_t>(level)].Find(p_world, from_world);
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
  match->constraints.push_back(
      ConstraintOf(fit, world_from_body, line.middle_ns(), repeated_weight_));
  match->hessian += repeated_weight_ * by_motion.transpose() * fit.hessian() * by_motion;
  match->gradient += repeated_weight_ * by_motion.transpose() * fit.gradient();
}

Eigen::Matrix<double, 6, 12> ScanMatcher::ByMotion(const Line& line) const {
  const double duration_ns = std::max(1.0, static_cast<double>(end_ns_ - begin_ns_));
  const double share = static_cast<double>(line.middle_ns() - begin_ns_) / duration_ns;
  Eigen::Matrix<double, 6, 12> by_motion;
  by_motion << (1.0 - share) * Matrix6d::Identity(), share * Matrix6d::Identity();
  return by_motion;
}

ScanMatch ScanMatcher::MatchMoved(const Trajectory& trajectory,
                                  int level,
                                  const BeamMask* chosen,
                                  const MotionVector& error) const {
  PoseSampler poses(trajectory);
  ScanMatch match;
  for (size_t i = 0; i < lines_.size(); ++i) {
    MatchLine(
        lines_[i], level, chosen == nullptr ? nullptr : &(*chosen)[i], error, &poses, &match);
  }
  return match;
}

MotionVector ScanMatcher::BestTurn(const Trajectory& trajectory,
                                   const MotionMatrix& covariance) const {
  constexpr int kYawAtEnd = 8;
  const double variance = covariance(kYawAtEnd, kYawAtEnd);
  const int num_steps =
      static_cast<int>(std::min(kMaxTurn, kTurnSigmas * std::sqrt(variance)) / kTurnStep);
  MotionVector best = MotionVector::Zero();
  if (num_steps == 0) return best;
  // Expected error of the whole motion, given an error of the heading at its end.
  const MotionVector by_yaw = covariance.col(kYawAtEnd) / variance;
  int best_num_near = -1;
  for (int step = -num_steps; step <= num_steps; ++step) {
    const MotionVector turn = by_yaw * (step * kTurnStep);
    const int num_near = MatchMoved(trajectory, kTurnLevel, nullptr, turn).num_near;
    if (num_near <= best_num_near) continue;
    best_num_near = num_near;
    best = turn;
  }
  return best;
}

MotionVector ScanMatcher::Refine(const Trajectory& trajectory,
                                 const MotionMatrix& information,
                                 int coarsest_level,
                                 MotionVector error) const {
  for (int level = coarsest_level; level >= 0; --level) {
    for (int round = 0; round < kRoundsPerLevel; ++round) {
      const ScanMatch match = MatchMoved(trajectory, level, nullptr, error);
      const MotionMatrix hessian = match.hessian + information;
      const MotionVector step = hessian.ldlt().solve(-(match.gradient + information * error));
      error += step;
      if (step.norm() < kSmallStep) break;
    }
  }
  return error;
}

ScanMatch ScanMatcher::Register(const Trajectory& trajectory,
                                const MotionMatrix& covariance) const {
  // Planar rigs have no errors out of the plane.
  const MotionMatrix information =
      (covariance + kTinyVariance * MotionMatrix::Identity()).inverse();
  ScanMatch best;
  const auto consider = [&](int coarsest_level, const MotionVector& start) {
    const MotionVector error = Refine(trajectory, information, coarsest_level, start);
    ScanMatch match = MatchMoved(trajectory, 0, nullptr, error);
    if (match.num_near > best.num_near) best = std::move(match);
  };
  consider(0, MotionVector::Zero());
  if (best.num_near > kMinNearShare * best.num_points) return best;
  consider(kNumLevels - 1, MotionVector::Zero());
  const MotionVector turn = BestTurn(trajectory, covariance);
  if (!turn.isZero()) {
    consider(1, turn);
    consider(kNumLevels - 1, turn);
  }
  return best;
}

std::vector<MotionVector> ScanMatcher::LikeliestErrors(const Trajectory& trajectory,
                                                       const Rigid3d& correction,
                                                       const SearchWindow& window) const {
  const LocalMap& map = maps_[kTurnLevel];
  const double step_m = options_.cell_m;
  const double near_m = kSignificantStddevs * options_.surface_stddev_m * (1 << kTurnLevel);
  PoseSampler poses(trajectory);
  const Eigen::Vector3d at_begin = poses.WorldFromBody(begin_ns_).translation;
  const Eigen::Vector3d at_end = poses.WorldFromBody(end_ns_).translation;
  const Eigen::Vector3d about = correction * at_end;
  struct Beam {
    Eigen::Vector3d end;
    Eigen::Vector3d from;
  };
  std::vector<Beam> beams;
  for (const Line& line : lines_) {
    const ScanMotion motion = MotionOf(line, &poses);
    const size_t stride = std::max<size_t>(1, line.p_scanner.size() / kTracedBeams);
    for (size_t i = 0; i < line.p_scanner.size(); i += stride) {
      if (line.Moves(i)) continue;
      beams.push_back({correction * motion.ToWorld(line.p_scanner[i], line.times_ns[i]),
                       correction * Eigen::Vector3d(motion.nodes()[1].col(2))});
    }
  }
  std::vector<TriedPlace> places;
  const int num_turns = static_cast<int>(window.turn_rad / kTurnStep);
  const int num_steps = static_cast<int>(window.position_m / step_m);
  std::vector<Beam> turned(beams.size());
  for (int turn = -num_turns; turn <= num_turns; ++turn) {
    const Rigid3d by_turn =
        About(about, turn * kTurnStep * Eigen::Vector3d::UnitZ(), Eigen::Vector3d::Zero());
    for (size_t i = 0; i < beams.size(); ++i) {
      turned[i] = {by_turn * beams[i].end, by_turn * beams[i].from};
    }
    for (int y = -num_steps; y <= num_steps; ++y) {
      for (int x = -num_steps; x <= num_steps; ++x) {
        TriedPlace place{0, turn * kTurnStep, {x * step_m, y * step_m, 0.0}};
        for (const Beam& beam : turned) {
          const Eigen::Vector3d p_world = beam.end + place.shift;
          const LocalCell* cell = map.Find(p_world, beam.from + place.shift);
          if (cell == nullptr || cell->num_directions() == 0) continue;
          const SurfaceDirection& direction = cell->direction(0);
          if (std::abs(direction.normal.dot(p_world - cell->Mean())) < near_m)
            ++place.num_near;
        }
        places.push_back(place);
      }
    }
  }
  std::vector<MotionVector> errors;
  for (const TriedPlace& peak : Peaks(std::move(places), step_m, window.num_places)) {
    const Rigid3d moved =
        About(about, peak.turn * Eigen::Vector3d::UnitZ(), peak.shift) * correction;
    const Eigen::Vector3d turn = Log(moved.rotation);
    MotionVector error;
    error << turn, moved * at_begin - at_begin, turn, moved * at_end - at_end;
    errors.push_back(error);
  }
  return errors;
}

ScanMatch ScanMatcher::Search(const Trajectory& trajectory,
                              const Rigid3d& correction,
                              const SearchWindow& window) const {
  Eigen::Matrix<double, 6, 1> variances = Eigen::Matrix<double, 6, 1>::Zero();
  variances[2] = window.turn_rad * window.turn_rad;
  variances[3] = variances[4] = window.position_m * window.position_m;
  MotionMatrix covariance = kTinyVariance * MotionMatrix::Identity();
  covariance.diagonal().head<6>() += variances;
  covariance.diagonal().tail<6>() += variances;
  const MotionMatrix information = covariance.inverse();
  ScanMatch best;
  for (const MotionVector& start : LikeliestErrors(trajectory, correction, window)) {
    const MotionVector error = Refine(trajectory, information, kTurnLevel, start);
    ScanMatch match = MatchMoved(trajectory, 0, nullptr, error);
    if (match.num_near > best.num_near) best = std::move(match);
  }
  return best;
}

int ScanMatcher::num_points() const {
  int num = 0;
  for (const Line& line : lines_) {
    num += static_cast<int>(line.beams.size()) -
           static_cast<int>(std::count(line.moves.begin(), line.moves.end(), true));
  }
  return num;
}

std::vector<bool> ScanMatcher::InEmpty(const Line& line, PoseSampler* poses) {
  const ScanMotion motion = MotionOf(line, poses);
  std::vector<bool> in_empty(line.p_scanner.size());
  for (size_t i = 0; i < in_empty.size(); ++i) {
    in_empty[i] = occupancy_.IsEmpty(motion.ToWorld(line.p_scanner[i], line.times_ns[i]),
                                     0.5 * kOccupancyCell);
  }
  return in_empty;
}

int ScanMatcher::NumInEmpty(const Trajectory& trajectory) {
  PoseSampler poses(trajectory);
  int num = 0;
  for (const Line& line : lines_) {
    const std::vector<bool> in_empty = InEmpty(line, &poses);
    num += static_cast<int>(std::count(in_empty.begin(), in_empty.end(), true));
  }
  return num;
}

void ScanMatcher::LeaveOutMoving(const Trajectory& trajectory) {
  if (!options_.leave_out_moving || scan_index_ < next_check_scan_) return;
  PoseSampler poses(trajectory);
  size_t num_points = 0;
  size_t num_moving = 0;
  for (Line& line : lines_) {
    line.moves = InEmpty(line, &poses);
    num_moving += static_cast<size_t>(std::count(line.moves.begin(), line.moves.end(), true));
    num_points += line.p_scanner.size();
  }
  const double share =
      static_cast<double>(num_moving) / std::max(1.0, static_cast<double>(num_points));
  const double gain =
      std::min(1.0, (scan_index_ - last_check_scan_) * scan_period_s_ / kMotionTime);
  last_check_scan_ = scan_index_;
  motion_ += gain * ((share < kStillShare ? 0.0 : 1.0) - motion_);
  if (share < kStillShare) next_check_scan_ = scan_index_ + still_scans_;
  if (share <= kMaxMovingShare) return;
  for (Line& line : lines_) line.moves.clear();
}

bool ScanMatcher::IsMoving(int scan_line_index, int first_beam, int last_beam) const {
  int num_points = 0;
  int num_moving = 0;
  for (const Line& line : lines_) {
    if (line.scan_line_index != scan_line_index || line.moves.empty()) continue;
    const auto first = std::lower_bound(line.beams.begin(), line.beams.end(), first_beam);
    for (auto beam = first; beam != line.beams.end() && *beam <= last_beam; ++beam) {
      ++num_points;
      if (line.moves[static_cast<size_t>(beam - line.beams.begin())]) ++num_moving;
    }
  }
  return 2 * num_moving > num_points;
}

std::vector<MovingBeams> ScanMatcher::FindMovingBeams() const {
  std::vector<MovingBeams> runs;
  for (const Line& line : lines_) {
    for (size_t i = 0; i < line.moves.size(); ++i) {
      if (!line.moves[i]) continue;
      const size_t first = i;
      while (i + 1 < line.moves.size() && line.moves[i + 1]) ++i;
      if (i == first) continue;
      runs.push_back({line.scan_line_index, line.beams[first], line.beams[i]});
    }
  }
  return runs;
}

BeamMask ScanMatcher::AllBeams() const {
  BeamMask mask;
  for (const Line& line : lines_) mask.emplace_back(static_cast<size_t>(line.num_beams), true);
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

void ScanMatcher::Remember(const Trajectory& trajectory, bool may_found) {
  PoseSampler poses(trajectory);
  const bool traces = options_.leave_out_moving && scan_index_ % trace_period_scans_ == 0;
  for (const Line& line : lines_) {
    const ScanMotion motion = MotionOf(line, &poses);
    const Eigen::Matrix3d placement = motion.nodes()[1];
    const Eigen::Vector3d normal = placement.col(0).cross(placement.col(1));
    const size_t stride = std::max<size_t>(1, line.beams.size() / kTracedBeams);
    const Eigen::Vector3d from_world = motion.nodes()[1].col(2);
    for (size_t i = 0; i < line.p_scanner.size(); ++i) {
      const Eigen::Vector3d p_world = motion.ToWorld(line.p_scanner[i], line.times_ns[i]);
      const bool moves = line.Moves(i);
      if (traces &&
          (i + static_cast<size_t>(scan_index_ / trace_period_scans_)) % stride == 0) {
        occupancy_.AddBeam(from_world, p_world, !moves, scan_index_);
      }
      if (moves) continue;
      // Large cells fill with fewer points.
      const size_t num_levels = i % kCoarseStride == 0 ? maps_.size() : 1;
      for (size_t level = 0; level < num_levels; ++level) {
        maps_[level].Add(p_world, from_world, normal, scan_index_, may_found);
      }
    }
  }
  if (++scan_index_ % forget_period_scans_ != 0) return;
  for (LocalMap& map : maps_) map.ForgetBefore(scan_index_ - max_age_scans_);
  occupancy_.ForgetBefore(scan_index_ - max_age_scans_);
}

}  // namespace plumbline
