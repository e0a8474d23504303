#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/result/result_reader.h"
#include "core/result/result_writer.h"
#include "core/util/atomic_file.h"
#include "core/util/error.h"
#include "core/util/json_file.h"
#include "simulation/evaluation/evaluation.h"

namespace plumbline {
namespace {

using Json = nlohmann::ordered_json;

ResultFigures ReadFigures(const std::string& path) {
  const Json json = ReadJsonFile<Json>(path);
  ResultFigures figures;
  try {
    figures.motion = json.at("motion").get<std::string>();
    figures.reference_plane_id = json.at("reference_plane_id").get<int>();
    figures.residual_rms_m = json.at("residual_rms_m").get<double>();
    figures.variance_factor = json.at("variance_factor").get<double>();
  } catch (const nlohmann::json::exception& error) {
    throw Error(path + ": " + error.what());
  }
  if (figures.motion != "spatial" && figures.motion != "planar") {
    throw Error(path + ": motion is \"" + figures.motion + "\", not spatial or planar");
  }
  return figures;
}

Json ToJson(const ErrorStatistics& statistics) {
  return {{"rmse", statistics.rmse},
          {"mean", statistics.mean},
          {"median", statistics.median},
          {"max", statistics.max},
          {"std", statistics.stddev}};
}

Json ToJson(const PoseErrors& errors) {
  return {{"position_m", ToJson(errors.position_m)},
          {"rotation_deg", ToJson(errors.rotation_deg)}};
}

Json ToJson(const TrajectoryEvaluation& trajectory) {
  return {{"poses", trajectory.num_poses},
          {"poses_uncovered", trajectory.num_poses_uncovered},
          {"path_length_m", trajectory.path_length_m},
          {"unaligned", ToJson(trajectory.unaligned)},
          {"aligned", ToJson(trajectory.aligned)},
          {"relative_1m", ToJson(trajectory.relative_1m)}};
}

Json ToJson(const ModelFrameOfTruth& frame) {
  const Eigen::Vector3d& p = frame.model_from_truth.translation;
  const Eigen::Quaterniond& q = frame.model_from_truth.rotation;
  return {{"translation", {p.x(), p.y(), p.z()}},
          {"rotation_xyzw", {q.x(), q.y(), q.z(), q.w()}},
          {"anchor", frame.reference_face_id >= 0 ? "reference_plane" : "first_pose"},
          {"reference_face_id", frame.reference_face_id}};
}

Json ToJson(const PlaneEvaluation& planes) {
  Json list = Json::array();
  for (const PlaneMatch& match : planes.list) {
    Json entry = {{"id", match.plane_id},
                  {"status", MatchStatusName(match.status)},
                  {"true_faces", match.face_ids}};
    if (match.status != MatchStatus::kWrong) {
      entry["angle_deg"] = match.angle_deg;
      entry["distance_m"] = match.distance_m;
    }
    if (match.radius_error_m) {
      entry["radius_error_m"] = *match.radius_error_m;
      entry["sigma_radius_m"] = match.sigma_radius_m;
    }
    entry["sigma_angle_deg"] = match.sigma_angle_deg;
    entry["sigma_distance_m"] = match.sigma_distance_m;
    list.push_back(entry);
  }
  return {{"matched", planes.num_matched},
          {"wrong", planes.num_wrong},
          {"doubled", planes.num_doubled},
          {"missed", planes.num_missed},
          {"completeness", planes.completeness},
          {"angle_deg",
           {{"rmse", planes.angle_rmse_deg},
            {"max", planes.angle_max_deg},
            {"over_sigma_rms", planes.angle_over_sigma_rms}}},
          {"distance_m",
           {{"rmse", planes.distance_rmse_m},
            {"max", planes.distance_max_m},
            {"over_sigma_rms", planes.distance_over_sigma_rms}}},
          {"radius_error_max_m", planes.radius_max_m},
          {"radius_error_max_percent", planes.radius_max_percent},
          {"missed_faces", planes.missed_face_ids},
          {"list", list}};
}

// printf into the table.
template <typename... Values>
void Append(std::string* text, const char* format, Values... values) {
  char line[200];
  std::snprintf(line, sizeof(line), format, values...);
  *text += line;
}

void AppendErrors(std::string* text, const char* name, const PoseErrors& errors) {
  const auto append =
      [text](const char* label, const char* unit, const ErrorStatistics& s, double scale) {
        Append(text,
               "  %-22s %-4s %10.4f %10.4f %10.4f %10.4f %10.4f\n",
               label,
               unit,
               scale * s.rmse,
               scale * s.mean,
               scale * s.median,
               scale * s.max,
               scale * s.stddev);
      };
  append((std::string(name) + " position").c_str(), "mm", errors.position_m, 1000.0);
  append((std::string(name) + " rotation").c_str(), "deg", errors.rotation_deg, 1.0);
}

void AppendPlane(std::string* text, const PlaneMatch& match) {
  const std::string status = MatchStatusName(match.status);
  if (match.status == MatchStatus::kWrong) {
    Append(text, "  %5d  %-8s\n", match.plane_id, status.c_str());
    return;
  }
  std::string faces;
  for (const int id : match.face_ids) faces += (faces.empty() ? "" : " ") + std::to_string(id);
  Append(text,
         "  %5d  %-8s %10.4f %10.4f %10.3f %10.3f   %.80s\n",
         match.plane_id,
         status.c_str(),
         match.angle_deg,
         match.sigma_angle_deg,
         1000.0 * match.distance_m,
         1000.0 * match.sigma_distance_m,
         faces.c_str());
  if (match.radius_error_m) {
    Append(text,
           "         cylinder: radius off by %.3f mm, sigma %.3f mm\n",
           1000.0 * *match.radius_error_m,
           1000.0 * match.sigma_radius_m);
  }
}

}  // namespace

EvaluationInput ReadEvaluationInput(const std::string& result_directory,
                                    const std::string& truth_directory) {
  const std::filesystem::path result(result_directory);
  const std::filesystem::path truth(truth_directory);
  EvaluationInput input;
  input.trajectory = ReadTrajectory((result / "trajectory.tum").string());
  input.planes = ReadPlanes((result / "planes.json").string());
  input.figures = ReadFigures((result / "summary.json").string());
  input.truth_trajectory = ReadTrajectory((truth / "truth_trajectory.tum").string());
  input.truth_planes = ReadPlanes((truth / "truth_planes.json").string());
  return input;
}

std::string EvaluationTable(const Evaluation& evaluation) {
  const TrajectoryEvaluation& trajectory = evaluation.trajectory;
  const PlaneEvaluation& planes = evaluation.planes;
  std::string text;
  Append(&text,
         "Trajectory: %d poses over %.2f m, %s motion",
         trajectory.num_poses,
         trajectory.path_length_m,
         evaluation.figures.motion.c_str());
  if (trajectory.num_poses_uncovered > 0) {
    Append(&text, ", %d poses outside the truth left out", trajectory.num_poses_uncovered);
  }
  Append(&text,
         "\n  %-27s %10s %10s %10s %10s %10s\n",
         "",
         "rmse",
         "mean",
         "median",
         "max",
         "std");
  AppendErrors(&text, "unaligned", trajectory.unaligned);
  AppendErrors(&text, "aligned", trajectory.aligned);
  AppendErrors(&text, "per metre", trajectory.relative_1m);
  if (evaluation.frame.reference_face_id >= 0) {
    Append(&text, "  frame from true face %d\n", evaluation.frame.reference_face_id);
  } else {
    text += "  frame from the first pose, no reference wall matched\n";
  }
  Append(&text,
         "\nPlanes: %d matched, %d wrong, %d doubled, %d missed, %.2f %% of the points' faces "
         "found\n",
         planes.num_matched,
         planes.num_wrong,
         planes.num_doubled,
         planes.num_missed,
         100.0 * planes.completeness);
  Append(&text,
         "  %5s  %-8s %10s %10s %10s %10s   %s\n",
         "id",
         "status",
         "angle/deg",
         "sigma/deg",
         "dist/mm",
         "sigma/mm",
         "true faces");
  for (const PlaneMatch& match : planes.list) AppendPlane(&text, match);
  Append(&text,
         "  angle rmse %.4f deg, max %.4f deg, error/sigma %.2f\n",
         planes.angle_rmse_deg,
         planes.angle_max_deg,
         planes.angle_over_sigma_rms);
  Append(&text,
         "  distance rmse %.3f mm, max %.3f mm, error/sigma %.2f\n",
         1000.0 * planes.distance_rmse_m,
         1000.0 * planes.distance_max_m,
         planes.distance_over_sigma_rms);
  const PlaneEvaluation& aligned = evaluation.planes_aligned;
  Append(&text,
         "  after the trajectory's alignment: distance rmse %.3f mm, max %.3f mm\n",
         1000.0 * aligned.distance_rmse_m,
         1000.0 * aligned.distance_max_m);
  Append(&text,
         "\nResiduals: rms %.2f mm, variance factor %.4f\n",
         1000.0 * evaluation.figures.residual_rms_m,
         evaluation.figures.variance_factor);
  return text;
}

void WriteEvaluation(const Evaluation& evaluation, const std::string& path) {
  const Json json = {{"motion", evaluation.figures.motion},
                     {"residual_rms_m", evaluation.figures.residual_rms_m},
                     {"variance_factor", evaluation.figures.variance_factor},
                     {"model_from_truth", ToJson(evaluation.frame)},
                     {"trajectory", ToJson(evaluation.trajectory)},
                     {"planes", ToJson(evaluation.planes)},
                     {"planes_aligned", ToJson(evaluation.planes_aligned)}};
  WriteFileAtomically(path, json.dump(2) + "\n");
}

}  // namespace plumbline
