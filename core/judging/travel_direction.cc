#include "core/judging/travel_direction.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "core/geometry/angles.h"
#include "core/judging/levels.h"
#include "core/util/quantiles.h"
#include "core/util/time.h"

namespace plumbline {
namespace {

// A rig that turns carries a scanner off its middle sideways.
constexpr double kMaxTurn = 5.0 * kRadiansPerDegree;
constexpr double kMaxMove = 1.5;       // m in a step
constexpr double kMaxResidual = 0.05;  // m, of a wall's distance
// Normals in one direction only leave the other one open.

// A wall as a scan line shows it: n.x = d, n pointing away from the scanner.
struct WallTrace {
  Eigen::Vector2d normal;
  double angle = 0.0;  // of the normal
  double distance = 0.0;
  double length = 0.0;
};

struct Step {
  Eigen::Vector2d move = Eigen::Vector2d::Zero();  // in the first line's frame, m
  double turn = 0.0;
  double agreeing = 0.0;  // length of the traces that agree, m
};

std::vector<WallTrace> WallsOf(const SampledLine& line) {
  std::vector<WallTrace> walls;
  for (const SampledSegment& segment : line.segments) {
    WallTrace wall;
    wall.length = segment.length_m();
    if (wall.length < kMinTrace) continue;
    const Eigen::Vector2d along = (segment.end - segment.start) / wall.length;
    wall.normal = {-along.y(), along.x()};
    wall.distance = wall.normal.dot(segment.start);
    if (wall.distance < 0.0) {
      wall.normal = -wall.normal;
      wall.distance = -wall.distance;
    }
    wall.angle = std::atan2(wall.normal.y(), wall.normal.x());
    walls.push_back(wall);
  }
  return walls;
}

// A wall of before, its trace's length, and how much nearer it is now.
struct Approach {
  Eigen::Vector2d normal;
  double nearer = 0.0;
  double length = 0.0;
};

std::vector<Approach> ApproachesAt(const std::vector<WallTrace>& before,
                                   const std::vector<WallTrace>& after,
                                   double turn) {
  std::vector<Approach> approaches;
  for (const WallTrace& wall : before) {
    const WallTrace* nearest = nullptr;
    for (const WallTrace& other : after) {
      if (std::abs(std::remainder(other.angle + turn - wall.angle, 2.0 * M_PI)) > kMaxTurn) {
        continue;
      }
      if (std::abs(other.distance - wall.distance) > kMaxMove) continue;
      const auto difference = [&](const WallTrace& one) {
        return std::abs(one.distance - wall.distance);
      };
      if (nearest == nullptr || difference(other) < difference(*nearest)) nearest = &other;
    }
    if (nearest == nullptr) continue;
    approaches.push_back({wall.normal,
                          wall.distance - nearest->distance,
                          std::min(wall.length, nearest->length)});
  }
  return approaches;
}

// The way that explains the approaches, n.move = nearer, by least squares; nothing where they
// do not determine it.
std::optional<Eigen::Vector2d> MoveOf(const std::vector<Approach>& approaches) {
  Eigen::Matrix2d information = Eigen::Matrix2d::Zero();
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const Approach& one : approaches) {
    information += one.length * one.normal * one.normal.transpose();
    sum += one.length * one.nearer * one.normal;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(information);
  if (solver.eigenvalues()[0] <= kSome * solver.eigenvalues()[1]) return std::nullopt;
  return information.ldlt().solve(sum);
}

double LengthOf(const std::vector<Approach>& approaches) {
  double length = 0.0;
  for (const Approach& one : approaches) length += one.length;
  return length;
}

// The step at a turn: walls that do not fit the others are left out.
std::optional<Step> StepAt(std::vector<Approach> approaches, double turn) {
  const double all = LengthOf(approaches);
  Step step;
  step.turn = turn;
  while (true) {
    const std::optional<Eigen::Vector2d> move = MoveOf(approaches);
    if (!move) return std::nullopt;
    step.move = *move;
    const auto residual = [&](const Approach& one) {
      return std::abs(one.normal.dot(*move) - one.nearer);
    };
    const auto worst = std::max_element(
        approaches.begin(), approaches.end(), [&](const Approach& a, const Approach& b) {
          return residual(a) < residual(b);
        });
    if (residual(*worst) < kMaxResidual) break;
    approaches.erase(worst);
  }
  step.agreeing = LengthOf(approaches);
  if (step.agreeing < kMost * all) return std::nullopt;
  return step;
}

// The step between two lines on which most of their traces agree.
std::optional<Step> FindStep(const SampledLine& before, const SampledLine& after) {
  const std::vector<WallTrace> walls = WallsOf(before);
  const std::vector<WallTrace> others = WallsOf(after);
  std::optional<Step> best;
  for (const WallTrace& wall : walls) {
    for (const WallTrace& other : others) {
      const double turn = std::remainder(wall.angle - other.angle, 2.0 * M_PI);
      if (std::abs(turn) > kMaxTurn) continue;
      const std::optional<Step> step = StepAt(ApproachesAt(walls, others, turn), turn);
      if (step && (!best || step->agreeing > best->agreeing)) best = step;
    }
  }
  return best;
}

}  // namespace

std::vector<StepMove> FindMoves(const std::vector<SampledLine>& lines) {
  const int64_t step_ns = NanosecondsFromSeconds(kMotionStep);
  std::vector<StepMove> moves;
  int64_t next_ns = 0;
  size_t after = 0;
  for (const SampledLine& line : lines) {
    if (line.stamp_ns < next_ns) continue;
    while (after < lines.size() && lines[after].stamp_ns < line.stamp_ns + step_ns) ++after;
    if (after == lines.size()) break;
    if (lines[after].stamp_ns > line.stamp_ns + step_ns * 3 / 2)
      continue;  // of another window
    next_ns = lines[after].stamp_ns;
    const std::optional<Step> step = FindStep(line, lines[after]);
    if (!step || step->move.norm() < kAgreed) continue;
    moves.push_back({line.stamp_ns, next_ns, step->move, step->turn});
  }
  return moves;
}

std::optional<TravelDirection> FindTravelDirection(const std::vector<StepMove>& moves) {
  std::vector<double> angles;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const StepMove& move : moves) {
    // In the frame half way.
    angles.push_back(std::atan2(move.move.y(), move.move.x()) - move.turn_rad / 2.0);
    sum += Eigen::Vector2d(std::cos(angles.back()), std::sin(angles.back()));
  }
  if (static_cast<int>(angles.size()) < kMinSteps) return std::nullopt;
  // The middle of the angles, counted from their mean direction.
  const double mean = std::atan2(sum.y(), sum.x());
  std::vector<double> deviations;
  for (const double angle : angles) {
    deviations.push_back(std::remainder(angle - mean, 2.0 * M_PI));
  }
  const double middle = Median(deviations);
  for (double& deviation : deviations) deviation = std::abs(deviation - middle);
  TravelDirection direction;
  direction.angle_rad = std::remainder(mean + middle, 2.0 * M_PI);
  direction.spread_rad = Median(deviations);
  direction.num_steps = static_cast<int>(angles.size());
  if (direction.spread_rad > kParallelAngle) return std::nullopt;
  return direction;
}

}  // namespace plumbline
