#include "simulation/sensing/experiment.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <optional>

#include "core/geometry/angles.h"
#include "core/util/time.h"
#include "core/util/yaml_node.h"
#include "simulation/sensing/moving_reader.h"
#include "simulation/world/path_file.h"

namespace plumbline {
namespace {

constexpr double kMaxLength = 1e5;         // m; a day on foot
constexpr double kDefaultTurnRate = 60.0;  // deg/s
constexpr double kDefaultStart = 1.4e9;    // s since 1970; as large as those of recordings
constexpr double kLatestStart = 4e9;       // s; a ROS 1 stamp holds no later instant

std::string Resolve(const YamlNode& node, const std::string& experiment_path) {
  namespace fs = std::filesystem;
  const fs::path path = (fs::path(experiment_path).parent_path() / node.AsString());
  if (!fs::is_regular_file(path)) node.Fail("there is no file " + path.string());
  return path.lexically_normal().string();
}

void ReadPauses(const YamlNode& node, PathOptions* path) {
  if (!node.Has("pauses")) return;
  for (const YamlNode& pause : node["pauses"].Elements()) {
    path->pauses.push_back({pause["at_m"].AsDouble(0.0, kMaxLength),
                            pause["duration_s"].AsDouble(0.0, 3600.0),
                            pause.Location()});
    pause.RejectUnreadKeys();
  }
}

// The way points of a walk: those of a path file, or [x, y, z], or [x, y] on the floor.
std::vector<Eigen::Vector3d> ReadWalkPoints(const YamlNode& node, double floor_height) {
  std::vector<Eigen::Vector3d> points;
  for (const YamlNode& point : node["way_points"].Elements()) {
    const std::vector<double> xyz = point.AsDoubles(-1, -kMaxLength, kMaxLength);
    if (xyz.size() != 2 && xyz.size() != 3) point.Fail("a way point is [x, y] or [x, y, z]");
    points.emplace_back(xyz[0], xyz[1], xyz.size() == 3 ? xyz[2] : floor_height);
  }
  return points;
}

// The part of a polyline between two lengths along it.
std::vector<Eigen::Vector3d> Trim(const std::vector<Eigen::Vector3d>& points,
                                  double begin_m,
                                  double end_m) {
  std::vector<Eigen::Vector3d> part;
  double passed_m = 0.0;
  for (size_t i = 1; i < points.size(); ++i) {
    const Eigen::Vector3d step = points[i] - points[i - 1];
    const double length = step.norm();
    const double from = std::max(begin_m, passed_m);
    const double to = std::min(end_m, passed_m + length);
    if (from < to) {
      if (part.empty()) part.push_back(points[i - 1] + (from - passed_m) / length * step);
      part.push_back(points[i - 1] + (to - passed_m) / length * step);
    }
    passed_m += length;
  }
  return part;
}

double LengthOf(const std::vector<Eigen::Vector3d>& points) {
  double length = 0.0;
  for (size_t i = 1; i < points.size(); ++i) length += (points[i] - points[i - 1]).norm();
  return length;
}

// file: null unless the path names one.
void ReadWalk(const YamlNode& node,
              const PathFile* file,
              double floor_height,
              PathOptions* path) {
  WalkOptions walk;
  walk.location = path->location = node.Location();
  walk.points = file ? file->points : ReadWalkPoints(node, floor_height);
  if (file) {
    walk.smooth_m = file->smooth_m;
    node.Optional("corner_radius_m", &walk.smooth_m, 0.01, 1000.0);
  } else {
    walk.smooth_m = node["corner_radius_m"].AsDouble(0.01, 1000.0);
  }
  double turn_rate_deg_s = kDefaultTurnRate;
  node.Optional("max_turn_rate_deg_s", &turn_rate_deg_s, 1.0, 1000.0);
  walk.max_turn_rate_rad_s = turn_rate_deg_s * kRadiansPerDegree;
  const double whole_m = LengthOf(walk.points);
  double start_fraction = 0.0;
  node.Optional("start_fraction", &start_fraction, 0.0, 1.0);
  double length_m = (1.0 - start_fraction) * whole_m;
  node.Optional("length_m", &length_m, 1e-3, kMaxLength);
  const double begin_m = start_fraction * whole_m;
  if (begin_m + length_m > whole_m + 1e-9) {
    node.Fail("the path is only " + std::to_string(whole_m) + " m long");
  }
  walk.points = Trim(walk.points, begin_m, begin_m + length_m);
  path->height_m = node["body_height_m"].AsDouble(0.0, 1000.0);
  ReadPauses(node, path);
  for (const Pause& pause : path->pauses) walk.stops.push_back({pause.at_m, pause.duration_s});
  node.RejectUnreadKeys();
  path->walk = walk;
}

// Whether the way is a walk: in space, or with turns on the spot.
bool IsWalk(const YamlNode& node) {
  if (node.Has("max_turn_rate_deg_s")) return true;
  for (const YamlNode& point : node["way_points"].Elements()) {
    if (point.AsDoubles(-1, -kMaxLength, kMaxLength).size() == 3) return true;
  }
  return false;
}

void ReadWay(const YamlNode& node, double floor_height, PathOptions* path) {
  path->location = node.Location();
  for (const YamlNode& point : node["way_points"].Elements()) {
    const std::vector<double> xy = point.AsDoubles(2, -kMaxLength, kMaxLength);
    path->way_points.push_back({Eigen::Vector2d(xy[0], xy[1]), point.Location()});
  }
  node.Optional("closed", &path->closed);
  if (node.Has("laps")) {
    if (!path->closed) node["laps"].Fail("laps need a closed path");
    if (node.Has("length_m")) node["laps"].Fail("give either laps or length_m, not both");
    path->laps = node["laps"].AsDouble(1e-3, 1000.0);
  }
  node.Optional("length_m", &path->length_m, 1e-3, kMaxLength);
  node.Optional("start_fraction", &path->start_fraction, 0.0, 1.0);
  path->corner_radius_m = node["corner_radius_m"].AsDouble(0.01, 1000.0);
  path->height_m = floor_height + node["body_height_m"].AsDouble(0.0, 1000.0);
  ReadPauses(node, path);
  node.RejectUnreadKeys();
}

// Building and path: the path file may name elements of the mesh that are left out.
void ReadBuildingAndPath(const YamlNode& root, const std::string& path, Experiment* result) {
  const std::string building = Resolve(root["building"], path);
  const YamlNode way = root["path"];
  std::optional<PathFile> file;
  std::set<int> dropped;
  if (way.Has("file")) {
    file = ReadPathFile(Resolve(way["file"], path));
    dropped = file->dropped;
  }
  if (root.Has("drop")) {
    for (const YamlNode& element : root["drop"].Elements()) {
      dropped.insert(element.AsInt(0, std::numeric_limits<int>::max()));
    }
  }
  result->building = ReadBuilding(building, dropped);
  const double floor_height = result->building.floor_height;
  if (file || IsWalk(way)) {
    ReadWalk(way, file ? &*file : nullptr, floor_height, &result->path);
  } else {
    ReadWay(way, floor_height, &result->path);
  }
  result->path.speed_m_s = root["speed_m_s"].AsDouble(0.001, 100.0);
  if (result->path.walk) result->path.walk->speed_m_s = result->path.speed_m_s;
}

Oscillation ReadOscillation(const YamlNode& node, bool is_angle) {
  Oscillation oscillation;
  oscillation.amplitude = is_angle
                              ? node["amplitude_deg"].AsDouble(0.0, 45.0) * kRadiansPerDegree
                              : node["amplitude_m"].AsDouble(0.0, 10.0);
  oscillation.frequency_hz = node["frequency_hz"].AsDouble(0.0, 20.0);
  double phase_deg = 0.0;
  node.Optional("phase_deg", &phase_deg, -360.0, 360.0);
  oscillation.phase_rad = phase_deg * kRadiansPerDegree;
  node.RejectUnreadKeys();
  return oscillation;
}

void ReadMotion(const YamlNode& node, PathOptions* path) {
  if (node.Has("roll")) path->roll = ReadOscillation(node["roll"], true);
  if (node.Has("pitch")) path->pitch = ReadOscillation(node["pitch"], true);
  if (node.Has("yaw")) path->yaw = ReadOscillation(node["yaw"], true);
  if (node.Has("height")) path->height = ReadOscillation(node["height"], false);
  node.RejectUnreadKeys();
}

NoiseOptions ReadNoise(const YamlNode& node) {
  NoiseOptions noise;
  node.Optional("scale", &noise.scale, 0.0, 1000.0);
  node.Optional("dropout", &noise.dropout, 0.0, 1.0);
  node.RejectUnreadKeys();
  return noise;
}

}  // namespace

Experiment ReadExperiment(const std::string& path) {
  const YamlNode root = YamlNode::ReadFile(path);
  Experiment experiment;
  ReadBuildingAndPath(root, path, &experiment);
  experiment.rig = ReadRig(Resolve(root["rig"], path));
  for (const Scanner& scanner : experiment.rig.scanners) {
    if (!scanner.estimates_noise) continue;
    root["rig"].Fail("scanner " + scanner.name +
                     ": to simulate it, range_noise_m has to be a number");
  }
  if (root.Has("motion")) ReadMotion(root["motion"], &experiment.path);
  if (root.Has("noise")) experiment.noise = ReadNoise(root["noise"]);
  if (root.Has("faults")) experiment.faults = ReadFaults(root["faults"], experiment.rig);
  const double floor_height = experiment.building.floor_height;
  if (root.Has("moving")) experiment.moving = ReadMoving(root["moving"], floor_height);
  experiment.moving.body_height_m =
      experiment.path.height_m - (experiment.path.walk ? 0.0 : floor_height);
  if (root.Has("odometry")) experiment.wheels = ReadWheels(root["odometry"]);
  experiment.rig.odometry_topic = experiment.wheels ? experiment.wheels->topic : "";
  if (root.Has("imu")) {
    if (!experiment.rig.imu) root["imu"].Fail("the rig file has no imu");
    experiment.inertial = ReadInertial(root["imu"]);
  } else {
    experiment.rig.imu.reset();
  }
  if (root.Has("mounts")) {
    const auto is_mounted = [](const Scanner& scanner) { return scanner.mount.has_value(); };
    if (std::none_of(
            experiment.rig.scanners.begin(), experiment.rig.scanners.end(), is_mounted)) {
      root["mounts"].Fail("the rig file has no mount");
    }
    experiment.mounts = ReadMountOptions(root["mounts"]);
  }
  for (const Scanner& scanner : experiment.rig.scanners) {
    if (!scanner.mount || scanner.mount->swing || scanner.mount->rate_rad_s != 0.0) continue;
    root["rig"].Fail("scanner " + scanner.name +
                     ": to simulate its mount, it needs a swing or a rate_deg_s");
  }
  double start_time_s = kDefaultStart;
  root.Optional("start_time_s", &start_time_s, 1.0, kLatestStart);
  experiment.path.start_ns = NanosecondsFromSeconds(start_time_s);
  const int num_scanners = static_cast<int>(experiment.rig.scanners.size());
  experiment.scanner_phases_s.assign(experiment.rig.scanners.size(), 0.0);
  if (root.Has("scanner_phases_s")) {
    experiment.scanner_phases_s = root["scanner_phases_s"].AsDoubles(num_scanners, 0.0, 10.0);
  }
  root.Ignore("mapper");
  root.RejectUnreadKeys();
  return experiment;
}

}  // namespace plumbline
