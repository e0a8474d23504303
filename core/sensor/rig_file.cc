#include <algorithm>
#include <array>
#include <charconv>
#include <set>
#include <sstream>

#include "core/geometry/angles.h"
#include "core/geometry/roll_pitch_yaw.h"
#include "core/sensor/rig.h"
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

// Reads what scanners and depth cameras have in common: noise, reach, clock, rate.
void ReadRanging(const YamlNode& node, Scanner* scanner) {
  node.Optional("range_noise_per_m2", &scanner->range_noise_per_m2, 0.0, 1.0);
  scanner->min_range_m = node["min_range_m"].AsDouble(0.0, 1000.0);
  scanner->max_range_m = node["max_range_m"].AsDouble(0.0, 1000.0);
  if (scanner->min_range_m >= scanner->max_range_m) {
    node["min_range_m"].Fail("min_range_m must be less than max_range_m");
  }
  node.Optional("time_offset_s", &scanner->time_offset_s, -10.0, 10.0);
  node.Optional("range_bias_m", &scanner->range_bias_m, -10.0, 10.0);
  node.Optional("range_scale", &scanner->range_scale, 0.5, 2.0);
  double angle_noise_deg = scanner->angle_noise_rad / kRadiansPerDegree;
  node.Optional("angle_noise_deg", &angle_noise_deg, 0.0, 10.0);
  scanner->angle_noise_rad = angle_noise_deg * kRadiansPerDegree;
  node.Optional("scan_rate_hz", &scanner->scan_rate_hz, 0.1, 1000.0);
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
  ReadRanging(node, &scanner);
  scanner.uncertainty =
      node.Has("uncertainty") ? ReadUncertainty(node["uncertainty"]) : MeasuredByHand();
  ReadHeader(node, &scanner);
  node.Optional("beams", &scanner.beams, 2, 100000);
  node.Optional("field_of_view_deg", &scanner.field_of_view_deg, 0.1, 360.0);
  node.RejectUnreadKeys();
  return scanner;
}

PinholeModel ReadModel(const YamlNode& node) {
  const std::vector<double> size = node["image"].AsDoubles(2, 1.0, 100000.0);
  const std::vector<double> angles_deg = node["field_of_view_deg"].AsDoubles(2, 0.1, 179.0);
  return ModelOf(static_cast<int>(size[0]),
                 static_cast<int>(size[1]),
                 angles_deg[0] * kRadiansPerDegree,
                 angles_deg[1] * kRadiansPerDegree);
}

// Reads a depth camera and adds it and its rows to the rig. The pose of a row is known
// exactly: it is the camera's, whose uncertainty this program does not estimate.
void ReadDepthCamera(const YamlNode& node, Rig* rig) {
  DepthCamera camera;
  Scanner row;
  camera.name = node["name"].AsString();
  camera.topic = row.topic = node["topic"].AsString();
  camera.info_topic = node["info_topic"].AsString();
  camera.body_from_camera = ReadRigid(node["body_from_camera"]);
  node.Optional("rows", &camera.num_rows, 1, 200);
  row.range_noise_m = node["range_noise_m"].AsDouble(1e-6, 10.0);
  ReadRanging(node, &row);
  const PinholeModel model = ReadModel(node);
  if (model.height < camera.num_rows) node["image"].Fail("an image has fewer rows than rows");
  node.RejectUnreadKeys();
  for (int i = 0; i < camera.num_rows; ++i) {
    row.name = camera.name + " row " + std::to_string(i + 1);
    row.camera_row = CameraRow{rig->depth_cameras.size(), 0};
    rig->scanners.push_back(row);
  }
  rig->depth_cameras.push_back(camera);
  PlaceRows(rig->depth_cameras.size() - 1, model, rig);
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

std::string PoseText(const std::string& key, const Rigid3d& pose) {
  return "    " + key + ":\n      translation: " + Format(pose.translation) +
         "\n      rotation_rpy_deg: " + Format(RollPitchYawDegrees(pose.rotation)) + "\n";
}

std::string RangingText(const Scanner& scanner) {
  return "    range_noise_m: " +
         (scanner.estimates_noise ? kEstimate : Format(scanner.range_noise_m)) +
         (scanner.range_noise_per_m2 == 0.0
              ? ""
              : "\n    range_noise_per_m2: " + Format(scanner.range_noise_per_m2)) +
         "\n    angle_noise_deg: " + Format(scanner.angle_noise_rad / kRadiansPerDegree) +
         "\n    min_range_m: " + Format(scanner.min_range_m) +
         "\n    max_range_m: " + Format(scanner.max_range_m) +
         "\n    time_offset_s: " + Format(scanner.time_offset_s) +
         "\n    range_bias_m: " + Format(scanner.range_bias_m) +
         "\n    range_scale: " + Format(scanner.range_scale) + "\n";
}

void WriteScanner(const Scanner& scanner, std::ostream& out) {
  out << "  - name: " << Quote(scanner.name) << "\n"
      << "    topic: " << Quote(scanner.topic) << "\n"
      << PoseText("body_from_scanner", scanner.body_from_scanner)
      << (scanner.mount ? MountText(*scanner.mount) : "") << RangingText(scanner)
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

// row: any scanner of the camera's.
void WriteDepthCamera(const DepthCamera& camera, const Scanner& row, std::ostream& out) {
  const PinholeModel& model = camera.model;
  const auto angle_deg = [](int size, double focal) {
    return Format(2.0 * std::atan(0.5 * size / focal) / kRadiansPerDegree);
  };
  out << "  - name: " << Quote(camera.name) << "\n"
      << "    topic: " << Quote(camera.topic) << "\n"
      << "    info_topic: " << Quote(camera.info_topic) << "\n"
      << PoseText("body_from_camera", camera.body_from_camera)
      << "    rows: " << camera.num_rows << "\n"
      << RangingText(row) << "    image: [" << model.width << ", " << model.height << "]\n"
      << "    field_of_view_deg: [" << angle_deg(model.width, model.focal_x) << ", "
      << angle_deg(model.height, model.focal_y) << "]\n"
      << "    scan_rate_hz: " << Format(row.scan_rate_hz) << "\n";
}

void WriteDepthCameras(const Rig& rig, std::ostream& out) {
  for (size_t i = 0; i < rig.depth_cameras.size(); ++i) {
    if (i == 0) out << "depth_cameras:\n";
    const auto row =
        std::find_if(rig.scanners.begin(), rig.scanners.end(), [i](const Scanner& scanner) {
          return scanner.camera_row && scanner.camera_row->camera == i;
        });
    WriteDepthCamera(rig.depth_cameras[i], *row, out);
  }
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
  const auto check_new = [&](const YamlNode& node) {
    const std::string name = node["name"].AsString();
    const std::string topic = node["topic"].AsString();
    if (!names.insert(name).second) {
      node["name"].Fail("a scanner named '" + name + "' stands above already");
    }
    if (!topics.insert(topic).second) {
      node["topic"].Fail("topic '" + topic + "' belongs to a scanner above already");
    }
  };
  const bool has_cameras = root.Has("depth_cameras");
  if (root.Has("scanners") || !has_cameras) {
    for (const YamlNode& node : root["scanners"].Elements()) {
      check_new(node);
      rig.scanners.push_back(ReadScanner(node));
    }
  }
  if (has_cameras) {
    for (const YamlNode& node : root["depth_cameras"].Elements()) {
      check_new(node);
      ReadDepthCamera(node, &rig);
    }
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
  out << "motion: " << kMotionNames.at(static_cast<size_t>(rig.motion)) << "\n";
  const std::vector<Scanner> scanners = WithoutCameraRows(rig).scanners;
  if (!scanners.empty()) out << "scanners:\n";
  for (const Scanner& scanner : scanners) WriteScanner(scanner, out);
  WriteDepthCameras(rig, out);
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

}  // namespace plumbline
