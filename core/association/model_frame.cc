#include "core/association/model_frame.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <set>

#include "core/association/plane_candidates.h"

namespace plumbline {
namespace {

constexpr int kMinPoints = 8;       // of a segment that counts here
constexpr double kMaxSigma = 0.05;  // rad, of a direction that counts here
const double kMinCrossing = std::sin(15.0 * M_PI / 180.0);  // between two scanners' traces
const double kMinHypothesis =
    std::sin(5.0 * M_PI / 180.0);  // between two levels to try a z axis
constexpr int kMinWitnesses = 3;   // of the z axis, which two always agree on
const double kMinUpright = std::cos(35.0 * M_PI / 180.0);  // z axis against the body's
constexpr double kMaxZSigma = 0.03;                        // rad, of the z axis found
constexpr double kSigmas = 3.5;
constexpr double kSignificance = 1e-4;

struct BodyLine {
  int observation = 0;
  int scanner = 0;
  Eigen::Vector3d point_body;
  Eigen::Vector3d direction_body;
  Eigen::Vector3d scan_normal_body;
  double length_m = 0.0;
  double sigma_rad = 0.0;
};

// A direction that is perpendicular to z if it comes from what it seems to come from.
struct Level {
  int scanner = -1;  // -1: two scanners gave it
  Eigen::Vector3d direction_body;
  Eigen::Vector3d scan_normal_body;  // zero where two scanners gave it
  double sigma_rad = 0.0;
  double weight = 0.0;        // m of segment
  std::vector<size_t> lines;  // that it was found from: one, or one of each of two scanners
};

std::vector<BodyLine> LinesInBody(const Rig& rig, const std::vector<Observation>& scan) {
  std::vector<BodyLine> lines;
  for (size_t i = 0; i < scan.size(); ++i) {
    const Observation& observation = scan[i];
    if (observation.num_points < kMinPoints || observation.sigma_direction_rad > kMaxSigma) {
      continue;
    }
    const Rigid3d body_from_scanner =
        rig.scanners[static_cast<size_t>(observation.scanner_index)].BodyFromScanner(
            observation.middle_time_ns());
    BodyLine line;
    line.observation = static_cast<int>(i);
    line.scanner = observation.scanner_index;
    line.point_body =
        body_from_scanner *
        Eigen::Vector3d(observation.centroid().x(), observation.centroid().y(), 0.0);
    line.direction_body =
        body_from_scanner.rotation *
        Eigen::Vector3d(observation.tangent().x(), observation.tangent().y(), 0.0);
    line.scan_normal_body = body_from_scanner.rotation * Eigen::Vector3d::UnitZ();
    line.length_m = observation.length_m();
    line.sigma_rad = observation.sigma_direction_rad;
    lines.push_back(line);
  }
  return lines;
}

// Lists the traces that may be those of floor and ceiling, and the normals of planes that two
// scanners may see; among them are wrong ones, which the vote leaves alone.
std::vector<Level> FindLevels(const std::vector<BodyLine>& lines) {
  std::vector<Level> levels;
  for (size_t i = 0; i < lines.size(); ++i) {
    const BodyLine& line = lines[i];
    const double tilt_sine = line.scan_normal_body.head<2>().norm();
    if (tilt_sine < kMinCrossing) continue;
    levels.push_back({line.scanner,
                      line.direction_body,
                      line.scan_normal_body,
                      line.sigma_rad,
                      line.length_m,
                      {i}});
  }
  for (size_t i = 0; i < lines.size(); ++i) {
    for (size_t j = i + 1; j < lines.size(); ++j) {
      if (lines[i].scanner == lines[j].scanner) continue;
      const Eigen::Vector3d cross = lines[i].direction_body.cross(lines[j].direction_body);
      if (cross.norm() < kMinCrossing) continue;
      const Eigen::Vector3d normal = cross.normalized();
      const Eigen::Vector3d apart = lines[i].point_body - lines[j].point_body;
      const double sigma = std::hypot(lines[i].sigma_rad, lines[j].sigma_rad) / cross.norm();
      if (std::abs(normal.dot(apart)) > kSigmas * sigma * std::max(1.0, apart.norm()))
        continue;
      if (std::abs(normal.z()) > kMinUpright) continue;  // seems a floor: its traces count
      levels.push_back({-1,
                        normal,
                        Eigen::Vector3d::Zero(),
                        sigma,
                        std::min(lines[i].length_m, lines[j].length_m),
                        {i, j}});
    }
  }
  return levels;
}

bool Agrees(const Level& level, const Eigen::Vector3d& z) {
  // Every trace of a scanner is perpendicular to its own scan normal, whatever it lies on.
  if (!level.scan_normal_body.isZero() &&
      level.scan_normal_body.cross(z).norm() < kMinCrossing) {
    return false;
  }
  return std::abs(level.direction_body.dot(z)) < kSigmas * level.sigma_rad;
}

// Selects the levels that speak for z. A segment on a wall is no trace of floor or ceiling:
// mirrored scanners have parallel traces on the walls of a corridor, and these would agree
// with the walls' normals on a wrong z axis.
std::vector<const Level*> FindWitnesses(const std::vector<Level>& levels,
                                        const Eigen::Vector3d& z) {
  std::set<size_t> lines_on_walls;
  std::vector<const Level*> agreeing;
  for (const Level& level : levels) {
    if (!Agrees(level, z)) continue;
    agreeing.push_back(&level);
    if (level.scanner < 0) lines_on_walls.insert(level.lines.begin(), level.lines.end());
  }
  std::vector<const Level*> witnesses;
  for (const Level* level : agreeing) {
    if (level->scanner < 0 || lines_on_walls.count(level->lines.front()) == 0) {
      witnesses.push_back(level);
    }
  }
  return witnesses;
}

// Number of independent witnesses: the traces of a scanner that run parallel count once, and
// so do the normals of parallel walls.
int CountIndependent(const std::vector<const Level*>& witnesses) {
  std::vector<const Level*> independent;
  for (const Level* level : witnesses) {
    const bool is_known =
        std::any_of(independent.begin(), independent.end(), [level](const Level* other) {
          return other->scanner == level->scanner &&
                 other->direction_body.cross(level->direction_body).norm() < kMinCrossing;
        });
    if (!is_known) independent.push_back(level);
  }
  return static_cast<int>(independent.size());
}

// The z axis with the largest consensus, refined over those that agree; zero when there is
// none or it is not well determined.
Eigen::Vector3d FindZ(std::vector<Level> levels) {
  std::stable_sort(levels.begin(), levels.end(), [](const Level& a, const Level& b) {
    return a.weight > b.weight;
  });
  constexpr size_t kMaxLevels = 60;
  if (levels.size() > kMaxLevels) levels.resize(kMaxLevels);
  double best_weight = 0.0;
  Eigen::Vector3d best = Eigen::Vector3d::Zero();
  for (size_t i = 0; i < levels.size(); ++i) {
    for (size_t j = i + 1; j < levels.size(); ++j) {
      Eigen::Vector3d z = levels[i].direction_body.cross(levels[j].direction_body);
      if (z.norm() < kMinHypothesis) continue;
      z.normalize();
      if (z.z() < 0.0) z = -z;
      if (z.z() < kMinUpright) continue;
      double weight = 0.0;
      for (const Level* level : FindWitnesses(levels, z)) weight += level->weight;
      if (weight > best_weight) {
        best_weight = weight;
        best = z;
      }
    }
  }
  if (best_weight == 0.0) return Eigen::Vector3d::Zero();
  for (int iteration = 0; iteration < 3; ++iteration) {
    Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
    for (const Level* level : FindWitnesses(levels, best)) {
      moments += level->direction_body * level->direction_body.transpose() /
                 (level->sigma_rad * level->sigma_rad);
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(moments);
    if (solver.eigenvalues()[1] * kMaxZSigma * kMaxZSigma < 1.0)
      return Eigen::Vector3d::Zero();
    const Eigen::Vector3d z = solver.eigenvectors().col(0);
    best = z.z() < 0.0 ? Eigen::Vector3d(-z) : z;
  }
  if (CountIndependent(FindWitnesses(levels, best)) < kMinWitnesses) {
    return Eigen::Vector3d::Zero();
  }
  return best;
}

}  // namespace

std::optional<ModelFrame> FindModelFrame(const Rig& rig,
                                         bool planar,
                                         const std::vector<Observation>& scan,
                                         const std::set<int>& no_walls) {
  const std::vector<BodyLine> lines = LinesInBody(rig, scan);
  const Eigen::Vector3d z_body =
      planar ? Eigen::Vector3d(Eigen::Vector3d::UnitZ()) : FindZ(FindLevels(lines));
  if (z_body.isZero()) return std::nullopt;
  // Some rotation that takes z_body to the z axis; the wall then gives the heading.
  const Eigen::Quaterniond level_from_body =
      Eigen::Quaterniond::FromTwoVectors(z_body, Eigen::Vector3d::UnitZ());
  double best_sigma = kMaxSigma;
  ModelFrame frame;
  Eigen::Vector3d wall_normal = Eigen::Vector3d::Zero();
  for (const BodyLine& line : lines) {
    if (no_walls.count(line.observation) > 0) continue;
    const Observation& observation = scan[static_cast<size_t>(line.observation)];
    const Rigid3d body_from_scanner =
        rig.scanners[static_cast<size_t>(line.scanner)].BodyFromScanner(
            observation.middle_time_ns());
    if (!planar) {
      const TypeEvidence evidence = JudgeType(observation,
                                              level_from_body * body_from_scanner.rotation,
                                              std::hypot(line.sigma_rad, kMaxZSigma),
                                              kSignificance);
      if (evidence.can_be_horizontal || !evidence.can_be_vertical) continue;
    }
    const Eigen::Vector3d direction = level_from_body * line.direction_body;
    const double sigma = line.sigma_rad / direction.head<2>().squaredNorm();
    if (sigma >= best_sigma) continue;
    best_sigma = sigma;
    frame.reference_observation = line.observation;
    wall_normal = direction.cross(Eigen::Vector3d::UnitZ()).normalized();
    const Eigen::Vector3d to_scanner =
        level_from_body * (body_from_scanner.translation - line.point_body);
    if (wall_normal.dot(to_scanner) < 0.0) wall_normal = -wall_normal;
  }
  if (frame.reference_observation < 0) return std::nullopt;
  const double heading = std::atan2(wall_normal.y(), wall_normal.x());
  frame.world_from_body =
      Eigen::AngleAxisd(-heading, Eigen::Vector3d::UnitZ()) * level_from_body;
  return frame;
}

}  // namespace plumbline
