#include "core/result/result_files.h"

#include <algorithm>
#include <filesystem>
#include <iterator>

#include "core/result/point_cloud_writer.h"

namespace plumbline {
namespace {

constexpr char kPart[] = "part_";
constexpr size_t kPartLength = sizeof(kPart) - 1;

bool IsNumber(const std::string& text) {
  return !text.empty() && text.front() != '0' &&
         text.find_first_not_of("0123456789") == std::string::npos;
}

// "floor_plan.svg", "floor_plan_2.dxf", ...
bool IsStoreyFile(const std::string& name) {
  const std::string prefix = "floor_plan";
  for (const std::string extension : {".svg", ".dxf"}) {
    const size_t length = prefix.size() + extension.size();
    if (name.size() < length || name.compare(0, prefix.size(), prefix) != 0 ||
        name.compare(name.size() - extension.size(), extension.size(), extension) != 0) {
      continue;
    }
    const std::string number = name.substr(prefix.size(), name.size() - length);
    if (number.empty() || (number.front() == '_' && IsNumber(number.substr(1)))) return true;
  }
  return false;
}

}  // namespace

bool IsResultFile(const std::string& name) {
  if (IsStoreyFile(name)) return true;
  static const char* const kNames[] = {"building.city.json",
                                       "calibration.json",
                                       "config_used.yaml",
                                       "loop_closures.json",
                                       "plane_covariance.csv",
                                       "planes.json",
                                       "planes.ply",
                                       "report.html",
                                       "rig_calibrated.yaml",
                                       "rig_used.yaml",
                                       "rooms.json",
                                       "summary.json",
                                       "trajectory.tum",
                                       "trajectory_covariance.csv",
                                       "window_plane_covariance.csv",
                                       "window_planes.json",
                                       "window_trajectory.tum",
                                       "window_trajectory_covariance.csv"};
  return std::find(std::begin(kNames), std::end(kNames), name) != std::end(kNames) ||
         IsCloudFileName(name);
}

std::string PartName(size_t part) { return kPart + std::to_string(part); }

bool IsPartName(const std::string& name) {
  return name.size() > kPartLength && name.compare(0, kPartLength, kPart) == 0 &&
         IsNumber(name.substr(kPartLength));
}

std::vector<std::string> PartsOf(const std::string& directory) {
  std::vector<std::string> parts;
  for (const auto& entry : std::filesystem::directory_iterator(directory)) {
    const std::string name = entry.path().filename().string();
    if (entry.is_directory() && IsPartName(name)) parts.push_back(name);
  }
  // Shorter numbers are smaller.
  std::sort(parts.begin(), parts.end(), [](const std::string& a, const std::string& b) {
    return a.size() != b.size() ? a.size() < b.size() : a < b;
  });
  return parts;
}

}  // namespace plumbline
