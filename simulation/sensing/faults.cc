#include "simulation/sensing/faults.h"

#include "core/geometry/angles.h"

namespace plumbline {
namespace {

constexpr double kFoot = 0.3048;       // m
constexpr double kLongest = 100000.0;  // s

Eigen::Vector3d ReadVector(const YamlNode& node, double limit) {
  const std::vector<double> xyz = node.AsDoubles(3, -limit, limit);
  return {xyz[0], xyz[1], xyz[2]};
}

Episode ReadEpisode(const YamlNode& node) {
  Episode episode;
  const std::vector<std::string> kinds = {"gone", "frozen", "infinite", "random"};
  episode.kind = static_cast<Episode::Kind>(node["kind"].AsChoice(kinds));
  episode.from_s = node["from_s"].AsDouble(0.0, kLongest);
  episode.to_s = node["to_s"].AsDouble(episode.from_s, kLongest);
  node.RejectUnreadKeys();
  return episode;
}

int ScannerNamed(const YamlNode& node, const Rig& rig) {
  std::vector<std::string> names;
  for (const Scanner& scanner : rig.scanners) names.push_back(scanner.name);
  return node.AsChoice(names);
}

ScannerFaults ReadScannerFaults(const YamlNode& node) {
  ScannerFaults faults;
  node.Optional("range_bias_m", &faults.range_bias_m, -10.0, 10.0);
  node.Optional("range_scale", &faults.range_scale, 0.5, 2.0);
  node.Optional("clock_late_s", &faults.clock_late_s, -10.0, 10.0);
  if (node.Has("rotation_error_deg")) {
    const Eigen::Vector3d rpy =
        kRadiansPerDegree * ReadVector(node["rotation_error_deg"], 360.0);
    faults.rotation_error = RotationFromRollPitchYaw(rpy.x(), rpy.y(), rpy.z());
  }
  if (node.Has("translation_error_m")) {
    faults.translation_error = ReadVector(node["translation_error_m"], 10.0);
  }
  node.Optional("mirrored", &faults.mirrored);
  if (node.Has("unit")) {
    faults.unit_m = node["unit"].AsChoice({"metres", "feet"}) == 0 ? 1.0 : kFoot;
  }
  if (node.Has("episodes")) {
    for (const YamlNode& episode : node["episodes"].Elements()) {
      faults.episodes.push_back(ReadEpisode(episode));
    }
  }
  node.RejectUnreadKeys();
  return faults;
}

}  // namespace

FaultOptions ReadFaults(const YamlNode& node, const Rig& rig) {
  FaultOptions faults;
  node.Optional("outliers", &faults.outliers, 0.0, 1.0);
  node.Optional("mixed_pixels", &faults.mixed_pixels, 0.0, 1.0);
  if (node.Has("glass")) {
    const YamlNode glass = node["glass"];
    glass.Optional("returns", &faults.glass.returns, 0.0, 1.0);
    glass.Optional("passes", &faults.glass.passes, 0.0, 1.0);
    glass.RejectUnreadKeys();
    if (faults.glass.returns + faults.glass.passes > 1.0) {
      glass.Fail("returns and passes are probabilities that exclude each other");
    }
  }
  if (node.Has("surfaces")) {
    const YamlNode surfaces = node["surfaces"];
    surfaces.Optional("stddev_m", &faults.surfaces.stddev_m, 0.0, 1.0);
    surfaces.Optional("correlation_m", &faults.surfaces.correlation_m, 0.01, 100.0);
    surfaces.RejectUnreadKeys();
  }
  if (node.Has("swapped")) {
    for (const YamlNode& name : node["swapped"].Elements()) {
      faults.swapped.push_back(ScannerNamed(name, rig));
    }
    if (faults.swapped.size() != 2) node["swapped"].Fail("name two scanners");
  }
  if (node.Has("scanners")) {
    faults.scanners.resize(rig.scanners.size());
    for (const YamlNode& scanner : node["scanners"].Elements()) {
      const int index = ScannerNamed(scanner["name"], rig);
      faults.scanners[static_cast<size_t>(index)] = ReadScannerFaults(scanner);
    }
  }
  node.RejectUnreadKeys();
  return faults;
}

Rig TrueRig(const Rig& rig, const FaultOptions& faults) {
  Rig true_rig = rig;
  if (faults.swapped.size() == 2) {
    const auto a = static_cast<size_t>(faults.swapped[0]);
    const auto b = static_cast<size_t>(faults.swapped[1]);
    true_rig.scanners[a].body_from_scanner = rig.scanners[b].body_from_scanner;
    true_rig.scanners[b].body_from_scanner = rig.scanners[a].body_from_scanner;
  }
  for (size_t i = 0; i < faults.scanners.size(); ++i) {
    const ScannerFaults& fault = faults.scanners[i];
    Scanner& scanner = true_rig.scanners[i];
    scanner.time_offset_s -= fault.clock_late_s;
    scanner.body_from_scanner.rotation =
        fault.rotation_error * scanner.body_from_scanner.rotation;
    scanner.body_from_scanner.translation += fault.translation_error;
  }
  return true_rig;
}

}  // namespace plumbline
