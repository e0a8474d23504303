#include <benchmark/benchmark.h>
#include <glog/logging.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/estimation/estimation_problem.h"
#include "core/estimation/gauss_newton_solver.h"
#include "core/estimation/map_covariance.h"
#include "core/estimation/segment_groups.h"
#include "core/result/point_cloud_writer.h"
#include "core/sensor/beam_instant.h"
#include "core/sensor/recording.h"
#include "core/sensor/scan_reader.h"
#include "core/surface/plane_patches.h"
#include "core/util/stopwatch.h"
#include "core/window/window.h"
#include "test/benchmark/mapped_walk.h"

namespace plumbline {
namespace {

// The time of one element of what an iteration processes.
benchmark::Counter PerElement(size_t num_elements) {
  return benchmark::Counter(
      static_cast<double>(num_elements),
      benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

std::vector<const Observation*> Associated(const MapState& state) {
  std::vector<const Observation*> associated;
  for (const Observation& observation : state.observations) {
    if (observation.landmark_id >= 0) associated.push_back(&observation);
  }
  return associated;
}

// Value, gradient and Gauss-Newton matrix of the segments of one knot interval.
void SegmentGroupWithJacobian(benchmark::State& state, const std::string& walk_name) {
  const MappedWalk& walk = WalkByName(walk_name);
  const MapState& map = walk.result().state;
  SegmentGroupCache cache(LinearisedGroup::kFine, 1);
  const std::vector<const SegmentGroupCache::Entry*> groups =
      cache.Update(walk.rig(), nullptr, map.trajectory, map.landmarks, Associated(map), {});
  CHECK_GT(groups.size(), 2u);
  const SegmentGroupCache::Entry& entry = *groups[groups.size() / 2];
  const SegmentGroup& group = entry.group->group();
  std::vector<const double*> parameters;
  for (const bool rotation : {true, false}) {
    for (int j = 0; j < group.num_control_points(); ++j) {
      const ControlPoint& point = map.trajectory.control_point(entry.first_control_point + j);
      parameters.push_back(rotation ? point.rotation.data() : point.position.data());
    }
  }
  for (const int id : entry.landmark_ids) {
    parameters.push_back(map.landmarks[static_cast<size_t>(id)].parameters.data());
  }
  size_t num_segments = 0;
  for (const Observation* observation : Associated(map)) {
    const int first = map.trajectory.Locate(observation->measurement.node_times_ns()[0]).first;
    if (first == entry.first_control_point) ++num_segments;
  }
  SegmentGroup::Quadratic quadratic;
  for (auto _ : state) {
    group.Linearise(parameters.data(), &quadratic);
    benchmark::ClobberMemory();
  }
  state.counters["segments"] = static_cast<double>(num_segments);
  state.counters["per_segment"] = PerElement(num_segments);
}
BENCHMARK_CAPTURE(SegmentGroupWithJacobian, corridor, "corridor");
BENCHMARK_CAPTURE(SegmentGroupWithJacobian, office, "office");

// Gives a window the mapped segments again, knot interval by knot interval.
class WindowReplay {
 public:
  explicit WindowReplay(const MappedWalk& walk) : walk_(walk) { Restart(); }

  // Makes the next step ready; begins again at the end.
  void Advance() {
    const Trajectory& mapped = walk_.result().state.trajectory;
    if (now_ns_ + mapped.knot_interval_ns() >= mapped.end_ns()) Restart();
    now_ns_ += mapped.knot_interval_ns();
    TakeControlPoints();
    while (next_observation_ < state_->observations.size() &&
           state_->observations[next_observation_].end_time_ns() <= now_ns_) {
      if (state_->observations[next_observation_].landmark_id >= 0) {
        window_->Add(static_cast<int>(next_observation_));
      }
      ++next_observation_;
    }
  }

  void Solve() {
    window_->Solve(now_ns_, walk_.options().window.num_scans * walk_.scan_period_s());
  }

 private:
  void Restart() {
    const MapState& mapped = walk_.result().state;
    const Trajectory start(mapped.trajectory.start_ns(),
                           mapped.trajectory.knot_interval_ns(),
                           mapped.trajectory.WorldFromBody(mapped.origin_time_ns));
    state_ = std::make_unique<MapState>(
        MapState{start, mapped.landmarks, mapped.observations, mapped.origin_time_ns, {}});
    window_ = std::make_unique<Window>(
        walk_.rig(), walk_.result().planar, walk_.options(), &motion_prior_, state_.get());
    now_ns_ = mapped.origin_time_ns;
    next_observation_ = 0;
  }

  // The new control points where the map has them, in place of a prediction.
  void TakeControlPoints() {
    Trajectory& trajectory = state_->trajectory;
    const int known = next_observation_ == 0 ? 0 : trajectory.num_control_points();
    trajectory.ExtendTo(now_ns_);
    for (int i = known; i < trajectory.num_control_points(); ++i) {
      trajectory.control_point(i) = walk_.result().state.trajectory.control_point(i);
    }
  }

  const MappedWalk& walk_;
  MotionPrior motion_prior_{walk_.options().trajectory};
  std::unique_ptr<MapState> state_;
  std::unique_ptr<Window> window_;
  int64_t now_ns_ = 0;
  size_t next_observation_ = 0;
};

// The window's estimation and marginalisation, once per knot interval.
void WindowStep(benchmark::State& state, const std::string& walk_name) {
  WindowReplay replay(WalkByName(walk_name));
  for (auto _ : state) {
    state.PauseTiming();
    replay.Advance();
    state.ResumeTiming();
    replay.Solve();
  }
}
BENCHMARK_CAPTURE(WindowStep, corridor, "corridor")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(WindowStep, office, "office")->Unit(benchmark::kMillisecond);

// One iteration of the batch: normal equations, their solution and the cost where it leads to.
void TimeBatchIteration(benchmark::State& state, const MappedWalk& walk, FactorKind factor) {
  MapState map = walk.result().state;
  const auto problem = walk.BatchProblem(factor, &map);
  for (auto _ : state) {
    // Away from the solution, where the group factors would still know their last result.
    for (int i = 0; i < map.trajectory.num_control_points(); ++i) {
      map.trajectory.control_point(i) = walk.result().state.trajectory.control_point(i);
      map.trajectory.control_point(i).position[0] += 1e-3;
    }
    Stopwatch watch;
    {
      const Stopwatch::Running running(&watch);
      GaussNewtonSolver<ArrowheadEquations>({1, 0.0, 0.0}).Solve(problem.get());
    }
    state.SetIterationTime(watch.seconds());
  }
  const double duration_s =
      SecondsBetween(walk.result().scan_times_ns.front(), walk.result().scan_times_ns.back());
  state.counters["recording_s"] = duration_s;
  state.counters["planes"] = static_cast<double>(PlanePatches(map.landmarks).size());
}

void BatchIteration(benchmark::State& state, const std::string& walk_name) {
  TimeBatchIteration(state, WalkByName(walk_name), FactorKind::kSegment);
}
BENCHMARK_CAPTURE(BatchIteration, corridor, "corridor")
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(BatchIteration, office, "office")
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

// The same walk both ways.
void BatchIterationByFactor(benchmark::State& state, FactorKind factor) {
  TimeBatchIteration(state, WalkWithSinglePoints(), factor);
}
BENCHMARK_CAPTURE(BatchIterationByFactor, segment, FactorKind::kSegment)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(BatchIterationByFactor, point, FactorKind::kPoint)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

void Covariance(benchmark::State& state, const std::string& walk_name) {
  const MappedWalk& walk = WalkByName(walk_name);
  MapState map = walk.result().state;
  const auto problem = walk.BatchProblem(FactorKind::kSegment, &map);
  for (auto _ : state) benchmark::DoNotOptimize(MapCovariance::Of(*problem));
}
BENCHMARK_CAPTURE(Covariance, corridor, "corridor")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Covariance, office, "office")->Unit(benchmark::kMillisecond);

// Poses of the trajectory at the beams of a scan line, one after the other.
void PoseOfBeam(benchmark::State& state) {
  const MappedWalk& walk = CorridorWalk();
  RecordingReader reader(walk.recording(), walk.rig());
  ScanLine scan_line;
  for (int i = 0; i < reader.num_scan_lines() / 2; ++i) CHECK(reader.Next(&scan_line));
  std::vector<int64_t> times_ns;
  for (int beam = 0; beam < scan_line.num_beams(); ++beam) {
    times_ns.push_back(BeamInstant(scan_line, beam, walk.rig()));
  }
  const Trajectory& trajectory = walk.result().state.trajectory;
  for (auto _ : state) {
    for (const int64_t time_ns : times_ns) {
      benchmark::DoNotOptimize(trajectory.WorldFromBody(time_ns));
    }
  }
  state.counters["per_pose"] = PerElement(times_ns.size());
}
BENCHMARK(PoseOfBeam);

void ReadRecording(benchmark::State& state) {
  const MappedWalk& walk = CorridorWalk();
  RecordingReader reader(walk.recording(), walk.rig());
  ScanLine scan_line;
  for (auto _ : state) {
    reader.Rewind();
    while (reader.Next(&scan_line)) benchmark::DoNotOptimize(scan_line);
  }
  state.counters["per_scan_line"] = PerElement(static_cast<size_t>(reader.num_scan_lines()));
}
BENCHMARK(ReadRecording)->Unit(benchmark::kMillisecond);

// Both point clouds of a map.
void ExportPoints(benchmark::State& state) {
  constexpr size_t kNumPoints = 100000;
  constexpr size_t kPointsAtOnce = 5000;
  const std::filesystem::path path =
      std::filesystem::path(CorridorWalk().recording()).parent_path();
  MapPoint point;
  point.p_world = Eigen::Vector3f(1.0f, 2.0f, 3.0f);
  PointBuffer points;
  for (auto _ : state) {
    std::vector<std::unique_ptr<PointCloudWriter>> writers;
    for (const CloudFormat format : ParseCloudFormats(kDefaultCloudFormats)) {
      const std::string file = (path / CloudFileName(format)).string();
      writers.push_back(CreatePointCloudWriter(format, file, file));
    }
    for (size_t i = 0; i < kNumPoints; ++i) {
      point.time_s = 1e-4 * static_cast<double>(i);
      points.Add(point);
      if ((i + 1) % kPointsAtOnce > 0) continue;
      for (const auto& writer : writers) writer->Add(points);
      points.Clear();
    }
    for (const auto& writer : writers) writer->Finish();
  }
  state.counters["per_point"] = PerElement(kNumPoints);
}
BENCHMARK(ExportPoints)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace plumbline
