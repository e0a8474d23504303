#include "core/sensor/rig.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <set>
#include <sstream>

#include "core/geometry/angles.h"
#include "core/geometry/roll_pitch_yaw.h"
#include "core/util/atomic_file.h"
#include "core/util/error.h"
#include "core/util/yaml_node.h"

namespace plumbline {
namespace {

const std::string kEstimate = "estimate";  // a range noise that the recording shows

const std::array<const char*, 3> kMotionNames = {"automatic", "spatial", "planar"};

Rigid3d ReadRigid(const YamlNode& node) {
  const std::vector<double> t = node["translation"].AsDoubles(3, -100.0, 100.0);
  const std::vector<double> rpy = node["rotation_rpy_deg"].AsDoubles(3, -360.0, 360.0);
  node.RejectUnreadKeys();
  return {
      RotationFromRollPitchYaw(
          rpy[0] * kRadiansPerDegree, rpy[1] * kRadiansPerDegree, rpy[2] * kRadiansPerDegree),
      Eigen::Vector3d(t[0], t[1], t[2])};
}

// Uncertainty of a rig that was measured with a ruler and a protractor, its clocks being those
// of one computer that stamps messages as they come, its ranges as data sheets state them.
ScannerUncertainty MeasuredByHand() {
  return {1.0 * kRadiansPerDegree, 0.01, 0.002, 0.01, 0.0};
}

ScannerUncertainty ReadUncertainty(const YamlNode& node) {
  ScannerUncertainty uncertainty = MeasuredByHand();
  double rotation_deg = uncertainty.rotation_rad / kRadiansPerDegree;
  node.Optional("rotation_deg", &rotation_deg, 0.0, 30.0);
  uncertainty.rotation_rad = rotation_deg * kRadiansPerDegree;
  node.Optional("translation_m", &uncertainty.translation_m, 0.0, 1.0);
  node.Optional("time_s", &uncertainty.time_s, 0.0, 1.0);
  node.Optional("range_m", &uncertainty.range_m, 0.0, 1.0);
  node.Optional("range_scale", &uncertainty.range_scale, 0.0, 0.1);
  node.RejectUnreadKeys();
  return uncertainty;
}

// Reads the values that replace the headers of the messages.
void ReadHeader(const YamlNode& node, Scanner* scanner) {
  if (node.Has("time_increment_s")) {
    scanner->time_increment_s = node["time_increment_s"].AsDouble(-1.0, 1.0);
  }
  if (node.Has("angle_min_deg")) {
    scanner->angle_min_rad = node["angle_min_deg"].AsDouble(-360.0, 360.0) * kRadiansPerDegree;
  }
  if (node.Has("angle_increment_deg")) {
    const double degrees = node["angle_increment_deg"].AsDouble(-90.0, 90.0);
    if (degrees == 0.0) node["angle_increment_deg"].Fail("angle_increment_deg must not be 0");
    scanner->angle_increment_rad = degrees * kRadiansPerDegree;
  }
}

// Of a mount that was measured by hand, its drive's rate as a data sheet states it.
MountUncertainty MountMeasuredByHand(bool is_read) {
  const ScannerUncertainty by_hand = MeasuredByHand();
  return {by_hand.rotation_rad,
          by_hand.time_s,
          is_read ? 0.0 : 0.001,
          by_hand.rotation_rad,
          by_hand.translation_m};
}

MountUncertainty ReadMountUncertainty(const YamlNode& node, MountUncertainty uncertainty) {
  const auto read_angle = [&](const std::string& name, double* value) {
    double degrees = *value / kRadiansPerDegree;
    node.Optional(name, &degrees, 0.0, 30.0);
    *value = degrees * kRadiansPerDegree;
  };
  read_angle("zero_deg", &uncertainty.zero_rad);
  node.Optional("time_s", &uncertainty.time_s, 0.0, 1.0);
  node.Optional("rate", &uncertainty.rate, 0.0, 0.1);
  read_angle("axis_deg", &uncertainty.axis_rad);
  node.Optional("point_m", &uncertainty.point_m, 0.0, 1.0);
  node.RejectUnreadKeys();
  return uncertainty;
}

Swing ReadSwing(const YamlNode& node) {
  Swing swing;
  swing.amplitude_rad = node["amplitude_deg"].AsDouble(0.0, 180.0) * kRadiansPerDegree;
  swing.period_s = node["period_s"].AsDouble(0.01, 1000.0);
  double phase_deg = 0.0;
  node.Optional("phase_deg", &phase_deg, -360.0, 360.0);
  swing.phase_rad = phase_deg * kRadiansPerDegree;
  node.RejectUnreadKeys();
  return swing;
}

// origin_body: of the scanner, through which the axis goes where the file says nothing else.
Mount ReadMount(const YamlNode& node, const Eigen::Vector3d& origin_body) {
  Mount mount;
  const std::vector<double> axis = node["axis"].AsDoubles(3, -1000.0, 1000.0);
  mount.axis = Eigen::Vector3d(axis[0], axis[1], axis[2]);
  if (mount.axis.norm() < 1e-6) node["axis"].Fail("axis must not be of length 0");
  mount.axis.normalize();
  mount.point = origin_body;
  if (node.Has("point")) {
    const std::vector<double> point = node["point"].AsDoubles(3, -100.0, 100.0);
    mount.point = Eigen::Vector3d(point[0], point[1], point[2]);
  }
  node.Optional("joint_topic", &mount.joint_topic);
  node.Optional("joint", &mount.joint);
  if (!mount.joint.empty() && !mount.IsRead()) {
    node["joint"].Fail("joint names one of the joints in the messages of a joint_topic");
  }
  const bool has_rate = node.Has("rate_deg_s");
  if (has_rate) {
    mount.rate_rad_s = node["rate_deg_s"].AsDouble(-36000.0, 36000.0) * kRadiansPerDegree;
  }
  if (node.Has("swing")) {
    if (has_rate) node["swing"].Fail("give either rate_deg_s or swing, not both");
    mount.swing = ReadSwing(node["swing"]);
  }
  if (!mount.IsRead() && !has_rate && !mount.swing) {
    node.Fail("a mount needs a joint_topic, a rate_deg_s or a swing");
  }
  double zero_deg = 0.0;
  node.Optional("zero_deg", &zero_deg, -360.0, 360.0);
  mount.zero_rad = zero_deg * kRadiansPerDegree;
  node.Optional("time_offset_s", &mount.time_offset_s, -10.0, 10.0);
  mount.uncertainty = MountMeasuredByHand(mount.IsRead());
  if (node.Has("uncertainty")) {
    mount.uncertainty = ReadMountUncertainty(node["uncertainty"], mount.uncertainty);
  }
  node.RejectUnreadKeys();
  return mount;
}

Scanner ReadScanner(const YamlNode& node) {
  Scanner scanner;
  scanner.name = node["name"].AsString();
  scanner.topic = node["topic"].AsString();
  scanner.body_from_scanner = ReadRigid(node["body_from_scanner"]);
  if (node.Has("mount")) {
    scanner.mount = ReadMount(node["mount"], scanner.body_from_scanner.translation);
  }
  const YamlNode noise = node["range_noise_m"];
  scanner.estimates_noise = noise.AsString() == kEstimate;
  if (!scanner.estimates_noise) scanner.range_noise_m = noise.AsDouble(1e-6, 10.0);
  node.Optional("range_noise_per_m2", &scanner.range_noise_per_m2, 0.0, 1.0);
  scanner.min_range_m = node["min_range_m"].AsDouble(0.0, 1000.0);
  scanner.max_range_m = node["max_range_m"].AsDouble(0.0, 1000.0);
  if (scanner.min_range_m >= scanner.max_range_m) {
    node["min_range_m"].Fail("min_range_m must be less than max_range_m");
  }
  node.Optional("time_offset_s", &scanner.time_offset_s, -10.0, 10.0);
  node.Optional("range_bias_m", &scanner.range_bias_m, -10.0, 10.0);
  node.Optional("range_scale", &scanner.range_scale, 0.5, 2.0);
  scanner.uncertainty =
      node.Has("uncertainty") ? ReadUncertainty(node["uncertainty"]) : MeasuredByHand();
  double angle_noise_deg = scanner.angle_noise_rad / kRadiansPerDegree;
  node.Optional("angle_noise_deg", &angle_noise_deg, 0.0, 10.0);
  scanner.angle_noise_rad = angle_noise_deg * kRadiansPerDegree;
  ReadHeader(node, &scanner);
  node.Optional("beams", &scanner.beams, 2, 100000);
  node.Optional("field_of_view_deg", &scanner.field_of_view_deg, 0.1, 360.0);
  node.Optional("scan_rate_hz", &scanner.scan_rate_hz, 0.1, 1000.0);
  node.RejectUnreadKeys();
  return scanner;
}

// Shortest text that reads back as the same double.
std::string Format(double value) {
  std::array<char, 32> buffer;
  const auto result = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  return std::string(buffer.data(), result.ptr);
}

std::string Format(const Eigen::Vector3d& v) {
  return "[" + Format(v.x()) + ", " + Format(v.y()) + ", " + Format(v.z()) + "]";
}

// Always in double quotes, so that any name reads back as the text it was.
std::string Quote(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    if (c == '\n') {
      quoted += "\\n";
    } else {
      quoted += c;
    }
  }
  return quoted + "\"";
}

std::string HeaderText(const Scanner& scanner) {
  std::string text;
  const auto add =
      [&text](const std::string& name, const std::optional<double>& value, double unit) {
        if (value) text += "    " + name + ": " + Format(*value / unit) + "\n";
      };
  add("time_increment_s", scanner.time_increment_s, 1.0);
  add("angle_min_deg", scanner.angle_min_rad, kRadiansPerDegree);
  add("angle_increment_deg", scanner.angle_increment_rad, kRadiansPerDegree);
  return text;
}

std::string MountText(const Mount& mount) {
  const auto degrees = [](double radians) { return Format(radians / kRadiansPerDegree); };
  std::string text = "    mount:\n      axis: " + Format(mount.axis) +
                     "\n      point: " + Format(mount.point) + "\n";
  if (mount.IsRead()) text += "      joint_topic: " + Quote(mount.joint_topic) + "\n";
  if (!mount.joint.empty()) text += "      joint: " + Quote(mount.joint) + "\n";
  if (mount.swing) {
    text += "      swing: {amplitude_deg: " + degrees(mount.swing->amplitude_rad) +
            ", period_s: " + Format(mount.swing->period_s) +
            ", phase_deg: " + degrees(mount.swing->phase_rad) + "}\n";
  } else if (mount.rate_rad_s != 0.0 || !mount.IsRead()) {
    text += "      rate_deg_s: " + degrees(mount.rate_rad_s) + "\n";
  }
  return text + "      zero_deg: " + degrees(mount.zero_rad) +
         "\n      time_offset_s: " + Format(mount.time_offset_s) +
         "\n      uncertainty: {zero_deg: " + degrees(mount.uncertainty.zero_rad) +
         ", time_s: " + Format(mount.uncertainty.time_s) +
         ", rate: " + Format(mount.uncertainty.rate) +
         ", axis_deg: " + degrees(mount.uncertainty.axis_rad) +
         ", point_m: " + Format(mount.uncertainty.point_m) + "}\n";
}

void WriteScanner(const Scanner& scanner, std::ostream& out) {
  const Rigid3d& pose = scanner.body_from_scanner;
  out << "  - name: " << Quote(scanner.name) << "\n"
      << "    topic: " << Quote(scanner.topic) << "\n"
      << "    body_from_scanner:\n"
      << "      translation: " << Format(pose.translation) << "\n"
      << "      rotation_rpy_deg: " << Format(RollPitchYawDegrees(pose.rotation)) << "\n"
      << (scanner.mount ? MountText(*scanner.mount) : "") << "    range_noise_m: "
      << (scanner.estimates_noise ? kEstimate : Format(scanner.range_noise_m)) << "\n"
      << (scanner.range_noise_per_m2 == 0.0
              ? ""
              : "    range_noise_per_m2: " + Format(scanner.range_noise_per_m2) + "\n")
      << "    angle_noise_deg: " << Format(scanner.angle_noise_rad / kRadiansPerDegree) << "\n"
      << "    min_range_m: " << Format(scanner.min_range_m) << "\n"
      << "    max_range_m: " << Format(scanner.max_range_m) << "\n"
      << "    time_offset_s: " << Format(scanner.time_offset_s) << "\n"
      << "    range_bias_m: " << Format(scanner.range_bias_m) << "\n"
      << "    range_scale: " << Format(scanner.range_scale) << "\n"
      << "    uncertainty: {rotation_deg: "
      << Format(scanner.uncertainty.rotation_rad / kRadiansPerDegree)
      << ", translation_m: " << Format(scanner.uncertainty.translation_m)
      << ", time_s: " << Format(scanner.uncertainty.time_s)
      << ", range_m: " << Format(scanner.uncertainty.range_m)
      << ", range_scale: " << Format(scanner.uncertainty.range_scale) << "}\n"
      << HeaderText(scanner) << "    beams: " << scanner.beams << "\n"
      << "    field_of_view_deg: " << Format(scanner.field_of_view_deg) << "\n"
      << "    scan_rate_hz: " << Format(scanner.scan_rate_hz) << "\n";
}

// A key with the errors of a gyroscope or an accelerometer, and its unit in rad/s or m/s^2.
struct InertialUnit {
  const char* name;
  double size;
};

struct InertialUnits {
  InertialUnit noise, bias_instability, bias, range;
};

const InertialUnits kGyroscopeUnits = {{"noise_deg_s_sqrt_hz", kRadiansPerDegree},
                                       {"bias_instability_deg_h", kRadiansPerDegree / 3600.0},
                                       {"bias_deg_s", kRadiansPerDegree},
                                       {"range_deg_s", kRadiansPerDegree}};
const InertialUnits kAccelerometerUnits = {{"noise_ug_sqrt_hz", 1e-6 * kStandardGravity},
                                           {"bias_instability_ug", 1e-6 * kStandardGravity},
                                           {"bias_mg", 1e-3 * kStandardGravity},
                                           {"range_g", kStandardGravity}};
const std::string kScaleError = "scale_error";

// errors: what stands for keys that are missing; the noise has to be there.
InertialErrors ReadInertialErrors(const YamlNode& node,
                                  const InertialUnits& units,
                                  InertialErrors errors) {
  const auto read = [&](const InertialUnit& unit, double* value) {
    if (node.Has(unit.name)) *value = node[unit.name].AsDouble(0.0, 1e6) * unit.size;
  };
  errors.noise = node[units.noise.name].AsDouble(1e-9, 1e6) * units.noise.size;
  read(units.bias_instability, &errors.bias_instability);
  read(units.bias, &errors.bias);
  read(units.range, &errors.range);
  node.Optional(kScaleError, &errors.scale, 0.0, 0.5);
  node.RejectUnreadKeys();
  return errors;
}

// Of sensors that cost some dollars, once they are soldered.
InertialErrors CheapGyroscope() {
  return {0.0, 20.0 / 3600.0 * kRadiansPerDegree, 5.0 * kRadiansPerDegree, 0.03};
}
InertialErrors CheapAccelerometer() {
  return {0.0, 1e-4 * kStandardGravity, 0.05 * kStandardGravity, 0.03};
}

Imu ReadImu(const YamlNode& node) {
  Imu imu;
  imu.topic = node["topic"].AsString();
  imu.body_from_imu = ReadRigid(node["body_from_imu"]);
  imu.gyroscope = ReadInertialErrors(node["gyroscope"], kGyroscopeUnits, CheapGyroscope());
  imu.accelerometer =
      ReadInertialErrors(node["accelerometer"], kAccelerometerUnits, CheapAccelerometer());
  node.Optional("time_offset_s", &imu.time_offset_s, -10.0, 10.0);
  ScannerUncertainty uncertainty = MeasuredByHand();
  if (node.Has("uncertainty")) {
    uncertainty = ReadUncertainty(node["uncertainty"]);
    if (node["uncertainty"].Has("range_m")) {
      node["uncertainty"]["range_m"].Fail("an IMU measures no ranges");
    }
  }
  imu.rotation_rad = uncertainty.rotation_rad;
  imu.translation_m = uncertainty.translation_m;
  imu.time_s = uncertainty.time_s;
  node.RejectUnreadKeys();
  return imu;
}

std::string InertialErrorsText(const InertialErrors& errors, const InertialUnits& units) {
  std::string text;
  const auto add = [&text](const std::string& name, double value) {
    text += (text.empty() ? "{" : ", ") + name + ": " + Format(value);
  };
  add(units.noise.name, errors.noise / units.noise.size);
  add(units.bias_instability.name, errors.bias_instability / units.bias_instability.size);
  add(units.bias.name, errors.bias / units.bias.size);
  add(kScaleError, errors.scale);
  if (std::isfinite(errors.range)) add(units.range.name, errors.range / units.range.size);
  return text + "}";
}

void WriteImu(const Imu& imu, std::ostream& out) {
  out << "imu:\n"
      << "  topic: " << Quote(imu.topic) << "\n"
      << "  body_from_imu:\n"
      << "    translation: " << Format(imu.body_from_imu.translation) << "\n"
      << "    rotation_rpy_deg: " << Format(RollPitchYawDegrees(imu.body_from_imu.rotation))
      << "\n"
      << "  gyroscope: " << InertialErrorsText(imu.gyroscope, kGyroscopeUnits) << "\n"
      << "  accelerometer: " << InertialErrorsText(imu.accelerometer, kAccelerometerUnits)
      << "\n"
      << "  time_offset_s: " << Format(imu.time_offset_s) << "\n"
      << "  uncertainty: {rotation_deg: " << Format(imu.rotation_rad / kRadiansPerDegree)
      << ", translation_m: " << Format(imu.translation_m) << ", time_s: " << Format(imu.time_s)
      << "}\n";
}

double TiltOf(const Eigen::Vector3d& normal_body) {
  return std::atan2(normal_body.head<2>().norm(), std::abs(normal_body.z()));
}

// The angle between a scan plane and the horizontal one of the body; the largest that a mount
// gives it.
double Tilt(const Scanner& scanner) {
  const Eigen::Vector3d normal_body =
      scanner.body_from_scanner.rotation * Eigen::Vector3d::UnitZ();
  double tilt = TiltOf(normal_body);
  if (!scanner.mount) return tilt;
  const Mount& mount = *scanner.mount;
  const double reach = mount.swing ? mount.swing->amplitude_rad : 0.5 * M_PI;
  for (const double angle : {mount.zero_rad - reach, mount.zero_rad, mount.zero_rad + reach}) {
    tilt = std::max(tilt, TiltOf(mount.TurnBy(angle).rotation * normal_body));
  }
  return tilt;
}

bool IsExact(const ScannerUncertainty& uncertainty) {
  return uncertainty.rotation_rad == 0.0 && uncertainty.translation_m == 0.0 &&
         uncertainty.time_s == 0.0;
}

bool IsExact(const MountUncertainty& uncertainty) {
  return uncertainty.zero_rad == 0.0 && uncertainty.time_s == 0.0 && uncertainty.rate == 0.0 &&
         uncertainty.axis_rad == 0.0 && uncertainty.point_m == 0.0;
}

}  // namespace

Rig ReadRig(const std::string& path) {
  const YamlNode root = YamlNode::ReadFile(path);
  Rig rig;
  if (root.Has("motion")) {
    rig.motion = static_cast<MotionModel>(
        root["motion"].AsChoice({kMotionNames.begin(), kMotionNames.end()}));
  }
  std::set<std::string> names;
  std::set<std::string> topics;
  for (const YamlNode& node : root["scanners"].Elements()) {
    const Scanner scanner = ReadScanner(node);
    if (!names.insert(scanner.name).second) {
      node["name"].Fail("a scanner named '" + scanner.name + "' stands above already");
    }
    if (!topics.insert(scanner.topic).second) {
      node["topic"].Fail("topic '" + scanner.topic + "' belongs to a scanner above already");
    }
    rig.scanners.push_back(scanner);
  }
  if (root.Has("odometry")) {
    const YamlNode odometry = root["odometry"];
    rig.odometry_topic = odometry["topic"].AsString();
    if (odometry.Has("time_offset_s")) {
      rig.odometry_time_offset_s = odometry["time_offset_s"].AsDouble(-10.0, 10.0);
    }
    odometry.RejectUnreadKeys();
  }
  if (root.Has("imu")) rig.imu = ReadImu(root["imu"]);
  if (rig.scanners.empty()) root["scanners"].Fail("the rig has no scanner");
  root.RejectUnreadKeys();
  return rig;
}

void WriteRig(const Rig& rig, const std::string& path) {
  std::ostringstream out;
  out << "motion: " << kMotionNames.at(static_cast<size_t>(rig.motion)) << "\nscanners:\n";
  for (const Scanner& scanner : rig.scanners) WriteScanner(scanner, out);
  if (!rig.odometry_topic.empty()) {
    out << "odometry:\n"
        << "  topic: " << Quote(rig.odometry_topic) << "\n";
    if (rig.odometry_time_offset_s) {
      out << "  time_offset_s: " << Format(*rig.odometry_time_offset_s) << "\n";
    }
  }
  if (rig.imu) WriteImu(*rig.imu, out);
  WriteFileAtomically(path, out.str());
}

bool IsPlanar(const Rig& rig) {
  // Scan planes tilted by less against the body see no heights: 2 degrees move a wall 5 m away
  // by 17 cm up or down, and a wall looks the same there.
  constexpr double kTolerance = 2.0 * M_PI / 180.0;
  return rig.motion == MotionModel::kPlanar ||
         (rig.motion == MotionModel::kAutomatic && AllScannersHorizontal(rig, kTolerance));
}

bool AllScannersHorizontal(const Rig& rig, double tolerance_rad) {
  return std::all_of(rig.scanners.begin(), rig.scanners.end(), [&](const Scanner& scanner) {
    return Tilt(scanner) <= tolerance_rad;
  });
}

std::optional<size_t> ExactlyPlacedScanner(const Rig& rig) {
  const auto exact =
      std::find_if(rig.scanners.begin(), rig.scanners.end(), [](const Scanner& scanner) {
        return !scanner.mount && IsExact(scanner.uncertainty);
      });
  if (exact == rig.scanners.end()) return std::nullopt;
  return static_cast<size_t>(exact - rig.scanners.begin());
}

size_t BodyScanner(const Rig& rig) {
  if (const auto exact = ExactlyPlacedScanner(rig)) return *exact;
  const auto moves = [](const Scanner& scanner) { return scanner.mount.has_value(); };
  const bool all_move = std::all_of(rig.scanners.begin(), rig.scanners.end(), moves);
  const auto can_be_body = [&](const Scanner& scanner) { return all_move || !moves(scanner); };
  if (IsPlanar(rig)) {
    return static_cast<size_t>(
        std::find_if(rig.scanners.begin(), rig.scanners.end(), can_be_body) -
        rig.scanners.begin());
  }
  // A level scanner sees neither floor nor ceiling, by which the body's attitude is known. Of
  // scanners that are about as steep it is the first, however a rig file is off.
  double steepest = 0.0;
  for (const Scanner& scanner : rig.scanners) {
    if (can_be_body(scanner)) steepest = std::max(steepest, Tilt(scanner));
  }
  const auto body =
      std::find_if(rig.scanners.begin(), rig.scanners.end(), [&](const Scanner& scanner) {
        return can_be_body(scanner) && 2.0 * Tilt(scanner) >= steepest;
      });
  return static_cast<size_t>(body - rig.scanners.begin());
}

bool EstimatesScanners(const Rig& rig) {
  return rig.scanners.size() > 1 &&
         std::any_of(rig.scanners.begin(), rig.scanners.end(), [](const Scanner& scanner) {
           return !IsExact(scanner.uncertainty) || scanner.uncertainty.range_m > 0.0 ||
                  scanner.uncertainty.range_scale > 0.0 ||
                  (scanner.mount && !IsExact(scanner.mount->uncertainty));
         });
}

double MaxRangeNoise(const Rig& rig) {
  double range_noise_m = 0.0;
  for (const Scanner& scanner : rig.scanners) {
    range_noise_m = std::max(range_noise_m, scanner.RangeStddev(scanner.max_range_m));
  }
  return range_noise_m;
}

}  // namespace plumbline
