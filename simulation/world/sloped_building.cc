#include "simulation/world/sloped_building.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <deque>
#include <optional>

#include "core/util/error.h"
#include "simulation/world/column_faces.h"
#include "simulation/world/furniture.h"

namespace plumbline {
namespace {

constexpr double kFar = 1e5;  // m; beyond all buildings

// A part of the plan that has to change what is free somewhere. One that does not is a mistake
// of the plan: it would be left out without a word.
struct Part {
  std::string location;  // "file:line"
  std::string mistake;   // in words, where it changes nothing
  bool changes = false;
};

// A prism whose ends may slope. Without corners it has no sides.
struct Block {
  Polygon2 corners;
  FreeInterval heights;
  Part* part = nullptr;  // to which it belongs, or none that is looked at

  bool IsAbove(const Eigen::Vector2d& place) const {
    return corners.empty() || Contains(corners, place);
  }
};

bool IsSame(const HeightPlane& a, const HeightPlane& b) {
  return a.at_origin == b.at_origin && a.gradient == b.gradient;
}

bool IsSame(const FreeColumn& a, const FreeColumn& b) {
  return std::equal(a.begin(),
                    a.end(),
                    b.begin(),
                    b.end(),
                    [](const FreeInterval& x, const FreeInterval& y) {
                      return IsSame(x.bottom, y.bottom) && IsSame(x.top, y.top);
                    });
}

// Frees or fills an interval for a part of the plan, which may be null.
template <typename Change>
void ChangeFor(Part* part,
               const Change& free_or_fill,
               const FreeInterval& interval,
               const Eigen::Vector2d& place,
               FreeColumn* column) {
  if (part == nullptr || part->changes) {
    free_or_fill(interval, place, column);
    return;
  }
  const FreeColumn before = *column;
  free_or_fill(interval, place, column);
  part->changes = !IsSame(before, *column);
}

FreeInterval Between(double bottom, double top) {
  return {HeightPlane::Level(bottom), HeightPlane::Level(top)};
}

FreeInterval From(const HeightPlane& bottom) { return {bottom, HeightPlane::Level(kFar)}; }

// One storey as blocks that are freed and filled, in this order.
struct Storey {
  std::vector<Block> rooms;     // freed
  std::vector<Block> ramps;     // free in place of rooms
  std::vector<Block> roof;      // filled
  std::vector<Block> walls;     // filled; solids too
  std::vector<Block> openings;  // freed between this storey's floor and the ceiling below

  // Free heights before walls stand.
  FreeColumn RoomsAt(const Eigen::Vector2d& place) const {
    FreeColumn column;
    for (const Block& room : rooms) {
      if (room.IsAbove(place)) Free(room.heights, place, &column);
    }
    for (const Block& ramp : ramps) {
      if (ramp.IsAbove(place)) column = {ramp.heights};
    }
    for (const Block& block : roof) {
      ChangeFor(block.part, Fill, block.heights, place, &column);
    }
    return column;
  }

  FreeColumn FreeAt(const Eigen::Vector2d& place) const {
    FreeColumn column = RoomsAt(place);
    if (column.empty()) return column;
    for (const Block& wall : walls) {
      if (wall.IsAbove(place)) Fill(wall.heights, place, &column);
    }
    return column;
  }

  double FloorAt(const Eigen::Vector2d& place, double otherwise) const {
    const FreeColumn column = RoomsAt(place);
    return column.empty() ? otherwise : column.front().bottom.At(place);
  }
};

// add_part returns a part of the plan that changes nothing yet.
template <typename AddPart>
Storey MakeStorey(const FloorPlan& plan, const AddPart& add_part) {
  Storey storey;
  for (const Polygon2& outline : plan.outlines) {
    storey.rooms.push_back({outline, Between(plan.floor_height, plan.ceiling_height)});
  }
  for (const Hall& hall : plan.halls) {
    storey.rooms.push_back({hall.corners, Between(hall.floor_height, hall.ceiling_height)});
  }
  for (const Ramp& ramp : plan.ramps) {
    storey.ramps.push_back({ramp.corners, {ramp.floor, ramp.ceiling}});
  }
  for (const Roof& roof : plan.roofs) {
    Part* part = add_part(roof.location, "the roof lies above all rooms of its storey");
    for (const HeightPlane& plane : roof.planes) {
      storey.roof.push_back({{}, From(plane), part});
    }
  }
  for (const Polygon2& solid : plan.solids) {
    storey.walls.push_back({solid, Between(-kFar, kFar)});
  }
  for (const Wall& wall : plan.walls) {
    for (const Polygon2& footprint : wall.FootprintsBeside(wall.openings)) {
      storey.walls.push_back({footprint, Between(-kFar, kFar)});
    }
    // Lintels begin at the openings' heights above the floor in their middle.
    const Eigen::Vector2d along = (wall.to - wall.from).normalized();
    for (const Opening& opening : wall.openings) {
      const double half = opening.width_m / 2;
      const double floor =
          storey.FloorAt(wall.from + opening.position_m * along, plan.floor_height);
      storey.walls.push_back(
          {wall.Footprint(opening.position_m - half, opening.position_m + half),
           From(HeightPlane::Level(floor + opening.height_m))});
    }
  }
  for (const FloorOpening& opening : plan.floor_openings) {
    storey.openings.push_back(
        {opening.corners,
         {},
         add_part(opening.location,
                  "the floor opening lies nowhere above one room and below another")});
  }
  return storey;
}

std::vector<Block> BlocksOf(const Stairs& stairs, Part* owner) {
  const Eigen::Vector2d from = stairs.from.head<2>();
  const Eigen::Vector2d to = stairs.to.head<2>();
  const double length = (to - from).norm();
  const auto part = [&](double begin_m, double end_m) {
    return RectangleAlong(from, to, stairs.width_m, begin_m, end_m);
  };
  const double rise = stairs.to.z() - stairs.from.z();
  const HeightPlane foot = HeightPlane::Level(stairs.from.z());
  const HeightPlane underside =
      HeightPlane::Rising(stairs.from, stairs.to).RaisedBy(-stairs.thickness_m);
  // Up to here the flight stands on its foot.
  const double solid_m = stairs.thickness_m == 0.0
                             ? length
                             : std::min(length, stairs.thickness_m / rise * length);
  std::vector<Block> blocks;
  for (int i = 0; i < stairs.num_steps; ++i) {
    const double begin = i * length / stairs.num_steps;
    const double end = (i + 1) * length / stairs.num_steps;
    const HeightPlane tread =
        HeightPlane::Level(stairs.from.z() + (i + 1) * rise / stairs.num_steps);
    if (begin < solid_m) {
      blocks.push_back({part(begin, std::min(end, solid_m)), {foot, tread}, owner});
    }
    if (end > solid_m) {
      blocks.push_back({part(std::max(begin, solid_m), end), {underside, tread}, owner});
    }
  }
  return blocks;
}

// Lines of the plan between which one order of planes holds.
class LineCollector {
 public:
  void Add(const Block& block) {
    AddPolygon(block.corners);
    for (const HeightPlane& plane : {block.heights.bottom, block.heights.top}) {
      if (std::abs(plane.at_origin) < kFar) sheets_.push_back({plane, BoxOf(block.corners)});
    }
  }

  void AddPolygon(const Polygon2& corners) {
    for (size_t i = 0; i < corners.size(); ++i) {
      lines_.push_back({corners[i], corners[(i + 1) % corners.size()]});
      extent_.extend(corners[i]);
    }
  }

  // With the lines where two planes cross above the boxes of both.
  std::vector<PlanLine> Lines() const {
    std::vector<PlanLine> lines = lines_;
    for (size_t i = 0; i < sheets_.size(); ++i) {
      for (size_t j = 0; j < i; ++j) {
        const HeightPlane& a = sheets_[i].plane;
        const HeightPlane& b = sheets_[j].plane;
        const auto box = sheets_[i].box.intersection(sheets_[j].box).intersection(extent_);
        if (box.isEmpty()) continue;
        const auto line = Clipped({a.at_origin - b.at_origin, a.gradient - b.gradient}, box);
        if (line) lines.push_back(*line);
      }
    }
    return lines;
  }

 private:
  using Box = Eigen::AlignedBox2d;
  struct Sheet {
    HeightPlane plane;
    Box box;
  };

  static Box BoxOf(const Polygon2& corners) {
    if (corners.empty()) return {Eigen::Vector2d(-kFar, -kFar), Eigen::Vector2d(kFar, kFar)};
    Box box;
    for (const Eigen::Vector2d& corner : corners) box.extend(corner);
    return box;
  }

  // The line of height zero of a plane, within a box.
  static std::optional<PlanLine> Clipped(const HeightPlane& difference, const Box& box) {
    const double slope = difference.gradient.norm();
    if (slope < kSamePlane) return std::nullopt;
    const Eigen::Vector2d up = difference.gradient / slope;
    const Eigen::Vector2d along(-up.y(), up.x());
    const Eigen::Vector2d foot = -difference.at_origin / slope * up;
    double begin = -kFar;
    double end = kFar;
    for (int axis = 0; axis < 2; ++axis) {
      if (std::abs(along[axis]) < 1e-12) {
        if (foot[axis] < box.min()[axis] || foot[axis] > box.max()[axis]) return std::nullopt;
        continue;
      }
      const double at_min = (box.min()[axis] - foot[axis]) / along[axis];
      const double at_max = (box.max()[axis] - foot[axis]) / along[axis];
      begin = std::max(begin, std::min(at_min, at_max));
      end = std::min(end, std::max(at_min, at_max));
    }
    if (end - begin < kSamePlane) return std::nullopt;
    return PlanLine{foot + begin * along, foot + end * along};
  }

  std::vector<PlanLine> lines_;
  std::vector<Sheet> sheets_;
  Box extent_;
};

// All storeys of a building.
class StoreyStack {
 public:
  explicit StoreyStack(const std::vector<FloorPlan>& plans) {
    const auto add_part = [this](const std::string& location, const std::string& mistake) {
      parts_.push_back({location, mistake});
      return &parts_.back();
    };
    for (const FloorPlan& plan : plans) {
      storeys_.push_back(MakeStorey(plan, add_part));
      for (const Stairs& stairs : plan.stairs) {
        Part* part = add_part(stairs.location, "the stairs stand in no room");
        const std::vector<Block> blocks = BlocksOf(stairs, part);
        stairs_.insert(stairs_.end(), blocks.begin(), blocks.end());
      }
    }
  }

  StoreyStack(const StoreyStack&) = delete;  // blocks point to parts
  StoreyStack& operator=(const StoreyStack&) = delete;

  const Storey& storey(size_t index) const { return storeys_[index]; }

  // Marks the parts that change something at the place.
  FreeColumn FreeAt(const Eigen::Vector2d& place) const {
    FreeColumn column;
    for (const Storey& storey : storeys_) {
      for (const FreeInterval& interval : storey.FreeAt(place)) Free(interval, place, &column);
    }
    for (size_t i = 1; i < storeys_.size(); ++i) {
      for (const Block& opening : storeys_[i].openings) {
        if (!opening.IsAbove(place)) continue;
        const FreeColumn below = storeys_[i - 1].RoomsAt(place);
        const FreeColumn above = storeys_[i].RoomsAt(place);
        if (below.empty() || above.empty()) continue;
        ChangeFor(
            opening.part, Free, {below.back().top, above.front().bottom}, place, &column);
      }
    }
    if (column.empty()) return column;
    for (const Block& step : stairs_) {
      if (step.IsAbove(place)) ChangeFor(step.part, Fill, step.heights, place, &column);
    }
    return column;
  }

  // An error when a part has changed nothing anywhere, all places having been looked at.
  void CheckParts() const {
    for (const Part& part : parts_) {
      if (!part.changes) throw Error(part.location + ": " + part.mistake);
    }
  }

  std::vector<PlanLine> Lines() const {
    LineCollector collector;
    for (const Storey& storey : storeys_) {
      for (const auto* blocks : {&storey.rooms, &storey.ramps, &storey.roof, &storey.walls}) {
        for (const Block& block : *blocks) collector.Add(block);
      }
      for (const Block& opening : storey.openings) {
        collector.AddPolygon(opening.corners);
      }
    }
    for (const Block& step : stairs_) collector.Add(step);
    return collector.Lines();
  }

 private:
  std::deque<Part> parts_;
  std::vector<Storey> storeys_;
  std::vector<Block> stairs_;
};

}  // namespace

Building MakeSlopedBuilding(const std::vector<FloorPlan>& storeys) {
  const StoreyStack stack(storeys);
  ColumnPlan plan;
  plan.location = storeys.front().location;
  plan.lines = stack.Lines();
  plan.free_at = [&](const Eigen::Vector2d& place) { return stack.FreeAt(place); };
  for (const FloorPlan& storey : storeys) {
    plan.circles.insert(plan.circles.end(), storey.circles.begin(), storey.circles.end());
  }
  Building building;
  building.floor_height = storeys.front().floor_height;
  building.ceiling_height = storeys.back().ceiling_height;
  building.faces = MakeColumnFaces(plan);
  if (building.faces.empty()) {
    throw Error(plan.location + ": the building has no free space");
  }
  stack.CheckParts();
  for (size_t i = 0; i < storeys.size(); ++i) {
    for (const Furniture& piece : storeys[i].furniture) {
      const double floor = stack.storey(i).FloorAt(piece.position, storeys[i].floor_height);
      AddFurniture(piece, floor, &building.faces);
    }
  }
  return building;
}

}  // namespace plumbline
