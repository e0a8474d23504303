#include "core/outputs/plan_drawing.h"

#include <cstdio>

namespace plumbline {
namespace {

std::string Text(const char* format, double value) {
  char text[64];
  std::snprintf(text, sizeof(text), format, value);
  return text;
}

}  // namespace

std::string AreaText(const Room& room) { return Text("%.2f", room.area_m2); }
std::string AreaStddevText(const Room& room) { return Text("%.3f", room.area_stddev_m2); }
std::string LengthText(double length_m) { return Text("%.3f", length_m); }
std::string DoorWidthText(double width_m) { return Text("%.2f", width_m); }
std::string StddevText(double stddev_m) { return Text("%.1f", 1e3 * stddev_m); }

std::string OriginText(const MapOrigin& origin) {
  std::string text = "Map";
  if (!origin.recording.empty()) {
    text += " of ";
    for (const char c : origin.recording) text += c >= ' ' && c <= '~' ? c : '?';
  }
  if (!origin.date.empty()) text += ", " + origin.date;
  if (!origin.verdict.empty()) text += ": " + origin.verdict;
  text += ".";
  if (!origin.version.empty()) text += " plumbline " + origin.version;
  return text;
}

std::string WarningText(const MapOrigin& origin) {
  if (origin.verdict == "doubtful") {
    return "The map is doubtful: lengths and areas may be wrong (see its summary.json)";
  }
  if (origin.verdict == "contradictory") {
    return "The map contradicts the scans it was made from: do not use it";
  }
  return "";
}

std::vector<Eigen::Vector2d> GapCorners(const PlanDoor& door) {
  const double depth = door.depth_m > 0.0 ? door.depth_m : kDrawnThicknessM;
  const Eigen::Vector2d behind = -depth * door.normal;
  return {door.from, door.to, door.to + behind, door.from + behind};
}

}  // namespace plumbline
