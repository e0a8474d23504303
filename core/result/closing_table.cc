#include "core/result/closing_table.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "core/geometry/angles.h"
#include "core/result/calibration_text.h"
#include "core/result/symptoms.h"

namespace plumbline {
namespace {

// printf to the end of a text.
template <typename... Values>
void Append(std::string* text, const char* format, Values... values) {
  char line[300];
  std::snprintf(line, sizeof(line), format, values...);
  *text += line;
}

void AppendRow(std::string* text,
               const char* what,
               const std::string& value,
               const char* unit,
               const std::string& deviation) {
  std::string row;
  Append(&row, "  %-24s %10s %-4s %s", what, value.c_str(), unit, deviation.c_str());
  *text += row.substr(0, row.find_last_not_of(' ') + 1) + "\n";
}

std::string Number(double value, int digits) {
  char text[64];
  std::snprintf(text, sizeof(text), "%.*f", digits, value);
  return text;
}

// Median and largest of the standard deviations that are stated.
std::string Deviations(std::vector<double> sigmas, const char* unit) {
  sigmas.erase(std::remove_if(
                   sigmas.begin(), sigmas.end(), [](double sigma) { return !(sigma > 0.0); }),
               sigmas.end());
  if (sigmas.empty()) return "not stated";
  std::sort(sigmas.begin(), sigmas.end());
  std::string text;
  Append(&text,
         "%.3g %s median, %.3g %s worst",
         sigmas[sigmas.size() / 2],
         unit,
         sigmas.back(),
         unit);
  return text;
}

// Whether doubtful intervals cover nearly all of the recording.
bool IsDoubtfulThroughout(const Summary& summary) {
  constexpr double kNearlyAll = 0.9;
  double covered_s = 0.0;
  for (const SymptomGroup& group : GroupSymptoms(summary.consistency.doubtful_intervals)) {
    covered_s += group.end_s - group.start_s;
  }
  return covered_s >= kNearlyAll * summary.duration_s;
}

double Length(const std::vector<StampedPose>& trajectory) {
  double length_m = 0.0;
  for (size_t i = 1; i < trajectory.size(); ++i) {
    length_m += (trajectory[i].world_from_body.translation -
                 trajectory[i - 1].world_from_body.translation)
                    .norm();
  }
  return length_m;
}

std::string Kinds(const std::vector<PlanePatch>& planes) {
  std::map<PlaneType, int> numbers;
  for (const PlanePatch& plane : planes) ++numbers[plane.type];
  std::string text;
  for (const auto& [type, number] : numbers) {
    Append(&text, "%s%d %s", text.empty() ? "" : ", ", number, FieldsOf(type).name.c_str());
  }
  return text;
}

}  // namespace

std::string ClosingTable(const Summary& summary,
                         const std::vector<PlanePatch>& planes,
                         const std::vector<StampedPose>& trajectory,
                         const std::string& directory,
                         bool has_report) {
  std::string text;
  AppendRow(&text, "what", "value", "unit", "stated standard deviation");
  AppendRow(&text,
            "recording",
            Number(summary.duration_s, 1),
            "s",
            "mapped at " + Number(summary.real_time_factor, 1) + " times real time");
  AppendRow(&text, "trajectory", Number(Length(trajectory), 1), "m", "");
  AppendRow(&text, "surfaces", std::to_string(planes.size()), "", Kinds(planes));
  std::vector<double> distances_mm;
  std::vector<double> angles_deg;
  std::vector<double> radii_mm;
  for (const PlanePatch& plane : planes) {
    distances_mm.push_back(1e3 * plane.sigma_distance_m);
    angles_deg.push_back(plane.sigma_angle_rad * kDegreesPerRadian);
    if (FieldsOf(plane.type).has_radius) radii_mm.push_back(1e3 * plane.sigma_radius_m);
  }
  if (summary.consistency.verdict == Verdict::kConsistent) {
    AppendRow(&text, "  along their normals", "", "", Deviations(distances_mm, "mm"));
    AppendRow(&text, "  of their normals", "", "", Deviations(angles_deg, "deg"));
    if (!radii_mm.empty()) AppendRow(&text, "  radii", "", "", Deviations(radii_mm, "mm"));
  } else {
    // Deviations count on every surface and pose being what the map takes it for.
    AppendRow(&text,
              "  how well known",
              "",
              "",
              "not stated: the map is " + VerdictName(summary.consistency.verdict));
  }
  AppendRow(&text, "residuals, RMS", Number(1e3 * summary.residual_rms_m, 1), "mm", "");
  if (summary.parts.size() > 1) {
    AppendRow(&text, "parts", std::to_string(summary.parts.size()), "", "this is the longest");
  }
  if (!summary.calibration.scanners.empty())
    text += CalibrationLine(summary.calibration) + "\n";
  Append(&text, "Verdict: %s", VerdictName(summary.consistency.verdict).c_str());
  if (!summary.warnings.empty()) {
    Append(&text, ", %zu warnings (summary.json)", summary.warnings.size());
  }
  if (summary.cause) {
    const Cause& cause = *summary.cause;
    text += "\nLikeliest cause: " + cause.name + "\n  what speaks for it: " + cause.evidence +
            "\n  what to do: " + cause.next_step;
  }
  for (const SymptomGroup& group : GroupSymptoms(summary.consistency.doubtful_intervals)) {
    Append(&text, "\nDoubtful from %.0f to %.0f s:", group.start_s, group.end_s);
    for (const Symptom& symptom : group.symptoms) {
      text += "\n  - " + SymptomText(symptom, group);
    }
  }
  Append(
      &text,
      "\nWritten to %s: map.* (points), planes.ply and planes.json (surfaces), "
      "trajectory.tum, summary.json\n",
      directory.c_str());
  text += has_report ? "Report: " + directory + "/report.html\n"
                     : "Next: plumbline_report " + directory +
                           " (the map in a browser), plumbline_plan " + directory +
                           " (floor plans)\n";
  if (summary.consistency.verdict == Verdict::kDoubtful && IsDoubtfulThroughout(summary)) {
    text += "The map is doubtful from end to end: check it before it is used\n";
  }
  return text;
}

}  // namespace plumbline
