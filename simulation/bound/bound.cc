#include "simulation/bound/bound.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <utility>

#include "core/association/association.h"
#include "core/estimation/ceres_solver.h"
#include "core/estimation/estimation_problem.h"
#include "core/estimation/imu_terms.h"
#include "core/estimation/map_covariance.h"
#include "core/estimation/pose_prior.h"
#include "core/geometry/angles.h"
#include "core/geometry/matrix_types.h"
#include "core/map/calibration_report.h"
#include "core/map/imu_report.h"
#include "core/map/map_state.h"
#include "core/result/calibration_text.h"
#include "core/result/result_text.h"
#include "core/sensor/beam_instant.h"
#include "core/sensor/scan_reader.h"
#include "core/surface/plane_patches.h"
#include "core/trajectory/motion_noise.h"
#include "core/util/atomic_file.h"
#include "core/util/error.h"
#include "simulation/sensing/simulator.h"

namespace plumbline {
namespace {

// The experiment with mounts as the rig file states them.
Experiment WithExactMounts(Experiment experiment) {
  experiment.mounts.errors = experiment.mounts.jitter_rad = experiment.mounts.backlash_rad =
      0.0;
  return experiment;
}

// Whether two faces are parts of one plane, or of one cylinder.
bool AreOneSurface(const Face& a, const Face& b) {
  if (a.curvature == 0.0 || b.curvature == 0.0) {
    return a.curvature == b.curvature && (a.normal - b.normal).norm() < kSamePlane &&
           std::abs(a.distance - b.distance) < kSamePlane;
  }
  const auto axis_of = [](const Face& face) -> Eigen::Vector2d {
    return (face.middle - face.normal / face.curvature).head<2>();
  };
  return std::abs(a.curvature - b.curvature) < kSamePlane &&
         (axis_of(a) - axis_of(b)).norm() < kSamePlane;
}

// Faces that are one plane get the same number.
std::vector<int> PlaneOfFace(const Building& building) {
  std::vector<int> plane_of;
  for (const Face& face : building.faces) {
    int plane = face.id;
    for (const Face& other : building.faces) {
      if (other.id >= face.id) break;
      if (AreOneSurface(face, other)) {
        plane = plane_of[static_cast<size_t>(other.id)];
        break;
      }
    }
    plane_of.push_back(plane);
  }
  return plane_of;
}

// Consecutive beams on one plane, or on a short piece of an arc.
struct BeamRun {
  int plane = 0;  // a face's id
  Segment segment;
};

std::vector<BeamRun> FindRuns(const PerfectScanLine& perfect,
                              const ScanLine& scan_line,
                              const Building& building,
                              const std::vector<int>& plane_of_face) {
  constexpr double kMaxTurn = 0.25;  // rad, on an arc
  Eigen::Vector2d begin = Eigen::Vector2d::Zero();
  std::vector<BeamRun> runs;
  bool continues = false;
  for (int beam = 0; beam < scan_line.num_beams(); ++beam) {
    const auto index = static_cast<size_t>(beam);
    const std::optional<RayHit>& hit = perfect.beams[index];
    if (!hit || hit->face_id == kNoFace || !std::isfinite(scan_line.ranges[index])) {
      continues = false;
      continue;
    }
    const int plane = plane_of_face[static_cast<size_t>(hit->face_id)];
    const Eigen::Vector2d at = hit->range * scan_line.BeamDirection(beam);
    const double curvature =
        std::abs(building.faces[static_cast<size_t>(hit->face_id)].curvature);
    const bool turns_on = curvature * (at - begin).norm() > kMaxTurn;
    if (!continues || turns_on || runs.back().plane != plane) {
      begin = at;
      runs.emplace_back();
      runs.back().plane = plane;
      runs.back().segment.first_beam = beam;
      continues = true;
    }
    runs.back().segment.last_beam = beam;
    ++runs.back().segment.num_points;
  }
  return runs;
}

class BoundComputer {
 public:
  // seed: of the noise; errorless beams without one.
  BoundComputer(const Experiment& experiment,
                const MapperOptions& options,
                std::optional<uint64_t> seed)
      : experiment_(WithExactMounts(experiment)),
        options_(experiment.inertial && !IsPlanar(experiment.rig) ? WithoutMotionPrior(options)
                                                                  : options),
        seed_(seed),
        simulator_(experiment_),
        plane_of_face_(PlaneOfFace(experiment.building)),
        planar_(IsPlanar(experiment.rig)) {
    for (size_t i = 0; i < experiment_.rig.scanners.size(); ++i) {
      auto& mount = experiment_.rig.scanners[i].mount;
      if (!mount) continue;
      mount->start_ns = simulator_.first_line_ns();
      if (mount->IsRead()) mount->angles = simulator_.true_rig().scanners[i].mount->angles;
    }
    rig_ = experiment_.rig;
  }

  Bound Run(const ProgressCallback& progress) {
    int num_done = 0;
    simulator_.Run([&](const PerfectScanLine& perfect) {
      Take(perfect);
      ProgressState state(static_cast<double>(++num_done) / simulator_.num_scan_lines());
      state.recording_s =
          SecondsBetween(simulator_.path().start_ns(), simulator_.path().end_ns());
      progress(state);
    });
    if (seed_) Estimate();
    const auto problem = MakeProblem();
    const MapCovariance covariance = MapCovariance::Of(*problem);
    for (size_t i = 0; i < covariance.landmark_ids().size(); ++i) {
      const int offset = covariance.offsets()[i];
      const int size = covariance.offsets()[i + 1] - offset;
      state_->landmarks[static_cast<size_t>(covariance.landmark_ids()[i])]
          .covariance.topLeftCorner(size, size) =
          covariance.landmarks().block(offset, offset, size, size);
    }
    Bound bound;
    bound.calibration = DescribeCalibration(
        experiment_.rig, experiment_.rig, state_->calibration, covariance.scanners());
    if (state_->imu != nullptr) {
      SetCalibrationCovariance(*problem, covariance, &state_->calibration);
      bound.calibration.imu = DescribeImu(*state_);
    }
    bound.planes = StatedCovariance(
        state_->landmarks, PlanePatches(state_->landmarks), covariance.landmarks());
    for (const PlanePatch& plane : bound.planes.planes()) {
      bound.face_ids.push_back(face_of_landmark_[static_cast<size_t>(plane.id)]);
    }
    const std::vector<int> position_first = {3, 4, 5, 0, 1, 2};
    for (const int64_t time_ns : scan_times_ns_) {
      bound.trajectory.push_back({time_ns, state_->trajectory.WorldFromBody(time_ns)});
      const Matrix6d pose = covariance.PoseAt(state_->trajectory, time_ns);
      bound.poses.push_back({time_ns, pose(position_first, position_first)});
    }
    return bound;
  }

 private:
  // The beams that an observation was made from.
  struct Source {
    std::shared_ptr<const ScanLine> scan_line;
    Segment segment;
  };

  std::unique_ptr<EstimationProblem> MakeProblem() {
    auto problem = std::make_unique<EstimationProblem>(
        rig_, planar_, &state_->trajectory, &state_->landmarks, &state_->calibration);
    AddScannerPriors(state_->calibration, problem.get());
    problem->AddTrajectoryTerms(options_.trajectory, motion_noise_, state_->origin_time_ns);
    if (state_->imu != nullptr) {
      const int num_intervals = state_->trajectory.num_control_points() - kSplineOrder + 1;
      state_->calibration.imu->ExtendTo(num_intervals);
      AddImuPrior(*state_->calibration.imu, problem.get());
      AddImu(*state_, 0, num_intervals, 1, problem.get());
    }
    std::vector<const Observation*> observations;
    for (const Observation& observation : state_->observations) {
      Landmark& landmark = state_->landmarks[static_cast<size_t>(observation.landmark_id)];
      // Fewer beams than a segment needs may leave a plane open.
      if (landmark.num_points < options_.segmentation.min_points) {
        landmark.num_segments = 0;
        continue;
      }
      observations.push_back(&observation);
    }
    problem->AddSegments(observations, 0.0);
    return problem;
  }

  // Least squares with the true associations. Lever arms and weights follow the estimate.
  void Estimate() {
    constexpr int kRounds = 3;  // another one changes weights by less than they are known to
    const CeresSolver<ArrowheadEquations> solver({});
    for (int round = 0; round < kRounds; ++round) {
      Solve(solver);
      for (size_t i = 0; i < sources_.size(); ++i) {
        Observation& observation = state_->observations[i];
        Observation anew =
            Observe(*sources_[i].scan_line, sources_[i].segment, observation.landmark_id);
        anew.scan_index = observation.scan_index;
        observation = std::move(anew);
      }
    }
    Solve(solver);
  }

  void Solve(const CeresSolver<ArrowheadEquations>& solver) {
    solver.Solve(MakeProblem().get());
    state_->calibration.ApplyTo(&rig_);
  }

  Observation Observe(const ScanLine& scan_line, const Segment& segment, int landmark_id) {
    const Scanner& scanner = rig_.scanners[static_cast<size_t>(scan_line.scanner_index)];
    const Landmark& landmark = state_->landmarks[static_cast<size_t>(landmark_id)];
    const ScanMotion motion = MotionOf(scan_line, scanner, segment);
    // Single beams have no line of their own to be weighted by.
    Observation observation =
        landmark.IsCurved()
            ? MakeObservationOnArc(landmark, motion, scan_line, scanner, segment, false)
            : MakeObservationOn(motion.TraceOf(landmark.Normal(), landmark.Distance()),
                                scan_line,
                                scanner,
                                segment,
                                false);
    observation.landmark_id = landmark_id;
    return observation;
  }

  void Take(const PerfectScanLine& perfect) {
    NoiseOptions noise = experiment_.noise;
    if (!seed_) {
      noise.scale = 0.0;
      noise.dropout = 0.0;
    }
    const auto scanner_index = static_cast<size_t>(perfect.scan_line.scanner_index);
    const Scanner& scanner = experiment_.rig.scanners[scanner_index];
    const ScanLine scan_line = AddNoise(perfect, scanner, noise, seed_.value_or(0));
    std::vector<BeamRun> runs =
        FindRuns(perfect, scan_line, experiment_.building, plane_of_face_);
    if (!state_) {
      first_lines_.emplace_back(scan_line, runs);
      if (!Start()) return;
      for (auto& [line, its_runs] : first_lines_) Add(line, std::move(its_runs));
      first_lines_.clear();
      return;
    }
    Add(scan_line, std::move(runs));
  }

  // Sets the model frame by the wall that the scan lines so far see with most beams, once
  // every scanner has taken one.
  bool Start() {
    const int64_t first_ns = first_lines_.front().first.stamp_ns;
    const int64_t last_ns = first_lines_.back().first.stamp_ns;
    if (first_lines_.size() < experiment_.rig.scanners.size() && last_ns == first_ns) {
      return false;
    }
    std::map<int, int> num_beams;
    for (const auto& [line, runs] : first_lines_) {
      for (const BeamRun& run : runs) num_beams[run.plane] += run.segment.num_points;
    }
    int reference = -1;
    for (const auto& [plane, count] : num_beams) {
      if (FaceOf(plane).type != PlaneType::kVertical) continue;
      if (reference < 0 || count > num_beams.at(reference)) reference = plane;
    }
    if (reference < 0) throw Error("the first scan lines see no wall: no model frame");
    const Eigen::Vector3d& normal = FaceOf(reference).normal;
    const Eigen::Quaterniond heading(
        Eigen::AngleAxisd(-std::atan2(normal.y(), normal.x()), Eigen::Vector3d::UnitZ()));
    const Path& path = simulator_.path();
    model_from_world_ = {heading, -(heading * path.PoseAt(path.start_ns()).translation)};
    // The control points lie where the path is at the instant at which each counts most: close
    // enough to the true motion for derivatives.
    const double interval_s = std::max(options_.trajectory.knot_interval_s,
                                       options_.trajectory.min_scans_per_knot / MaxScanRate());
    const int64_t interval_ns = NanosecondsFromSeconds(interval_s);
    int64_t earliest_ns = path.start_ns();
    int64_t latest_ns = path.end_ns();
    for (const Scanner& scanner : experiment_.rig.scanners) {
      const int64_t offset_ns = NanosecondsFromSeconds(scanner.time_offset_s);
      earliest_ns = std::min(earliest_ns, path.start_ns() + offset_ns);
      latest_ns = std::max(latest_ns, path.end_ns() + offset_ns);
    }
    Trajectory trajectory(earliest_ns, interval_ns, Rigid3d());
    trajectory.ExtendTo(latest_ns);
    for (int i = 0; i < trajectory.num_control_points(); ++i) {
      const Rigid3d pose =
          model_from_world_ * PathPose(trajectory.start_ns() + (i - 1) * interval_ns);
      ControlPoint& control_point = trajectory.control_point(i);
      Eigen::Map<Eigen::Quaterniond>(control_point.rotation.data()) = pose.rotation;
      Eigen::Map<Eigen::Vector3d>(control_point.position.data()) = pose.translation;
    }
    const MotionNoise initial = MotionNoise::Of(options_.trajectory);
    motion_noise_ = options_.trajectory.estimate_densities
                        ? MotionProfile::Of(trajectory, initial)
                        : MotionProfile::Uniform(initial, trajectory);
    state_ = std::make_unique<MapState>(MapState{trajectory, {}, {}, path.start_ns(), {}});
    state_->calibration = RigCalibration(experiment_.rig, planar_);
    if (experiment_.inertial) {
      state_->calibration.imu.emplace(*experiment_.rig.imu, planar_, interval_s);
      state_->imu = ReadingsOfImu();
    }
    LandmarkOf(reference, 0);
    state_->landmarks.front().heading_fixed = true;
    return true;
  }

  // What the IMU reads along the path; without a seed as a perfect one.
  std::shared_ptr<const ImuReadings> ReadingsOfImu() const {
    InertialOptions options = *experiment_.inertial;
    if (!seed_) options.errors = 0.0;
    const Imu& imu = *experiment_.rig.imu;
    std::vector<ImuSample> samples =
        SimulateImu(simulator_.path(), imu, options, seed_.value_or(0)).samples;
    for (ImuSample& sample : samples) {
      sample.time_ns += NanosecondsFromSeconds(imu.time_offset_s);
    }
    return std::make_shared<const ImuReadings>(std::move(samples), imu);
  }

  // The path, continued beyond its ends as its mirror image there.
  Rigid3d PathPose(int64_t time_ns) const {
    const Path& path = simulator_.path();
    const int64_t inside_ns = std::clamp(time_ns, path.start_ns(), path.end_ns());
    const Rigid3d end = path.PoseAt(inside_ns);
    if (inside_ns == time_ns) return end;
    const Rigid3d mirrored =
        path.PoseAt(std::clamp(2 * inside_ns - time_ns, path.start_ns(), path.end_ns()));
    return {end.rotation * mirrored.rotation.conjugate() * end.rotation,
            2.0 * end.translation - mirrored.translation};
  }

  double MaxScanRate() const {
    double rate = 0.0;
    for (const Scanner& scanner : experiment_.rig.scanners) {
      rate = std::max(rate, scanner.scan_rate_hz);
    }
    return rate;
  }

  const Face& FaceOf(int plane) const {
    return experiment_.building.faces[static_cast<size_t>(plane)];
  }

  // The landmark that shows a plane in a scan; a new one where the gap rule asks for it.
  int LandmarkOf(int plane, int scan_index) {
    const auto known = landmark_of_plane_.find(plane);
    if (known != landmark_of_plane_.end()) {
      const Landmark& landmark = state_->landmarks[static_cast<size_t>(known->second)];
      if (IsWithinGap(landmark, scan_index, options_.loop_closure)) return known->second;
    }
    const Face& face = FaceOf(plane);
    const Eigen::Vector3d normal = model_from_world_.rotation * face.normal;
    const Eigen::Vector3d point = model_from_world_ * face.Centroid();
    Landmark landmark =
        face.type == PlaneType::kHorizontal ? MakeHorizontalLandmark(normal.z(), point)
        : face.type == PlaneType::kVertical ? MakeVerticalLandmark(normal, point)
        : face.type == PlaneType::kCylinder
            ? MakeCylinderLandmark(normal, face.curvature, point)
            : MakeGeneralLandmark(normal, point);
    landmark.id = static_cast<int>(state_->landmarks.size());
    landmark.first_scan = landmark.last_scan = scan_index;
    landmark_of_plane_[plane] = landmark.id;
    state_->landmarks.push_back(std::move(landmark));
    face_of_landmark_.push_back(plane);
    return state_->landmarks.back().id;
  }

  ScanMotion MotionOf(const ScanLine& scan_line,
                      const Scanner& scanner,
                      const Segment& segment) const {
    const std::array<int64_t, 3> times_ns =
        NodesOfSpan(BeamInstant(scan_line, segment.first_beam, experiment_.rig),
                    BeamInstant(scan_line, segment.last_beam, experiment_.rig));
    PoseSampler poses(state_->trajectory);
    std::array<Rigid3d, 3> world_from_scanner;
    for (size_t k = 0; k < 3; ++k) {
      world_from_scanner[k] = poses.WorldFromBody(times_ns[k], scanner.delay_s) *
                              scanner.BodyFromScanner(times_ns[k]);
    }
    return {times_ns, world_from_scanner};
  }

  void Add(const ScanLine& scan_line, std::vector<BeamRun> runs) {
    if (scan_line.scanner_index == 0) scan_times_ns_.push_back(scan_line.stamp_ns);
    const int scan_index = std::max<int>(0, static_cast<int>(scan_times_ns_.size()) - 1);
    const auto scanner_index = static_cast<size_t>(scan_line.scanner_index);
    const Scanner& scanner = experiment_.rig.scanners[scanner_index];
    std::shared_ptr<const ScanLine> kept;
    for (BeamRun& run : runs) {
      const int landmark_id = LandmarkOf(run.plane, scan_index);
      Segment& segment = run.segment;
      // The line's normal in the scan plane, which the beams' weights need.
      const int middle = (segment.first_beam + segment.last_beam) / 2;
      const int64_t middle_ns = BeamInstant(scan_line, middle, experiment_.rig);
      const Rigid3d world_from_scanner =
          state_->trajectory.WorldFromBody(middle_ns) * scanner.BodyFromScanner(middle_ns);
      const Eigen::Vector2d at = scan_line.ranges[static_cast<size_t>(segment.first_beam)] *
                                 scan_line.BeamDirection(segment.first_beam);
      const Eigen::Vector3d normal =
          world_from_scanner.rotation.conjugate() *
          state_->landmarks[static_cast<size_t>(landmark_id)].NormalNear(
              world_from_scanner * Eigen::Vector3d(at.x(), at.y(), 0.0));
      if (normal.head<2>().norm() < 1e-3) continue;  // the scan plane runs along the plane
      segment.normal = normal.head<2>().normalized();
      Observation observation = Observe(scan_line, segment, landmark_id);
      observation.scan_index = scan_index;
      if (seed_) {
        if (!kept) kept = std::make_shared<const ScanLine>(scan_line);
        sources_.push_back({kept, segment});
      }
      state_->observations.push_back(std::move(observation));
      const Observation& added = state_->observations.back();
      CountObservation(
          added, ObservationPoses(state_->trajectory, scanner, added), state_.get());
    }
  }

  Experiment experiment_;
  MapperOptions options_;
  std::optional<uint64_t> seed_;
  Simulator simulator_;
  std::vector<int> plane_of_face_;
  bool planar_;
  Rig rig_;                     // with its scanners as they are estimated
  MotionProfile motion_noise_;  // of the path, as the mapper would estimate it
  std::vector<std::pair<ScanLine, std::vector<BeamRun>>> first_lines_;  // before the start
  std::vector<int> face_of_landmark_;
  std::map<int, int> landmark_of_plane_;  // the newest
  Rigid3d model_from_world_;
  std::unique_ptr<MapState> state_;
  std::vector<int64_t> scan_times_ns_;
  std::vector<Source> sources_;  // of the observations; with a seed only
};

// The root mean square of the standard deviations of all scanners' parameters first .. end - 1
// that are not held.
double RmsSigma(const Calibration& calibration, size_t first, size_t end) {
  double squares = 0.0;
  int count = 0;
  for (const CalibratedScanner& scanner : calibration.scanners) {
    for (size_t i = first; i < end; ++i) {
      const CalibratedParameter& parameter = scanner.parameters[i];
      if (parameter.IsHeld()) continue;
      squares += parameter.sigma * parameter.sigma;
      ++count;
    }
  }
  return count == 0 ? 0.0 : std::sqrt(squares / count);
}

}  // namespace

Bound ComputeBound(const Experiment& experiment,
                   const MapperOptions& options,
                   const ProgressCallback& progress) {
  return BoundComputer(experiment, options, std::nullopt).Run(progress);
}

Bound EstimateWithTrueAssociations(const Experiment& experiment,
                                   const MapperOptions& options,
                                   uint64_t seed,
                                   const ProgressCallback& progress) {
  return BoundComputer(experiment, options, seed).Run(progress);
}

std::string BoundTable(const Bound& bound) {
  std::string text = "plane  type        points   angle/deg  distance/mm\n";
  char line[120];
  for (const PlanePatch& plane : bound.planes.planes()) {
    std::snprintf(line,
                  sizeof(line),
                  "%5d  %-10s %7lld  %10.5f  %11.3f\n",
                  plane.id,
                  FieldsOf(plane.type).name.c_str(),
                  static_cast<long long>(plane.num_points),
                  plane.sigma_angle_rad * kDegreesPerRadian,
                  1e3 * plane.sigma_distance_m);
    text += line;
  }
  std::vector<double> positions;
  std::vector<double> rotations;
  for (const StampedCovariance& pose : bound.poses) {
    positions.push_back(std::sqrt(pose.covariance.topLeftCorner<3, 3>().trace()));
    rotations.push_back(std::sqrt(pose.covariance.bottomRightCorner<3, 3>().trace()));
  }
  std::sort(positions.begin(), positions.end());
  std::sort(rotations.begin(), rotations.end());
  std::snprintf(line,
                sizeof(line),
                "poses: position %.2f mm median, %.2f mm worst; rotation %.4f deg, %.4f deg\n",
                1e3 * positions[positions.size() / 2],
                1e3 * positions.back(),
                rotations[rotations.size() / 2] * kDegreesPerRadian,
                rotations.back() * kDegreesPerRadian);
  text += line;
  const Calibration& calibration = bound.calibration;
  if (!calibration.scanners.empty()) {
    using At = CalibratedScanner::At;
    std::snprintf(line,
                  sizeof(line),
                  "scanners: rotations %.4f deg, translations %.3f mm, clocks %.4f ms, range "
                  "biases %.3f mm\n",
                  RmsSigma(calibration, At::kTurn, At::kShift),
                  1e3 * RmsSigma(calibration, At::kShift, At::kTime),
                  1e3 * RmsSigma(calibration, At::kTime, At::kRange),
                  1e3 * RmsSigma(calibration, At::kRange, At::kRange + kNumRangeErrors));
    text += line;
  }
  if (calibration.imu) {
    text += "IMU:";
    for (const CalibratedParameter& parameter : calibration.imu->parameters) {
      std::snprintf(line, sizeof(line), " %s %.3g", parameter.name.c_str(), parameter.sigma);
      text += line;
    }
    text += "\n";
  }
  for (const std::string& unobserved : UnobservedInWords(calibration)) {
    text += "not shown: " + unobserved + "\n";
  }
  return text;
}

void WriteBound(const Bound& bound, const std::string& directory) {
  std::error_code error;
  std::filesystem::create_directories(directory, error);
  if (!std::filesystem::is_directory(directory)) {
    throw Error(directory + ": can not create the directory");
  }
  const std::filesystem::path path = directory;
  WriteFileAtomically((path / "trajectory.tum").string(), FormatTrajectory(bound.trajectory));
  WriteFileAtomically((path / "trajectory_covariance.csv").string(),
                      FormatTrajectoryCovariance(bound.poses));
  WriteFileAtomically((path / "planes.json").string(), FormatPlanes(bound.planes.planes()));
  std::string faces = "plane,face\n";
  for (size_t i = 0; i < bound.face_ids.size(); ++i) {
    faces += std::to_string(bound.planes.planes()[i].id) + "," +
             std::to_string(bound.face_ids[i]) + "\n";
  }
  WriteFileAtomically((path / "faces.csv").string(), faces);
  WriteFileAtomically((path / "plane_covariance.csv").string(),
                      FormatPlaneCovariance(bound.planes));
  const std::filesystem::path calibration = path / "calibration.json";
  if (bound.calibration.empty()) {
    std::filesystem::remove(calibration, error);  // of an earlier bound
    return;
  }
  WriteFileAtomically(calibration.string(), FormatCalibration(bound.calibration));
}

}  // namespace plumbline
