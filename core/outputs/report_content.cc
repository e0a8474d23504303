#include "core/outputs/report_content.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <system_error>
#include <unordered_map>

#include "core/outputs/point_statistics.h"
#include "core/result/plane_covariance.h"
#include "core/result/ply_reader.h"
#include "core/result/result_reader.h"
#include "core/util/error.h"
#include "core/util/json_file.h"
#include "core/util/time.h"

namespace plumbline {
namespace {

using Json = nlohmann::ordered_json;

// More poses or parameters than these would leave little room for points.
constexpr size_t kMaxPoses = 20'000;
constexpr size_t kMaxParameters = 1'000;

template <typename T>
void AppendBytes(const T& value, std::vector<uint8_t>* bytes) {
  const auto* first = reinterpret_cast<const uint8_t*>(&value);
  bytes->insert(bytes->end(), first, first + sizeof(T));
}

// Makes one array of all first bytes, all second bytes, ... of numbers of number_bytes bytes:
// such arrays pack well.
std::vector<uint8_t> BytesByPlace(const std::vector<uint8_t>& bytes, size_t number_bytes) {
  std::vector<uint8_t> by_place;
  by_place.reserve(bytes.size());
  for (size_t place = 0; place < number_bytes; ++place) {
    for (size_t i = place; i < bytes.size(); i += number_bytes) by_place.push_back(bytes[i]);
  }
  return by_place;
}

// Returns the indices of an even selection of `count` of `size` elements, the first and the
// last included.
std::vector<size_t> EvenSelection(size_t size, size_t count) {
  std::vector<size_t> selection;
  const size_t kept = std::min(size, count);
  for (size_t i = 0; i < kept; ++i) {
    selection.push_back(kept < 2 ? 0 : i * (size - 1) / (kept - 1));
  }
  return selection;
}

// The largest standard deviations of a pose over all directions.
struct PoseStddev {
  double position_m = 0.0;
  double rotation_rad = 0.0;
};

double LargestStddev(const Eigen::Matrix3d& covariance) {
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(covariance, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, solver.eigenvalues()[2]));
}

PoseStddev ParsePoseStddev(const std::string& line, const std::string& place) {
  Eigen::Matrix<double, 6, 6> covariance;
  const char* at = std::strchr(line.c_str(), ',');
  for (int i = 0; i < 6; ++i) {
    for (int j = i; j < 6; ++j) {
      char* end = nullptr;
      const double value = at == nullptr ? 0.0 : std::strtod(at + 1, &end);
      if (end == nullptr || end == at + 1 || !std::isfinite(value)) {
        throw Error(place + ": not a time and 21 numbers");
      }
      covariance(i, j) = covariance(j, i) = value;
      at = *end == ',' ? end : nullptr;
    }
  }
  return {LargestStddev(covariance.topLeftCorner<3, 3>()),
          LargestStddev(covariance.bottomRightCorner<3, 3>())};
}

// Reads the lines of trajectory_covariance.csv that belong to the selected poses.
std::vector<PoseStddev> ReadPoseStddevs(const std::string& path,
                                        size_t num_poses,
                                        const std::vector<size_t>& selection) {
  std::ifstream file(path);
  if (!file) throw Error(path + ": can not be read: " + std::strerror(errno));
  std::vector<PoseStddev> stddevs;
  std::string line;
  std::getline(file, line);
  size_t num_lines = 0;
  for (; std::getline(file, line); ++num_lines) {
    if (stddevs.size() == selection.size() || num_lines != selection[stddevs.size()]) continue;
    stddevs.push_back(ParsePoseStddev(line, path + ":" + std::to_string(num_lines + 2)));
  }
  if (num_lines != num_poses) {
    throw Error(path + ": has " + std::to_string(num_lines) + " poses, trajectory.tum has " +
                std::to_string(num_poses));
  }
  return stddevs;
}

DataSection PoseSection(const std::vector<StampedPose>& poses,
                        const std::vector<size_t>& selection,
                        const std::vector<PoseStddev>& stddevs,
                        int64_t start_ns) {
  DataSection section{"poses", {}};
  for (size_t i = 0; i < selection.size(); ++i) {
    const StampedPose& pose = poses[selection[i]];
    const Eigen::Vector3d& p = pose.world_from_body.translation;
    const Eigen::Quaterniond& q = pose.world_from_body.rotation;
    for (const double value : {static_cast<double>(pose.time_ns - start_ns) * 1e-9,
                               p.x(),
                               p.y(),
                               p.z(),
                               q.x(),
                               q.y(),
                               q.z(),
                               q.w(),
                               stddevs[i].position_m,
                               stddevs[i].rotation_rad}) {
      AppendBytes(static_cast<float>(value), &section.bytes);
    }
  }
  section.bytes = BytesByPlace(section.bytes, sizeof(float));
  return section;
}

// Returns the planes with most points whose parameters together fit the report's covariance,
// in the result's order.
std::vector<size_t> LargestPlanes(const std::vector<PlanePatch>& planes) {
  std::vector<size_t> order(planes.size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&planes](size_t a, size_t b) {
    return planes[a].num_points > planes[b].num_points;
  });
  size_t num_parameters = 0;
  std::vector<size_t> kept;
  for (const size_t i : order) {
    num_parameters += FieldsOf(planes[i].type).parameters.size();
    if (num_parameters > kMaxParameters) break;
    kept.push_back(i);
  }
  std::sort(kept.begin(), kept.end());
  return kept;
}

// A number of 36 binary digits, 11 decimal ones: as many as plane_covariance.csv has.
double WithCsvDigits(double value) {
  constexpr int kDigits = 36;
  int exponent = 0;
  const double fraction = std::frexp(value, &exponent);
  return std::ldexp(std::round(std::ldexp(fraction, kDigits)), exponent - kDigits);
}

DataSection CovarianceSection(const PlaneCovariance& covariance,
                              const std::vector<size_t>& kept) {
  std::vector<Eigen::Index> columns;
  Eigen::Index offset = 0;
  for (size_t i = 0, next = 0; i < covariance.planes().size(); ++i) {
    const auto size =
        static_cast<Eigen::Index>(FieldsOf(covariance.planes()[i].type).parameters.size());
    if (next < kept.size() && kept[next] == i) {
      for (Eigen::Index k = 0; k < size; ++k) columns.push_back(offset + k);
      ++next;
    }
    offset += size;
  }
  DataSection section{"covariance", {}};
  for (size_t row = 0; row < columns.size(); ++row) {
    for (size_t column = 0; column <= row; ++column) {
      AppendBytes(WithCsvDigits(covariance.covariance()(columns[row], columns[column])),
                  &section.bytes);
    }
  }
  section.bytes = BytesByPlace(section.bytes, sizeof(double));
  return section;
}

// The points of a map that a report may show, with statistics of its surfaces.
struct Points {
  QuantisedPoints packed;
  PointStatistics statistics;
  int64_t num_points = 0;
};

// Seconds since the recording's start between which a map has points.
struct TimeSpan {
  double first_s = 0.0;
  double last_s = 0.0;
};

// Throws Error where the trajectory is too long to be shown second by second.
TimeSpan SpanOf(const std::vector<StampedPose>& poses,
                int64_t start_ns,
                const std::string& path) {
  constexpr double kMaxLengthS = 1e6;  // beyond it, figures by second would fill the page
  constexpr double kMarginS = 1.0;     // of a scan line before or after its pose
  const TimeSpan span = {SecondsBetween(start_ns, poses.front().time_ns) - kMarginS,
                         SecondsBetween(start_ns, poses.back().time_ns) + kMarginS};
  if (span.first_s < -kMaxLengthS || span.last_s > kMaxLengthS) {
    throw Error(path + ": has a pose " + FormatSeconds(span.last_s - kMarginS) +
                " after the recording's start: longer than a report can show");
  }
  return span;
}

Points ReadPoints(const std::string& path,
                  const std::vector<PlanePatch>& planes,
                  const TimeSpan& span,
                  int64_t max_points) {
  std::unordered_map<int, size_t> index_of;
  for (size_t i = 0; i < planes.size(); ++i) index_of[planes[i].id] = i;
  PlyReader reader(path);
  Points points;
  points.num_points = reader.num_points();
  const int64_t num_kept = std::min(max_points, points.num_points);
  std::vector<MapPoint> kept;
  std::vector<uint16_t> plane_fields;
  kept.reserve(static_cast<size_t>(num_kept));
  plane_fields.reserve(static_cast<size_t>(num_kept));
  PointBuffer block;
  int64_t i = 0;
  while (reader.Next(&block)) {
    for (int64_t k = 0; k < block.num_points(); ++k) {
      const MapPoint point = block.At(k);
      if (point.time_s < span.first_s || point.time_s > span.last_s) {
        throw Error(path + ": point " + std::to_string(i) + " was taken at " +
                    FormatSeconds(point.time_s) + ", when trajectory.tum has no pose");
      }
      uint16_t field = point.plane_id == kMovingPlaneId ? QuantisedPoints::kMoving
                                                        : QuantisedPoints::kOnNoPlane;
      if (point.plane_id >= 0) {
        const auto at = index_of.find(point.plane_id);
        if (at == index_of.end()) {
          throw Error(path + ": point " + std::to_string(i) + " lies on plane " +
                      std::to_string(point.plane_id) + ", which planes.json lacks");
        }
        field = static_cast<uint16_t>(QuantisedPoints::kFirstPlane + at->second);
      }
      points.statistics.Add(point);
      const auto next = static_cast<int64_t>(kept.size());
      if (next < num_kept && i == next * points.num_points / num_kept) {
        kept.push_back(point);
        plane_fields.push_back(field);
      }
      ++i;
    }
  }
  points.packed = QuantisedPoints(kept, plane_fields);
  return points;
}

Json GroupsJson(const std::vector<PointStatistics::Group>& groups) {
  Json json = Json::array();
  for (const PointStatistics::Group& group : groups) {
    const double mean = group.on_planes > 0
                            ? group.sum_squares_m2 / static_cast<double>(group.on_planes)
                            : 0.0;
    json.push_back({group.points, group.on_planes, std::sqrt(mean)});
  }
  return json;
}

// Groups as [points, of these on planes, RMS of their residuals in m].
Json StatisticsJson(const PointStatistics& statistics, int64_t num_points) {
  return {{"points", num_points},
          {"bin_m", PointStatistics::kBinWidth},
          {"histogram", statistics.histogram()},
          {"by_scanner", GroupsJson(statistics.by_scanner())},
          {"by_second", GroupsJson(statistics.by_second())}};
}

// Floor plans of the result, one a storey: floor_plan.svg, floor_plan_2.svg, ...
std::vector<DataSection> ReadFloorPlans(const std::filesystem::path& directory) {
  std::vector<DataSection> plans;
  while (true) {
    const std::string number = std::to_string(plans.size() + 1);
    const auto path =
        directory / (plans.empty() ? "floor_plan.svg" : "floor_plan_" + number + ".svg");
    if (!std::filesystem::exists(path)) return plans;
    const std::string text = ReadTextFile(path.string());
    plans.push_back({"floor-plan-" + number, {text.begin(), text.end()}});
  }
}

// Whether a file lies in the directory itself, so that it can name what else does.
bool StandsIn(const std::filesystem::path& directory, const std::filesystem::path& file) {
  std::error_code error;
  const std::filesystem::path parent = file.has_parent_path() ? file.parent_path() : ".";
  return std::filesystem::equivalent(directory, parent, error);
}

// "<" would end the element in which the text stands; it occurs in strings only.
std::string JsonText(const Json& json) {
  const std::string dumped = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  std::string text;
  for (const char c : dumped) {
    if (c == '<') {
      text += "\\u003c";
    } else {
      text += c;
    }
  }
  return text;
}

}  // namespace

ReportContent ReadReportContent(const ReportJob& job) {
  const std::filesystem::path directory = job.result_directory;
  const auto path = [&directory](const char* name) { return (directory / name).string(); };
  Json json;
  json["title"] = job.title;
  json["summary"] = ReadJsonObject<Json>(path("summary.json"));
  json["evaluation"] = job.evaluation.empty() ? Json() : ReadJsonObject<Json>(job.evaluation);
  const std::string calibration = path("calibration.json");
  json["calibration"] =
      std::filesystem::exists(calibration) ? ReadJsonObject<Json>(calibration) : Json();
  const PlaneCovariance covariance = ReadPlaneCovariance(job.result_directory);
  const std::vector<PlanePatch>& planes = covariance.planes();
  if (planes.size() > UINT16_MAX - QuantisedPoints::kFirstPlane) {
    throw Error(path("planes.json") + ": has more planes than a report can show");
  }
  json["planes"] = ReadJsonFile<Json>(path("planes.json"));
  json["loop_closures"] = ReadJsonFile<Json>(path("loop_closures.json"));
  const std::vector<StampedPose> poses = ReadTrajectory(path("trajectory.tum"));
  const int64_t start_ns = ReadStartTime(path("summary.json"));
  json["start_s"] = static_cast<double>(start_ns) * 1e-9;
  const Points points = ReadPoints(path("map.ply"),
                                   planes,
                                   SpanOf(poses, start_ns, path("trajectory.tum")),
                                   job.max_points);
  json["statistics"] = StatisticsJson(points.statistics, points.num_points);

  ReportContent content;
  content.points = points.packed;
  const std::vector<size_t> shown_poses = EvenSelection(poses.size(), kMaxPoses);
  json["num_poses"] = shown_poses.size();
  content.sections.push_back(PoseSection(
      poses,
      shown_poses,
      ReadPoseStddevs(path("trajectory_covariance.csv"), poses.size(), shown_poses),
      start_ns));
  const std::vector<size_t> largest = LargestPlanes(planes);
  json["covariance_plane_ids"] = Json::array();
  for (const size_t i : largest) json["covariance_plane_ids"].push_back(planes[i].id);
  content.sections.push_back(CovarianceSection(covariance, largest));
  std::vector<DataSection> plans = ReadFloorPlans(directory);
  json["floor_plans"] = plans.size();
  json["part_reports"] = StandsIn(directory, job.output);
  for (DataSection& plan : plans) content.sections.push_back(std::move(plan));
  content.json = JsonText(json);
  return content;
}

}  // namespace plumbline
