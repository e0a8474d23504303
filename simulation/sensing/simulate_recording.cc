#include "simulation/sensing/simulate_recording.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <system_error>

#include "core/result/result_text.h"
#include "core/util/atomic_file.h"
#include "core/util/error.h"
#include "core/util/time.h"
#include "simulation/sensing/recorder.h"
#include "simulation/sensing/recording_writer.h"

namespace plumbline {
namespace {

constexpr int64_t kTruthStepNs = 5000000;  // divides the period of a 40 Hz scanner

}  // namespace

TruthPlanes::TruthPlanes(const Building& building) {
  for (const Face& face : building.faces) {
    PlanePatch& patch = patches_.emplace_back();
    patch.id = face.id;
    patch.type = face.type;
    patch.normal = face.normal;
    patch.distance = face.distance;
    patch.curvature = face.curvature;
    patch.centre = face.Centroid();
    patch.outline = face.OutlineOfPieces();
  }
  num_from_behind_.assign(patches_.size(), 0);
}

void TruthPlanes::Add(const PerfectScanLine& perfect,
                      const ScanLine& recorded,
                      double time_offset_s) {
  const int64_t offset_ns = NanosecondsFromSeconds(time_offset_s);
  for (int beam = 0; beam < recorded.num_beams(); ++beam) {
    const std::optional<RayHit>& hit = perfect.beams[static_cast<size_t>(beam)];
    if (!hit || hit->face_id == kNoFace) continue;
    if (!std::isfinite(recorded.ranges[static_cast<size_t>(beam)])) continue;
    PlanePatch& patch = patches_[static_cast<size_t>(hit->face_id)];
    const int64_t time_ns = recorded.BeamTime(beam) + offset_ns;
    if (patch.num_points == 0) patch.first_time_ns = patch.last_time_ns = time_ns;
    patch.first_time_ns = std::min(patch.first_time_ns, time_ns);
    patch.last_time_ns = std::max(patch.last_time_ns, time_ns);
    ++patch.num_points;
    num_from_behind_[static_cast<size_t>(hit->face_id)] += hit->from_behind;
  }
}

std::vector<PlanePatch> TruthPlanes::Patches() const {
  std::vector<PlanePatch> seen;
  for (size_t i = 0; i < patches_.size(); ++i) {
    if (patches_[i].num_points == 0) continue;
    PlanePatch& patch = seen.emplace_back(patches_[i]);
    if (2 * num_from_behind_[i] <= patch.num_points) continue;
    patch.normal = -patch.normal;
    patch.distance = -patch.distance;
    patch.curvature = -patch.curvature;
    std::reverse(patch.outline.begin(), patch.outline.end());
  }
  return seen;
}

std::vector<StampedPose> TruthTrajectory(const Path& path) {
  std::vector<StampedPose> poses;
  for (int64_t time_ns = path.start_ns(); time_ns < path.end_ns(); time_ns += kTruthStepNs) {
    poses.push_back({time_ns, path.PoseAt(time_ns)});
  }
  poses.push_back({path.end_ns(), path.PoseAt(path.end_ns())});
  return poses;
}

SimulationSummary SimulateRecording(const std::string& experiment_path,
                                    uint64_t seed,
                                    const std::string& output_directory,
                                    const ProgressCallback& progress) {
  const Experiment experiment = ReadExperiment(experiment_path);
  const Simulator simulator(experiment, seed);
  std::error_code error;
  std::filesystem::create_directories(output_directory, error);
  if (!std::filesystem::is_directory(output_directory)) {
    throw Error(output_directory + ": can not create the directory");
  }
  const std::filesystem::path directory = output_directory;
  RecordingWriter writer((directory / "recording.bag").string(), experiment.rig);
  TruthPlanes truth_planes(experiment.building);
  Recorder recorder(experiment, seed);
  const Path& path = simulator.path();
  SimulationSummary summary;
  summary.duration_s = SecondsBetween(path.start_ns(), path.end_ns());
  summary.num_scanners = static_cast<int>(experiment.rig.scanners.size());
  std::vector<OdometrySample> wheels;
  if (experiment.wheels) wheels = WheelSamples(path, *experiment.wheels, seed);
  auto next_wheels = wheels.begin();
  SimulatedImu imu;
  if (experiment.inertial) {
    imu = SimulateImu(path, *experiment.rig.imu, *experiment.inertial, seed);
  }
  auto next_imu = imu.samples.begin();
  const std::vector<MountReading>& angles = simulator.mounts().readings;
  auto next_angle = angles.begin();
  int num_done = 0;
  simulator.Run([&](const PerfectScanLine& perfect) {
    for (; next_wheels != wheels.end() && next_wheels->time_ns < perfect.scan_line.stamp_ns;
         ++next_wheels) {
      writer.Write(*next_wheels);
    }
    for (; next_imu != imu.samples.end() && next_imu->time_ns < perfect.scan_line.stamp_ns;
         ++next_imu) {
      writer.Write(*next_imu);
    }
    for (; next_angle != angles.end() && next_angle->stamp_ns < perfect.scan_line.stamp_ns;
         ++next_angle) {
      writer.Write(*next_angle);
    }
    const auto scanner_index = static_cast<size_t>(perfect.scan_line.scanner_index);
    const std::optional<ScanLine> recorded = recorder.Record(perfect);
    if (recorded) {
      const double offset_s = simulator.true_rig().scanners[scanner_index].time_offset_s;
      truth_planes.Add(perfect, *recorded, offset_s);
      writer.Write(*recorded);
      ++summary.num_scan_lines;
      summary.num_beams += static_cast<int64_t>(recorded->ranges.size());
    }
    ProgressState state(static_cast<double>(++num_done) / simulator.num_scan_lines());
    state.recording_s = summary.duration_s;
    progress(state);
  });
  for (; next_wheels != wheels.end(); ++next_wheels) writer.Write(*next_wheels);
  for (; next_imu != imu.samples.end(); ++next_imu) writer.Write(*next_imu);
  for (; next_angle != angles.end(); ++next_angle) writer.Write(*next_angle);
  writer.Close();
  WriteRig(experiment.rig, (directory / "rig.yaml").string());
  const std::vector<StampedPose> trajectory = TruthTrajectory(path);
  const std::vector<PlanePatch> faces = truth_planes.Patches();
  WriteFileAtomically((directory / "truth_trajectory.tum").string(),
                      FormatTrajectory(trajectory));
  WriteFileAtomically((directory / "truth_planes.json").string(), FormatPlanes(faces));
  if (experiment.inertial) {
    WriteFileAtomically((directory / "truth_imu.json").string(), FormatInertialTruth(imu));
  }
  if (!simulator.mounts().truths.empty()) {
    WriteFileAtomically((directory / "truth_mounts.json").string(),
                        FormatMountTruth(simulator.mounts().truths));
  }
  for (size_t i = 1; i < trajectory.size(); ++i) {
    summary.path_length_m += (trajectory[i].world_from_body.translation -
                              trajectory[i - 1].world_from_body.translation)
                                 .norm();
  }
  summary.num_faces = static_cast<int>(faces.size());
  return summary;
}

std::string SimulationTable(const SimulationSummary& summary,
                            const std::string& output_directory) {
  char text[400];
  std::snprintf(text,
                sizeof(text),
                "  %-24s %10s unit\n"
                "  %-24s %10.1f s\n"
                "  %-24s %10.1f m\n"
                "  %-24s %10d\n"
                "  %-24s %10lld\n"
                "  %-24s %10lld\n"
                "  %-24s %10d\n",
                "what",
                "value",
                "recording",
                summary.duration_s,
                "trajectory",
                summary.path_length_m,
                "scanners",
                summary.num_scanners,
                "scan lines",
                static_cast<long long>(summary.num_scan_lines),
                "beams",
                static_cast<long long>(summary.num_beams),
                "faces that beams hit",
                summary.num_faces);
  return text + ("Written to " + output_directory +
                 ": recording.bag, rig.yaml (for plumbline_map), truth_planes.json and "
                 "truth_trajectory.tum (for plumbline_evaluate)\n");
}

}  // namespace plumbline
