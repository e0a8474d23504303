#include "core/revisits/visit_matching.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

namespace plumbline {
namespace {

using Points = std::vector<Eigen::Vector2d>;

constexpr size_t kMaxPoints = 400;  // of the later visit, evenly taken
constexpr size_t kMinPoints = 50;
constexpr double kTurnStep = 0.02;  // rad, between poses that are tried
constexpr double kMinScore =
    0.2;  // of the mean fit of the points, below which nothing is in common
// Shift and turn beyond which a match is at another place.
constexpr double kElsewhere = 0.8;      // m
constexpr double kElsewhereTurn = 0.2;  // rad
// Of a match: the part of the points where the earlier visit knows something, of these the
// part that lies on surfaces, and how well another place fits, of the best.
constexpr double kMinKnownShare = 0.35;
constexpr double kMinHitShare = 0.7;
constexpr double kMaxSecondShare = 0.92;
constexpr double kMinFit = 0.1;  // of a point on a surface

// The refinement: its steps, each with a width beyond which points do not count.
constexpr double kWidths[] = {
    0.3, 0.3, 0.3, 0.3, 0.3, 0.2, 0.2, 0.2, 0.2, 0.2, 0.12, 0.12, 0.12, 0.12, 0.12};  // m
constexpr double kMaxSpotDistance = 0.35;                                             // m
constexpr double kSurfaceStddev = 0.05;                                               // m
constexpr double kPointsPerMeasurement = 10.0;  // neighbours deviate alike
// Prior that holds a direction that the lines leave open.
constexpr double kGuessStddev = 1.0;         // m
constexpr double kGuessHeadingStddev = 0.1;  // rad

struct Candidate {
  double score = 0.0;  // mean fit, or a bound of it
  int turn = 0;        // in steps from the guess
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
};

Points SomeOf(const Points& points) {
  const size_t step = 1 + points.size() / kMaxPoints;
  Points some;
  for (size_t i = 0; i < points.size(); i += step) some.push_back(points[i]);
  return some;
}

Points Turned(const Points& points, double heading) {
  const Eigen::Matrix2d rotation = Eigen::Rotation2Dd(heading).toRotationMatrix();
  Points turned;
  for (const Eigen::Vector2d& p : points) turned.push_back(rotation * p);
  return turned;
}

// A search over the poses of a window.
class WindowSearch {
 public:
  WindowSearch(const VisitGrid& grid,
               const Points& points,
               const PlanarPose& guess,
               const MatchWindow& window)
      : grid_(grid),
        guess_(guess),
        num_turns_(static_cast<int>(std::ceil(window.heading_rad / kTurnStep))),
        num_steps_(static_cast<int>(std::ceil(window.position_m / kStep))) {
    for (int turn = -num_turns_; turn <= num_turns_; ++turn) {
      turned_.push_back(Turned(points, guess.heading + turn * kTurnStep));
    }
  }

  // The best pose near each coarse one that may be among the best.
  std::vector<Candidate> Run() const {
    std::vector<Candidate> found;
    double best = 0.0;
    for (const Candidate& place : CoarsePlaces()) {
      if (place.score < std::max(kMinScore, kMaxSecondShare * best)) break;
      found.push_back(BestNear(place));
      best = std::max(best, found.back().score);
    }
    return found;
  }

 private:
  static constexpr double kStep = VisitGrid::kCell * VisitGrid::kCoarse;  // m

  // All of them, by their bounds, best first.
  std::vector<Candidate> CoarsePlaces() const {
    std::vector<Candidate> places;
    for (int turn = -num_turns_; turn <= num_turns_; ++turn) {
      const Points& points = turned_[static_cast<size_t>(turn + num_turns_)];
      for (int y = -num_steps_; y <= num_steps_; ++y) {
        for (int x = -num_steps_; x <= num_steps_; ++x) {
          const Eigen::Vector2d at = guess_.position + kStep * Eigen::Vector2d(x, y);
          double sum = 0.0;
          for (const Eigen::Vector2d& p : points) sum += grid_.BoundAt(p + at);
          places.push_back({sum / static_cast<double>(points.size()), turn, at});
        }
      }
    }
    std::stable_sort(places.begin(), places.end(), [](const Candidate& a, const Candidate& b) {
      return a.score > b.score;
    });
    return places;
  }

  Candidate BestNear(const Candidate& place) const {
    const Points& points = turned_[static_cast<size_t>(place.turn + num_turns_)];
    Candidate best{0.0, place.turn, place.position};
    for (int y = 0; y < VisitGrid::kCoarse; ++y) {
      for (int x = 0; x < VisitGrid::kCoarse; ++x) {
        const Eigen::Vector2d at = place.position + VisitGrid::kCell * Eigen::Vector2d(x, y);
        double sum = 0.0;
        for (const Eigen::Vector2d& p : points) sum += grid_.At(p + at);
        const double score = sum / static_cast<double>(points.size());
        if (score > best.score) best = {score, place.turn, at};
      }
    }
    return best;
  }

  const VisitGrid& grid_;
  PlanarPose guess_;
  int num_turns_;  // in each direction
  int num_steps_;
  std::vector<Points> turned_;
};

// One Gauss-Newton step of a pose; returns the Hessian without what the guess adds.
Eigen::Matrix3d Step(const VisitSurface& surface,
                     const Points& points,
                     double width_m,
                     const PlanarPose& guess,
                     PlanarPose* pose) {
  const Eigen::Vector3d prior(1.0 / (kGuessStddev * kGuessStddev),
                              1.0 / (kGuessStddev * kGuessStddev),
                              1.0 / (kGuessHeadingStddev * kGuessHeadingStddev));
  Eigen::Matrix3d hessian = Eigen::Matrix3d::Zero();
  Eigen::Vector3d gradient;
  gradient << pose->position - guess.position, pose->heading - guess.heading;
  gradient = prior.cwiseProduct(gradient).eval();
  const Eigen::Matrix2d rotation = pose->Rotation();
  for (const Eigen::Vector2d& point : points) {
    const Eigen::Vector2d turned = rotation * point;
    const Eigen::Vector2d p = turned + pose->position;
    const VisitSurface::Spot* spot = surface.Nearest(p, kMaxSpotDistance);
    if (spot == nullptr) continue;
    const Eigen::Vector2d& normal = spot->normal;
    const double residual = normal.dot(p - spot->position);
    const double ratio = residual / width_m;
    if (std::abs(ratio) > 1.0) continue;
    // Tukey's weight.
    const double weight = (1.0 - ratio * ratio) * (1.0 - ratio * ratio) /
                          (kSurfaceStddev * kSurfaceStddev * kPointsPerMeasurement);
    const Eigen::Vector3d jacobian(
        normal.x(), normal.y(), normal.dot(Eigen::Vector2d(-turned.y(), turned.x())));
    hessian += weight * jacobian * jacobian.transpose();
    gradient += weight * residual * jacobian;
  }
  const Eigen::Matrix3d with_prior = hessian + Eigen::Matrix3d(prior.asDiagonal());
  const Eigen::Vector3d delta = with_prior.ldlt().solve(-gradient);
  pose->position += delta.head<2>();
  pose->heading += delta[2];
  return hessian;
}

// Whether the points lie on what the grid has, and not where beams passed.
bool Fits(const VisitGrid& grid, const Points& points, const PlanarPose& pose) {
  int num_known = 0;
  int num_hits = 0;
  for (const Eigen::Vector2d& p : points) {
    const double fit = grid.At(pose * p);
    num_known += fit != 0.0 ? 1 : 0;
    num_hits += fit > kMinFit ? 1 : 0;
  }
  return num_known >= kMinKnownShare * static_cast<double>(points.size()) &&
         num_hits >= kMinHitShare * num_known;
}

}  // namespace

std::optional<VisitMatch> MatchVisits(const VisitGrid& earlier_grid,
                                      const VisitSurface& earlier_surface,
                                      const Visit& later,
                                      const PlanarPose& guess,
                                      const MatchWindow& window) {
  const Points points = SomeOf(later.points);
  if (points.size() < kMinPoints) return std::nullopt;
  const std::vector<Candidate> found = WindowSearch(earlier_grid, points, guess, window).Run();
  if (found.empty()) return std::nullopt;
  const Candidate& best = *std::max_element(
      found.begin(), found.end(), [](const Candidate& a, const Candidate& b) {
        return a.score < b.score;
      });
  const PlanarPose start{guess.heading + best.turn * kTurnStep, best.position};
  VisitMatch match{start, {}};
  for (const double width_m : kWidths) {
    match.information =
        Step(earlier_surface, points, width_m, start, &match.earlier_from_later);
  }
  const PlanarPose& pose = match.earlier_from_later;
  const auto is_elsewhere = [&](const Eigen::Vector2d& position, double heading) {
    return (position - pose.position).norm() > kElsewhere ||
           std::abs(heading - pose.heading) > kElsewhereTurn;
  };
  if (is_elsewhere(start.position, start.heading)) return std::nullopt;
  for (const Candidate& other : found) {
    if (other.score > kMaxSecondShare * best.score &&
        is_elsewhere(other.position, guess.heading + other.turn * kTurnStep)) {
      return std::nullopt;
    }
  }
  if (!Fits(earlier_grid, points, pose)) return std::nullopt;
  return match;
}

}  // namespace plumbline
