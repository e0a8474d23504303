#include "core/options/config.h"

#include <iomanip>
#include <limits>
#include <sstream>

#include "core/util/error.h"
#include "core/util/yaml_node.h"

namespace plumbline {
namespace {

// The settings of what takes the whole map at once, see Visit.
template <typename Options, typename Visitor>
void VisitWholeMap(Options& o, Visitor& v) {
  v.Section("loop_closure", [&](auto& s) {
    s.Flag("enabled", o.loop_closure.enabled);
    s.Integer(
        "max_gap_scans", o.loop_closure.max_gap_scans, 1, std::numeric_limits<int>::max());
  });
  v.Section("batch", [&](auto& s) {
    s.Choice("solver", o.batch.solver, {"gauss_newton", "ceres"});
    s.Choice("factor", o.batch.factor, {"segment", "point"});
    s.Integer("max_rounds", o.batch.max_rounds, 1, 1000);
    s.Flag("resegment", o.batch.resegment);
    s.Renamed("recut_segments", "resegment");
    s.Choice("correlated_errors", o.batch.correlated_errors, {"off", "estimated"});
    s.Removed("estimate_motion_noise",
              "covariances are always for the motion that the recording shows");
  });
  v.Section("recording", [&](auto& s) { s.Number("max_gap_s", o.max_gap_s, 0.01, 1e6); });
}

// The settings of how the rig moves, see Visit.
template <typename Options, typename Visitor>
void VisitTrajectory(Options& o, Visitor& v) {
  v.Section("trajectory", [&](auto& s) {
    s.Number("knot_interval_s", o.trajectory.knot_interval_s, 0.01, 10.0);
    s.Number("min_scans_per_knot", o.trajectory.min_scans_per_knot, 0.1, 100.0);
    s.Number("acceleration_density_m_s2", o.trajectory.acceleration_density_m_s2, 1e-4, 1e3);
    s.Number("angular_acceleration_density_deg_s2",
             o.trajectory.angular_acceleration_density_deg_s2,
             1e-3,
             1e5);
    s.Number("acceleration_correlation_s", o.trajectory.acceleration_correlation_s, 0.0, 10.0);
    s.Number("vertical_velocity_correlation_s",
             o.trajectory.vertical_velocity_correlation_s,
             1e-2,
             1e3);
    s.Flag("estimate_densities", o.trajectory.estimate_densities);
    s.Number("bridging_acceleration_density_m_s2",
             o.trajectory.bridging_acceleration_density_m_s2,
             1e-4,
             1e3);
    s.Number("initial_speed_stddev_m_s", o.trajectory.initial_speed_stddev_m_s, 1e-3, 100.0);
    s.Number("initial_turn_rate_stddev_deg_s",
             o.trajectory.initial_turn_rate_stddev_deg_s,
             1e-2,
             1e4);
  });
}

template <typename Options, typename Visitor>
void VisitRules(Options& o, Visitor& v) {
  v.Section("rules", [&](auto& s) {
    s.Flag("second_hypothesis", o.rules.second_hypothesis);
    s.Flag("thin_evidence", o.rules.thin_evidence);
    s.Flag("points_over_planes", o.rules.points_over_planes);
    s.Flag("half_window_steps", o.rules.half_window_steps);
    s.Flag("several_starts", o.rules.several_starts);
    s.Flag("beams_behind_walls", o.rules.beams_behind_walls);
    s.Flag("redundant_planes", o.rules.redundant_planes);
    s.Flag("passed_through_planes", o.rules.passed_through_planes);
    s.Flag("oblique_planes", o.rules.oblique_planes);
    s.Flag("bent_walls", o.rules.bent_walls);
    s.Flag("rows_of_chords", o.rules.rows_of_chords);
  });
}

// Visit() is the one place that ties every option to its YAML name and range. A visitor sees
// sections and fields in a fixed order; one reads, one writes, one checks.
template <typename Options, typename Visitor>
void Visit(Options& o, Visitor& v) {
  VisitTrajectory(o, v);
  v.Section("segmentation", [&](auto& s) {
    s.Integer("min_points", o.segmentation.min_points, 3, 1000);
    s.Number("significance", o.segmentation.significance, 1e-12, 0.5);
    s.Number("ambiguity_sigmas", o.segmentation.ambiguity_sigmas, 0.0, 100.0);
  });
  v.Section("association", [&](auto& s) {
    s.Number("significance", o.association.significance, 1e-12, 0.5);
    s.Number("max_gap_m", o.association.max_gap_m, 0.0, 100.0);
    s.Number("surface_flatness_m", o.association.surface_flatness_m, 1e-4, 1.0);
    s.Number("huber_width", o.association.huber_width, 1.0, 1000.0);
  });
  v.Section("planes", [&](auto& s) {
    s.Integer("min_points", o.planes.min_points, 3, 10000);
    s.Number("max_direction_sigma_deg", o.planes.max_direction_sigma_deg, 0.01, 90.0);
    s.Integer("min_scans", o.planes.min_scans, 1, 1000);
    s.Number("small_m", o.planes.small_m, 0.0, 1000.0);
    s.Number("min_age_of_small_s", o.planes.min_age_of_small_s, 0.0, 1e6);
    s.Number("max_tentative_age_s", o.planes.max_tentative_age_s, 0.0, 1e6);
    s.Renamed("max_candidate_age_s", "max_tentative_age_s");
  });
  v.Section("tracking", [&](auto& s) {
    s.Number("min_part_s", o.tracking.min_part_s, 0.0, 1e6);
    s.Number("max_undecided_s", o.tracking.max_undecided_s, 0.0, 1000.0);
    s.Number("max_start_search_s", o.tracking.max_start_search_s, 0.0, 1e6);
    s.Number("lost_position_m", o.tracking.lost_position_m, 1e-3, 100.0);
    s.Number("lost_rotation_deg", o.tracking.lost_rotation_deg, 1e-2, 180.0);
  });
  v.Section("window", [&](auto& s) {
    s.Choice("solver", o.window.solver, {"gauss_newton", "ceres"});
    s.Integer("num_scans", o.window.num_scans, 2, 10000);
    s.Number("step_s", o.window.step_s, 0.001, 100.0);
    s.Flag("resegment", o.window.resegment);
    s.Renamed("recut_segments", "resegment");
    s.Flag("keep_estimates", o.window.keep_estimates);
    s.Renamed("keep_statements", "keep_estimates");
  });
  v.Section("points", [&](auto& s) {
    s.Flag("hold_pose", o.points.hold_pose);
    s.Number("cell_m", o.points.cell_m, 0.02, 10.0);
    s.Number("surface_stddev_m", o.points.surface_stddev_m, 0.0005, 1.0);
    s.Number("min_age_s", o.points.min_age_s, 0.0, 1000.0);
    s.Flag("leave_out_moving", o.points.leave_out_moving);
    s.Number("max_age_s", o.points.max_age_s, 0.1, 1e6);
  });
  v.Section("odometry", [&](auto& s) {
    s.Flag("enabled", o.odometry.enabled);
    s.Number("length_noise", o.odometry.length_noise, 1e-3, 10.0);
    s.Number("turn_noise", o.odometry.turn_noise, 1e-3, 10.0);
  });
  VisitRules(o, v);
  VisitWholeMap(o, v);
}

struct FieldReader {
  const YamlNode& node;
  void Number(const char* key, double& value, double min, double max) {
    node.Optional(key, &value, min, max);
  }
  void Integer(const char* key, int& value, int min, int max) {
    node.Optional(key, &value, min, max);
  }
  void Flag(const char* key, bool& value) { node.Optional(key, &value); }
  void Removed(const char* key, const char* why) { node.RejectRemoved(key, why); }
  void Renamed(const char* old_key, const char* new_key) {
    node.RejectRenamed(old_key, new_key);
  }
  template <typename Enum>
  void Choice(const char* key, Enum& value, const std::vector<std::string>& words) {
    if (node.Has(key)) value = static_cast<Enum>(node[key].AsChoice(words));
  }
};

struct SectionReader {
  const YamlNode& root;
  template <typename Fields>
  void Section(const char* name, Fields fields) {
    if (!root.Has(name)) return;
    const YamlNode section = root[name];
    FieldReader reader{section};
    fields(reader);
    section.RejectUnreadKeys();
  }
};

struct FieldChecker {
  std::string section;
  template <typename Value>
  void CheckRange(const char* key, Value value, Value min, Value max) {
    if (value >= min && value <= max) return;  // NaN is outside
    std::ostringstream message;
    message << "'" << section << "." << key << "' must lie between " << min << " and " << max
            << ", not " << value;
    throw Error(message.str());
  }
  void Number(const char* key, double value, double min, double max) {
    CheckRange(key, value, min, max);
  }
  void Integer(const char* key, int value, int min, int max) {
    CheckRange(key, value, min, max);
  }
  void Flag(const char*, bool) {}
  template <typename Enum>
  void Choice(const char*, Enum, const std::vector<std::string>&) {}
  void Removed(const char*, const char*) {}
  void Renamed(const char*, const char*) {}
};

struct SectionChecker {
  template <typename Fields>
  void Section(const char* name, Fields fields) {
    FieldChecker checker{name};
    fields(checker);
  }
};

struct FieldWriter {
  std::ostream& out;
  void Number(const char* key, double value, double, double) { Line(key) << value << "\n"; }
  void Integer(const char* key, int value, int, int) { Line(key) << value << "\n"; }
  void Flag(const char* key, bool value) { Line(key) << (value ? "true" : "false") << "\n"; }
  template <typename Enum>
  void Choice(const char* key, Enum value, const std::vector<std::string>& words) {
    Line(key) << words[static_cast<size_t>(value)] << "\n";
  }
  void Removed(const char*, const char*) {}
  void Renamed(const char*, const char*) {}
  std::ostream& Line(const char* key) { return out << "  " << key << ": "; }
};

struct SectionWriter {
  std::ostream& out;
  template <typename Fields>
  void Section(const char* name, Fields fields) {
    out << name << ":\n";
    FieldWriter writer{out};
    fields(writer);
  }
};

}  // namespace

MapperOptions MapperOptions::DefaultsFor(bool planar) {
  MapperOptions options;
  if (!planar) return options;
  options.trajectory.knot_interval_s = 0.125;
  options.trajectory.min_scans_per_knot = 1.5;
  // What their slow scans show of single accelerations is too little to estimate these.
  options.trajectory.acceleration_density_m_s2 = 0.35;
  options.trajectory.angular_acceleration_density_deg_s2 = 21.0;
  options.trajectory.acceleration_correlation_s = 0.0;
  options.trajectory.estimate_densities = false;
  // What the extrinsics leave between the scanners shows on every surface.
  options.association.surface_flatness_m = 0.015;
  options.window.num_scans = 20;  // long enough to outlast a wrong association
  return options;
}

void MapperOptions::Check() const {
  SectionChecker checker;
  Visit(*this, checker);
}

MapperOptions ReadMapperOptions(const std::string& path, const MapperOptions& defaults) {
  const YamlNode file = YamlNode::ReadFile(path);
  MapperOptions options = defaults;
  // An experiment is known by its building; its other keys are the simulator's to check.
  const bool is_experiment = file.Has("building") || file.Has("mapper");
  if (is_experiment && !file.Has("mapper")) return options;
  const YamlNode root = is_experiment ? file["mapper"] : file;
  SectionReader reader{root};
  Visit(options, reader);
  root.RejectUnreadKeys();
  return options;
}

std::string MapperOptionsToYaml(const MapperOptions& options) {
  std::ostringstream out;
  out << std::setprecision(12);
  SectionWriter writer{out};
  Visit(options, writer);
  return out.str();
}

}  // namespace plumbline
