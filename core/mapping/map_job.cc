#include "core/mapping/map_job.h"

#include <glog/logging.h>
#include <sys/resource.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

#include "core/estimation/block_layout.h"
#include "core/geometry/matrix_types.h"
#include "core/map/plane_patches.h"
#include "core/mapping/point_exporter.h"
#include "core/options/config.h"
#include "core/result/plane_covariance.h"
#include "core/result/result_writer.h"
#include "core/trajectory/motion_noise.h"
#include "core/util/stopwatch.h"

namespace plumbline {
namespace {

constexpr double kMappingShare = 0.92;  // of the time, roughly; the rest is writing

// Peak resident memory of this process.
double PeakMemoryMb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

std::vector<StampedPose> Poses(const MapResult& result) {
  std::vector<StampedPose> poses;
  for (const int64_t time_ns : result.scan_times_ns) {
    poses.push_back({time_ns, result.state.trajectory.WorldFromBody(time_ns)});
  }
  return poses;
}

std::vector<StampedCovariance> PoseCovariances(const MapResult& result) {
  std::vector<StampedCovariance> covariances;
  const std::vector<int> position_first = {3, 4, 5, 0, 1, 2};
  for (const int64_t time_ns : result.scan_times_ns) {
    const Matrix6d covariance =
        result.batch.covariance.PoseAt(result.state.trajectory, time_ns);
    covariances.push_back({time_ns, covariance(position_first, position_first)});
  }
  return covariances;
}

void WriteWindow(const MapResult& result, ResultWriter* writer) {
  std::vector<StampedPose> poses;
  std::vector<StampedCovariance> covariances;
  const std::vector<int> position_first = {3, 4, 5, 0, 1, 2};
  for (const WindowEstimate& estimate : result.window_estimates) {
    poses.push_back(estimate.newest_pose);
    covariances.push_back({estimate.newest_pose.time_ns,
                           estimate.pose_covariance(position_first, position_first)});
  }
  writer->WriteWindow(poses, covariances, result.window_planes);
}

std::vector<std::pair<std::string, double>> NamedStddevs(const MotionNoise& noise,
                                                         bool planar) {
  std::vector<std::pair<std::string, double>> named;
  named.emplace_back("horizontal_m_s2", noise.horizontal_m_s2);
  if (!planar) named.emplace_back("vertical_m_s2", noise.vertical_m_s2);
  named.emplace_back("angular_deg_s2", noise.angular_rad_s2 * 180.0 / M_PI);
  return named;
}

std::string PlaneName(int id) { return "plane " + std::to_string(id); }

// What the covariance says of how well the unknowns are determined.
void Describe(const MapResult& result, const PlaneCovariance& planes, Summary* summary) {
  constexpr size_t kNumCorrelations = 5;
  for (const auto& correlation : planes.LargestCorrelations(kNumCorrelations)) {
    const auto name = [](bool angle) { return angle ? "angle of " : "distance of "; };
    summary->largest_correlations.emplace_back(
        name(correlation.angle_a) + PlaneName(correlation.plane_a) + " with " +
            name(correlation.angle_b) + PlaneName(correlation.plane_b),
        correlation.value);
  }
  const Trajectory& trajectory = result.state.trajectory;
  for (const WeakDirection& weak : result.batch.covariance.weak_directions()) {
    std::string what = PlaneName(weak.block.index);
    if (weak.block.kind != BlockId::Kind::kLandmark) {
      // A control point acts most in the middle of the four intervals it reaches.
      const double since_start_s =
          SecondsBetween(result.state.origin_time_ns, trajectory.start_ns()) +
          (weak.block.index - 1) * trajectory.knot_interval_s();
      what = (weak.block.kind == BlockId::Kind::kRotation ? "rotation" : "position") +
             (" near " + FormatSeconds(since_start_s) + " after the start of the map");
    }
    summary->weakest_directions.emplace_back(what, weak.eigenvalue);
  }
}

// On the threads of the caller's arena.
Summary Run(const MapJob& job, const ProgressCallback& progress) {
  Stopwatch total_watch;
  Stopwatch reading_watch;
  Stopwatch writing_watch;
  Summary summary;
  auto total = std::make_unique<Stopwatch::Running>(&total_watch);
  const Rig rig = ReadRig(job.rig);
  const MapperOptions options =
      job.config.empty() ? MapperOptions() : ReadMapperOptions(job.config);
  auto reading = std::make_unique<Stopwatch::Running>(&reading_watch);
  RecordingReader recording(job.recording, rig);
  reading.reset();
  LOG(INFO) << job.recording << ": " << recording.num_scan_lines() << " scan lines, "
            << SecondsBetween(recording.start_ns(), recording.end_ns()) << " s";
  for (const std::string& warning : recording.warnings()) LOG(WARNING) << warning;

  MapResult result = MapRecording(
      rig, options, [&](double share) { progress(kMappingShare * share); }, &recording);
  for (const std::string& warning : result.warnings) LOG(WARNING) << warning;

  auto writing = std::make_unique<Stopwatch::Running>(&writing_watch);
  ResultWriter writer(job.output);
  const std::vector<PlanePatch> planes = PlanePatches(result.state);
  writer.WriteTrajectory(Poses(result));
  writer.WritePlanes(planes);
  const PlaneCovariance covariance(planes, result.batch.covariance.landmarks());
  writer.WriteTrajectoryCovariance(PoseCovariances(result));
  writer.WritePlaneCovariance(covariance);
  if (!result.window_estimates.empty()) WriteWindow(result, &writer);
  const PointReport points = ExportPoints(
      rig,
      result.state,
      [&](double share) { progress(kMappingShare + (1.0 - kMappingShare) * share); },
      &recording,
      &writer);
  for (const std::string& warning : points.warnings) LOG(WARNING) << warning;
  writer.WriteConfig(MapperOptionsToYaml(options));
  writing.reset();
  total.reset();

  summary.scans = static_cast<int>(result.scan_times_ns.size());
  summary.points = points.num_points;
  summary.points_used = points.num_used;
  summary.residual_rms_m = points.residual_rms_m;
  summary.segments = static_cast<int>(std::count_if(
      result.state.observations.begin(),
      result.state.observations.end(),
      [](const Observation& observation) { return observation.landmark_id >= 0; }));
  summary.planes = static_cast<int>(planes.size());
  summary.control_points = result.state.trajectory.num_control_points();
  summary.variance_factor = result.batch.variance_factor;
  summary.duration_s = SecondsBetween(recording.start_ns(), recording.end_ns());
  summary.stages.emplace_back("reading", reading_watch.seconds());
  summary.stages.insert(summary.stages.end(), result.stages.begin(), result.stages.end());
  summary.stages.emplace_back("writing", writing_watch.seconds());
  summary.stages.emplace_back("total", total_watch.seconds());
  summary.real_time_factor = summary.duration_s / total_watch.seconds();
  Describe(result, covariance, &summary);
  summary.motion = result.planar ? "planar" : "spatial";
  summary.motion_noise = NamedStddevs(result.batch.motion_noise, result.planar);
  summary.reference_plane_id = 0;
  std::vector<std::string> warnings = recording.warnings();
  warnings.insert(warnings.end(), result.warnings.begin(), result.warnings.end());
  warnings.insert(warnings.end(), points.warnings.begin(), points.warnings.end());
  summary.warnings = std::move(warnings);
  summary.peak_memory_mb = PeakMemoryMb();
  writer.WriteSummary(summary);
  writer.Commit();
  return summary;
}

}  // namespace

Summary RunMapJob(const MapJob& job, const ProgressCallback& progress) {
  tbb::task_arena arena(job.threads > 0 ? job.threads : tbb::task_arena::automatic);
  return arena.execute([&] { return Run(job, progress); });
}

}  // namespace plumbline
