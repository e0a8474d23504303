#include "core/floor_plan/plan_svg.h"

#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>

#include "core/floor_plan/plan_drawing.h"

namespace plumbline {
namespace {

// Sizes on paper, mm.
constexpr double kMargin = 14.0;
constexpr double kFoot = 22.0;  // below the drawing: title and scale bar
constexpr double kMaxWidth = 380.0;
constexpr double kMaxHeight = 250.0;
constexpr double kRoomText = 3.0;
constexpr double kSmallText = 2.0;
constexpr double kDoorText = 1.7;
constexpr double kTick = 0.9;
constexpr int kScales[] = {20, 50, 100, 200, 500, 1000, 2000, 5000};

constexpr char kWallColour[] = "#2b2b2b";
constexpr char kThinWallColour[] = "#9a9a9a";
constexpr char kDimensionColour[] = "#1f5f99";
constexpr char kDoorColour[] = "#a33b1f";

std::string Number(double value) {
  char text[64];
  std::snprintf(text, sizeof(text), "%.2f", value + 0.0);
  return std::string(text) == "-0.00" ? "0.00" : text;
}

// Paper is where the model frame's points lie on paper: the same for all storeys, turned by 90
// degrees where the building is longer that way.
class Paper {
 public:
  explicit Paper(const FloorPlans& plan) {
    Eigen::AlignedBox2d box;
    for (const StoreyPlan& storey : plan.storeys) {
      for (const Room& room : storey.rooms) {
        for (const RoomEdge& edge : room.loops.front()) box.extend(edge.from);
      }
    }
    turned_ = box.sizes().y() > box.sizes().x();
    origin_ = turned_ ? Eigen::Vector2d(box.min().y(), box.max().x())
                      : Eigen::Vector2d(box.min().x(), box.max().y());
    if (turned_) origin_ = {box.min().y(), -box.min().x()};
    const Eigen::Vector2d size =
        turned_ ? Eigen::Vector2d(box.sizes().y(), box.sizes().x()) : box.sizes();
    for (const int scale : kScales) {
      scale_ = scale;
      mm_per_m_ = 1000.0 / scale;
      if (size.x() * mm_per_m_ <= kMaxWidth && size.y() * mm_per_m_ <= kMaxHeight) break;
    }
    width_ = std::max(120.0, size.x() * mm_per_m_ + 2.0 * kMargin);
    height_ = size.y() * mm_per_m_ + 2.0 * kMargin + kFoot;
  }

  Eigen::Vector2d At(const Eigen::Vector2d& p) const {
    const Eigen::Vector2d turned = Turn(p);
    return {kMargin + (turned.x() - origin_.x()) * mm_per_m_,
            kMargin + (origin_.y() - turned.y()) * mm_per_m_};
  }
  // Of a vector, y downwards as on paper.
  Eigen::Vector2d Direction(const Eigen::Vector2d& v) const {
    const Eigen::Vector2d turned = Turn(v);
    return {turned.x(), -turned.y()};
  }

  int scale() const { return scale_; }
  double mm_per_m() const { return mm_per_m_; }
  double width() const { return width_; }
  double height() const { return height_; }

 private:
  // Clockwise, so that the model frame's y axis points to the right.
  Eigen::Vector2d Turn(const Eigen::Vector2d& p) const {
    return turned_ ? Eigen::Vector2d(p.y(), -p.x()) : p;
  }

  bool turned_ = false;
  Eigen::Vector2d origin_ = Eigen::Vector2d::Zero();
  int scale_ = 100;
  double mm_per_m_ = 10.0;
  double width_ = 0.0;
  double height_ = 0.0;
};

class SvgText {
 public:
  explicit SvgText(const Paper& paper) : paper_(paper) {
    const std::string width = Number(paper.width());
    const std::string height = Number(paper.height());
    text_ =
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" +
        width + "mm\" height=\"" + height + "mm\" viewBox=\"0 0 " + width + " " + height +
        "\" font-family=\"Helvetica, Arial, sans-serif\">\n"
        "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n";
  }

  void Open(const std::string& attributes) { text_ += "<g " + attributes + ">\n"; }
  void Close() { text_ += "</g>\n"; }

  std::string Path(const std::vector<Eigen::Vector2d>& corners, bool closed) const {
    std::string d;
    for (size_t i = 0; i < corners.size(); ++i) {
      const Eigen::Vector2d p = paper_.At(corners[i]);
      d += (i == 0 ? "M" : "L") + Number(p.x()) + " " + Number(p.y());
    }
    return d + (closed ? "Z" : "");
  }
  void AddPath(const std::string& d, const std::string& attributes = "") {
    text_ += "<path d=\"" + d + "\"" + (attributes.empty() ? "" : " " + attributes) + "/>\n";
  }

  // Text on paper, with its middle at a point and turned clockwise.
  void AddText(const Eigen::Vector2d& at,
               double size,
               double angle_deg,
               const std::string& text,
               const std::string& attributes = "") {
    text_ += "<text x=\"" + Number(at.x()) + "\" y=\"" + Number(at.y()) + "\" font-size=\"" +
             Number(size) + "\" text-anchor=\"middle\"";
    if (angle_deg != 0.0) {
      text_ += " transform=\"rotate(" + Number(angle_deg) + " " + Number(at.x()) + " " +
               Number(at.y()) + ")\"";
    }
    text_ += (attributes.empty() ? "" : " " + attributes) + ">" + text + "</text>\n";
  }
  void Add(const std::string& element) { text_ += element + "\n"; }

  std::string Finish() { return std::move(text_) + "</svg>\n"; }

 private:
  const Paper& paper_;
  std::string text_;
};

std::vector<Eigen::Vector2d> CornersOf(const RoomLoop& loop) {
  std::vector<Eigen::Vector2d> corners;
  for (const RoomEdge& edge : loop) corners.push_back(edge.from);
  return corners;
}

std::string RoomPath(const SvgText& svg, const Room& room) {
  std::string d;
  for (const RoomLoop& loop : room.loops) d += svg.Path(CornersOf(loop), true);
  return d;
}

void DrawWalls(const StoreyPlan& storey, const Paper& paper, SvgText* svg) {
  // Walls of which one face was seen: a band round the rooms, most of it covered by what
  // follows.
  svg->Open("id=\"walls-one-face\" fill=\"none\" stroke=\"" + std::string(kThinWallColour) +
            "\" stroke-width=\"" + Number(2.0 * kDrawnThicknessM * paper.mm_per_m()) +
            "\" stroke-linejoin=\"miter\"");
  for (const Room& room : storey.rooms) {
    svg->AddPath(svg->Path(CornersOf(room.loops.front()), true));
  }
  for (const auto& outline : storey.solids) svg->AddPath(svg->Path(outline, true));
  svg->Close();
  std::string solids;
  for (const auto& outline : storey.solids) solids += svg->Path(outline, true);
  svg->AddPath(solids,
               "id=\"walls\" fill=\"" + std::string(kWallColour) +
                   "\" fill-rule=\"evenodd\" stroke=\"none\"");
  svg->Open("id=\"rooms\" fill-rule=\"evenodd\" stroke=\"" + std::string(kWallColour) +
            "\" stroke-width=\"0.25\"");
  for (const Room& room : storey.rooms) {
    svg->AddPath(RoomPath(*svg, room), room.entered ? "fill=\"#ffffff\"" : "fill=\"#ececec\"");
  }
  svg->Close();
}

double ReadableAngle(const Eigen::Vector2d& along) {
  double angle = std::atan2(along.y(), along.x()) * 180.0 / M_PI;
  constexpr double kUpright = 89.99;  // what is upright reads from the right
  if (angle > kUpright) angle -= 180.0;
  if (angle <= kUpright - 180.0) angle += 180.0;
  return angle;
}

Eigen::Vector2d UpFrom(double angle_deg) {
  const double angle = angle_deg * M_PI / 180.0;
  return {std::sin(angle), -std::cos(angle)};
}

void DrawDoorsAndWindows(const StoreyPlan& storey, const Paper& paper, SvgText* svg) {
  svg->Open("id=\"windows\" fill=\"#ffffff\" stroke=\"" + std::string(kWallColour) +
            "\" stroke-width=\"0.15\"");
  for (const PlanWindow& window : storey.windows) {
    const Eigen::Vector2d along = (window.to - window.from).normalized();
    const Eigen::Vector2d behind =
        kDrawnThicknessM * Eigen::Vector2d(-along.y(), along.x());  // off the seen side
    svg->AddPath(
        svg->Path({window.from, window.to, window.to + behind, window.from + behind}, true));
    svg->AddPath(svg->Path({window.from + 0.5 * behind, window.to + 0.5 * behind}, false));
  }
  svg->Close();
  svg->Open("id=\"doors\" stroke=\"" + std::string(kDoorColour) + "\" stroke-width=\"0.2\"");
  for (const PlanDoor& door : storey.doors) {
    const std::vector<Eigen::Vector2d> corners = GapCorners(door);
    svg->AddPath(svg->Path(corners, true), "fill=\"#ffffff\" stroke=\"#ffffff\"");
    svg->AddPath(svg->Path({corners[0], corners[3]}, false), "fill=\"none\"");
    svg->AddPath(svg->Path({corners[1], corners[2]}, false), "fill=\"none\"");
    svg->AddPath(svg->Path({corners[0], corners[1]}, false) +
                     svg->Path({corners[3], corners[2]}, false),
                 "fill=\"none\" stroke-dasharray=\"0.6 0.5\" stroke-width=\"0.12\"");
    const double angle = ReadableAngle(paper.Direction(door.to - door.from));
    const Eigen::Vector2d middle = 0.5 * (paper.At(corners[0]) + paper.At(corners[2]));
    svg->AddText(middle - 0.35 * kDoorText * UpFrom(angle),
                 kDoorText,
                 angle,
                 Number(door.width_m),
                 "fill=\"" + std::string(kDoorColour) + "\" stroke=\"none\"");
  }
  svg->Close();
}

void DrawDimension(const Dimension& dimension, const Paper& paper, SvgText* svg) {
  const Eigen::Vector2d from = paper.At(dimension.from);
  const Eigen::Vector2d to = paper.At(dimension.to);
  const Eigen::Vector2d along = (to - from).normalized();
  const Eigen::Vector2d tick =
      kTick * Eigen::Vector2d(along.x() + along.y(), along.y() - along.x());
  svg->AddPath(svg->Path({dimension.from, dimension.to}, false));
  for (const Eigen::Vector2d& end : {from, to}) {
    svg->AddPath("M" + Number(end.x() - tick.x()) + " " + Number(end.y() - tick.y()) + "L" +
                 Number(end.x() + tick.x()) + " " + Number(end.y() + tick.y()));
  }
  const double angle = ReadableAngle(along);
  svg->AddText(0.5 * (from + to) + 0.5 * UpFrom(angle),
               kSmallText,
               angle,
               LengthText(dimension.length_m) + " <tspan font-size=\"" +
                   Number(0.8 * kSmallText) + "\">\u00b1" + StddevText(dimension.stddev_m) +
                   " mm</tspan>",
               "fill=\"" + std::string(kDimensionColour) + "\" stroke=\"none\"");
}

void DrawTexts(const StoreyPlan& storey, const Paper& paper, SvgText* svg) {
  svg->Open("id=\"dimensions\" fill=\"none\" stroke=\"" + std::string(kDimensionColour) +
            "\" stroke-width=\"0.13\"");
  for (const Room& room : storey.rooms) {
    for (const Dimension& dimension : room.dimensions) DrawDimension(dimension, paper, svg);
  }
  svg->Close();
  svg->Open("id=\"labels\" fill=\"#000000\"");
  for (const Room& room : storey.rooms) {
    const Eigen::Vector2d at = paper.At(room.label);
    svg->Add("<circle cx=\"" + Number(at.x()) + "\" cy=\"" + Number(at.y() - 2.6) +
             "\" r=\"2.5\" fill=\"#ffffff\" stroke=\"#000000\" stroke-width=\"0.2\"/>");
    svg->AddText(at + Eigen::Vector2d(0.0, -1.55),
                 kRoomText,
                 0.0,
                 std::to_string(room.number),
                 "font-weight=\"bold\"");
    svg->AddText(at + Eigen::Vector2d(0.0, 3.4), kRoomText, 0.0, AreaText(room) + " m\u00b2");
    svg->AddText(
        at + Eigen::Vector2d(0.0, 6.0),
        kSmallText,
        0.0,
        "\u00b1" + AreaStddevText(room) + " m\u00b2" + (room.entered ? "" : ", not entered"));
  }
  svg->Close();
}

// Title, scale bar and the directions of the model frame.
void DrawFoot(const FloorPlans& plan, size_t storey, const Paper& paper, SvgText* svg) {
  const double top = paper.height() - kFoot;
  const double step_m = paper.scale() <= 100 ? 1.0 : paper.scale() / 100.0;
  svg->Open("id=\"scale\" stroke=\"#000000\" stroke-width=\"0.2\"");
  for (int i = 0; i < 5; ++i) {
    svg->Add("<rect x=\"" + Number(kMargin + i * step_m * paper.mm_per_m()) + "\" y=\"" +
             Number(top + 6.0) + "\" width=\"" + Number(step_m * paper.mm_per_m()) +
             "\" height=\"1.4\" fill=\"" + (i % 2 == 0 ? "#000000" : "#ffffff") + "\"/>");
  }
  svg->Close();
  for (int i = 0; i <= 5; ++i) {
    char text[32];
    std::snprintf(text, sizeof(text), i == 5 ? "%g m" : "%g", i * step_m);
    svg->AddText({kMargin + i * step_m * paper.mm_per_m(), top + 10.4}, kSmallText, 0.0, text);
  }
  const StoreyLevel& level = plan.storeys[storey].level;
  std::string title = "Floor plan";
  if (plan.storeys.size() > 1) {
    title += ", storey " + std::to_string(storey + 1) + " of " +
             std::to_string(plan.storeys.size());
  }
  char notes[256];
  std::snprintf(
      notes,
      sizeof(notes),
      "Scale 1:%d. Clear areas and distances in m, \u00b1: stated standard deviation. "
      "Grey walls: one face seen, thickness not known.",
      paper.scale());
  svg->AddText({kMargin, top + 15.0},
               kRoomText,
               0.0,
               title,
               "font-weight=\"bold\" style=\"text-anchor:start\"");
  svg->AddText({kMargin, top + 18.6}, kSmallText, 0.0, notes, "style=\"text-anchor:start\"");
  if (level.has_floor) {
    std::snprintf(notes,
                  sizeof(notes),
                  "Floor at %.2f m of the model frame, cut %.2f m above it.",
                  level.floor_m,
                  level.section_m() - level.floor_m);
    svg->AddText({paper.width() - kMargin, top + 18.6},
                 kSmallText,
                 0.0,
                 notes,
                 "style=\"text-anchor:end\"");
  }
  const Eigen::Vector2d origin(paper.width() - kMargin - 10.0, top + 6.0);
  svg->Open("id=\"axes\" stroke=\"#000000\" stroke-width=\"0.2\"");
  const char* const names[] = {"x", "y"};
  for (int i = 0; i < 2; ++i) {
    const Eigen::Vector2d along = paper.Direction(Eigen::Vector2d::Unit(i));
    const Eigen::Vector2d tip = origin + 6.0 * along;
    svg->AddPath("M" + Number(origin.x()) + " " + Number(origin.y()) + "L" + Number(tip.x()) +
                 " " + Number(tip.y()));
    const Eigen::Vector2d text = origin + 7.6 * along + Eigen::Vector2d(0.0, 0.7);
    svg->AddText(text, kSmallText, 0.0, names[i], "stroke=\"none\"");
  }
  svg->Close();
}

}  // namespace

std::string FormatSvg(const FloorPlans& plan, size_t storey) {
  const Paper paper(plan);
  SvgText svg(paper);
  DrawWalls(plan.storeys[storey], paper, &svg);
  DrawDoorsAndWindows(plan.storeys[storey], paper, &svg);
  DrawTexts(plan.storeys[storey], paper, &svg);
  DrawFoot(plan, storey, paper, &svg);
  return svg.Finish();
}

}  // namespace plumbline
