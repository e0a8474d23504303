#include "simulation/evaluation/evaluation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/geometry/angles.h"
#include "core/result/result_text.h"
#include "core/result/result_writer.h"
#include "core/util/atomic_file.h"
#include "core/util/error.h"
#include "core/util/time.h"

namespace plumbline {
namespace {

// A rig that weaves and nods on a round path; no polynomial.
Rigid3d TruePose(double time_s) {
  const double phase = 0.4 * time_s;
  const Eigen::Vector3d position(
      3.0 * std::cos(phase), 2.0 * std::sin(phase), 1.5 + 0.02 * std::sin(5.0 * time_s));
  return {RotationFromRollPitchYaw(
              0.03 * std::sin(4.0 * time_s), 0.02 * std::cos(6.0 * time_s), phase + 1.0),
          position};
}

// The flat part of it, for planar rigs.
Rigid3d TrueFlatPose(double time_s) {
  Rigid3d pose = TruePose(time_s);
  pose.translation.z() = 0.3;
  pose.rotation = RotationFromRollPitchYaw(0.0, 0.0, 0.4 * time_s + 1.0);
  return pose;
}

std::vector<StampedPose> Sample(Rigid3d (*pose)(double), double end_s, double step_s) {
  std::vector<StampedPose> poses;
  for (int i = 0; i * step_s <= end_s + 1e-9; ++i) {
    poses.push_back({NanosecondsFromSeconds(i * step_s), pose(i * step_s)});
  }
  return poses;
}

// A rectangle with the given normal around centre, half its size along each side.
PlanePatch MakePatch(int id,
                     const Eigen::Vector3d& normal,
                     const Eigen::Vector3d& centre,
                     double half_width,
                     double half_height) {
  PlanePatch patch;
  patch.id = id;
  patch.type = std::abs(normal.z()) > 0.5 ? PlaneType::kHorizontal : PlaneType::kVertical;
  patch.normal = normal;
  patch.distance = normal.dot(centre);
  patch.centre = centre;
  const Eigen::Vector3d up = patch.type == PlaneType::kHorizontal ? Eigen::Vector3d::UnitY()
                                                                  : Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d along = up.cross(normal);
  for (const auto& [u, v] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
    patch.outline.push_back(centre + u * half_width * along + v * half_height * up);
  }
  patch.num_points = 1000;
  return patch;
}

// A room of 8 x 6 x 3 m around the true world's origin, normals pointing inwards.
std::vector<PlanePatch> TrueRoom() {
  return {MakePatch(10, {0, 0, 1}, {0, 0, 0}, 4, 3),
          MakePatch(11, {0, 0, -1}, {0, 0, 3}, 4, 3),
          MakePatch(12, {-1, 0, 0}, {4, 0, 1.5}, 3, 1.5),
          MakePatch(13, {0, -1, 0}, {0, 3, 1.5}, 4, 1.5),
          MakePatch(14, {1, 0, 0}, {-4, 0, 1.5}, 3, 1.5),
          MakePatch(15, {0, 1, 0}, {0, -3, 1.5}, 4, 1.5)};
}

// The model frame by its definition, when face 13 (normal -y) is the reference wall.
Rigid3d ModelFromTruth(Rigid3d (*pose)(double)) {
  const Eigen::Quaterniond rotation = RotationFromRollPitchYaw(0.0, 0.0, M_PI / 2.0);
  return {rotation, -(rotation * pose(0.0).translation)};
}

// A faultless result: planes have the faces' ids.
EvaluationInput PerfectInput(Rigid3d (*pose)(double) = TruePose) {
  EvaluationInput input;
  const Rigid3d model_from_truth = ModelFromTruth(pose);
  input.truth_trajectory = Sample(pose, 12.0, 0.005);
  input.truth_planes = TrueRoom();
  input.trajectory = Sample(pose, 11.9, 0.0237);
  for (StampedPose& stamped : input.trajectory) {
    stamped.world_from_body = model_from_truth * stamped.world_from_body;
  }
  for (const PlanePatch& face : input.truth_planes) {
    input.planes.push_back(TransformPatch(model_from_truth, face));
  }
  input.figures.reference_plane_id = 13;
  return input;
}

void RotateResult(double yaw, EvaluationInput* input) {
  const Rigid3d motion{RotationFromRollPitchYaw(0.0, 0.0, yaw), Eigen::Vector3d::Zero()};
  for (StampedPose& pose : input->trajectory) {
    pose.world_from_body = motion * pose.world_from_body;
  }
}

const PlaneMatch& MatchOf(const Evaluation& evaluation, int plane_id) {
  for (const PlaneMatch& match : evaluation.planes.list) {
    if (match.plane_id == plane_id) return match;
  }
  throw Error("no plane " + std::to_string(plane_id));
}

TEST(EvaluationTest, StatisticsByHand) {
  const ErrorStatistics statistics = ComputeStatistics({4.0, 1.0, 3.0, 2.0});
  EXPECT_DOUBLE_EQ(statistics.mean, 2.5);
  EXPECT_DOUBLE_EQ(statistics.median, 2.5);
  EXPECT_DOUBLE_EQ(statistics.max, 4.0);
  EXPECT_DOUBLE_EQ(statistics.rmse, std::sqrt(30.0 / 4.0));
  EXPECT_DOUBLE_EQ(statistics.stddev, std::sqrt(5.0 / 4.0));
  EXPECT_DOUBLE_EQ(ComputeStatistics({5.0, 1.0, 2.0}).median, 2.0);
}

TEST(EvaluationTest, InterpolatesTruthBetweenItsSamples) {
  const InterpolatedTrajectory truth(Sample(TruePose, 2.0, 0.005));
  for (const double time_s : {0.0, 0.0012, 0.0025, 0.9987, 1.0025, 1.9981, 2.0}) {
    const Rigid3d pose = truth.Pose(NanosecondsFromSeconds(time_s));
    const Rigid3d expected = TruePose(time_s);
    EXPECT_LT((pose.translation - expected.translation).norm(), 1e-8) << time_s;
    EXPECT_LT(pose.rotation.angularDistance(expected.rotation), 1e-7) << time_s;
  }
}

TEST(EvaluationTest, ASampleThatAlmostCoincidesDoesNoHarm) {
  std::vector<StampedPose> poses = Sample(TruePose, 1.0, 0.005);
  poses.push_back({NanosecondsFromSeconds(1.0) + 1, TruePose(1.0)});
  poses.back().world_from_body.translation.x() += 1e-9;  // the rounding of a file
  const InterpolatedTrajectory truth(poses);
  const Rigid3d pose = truth.Pose(NanosecondsFromSeconds(0.9975));
  EXPECT_LT((pose.translation - TruePose(0.9975).translation).norm(), 1e-8);
}

TEST(EvaluationTest, RejectsUnusableTruth) {
  EXPECT_THROW(InterpolatedTrajectory(std::vector<StampedPose>{}), Error);
  EXPECT_THROW(InterpolatedTrajectory(std::vector<StampedPose>{{5, {}}, {5, {}}}), Error);
  const InterpolatedTrajectory truth({{5, {}}, {6, {}}});
  EXPECT_THROW(truth.Pose(7), Error);
  EvaluationInput input = PerfectInput();
  for (StampedPose& pose : input.trajectory) pose.time_ns = -1 - pose.time_ns;
  EXPECT_THROW(Evaluate(input, {}), Error);
  input.trajectory.clear();
  EXPECT_THROW(Evaluate(input, {}), Error);
}

TEST(EvaluationTest, PerfectResultHasNoErrors) {
  const EvaluationInput input = PerfectInput();
  const Evaluation evaluation = Evaluate(input, {});
  EXPECT_EQ(evaluation.frame.reference_face_id, 13);
  EXPECT_LT(evaluation.trajectory.unaligned.position_m.max, 1e-7);
  EXPECT_LT(evaluation.trajectory.unaligned.rotation_deg.max, 1e-5);
  EXPECT_LT(evaluation.trajectory.aligned.position_m.max, 1e-7);
  EXPECT_LT(evaluation.trajectory.relative_1m.position_m.max, 1e-7);
  double path_length_m = 0.0;
  for (size_t i = 1; i < input.trajectory.size(); ++i) {
    path_length_m += (input.trajectory[i].world_from_body.translation -
                      input.trajectory[i - 1].world_from_body.translation)
                         .norm();
  }
  EXPECT_NEAR(evaluation.trajectory.path_length_m, path_length_m, 1e-5);
  EXPECT_EQ(evaluation.planes.num_matched, 6);
  EXPECT_EQ(evaluation.planes.num_wrong, 0);
  EXPECT_EQ(evaluation.planes.num_doubled, 0);
  EXPECT_EQ(evaluation.planes.num_missed, 0);
  EXPECT_DOUBLE_EQ(evaluation.planes.completeness, 1.0);
  EXPECT_LT(evaluation.planes.angle_max_deg, 1e-9);
  EXPECT_LT(evaluation.planes.distance_max_m, 1e-9);
}

TEST(EvaluationTest, KnownOffsetIsReportedAndAligned) {
  EvaluationInput input = PerfectInput();
  const Eigen::Vector3d offset(0.003, 0.0, 0.004);
  for (StampedPose& pose : input.trajectory) pose.world_from_body.translation += offset;
  const Evaluation evaluation = Evaluate(input, {});
  EXPECT_NEAR(evaluation.trajectory.unaligned.position_m.rmse, 0.005, 1e-7);
  EXPECT_NEAR(evaluation.trajectory.unaligned.position_m.median, 0.005, 1e-7);
  EXPECT_LT(evaluation.trajectory.unaligned.rotation_deg.max, 1e-5);
  EXPECT_LT(evaluation.trajectory.aligned.position_m.max, 1e-7);
}

TEST(EvaluationTest, AlignmentTakesOutAnyRigidMotion) {
  EvaluationInput input = PerfectInput();
  const Rigid3d motion{RotationFromRollPitchYaw(0.004, -0.006, 0.01), {0.1, 0.2, -0.3}};
  for (StampedPose& pose : input.trajectory) {
    pose.world_from_body = motion * pose.world_from_body;
  }
  const Evaluation evaluation = Evaluate(input, {});
  EXPECT_NEAR(evaluation.trajectory.unaligned.rotation_deg.mean,
              Eigen::AngleAxisd(motion.rotation).angle() / kRadiansPerDegree,
              1e-5);
  EXPECT_LT(evaluation.trajectory.aligned.position_m.max, 1e-6);
  EXPECT_LT(evaluation.trajectory.aligned.rotation_deg.max, 1e-4);
  EXPECT_LT(evaluation.trajectory.relative_1m.position_m.max, 1e-6);
}

TEST(EvaluationTest, AlignmentOfStraightAndStandingRigs) {
  for (const double speed : {0.0, 1.0}) {
    EvaluationInput input;
    for (int i = 0; i <= 100; ++i) {
      const Rigid3d pose{Eigen::Quaterniond::Identity(), {speed * 0.05 * i, 0.0, 1.0}};
      const int64_t time_ns = NanosecondsFromSeconds(0.05 * i);
      input.truth_trajectory.push_back({time_ns, pose});
      const Rigid3d model_from_truth{Eigen::Quaterniond::Identity(), {0.1, 0.2, 0.3}};
      input.trajectory.push_back({time_ns, model_from_truth * pose});
    }
    input.trajectory.front().world_from_body.translation.x() += 0.02;
    const Evaluation evaluation = Evaluate(input, {});
    EXPECT_EQ(evaluation.frame.reference_face_id, -1);
    EXPECT_LT(evaluation.trajectory.aligned.rotation_deg.max, 1e-9);
    EXPECT_NEAR(evaluation.trajectory.aligned.position_m.max, 0.02 * 100 / 101, 1e-4);
  }
}

TEST(EvaluationTest, HeadingComesFromTheWallNotFromTheFirstPose) {
  EvaluationInput input = PerfectInput();
  RotateResult(0.5 * kRadiansPerDegree, &input);
  const Evaluation by_wall = Evaluate(input, {});
  EXPECT_EQ(by_wall.frame.reference_face_id, 13);
  EXPECT_NEAR(by_wall.trajectory.unaligned.rotation_deg.rmse, 0.5, 1e-5);
  EXPECT_EQ(by_wall.planes.num_matched, 6);
  EXPECT_LT(by_wall.planes.angle_max_deg, 1e-9);

  input.figures.reference_plane_id = -1;
  const Evaluation by_pose = Evaluate(input, {});
  EXPECT_EQ(by_pose.frame.reference_face_id, -1);
  EXPECT_LT(by_pose.trajectory.unaligned.position_m.max, 1e-6);
  EXPECT_NEAR(MatchOf(by_pose, 14).angle_deg, 0.5, 1e-5);
}

TEST(EvaluationTest, KnownPlaneErrors) {
  EvaluationInput input = PerfectInput();
  PlanePatch& wall = input.planes[4];
  const double yaw = 0.1 * kRadiansPerDegree;
  wall.centre += 0.012 * wall.normal;
  wall.normal = RotationFromRollPitchYaw(0.0, 0.0, yaw) * wall.normal;
  wall.distance = wall.normal.dot(wall.centre);
  wall.sigma_angle_rad = 0.5 * yaw;
  wall.sigma_distance_m = 0.004;
  const Evaluation evaluation = Evaluate(input, {});
  EXPECT_NEAR(MatchOf(evaluation, 14).angle_deg, 0.1, 1e-9);
  EXPECT_NEAR(MatchOf(evaluation, 14).distance_m, 0.012, 1e-9);
  EXPECT_NEAR(evaluation.planes.angle_rmse_deg, 0.1 / std::sqrt(6.0), 1e-9);
  EXPECT_NEAR(evaluation.planes.distance_max_m, 0.012, 1e-9);
  EXPECT_NEAR(evaluation.planes.angle_over_sigma_rms, 2.0, 1e-6);
  EXPECT_NEAR(evaluation.planes.distance_over_sigma_rms, 3.0, 1e-6);
}

TEST(EvaluationTest, WrongDoubledAndMissedPlanes) {
  EvaluationInput input = PerfectInput();
  // 0.3 m in front of a wall: no true face.
  PlanePatch ghost = input.planes[2];
  ghost.id = 20;
  ghost.centre += 0.3 * ghost.normal;
  ghost.distance += 0.3;
  // A part of another wall once more.
  PlanePatch twin = input.planes[5];
  twin.id = 21;
  twin.num_points = 10;
  for (Eigen::Vector3d& corner : twin.outline) corner = 0.5 * (corner + twin.centre);
  input.planes.erase(input.planes.begin() + 4);
  input.planes.push_back(ghost);
  input.planes.push_back(twin);
  const Evaluation evaluation = Evaluate(input, {});
  EXPECT_EQ(evaluation.planes.num_matched, 5);
  EXPECT_EQ(MatchOf(evaluation, 20).status, MatchStatus::kWrong);
  EXPECT_EQ(MatchOf(evaluation, 21).status, MatchStatus::kDoubled);
  EXPECT_EQ(evaluation.planes.num_wrong, 1);
  EXPECT_EQ(evaluation.planes.num_doubled, 1);
  EXPECT_EQ(evaluation.planes.missed_face_ids, std::vector<int>{14});
  EXPECT_DOUBLE_EQ(evaluation.planes.completeness, 5.0 / 6.0);

  // A face that the beams hardly hit can not be missed.
  input.truth_planes[4].num_points = 199;
  EXPECT_EQ(Evaluate(input, {}).planes.num_missed, 0);
}

TEST(PlaneMatchingTest, PiecesOfAWallThatDoNotOverlapAreNotDoubled) {
  const PlanePatch face = MakePatch(1, {1, 0, 0}, {0, 0, 0}, 4, 1.5);
  const PlanePatch left = MakePatch(2, {1, 0, 0}, {0, -2, 0}, 1.5, 1.5);
  const PlanePatch right = MakePatch(3, {1, 0, 0}, {0, 2, 0}, 1.5, 1.5);
  const PlaneEvaluation evaluation = MatchPlanes({left, right}, {face}, false, {});
  EXPECT_EQ(evaluation.num_matched, 2);
  EXPECT_EQ(evaluation.num_doubled, 0);
}

TEST(PlaneMatchingTest, FacingTellsTheSidesOfAThinWallApart) {
  const PlanePatch front = MakePatch(1, {1, 0, 0}, {0.05, 0, 0}, 4, 1.5);
  const PlanePatch back = MakePatch(2, {-1, 0, 0}, {-0.05, 0, 0}, 4, 1.5);
  // Nearer to the back, but seen from the front.
  const PlanePatch estimate = MakePatch(3, {1, 0, 0}, {-0.02, 0, 0}, 2, 1);
  const PlaneEvaluation evaluation = MatchPlanes({estimate}, {front, back}, false, {});
  EXPECT_EQ(evaluation.list.front().face_ids, std::vector<int>{1});
  EXPECT_NEAR(evaluation.list.front().distance_m, -0.07, 1e-12);
  EXPECT_EQ(evaluation.missed_face_ids, std::vector<int>{2});
}

TEST(PlaneMatchingTest, OneEstimateMayCoverCoplanarFaces) {
  const PlanePatch left = MakePatch(1, {1, 0, 0}, {0, -2.5, 0}, 2, 1.5);
  const PlanePatch right = MakePatch(2, {1, 0, 0}, {0.005, 2.5, 0}, 2, 1.5);
  const PlanePatch estimate = MakePatch(3, {1, 0, 0}, {0, 0, 0}, 4.5, 1.5);
  const PlaneEvaluation evaluation = MatchPlanes({estimate}, {left, right}, false, {});
  EXPECT_EQ(evaluation.num_matched, 1);
  EXPECT_EQ(evaluation.list.front().face_ids.size(), 2u);
  EXPECT_EQ(evaluation.num_missed, 0);
}

TEST(PlaneMatchingTest, ANicheIsNotTheWallAroundIt) {
  const PlanePatch wall = MakePatch(1, {1, 0, 0}, {0, 0, 0}, 4, 1.5);
  const PlanePatch niche = MakePatch(2, {1, 0, 0}, {-0.06, 0, 0}, 0.5, 1);
  const PlaneEvaluation evaluation = MatchPlanes({wall, niche}, {wall, niche}, false, {});
  EXPECT_EQ(evaluation.num_matched, 2);
  EXPECT_EQ(evaluation.list[0].face_ids, std::vector<int>{1});
  EXPECT_EQ(evaluation.list[1].face_ids, std::vector<int>{2});
}

TEST(PlaneMatchingTest, AnEstimateShowsAFaceThatItsPointsCanBeFrom) {
  const PlanePatch estimate = MakePatch(1, {1, 0, 0}, {0, 0, 0}, 4, 1.5);
  PlanePatch rail = MakePatch(2, {1, 0, 0}, {0.03, 0, 0}, 4, 1.5);
  rail.num_points = 20;
  const PlanePatch wall = MakePatch(3, {1, 0, 0}, {0, -2, 0}, 2, 1.5);
  EXPECT_EQ(FindBestFace(estimate, {rail, wall}, false, {}), 1);
}

TEST(PlaneMatchingTest, CoplanarFacesCountTogether) {
  const PlanePatch estimate = MakePatch(1, {1, 0, 0}, {0, 0, 0}, 4, 1.5);
  PlanePatch frame = MakePatch(2, {1, 0, 0}, {-0.025, -1, 0}, 3, 1.5);
  frame.num_points = 300;
  std::vector<PlanePatch> faces = {frame};
  for (int sash = 0; sash < 3; ++sash) {
    faces.push_back(MakePatch(3 + sash, {1, 0, 0}, {0, -2.0 + 2.0 * sash, 0}, 0.9, 1.5));
    faces.back().num_points = 300;
  }
  faces[2].num_points = 310;
  EXPECT_EQ(FindBestFace(estimate, faces, false, {}), 2);
}

TEST(EvaluationTest, PlanarRigsAreComparedFromAbove) {
  EvaluationInput input = PerfectInput(TrueFlatPose);
  input.figures.motion = "planar";
  // A planar rig knows no heights: poses at zero, walls as thin strips somewhere else.
  for (StampedPose& pose : input.trajectory) pose.world_from_body.translation.z() = 0.0;
  std::vector<PlanePatch> walls(input.planes.begin() + 2, input.planes.end());
  for (PlanePatch& wall : walls) {
    for (Eigen::Vector3d& corner : wall.outline) corner.z() = 7.0;
    wall.centre.z() = 7.0;
  }
  input.planes = walls;
  for (StampedPose& pose : input.trajectory) {
    if (pose.time_ns > 0) pose.world_from_body.translation.y() += 0.01;
  }
  const Evaluation evaluation = Evaluate(input, {});
  EXPECT_NEAR(evaluation.trajectory.unaligned.position_m.median, 0.01, 1e-6);
  EXPECT_LT(evaluation.trajectory.unaligned.rotation_deg.max, 1e-5);
  EXPECT_LT(evaluation.trajectory.aligned.position_m.median, 1e-4);
  EXPECT_EQ(evaluation.planes.num_matched, 4);
  EXPECT_EQ(evaluation.planes.num_missed, 0);
  EXPECT_DOUBLE_EQ(evaluation.planes.completeness, 1.0);
}

TEST(EvaluationTest, WritesJsonAndTable) {
  EvaluationInput input = PerfectInput();
  input.figures.residual_rms_m = 0.0217;
  const Evaluation evaluation = Evaluate(input, {});
  const std::string path = ::testing::TempDir() + "/plumbline_evaluation_test.json";
  WriteEvaluation(evaluation, path);
  std::ifstream file(path);
  const nlohmann::json json = nlohmann::json::parse(file);
  EXPECT_EQ(json["planes"]["matched"], 6);
  EXPECT_EQ(json["planes"]["list"].size(), 6u);
  EXPECT_EQ(json["residual_rms_m"], 0.0217);
  EXPECT_EQ(json["model_from_truth"]["anchor"], "reference_plane");
  EXPECT_EQ(json["trajectory"]["unaligned"]["position_m"]["rmse"],
            evaluation.trajectory.unaligned.position_m.rmse);
  EXPECT_TRUE(json["planes"]["angle_deg"].contains("rmse"));
  EXPECT_NE(EvaluationTable(evaluation).find("6 matched, 0 wrong"), std::string::npos);
  std::filesystem::remove(path);
  EXPECT_THROW(WriteEvaluation(evaluation, "/no/such/directory/evaluation.json"), Error);
}

TEST(EvaluationTest, ReadsTheFilesOfMapperAndSimulator) {
  namespace fs = std::filesystem;
  const EvaluationInput input = PerfectInput();
  const fs::path directory = fs::path(::testing::TempDir()) / "plumbline_evaluation_input";
  fs::remove_all(directory);
  {
    ResultDirectory result(directory.string());
    ResultWriter writer(result);
    writer.WriteTrajectory(input.trajectory);
    writer.WritePlanes(input.planes);
    Summary summary;
    summary.motion = "spatial";
    summary.reference_plane_id = 13;
    summary.variance_factor = 1.02;
    writer.WriteSummary(summary);
    writer.Finish();
    result.Commit();
  }
  WriteFileAtomically((directory / "truth_trajectory.tum").string(),
                      FormatTrajectory(input.truth_trajectory));
  WriteFileAtomically((directory / "truth_planes.json").string(),
                      FormatPlanes(input.truth_planes));
  const EvaluationInput read = ReadEvaluationInput(directory.string(), directory.string());
  EXPECT_EQ(read.figures.variance_factor, 1.02);
  const Evaluation evaluation = Evaluate(read, {});
  EXPECT_EQ(evaluation.frame.reference_face_id, 13);
  EXPECT_EQ(evaluation.planes.num_matched, 6);
  EXPECT_LT(evaluation.trajectory.unaligned.position_m.max, 1e-8);  // files hold 1e-9 m

  for (const char* summary : {"{", "{}", R"({"motion": "sideways"})", R"({"motion": 1})"}) {
    WriteFileAtomically((directory / "summary.json").string(), summary);
    EXPECT_THROW(ReadEvaluationInput(directory.string(), directory.string()), Error)
        << summary;
  }
  fs::remove(directory / "summary.json");
  EXPECT_THROW(ReadEvaluationInput(directory.string(), directory.string()), Error);
  fs::remove_all(directory);
}

}  // namespace
}  // namespace plumbline
