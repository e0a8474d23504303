#include "core/map_job.h"

#include <glog/logging.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <optional>

#include "core/config.h"
#include "core/plane_covariance.h"
#include "core/result_writer.h"
#include "core/scan_reader.h"
#include "core/stopwatch.h"

namespace plumbline {
namespace {

// Peak resident memory of this process.
double PeakMemoryMb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

// Share of points on planes over time, to tell where the pose is doubtful: where the estimate
// went astray, segments no longer lie on the planes.
class SupportOverTime {
 public:
  void Add(double time_s, bool on_plane) {
    const auto bin = static_cast<size_t>(std::max(0.0, time_s) / kBinSeconds);
    if (bin >= bins_.size()) bins_.resize(bin + 1);
    ++bins_[bin].num_points;
    bins_[bin].num_on_planes += on_plane ? 1 : 0;
  }

  // One sentence for each stretch with less than half of the overall share.
  std::vector<std::string> Warnings() const {
    Bin total;
    for (const Bin& bin : bins_) {
      total.num_points += bin.num_points;
      total.num_on_planes += bin.num_on_planes;
    }
    std::vector<std::string> warnings;
    for (size_t i = 0; i < bins_.size(); ++i) {
      if (!IsDoubtful(bins_[i], total)) continue;
      const size_t first = i;
      while (i + 1 < bins_.size() && IsDoubtful(bins_[i + 1], total)) ++i;
      char text[160];
      std::snprintf(
          text,
          sizeof(text),
          "from %.2f to %.2f s less than half as many points as usual lie on planes: "
          "the pose is doubtful there",
          static_cast<double>(first) * kBinSeconds,
          static_cast<double>(i + 1) * kBinSeconds);
      warnings.emplace_back(text);
    }
    return warnings;
  }

 private:
  static constexpr double kBinSeconds = 0.25;
  struct Bin {
    int64_t num_points = 0;
    int64_t num_on_planes = 0;
  };

  static bool IsDoubtful(const Bin& bin, const Bin& total) {
    return 2 * bin.num_on_planes * total.num_points < bin.num_points * total.num_on_planes;
  }

  std::vector<Bin> bins_;
};

// Second pass over the recording: places every valid point, so that none had to be kept.
class PointExporter {
 public:
  PointExporter(const Rig& rig, const MapState& state, ResultWriter* writer)
      : rig_(rig), state_(state), writer_(writer), sampler_(state.trajectory) {
    for (const Landmark& landmark : state.landmarks) planes_.emplace_back(landmark);
  }

  void Run(const ProgressCallback& progress, RecordingReader* recording, Summary* summary) {
    recording->Rewind();
    ScanLine scan_line;
    size_t next_observation = 0;
    size_t next_run = 0;
    const int num_scan_lines = recording->num_scan_lines();
    for (int index = 0; recording->Next(&scan_line); ++index) {
      if (index % 256 == 0) progress("writing", static_cast<double>(index) / num_scan_lines);
      const auto& observations = state_.observations;
      const size_t first = next_observation;
      while (next_observation < observations.size() &&
             observations[next_observation].scan_line_index == index) {
        ++next_observation;
      }
      plane_of_beam_.assign(scan_line.ranges.size(), nullptr);
      for (size_t i = first; i < next_observation; ++i) Assign(observations[i]);
      for (; next_run < state_.short_runs.size() &&
             state_.short_runs[next_run].scan_line_index == index;
           ++next_run) {
        Assign(state_.short_runs[next_run]);
      }
      Place(scan_line, recording->start_ns());
    }
    CHECK_EQ(next_observation, state_.observations.size()) << "observations out of order";
    for (const std::string& warning : support_.Warnings()) {
      LOG(WARNING) << warning;
      summary->warnings.push_back(warning);
    }
    summary->points = num_points_;
    summary->points_used = num_used_;
    summary->residual_rms_m =
        num_used_ > 0 ? std::sqrt(sum_squares_ / static_cast<double>(num_used_)) : 0.0;
  }

 private:
  // Notes the plane of an observation's beams.
  void Assign(const Observation& observation) {
    if (observation.landmark_id < 0) return;
    const LandmarkCandidate* plane = &planes_[static_cast<size_t>(observation.landmark_id)];
    for (int beam = observation.first_beam; beam <= observation.last_beam; ++beam) {
      plane_of_beam_[static_cast<size_t>(beam)] = plane;
    }
    for (const int beam : observation.excluded_beams) {
      plane_of_beam_[static_cast<size_t>(beam)] = nullptr;
    }
  }

  void Place(const ScanLine& scan_line, int64_t start_ns) {
    const Scanner& scanner = rig_.scanners[static_cast<size_t>(scan_line.scanner_index)];
    const int64_t map_start_ns = state_.trajectory.start_ns();
    const int64_t map_end_ns = state_.trajectory.end_ns();
    int64_t span_end_ns = std::numeric_limits<int64_t>::min();
    std::optional<ScanMotion> motion;
    for (int beam = 0; beam < scan_line.num_beams(); ++beam) {
      const double range = scan_line.ranges[static_cast<size_t>(beam)];
      if (!scanner.IsValidRange(range)) continue;
      ++num_points_;
      const int64_t time_ns = BeamInstant(scan_line, beam, rig_);
      if (time_ns < map_start_ns || time_ns >= map_end_ns) continue;
      if (time_ns > span_end_ns) {
        const int last = scan_line.num_beams() - 1;
        span_end_ns = std::min(
            {BeamInstant(scan_line, last, rig_), time_ns + kMaxSpanNs, map_end_ns - 1});
        motion = ObservationPoses(
                     NodesOfSpan(time_ns, span_end_ns), scanner.body_from_scanner, &sampler_)
                     .motion;
      }
      const Eigen::Vector3d p_world =
          motion->ToWorld(range * scan_line.BeamDirection(beam), time_ns);
      MapPoint point;
      point.p_world = p_world.cast<float>();
      point.time_s = SecondsBetween(start_ns, time_ns);
      point.scanner = scan_line.scanner_index;
      point.residual_m = std::numeric_limits<float>::quiet_NaN();
      if (const LandmarkCandidate* plane = plane_of_beam_[static_cast<size_t>(beam)]) {
        const double residual = plane->SignedDistance(p_world);
        ++num_used_;
        sum_squares_ += residual * residual;
        point.plane_id = plane->landmark->id;
        point.residual_m = static_cast<float>(residual);
      }
      support_.Add(point.time_s, point.plane_id >= 0);
      writer_->AddMapPoint(point);
    }
  }

  // Points in such a span are placed by the quadratic through three poses, to better than
  // float's resolution.
  static constexpr int64_t kMaxSpanNs = 25'000'000;

  const Rig& rig_;
  const MapState& state_;
  ResultWriter* writer_;
  PoseSampler sampler_;
  std::vector<LandmarkCandidate> planes_;  // by landmark id
  std::vector<const LandmarkCandidate*> plane_of_beam_;
  SupportOverTime support_;
  int64_t num_points_ = 0;
  int64_t num_used_ = 0;
  double sum_squares_ = 0.0;
};

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
  for (const WindowStatement& statement : result.window_statements) {
    poses.push_back(statement.newest_pose);
    covariances.push_back({statement.newest_pose.time_ns,
                           statement.pose_covariance(position_first, position_first)});
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

}  // namespace

Summary RunMapJob(const MapJob& job, const ProgressCallback& progress) {
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

  MapResult result = MapRecording(rig, options, job.threads, progress, &recording);
  for (const std::string& warning : result.warnings) LOG(WARNING) << warning;

  auto writing = std::make_unique<Stopwatch::Running>(&writing_watch);
  ResultWriter writer(job.output);
  const std::vector<PlanePatch> planes = PlanePatches(result.state);
  writer.WriteTrajectory(Poses(result));
  writer.WritePlanes(planes);
  const PlaneCovariance covariance(planes, result.batch.covariance.landmarks());
  writer.WriteTrajectoryCovariance(PoseCovariances(result));
  writer.WritePlaneCovariance(covariance);
  if (!result.window_statements.empty()) WriteWindow(result, &writer);
  PointExporter(rig, result.state, &writer).Run(progress, &recording, &summary);
  writer.WriteConfig(MapperOptionsToYaml(options));
  writing.reset();
  total.reset();

  summary.scans = static_cast<int>(result.scan_times_ns.size());
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
  summary.motion_found = NamedStddevs(result.batch.motion_found, result.planar);
  summary.reference_plane_id = 0;
  std::vector<std::string> warnings = recording.warnings();
  warnings.insert(warnings.end(), result.warnings.begin(), result.warnings.end());
  warnings.insert(warnings.end(), summary.warnings.begin(), summary.warnings.end());
  summary.warnings = std::move(warnings);
  summary.peak_memory_mb = PeakMemoryMb();
  writer.WriteSummary(summary);
  writer.Commit();
  return summary;
}

}  // namespace plumbline
