#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "core/outputs/floor_plan.h"
#include "core/outputs/plan_drawing.h"
#include "core/util/json_file.h"
#include "core/util/time.h"
#include "simulation/sensing/simulate_recording.h"
#include "simulation/world/floor_plan.h"
#include "simulation/world/planar_region.h"
#include "test/testing/paths.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

const fs::path kConfigs = ConfigsDir();

// An experiment that walks through each of the shipped buildings.
constexpr const char* kExperiments[] = {
    "corridor",
    "large_building",
    "mounts/nodding_corner",
    "office",
    "ramp_and_arc",
    "room",
    "robustness/apse",
    "robustness/attic_12_deg",
    "robustness/attic_35_deg",
    "robustness/curved_corridor",
    "robustness/duplex_a_stairs",
    "robustness/furniture",
    "robustness/fzk_ground",
    "robustness/glass",
    "robustness/hall",
    "robustness/halls_gentle_ramp",
    "robustness/halls_ramp",
    "robustness/look_alike_floors",
    "robustness/look_alike_wings",
    "robustness/ramp",
    "robustness/round_room",
    "robustness/smooth_corridor",
    "robustness/two_storeys",
};

std::string FileOf(const std::string& experiment) {
  return (kConfigs / "experiments" / (experiment + ".yaml")).string();
}

fs::path BuildingOf(const std::string& experiment) {
  const std::string file = FileOf(experiment);
  const std::string key = "building: ";
  std::ifstream lines(file);
  for (std::string line; std::getline(lines, line);) {
    if (line.compare(0, key.size(), key) != 0) continue;
    return (fs::path(file).parent_path() / line.substr(key.size())).lexically_normal();
  }
  return {};
}

// What a map without errors would give the floor plan: true faces and poses, ranges with the
// scanners' noise. Of long walks fewer lines are taken: as many as of a minute.
FloorPlanInput TrueMapOf(const std::string& experiment_name) {
  constexpr double kNumScans = 600.0;
  constexpr int kBeams = 270;
  constexpr int64_t kPoseStepNs = 100'000'000;
  Experiment experiment = ReadExperiment(FileOf(experiment_name));
  const Path path(experiment.path);
  const double duration_s = SecondsBetween(path.start_ns(), path.end_ns());
  for (Scanner& scanner : experiment.rig.scanners) {
    scanner.beams = kBeams;
    scanner.scan_rate_hz = std::min(10.0, std::max(0.3, kNumScans / duration_s));
  }
  experiment.moving = {};
  const Simulator simulator(experiment);
  FloorPlanInput input;
  input.rig = experiment.rig;
  input.start_ns = path.start_ns();
  for (int64_t at = path.start_ns(); at <= path.end_ns(); at += kPoseStepNs) {
    input.poses.push_back({at, path.PoseAt(at)});
  }
  TruthPlanes truth(experiment.building);
  simulator.Run([&](const PerfectScanLine& perfect) {
    const ScanLine& line = perfect.scan_line;
    const Scanner& scanner = experiment.rig.scanners[static_cast<size_t>(line.scanner_index)];
    const ScanLine noisy = AddNoise(perfect, scanner, experiment.noise, 1);
    truth.Add(perfect, noisy, scanner.time_offset_s);
    for (size_t i = 0; i < noisy.ranges.size(); ++i) {
      const double range = static_cast<double>(noisy.ranges[i]);
      if (!scanner.IsValidRange(range) || !perfect.beams[i]) continue;
      const int64_t time_ns = std::clamp(
          line.BeamTime(static_cast<int>(i)) + NanosecondsFromSeconds(scanner.time_offset_s),
          path.start_ns(),
          path.end_ns());
      const double angle = noisy.BeamAngle(static_cast<int>(i));
      const Eigen::Vector3d p_world =
          path.PoseAt(time_ns) *
          (scanner.body_from_scanner *
           Eigen::Vector3d(range * std::cos(angle), range * std::sin(angle), 0.0));
      CloudPoint point;
      point.p_world = p_world.cast<float>();
      point.time_s = SecondsBetween(path.start_ns(), time_ns);
      point.plane_id = perfect.beams[i]->face_id;
      point.scanner = static_cast<uint8_t>(line.scanner_index);
      input.points.push_back(point);
    }
  });
  const std::vector<PlanePatch> faces = truth.Patches();
  Eigen::Index num_parameters = 0;
  for (const PlanePatch& face : faces) {
    num_parameters += static_cast<Eigen::Index>(FieldsOf(face.type).parameters.size());
  }
  constexpr double kVariance = 1e-8;  // of surfaces that are true
  input.planes = PlaneCovariance(
      faces, kVariance * Eigen::MatrixXd::Identity(num_parameters, num_parameters));
  return input;
}

bool IsIn(const std::vector<Eigen::Vector2d>& polygon, const Eigen::Vector2d& p) {
  bool inside = false;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d& a = polygon[i];
    const Eigen::Vector2d& b = polygon[(i + 1) % polygon.size()];
    if ((a.y() > p.y()) != (b.y() > p.y()) &&
        p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x())) {
      inside = !inside;
    }
  }
  return inside;
}

bool IsInGap(const PlanDoor& door, const Eigen::Vector2d& p) {
  constexpr double kBesideM = 0.05;
  const Eigen::Vector2d along = (door.to - door.from).normalized();
  const double s = along.dot(p - door.from);
  const double depth = -door.normal.dot(p - door.from);
  const double thickness = door.depth_m > 0.0 ? door.depth_m : kDrawnThicknessM;
  return s > 0.0 && s < (door.to - door.from).norm() && depth > -kBesideM &&
         depth < thickness + kBesideM;
}

bool IsDrawnSolid(const StoreyPlan& storey, const Eigen::Vector2d& p) {
  bool is_solid = false;
  for (const auto& outline : storey.solids) is_solid ^= IsIn(outline, p);
  return is_solid && std::none_of(storey.doors.begin(),
                                  storey.doors.end(),
                                  [&](const PlanDoor& door) { return IsInGap(door, p); });
}

bool IsOnStorey(const StoreyPlan& storey, const Eigen::Vector3d& p) {
  constexpr double kLowestM = 0.5;
  const StoreyHeights heights = storey.level.At(p.head<2>());
  return p.z() > heights.floor_m + kLowestM && p.z() < heights.top_m;
}

// An opening of a building file, in plan.
struct TrueDoor {
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  Eigen::Vector2d along = Eigen::Vector2d::UnitX();
  double width_m = 0.0;
};

std::vector<TrueDoor> DoorsOf(const FloorPlan& plan) {
  std::vector<TrueDoor> doors;
  for (const Wall& wall : plan.walls) {
    const Eigen::Vector2d along = (wall.to - wall.from).normalized();
    for (const Opening& opening : wall.openings) {
      doors.push_back({wall.from + opening.position_m * along, along, opening.width_m});
    }
  }
  return doors;
}

// Whether a step of the rig leads through the opening.
bool LeadsThrough(const Eigen::Vector2d& from,
                  const Eigen::Vector2d& to,
                  const TrueDoor& door) {
  const Eigen::Vector2d normal(-door.along.y(), door.along.x());
  const double a = normal.dot(from - door.middle);
  const double b = normal.dot(to - door.middle);
  if ((a > 0.0) == (b > 0.0)) return false;
  const Eigen::Vector2d p = from + a / (a - b) * (to - from);
  return std::abs(door.along.dot(p - door.middle)) < 0.5 * door.width_m;
}

// What a storey's walls enclose, with its doors shut.
std::vector<PolygonWithHoles> RoomsOf(const FloorPlan& plan) {
  PlanarRegion region;
  for (const Polygon2& outline : plan.outlines) region.Join(outline);
  for (const Hall& hall : plan.halls) region.Join(hall.corners);
  for (const Ramp& ramp : plan.ramps) region.Join(ramp.corners);
  for (const Polygon2& solid : plan.solids) region.Subtract(solid);
  for (const Wall& wall : plan.walls) {
    for (const Polygon2& footprint : wall.FootprintsBeside({})) region.Subtract(footprint);
  }
  for (const FloorOpening& opening : plan.floor_openings) region.Subtract(opening.corners);
  return region.Polygons();
}

double AreaOf(const Polygon2& polygon) {
  double twice = 0.0;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d& a = polygon[i];
    const Eigen::Vector2d& b = polygon[(i + 1) % polygon.size()];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return 0.5 * std::abs(twice);
}

double AreaOf(const PolygonWithHoles& room) {
  double area_m2 = AreaOf(room.outer);
  for (const Polygon2& hole : room.holes) area_m2 -= AreaOf(hole);
  return area_m2;
}

std::vector<FloorPlan>::const_iterator NearestStorey(const std::vector<FloorPlan>& truth,
                                                     const StoreyPlan& storey) {
  return std::min_element(
      truth.begin(), truth.end(), [&](const FloorPlan& a, const FloorPlan& b) {
        return std::abs(a.floor_height - storey.level.floor_m) <
               std::abs(b.floor_height - storey.level.floor_m);
      });
}

class ShippedBuildingTest : public ::testing::TestWithParam<const char*> {};

TEST_P(ShippedBuildingTest, NoPoseLiesInADrawnWallAndDoorsAreTheBuildings) {
  const FloorPlanInput input = TrueMapOf(GetParam());
  const FloorPlans plan = MakeFloorPlan(input);
  std::vector<FloorPlan> truth;
  const fs::path building = BuildingOf(GetParam());
  if (building.extension() == ".yaml") truth = ReadFloorPlans(building.string());
  for (const StoreyPlan& storey : plan.storeys) {
    int num_in_walls = 0;
    for (const StampedPose& pose : input.poses) {
      const Eigen::Vector3d& p = pose.world_from_body.translation;
      if (IsOnStorey(storey, p) && IsDrawnSolid(storey, p.head<2>())) ++num_in_walls;
    }
    EXPECT_EQ(num_in_walls, 0);
    const auto of_storey = NearestStorey(truth, storey);
    if (of_storey == truth.end()) continue;
    const std::vector<TrueDoor> doors = DoorsOf(*of_storey);
    for (const TrueDoor& door : doors) {
      bool is_passed = false;
      for (size_t i = 1; i < input.poses.size(); ++i) {
        const Eigen::Vector3d& from = input.poses[i - 1].world_from_body.translation;
        const Eigen::Vector3d& to = input.poses[i].world_from_body.translation;
        is_passed = is_passed || (IsOnStorey(storey, from) && IsOnStorey(storey, to) &&
                                  LeadsThrough(from.head<2>(), to.head<2>(), door));
      }
      if (!is_passed) continue;
      const PlanDoor* nearest = nullptr;
      double least_m = 0.5 * door.width_m;
      for (const PlanDoor& drawn : storey.doors) {
        const double away_m = (0.5 * (drawn.from + drawn.to) - door.middle).norm();
        if (away_m < least_m) {
          least_m = away_m;
          nearest = &drawn;
        }
      }
      ASSERT_NE(nearest, nullptr) << "no door at " << door.middle.transpose();
      EXPECT_NEAR(nearest->width_m, door.width_m, 4.0 * nearest->width_stddev_m)
          << "at " << door.middle.transpose();
    }
    // Panes of glass are openings below lintels, too, but wider than doors.
    constexpr double kMaxDoorM = 1.5;
    constexpr double kAwayM = 0.2;
    for (const PlanDoor& drawn : storey.doors) {
      if (drawn.width_m > kMaxDoorM) continue;
      const Eigen::Vector2d middle = 0.5 * (drawn.from + drawn.to);
      EXPECT_TRUE(std::any_of(doors.begin(),
                              doors.end(),
                              [&](const TrueDoor& door) {
                                return (middle - door.middle).norm() <
                                       0.5 * door.width_m + kAwayM;
                              }))
          << "made up at " << middle.transpose();
    }
  }
}

std::string TestName(const ::testing::TestParamInfo<const char*>& info) {
  return fs::path(info.param).filename().string();
}

INSTANTIATE_TEST_SUITE_P(All,
                         ShippedBuildingTest,
                         ::testing::ValuesIn(kExperiments),
                         TestName);

TEST(ShippedBuildings, HaveAnExperimentEach) {
  std::set<fs::path> walked;
  for (const char* experiment : kExperiments) walked.insert(BuildingOf(experiment));
  for (const auto& entry : fs::directory_iterator(kConfigs / "buildings")) {
    const std::string extension = entry.path().extension().string();
    if (extension != ".yaml" && extension != ".ply") continue;
    EXPECT_EQ(walked.count(entry.path().lexically_normal()), 1u) << entry.path();
  }
}

// Doors and windows of an architect's house: what has panes is a window, the door to the
// terrace too, whose panes reach the floor. One window is not seen well enough by so few scan
// lines.
TEST(ShippedBuildings, WindowsOfTheHouseAreItsPanes) {
  constexpr double kAwayM = 0.25;  // of a face from the panes and leaves within its wall
  const std::string storey_name = "Erdgeschoss";
  const Json elements =
      ReadJsonFile<Json>((kConfigs / "buildings" / "AC20-FZK-Haus.json").string())
          .at("elements");
  const auto box_of = [](const Json& element) {
    const auto corner = [&](const char* key) {
      return Eigen::Vector2d(element.at(key)[0].get<double>(),
                             element.at(key)[1].get<double>());
    };
    return Eigen::AlignedBox2d(corner("min"), corner("max"));
  };
  const StoreyPlan storey = MakeFloorPlan(TrueMapOf("robustness/fzk_ground")).storeys.at(0);
  size_t num_drawn = 0;
  for (const auto& [number, element] : elements.items()) {
    const std::string type = element.at("type");
    if (element.at("storey") != storey_name || (type != "IfcWindow" && type != "IfcDoor")) {
      continue;
    }
    SCOPED_TRACE(element.at("name").get<std::string>());
    const Eigen::AlignedBox2d box = box_of(element);
    const auto is_here = [&](const auto& drawn) {
      return box.exteriorDistance(0.5 * (drawn.from + drawn.to)) < kAwayM;
    };
    const auto window = std::find_if(storey.windows.begin(), storey.windows.end(), is_here);
    if (element.at("glass_triangles") == 0) {
      EXPECT_EQ(window, storey.windows.end());
      continue;
    }
    EXPECT_EQ(std::count_if(storey.doors.begin(), storey.doors.end(), is_here), 0);
    if (window == storey.windows.end()) continue;
    ++num_drawn;
    EXPECT_EQ(window->reaches_floor, type == "IfcDoor");
    if (type == "IfcDoor") continue;  // its frame is wide, and parts the panes
    EXPECT_NEAR((window->to - window->from).norm(),
                box.sizes().maxCoeff(),
                3.0 * window->width_stddev_m);
  }
  EXPECT_GE(num_drawn, 9u);
  EXPECT_EQ(storey.windows.size(), num_drawn);
}

// Rooms of buildings that the plan has as one, too, and of which little was not seen.
TEST(ShippedBuildings, AreasAreRightWithinTheirDeviations) {
  constexpr double kMaxUnseenShare = 0.05;
  constexpr double kRoundingM2 = 0.005;
  int num_rooms = 0;
  int num_within_two = 0;
  for (const char* experiment : {"corridor",
                                 "office",
                                 "ramp_and_arc",
                                 "room",
                                 "robustness/apse",
                                 "robustness/curved_corridor",
                                 "robustness/furniture",
                                 "robustness/look_alike_wings",
                                 "robustness/round_room",
                                 "robustness/two_storeys"}) {
    const std::vector<FloorPlan> truth = ReadFloorPlans(BuildingOf(experiment).string());
    for (const StoreyPlan& storey : MakeFloorPlan(TrueMapOf(experiment)).storeys) {
      for (const PolygonWithHoles& true_room : RoomsOf(*NearestStorey(truth, storey))) {
        const auto is_here = [&](const Room& room) {
          return IsIn(true_room.outer, room.label);
        };
        if (std::count_if(storey.rooms.begin(), storey.rooms.end(), is_here) != 1) continue;
        const Room& room = *std::find_if(storey.rooms.begin(), storey.rooms.end(), is_here);
        if (room.unseen_m > kMaxUnseenShare * room.perimeter_m) continue;
        const double off_m2 = std::abs(room.area_m2 - AreaOf(true_room));
        ++num_rooms;
        if (off_m2 <= 2.0 * room.area_stddev_m2 + kRoundingM2) {
          ++num_within_two;
        } else {
          std::printf("%s, room %d: off by %.3f m2, stated %.3f\n",
                      experiment,
                      room.number,
                      off_m2,
                      room.area_stddev_m2);
        }
      }
    }
  }
  EXPECT_GE(num_rooms, 20);
  EXPECT_GE(num_within_two, 0.95 * num_rooms);
}

}  // namespace
}  // namespace plumbline
