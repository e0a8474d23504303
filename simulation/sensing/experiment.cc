#include "simulation/sensing/experiment.h"

#include <cmath>
#include <filesystem>

#include "core/geometry/angles.h"
#include "core/util/time.h"
#include "core/util/yaml_node.h"

namespace plumbline {
namespace {

constexpr double kMaxLength = 1e5;       // m; a day on foot
constexpr double kDefaultStart = 1.4e9;  // s since 1970; as large as those of recordings
constexpr double kLatestStart = 4e9;     // s; a ROS 1 stamp holds no later instant

std::string Resolve(const YamlNode& node, const std::string& experiment_path) {
  namespace fs = std::filesystem;
  const fs::path path = (fs::path(experiment_path).parent_path() / node.AsString());
  if (!fs::is_regular_file(path)) node.Fail("there is no file " + path.string());
  return path.lexically_normal().string();
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
  if (node.Has("pauses")) {
    for (const YamlNode& pause : node["pauses"].Elements()) {
      path->pauses.push_back({pause["at_m"].AsDouble(0.0, kMaxLength),
                              pause["duration_s"].AsDouble(0.0, 3600.0),
                              pause.Location()});
      pause.RejectUnreadKeys();
    }
  }
  node.RejectUnreadKeys();
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
  experiment.building = ReadBuilding(Resolve(root["building"], path));
  experiment.rig = ReadRig(Resolve(root["rig"], path));
  ReadWay(root["path"], experiment.building.floor_height, &experiment.path);
  experiment.path.speed_m_s = root["speed_m_s"].AsDouble(0.001, 100.0);
  if (root.Has("motion")) ReadMotion(root["motion"], &experiment.path);
  if (root.Has("noise")) experiment.noise = ReadNoise(root["noise"]);
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
