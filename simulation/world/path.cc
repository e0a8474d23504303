#include "simulation/world/path.h"

#include <glog/logging.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/util/error.h"
#include "core/util/time.h"

namespace plumbline {
namespace {

// Gauss-Legendre quadrature on [-1, 1] with 12 points: the positive roots. Over half a corner
// the integrand is so smooth that the error stays below 1e-12 of the corner's length.
constexpr std::array<double, 6> kLegendreRoots = {0.12523340851146891,
                                                  0.36783149899818018,
                                                  0.58731795428661748,
                                                  0.76990267419430469,
                                                  0.9041172563704748,
                                                  0.98156063424671924};
constexpr std::array<double, 6> kLegendreWeights = {0.24914704581340269,
                                                    0.23349253653835464,
                                                    0.20316742672306565,
                                                    0.16007832854334611,
                                                    0.10693932599531888,
                                                    0.047175336386512022};

// The heading's share of the turn at the share u of a corner's length: the integral of
// 2 sin^2(pi u).
double ShareOfTurn(double u) { return u - std::sin(2 * M_PI * u) / (2 * M_PI); }

// Integral of (cos, sin)(heading + turn * ShareOfTurn(u)) over u from 0 to end <= 1/2.
Eigen::Vector2d IntegrateDirection(double heading, double turn, double end) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (size_t i = 0; i < kLegendreRoots.size(); ++i) {
    for (const double root : {-kLegendreRoots[i], kLegendreRoots[i]}) {
      const double angle = heading + turn * ShareOfTurn(end * (1 + root) / 2);
      sum += kLegendreWeights[i] * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    }
  }
  return sum * end / 2;
}

// Displacement along a whole corner of unit length that starts along x. The second half
// mirrors the first: headings turn - angle instead of angle.
Eigen::Vector2d UnitCorner(double turn) {
  return IntegrateDirection(0.0, turn, 0.5) +
         Eigen::Rotation2Dd(turn) *
             Eigen::Vector2d(1, -1).cwiseProduct(IntegrateDirection(0.0, turn, 0.5));
}

// Seconds from full speed to a stand, v = speed * cos^2(pi t / 2 ramp). It costs half a ramp
// of distance, and half a ramp of time more than going on. A person stops within a second.
constexpr double kRampS = 1.0;

// Travelled after a time since the ramp's begin, as a share of speed * ramp.
double RampTravel(double share) { return share / 2 + std::sin(M_PI * share) / (2 * M_PI); }

constexpr double kMaxTurn = 170.0 * M_PI / 180.0;  // beyond, the corner's ends run to infinity
constexpr double kMinTurn = 1e-9;                  // rad; what rounding makes of straight on
constexpr double kFit = 1e-9;                      // m; corners that just meet may round so

}  // namespace

double Oscillation::At(double time_s) const {
  if (amplitude == 0.0) return 0.0;
  return amplitude * std::sin(2 * M_PI * frequency_hz * time_s + phase_rad);
}

Path::Path(const PathOptions& options) : options_(options) {
  CHECK_GT(options_.speed_m_s, 0.0);
  CHECK_GT(options_.corner_radius_m, 0.0);
  if (options_.walk) {
    walk_ = std::make_shared<Walk>(*options_.walk);
    lap_length_m_ = walk_->length_m();
    end_ns_ = options_.start_ns + NanosecondsFromSeconds(walk_->duration_s());
    return;
  }
  MakePieces();
  start_m_ = options_.start_fraction * lap_length_m_;
  double travel_m = options_.length_m;
  if (travel_m == 0.0) {
    travel_m = options_.closed ? options_.laps * lap_length_m_ : lap_length_m_ - start_m_;
  }
  if (!options_.closed && start_m_ + travel_m > lap_length_m_ + kFit) {
    throw Error(options_.location + ": the path is only " + std::to_string(lap_length_m_) +
                " m long");
  }
  if (travel_m <= 0.0) throw Error(options_.location + ": the path has no length");
  CheckPauses(travel_m);
  double duration_s = travel_m / options_.speed_m_s;
  for (const Pause& pause : options_.pauses) duration_s += pause.duration_s + kRampS;
  end_ns_ = options_.start_ns + NanosecondsFromSeconds(duration_s);
}

Path::Corner Path::MakeCorner(size_t way_point) const {
  const std::vector<WayPoint>& points = options_.way_points;
  const size_t size = points.size();
  const WayPoint& point = points[way_point];
  const Eigen::Vector2d in = point.position - points[(way_point + size - 1) % size].position;
  const Eigen::Vector2d out = points[(way_point + 1) % size].position - point.position;
  Corner corner;
  corner.turn_rad = std::atan2(in.x() * out.y() - in.y() * out.x(), in.dot(out));
  if (std::abs(corner.turn_rad) < kMinTurn) return Corner();
  if (std::abs(corner.turn_rad) > kMaxTurn) {
    throw Error(point.location + ": the path turns back on itself at this way point");
  }
  const double half = std::abs(corner.turn_rad) / 2;
  corner.tangent_m = options_.corner_radius_m * std::tan(half);
  corner.length_m = corner.tangent_m * 2 * std::cos(half) / UnitCorner(corner.turn_rad).norm();
  return corner;
}

void Path::MakePieces() {
  const std::vector<WayPoint>& points = options_.way_points;
  const size_t size = points.size();
  if (size < (options_.closed ? 3u : 2u)) {
    throw Error(options_.location + ": a path needs at least two way points, three if closed");
  }
  std::vector<Corner> corners(size);
  const size_t num_stretches = options_.closed ? size : size - 1;
  for (size_t i = 0; i < num_stretches; ++i) {
    if ((points[(i + 1) % size].position - points[i].position).norm() < kFit) {
      throw Error(points[(i + 1) % size].location + ": the same way point stands twice");
    }
  }
  for (size_t i = 0; i < size; ++i) {
    if (options_.closed || (i > 0 && i + 1 < size)) corners[i] = MakeCorner(i);
  }
  for (size_t i = 0; i < num_stretches; ++i) {
    const size_t next = (i + 1) % size;
    const Eigen::Vector2d along = points[next].position - points[i].position;
    const double straight = along.norm() - corners[i].tangent_m - corners[next].tangent_m;
    if (straight < -kFit) {
      throw Error(points[next].location +
                  ": corners of this radius do not fit between this way point and the one "
                  "before it");
    }
    const Eigen::Vector2d direction = along.normalized();
    AddStraight(points[i].position + corners[i].tangent_m * direction,
                points[next].position - corners[next].tangent_m * direction,
                i);
    if (options_.closed || next + 1 < size) AddCorner(corners[next], next);
  }
  lap_length_m_ = pieces_.back().begin_m + pieces_.back().length_m;
}

void Path::AddStraight(const Eigen::Vector2d& from,
                       const Eigen::Vector2d& to,
                       size_t way_point) {
  const WayPoint& point = options_.way_points[way_point];
  const WayPoint& next = options_.way_points[(way_point + 1) % options_.way_points.size()];
  const Eigen::Vector2d along = next.position - point.position;
  Piece piece;
  if (!pieces_.empty()) piece.begin_m = pieces_.back().begin_m + pieces_.back().length_m;
  piece.length_m = std::max(0.0, (to - from).dot(along.normalized()));
  piece.begin = from;
  piece.end = to;
  piece.heading_rad = std::atan2(along.y(), along.x());
  piece.way_point = way_point;
  pieces_.push_back(piece);
}

void Path::AddCorner(const Corner& corner, size_t way_point) {
  if (corner.turn_rad == 0.0) return;
  const Piece& before = pieces_.back();
  Piece piece;
  piece.begin_m = before.begin_m + before.length_m;
  piece.length_m = corner.length_m;
  piece.begin = before.end;
  piece.heading_rad = before.heading_rad;
  piece.turn_rad = corner.turn_rad;
  piece.end = piece.begin + corner.length_m * (Eigen::Rotation2Dd(piece.heading_rad) *
                                               UnitCorner(corner.turn_rad));
  piece.way_point = way_point;
  pieces_.push_back(piece);
}

void Path::CheckPauses(double travel_m) const {
  const double ramp_m = options_.speed_m_s * kRampS / 2;
  double free_from_m = 0.0;
  for (const Pause& pause : options_.pauses) {
    if (pause.at_m - ramp_m < free_from_m || pause.at_m + ramp_m > travel_m) {
      throw Error(pause.location +
                  ": no room to slow down and speed up for this pause; pauses stand in the "
                  "order in which they come");
    }
    free_from_m = pause.at_m + ramp_m;
  }
}

double Path::TravelledAt(int64_t time_ns) const {
  double time_s = SecondsBetween(options_.start_ns, time_ns);
  if (walk_) return walk_->At(time_s).travelled_m;
  const double speed = options_.speed_m_s;
  double passed_m = 0.0;  // up to the last pause's end
  for (const Pause& pause : options_.pauses) {
    const double slow_s = (pause.at_m - passed_m) / speed - kRampS / 2;
    if (time_s < slow_s) break;
    time_s -= slow_s;
    if (time_s < kRampS) {
      return passed_m + speed * (slow_s + kRampS * RampTravel(time_s / kRampS));
    }
    time_s -= kRampS + pause.duration_s;
    if (time_s < 0.0) return pause.at_m;
    if (time_s < kRampS) {
      return pause.at_m + speed * kRampS * (0.5 - RampTravel(1.0 - time_s / kRampS));
    }
    time_s -= kRampS / 2;  // as if at full speed since the pause
    passed_m = pause.at_m;
  }
  return passed_m + speed * time_s;
}

const Path::Piece& Path::PieceAt(double* distance_m) const {
  if (options_.closed) {
    *distance_m -= std::floor(*distance_m / lap_length_m_) * lap_length_m_;
  }
  auto after = std::upper_bound(
      pieces_.begin(), pieces_.end(), *distance_m, [](double distance, const Piece& piece) {
        return distance < piece.begin_m;
      });
  const Piece& piece = after == pieces_.begin() ? *after : *(after - 1);
  *distance_m -= piece.begin_m;
  return piece;
}

Eigen::Vector3d Path::PlaceAndHeadingAt(double distance_m) const {
  const Piece& piece = PieceAt(&distance_m);
  Eigen::Vector2d place;
  double heading = piece.heading_rad;
  if (piece.turn_rad == 0.0) {
    place = piece.begin + distance_m * Eigen::Vector2d(std::cos(heading), std::sin(heading));
  } else {
    const double u = distance_m / piece.length_m;
    if (u <= 0.5) {
      place = piece.begin +
              piece.length_m * IntegrateDirection(piece.heading_rad, piece.turn_rad, u);
    } else {
      // Backwards from the end, where the turn has the opposite sign.
      place =
          piece.end - piece.length_m * IntegrateDirection(piece.heading_rad + piece.turn_rad,
                                                          -piece.turn_rad,
                                                          1.0 - u);
    }
    heading += piece.turn_rad * ShareOfTurn(u);
  }
  return {place.x(), place.y(), heading};
}

const std::string& Path::LocationAt(int64_t time_ns) const {
  if (walk_) return options_.location;
  double distance_m = start_m_ + TravelledAt(time_ns);
  return options_.way_points[PieceAt(&distance_m).way_point].location;
}

Rigid3d Path::PoseAt(int64_t time_ns) const {
  CHECK_GE(time_ns, start_ns());
  CHECK_LE(time_ns, end_ns());
  const double time_s = SecondsBetween(options_.start_ns, time_ns);
  WalkState state;
  if (walk_) {
    state = walk_->At(time_s);
  } else {
    const Eigen::Vector3d place = PlaceAndHeadingAt(start_m_ + TravelledAt(time_ns));
    state.place.head<2>() = place.head<2>();
    state.heading_rad = place.z();
  }
  state.place.z() += options_.height_m + options_.height.At(time_s);
  return {RotationFromRollPitchYaw(options_.roll.At(time_s),
                                   options_.pitch.At(time_s),
                                   state.heading_rad + options_.yaw.At(time_s)),
          state.place};
}

}  // namespace plumbline
