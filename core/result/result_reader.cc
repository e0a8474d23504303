#include "core/result/result_reader.h"

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <utility>

#include "core/geometry/angles.h"
#include "core/util/error.h"
#include "core/util/json_file.h"

namespace plumbline {

namespace {

// How far the length of a unit vector or quaternion may be off, given with few decimals.
constexpr double kUnitTolerance = 1e-3;
constexpr long double kMaxTimeS = 9.2e9L;  // the most that int64 nanoseconds hold

// long double holds seconds since 1970 with 9 decimals, double does not.
using Json = nlohmann::
    basic_json<std::map, std::vector, std::string, bool, int64_t, uint64_t, long double>;

int64_t NanosecondsFromLongSeconds(long double seconds) {
  return std::llroundl(seconds * 1e9L);
}

// None where it is no number of seconds, or too large a one.
std::optional<int64_t> ParseTime(const Json& json) {
  if (!json.is_number()) return std::nullopt;
  const long double seconds = json.get<long double>();
  if (!(std::abs(seconds) <= kMaxTimeS)) return std::nullopt;
  return NanosecondsFromLongSeconds(seconds);
}

// Reads the numbers of one line; false where it holds anything else or another number of them.
bool ParseNumbers(const std::string& line, std::vector<long double>* numbers, size_t count) {
  numbers->clear();
  const char* position = line.c_str();
  while (true) {
    char* end = nullptr;
    const long double number = std::strtold(position, &end);
    if (end == position) break;
    numbers->push_back(number);
    position = end;
  }
  return numbers->size() == count && std::strspn(position, " \t\r") == std::strlen(position);
}

// Reads the fields of one plane and names what is wrong with them.
class PlaneReader {
 public:
  PlaneReader(const std::string& path, size_t element, const Json& json)
      : location_(path + ": element " + std::to_string(element)), json_(json) {
    if (!json.is_object()) throw Error(location_ + " is not an object");
    if (json.contains("id") && json["id"].is_number_integer()) {
      location_ += " (plane " + std::to_string(json["id"].get<int64_t>()) + ")";
    }
  }

  PlanePatch Read() const {
    PlanePatch plane;
    plane.id = static_cast<int>(Integer("id", std::numeric_limits<int>::max()));
    plane.type = Type();
    plane.normal = Vector("normal", Field("normal"));
    if (std::abs(plane.normal.norm() - 1.0) > kUnitTolerance) Fail("normal", "a unit vector");
    plane.normal.normalize();
    plane.distance = Number("distance", Field("distance"));
    plane.sigma_angle_rad = Sigma("sigma_angle_deg") * kRadiansPerDegree;
    plane.sigma_distance_m = Sigma("sigma_distance_m");
    plane.centre = Vector("centre", Field("centre"));
    if (FieldsOf(plane.type).has_radius) ReadRadius(&plane);
    const Json& outline = Field("outline");
    if (!outline.is_array()) Fail("outline", "an array of points");
    for (const Json& corner : outline) plane.outline.push_back(Vector("outline", corner));
    plane.num_points = Integer("num_points", std::numeric_limits<int64_t>::max());
    plane.num_segments =
        static_cast<int>(Integer("num_segments", std::numeric_limits<int>::max()));
    plane.first_time_ns = Time("first_time");
    plane.last_time_ns = Time("last_time");
    return plane;
  }

 private:
  [[noreturn]] void Fail(const std::string& key, const std::string& expected) const {
    throw Error(location_ + ": '" + key + "' must be " + expected);
  }

  void ReadRadius(PlanePatch* plane) const {
    const double radius = Number("radius", Field("radius"));
    if (!(radius > 0.0)) Fail("radius", "positive");
    const Eigen::Vector3d axis = Vector("axis_point", Field("axis_point"));
    const double side = plane->normal.dot(plane->centre - axis);
    plane->curvature = std::copysign(1.0 / radius, side);
    plane->sigma_radius_m = Sigma("sigma_radius_m");
    plane->radius_turn_correlation =
        Number("radius_turn_correlation", Field("radius_turn_correlation"));
  }

  const Json& Field(const std::string& key) const {
    const auto field = json_.find(key);
    if (field == json_.end()) throw Error(location_ + ": has no '" + key + "'");
    return *field;
  }

  double Number(const std::string& key, const Json& json) const {
    if (!json.is_number()) Fail(key, "a number");
    const double number = json.get<double>();
    if (!std::isfinite(number)) Fail(key, "a finite number");
    return number;
  }

  // Written as null where there is none.
  double Sigma(const std::string& key) const {
    const Json& json = Field(key);
    if (json.is_null()) return std::numeric_limits<double>::quiet_NaN();
    const double sigma = Number(key, json);
    if (sigma < 0.0) Fail(key, "zero or positive");
    return sigma;
  }

  int64_t Integer(const std::string& key, int64_t max) const {
    const Json& json = Field(key);
    if (!json.is_number_integer() || json.get<long double>() < 0.0L ||
        json.get<long double>() > static_cast<long double>(max)) {
      Fail(key, "an integer from 0 to " + std::to_string(max));
    }
    return json.get<int64_t>();
  }

  int64_t Time(const std::string& key) const {
    const std::optional<int64_t> time_ns = ParseTime(Field(key));
    if (!time_ns) Fail(key, "a time in seconds");
    return *time_ns;
  }

  Eigen::Vector3d Vector(const std::string& key, const Json& json) const {
    if (!json.is_array() || json.size() != 3) Fail(key, "made of three numbers");
    return {Number(key, json[0]), Number(key, json[1]), Number(key, json[2])};
  }

  PlaneType Type() const {
    const Json& json = Field("type");
    for (PlaneType type : {PlaneType::kHorizontal,
                           PlaneType::kVertical,
                           PlaneType::kGeneral,
                           PlaneType::kCylinder}) {
      if (json.is_string() && json.get<std::string>() == FieldsOf(type).name) return type;
    }
    Fail("type", "horizontal, vertical, general or cylinder");
  }

  std::string location_;
  const Json& json_;
};

StampedPose ParsePose(const std::string& line, const std::string& location) {
  std::vector<long double> numbers;
  if (!ParseNumbers(line, &numbers, 8)) {
    throw Error(location + ": not the eight numbers t x y z qx qy qz qw");
  }
  for (const long double number : numbers) {
    if (!std::isfinite(number)) throw Error(location + ": a number is not finite");
  }
  if (std::abs(numbers[0]) > kMaxTimeS) throw Error(location + ": time out of range");
  const auto number = [&numbers](size_t i) { return static_cast<double>(numbers[i]); };
  StampedPose pose;
  pose.time_ns = NanosecondsFromLongSeconds(numbers[0]);
  pose.world_from_body.translation = {number(1), number(2), number(3)};
  const Eigen::Quaterniond rotation(number(7), number(4), number(5), number(6));
  if (std::abs(rotation.norm() - 1.0) > kUnitTolerance) {
    throw Error(location + ": qx qy qz qw is not a unit quaternion");
  }
  pose.world_from_body.rotation = rotation.normalized();
  return pose;
}

}  // namespace

std::vector<StampedPose> ReadTrajectory(const std::string& path) {
  std::istringstream text(ReadTextFile(path));
  std::vector<StampedPose> poses;
  std::string line;
  for (int line_number = 1; std::getline(text, line); ++line_number) {
    const size_t first = line.find_first_not_of(" \t\r");
    if (first == std::string::npos || line[first] == '#') continue;
    const std::string location = path + ":" + std::to_string(line_number);
    const StampedPose pose = ParsePose(line, location);
    if (!poses.empty() && pose.time_ns <= poses.back().time_ns) {
      throw Error(location + ": time does not increase");
    }
    poses.push_back(pose);
  }
  if (poses.empty()) throw Error(path + ": holds no poses");
  return poses;
}

std::vector<PlanePatch> ReadPlanes(const std::string& path) {
  const Json json = ReadJsonFile<Json>(path);
  if (!json.is_array()) throw Error(path + ": is not an array of planes");
  std::vector<PlanePatch> planes;
  for (size_t i = 0; i < json.size(); ++i) {
    planes.push_back(PlaneReader(path, i, json[i]).Read());
  }
  return planes;
}

int64_t ReadStartTime(const std::string& path) {
  const Json json = ReadJsonObject<Json>(path);
  const auto field = json.find("start_time");
  if (field == json.end()) {
    throw Error(path +
                ": has no 'start_time': the map was made by an earlier version, map the "
                "recording again");
  }
  const std::optional<int64_t> time_ns = ParseTime(*field);
  if (!time_ns) throw Error(path + ": 'start_time' must be a time in seconds");
  return *time_ns;
}

namespace {

// Empty before 2000, where clocks begin that nobody has set.
std::string DateText(int64_t time_ns) {
  constexpr int64_t kYear2000S = 946'684'800;
  const std::time_t seconds = time_ns / 1'000'000'000;
  std::tm date{};
  char text[32];
  if (seconds < kYear2000S || gmtime_r(&seconds, &date) == nullptr ||
      std::strftime(text, sizeof(text), "%Y-%m-%d", &date) == 0) {
    return "";
  }
  return text;
}

std::string TextOr(const Json& json, const char* key) {
  const auto field = json.find(key);
  return field != json.end() && field->is_string() ? field->get<std::string>() : "";
}

}  // namespace

MapOrigin ReadMapOrigin(const std::string& path) {
  const Json json = ReadJsonObject<Json>(path);
  MapOrigin origin;
  origin.recording = TextOr(json, "recording");
  origin.version = TextOr(json, "version");
  const auto consistency = json.find("consistency");
  if (consistency != json.end() && consistency->is_object()) {
    origin.verdict = TextOr(*consistency, "verdict");
  }
  const auto start = json.find("start_time");
  if (start != json.end()) {
    if (const std::optional<int64_t> time_ns = ParseTime(*start)) {
      origin.date = DateText(*time_ns);
    }
  }
  return origin;
}

PlaneCovariance ReadPlaneCovariance(const std::string& result_directory) {
  const std::filesystem::path directory = result_directory;
  std::vector<PlanePatch> planes = ReadPlanes((directory / "planes.json").string());
  const std::string path = (directory / "plane_covariance.csv").string();
  int size = 0;
  for (const PlanePatch& plane : planes)
    size += static_cast<int>(FieldsOf(plane.type).parameters.size());
  std::ifstream file(path);
  if (!file) throw Error(path + ": can not be read");
  Eigen::MatrixXd covariance(size, size);
  std::string line;
  std::getline(file, line);
  for (int row = 0; row < size; ++row) {
    const std::string place = path + ":" + std::to_string(row + 2);
    if (!std::getline(file, line)) throw Error(place + ": a line for each parameter expected");
    std::istringstream fields(line);
    std::string field;
    std::getline(fields, field, ',');
    std::getline(fields, field, ',');
    for (int column = 0; column < size; ++column) {
      char* end = nullptr;
      if (!std::getline(fields, field, ',')) throw Error(place + ": too few numbers");
      covariance(row, column) = std::strtod(field.c_str(), &end);
      if (end == field.c_str() || *end != '\0') {
        throw Error(place + ": not a number: '" + field + "'");
      }
    }
  }
  return PlaneCovariance(std::move(planes), std::move(covariance));
}

}  // namespace plumbline
