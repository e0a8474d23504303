#include "core/registration/visit_matching.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <tuple>
#include <vector>

#include "core/geometry/robust_fit.h"

namespace plumbline {
namespace {

using Points = std::vector<Eigen::Vector2d>;

constexpr size_t kMaxPoints = 400;  // of the later visit, evenly taken
constexpr size_t kMinPoints = 50;
constexpr double kTurnStep = 0.02;  // rad, between poses that are tried
// Shift and turn beyond which a match is at another place.
constexpr double kElsewhere = 0.8;      // m
constexpr double kElsewhereTurn = 0.2;  // rad
// Of a match: the part of the points where the earlier visit knows something, of these the
// part that lies on surfaces, and how well another place fits, of the best.
constexpr double kMinKnownShare = 0.35;
constexpr double kMinHitShare = 0.7;
constexpr double kMaxSecondShare = 0.92;
constexpr int kMinFit = 10;  // hundredths, of a point on a surface

// The refinement: its steps, each with a width beyond which points do not count.
constexpr double kWidths[] = {
    0.3, 0.3, 0.3, 0.3, 0.3, 0.2, 0.2, 0.2, 0.2, 0.2, 0.12, 0.12, 0.12, 0.12, 0.12};  // m
constexpr double kSurfaceStddev = 0.05;                                               // m
constexpr double kPointsPerMeasurement = 10.0;  // neighbours deviate alike
// Prior that holds a direction that the lines leave open.
constexpr double kGuessStddev = 1.0;         // m
constexpr double kGuessHeadingStddev = 0.1;  // rad

struct Candidate {
  double score = 0.0;                               // mean fit, or a bound of it
  size_t turn = 0;                                  // of the window's
  Eigen::Vector2i shift = Eigen::Vector2i::Zero();  // from the guess, in cells
};

Points SomeOf(const Points& points) {
  const size_t step = 1 + points.size() / kMaxPoints;
  Points some;
  for (size_t i = 0; i < points.size(); i += step) some.push_back(points[i]);
  return some;
}

// A search over the poses of a window, which are whole cells apart: a point's cell moves by as
// many.
class WindowSearch {
 public:
  WindowSearch(const VisitGrid& grid,
               const Points& points,
               const PlanarPose& guess,
               const MatchWindow& window)
      : grid_(grid),
        min_score_(window.min_score),
        num_steps_(static_cast<int>(std::ceil(window.position_m / kStep))) {
    for (const double turn : window.turns) {
      const Eigen::Matrix2d rotation =
          Eigen::Rotation2Dd(guess.heading + turn).toRotationMatrix();
      Cells& cells = turned_.emplace_back();
      for (const Eigen::Vector2d& p : points) {
        cells.push_back(grid.CellOf(rotation * p + guess.position));
      }
    }
  }

  // The best pose near each coarse one that may be among the best.
  std::vector<Candidate> Run() const {
    std::vector<Candidate> found;
    double best = 0.0;
    for (const Candidate& place : CoarsePlaces()) {
      if (place.score < std::max(min_score_, kMaxSecondShare * best)) break;
      found.push_back(BestNear(place));
      best = std::max(best, found.back().score);
    }
    return found;
  }

 private:
  using Cells = std::vector<Eigen::Vector2i>;
  static constexpr double kStep = VisitGrid::kCell * VisitGrid::kCoarse;  // m

  // fit: of a cell, in hundredths.
  template <typename Fit>
  double MeanFit(size_t turn, const Eigen::Vector2i& shift, const Fit& fit) const {
    int sum = 0;
    for (const Eigen::Vector2i& cell : turned_[turn]) sum += fit(cell + shift);
    return 0.01 * sum / static_cast<double>(turned_[turn].size());
  }

  // Those whose bounds allow for a fit, best first.
  std::vector<Candidate> CoarsePlaces() const {
    std::vector<Candidate> places;
    for (size_t turn = 0; turn < turned_.size(); ++turn) {
      for (int y = -num_steps_; y <= num_steps_; y += VisitGrid::kCoarse) {
        for (int x = -num_steps_; x <= num_steps_; x += VisitGrid::kCoarse) {
          const double bound = MeanFit(
              turn, VisitGrid::kCoarse * Eigen::Vector2i(x, y), [&](const Eigen::Vector2i& c) {
                return grid_.CoarseBoundAt(c);
              });
          if (bound >= min_score_) AddPlaces(turn, x, y, &places);
        }
      }
    }
    std::sort(places.begin(), places.end(), [](const Candidate& a, const Candidate& b) {
      const auto order = [](const Candidate& c) {
        return std::make_tuple(-c.score, c.turn, c.shift.y(), c.shift.x());
      };
      return order(a) < order(b);
    });
    return places;
  }

  // The places of a coarser one.
  void AddPlaces(size_t turn, int from_x, int from_y, std::vector<Candidate>* places) const {
    for (int y = from_y; y < std::min(from_y + VisitGrid::kCoarse, num_steps_ + 1); ++y) {
      for (int x = from_x; x < std::min(from_x + VisitGrid::kCoarse, num_steps_ + 1); ++x) {
        const Eigen::Vector2i shift = VisitGrid::kCoarse * Eigen::Vector2i(x, y);
        const double bound =
            MeanFit(turn, shift, [&](const Eigen::Vector2i& c) { return grid_.BoundAt(c); });
        places->push_back({bound, turn, shift});
      }
    }
  }

  Candidate BestNear(const Candidate& place) const {
    Candidate best{0.0, place.turn, place.shift};
    for (int y = 0; y < VisitGrid::kCoarse; ++y) {
      for (int x = 0; x < VisitGrid::kCoarse; ++x) {
        const Eigen::Vector2i shift = place.shift + Eigen::Vector2i(x, y);
        const double score =
            MeanFit(place.turn, shift, [&](const Eigen::Vector2i& c) { return grid_.At(c); });
        if (score > best.score) best = {score, place.turn, shift};
      }
    }
    return best;
  }

  const VisitGrid& grid_;
  double min_score_;
  int num_steps_;              // in each direction
  std::vector<Cells> turned_;  // of the points at the guess, by turn
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
  RobustFit<3> fit;
  const Eigen::Matrix2d rotation = pose->Rotation();
  for (const Eigen::Vector2d& point : points) {
    const Eigen::Vector2d turned = rotation * point;
    const Eigen::Vector2d p = turned + pose->position;
    const WallSpot* spot = surface.Nearest(p);
    if (spot == nullptr) continue;
    const Eigen::Vector2d& normal = spot->normal;
    const double residual = normal.dot(p - spot->position);
    fit.Add({normal.x(), normal.y(), normal.dot(Eigen::Vector2d(-turned.y(), turned.x()))},
            residual,
            TukeyWeight(residual, width_m) /
                (kSurfaceStddev * kSurfaceStddev * kPointsPerMeasurement));
  }
  const Eigen::Matrix3d hessian = fit.hessian();
  Eigen::Vector3d from_guess;
  from_guess << pose->position - guess.position, pose->heading - guess.heading;
  fit.AddPrior(prior.asDiagonal(), from_guess);
  const Eigen::Vector3d delta = fit.Step();
  pose->position += delta.head<2>();
  pose->heading += delta[2];
  return hessian;
}

// Whether the points lie on what the grid has, and not where beams passed.
bool Fits(const VisitGrid& grid, const Points& points, const PlanarPose& pose) {
  int num_known = 0;
  int num_hits = 0;
  for (const Eigen::Vector2d& p : points) {
    const int fit = grid.At(grid.CellOf(pose * p));
    num_known += fit != 0 ? 1 : 0;
    num_hits += fit > kMinFit ? 1 : 0;
  }
  return num_known >= kMinKnownShare * static_cast<double>(points.size()) &&
         num_hits >= kMinHitShare * num_known;
}

// How much line there is in each direction: numbers of spots, by the angle of their normals
// modulo half a turn.
std::vector<double> DirectionsOf(const VisitSurface& surface) {
  const auto num_bins = static_cast<int>(M_PI / kTurnStep);
  std::vector<double> directions(static_cast<size_t>(num_bins), 0.0);
  for (const WallSpot& spot : surface.spots()) {
    if (spot.normal.isZero()) continue;
    const double share = std::atan2(spot.normal.y(), spot.normal.x()) / M_PI + 1.0;
    const int bin = static_cast<int>(share * num_bins) % num_bins;
    // Neighbours, too: a line's direction is known to about a bin.
    for (int i = bin - 1; i <= bin + 1; ++i) {
      directions[static_cast<size_t>((i + num_bins) % num_bins)] += 1.0;
    }
  }
  return directions;
}

}  // namespace

std::vector<double> MatchWindow::TurnsWithin(double heading_rad) {
  const int num_turns = static_cast<int>(std::ceil(heading_rad / kTurnStep));
  std::vector<double> turns;
  for (int turn = -num_turns; turn <= num_turns; ++turn) turns.push_back(turn * kTurnStep);
  return turns;
}

MatchWindow WindowByDirections(const VisitSurface& earlier,
                               const VisitSurface& later,
                               double position_m) {
  const std::vector<double> of_earlier = DirectionsOf(earlier);
  const std::vector<double> of_later = DirectionsOf(later);
  const size_t num_bins = of_earlier.size();
  std::vector<double> scores(num_bins, 0.0);
  for (size_t turn = 0; turn < num_bins; ++turn) {
    for (size_t bin = 0; bin < num_bins; ++bin) {
      scores[turn] += of_later[bin] * of_earlier[(bin + turn) % num_bins];
    }
  }
  const double best = *std::max_element(scores.begin(), scores.end());
  MatchWindow window;
  window.position_m = position_m;
  window.turns.clear();
  for (size_t turn = 0; turn < num_bins; ++turn) {
    if (scores[turn] < kMinHitShare * best) continue;
    for (const double half : {0.0, M_PI}) {
      window.turns.push_back(half +
                             M_PI * static_cast<double>(turn) / static_cast<double>(num_bins));
    }
  }
  return window;
}

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
  const auto pose_of = [&](const Candidate& candidate) {
    return PlanarPose{guess.heading + window.turns[candidate.turn],
                      guess.position + VisitGrid::kCell * candidate.shift.cast<double>()};
  };
  const PlanarPose start = pose_of(best);
  VisitMatch match{start, {}};
  for (const double width_m : kWidths) {
    match.information =
        Step(earlier_surface, points, width_m, start, &match.earlier_from_later);
  }
  const PlanarPose& pose = match.earlier_from_later;
  const auto is_elsewhere = [&](const PlanarPose& other) {
    return (other.position - pose.position).norm() > kElsewhere ||
           std::abs(std::remainder(other.heading - pose.heading, 2.0 * M_PI)) > kElsewhereTurn;
  };
  if (is_elsewhere(start)) return std::nullopt;
  for (const Candidate& other : found) {
    if (other.score > kMaxSecondShare * best.score && is_elsewhere(pose_of(other))) {
      return std::nullopt;
    }
  }
  if (!Fits(earlier_grid, points, pose)) return std::nullopt;
  return match;
}

}  // namespace plumbline
