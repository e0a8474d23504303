#include "simulation/world/moving_things.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/util/time.h"
#include "simulation/world/random.h"

namespace plumbline {
namespace {

constexpr double kAside = 0.6;       // m; people's distance from the body of the rig
constexpr double kDoorOpens = 2.2;   // m; distance of the rig at which a door begins to open
constexpr double kDoorIsOpen = 1.4;  // m; and at which it is open

double Smooth(double share) {
  const double u = std::clamp(share, 0.0, 1.0);
  return u * u * (3 - 2 * u);
}

// A wave between 0 and 1 and back.
double Triangle(double phase) { return 1.0 - std::abs(2 * (phase - std::floor(phase)) - 1); }

double LengthOf(const std::vector<Eigen::Vector3d>& points) {
  double length = 0.0;
  for (size_t i = 1; i < points.size(); ++i) length += (points[i] - points[i - 1]).norm();
  return length;
}

Eigen::Vector3d Along(const std::vector<Eigen::Vector3d>& points, double share) {
  double rest = share * LengthOf(points);
  for (size_t i = 1; i < points.size(); ++i) {
    const double stretch = (points[i] - points[i - 1]).norm();
    if (rest <= stretch && stretch > 0.0) {
      return points[i - 1] + rest / stretch * (points[i] - points[i - 1]);
    }
    rest -= stretch;
  }
  return points.back();
}

std::optional<double> CastCylinder(const Eigen::Vector3d& origin,
                                   const Eigen::Vector3d& direction,
                                   const Eigen::Vector3d& foot,
                                   const Person& person) {
  const Eigen::Vector2d offset = (origin - foot).head<2>();
  const Eigen::Vector2d along = direction.head<2>();
  const double a = along.squaredNorm();
  const double b = offset.dot(along);
  const double c = offset.squaredNorm() - person.radius_m * person.radius_m;
  if (c <= 0.0) return std::nullopt;  // stands round the origin
  const double root = b * b - a * c;
  if (a < 1e-12 || root < 0.0 || b > 0.0) return std::nullopt;
  const double enter = (-b - std::sqrt(root)) / a;
  const double leave = (-b + std::sqrt(root)) / a;
  const double top = foot.z() + person.height_m;
  const auto height = [&](double range) { return origin.z() + range * direction.z(); };
  if (height(enter) >= foot.z() && height(enter) <= top) return enter;
  if (height(enter) > top && height(leave) < top) return (top - origin.z()) / direction.z();
  return std::nullopt;
}

std::optional<double> CastLeaf(const Eigen::Vector3d& origin,
                               const Eigen::Vector3d& direction,
                               const Door& door,
                               double angle_rad) {
  const Eigen::Vector2d leaf(std::cos(angle_rad), std::sin(angle_rad));
  const Eigen::Vector2d normal(-leaf.y(), leaf.x());
  const double approach = normal.dot(direction.head<2>());
  if (std::abs(approach) < 1e-9) return std::nullopt;
  const double range = normal.dot((door.hinge - origin).head<2>()) / approach;
  if (range <= 0.0) return std::nullopt;
  const Eigen::Vector3d hit = origin + range * direction - door.hinge;
  const double along = leaf.dot(hit.head<2>());
  const bool inside =
      along >= 0.0 && along <= door.width_m && hit.z() >= 0.0 && hit.z() <= door.height_m;
  return inside ? std::optional<double>(range) : std::nullopt;
}

}  // namespace

MovingThings::MovingThings(const MovingOptions& options, uint64_t seed) : options_(options) {
  for (size_t i = 0; i < options_.people.size(); ++i) {
    person_phases_.push_back(Random({seed, 0x70656f70, i}).Uniform());
  }
  for (size_t i = 0; i < options_.doors.size(); ++i) {
    door_phases_.push_back(Random({seed, 0x646f6f72, i}).Uniform());
  }
}

Eigen::Vector3d MovingThings::PlaceOf(size_t index, const Path& path, int64_t time_ns) const {
  const Person& person = options_.people[index];
  const double phase = person_phases_[index];
  const double time_s = SecondsBetween(path.start_ns(), time_ns);
  const auto below = [&](int64_t instant_ns) {
    Eigen::Vector3d p = path.PoseAt(instant_ns).translation;
    p.z() -= options_.body_height_m;
    return p;
  };
  const Eigen::Vector3d rig = below(time_ns);
  Eigen::Vector3d place = rig;
  if (!person.way_points.empty()) {
    const double period_s = 2 * LengthOf(person.way_points) / person.speed_m_s;
    place = Along(person.way_points, Triangle(phase + time_s / period_s));
  } else if (person.circles_m > 0.0) {
    const double angle = 2 * M_PI * phase + time_s * person.speed_m_s / person.circles_m;
    place += person.circles_m * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.0);
  } else {
    // The follower treads where the rig was; at the beginning it stands and waits.
    const int64_t behind_ns = NanosecondsFromSeconds(person.follows_m / person.speed_m_s);
    place = below(std::max(path.start_ns(), time_ns - behind_ns));
  }
  Eigen::Vector2d apart = (place - rig).head<2>();
  const double distance = apart.norm();
  if (distance < kAside && std::abs(place.z() - rig.z()) < person.height_m) {
    apart = distance > 1e-6 ? Eigen::Vector2d(apart / distance) : Eigen::Vector2d::UnitX();
    place.head<2>() = rig.head<2>() + kAside * apart;
  }
  return place;
}

double MovingThings::AngleOf(size_t index, const Path& path, int64_t time_ns) const {
  const Door& door = options_.doors[index];
  const double time_s = SecondsBetween(path.start_ns(), time_ns);
  // Shut for a while, open for a while.
  const double wave = Triangle(door_phases_[index] + time_s / door.period_s);
  const double swing = Smooth(2 * wave - 0.5);
  const double distance = (path.PoseAt(time_ns).translation - door.hinge).head<2>().norm();
  const double near = Smooth((kDoorOpens - distance) / (kDoorOpens - kDoorIsOpen));
  return door.shut_rad + std::max(swing, near) * (door.open_rad - door.shut_rad);
}

std::optional<double> MovingThings::Cast(const Eigen::Vector3d& origin_world,
                                         const Eigen::Vector3d& direction_world,
                                         const Path& path,
                                         int64_t time_ns) const {
  double nearest = std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < options_.people.size(); ++i) {
    const std::optional<double> range = CastCylinder(
        origin_world, direction_world, PlaceOf(i, path, time_ns), options_.people[i]);
    if (range) nearest = std::min(nearest, *range);
  }
  for (size_t i = 0; i < options_.doors.size(); ++i) {
    const std::optional<double> range =
        CastLeaf(origin_world, direction_world, options_.doors[i], AngleOf(i, path, time_ns));
    if (range) nearest = std::min(nearest, *range);
  }
  if (!std::isfinite(nearest)) return std::nullopt;
  return nearest;
}

}  // namespace plumbline
