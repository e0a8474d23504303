#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "core/geometry/rigid3.h"
#include "core/result/result_types.h"
#include "simulation/evaluation/plane_matching.h"

namespace plumbline {

// ResultFigures are the parts of summary.json that the evaluation needs.
struct ResultFigures {
  std::string motion = "spatial";  // "planar": heights, roll and pitch are not compared
  int reference_plane_id = -1;     // -1: the mapper found no reference wall
  double residual_rms_m = 0.0;
  double variance_factor = 0.0;
};

// EvaluationInput holds a result of the mapper and the truth to compare it with. The result is
// in the model frame, the truth in the simulator's own world frame ("truth" below); both have
// z up.
struct EvaluationInput {
  std::vector<StampedPose> trajectory;  // model_from_body
  std::vector<PlanePatch> planes;
  ResultFigures figures;
  std::vector<StampedPose> truth_trajectory;  // truth_from_body, dense
  std::vector<PlanePatch> truth_planes;       // num_points = beams that hit the face
};

// ErrorStatistics summarise a list of errors that are not negative. stddev is the spread about
// the mean: rmse^2 = mean^2 + stddev^2.
struct ErrorStatistics {
  double rmse = 0.0;
  double mean = 0.0;
  double median = 0.0;
  double max = 0.0;
  double stddev = 0.0;
};

ErrorStatistics ComputeStatistics(std::vector<double> errors);  // all zero for an empty list

struct PoseErrors {
  ErrorStatistics position_m;
  ErrorStatistics rotation_deg;
};

struct TrajectoryEvaluation {
  int num_poses = 0;            // compared
  int num_poses_uncovered = 0;  // outside the time span of the truth, left out
  double path_length_m = 0.0;   // of the truth at the compared instants
  PoseErrors unaligned;         // truth in the model frame by the frame's definition
  PoseErrors aligned;           // after the best rigid motion of the result onto the truth
  PoseErrors relative_1m;       // of the motion over each metre of the path
  Rigid3d alignment;            // that rigid motion
};

// ModelFrameOfTruth says how the truth was brought into the model frame.
struct ModelFrameOfTruth {
  Rigid3d model_from_truth;
  int reference_face_id = -1;  // the true wall that gives the heading; -1: the first pose does
};

struct Evaluation {
  ResultFigures figures;
  ModelFrameOfTruth frame;
  TrajectoryEvaluation trajectory;
  PlaneEvaluation planes;
  // Errors of the planes after the trajectory's alignment, which takes out the error of the
  // model frame's origin, the first pose.
  PlaneEvaluation planes_aligned;
};

// Interpolates poses between the samples of a dense trajectory: cubic through the four nearest
// samples, for the rotation in the tangent space of one of them. At 5 ms sampling the
// interpolation error of indoor motion is below a micrometre.
class InterpolatedTrajectory {
 public:
  // Throws Error for fewer than two poses or instants that do not increase.
  explicit InterpolatedTrajectory(const std::vector<StampedPose>& poses);

  bool Covers(int64_t time_ns) const;
  Rigid3d Pose(int64_t time_ns) const;  // Error unless Covers(time_ns)

 private:
  std::vector<StampedPose> poses_;
};

// Finds the model frame of a result (docs/terms.md) in the truth: z up, origin at the true
// position at the first pose, x axis along the normal of the true face that the reference wall
// shows. Without reference wall, or when no true face fits it, heading and origin are those
// that make the first poses agree.
ModelFrameOfTruth FindModelFrame(const EvaluationInput& input,
                                 const InterpolatedTrajectory& truth,
                                 const PlaneMatchingOptions& options);

// Computes the errors of a result. Throws Error when the result is empty or begins outside the
// time span of the truth.
Evaluation Evaluate(const EvaluationInput& input, const PlaneMatchingOptions& options);

// Reads trajectory.tum, planes.json and summary.json of a result, truth_trajectory.tum and
// truth_planes.json of a simulation. Throws Error naming the file at fault.
EvaluationInput ReadEvaluationInput(const std::string& result_directory,
                                    const std::string& truth_directory);

// Prints the errors for people, lengths in millimetres; ends with a line break.
std::string EvaluationTable(const Evaluation& evaluation);

// Writes evaluation.json as docs/outputs.md describes it, whole or not at all. Throws Error
// when it can not be written.
void WriteEvaluation(const Evaluation& evaluation, const std::string& path);

}  // namespace plumbline
