#include "core/outputs/floor_plan.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "core/outputs/beam_evidence.h"
#include "core/outputs/floor_openings.h"
#include "core/outputs/plan_scales.h"
#include "core/outputs/room_measures.h"
#include "core/outputs/room_outlines.h"
#include "core/outputs/storey_doors.h"
#include "core/outputs/storey_planner.h"
#include "core/result/result_files.h"
#include "core/result/result_reader.h"
#include "core/util/error.h"

namespace plumbline {
namespace {

constexpr double kNoiseSigmas = 5.0;  // of a beam's range: nearer to its end it does not pass

std::vector<Eigen::Vector2d> PosesIn(const StoreyLevel& level,
                                     const std::vector<StampedPose>& poses) {
  std::vector<Eigen::Vector2d> in_storey;
  for (const StampedPose& pose : poses) {
    const Eigen::Vector3d& p = pose.world_from_body.translation;
    const StoreyHeights heights = level.At(p.head<2>());
    if (level.has_floor && (p.z() < heights.floor_m + kBesideM || p.z() > heights.top_m)) {
      continue;
    }
    in_storey.push_back(p.head<2>());
  }
  return in_storey;
}

// The length of the rig's way in a room, and when it came there first.
struct Visit {
  double way_m = 0.0;
  size_t first = std::numeric_limits<size_t>::max();
};

Visit VisitOf(const Room& room, const std::vector<Eigen::Vector2d>& poses) {
  Visit visit;
  for (size_t i = 0; i < poses.size(); ++i) {
    if (!IsInside(room.loops, poses[i])) continue;
    visit.first = std::min(visit.first, i);
    if (i > 0) visit.way_m += (poses[i] - poses[i - 1]).norm();
  }
  return visit;
}

// Whether a region is a room: the rig was in it, or walls enclose it.
bool IsRoom(const Room& room) {
  constexpr double kMinAreaM2 = 1.0;
  constexpr double kMaxUnseenShare = 0.3;
  return room.area_m2 >= kMinAreaM2 &&
         (room.entered || room.unseen_m <= kMaxUnseenShare * room.perimeter_m);
}

StoreyPlan PlanOf(const FloorPlanInput& input,
                  const BeamOrigins& origins,
                  const StoreyLevel& level) {
  const std::vector<PlanePatch>& planes = input.planes.planes();
  StoreyPlan plan;
  plan.level = level;
  std::vector<WallFace> faces = FindWallFaces(planes, input.points, level);
  if (faces.empty()) return plan;
  const double margin_m = std::max(kSameM, kNoiseSigmas * MaxRangeNoise(input.rig));
  const FreeGrid free =
      CollectEvidence(planes, input.points, origins, level, margin_m, &faces);
  const std::vector<Eigen::Vector2d> poses = PosesIn(level, input.poses);
  NoteWay(poses, &faces);
  const StoreyRegions regions = PlanStorey(std::move(faces), free, poses);
  std::vector<bool> kept;
  std::vector<std::pair<size_t, Room>> rooms;  // with the first visit
  for (int i = 0; i < regions.num_rooms; ++i) {
    Room room;
    room.loops = TraceRoom(i, regions, planes, level.section_m());
    const Visit visit = VisitOf(room, poses);
    room.entered = visit.way_m >= kMinWallM;
    MeasureRoom(input.planes, level, &room);
    kept.push_back(IsRoom(room));
    if (kept.back()) {
      const size_t first = room.entered ? visit.first : std::numeric_limits<size_t>::max();
      rooms.emplace_back(first, std::move(room));
    }
  }
  std::stable_sort(rooms.begin(), rooms.end(), [](const auto& a, const auto& b) {
    return a.first != b.first ? a.first < b.first : a.second.area_m2 > b.second.area_m2;
  });
  for (auto& [first, room] : rooms) {
    room.number = static_cast<int>(plan.rooms.size()) + 1;
    plan.rooms.push_back(std::move(room));
  }
  FindFloorOpenings(planes, input.points, origins, level, &plan.rooms);
  plan.doors = FindDoors(regions, planes, plan.rooms);
  plan.windows = FindWindows(regions, planes, plan.rooms);
  plan.walls = FindWalls(input.planes, level, plan.rooms);
  plan.solids = FindSolids(kept, regions, planes, level.section_m());
  return plan;
}

}  // namespace

FloorPlanInput ReadFloorPlanInput(const std::string& result_directory,
                                  const std::string& rig_file) {
  FloorPlanInput input;
  std::string rig_used = result_directory + "/" + kRigCalibrated;
  if (!std::filesystem::exists(rig_used)) rig_used = result_directory + "/" + kRigUsed;
  if (rig_file.empty() && !std::filesystem::exists(rig_used)) {
    throw Error(rig_used + ": is missing: the map was made by an earlier version, name its " +
                "rig file with --rig");
  }
  input.rig = ReadRig(rig_file.empty() ? rig_used : rig_file);
  input.origin = ReadMapOrigin(result_directory + "/summary.json");
  input.start_ns = ReadStartTime(result_directory + "/summary.json");
  input.planes = ReadPlaneCovariance(result_directory);
  input.poses = ReadTrajectory(result_directory + "/trajectory.tum");
  input.points = ReadMapCloud(result_directory + "/map.ply");
  return input;
}

FloorPlans MakeFloorPlan(const FloorPlanInput& input) {
  const BeamOrigins origins(input.rig, input.poses, input.start_ns);
  FloorPlans plan;
  plan.origin = input.origin;
  for (const StoreyLevel& level :
       FindStoreys(input.planes.planes(), input.poses, input.points)) {
    StoreyPlan storey = PlanOf(input, origins, level);
    if (!storey.rooms.empty()) plan.storeys.push_back(std::move(storey));
  }
  if (plan.storeys.empty()) {
    throw Error("no floor plan: the map has no room that walls enclose");
  }
  return plan;
}

}  // namespace plumbline
