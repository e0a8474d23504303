#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "core/outputs/floor_plan.h"
#include "core/outputs/plan_paper.h"

namespace plumbline {

// Heights of texts on paper, mm.
inline constexpr double kRoomTextMm = 3.0;
inline constexpr double kSmallTextMm = 2.0;
inline constexpr double kStddevTextMm = 1.6;
inline constexpr double kDoorTextMm = 1.7;

// RoomLabel is a room's number, area and standard deviation, below each other.
struct RoomLabel {
  static constexpr double kCircleRadiusMm = 2.5;

  Eigen::Vector2d at = Eigen::Vector2d::Zero();  // its middle
  std::string area;                              // empty where it has no place
  std::string stddev;                            // so is this

  double height_mm() const;
  // The middle of the number's circle, and the middles of the texts' baselines.
  Eigen::Vector2d Circle() const;
  Eigen::Vector2d NumberAt() const;
  Eigen::Vector2d AreaAt() const;
  Eigen::Vector2d StddevAt() const;
};

// DimensionText is the length of a dimension, with its standard deviation where that has
// place.
struct DimensionText {
  TextBox box;
  std::string length;
  std::string stddev;
  std::optional<Eigen::Vector2d> leader_to;  // the line's middle, where the text stands apart

  // Begin of the leader: the nearer end of the text.
  Eigen::Vector2d LeaderFrom() const;
};

struct DoorText {
  TextBox box;
  std::string width;
};

// PlanTexts is where the texts of a storey's drawing stand. None lies on another one.
struct PlanTexts {
  std::vector<std::optional<DoorText>> doors;    // as the storey's doors
  std::vector<std::optional<RoomLabel>> labels;  // as its rooms
  std::vector<std::vector<std::optional<DimensionText>>>
      dimensions;  // as the rooms' dimensions
};

// Finds places for all texts: widths of doors stand in the doors, labels where the room is
// wide and no dimension line runs, lengths along their lines, else beside them within the
// room, first with and then without standard deviations. Where even that finds no place, a
// label is the number only, or left out, and so is a length or a width.
PlanTexts PlaceTexts(const StoreyPlan& storey, const Paper& paper);

// The middle of the baseline of a text in a box.
Eigen::Vector2d BaselineOf(const TextBox& box);

// The angle at which a text along a direction is read from below or from the right, degrees
// clockwise.
double ReadableAngle(const Eigen::Vector2d& along);

}  // namespace plumbline
