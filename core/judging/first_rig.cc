#include "core/judging/first_rig.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "core/geometry/angles.h"
#include "core/geometry/roll_pitch_yaw.h"
#include "core/judging/levels.h"
#include "core/judging/words.h"
#include "core/util/one_line.h"

namespace plumbline {
namespace {

std::string Quoted(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : OnOneLine(text)) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + "\"";
}

// Returns the topic without its slash, made different from all `names`.
std::string NameFor(const std::string& topic, std::set<std::string>* names) {
  std::string name = topic.substr(std::min(topic.find_first_not_of('/'), topic.size()));
  std::replace(name.begin(), name.end(), '/', '_');
  if (name.empty()) name = "scanner";
  while (!names->insert(name).second) name += "_";
  return name;
}

// Beyond what the rig itself returns.
double MinRangeOf(const TopicSurvey& topic) {
  double min_range_m = std::max(0.1, topic.metres_per_unit * topic.stated_min_range_m);
  for (const BeamCounts& beam : topic.beams) {
    if (beam.num_near <= kMost * beam.num_lines) continue;
    min_range_m = std::max(min_range_m, 1.05 * static_cast<double>(beam.farthest_near_m));
  }
  return std::ceil(100.0 * min_range_m) / 100.0;
}

double MaxRangeOf(const TopicSurvey& topic) {
  const bool is_limited = topic.limits.max_m < 1e6;
  const double max_range_m = is_limited ? topic.limits.max_m : topic.largest_range_m + 0.1;
  return std::max(1.0, std::floor(100.0 * max_range_m - 1e-6) / 100.0);
}

// The yaw with which a level scanner's travel is forward.
double YawDegrees(const TravelDirection& travel) {
  return std::round(-travel.angle_rad / kRadiansPerDegree) + 0.0;  // not -0
}

std::string RotationComment(Attitude attitude, const std::optional<TravelDirection>& travel) {
  switch (attitude) {
    case Attitude::kLevel:
      if (travel) {
        const double yaw_deg = YawDegrees(*travel);
        return "# level; yaw so that the rig goes forward, from " +
               std::to_string(travel->num_steps) + " half seconds (median deviation " +
               Decimal(travel->spread_rad / kRadiansPerDegree, 0) +
               " deg): MEASURE it; other way round where the rig went backwards; upside "
               "down: roll 180, yaw " +
               Decimal(0.0 - yaw_deg, 0);
      }
      return "# it stands level: roll 0 (180 where it hangs upside down), pitch 0; FILL IN "
             "yaw: the angle from the rig's forward axis to the beam at angle 0, "
             "counter-clockwise";
    case Attitude::kTilted:
      return "# FILL IN; it is not level: it sees floor or ceiling";
    case Attitude::kNodding:
      return "# FILL IN, at angle 0 of the mount below";
    case Attitude::kUnknown:
      return "# FILL IN; whether it is level, the scans do not show";
  }
  return "";
}

// The mount of a scanner that nods.
std::string MountText(const Nod& nod) {
  const double degrees = nod.axis_rad / kRadiansPerDegree;
  return "    mount:                    # it nods about an axis that lies in its scan "
         "plane at about " +
         Decimal(degrees, 0) +
         " deg\n"
         "      axis: [0.0, 1.0, 0.0]   # FILL IN, in the body frame\n"
         "      # FILL IN: joint_topic and joint where the angle was recorded, instead of:\n"
         "      swing: {amplitude_deg: 30.0, period_s: " +
         Decimal(nod.period_s, 3) + "}\n";
}

// Pose of a topic's scanner by the recording's static transforms.
std::optional<Rigid3d> PoseOf(const CheckReport& report, size_t topic) {
  const std::vector<std::string>& frames = report.survey.topics[topic].frames;
  const auto& poses = report.survey.frames.body_from_frame;
  if (frames.size() != 1 || poses.count(frames.front()) == 0) return std::nullopt;
  return poses.at(frames.front());
}

std::string PoseText(const Rigid3d& body_from_scanner, const std::string& body) {
  const auto list = [](const Eigen::Vector3d& v, int digits) {
    return "[" + Decimal(v.x(), digits) + ", " + Decimal(v.y(), digits) + ", " +
           Decimal(v.z(), digits) + "]";
  };
  return "      translation: " + list(body_from_scanner.translation, 4) +
         "        # of /tf_static, in " + OnOneLine(body) + "\n      rotation_rpy_deg: " +
         list(RollPitchYawDegrees(body_from_scanner.rotation), 3) + "\n";
}

}  // namespace

bool HasAllPoses(const CheckReport& report) {
  for (size_t i = 0; i < report.survey.topics.size(); ++i) {
    if (!PoseOf(report, i)) return false;
  }
  return !report.survey.topics.empty();
}

std::string FormatFirstRig(const CheckReport& report) {
  std::string text =
      "# A first rig file for " + OnOneLine(report.survey.path) +
      ", made by plumbline_check.\n"
      "# Replace what is marked FILL IN; the other values were read off the recording.\n"
      "# Body axes: x forward, y left, z up. Scanner axes: x along the beam at angle 0, "
      "beams\n"
      "# turning counter-clockwise about z. Rotation: R = Rz(yaw) Ry(pitch) Rx(roll), "
      "degrees.\n"
      "# Leave a scanner out by deleting its block.\n"
      "motion: automatic\n"
      "scanners:\n";
  std::set<std::string> names;
  for (size_t i = 0; i < report.survey.topics.size(); ++i) {
    const TopicSurvey& topic = report.survey.topics[i];
    text += "  - name: " + Quoted(NameFor(topic.name, &names)) + "\n";
    text += "    topic: " + Quoted(topic.name) + "\n";
    text += "    body_from_scanner:\n";
    const std::optional<Rigid3d> pose = PoseOf(report, i);
    if (pose) {
      text += PoseText(*pose, report.survey.frames.body);
    } else {
      text += "      translation: [0.0, 0.0, 0.0]        # FILL IN, metres\n";
      const Attitude attitude = report.attitudes[i].attitude;
      std::optional<TravelDirection> travel;
      if (i < report.travel_directions.size()) travel = report.travel_directions[i];
      const double yaw_deg = travel ? YawDegrees(*travel) : 0.0;
      text += "      rotation_rpy_deg: [0.0, 0.0, " + Decimal(yaw_deg, 1) + "]   " +
              RotationComment(attitude, travel) + "\n";
    }
    if (const auto nod = report.NodOf(i)) text += MountText(*nod);
    text += "    range_noise_m: " + Decimal(std::max(kMinNoise, topic.noise_m), 3) +
            "                  # neighbouring beams show " + Decimal(topic.noise_m, 3) +
            "; uneven walls and the mounting add to it\n";
    text += "    min_range_m: " + Decimal(MinRangeOf(topic), 2) + "\n";
    text += "    max_range_m: " + Decimal(MaxRangeOf(topic), 2) + "\n";
    text += "    time_offset_s: 0.0\n";
  }
  if (report.survey.wheels != nullptr) {
    text +=
        "odometry:\n  topic: " + Quoted(report.survey.wheels_topic) +
        "   # wheels; their clock is found by when they turn, or stated as time_offset_s\n";
  }
  return text;
}

}  // namespace plumbline
