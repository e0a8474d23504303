#include "core/floor_plan/plan_dxf.h"

#include <cmath>
#include <cstdio>

#include "core/floor_plan/plan_drawing.h"

namespace plumbline {
namespace {

constexpr double kTextM = 0.18;       // height of room texts
constexpr double kSmallTextM = 0.12;  // of dimensions and doors
constexpr double kTickM = 0.08;

struct Layer {
  const char* name;
  int colour;  // AutoCAD colour index
};
constexpr Layer kLayers[] = {
    {"WALLS", 7}, {"ROOMS", 5}, {"DOORS", 1}, {"WINDOWS", 4}, {"DIMENSIONS", 8}, {"TEXT", 7}};

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

  // Centred on a point; turned by an angle that keeps it readable.
  void Text(const char* layer,
            const Eigen::Vector2d& at,
            double height,
            double angle_deg,
            const std::string& text) {
    Add(0, "TEXT");
    Add(8, layer);
    AddPoint(10, at);
    Add(40, height);
    Add(1, text);
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
  std::string text_;
};

double ReadableAngle(const Eigen::Vector2d& along) {
  double angle = std::atan2(along.y(), along.x()) * 180.0 / M_PI;
  constexpr double kUpright = 90.01;  // what is upright reads from the right
  if (angle > kUpright) angle -= 180.0;
  if (angle <= kUpright - 180.0) angle += 180.0;
  return angle;
}

void AddDimension(const Dimension& dimension, DxfText* dxf) {
  const Eigen::Vector2d along = (dimension.to - dimension.from).normalized();
  const Eigen::Vector2d tick =
      kTickM * Eigen::Vector2d(along.x() - along.y(), along.x() + along.y());
  dxf->Line("DIMENSIONS", dimension.from, dimension.to);
  for (const Eigen::Vector2d& end : {dimension.from, dimension.to}) {
    dxf->Line("DIMENSIONS", end - tick, end + tick);
  }
  const double angle = ReadableAngle(along);
  const Eigen::Vector2d up(-std::sin(angle * M_PI / 180.0), std::cos(angle * M_PI / 180.0));
  dxf->Text("DIMENSIONS",
            0.5 * (dimension.from + dimension.to) + 0.5 * kSmallTextM * up,
            kSmallTextM,
            angle,
            LengthText(dimension.length_m) + " %%p" + StddevText(dimension.stddev_m) + " mm");
}

void AddRoom(const Room& room, DxfText* dxf) {
  for (const RoomLoop& loop : room.loops) {
    std::vector<Eigen::Vector2d> corners;
    for (const RoomEdge& edge : loop) corners.push_back(edge.from);
    dxf->ClosedLine("ROOMS", corners);
  }
  dxf->Text("TEXT", room.label, kTextM, 0.0, std::to_string(room.number));
  dxf->Text("TEXT",
            room.label - Eigen::Vector2d(0.0, 1.6 * kTextM),
            kTextM,
            0.0,
            AreaText(room) + " %%p" + AreaStddevText(room) + " m2");
  for (const Dimension& dimension : room.dimensions) AddDimension(dimension, dxf);
}

}  // namespace

std::string FormatDxf(const StoreyPlan& storey) {
  DxfText dxf;
  dxf.Header();
  for (const auto& outline : storey.solids) dxf.ClosedLine("WALLS", outline);
  for (const Room& room : storey.rooms) AddRoom(room, &dxf);
  for (const PlanDoor& door : storey.doors) {
    dxf.ClosedLine("DOORS", GapCorners(door));
    dxf.Text("DOORS",
             0.5 * (door.from + door.to),
             kSmallTextM,
             ReadableAngle(door.to - door.from),
             LengthText(door.width_m));
  }
  for (const PlanWindow& window : storey.windows) dxf.Line("WINDOWS", window.from, window.to);
  return dxf.Finish();
}

}  // namespace plumbline
