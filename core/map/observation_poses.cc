#include "core/map/observation_poses.h"

namespace plumbline {
namespace {

std::array<Rigid3d, 3> Sample(const std::array<int64_t, 3>& times_ns,
                              double delay_s,
                              PoseSampler* poses) {
  return {poses->WorldFromBody(times_ns[0], delay_s),
          poses->WorldFromBody(times_ns[1], delay_s),
          poses->WorldFromBody(times_ns[2], delay_s)};
}

std::array<Rigid3d, 3> SampleOnce(const std::array<int64_t, 3>& times_ns,
                                  double delay_s,
                                  const Trajectory& trajectory) {
  PoseSampler poses(trajectory);
  return Sample(times_ns, delay_s, &poses);
}

std::array<Rigid3d, 3> OfScanner(const std::array<int64_t, 3>& times_ns,
                                 const std::array<Rigid3d, 3>& world_from_body,
                                 const Scanner& scanner) {
  if (scanner.mount) {
    return {world_from_body[0] * scanner.BodyFromScanner(times_ns[0]),
            world_from_body[1] * scanner.BodyFromScanner(times_ns[1]),
            world_from_body[2] * scanner.BodyFromScanner(times_ns[2])};
  }
  const Rigid3d& body_from_scanner = scanner.body_from_scanner;
  return {world_from_body[0] * body_from_scanner,
          world_from_body[1] * body_from_scanner,
          world_from_body[2] * body_from_scanner};
}

// The middle one of equidistant instants follows from the others.
bool AreSame(const std::array<int64_t, 3>& a, const std::array<int64_t, 3>& b) {
  return a[0] == b[0] && a[2] == b[2];
}

}  // namespace

ObservationPoses::ObservationPoses(const std::array<int64_t, 3>& node_times_ns,
                                   const std::array<Rigid3d, 3>& bodies,
                                   const Scanner& scanner)
    : times_ns(node_times_ns),
      world_from_body(bodies[1]),
      world_from_scanner(bodies[1] * scanner.BodyFromScanner(node_times_ns[1])),
      motion(node_times_ns,
             OfScanner(node_times_ns, bodies, scanner),
             1.0 - scanner.range_excess_share),
      range_excess_m(scanner.range_excess_m) {}

ObservationPoses::ObservationPoses(const std::array<int64_t, 3>& node_times_ns,
                                   const Scanner& scanner,
                                   PoseSampler* poses)
    : ObservationPoses(node_times_ns, Sample(node_times_ns, scanner.delay_s, poses), scanner) {
}

ObservationPoses::ObservationPoses(const Trajectory& trajectory,
                                   const Scanner& scanner,
                                   const Observation& observation)
    : ObservationPoses(
          observation.measurement.node_times_ns(),
          SampleOnce(observation.measurement.node_times_ns(), scanner.delay_s, trajectory),
          scanner) {}

std::array<Rigid3d, 3> SharedPoses::BodiesAt(const std::array<int64_t, 3>& times_ns,
                                             double delay_s) {
  for (const Kept& kept : kept_) {
    if (kept.delay_s == delay_s && AreSame(kept.poses.times_ns, times_ns)) {
      return kept.world_from_body;
    }
  }
  return Sample(times_ns, delay_s, &sampler_);
}

const ObservationPoses& SharedPoses::Of(const Observation& observation) {
  const std::array<int64_t, 3> times_ns = observation.measurement.node_times_ns();
  for (const Kept& kept : kept_) {
    if (kept.scanner_index == observation.scanner_index &&
        AreSame(kept.poses.times_ns, times_ns)) {
      return kept.poses;
    }
  }
  const Scanner& scanner = rig_.scanners[static_cast<size_t>(observation.scanner_index)];
  const std::array<Rigid3d, 3> bodies = BodiesAt(times_ns, scanner.delay_s);
  const Kept made{
      observation.scanner_index, scanner.delay_s, bodies, {times_ns, bodies, scanner}};
  if (kept_.size() < kNumKept) {
    kept_.push_back(made);
    return kept_.back().poses;
  }
  next_ = (next_ + 1) % kNumKept;
  kept_[next_] = made;
  return kept_[next_].poses;
}

}  // namespace plumbline
