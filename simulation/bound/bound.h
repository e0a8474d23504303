#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/options/mapper_options.h"
#include "core/result/plane_covariance.h"
#include "core/result/result_types.h"
#include "simulation/sensing/experiment.h"

namespace plumbline {

// The Cramer-Rao bound of an experiment: the precision that a map of it can have at best.
struct Bound {
  PlaneCovariance planes;  // the true planes, in the model frame
  std::vector<int>
      face_ids;  // parallel to its planes: the true face, of coplanar ones the first
  std::vector<StampedPose> trajectory;
  std::vector<StampedCovariance> poses;  // of the same instants
};

// The mapper's normal matrix at the true geometry, every beam on its true plane, optimal
// weights, no noise and no estimation. Coplanar faces that look the same way are one plane.
// With loop closure switched off, a plane that was unseen for more than max_gap_scans scans
// counts as a new one, as in the mapper. The model frame's x axis is the normal of the wall
// that the first scan sees with most beams. progress is called with the share that is done.
// Throws Error for experiments whose first scan sees no wall.
Bound ComputeBound(const Experiment& experiment,
                   const MapperOptions& options,
                   const std::function<void(double)>& progress);

// What an estimator can make at best of the noise of one seed: least squares over all beams,
// each on its true plane, from the true geometry on. The planes and the trajectory are the
// estimated ones. Over the same seeds, what a map is off beyond this is the mapper's own
// share. Keeps the beams in memory.
Bound EstimateWithTrueAssociations(const Experiment& experiment,
                                   const MapperOptions& options,
                                   uint64_t seed,
                                   const std::function<void(double)>& progress);

// For people, lengths in millimetres; ends with a line break.
std::string BoundTable(const Bound& bound);

// trajectory.tum, trajectory_covariance.csv, planes.json, plane_covariance.csv and faces.csv
// as docs/outputs.md describes them, each whole or not at all. Throws Error.
void WriteBound(const Bound& bound, const std::string& directory);

}  // namespace plumbline
