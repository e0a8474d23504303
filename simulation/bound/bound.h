#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/options/mapper_options.h"
#include "core/result/plane_covariance.h"
#include "core/result/result_types.h"
#include "core/util/progress.h"
#include "simulation/sensing/experiment.h"

namespace plumbline {

// Bound is the Cramer-Rao bound of an experiment: the precision that a map of it can have at
// best.
struct Bound {
  PlaneCovariance planes;  // the true planes, in the model frame
  // The true face of each plane, the first where several faces are coplanar.
  std::vector<int> face_ids;
  std::vector<StampedPose> trajectory;
  std::vector<StampedCovariance> poses;  // of the same instants
  // The scanners and the IMU that the rig file does not know exactly: values are off the rig
  // file.
  Calibration calibration;
};

// Computes the bound from the mapper's normal matrix at the true geometry, with every beam on
// its true plane, optimal weights, no noise and no estimation. Coplanar faces that look the
// same way are one plane. With loop closure switched off, a plane that was unseen for more
// than max_gap_scans scans counts as a new one, as in the mapper. The model frame's x axis is
// the normal of the wall that the first scan sees with most beams. What the rig file does not
// know exactly of the scanners (Scanner::uncertainty) is unknown here as well, with that
// prior. progress is called after every scan line. Throws Error for experiments whose first
// scan sees no wall.
Bound ComputeBound(const Experiment& experiment,
                   const MapperOptions& options,
                   const ProgressCallback& progress);

// Estimates planes and trajectory from the noise of one seed as well as any estimator can: by
// least squares over all beams, each on its true plane, from the true geometry and the true
// rig on, which are also what the prior of uncertain scanners is about. What a map of the same
// seed is off beyond this is the mapper's own share. Keeps the beams in memory.
Bound EstimateWithTrueAssociations(const Experiment& experiment,
                                   const MapperOptions& options,
                                   uint64_t seed,
                                   const ProgressCallback& progress);

// Prints the standard deviations for people, lengths in millimetres; ends with a line break.
std::string BoundTable(const Bound& bound);

// Writes trajectory.tum, trajectory_covariance.csv, planes.json, plane_covariance.csv and
// faces.csv as docs/outputs.md describes them, and calibration.json where scanners are
// uncertain, each whole or not at all. Throws Error.
void WriteBound(const Bound& bound, const std::string& directory);

}  // namespace plumbline
