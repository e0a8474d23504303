#include "core/mapping/map_job.h"

#include <glog/logging.h>
#include <sys/resource.h>
#include <tbb/task_arena.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <system_error>
#include <utility>

#include "core/association/range_noise.h"
#include "core/batch/part_poses.h"
#include "core/estimation/block_layout.h"
#include "core/following/checkpoint.h"
#include "core/geometry/matrix_types.h"
#include "core/judging/consistency.h"
#include "core/map/calibration_report.h"
#include "core/map/imu_report.h"
#include "core/mapping/checked_recording.h"
#include "core/mapping/point_exporter.h"
#include "core/options/config.h"
#include "core/outputs/floor_plan_files.h"
#include "core/outputs/report.h"
#include "core/result/plane_covariance.h"
#include "core/result/result_directory.h"
#include "core/result/result_files.h"
#include "core/result/result_writer.h"
#include "core/surface/plane_patches.h"
#include "core/trajectory/motion_noise.h"
#include "core/util/atomic_file.h"
#include "core/util/error.h"
#include "core/util/stopwatch.h"

namespace plumbline {
namespace {

constexpr double kMappingShare = 0.92;  // of the time, roughly; the rest is writing

double RecordingLength(const RecordingReader& recording) {
  return SecondsBetween(recording.start_ns(), recording.end_ns());
}

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

// The first position is the map's origin: held, not measured.
void HoldOrigin(std::vector<StampedCovariance>* covariances) {
  if (covariances->empty()) return;
  covariances->front().covariance.topRows<3>().setZero();
  covariances->front().covariance.leftCols<3>().setZero();
}

std::vector<StampedCovariance> PoseCovariances(const MapResult& result) {
  std::vector<StampedCovariance> covariances;
  const std::vector<int> position_first = {3, 4, 5, 0, 1, 2};
  for (const int64_t time_ns : result.scan_times_ns) {
    const Matrix6d covariance =
        result.batch.covariance.PoseAt(result.state.trajectory, time_ns);
    covariances.push_back({time_ns, covariance(position_first, position_first)});
  }
  HoldOrigin(&covariances);
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

std::vector<std::pair<std::string, double>> NamedDensities(const MotionNoise& noise,
                                                           bool planar) {
  std::vector<std::pair<std::string, double>> named;
  named.emplace_back("horizontal_m_s2_rthz", noise.density[kHorizontal]);
  if (!planar) named.emplace_back("vertical_m_s2_rthz", noise.density[kVertical]);
  if (!planar) named.emplace_back("tilt_deg_s2_rthz", noise.density[kTilt] * 180.0 / M_PI);
  named.emplace_back("yaw_deg_s2_rthz", noise.density[kYaw] * 180.0 / M_PI);
  return named;
}

std::string PlaneName(int id) { return "plane " + std::to_string(id); }

// Adds to the summary how well the covariance shows the unknowns to be determined.
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
    if (IsImu(weak.block) || IsBias(weak.block)) {
      what = "the IMU";
    } else if (weak.block.kind != BlockId::Kind::kLandmark) {
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

// The summary of a map, without its times.
Summary Summarise(const RecordingReader& recording,
                  const MapResult& result,
                  const PointReport& points,
                  const PlaneCovariance& covariance) {
  Summary summary;
  summary.start_time_ns = recording.start_ns();
  summary.scans = static_cast<int>(result.scan_times_ns.size());
  summary.points = points.num_points;
  summary.points_used = points.num_used;
  summary.points_moving = points.num_moving;
  summary.residual_rms_m = points.residual_rms_m;
  summary.segments = static_cast<int>(std::count_if(
      result.state.observations.begin(),
      result.state.observations.end(),
      [](const Observation& observation) { return observation.landmark_id >= 0; }));
  summary.control_points = result.state.trajectory.num_control_points();
  summary.variance_factor = result.batch.variance_factor;
  summary.duration_s = RecordingLength(recording);
  Describe(result, covariance, &summary);
  summary.motion = result.planar ? "planar" : "spatial";
  summary.motion_noise = NamedDensities(result.batch.motion_noise, result.planar);
  if (result.state.odometry != nullptr) {
    const OdometryCalibration& wheels = result.state.odometry_calibration;
    summary.odometry = OdometrySummary{wheels.length_scale(),
                                       wheels.length_scale_stddev(),
                                       wheels.turn_scale(),
                                       wheels.turn_scale_stddev(),
                                       wheels.length_noise(),
                                       wheels.turn_noise(),
                                       wheels.num_motions()};
  }
  summary.reference_plane_id = 0;
  for (const MapGap& gap : result.state.gaps) {
    summary.gaps.push_back({SecondsBetween(recording.start_ns(), gap.start_ns),
                            SecondsBetween(recording.start_ns(), gap.end_ns),
                            gap.reason});
  }
  for (const auto* warnings : {&recording.warnings(), &result.warnings, &points.warnings}) {
    summary.warnings.insert(summary.warnings.end(), warnings->begin(), warnings->end());
  }
  return summary;
}

void LogWarnings(const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings) LOG(WARNING) << warning;
}

// The largest standard deviation over all directions.
double LargestStddev(const Eigen::Matrix3d& covariance) {
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(covariance, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, solver.eigenvalues()[2]));
}

// That of the position, by second since start_ns. A turn of the whole map, which the reference
// wall's direction leaves, is no doubt about the map: the position counts in the model frame
// or in the turned map, where it is known better.
std::vector<double> PositionStddevs(const MapResult& result, int64_t start_ns) {
  const MapCovariance& covariance = result.batch.covariance;
  const Trajectory& trajectory = result.state.trajectory;
  std::vector<double> stddevs_m;
  for (const int64_t time_ns : result.scan_times_ns) {
    const auto second = static_cast<size_t>(std::max(0.0, SecondsBetween(start_ns, time_ns)));
    if (second < stddevs_m.size()) continue;
    const Matrix6d in_frame = covariance.PoseAt(trajectory, time_ns);
    stddevs_m.resize(second, 0.0);
    stddevs_m.push_back(
        std::min(LargestStddev(in_frame.bottomRightCorner<3, 3>()),
                 LargestStddev(covariance.PositionInTurnedMap(trajectory, time_ns))));
  }
  return stddevs_m;
}

// Judges the map, for its summary.
void Judge(const Rig& rig,
           const MapResult& result,
           const PointReport& points,
           const RecordingReader& recording,
           Summary* summary) {
  const int first_second = FirstSecond(result.state, recording.start_ns());
  const int64_t map_start_ns = recording.start_ns() + NanosecondsFromSeconds(first_second);
  const FinishedMap map = {result.planar,
                           result.state,
                           result.batch.variance_factor,
                           first_second,
                           PositionStddevs(result, map_start_ns)};
  const ConsistencyReport report =
      JudgeConsistency(rig, map, points.activity, recording.start_ns());
  LogWarnings(report.warnings);
  summary->consistency = report.consistency;
  summary->cause = report.cause;
  if (!result.ended_by.empty()) summary->consistency.ends_at_s = result.end_s;
  summary->warnings.insert(
      summary->warnings.end(), report.warnings.begin(), report.warnings.end());
}

// Writes all files but the summary, which is returned without times.
Summary WriteResult(const Rig& rig,
                    const MapperOptions& options,
                    const MapResult& result,
                    const ProgressCallback& progress,
                    RecordingReader* recording,
                    ResultWriter* writer,
                    Stopwatch* judging_watch) {
  const std::vector<PlanePatch> planes = PlanePatches(result.state.landmarks);
  const PlaneCovariance covariance =
      StatedCovariance(result.state.landmarks, planes, result.batch.covariance.landmarks());
  writer->WriteTrajectory(Poses(result));
  writer->WritePlanes(planes);
  writer->WriteTrajectoryCovariance(PoseCovariances(result));
  writer->WritePlaneCovariance(covariance);
  writer->WriteLoopClosures(result.batch.closures);
  if (!result.window_estimates.empty()) WriteWindow(result, writer);
  const PointReport points = ExportPoints(rig, result.state, progress, recording, writer);
  LogWarnings(points.warnings);
  writer->WriteConfig(MapperOptionsToYaml(options));
  Summary summary = Summarise(*recording, result, points, covariance);
  for (const Scanner& scanner : rig.scanners) summary.scanners.push_back(scanner.name);
  summary.range_noise = EstimateRangeNoise(rig, result.state);
  const Stopwatch::Running judging(judging_watch);
  Judge(rig, result, points, *recording, &summary);
  summary.planes = static_cast<int>(planes.size());
  return summary;
}

// Says where there is less space than a map is likely to take: in each format, its points are
// about six times as large as a recording that is not packed.
void LogFreeSpace(const ResultDirectory& output, const MapJob& job) {
  const uintmax_t bytes_per_recorded_byte = 6 * job.formats.size();
  std::error_code error;
  const uintmax_t recorded = std::filesystem::file_size(job.recording, error);
  const uintmax_t free = output.FreeSpace();
  if (error || free / bytes_per_recorded_byte >= recorded) return;
  LOG(WARNING) << job.output << ": only " << free / 1'000'000
               << " MB are free; the map may need "
               << recorded * bytes_per_recorded_byte / 1'000'000 << " MB";
}

MapperOptions OptionsOf(const MapJob& job, const Rig& rig) {
  MapperOptions defaults = MapperOptions::DefaultsFor(IsPlanar(rig));
  const auto read = [&] {
    return job.config.empty() ? defaults : ReadMapperOptions(job.config, defaults);
  };
  if (!IsPlanar(rig) || rig.odometry_topic.empty() || !read().odometry.enabled) return read();
  // Wheels hold the spline between scans, so that it can follow turns as short as one, and
  // show accelerations, whose densities are estimated as any rig's are: fixed ones are too
  // stiff for sharp turns.
  const double knot_interval_s = defaults.trajectory.knot_interval_s;
  defaults.trajectory = TrajectoryOptions();
  defaults.trajectory.knot_interval_s = knot_interval_s;
  defaults.trajectory.min_scans_per_knot = 1.0;
  return read();
}

// The times that a job takes.
struct JobWatches {
  Stopwatch total;
  Stopwatch reading;
  Stopwatch writing;  // the judging included
  Stopwatch judging;
};

// Writes all files but the summaries, which are returned without times.
std::vector<Summary> WriteParts(const Rig& rig,
                                const MapperOptions& options,
                                const std::vector<MapResult>& parts,
                                const ProgressCallback& progress,
                                RecordingReader* recording,
                                std::vector<std::unique_ptr<ResultWriter>>* writers,
                                Stopwatch* judging_watch) {
  std::vector<Summary> summaries;
  const auto num_parts = static_cast<double>(parts.size());
  for (size_t i = 0; i < parts.size(); ++i) {
    LogWarnings(parts[i].warnings);
    summaries.push_back(WriteResult(
        parts[i].state.calibration.Posed(rig),
        options,
        parts[i],
        [&](double share) {
          const double done = (static_cast<double>(i) + share) / num_parts;
          ProgressState state(kMappingShare + (1.0 - kMappingShare) * done);
          state.stage = "writing";
          state.recording_s = RecordingLength(*recording);
          progress(state);
        },
        recording,
        (*writers)[i].get(),
        judging_watch));
  }
  return summaries;
}

// Says where the other parts lie in the frame of the longest one, or why that is not known.
void PlaceParts(const Rig& rig,
                const std::vector<MapResult>& parts,
                size_t longest,
                Summary* summary) {
  const PartMatchingOptions options;
  if (parts.size() < 2) return;
  const MapState& longest_state = parts[longest].state;
  const PartView of_longest =
      ViewFromAbove(longest_state.calibration.Posed(rig), longest_state, options.spacing_m);
  for (size_t i = 0; i < parts.size(); ++i) {
    if (i == longest) continue;
    const PartMatch match = MatchParts(
        of_longest,
        ViewFromAbove(
            parts[i].state.calibration.Posed(rig), parts[i].state, options.spacing_m),
        options);
    PartSummary& part = summary->parts[i];
    if (match.pose) {
      const PartPose& pose = *match.pose;
      part.pose = {pose.a_from_b.heading * 180.0 / M_PI,
                   pose.a_from_b.position.x(),
                   pose.a_from_b.position.y(),
                   pose.length_m};
    } else {
      summary->warnings.push_back(
          "where " + part.folder +
          " lies in the frame of the longest part is not known: " + match.reason);
      LOG(WARNING) << summary->warnings.back();
    }
  }
}

// Adds times and memory to the summary of the longest part, the stages of the same name of all
// parts added up.
void AddTimes(const std::vector<MapResult>& parts,
              const JobWatches& watches,
              Summary* summary) {
  const size_t longest = LongestPart(parts);
  summary->stages.emplace_back("reading", watches.reading.seconds());
  const auto& stages = parts[longest].stages;
  summary->stages.insert(summary->stages.end(), stages.begin(), stages.end());
  for (size_t i = 0; i < parts.size(); ++i) {
    if (i != longest)
      summary->stages.insert(
          summary->stages.end(), parts[i].stages.begin(), parts[i].stages.end());
  }
  summary->stages.emplace_back("writing",
                               watches.writing.seconds() - watches.judging.seconds());
  summary->stages.emplace_back("judging", watches.judging.seconds());
  summary->stages.emplace_back("total", watches.total.seconds());
  summary->real_time_factor = summary->duration_s / watches.total.seconds();
  summary->peak_memory_mb = PeakMemoryMb();
}

ReportJob ReportOf(const ResultDirectory& output,
                   const std::string& name,
                   const std::string& part) {
  ReportJob report;
  report.result_directory = output.Folder(part);
  report.output = report.result_directory + "/report.html";
  report.title = ReportTitle(name) + (part.empty() ? "" : ", " + part);
  return report;
}

// Paths of the checkpoint of this run, and of a killed one that it continues.
CheckpointFiles Checkpoint(const MapJob& job,
                           const MapperOptions& options,
                           const ResultDirectory& output) {
  CheckpointFiles files;
  files.inputs = InputsOf(job.recording, job.rig, MapperOptionsToYaml(options));
  if (!job.resume) {
    files.write_to = output.CheckpointPath();
    files.after_s = job.checkpoint_after_s;
  } else if (output.HasCheckpoint()) {
    files.read_from = output.CheckpointPath();
    LOG(INFO) << "going on with what a killed run has followed";
  } else {
    throw Error(job.output +
                ": there is no killed run to resume, or it had not yet followed "
                "the recording, or in so short a time that nothing was kept");
  }
  return files;
}

// Throws Error where report or floor plan would lack what they are made from.
void CheckFormats(const MapJob& job) {
  const auto& formats = job.formats;
  if (!(job.report || job.floor_plan) ||
      std::find(formats.begin(), formats.end(), CloudFormat::kPly) != formats.end()) {
    return;
  }
  throw Error(job.output + ": a " + (job.report ? "report" : "floor plan") +
              " is made from map.ply, which is not among the formats");
}

// Adds the floor plan to a part's result, whose other files are whole. A map of which there is
// none is still a map.
void WriteFloorPlan(const MapJob& job,
                    const ResultDirectory& output,
                    const std::string& part) {
  FloorPlans plan;
  try {
    plan = MakeFloorPlan(ReadFloorPlanInput(output.Folder(part), job.rig));
  } catch (const Error& error) {
    LOG(WARNING) << output.FinalName(part) << ": " << error.what();
    return;
  }
  for (const PlanFile& file : FloorPlanFiles(plan)) {
    WriteWholeFile(output.Folder(part) + "/" + file.name,
                   file.content,
                   output.FinalName(part) + "/" + file.name);
  }
}

// Writes what was found of the scanners, where they were estimated, and adds it to the
// summary.
void WriteCalibration(const CheckedRecording& checked,
                      const MapResult& result,
                      const std::string& folder,
                      ResultWriter* writer,
                      Summary* summary) {
  const RigCalibration& calibration = result.state.calibration;
  if (calibration.scanners.empty() && !calibration.imu) return;
  summary->calibration = DescribeCalibration(
      checked.stated, checked.rig, calibration, result.batch.covariance.scanners());
  Rig calibrated = CalibratedRig(checked.rig, calibration);
  if (calibration.imu) {
    summary->calibration.imu = DescribeImu(result.state);
    calibrated.imu = ImuAsEstimated(*calibration.imu);
  }
  writer->WriteCalibration(summary->calibration);
  WriteRig(calibrated, folder + "/" + kRigCalibrated);
}

std::vector<PartSummary> ListParts(const std::vector<std::string>& folders,
                                   const std::vector<MapResult>& parts,
                                   const std::vector<Summary>& summaries) {
  std::vector<PartSummary> list;
  for (size_t i = 0; i < parts.size(); ++i) {
    list.push_back({folders[i].empty() ? "." : folders[i],
                    parts[i].start_s,
                    parts[i].end_s,
                    summaries[i].scans,
                    summaries[i].planes,
                    summaries[i].consistency.verdict,
                    {}});
  }
  return list;
}

// Runs the job on the threads of the caller's arena.
Summary Run(const MapJob& job, const ProgressCallback& progress) {
  JobWatches watches;
  auto total = std::make_unique<Stopwatch::Running>(&watches.total);
  CheckFormats(job);
  Rig rig_file = ReadRig(job.rig);
  CheckPoses(job.rig, rig_file);
  const MapperOptions options = OptionsOf(job, rig_file);
  // Before the work, so that an output that can not be written shows first.
  ResultDirectory output(job.output, job.resume);
  const CheckpointFiles checkpoint = Checkpoint(job, options, output);
  CheckedRecording checked =
      ReadChecked(job.recording, std::move(rig_file), job.force, &watches.reading);
  const Rig& rig = checked.rig;
  RecordingReader& recording = *checked.reader;
  LOG(INFO) << job.recording << ": " << recording.num_scan_lines() << " scan lines, "
            << RecordingLength(recording) << " s";
  LogWarnings(recording.warnings());
  LogWarnings(WarningsOf(checked.findings));
  LogFreeSpace(output, job);

  const std::vector<MapResult> parts = MapRecording(
      rig,
      options,
      [&](ProgressState state) {
        state.share_done *= kMappingShare;
        state.recording_s = RecordingLength(recording);
        progress(state);
      },
      &recording,
      job.stop,
      checkpoint);
  const size_t longest = LongestPart(parts);

  auto writing = std::make_unique<Stopwatch::Running>(&watches.writing);
  std::vector<std::string> folders;
  std::vector<std::unique_ptr<ResultWriter>> writers;
  for (size_t i = 0; i < parts.size(); ++i) {
    folders.push_back(i == longest ? "" : PartName(i + 1));
    writers.push_back(std::make_unique<ResultWriter>(output, folders.back(), job.formats));
  }
  std::vector<Summary> summaries =
      WriteParts(rig, options, parts, progress, &recording, &writers, &watches.judging);
  for (Summary& of_part : summaries) {
    AddFindings(checked.findings, &of_part);
    of_part.recording =
        std::filesystem::path(job.recording).lexically_normal().filename().string();
    of_part.version = job.version;
  }
  Summary& summary = summaries[longest];
  if (parts.size() > 1) summary.parts = ListParts(folders, parts, summaries);
  PlaceParts(rig, parts, longest, &summary);
  writing.reset();
  total.reset();
  AddTimes(parts, watches, &summary);
  for (size_t i = 0; i < parts.size(); ++i) {
    WriteCalibration(
        checked, parts[i], output.Folder(folders[i]), writers[i].get(), &summaries[i]);
    writers[i]->WriteSummary(summaries[i]);
    writers[i]->Finish();
    WriteRig(rig, output.Folder(folders[i]) + "/" + kRigUsed);
    if (job.floor_plan) WriteFloorPlan(job, output, folders[i]);
  }
  for (const std::string& folder : folders) {
    if (job.report) WriteReport(ReportOf(output, job.output, folder));
  }
  output.Commit();
  return summary;
}

}  // namespace

Summary RunMapJob(const MapJob& job, const ProgressCallback& progress) {
  tbb::task_arena arena(job.threads > 0 ? job.threads : tbb::task_arena::automatic);
  return arena.execute([&] { return Run(job, progress); });
}

}  // namespace plumbline
