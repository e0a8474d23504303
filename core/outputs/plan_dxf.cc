#include "core/outputs/plan_dxf.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <optional>
#include <utility>

#include "core/outputs/plan_drawing.h"
#include "core/outputs/plan_paper.h"
#include "core/outputs/plan_texts.h"

namespace plumbline {
namespace {

// Texts have the sizes and places that they have on a sheet of this scale.
constexpr int kScale = 75;
constexpr double kMPerMm = 1e-3 * kScale;
constexpr double kCapital = 0.72;  // of a text's size: its height in DXF is that of capitals
constexpr double kTickM = 0.08;

struct Layer {
  const char* name;
  int colour;  // AutoCAD colour index
};
constexpr Layer kLayers[] = {{"WALLS", 7},
                             {"ROOMS", 5},
                             {"DOORS", 1},
                             {"WINDOWS", 4},
                             {"DIMENSIONS", 8},
                             {"TEXT", 7},
                             {"WARNING", 1}};

// DxfText writes pairs of a group code and a value, a line each.
class DxfText {
 public:
  void Add(int code, const std::string& value) {
    text_ += std::to_string(code) + "\n" + value + "\n";
  }
  void Add(int code, int value) { Add(code, std::to_string(value)); }
  void Add(int code, double value) {
    char text[64];
    std::snprintf(text, sizeof(text), "%.4f", value);
    Add(code, std::string(text));
  }
  void AddPoint(int code, const Eigen::Vector2d& p) {
    Add(code, p.x());
    Add(code + 10, p.y());
    Add(code + 20, 0.0);
  }

  void Header() {
    Add(0, "SECTION");
    Add(2, "HEADER");
    Add(9, "$ACADVER");
    Add(1, "AC1009");
    Add(9, "$INSUNITS");
    Add(70, 6);  // metres
    Add(0, "ENDSEC");
    Add(0, "SECTION");
    Add(2, "TABLES");
    Add(0, "TABLE");
    Add(2, "LTYPE");
    Add(70, 1);
    Add(0, "LTYPE");
    Add(2, "CONTINUOUS");
    Add(70, 0);
    Add(3, "Solid line");
    Add(72, 65);
    Add(73, 0);
    Add(40, 0.0);
    Add(0, "ENDTAB");
    Add(0, "TABLE");
    Add(2, "LAYER");
    Add(70, static_cast<int>(std::size(kLayers)));
    for (const Layer& layer : kLayers) {
      Add(0, "LAYER");
      Add(2, layer.name);
      Add(70, 0);
      Add(62, layer.colour);
      Add(6, "CONTINUOUS");
    }
    Add(0, "ENDTAB");
    Add(0, "ENDSEC");
    Add(0, "SECTION");
    Add(2, "ENTITIES");
  }

  void Line(const char* layer, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    Add(0, "LINE");
    Add(8, layer);
    AddPoint(10, a);
    AddPoint(11, b);
  }

  void ClosedLine(const char* layer, const std::vector<Eigen::Vector2d>& corners) {
    Add(0, "POLYLINE");
    Add(8, layer);
    Add(66, 1);
    AddPoint(10, Eigen::Vector2d::Zero());
    Add(70, 1);
    for (const Eigen::Vector2d& corner : corners) {
      Add(0, "VERTEX");
      Add(8, layer);
      AddPoint(10, corner);
    }
    Add(0, "SEQEND");
    Add(8, layer);
  }

  // Centred on a point of its baseline. size_mm: on paper. angle_deg: to the left.
  void Text(const char* layer,
            const Eigen::Vector2d& at,
            double size_mm,
            double angle_deg,
            const std::string& text) {
    Add(0, "TEXT");
    Add(8, layer);
    AddPoint(10, at);
    Add(40, kCapital * kMPerMm * size_mm);
    Add(1, WithoutUnicode(text));
    Add(50, angle_deg);
    Add(72, 1);  // centred
    AddPoint(11, at);
  }

  std::string Finish() {
    Add(0, "ENDSEC");
    Add(0, "EOF");
    return std::move(text_);
  }

 private:
  // R12 knows the sign of plus and minus by a name of its own, and no superscripts.
  static std::string WithoutUnicode(std::string text) {
    for (const auto& [from, to] : {std::pair("\u00b1", "%%p"), {"\u00b2", "2"}}) {
      for (size_t at = text.find(from); at != std::string::npos; at = text.find(from)) {
        text.replace(at, std::strlen(from), to);
      }
    }
    return text;
  }

  std::string text_;
};

void AddDimension(const Dimension& dimension, DxfText* dxf) {
  const Eigen::Vector2d along = (dimension.to - dimension.from).normalized();
  const Eigen::Vector2d tick =
      kTickM * Eigen::Vector2d(along.x() - along.y(), along.x() + along.y());
  dxf->Line("DIMENSIONS", dimension.from, dimension.to);
  for (const Eigen::Vector2d& end : {dimension.from, dimension.to}) {
    dxf->Line("DIMENSIONS", end - tick, end + tick);
  }
}

void AddRoom(const Room& room, DxfText* dxf) {
  for (const RoomLoop& loop : room.loops) {
    std::vector<Eigen::Vector2d> corners;
    for (const RoomEdge& edge : loop) corners.push_back(edge.from);
    dxf->ClosedLine("ROOMS", corners);
  }
  for (const Dimension& dimension : room.dimensions) AddDimension(dimension, dxf);
}

void AddTexts(const StoreyPlan& storey, DxfText* dxf) {
  const Paper paper(kScale);
  const PlanTexts texts = PlaceTexts(storey, paper);
  const auto add =
      [&](const char* layer, const TextBox& box, double size_mm, const std::string& text) {
        dxf->Text(layer, paper.ModelAt(BaselineOf(box)), size_mm, 0.0 - box.angle_deg, text);
      };
  for (const std::optional<DoorText>& text : texts.doors) {
    if (text) add("DOORS", text->box, kDoorTextMm, text->width);
  }
  for (size_t i = 0; i < storey.rooms.size(); ++i) {
    for (const std::optional<DimensionText>& text : texts.dimensions[i]) {
      if (!text) continue;
      add("DIMENSIONS",
          text->box,
          kSmallTextMm,
          text->length + (text->stddev.empty() ? "" : " " + text->stddev));
      if (text->leader_to) {
        dxf->Line(
            "DIMENSIONS", paper.ModelAt(text->LeaderFrom()), paper.ModelAt(*text->leader_to));
      }
    }
    if (!texts.labels[i]) continue;
    const RoomLabel& label = *texts.labels[i];
    dxf->Text("TEXT",
              paper.ModelAt(label.NumberAt()),
              kRoomTextMm,
              0.0,
              std::to_string(storey.rooms[i].number));
    if (!label.area.empty()) {
      dxf->Text("TEXT", paper.ModelAt(label.AreaAt()), kRoomTextMm, 0.0, label.area);
    }
    if (!label.stddev.empty()) {
      dxf->Text("TEXT", paper.ModelAt(label.StddevAt()), kSmallTextMm, 0.0, label.stddev);
    }
  }
}

// The parts of an edge's length between doors, as distances from its begin.
std::vector<std::pair<double, double>> WallParts(const Eigen::Vector2d& from,
                                                 const Eigen::Vector2d& to,
                                                 const std::vector<PlanDoor>& doors) {
  constexpr double kSameLineM = 0.06;  // surfaces of one face lie up to 5 cm off its line
  const double length = (to - from).norm();
  const Eigen::Vector2d along = (to - from) / length;
  const Eigen::Vector2d across(-along.y(), along.x());
  std::vector<std::pair<double, double>> gaps;
  for (const PlanDoor& door : doors) {
    const std::vector<Eigen::Vector2d> corners = GapCorners(door);
    for (const auto& [a, b] : {std::pair(corners[0], corners[1]), {corners[3], corners[2]}}) {
      if (std::abs(across.dot(a - from)) > kSameLineM) continue;
      if (std::abs(across.dot(b - from)) > kSameLineM) continue;
      gaps.push_back(std::minmax(along.dot(a - from), along.dot(b - from)));
    }
  }
  std::sort(gaps.begin(), gaps.end());
  std::vector<std::pair<double, double>> parts;
  double at = 0.0;
  for (const auto& [begin, end] : gaps) {
    if (begin > at && at < length) parts.emplace_back(at, std::min(begin, length));
    at = std::max(at, end);
  }
  if (at < length) parts.emplace_back(at, length);
  return parts;
}

// The faces of walls that look into a room: of walls seen from one side, all that is known.
void AddWallFaces(const Room& room, const std::vector<PlanDoor>& doors, DxfText* dxf) {
  for (const RoomLoop& loop : room.loops) {
    for (size_t i = 0; i < loop.size(); ++i) {
      const Eigen::Vector2d& from = loop[i].from;
      const Eigen::Vector2d& to = loop[(i + 1) % loop.size()].from;
      if (loop[i].plane_id < 0 || from == to) continue;
      const Eigen::Vector2d along = (to - from).normalized();
      for (const auto& [begin, end] : WallParts(from, to, doors)) {
        dxf->Line("WALLS", from + begin * along, from + end * along);
      }
    }
  }
}

// Below the drawing: of what map it is, and whether that may be trusted.
void AddOrigin(const StoreyPlan& storey, const MapOrigin& origin, DxfText* dxf) {
  Eigen::AlignedBox2d box;
  for (const Room& room : storey.rooms) {
    for (const RoomEdge& edge : room.loops.front()) box.extend(edge.from);
  }
  if (box.isEmpty()) return;
  const double line_m = 2.0 * kMPerMm * kRoomTextMm;
  const Eigen::Vector2d at(box.center().x(), box.min().y() - 2.0 * line_m);
  dxf->Text("TEXT", at, kSmallTextMm, 0.0, OriginText(origin));
  const std::string warning = WarningText(origin);
  if (warning.empty()) return;
  dxf->Text("WARNING", at - Eigen::Vector2d(0.0, line_m), kRoomTextMm, 0.0, warning);
}

}  // namespace

std::string FormatDxf(const StoreyPlan& storey, const MapOrigin& origin) {
  DxfText dxf;
  dxf.Header();
  for (const auto& outline : storey.solids) dxf.ClosedLine("WALLS", outline);
  for (const Room& room : storey.rooms) {
    AddWallFaces(room, storey.doors, &dxf);
    AddRoom(room, &dxf);
  }
  for (const PlanDoor& door : storey.doors) {
    dxf.ClosedLine("DOORS", GapCorners(door));
  }
  for (const PlanWindow& window : storey.windows) dxf.Line("WINDOWS", window.from, window.to);
  AddTexts(storey, &dxf);
  AddOrigin(storey, origin, &dxf);
  return dxf.Finish();
}

}  // namespace plumbline
