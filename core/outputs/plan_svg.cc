#include "core/outputs/plan_svg.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

#include "core/outputs/plan_drawing.h"
#include "core/outputs/plan_paper.h"
#include "core/outputs/plan_texts.h"

namespace plumbline {
namespace {

constexpr double kTickMm = 0.9;

constexpr char kWallColour[] = "#2b2b2b";
constexpr char kThinWallColour[] = "#9a9a9a";
constexpr char kDimensionColour[] = "#1f5f99";
constexpr char kDoorColour[] = "#a33b1f";

std::string Number(double value) {
  char text[64];
  std::snprintf(text, sizeof(text), "%.2f", value + 0.0);
  return std::string(text) == "-0.00" ? "0.00" : text;
}

class SvgText {
 public:
  explicit SvgText(const Paper& paper) : paper_(paper) {
    const std::string width = Number(paper.width_mm());
    const std::string height = Number(paper.height_mm());
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

  // A line between two points on paper.
  void AddLine(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    AddPath("M" + Number(a.x()) + " " + Number(a.y()) + "L" + Number(b.x()) + " " +
            Number(b.y()));
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
  // Text that stands in a box.
  void AddText(const TextBox& box,
               double size,
               const std::string& text,
               const std::string& attributes) {
    AddText(BaselineOf(box), size, box.angle_deg, text, attributes);
  }
  // A white box.
  void AddPaperBox(const TextBox& box) {
    const Eigen::Vector2d x = 0.5 * box.width * box.Along();
    const Eigen::Vector2d y = 0.5 * box.height * box.Up();
    std::string d;
    for (const Eigen::Vector2d& corner : {Eigen::Vector2d(-x - y),
                                          Eigen::Vector2d(x - y),
                                          Eigen::Vector2d(x + y),
                                          Eigen::Vector2d(y - x)}) {
      const Eigen::Vector2d p = box.centre + corner;
      d += (d.empty() ? "M" : "L") + Number(p.x()) + " " + Number(p.y());
    }
    AddPath(d + "Z", "fill=\"#ffffff\" stroke=\"none\"");
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
  for (const Room& room : storey.rooms) svg->AddPath(RoomPath(*svg, room));
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

// Openings in floors: dashed boxes with their diagonals.
void DrawFloorOpenings(const StoreyPlan& storey, SvgText* svg) {
  svg->Open("id=\"floor-openings\" fill=\"none\" stroke=\"" + std::string(kWallColour) +
            "\" stroke-width=\"0.15\" stroke-dasharray=\"1.2 0.6\"");
  for (const Room& room : storey.rooms) {
    for (const RoomFloorOpening& opening : room.floor_openings) {
      const Eigen::Vector2d a = opening.box.min();
      const Eigen::Vector2d c = opening.box.max();
      const Eigen::Vector2d b(c.x(), a.y());
      const Eigen::Vector2d d(a.x(), c.y());
      svg->AddPath(svg->Path({a, b, c, d}, true) + svg->Path({a, c}, false) +
                   svg->Path({b, d}, false));
    }
  }
  svg->Close();
}

void DrawDoorsAndWindows(const StoreyPlan& storey, SvgText* svg) {
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
  }
  svg->Close();
}

void DrawDimension(const Dimension& dimension, const Paper& paper, SvgText* svg) {
  const Eigen::Vector2d from = paper.At(dimension.from);
  const Eigen::Vector2d to = paper.At(dimension.to);
  const Eigen::Vector2d along = (to - from).normalized();
  const Eigen::Vector2d tick =
      kTickMm * Eigen::Vector2d(along.x() + along.y(), along.y() - along.x());
  svg->AddLine(from, to);
  for (const Eigen::Vector2d& end : {from, to}) svg->AddLine(end - tick, end + tick);
}

void DrawDimensionText(const DimensionText& text, SvgText* svg) {
  if (text.leader_to) svg->AddLine(text.LeaderFrom(), *text.leader_to);
  std::string content = text.length;
  if (!text.stddev.empty()) {
    content +=
        " <tspan font-size=\"" + Number(kStddevTextMm) + "\">" + text.stddev + "</tspan>";
  }
  svg->AddText(text.box,
               kSmallTextMm,
               content,
               "fill=\"" + std::string(kDimensionColour) + "\" stroke=\"none\"");
}

void DrawLabel(const Room& room, const RoomLabel& label, SvgText* svg) {
  const Eigen::Vector2d circle = label.Circle();
  svg->Add("<circle cx=\"" + Number(circle.x()) + "\" cy=\"" + Number(circle.y()) + "\" r=\"" +
           Number(RoomLabel::kCircleRadiusMm) +
           "\" fill=\"#ffffff\" stroke=\"#000000\" stroke-width=\"0.2\"/>");
  svg->AddText(
      label.NumberAt(), kRoomTextMm, 0.0, std::to_string(room.number), "font-weight=\"bold\"");
  if (!label.area.empty()) svg->AddText(label.AreaAt(), kRoomTextMm, 0.0, label.area);
  if (!label.stddev.empty()) svg->AddText(label.StddevAt(), kSmallTextMm, 0.0, label.stddev);
}

void DrawTexts(const StoreyPlan& storey, const Paper& paper, SvgText* svg) {
  const PlanTexts texts = PlaceTexts(storey, paper);
  svg->Open("id=\"dimensions\" fill=\"none\" stroke=\"" + std::string(kDimensionColour) +
            "\" stroke-width=\"0.13\"");
  for (size_t i = 0; i < storey.rooms.size(); ++i) {
    for (size_t k = 0; k < storey.rooms[i].dimensions.size(); ++k) {
      DrawDimension(storey.rooms[i].dimensions[k], paper, svg);
      if (texts.dimensions[i][k]) DrawDimensionText(*texts.dimensions[i][k], svg);
    }
  }
  svg->Close();
  svg->Open("id=\"door-widths\" fill=\"" + std::string(kDoorColour) + "\"");
  for (const std::optional<DoorText>& text : texts.doors) {
    if (!text) continue;
    // In a thin wall it stands on the door's lines.
    svg->AddPaperBox(text->box);
    svg->AddText(text->box, kDoorTextMm, text->width, "");
  }
  svg->Close();
  svg->Open("id=\"labels\" fill=\"#000000\"");
  for (size_t i = 0; i < storey.rooms.size(); ++i) {
    if (texts.labels[i]) DrawLabel(storey.rooms[i], *texts.labels[i], svg);
  }
  svg->Close();
}

// Draws the legend, in a row below the drawing.
void DrawLegend(double top, SvgText* svg) {
  constexpr double kSignMm = 8.0;
  constexpr double kHighMm = 2.4;
  struct Entry {
    std::string sign;  // elements of 8 mm x 2.4 mm from the upper left corner
    const char* text;
  };
  const std::string wall = std::string("fill=\"") + kWallColour + "\"";
  const std::string thin = std::string("fill=\"") + kThinWallColour + "\"";
  const std::string line =
      std::string(" fill=\"none\" stroke=\"") + kDoorColour + "\" stroke-width=\"0.2\"/>";
  const std::string box = "width=\"8\" height=\"2.4\" ";
  const std::vector<Entry> entries = {
      {"<rect " + box + wall + "/>", "wall, both faces seen"},
      {"<rect " + box + thin + "/>", "one face seen, thickness not known"},
      {"<path d=\"M0 0v2.4M8 0v2.4\"" + line +
           "<path d=\"M0 0h8M0 2.4h8\" stroke-dasharray=\"0.6 0.5\"" + line,
       "door or opening, width"},
      {"<path d=\"M0 0h8v2.4h-8zM0 1.2h8\" fill=\"none\" stroke=\"" +
           std::string(kWallColour) + "\" stroke-width=\"0.15\"/>",
       "window"},
      {"<rect " + box + "fill=\"#ececec\" stroke=\"" + kWallColour +
           "\" stroke-width=\"0.25\"/>",
       "room not entered"}};
  svg->Open("id=\"legend\"");
  double x = Paper::kMarginMm;
  for (const Entry& entry : entries) {
    svg->Add("<g transform=\"translate(" + Number(x) + " " + Number(top) + ")\">" +
             entry.sign + "</g>");
    x += kSignMm + 1.0;
    svg->AddText({x, top + 0.5 * kHighMm + 0.36 * kSmallTextMm},
                 kSmallTextMm,
                 0.0,
                 entry.text,
                 "style=\"text-anchor:start\"");
    x += TextWidth(entry.text, kSmallTextMm) + 3.0;
  }
  svg->Close();
}

// The directions of the model frame; where north is, no map knows.
void DrawAxes(const Paper& paper, double top, SvgText* svg) {
  constexpr double kLengthMm = 7.0;
  constexpr double kHeadMm = 1.4;
  // The axis that points up needs place above.
  const bool points_up = std::min(paper.Direction(Eigen::Vector2d::UnitX()).y(),
                                  paper.Direction(Eigen::Vector2d::UnitY()).y()) < -0.5;
  const Eigen::Vector2d origin(paper.width_mm() - Paper::kMarginMm - 10.0,
                               top + (points_up ? 15.0 : 8.0));
  svg->Open("id=\"axes\" fill=\"none\" stroke=\"#000000\" stroke-width=\"0.2\"");
  const char* const names[] = {"x", "y"};
  for (int i = 0; i < 2; ++i) {
    const Eigen::Vector2d along = paper.Direction(Eigen::Vector2d::Unit(i));
    const Eigen::Vector2d across(0.35 * along.y(), -0.35 * along.x());
    const Eigen::Vector2d tip = origin + kLengthMm * along;
    svg->AddLine(origin, tip);
    svg->AddLine(tip, tip - kHeadMm * (along + across));
    svg->AddLine(tip, tip - kHeadMm * (along - across));
    const Eigen::Vector2d text =
        origin + (kLengthMm + 1.6) * along + Eigen::Vector2d(0.0, 0.7);
    svg->AddText(text, kSmallTextMm, 0.0, names[i], "fill=\"#000000\" stroke=\"none\"");
  }
  svg->Close();
}

// Legend, scale bar, title and axes.
void DrawFoot(const FloorPlans& plan, size_t storey, const Paper& paper, SvgText* svg) {
  const double top = paper.height_mm() - Paper::kFootMm;
  DrawLegend(top, svg);
  DrawAxes(paper, top, svg);
  const double step_m = paper.scale() / 100.0;
  svg->Open("id=\"scale\" stroke=\"#000000\" stroke-width=\"0.2\"");
  for (int i = 0; i < 5; ++i) {
    svg->Add("<rect x=\"" + Number(Paper::kMarginMm + i * step_m * paper.mm_per_m()) +
             "\" y=\"" + Number(top + 9.0) + "\" width=\"" +
             Number(step_m * paper.mm_per_m()) + "\" height=\"1.4\" fill=\"" +
             (i % 2 == 0 ? "#000000" : "#ffffff") + "\"/>");
  }
  svg->Close();
  for (int i = 0; i <= 5; ++i) {
    char text[32];
    std::snprintf(text, sizeof(text), i == 5 ? "%g m" : "%g", i * step_m);
    svg->AddText({Paper::kMarginMm + i * step_m * paper.mm_per_m(), top + 13.4},
                 kSmallTextMm,
                 0.0,
                 text);
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
      "Scale 1:%d. Clear areas and distances in m, \u00b1: stated standard deviation.",
      paper.scale());
  svg->AddText({Paper::kMarginMm, top + 19.0},
               kRoomTextMm,
               0.0,
               title,
               "font-weight=\"bold\" style=\"text-anchor:start\"");
  svg->AddText(
      {Paper::kMarginMm, top + 23.0}, kSmallTextMm, 0.0, notes, "style=\"text-anchor:start\"");
  if (level.has_floor) {
    std::snprintf(notes,
                  sizeof(notes),
                  "Floor at %.2f m of the model frame, cut %.2f m above it.",
                  level.floor_m,
                  level.section_m() - level.floor_m);
    svg->AddText({paper.width_mm() - Paper::kMarginMm, top + 23.0},
                 kSmallTextMm,
                 0.0,
                 notes,
                 "style=\"text-anchor:end\"");
  }
}

}  // namespace

namespace {

std::string Escaped(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    escaped += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : std::string(1, c);
  }
  return escaped;
}

// A red band over the drawing of a map that is not consistent, within the margin.
void DrawWarning(const MapOrigin& origin, const Paper& paper, SvgText* svg) {
  const std::string warning = WarningText(origin);
  if (warning.empty()) return;
  constexpr double kBandMm = 0.5 * Paper::kMarginMm;
  // A narrow sheet takes the text smaller.
  const double size = std::min(
      kRoomTextMm, kRoomTextMm * (paper.width_mm() - 2.0) / TextWidth(warning, kRoomTextMm));
  svg->Open("id=\"warning\"");
  svg->Add("<rect x=\"0\" y=\"0\" width=\"" + Number(paper.width_mm()) + "\" height=\"" +
           Number(kBandMm) + "\" fill=\"#c81e1e\"/>");
  svg->AddText({0.5 * paper.width_mm(), 0.5 * kBandMm + 0.36 * size},
               size,
               0.0,
               warning,
               "fill=\"#ffffff\" font-weight=\"bold\"");
  svg->Close();
}

}  // namespace

std::string FormatSvg(const FloorPlans& plan, size_t storey) {
  const Paper paper(plan);
  SvgText svg(paper);
  DrawWalls(plan.storeys[storey], paper, &svg);
  DrawFloorOpenings(plan.storeys[storey], &svg);
  DrawDoorsAndWindows(plan.storeys[storey], &svg);
  DrawTexts(plan.storeys[storey], paper, &svg);
  DrawFoot(plan, storey, paper, &svg);
  svg.AddText({Paper::kMarginMm, paper.height_mm() - 1.6},
              kSmallTextMm,
              0.0,
              Escaped(OriginText(plan.origin)),
              "style=\"text-anchor:start\"");
  DrawWarning(plan.origin, paper, &svg);
  return svg.Finish();
}

}  // namespace plumbline
