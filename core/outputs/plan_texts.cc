#include "core/outputs/plan_texts.h"

#include <algorithm>
#include <cmath>

#include "core/outputs/plan_drawing.h"
#include "core/outputs/room_outlines.h"

namespace plumbline {
namespace {

constexpr double kLineWidthMm = 0.3;  // that texts keep off

// A line on paper as the narrow box that texts keep off.
TextBox BoxOfLine(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d along = b - a;
  return {0.5 * (a + b),
          along.norm(),
          kLineWidthMm,
          std::atan2(along.y(), along.x()) * 180.0 / M_PI};
}

std::vector<RoomLoop> OnPaper(const Room& room, const Paper& paper) {
  std::vector<RoomLoop> loops = room.loops;
  for (RoomLoop& loop : loops) {
    for (RoomEdge& edge : loop) edge.from = paper.At(edge.from);
  }
  return loops;
}

// Whether the whole box lies in the room, as points of its upper and lower border show.
bool IsIn(const std::vector<RoomLoop>& loops, const TextBox& box) {
  constexpr int kSteps = 8;
  for (int i = 0; i <= kSteps; ++i) {
    const double x = box.width * (static_cast<double>(i) / kSteps - 0.5);
    for (const double y : {-0.5 * box.height, 0.5 * box.height}) {
      if (!IsInside(loops, box.centre + x * box.Along() + y * box.Up())) return false;
    }
  }
  return true;
}

// TextPlacer keeps what is placed already.
class TextPlacer {
 public:
  TextPlacer(const StoreyPlan& storey, const Paper& paper) : storey_(storey), paper_(paper) {}

  PlanTexts Place() {
    for (const PlanDoor& door : storey_.doors) PlaceDoor(door);
    for (const Room& room : storey_.rooms) {
      loops_.push_back(OnPaper(room, paper_));
      for (const Dimension& dimension : room.dimensions) {
        lines_.push_back(BoxOfLine(paper_.At(dimension.from), paper_.At(dimension.to)));
      }
    }
    for (size_t i = 0; i < storey_.rooms.size(); ++i) PlaceLabel(i);
    for (size_t i = 0; i < storey_.rooms.size(); ++i) {
      auto& placed = texts_.dimensions.emplace_back();
      for (const Dimension& dimension : storey_.rooms[i].dimensions) {
        placed.push_back(PlaceDimension(dimension, loops_[i]));
      }
    }
    return std::move(texts_);
  }

 private:
  bool IsFree(const TextBox& box, bool off_lines) const {
    const auto meets = [&box](const TextBox& other) { return Overlap(box, other); };
    return std::none_of(taken_.begin(), taken_.end(), meets) &&
           (!off_lines || std::none_of(lines_.begin(), lines_.end(), meets));
  }

  void PlaceDoor(const PlanDoor& door) {
    const std::vector<Eigen::Vector2d> corners = GapCorners(door);
    DoorText text;
    text.width = DoorWidthText(door.width_m);
    text.box = {0.5 * (paper_.At(corners[0]) + paper_.At(corners[2])),
                TextWidth(text.width, kDoorTextMm),
                kDoorTextMm,
                ReadableAngle(paper_.Direction(door.to - door.from))};
    if (IsFree(text.box, false)) {
      taken_.push_back(text.box);
      texts_.doors.emplace_back(text);
    } else {
      texts_.doors.emplace_back();  // on that of another door
    }
  }

  // A label's box about its middle.
  static TextBox LabelBox(const RoomLabel& label) {
    return {label.at,
            std::max({2.0 * RoomLabel::kCircleRadiusMm + kLineWidthMm,
                      TextWidth(label.area, kRoomTextMm),
                      TextWidth(label.stddev, kSmallTextMm)}),
            label.height_mm(),
            0.0};
  }

  // At the nearest place to the room's own one that is free, within the room: off its
  // dimension lines, else on these; whole, else without the standard deviation, else the
  // number only.
  void PlaceLabel(size_t index) {
    const Room& room = storey_.rooms[index];
    const std::string area = AreaText(room) + " m\u00b2";
    const std::string stddev =
        "\u00b1" + AreaStddevText(room) + " m\u00b2" + (room.entered ? "" : ", not entered");
    const RoomLabel variants[] = {{{}, area, stddev}, {{}, area, ""}, {{}, "", ""}};
    for (const RoomLabel& variant : variants) {
      for (const bool off_lines : {true, false}) {
        RoomLabel label = variant;
        for (const Eigen::Vector2d& offset : LabelOffsets()) {
          label.at = paper_.At(room.label) + offset;
          const TextBox box = LabelBox(label);
          if (!IsIn(loops_[index], box) || !IsFree(box, off_lines)) continue;
          taken_.push_back(box);
          texts_.labels.push_back(label);
          return;
        }
      }
    }
    texts_.labels.emplace_back();
  }

  // Places about a point, the nearest first.
  static const std::vector<Eigen::Vector2d>& LabelOffsets() {
    static const auto* const offsets = [] {
      constexpr int kReachMm = 30;
      auto* made = new std::vector<Eigen::Vector2d>;
      for (int x = -kReachMm; x <= kReachMm; ++x) {
        for (int y = -kReachMm; y <= kReachMm; ++y) made->emplace_back(x, y);
      }
      std::stable_sort(made->begin(), made->end(), [](const auto& a, const auto& b) {
        return a.squaredNorm() < b.squaredNorm();
      });
      return made;
    }();
    return *offsets;
  }

  std::optional<DimensionText> PlaceDimension(const Dimension& dimension,
                                              const std::vector<RoomLoop>& loops) {
    const Eigen::Vector2d from = paper_.At(dimension.from);
    const Eigen::Vector2d to = paper_.At(dimension.to);
    DimensionText text;
    text.length = LengthText(dimension.length_m);
    const std::string stddev = "\u00b1" + StddevText(dimension.stddev_m) + " mm";
    for (const bool off_lines : {true, false}) {
      for (const std::string& shown : {stddev, std::string()}) {
        text.stddev = shown;
        text.box.width = TextWidth(text.length, kSmallTextMm);
        if (!shown.empty()) text.box.width += TextWidth(" " + shown, kStddevTextMm);
        text.box.height = kSmallTextMm;
        text.box.angle_deg = ReadableAngle(to - from);
        if (PlaceAlong(from, to, loops, off_lines, &text) ||
            PlaceApart(0.5 * (from + to), loops, off_lines, &text)) {
          taken_.push_back(text.box);
          return text;
        }
      }
    }
    return std::nullopt;
  }

  // On one of both sides of the dimension's line, as near to its middle as may be.
  bool PlaceAlong(const Eigen::Vector2d& from,
                  const Eigen::Vector2d& to,
                  const std::vector<RoomLoop>& loops,
                  bool off_lines,
                  DimensionText* text) const {
    constexpr double kGapMm = 0.3;
    constexpr int kSteps = 40;
    if ((to - from).norm() < text->box.width) return false;
    const double off_mm = 0.5 * (text->box.height + kLineWidthMm) + kGapMm;
    for (int i = 0; i <= kSteps; ++i) {
      const double share = 0.5 + (i % 2 == 0 ? 0.5 : -0.5) * ((i + 1) / 2) / (kSteps / 2 + 1);
      for (const double side : {1.0, -1.0}) {
        text->box.centre = from + share * (to - from) + side * off_mm * text->box.Up();
        if (IsIn(loops, text->box) && IsFree(text->box, off_lines)) return true;
      }
    }
    return false;
  }

  // Level, within the room, with a line that leads to the middle of the dimension's line.
  bool PlaceApart(const Eigen::Vector2d& middle,
                  const std::vector<RoomLoop>& loops,
                  bool off_lines,
                  DimensionText* text) const {
    constexpr double kNearestMm = 2.5;
    constexpr double kFarthestMm = 14.0;
    constexpr double kStepMm = 1.0;
    constexpr int kDirections = 16;
    DimensionText apart = *text;
    apart.box.angle_deg = 0.0;
    for (double away = kNearestMm; away <= kFarthestMm; away += kStepMm) {
      for (int i = 0; i < kDirections; ++i) {
        const double angle = 2.0 * M_PI * i / kDirections;
        const Eigen::Vector2d direction(std::cos(angle), std::sin(angle));
        apart.box.centre = middle + away * direction;
        apart.box.centre.x() += 0.5 * apart.box.width * direction.x();
        if (!IsIn(loops, apart.box) || !IsFree(apart.box, off_lines)) continue;
        apart.leader_to = middle;
        *text = apart;
        return true;
      }
    }
    return false;
  }

  const StoreyPlan& storey_;
  const Paper& paper_;
  std::vector<std::vector<RoomLoop>> loops_;  // of each room, on paper
  std::vector<TextBox> taken_;
  std::vector<TextBox> lines_;
  PlanTexts texts_;
};

// Size of a room's label, mm.
constexpr double kCircleHeightMm = 5.4;
constexpr double kAreaHeightMm = 4.0;
constexpr double kStddevHeightMm = 2.6;

// A point below the upper end of a label.
Eigen::Vector2d Below(const RoomLabel& label, double y) {
  return label.at + Eigen::Vector2d(0.0, y - 0.5 * label.height_mm());
}

}  // namespace

double RoomLabel::height_mm() const {
  return kCircleHeightMm + (area.empty() ? 0.0 : kAreaHeightMm) +
         (stddev.empty() ? 0.0 : kStddevHeightMm);
}
Eigen::Vector2d RoomLabel::Circle() const { return Below(*this, 0.5 * kCircleHeightMm); }
Eigen::Vector2d RoomLabel::NumberAt() const { return Below(*this, 3.75); }
Eigen::Vector2d RoomLabel::AreaAt() const { return Below(*this, kCircleHeightMm + 3.3); }
Eigen::Vector2d RoomLabel::StddevAt() const {
  return Below(*this, kCircleHeightMm + kAreaHeightMm + 1.9);
}

Eigen::Vector2d DimensionText::LeaderFrom() const {
  const Eigen::Vector2d half = 0.5 * box.width * box.Along();
  return box.centre + ((*leader_to - box.centre).dot(half) < 0.0 ? -1.0 : 1.0) * half;
}

Eigen::Vector2d BaselineOf(const TextBox& box) {
  constexpr double kBelowMiddle = 0.36;  // of digits, in heights of the text
  return box.centre - kBelowMiddle * box.height * box.Up();
}

double ReadableAngle(const Eigen::Vector2d& along) {
  double angle = std::atan2(along.y(), along.x()) * 180.0 / M_PI;
  constexpr double kUpright = 80.0;  // what is upright, about, reads from the right
  if (angle > kUpright) angle -= 180.0;
  if (angle <= kUpright - 180.0) angle += 180.0;
  return angle;
}

PlanTexts PlaceTexts(const StoreyPlan& storey, const Paper& paper) {
  return TextPlacer(storey, paper).Place();
}

}  // namespace plumbline
