#include "core/estimation/segment_groups.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <utility>

#include "core/surface/landmark_view.h"
#include "factors/segment/segment_measurement.h"
#include "factors/spline/spline.h"

namespace plumbline {
namespace {

// The landmarks that the observations lie on, ascending.
std::vector<int> LandmarksOf(const std::vector<const Observation*>& observations) {
  std::vector<int> ids;
  for (const Observation* observation : observations) ids.push_back(observation->landmark_id);
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  ids.shrink_to_fit();  // few planes, many observations
  return ids;
}

SegmentGroup::MountAtNodes MotionAtNodes(const Scanner& scanner,
                                         const std::array<int64_t, 3>& times_ns) {
  return {MotionOf(*scanner.mount, times_ns[0], scanner.delay_s),
          MotionOf(*scanner.mount, times_ns[1], scanner.delay_s),
          MotionOf(*scanner.mount, times_ns[2], scanner.delay_s)};
}

SegmentGroupCache::Entry MakeEntry(const Rig& rig,
                                   const std::vector<SegmentGroup::Scanner>& scanners,
                                   const Trajectory& trajectory,
                                   const std::deque<Landmark>& landmarks,
                                   int first,
                                   const std::vector<const Observation*>& members,
                                   const SegmentGroupCache::Loss& loss) {
  std::vector<int> ids = LandmarksOf(members);
  std::vector<SegmentGroup::Plane> planes;
  std::vector<LandmarkView> views;  // of planes
  for (const int id : ids) {
    const Landmark& landmark = landmarks[static_cast<size_t>(id)];
    planes.push_back({landmark.model, landmark.chart});
    views.emplace_back(landmark);
  }
  SharedPoses poses(rig, trajectory);
  std::vector<SegmentGroup::Segment> segments;
  segments.reserve(members.size());
  int num_control_points = kSplineOrder;
  std::array<int64_t, 3> times_ns = {};  // of the nodes; most segments share the last one's
  std::vector<SegmentGroup::MountAtNodes> mount_motions;
  int last_mounted = -1;  // scanner of the last motion, at these nodes
  SegmentGroup::Segment segment;
  for (const Observation* observation : members) {
    segment.measurement = &observation->measurement;
    if (observation->measurement.node_times_ns() != times_ns || segments.empty()) {
      times_ns = observation->measurement.node_times_ns();
      for (size_t k = 0; k < 3; ++k) {
        const Trajectory::Location at = trajectory.Locate(times_ns[k]);
        segment.nodes[k] = {at.first - first, at.u};
      }
      last_mounted = -1;
    }
    num_control_points = std::max(num_control_points, segment.nodes[2].first + kSplineOrder);
    segment.scanner = observation->scanner_index;
    const Scanner& scanner = rig.scanners[static_cast<size_t>(observation->scanner_index)];
    segment.mount_motion = -1;
    if (scanner.mount) {
      if (observation->scanner_index != last_mounted) {
        last_mounted = observation->scanner_index;
        mount_motions.push_back(MotionAtNodes(scanner, times_ns));
      }
      segment.mount_motion = static_cast<int>(mount_motions.size()) - 1;
    }
    segment.plane = static_cast<int>(
        std::lower_bound(ids.begin(), ids.end(), observation->landmark_id) - ids.begin());
    const ObservationPoses& placed = poses.Of(*observation);
    const Eigen::Vector3d centroid =
        placed.motion.nodes()[1] * observation->centroid().homogeneous();
    segment.weights =
        WeightsOn(*observation,
                  placed.world_from_scanner.rotation,
                  views[static_cast<size_t>(segment.plane)].UnitNormalNear(centroid));
    segments.push_back(segment);
  }
  SegmentGroup group(num_control_points,
                     trajectory.knot_interval_s(),
                     scanners,
                     std::move(planes),
                     std::move(segments),
                     loss.huber_width,
                     std::move(mount_motions));
  return {first,
          std::move(ids),
          std::make_shared<LinearisedGroup>(std::move(group), loss.landmarks_held)};
}

}  // namespace

SegmentWeights ObservationWeights(const ObservationPoses& poses,
                                  const std::deque<Landmark>& landmarks,
                                  const Observation& observation) {
  const Landmark& landmark = landmarks[static_cast<size_t>(observation.landmark_id)];
  const Eigen::Vector3d centroid =
      poses.motion.nodes()[1] * observation.centroid().homogeneous();
  return WeightsOn(observation,
                   poses.world_from_scanner.rotation,
                   landmark.NormalNear(centroid).normalized());
}

namespace {

std::vector<SegmentGroup::Scanner> ScannersOf(const Rig& rig,
                                              const RigCalibration* calibration) {
  std::vector<SegmentGroup::Scanner> scanners;
  for (size_t i = 0; i < rig.scanners.size(); ++i) {
    const bool estimated = calibration != nullptr && !calibration->scanners.empty() &&
                           calibration->scanners[i].IsEstimated();
    const Rigid3d& pose =
        estimated ? calibration->scanners[i].stated : rig.scanners[i].body_from_scanner;
    std::optional<MountPose> mount;
    if (rig.scanners[i].mount) {
      mount =
          estimated ? calibration->scanners[i].stated_mount : PoseOf(*rig.scanners[i].mount);
    }
    scanners.push_back(
        {{pose.rotation.toRotationMatrix(), pose.translation}, estimated, mount});
  }
  return scanners;
}

// Hash of which observations these are, with which beams and planes, and of what shape these
// are: what a list of them would tell, in less memory. A wall that has become a cylinder has
// other parameters. The mixing is that of SplitMix64 (Steele et al. 2014).
uint64_t Fingerprint(const std::vector<const Observation*>& observations,
                     const std::deque<Landmark>& landmarks) {
  uint64_t hash = 0;
  const auto mix = [&hash](uint64_t value) {
    hash = (hash ^ value) + 0x9e3779b97f4a7c15u;
    hash = (hash ^ (hash >> 30)) * 0xbf58476d1ce4e5b9u;
    hash = (hash ^ (hash >> 27)) * 0x94d049bb133111ebu;
    hash ^= hash >> 31;
  };
  for (const Observation* observation : observations) {
    mix(reinterpret_cast<uintptr_t>(observation));
    mix(static_cast<uint64_t>(observation->landmark_id));
    const Landmark& landmark = landmarks[static_cast<size_t>(observation->landmark_id)];
    mix(static_cast<uint64_t>(landmark.model));
    for (const double coordinate : landmark.chart.anchor) {
      uint64_t bits = 0;
      std::memcpy(&bits, &coordinate, sizeof(bits));
      mix(bits);
    }
    mix(static_cast<uint64_t>(observation->revision));
  }
  return hash;
}

// Returns the observations by the first of the knot intervals of their group.
std::map<int, std::vector<const Observation*>> ByInterval(
    const Trajectory& trajectory,
    const std::vector<const Observation*>& observations,
    int intervals_per_group) {
  std::map<int, std::vector<const Observation*>> by_interval;
  std::vector<const Observation*>* members = nullptr;  // of the last one's interval
  int64_t time_ns = 0;
  for (const Observation* observation : observations) {
    const int64_t now_ns = observation->measurement.node_times_ns()[0];
    if (members == nullptr || now_ns != time_ns) {
      time_ns = now_ns;
      const int interval = trajectory.Locate(time_ns).first;
      members = &by_interval[interval - interval % intervals_per_group];
    }
    members->push_back(observation);
  }
  return by_interval;
}

}  // namespace

std::vector<const SegmentGroupCache::Entry*> SegmentGroupCache::Update(
    const Rig& rig,
    const RigCalibration* calibration,
    const Trajectory& trajectory,
    const std::deque<Landmark>& landmarks,
    const std::vector<const Observation*>& observations,
    const Loss& loss) {
  const std::vector<SegmentGroup::Scanner> scanners = ScannersOf(rig, calibration);
  std::vector<const Entry*> entries;
  for (const auto& [first, observed] :
       ByInterval(trajectory, observations, intervals_per_group_)) {
    const uint64_t fingerprint = Fingerprint(observed, landmarks);
    Kept& kept = groups_[first];
    const bool stands = kept.entry.group != nullptr && kept.fingerprint == fingerprint &&
                        (kept.huber_width == loss.huber_width || kept.entry.group->is_plain());
    if (!stands) {
      kept.entry = MakeEntry(rig, scanners, trajectory, landmarks, first, observed, loss);
      kept.fingerprint = fingerprint;
      kept.huber_width = loss.huber_width;
    }
    kept.entry.group->set_validity(validity_);
    entries.push_back(&kept.entry);
  }
  return entries;
}

void SegmentGroupCache::ForgetBefore(int control_point) {
  groups_.erase(groups_.begin(), groups_.lower_bound(control_point));
}

}  // namespace plumbline
