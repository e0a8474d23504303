#include "core/result/result_text.h"

#include <glog/logging.h>

#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/geometry/angles.h"
#include "core/result/surface_colour.h"
#include "core/result/symptoms.h"

namespace plumbline {

namespace {

// Exact: a double can not hold today's nanoseconds.
std::string SecondsText(int64_t time_ns) {
  constexpr uint64_t kNanoseconds = 1'000'000'000;
  const uint64_t magnitude =
      time_ns < 0 ? -static_cast<uint64_t>(time_ns) : static_cast<uint64_t>(time_ns);
  char text[48];
  std::snprintf(text,
                sizeof(text),
                "%s%llu.%09llu",
                time_ns < 0 ? "-" : "",
                static_cast<unsigned long long>(magnitude / kNanoseconds),
                static_cast<unsigned long long>(magnitude % kNanoseconds));
  return text;
}

// Appends a number with `digits` digits after the point: printf's %f and %e, faster, since a
// trajectory has hundreds of thousands of numbers.
void AppendNumber(double value, std::chars_format format, int digits, std::string* text) {
  std::array<char, 400> number;  // the largest double has 309 digits before the point
  const auto [end, error] =
      std::to_chars(number.data(), number.data() + number.size(), value, format, digits);
  CHECK(error == std::errc());
  text->append(number.data(), end);
}

// The shortest text that reads back as the same double.
std::string NumberText(double value) { return nlohmann::json(value).dump(); }

std::string VectorText(const Eigen::Vector3d& vector) {
  return "[" + NumberText(vector.x()) + ", " + NumberText(vector.y()) + ", " +
         NumberText(vector.z()) + "]";
}

std::string PlaneText(const PlanePatch& plane) {
  std::string outline;
  for (const Eigen::Vector3d& corner : plane.outline) {
    outline += (outline.empty() ? "" : ", ") + VectorText(corner);
  }
  std::string text = "{\"id\": " + std::to_string(plane.id);
  const auto add = [&text](const std::string& key, const std::string& value) {
    text += ", \"" + key + "\": " + value;
  };
  add("type", "\"" + FieldsOf(plane.type).name + "\"");
  add("normal", VectorText(plane.normal));
  add("distance", NumberText(plane.distance));
  add("sigma_angle_deg", NumberText(plane.sigma_angle_rad * kDegreesPerRadian));
  add("sigma_distance_m", NumberText(plane.sigma_distance_m));
  if (FieldsOf(plane.type).has_radius) {
    add("radius", NumberText(plane.Radius()));
    add("sigma_radius_m", NumberText(plane.sigma_radius_m));
    add("axis_point", VectorText(plane.AxisPoint()));
    add("radius_turn_correlation", NumberText(plane.radius_turn_correlation));
  }
  add("centre", VectorText(plane.centre));
  add("outline", "[" + outline + "]");
  add("num_points", std::to_string(plane.num_points));
  add("num_segments", std::to_string(plane.num_segments));
  add("first_time", SecondsText(plane.first_time_ns));
  add("last_time", SecondsText(plane.last_time_ns));
  return text + "}";
}

// The colour of a surface as "red green blue".
std::string ColourText(int id) {
  const std::array<uint8_t, 3> colour = SurfaceColour(id);
  return std::to_string(colour[0]) + " " + std::to_string(colour[1]) + " " +
         std::to_string(colour[2]);
}

// The triangles of an outline, by the positions of their corners, which run to the left as
// seen from the side that was seen. Outlines of planes are convex.
std::vector<std::array<int, 3>> TrianglesOf(const PlanePatch& plane) {
  const int size = static_cast<int>(plane.outline.size());
  std::vector<std::array<int, 3>> triangles;
  if (plane.IsCurved()) {
    for (int i = 0; i + 1 < size / 2; ++i) {
      triangles.push_back({i, i + 1, size - 2 - i});
      triangles.push_back({i, size - 2 - i, size - 1 - i});
    }
  } else {
    for (int i = 1; i + 1 < size; ++i) triangles.push_back({0, i, i + 1});
  }
  for (std::array<int, 3>& triangle : triangles) {
    const auto corner = [&](size_t i) -> const Eigen::Vector3d& {
      return plane.outline[static_cast<size_t>(triangle[i])];
    };
    const Eigen::Vector3d normal = (corner(1) - corner(0)).cross(corner(2) - corner(0));
    if (normal.dot(plane.NormalAt(corner(0))) < 0.0) std::swap(triangle[1], triangle[2]);
  }
  return triangles;
}

}  // namespace

std::string FormatTrajectory(const std::vector<StampedPose>& poses) {
  std::string text;
  for (const StampedPose& pose : poses) {
    const Eigen::Vector3d& p = pose.world_from_body.translation;
    Eigen::Quaterniond q = pose.world_from_body.rotation.normalized();
    if (q.w() < 0.0) q.coeffs() = -q.coeffs();
    CHECK(p.allFinite() && q.coeffs().allFinite()) << "pose at " << pose.time_ns << " ns";
    text += SecondsText(pose.time_ns);
    const auto append = [&text](double value, int digits) {
      text += ' ';
      AppendNumber(value, std::chars_format::fixed, digits, &text);
    };
    for (const double value : p) append(value, 9);
    for (const double value : q.coeffs()) append(value, 12);
    text += '\n';
  }
  return text;
}

std::string FormatPlanes(const std::vector<PlanePatch>& planes) {
  std::string text = "[";
  for (const PlanePatch& plane : planes) {
    text += text.size() == 1 ? "\n  " : ",\n  ";
    text += PlaneText(plane);
  }
  return text + "\n]\n";
}

std::string FormatLoopClosures(const std::vector<LoopClosure>& closures) {
  std::string text = "[";
  for (const LoopClosure& closure : closures) {
    text += text.size() == 1 ? "\n  {" : ",\n  {";
    text += "\"surface_a\": " + std::to_string(closure.surface_a) +
            ", \"surface_b\": " + std::to_string(closure.surface_b) +
            ", \"time\": " + SecondsText(closure.time_ns) +
            ", \"difference_m\": " + NumberText(closure.difference_m) +
            ", \"statistic\": " + NumberText(closure.statistic) +
            ", \"threshold\": " + NumberText(closure.threshold) +
            ", \"return_statistic\": " + NumberText(closure.return_statistic) +
            ", \"return_threshold\": " + NumberText(closure.return_threshold) +
            ", \"accepted\": " + (closure.accepted ? "true" : "false") + "}";
  }
  return text + (text.size() == 1 ? "]\n" : "\n]\n");
}

std::string FormatPlanePolygons(const std::vector<PlanePatch>& planes) {
  std::string vertices;
  std::string faces;
  int num_vertices = 0;
  int num_faces = 0;
  for (const PlanePatch& plane : planes) {
    if (plane.outline.size() < 3) continue;
    const std::string colour = ColourText(plane.id);
    const int first = num_vertices;
    for (const Eigen::Vector3d& corner : plane.outline) {
      char position[128];
      std::snprintf(
          position, sizeof(position), "%.6g %.6g %.6g ", corner.x(), corner.y(), corner.z());
      vertices += position + colour + "\n";
      ++num_vertices;
    }
    for (const std::array<int, 3>& triangle : TrianglesOf(plane)) {
      faces += "3";
      for (const int corner : triangle) faces += " " + std::to_string(first + corner);
      faces += " " + colour + " " + std::to_string(plane.id) + "\n";
      ++num_faces;
    }
  }
  // Colours stand with the corners too: few viewers show those of faces.
  return "ply\nformat ascii 1.0\nelement vertex " + std::to_string(num_vertices) +
         "\nproperty float x\nproperty float y\nproperty float z\n"
         "property uchar red\nproperty uchar green\nproperty uchar blue\nelement face " +
         std::to_string(num_faces) +
         "\nproperty list uchar int vertex_indices\n"
         "property uchar red\nproperty uchar green\nproperty uchar blue\n"
         "property int plane_id\nend_header\n" +
         vertices + faces;
}

std::string FormatTrajectoryCovariance(const std::vector<StampedCovariance>& poses) {
  const char* const names[] = {"px", "py", "pz", "rx", "ry", "rz"};
  std::string text = "t";
  for (int i = 0; i < 6; ++i) {
    for (int j = i; j < 6; ++j) text += std::string(",") + names[i] + "_" + names[j];
  }
  text += "\n";
  for (const StampedCovariance& pose : poses) {
    text += SecondsText(pose.time_ns);
    for (int i = 0; i < 6; ++i) {
      for (int j = i; j < 6; ++j) {
        text += ',';
        AppendNumber(pose.covariance(i, j), std::chars_format::scientific, 6, &text);
      }
    }
    text += "\n";
  }
  return text;
}

namespace {

nlohmann::ordered_json ConsistencyJson(const Consistency& consistency) {
  nlohmann::ordered_json json;
  json["verdict"] = VerdictName(consistency.verdict);
  json["contradicted_share"] = consistency.contradicted_share;
  json["doubtful_intervals"] = nlohmann::ordered_json::array();
  for (const DoubtfulInterval& interval : consistency.doubtful_intervals) {
    json["doubtful_intervals"].push_back({{"start_s", interval.start_s},
                                          {"end_s", interval.end_s},
                                          {"reason", interval.reason}});
  }
  json["symptoms"] = nlohmann::ordered_json::array();
  for (const SymptomGroup& group : GroupSymptoms(consistency.doubtful_intervals)) {
    nlohmann::ordered_json texts = nlohmann::ordered_json::array();
    for (const Symptom& symptom : group.symptoms) texts.push_back(SymptomText(symptom, group));
    json["symptoms"].push_back(
        {{"start_s", group.start_s}, {"end_s", group.end_s}, {"what", texts}});
  }
  json["degenerate_intervals"] = nlohmann::ordered_json::array();
  for (const DegenerateInterval& interval : consistency.degenerate_intervals) {
    json["degenerate_intervals"].push_back({{"start_s", interval.start_s},
                                            {"end_s", interval.end_s},
                                            {"direction", interval.direction},
                                            {"stddev_m", interval.stddev_m}});
  }
  if (consistency.ends_at_s) json["ends_at_s"] = *consistency.ends_at_s;
  return json;
}

using Figures = std::vector<std::pair<std::string, double>>;

nlohmann::ordered_json ListJson(const Figures& figures) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const auto& [what, value] : figures) {
    list.push_back({{"what", what}, {"value", value}});
  }
  return list;
}

nlohmann::ordered_json NamedJson(const Figures& figures) {
  nlohmann::ordered_json named = nlohmann::ordered_json::object();
  for (const auto& [name, value] : figures) named[name] = value;
  return named;
}

nlohmann::ordered_json BinsJson(const std::vector<NoiseBin>& bins) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const NoiseBin& bin : bins) {
    json.push_back({{"from", bin.from}, {"to", bin.to}, {"noise_m", bin.noise_m}});
  }
  return json;
}

nlohmann::ordered_json NoiseJson(const ScannerNoise& noise) {
  return {{"scanner", noise.scanner},
          {"stated_m", noise.stated_m},
          {"noise_m",
           noise.noise_m ? nlohmann::ordered_json(*noise.noise_m) : nlohmann::ordered_json()},
          {"by_range_m", BinsJson(noise.by_range)},
          {"by_incidence_deg", BinsJson(noise.by_incidence)}};
}

nlohmann::ordered_json PartsJson(const std::vector<PartSummary>& parts) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const PartSummary& part : parts) {
    list.push_back({{"folder", part.folder},
                    {"start_s", part.start_s},
                    {"end_s", part.end_s},
                    {"scans", part.scans},
                    {"planes", part.planes},
                    {"verdict", VerdictName(part.verdict)}});
    if (!part.pose) continue;
    list.back()["pose"] = {{"yaw_deg", part.pose->yaw_deg},
                           {"x_m", part.pose->x_m},
                           {"y_m", part.pose->y_m},
                           {"matched_m", part.pose->matched_m}};
  }
  return list;
}

}  // namespace

std::string FormatSummary(const Summary& summary) {
  nlohmann::ordered_json json;
  if (!summary.recording.empty()) json["recording"] = summary.recording;
  if (!summary.version.empty()) json["version"] = summary.version;
  json["scanners"] = summary.scanners;
  json["scans"] = summary.scans;
  json["points"] = summary.points;
  json["points_used"] = summary.points_used;
  json["points_moving"] = summary.points_moving;
  json["segments"] = summary.segments;
  json["planes"] = summary.planes;
  json["control_points"] = summary.control_points;
  json["residual_rms_m"] = summary.residual_rms_m;
  json["variance_factor"] = summary.variance_factor;
  json["duration_s"] = summary.duration_s;
  nlohmann::ordered_json stages = nlohmann::ordered_json::object();
  for (const auto& [name, seconds] : summary.stages) {
    stages[name] = stages.value(name, 0.0) + seconds;
  }
  json["stages"] = stages;
  json["real_time_factor"] = summary.real_time_factor;
  json["peak_memory_mb"] = summary.peak_memory_mb;
  json["largest_correlations"] = ListJson(summary.largest_correlations);
  json["weakest_directions"] = ListJson(summary.weakest_directions);
  json["motion"] = summary.motion;
  json["motion_noise"] = NamedJson(summary.motion_noise);
  json["range_noise"] = nlohmann::ordered_json::array();
  for (const ScannerNoise& noise : summary.range_noise) {
    json["range_noise"].push_back(NoiseJson(noise));
  }
  if (summary.odometry) {
    json["odometry"] = {{"length_scale", summary.odometry->length_scale},
                        {"length_scale_stddev", summary.odometry->length_scale_stddev},
                        {"turn_scale", summary.odometry->turn_scale},
                        {"turn_scale_stddev", summary.odometry->turn_scale_stddev},
                        {"length_noise", summary.odometry->length_noise},
                        {"turn_noise", summary.odometry->turn_noise},
                        {"motions", summary.odometry->motions}};
  }
  json["reference_plane_id"] = summary.reference_plane_id;
  json["consistency"] = ConsistencyJson(summary.consistency);
  if (summary.cause) {
    json["cause"] = {{"name", summary.cause->name},
                     {"scanner", summary.cause->scanner.empty()
                                     ? nlohmann::ordered_json(nullptr)
                                     : nlohmann::ordered_json(summary.cause->scanner)},
                     {"evidence", summary.cause->evidence},
                     {"next_step", summary.cause->next_step}};
  }
  for (const UnmappedInterval& gap : summary.gaps) {
    json["gaps"].push_back(
        {{"start_s", gap.start_s}, {"end_s", gap.end_s}, {"reason", gap.reason}});
  }
  if (!summary.parts.empty()) json["parts"] = PartsJson(summary.parts);
  json["warnings"] = summary.warnings;
  // File names in warnings need not be UTF-8.
  const std::string text =
      json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
  // Written here, as the library knows doubles only.
  return "{\n  \"start_time\": " + SecondsText(summary.start_time_ns) + "," + text.substr(1);
}

std::string FormatPlaneCovariance(const PlaneCovariance& covariance) {
  std::vector<std::pair<std::string, std::string>> names;  // id, parameter
  for (const PlanePatch& plane : covariance.planes()) {
    for (const std::string& name : FieldsOf(plane.type).parameters) {
      names.emplace_back(std::to_string(plane.id), name);
    }
  }
  std::string text = "plane,parameter";
  for (const auto& [id, name] : names) text += "," + id + ":" + name;
  text += "\n";
  char number[40];
  for (size_t i = 0; i < names.size(); ++i) {
    text += names[i].first + "," + names[i].second;
    for (size_t j = 0; j < names.size(); ++j) {
      std::snprintf(
          number,
          sizeof(number),
          ",%.10e",
          covariance.covariance()(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)));
      text += number;
    }
    text += "\n";
  }
  return text;
}

}  // namespace plumbline
