#include "core/judging/check_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <sstream>
#include <utility>

#include "core/geometry/angles.h"
#include "core/judging/check_text.h"
#include "core/judging/svg_canvas.h"
#include "core/judging/words.h"
#include "core/util/quantiles.h"

namespace plumbline {
namespace {

constexpr double kWidth = 1200.0;
constexpr double kMargin = 20.0;
constexpr double kRowHeight = 230.0;
constexpr double kViewHeight = 460.0;
constexpr size_t kMaxDots = 4000;      // of a scanner in a view
constexpr double kFirst = 1.0;         // s, of which the points are shown
constexpr double kPlaneRadius = 0.22;  // of a drawn scan plane, as a share of the view

const std::array<const char*, 6> kColours = {
    "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"};

std::string ColourOf(size_t index) { return kColours[index % kColours.size()]; }

std::string ColourOf(Severity severity) {
  switch (severity) {
    case Severity::kNote:
      return "#555555";
    case Severity::kWarning:
      return "#b06000";
    case Severity::kStop:
      return "#c00000";
  }
  return "#000000";
}

struct Box {
  double x = 0.0;
  double y = 0.0;
  double width = 0.0;
  double height = 0.0;

  Eigen::Vector2d centre() const { return {x + 0.5 * width, y + 0.5 * height}; }
  Eigen::Vector2d At(double right, double down) const {
    return {x + right * width, y + down * height};
  }
};

// Distance within which nine tenths of the points lie, m.
double ExtentOf(const std::vector<Eigen::Vector2d>& points) {
  std::vector<double> distances;
  for (const Eigen::Vector2d& point : points) distances.push_back(point.norm());
  if (distances.empty()) return 1.0;
  return std::max(0.5, 1.15 * SampleQuantile(std::move(distances), 0.9));
}

// Takes points to a box with the origin in its middle, the first coordinate to the right and
// the second up, and draws rings of round distances.
class Scene {
 public:
  Scene(const Box& box, double extent_m, SvgCanvas* canvas)
      : box_(box), scale_(0.5 * std::min(box.width, box.height) / extent_m), canvas_(canvas) {
    double step = 1.0;
    while (extent_m / step > 4.0) step *= 2.0;
    canvas_->Frame(box.x, box.y, box.width, box.height);
    for (double ring = step; ring * scale_ < 0.5 * std::min(box.width, box.height);
         ring += step) {
      canvas_->Circle(box.centre(), ring * scale_, "#dddddd");
      canvas_->Text(At({0.0, ring}) + Eigen::Vector2d(2.0, 10.0),
                    Decimal(ring, 0) + " m",
                    9,
                    "start",
                    "#999999");
    }
  }

  Eigen::Vector2d At(const Eigen::Vector2d& p) const {
    return box_.centre() + scale_ * Eigen::Vector2d(p.x(), -p.y());
  }
  bool Holds(const Eigen::Vector2d& p) const {
    const Eigen::Vector2d at = At(p);
    return at.x() > box_.x && at.x() < box_.x + box_.width && at.y() > box_.y &&
           at.y() < box_.y + box_.height;
  }
  void Dots(const std::vector<Eigen::Vector2d>& points,
            const std::string& colour,
            double size) {
    std::vector<Eigen::Vector2d> placed;
    for (const Eigen::Vector2d& point : points) {
      if (Holds(point)) placed.push_back(At(point));
    }
    canvas_->Dots(placed, colour, size);
  }

 private:
  Box box_;
  double scale_;
  SvgCanvas* canvas_;
};

// Points of a scan line that are returns, scanner frame.
std::vector<Eigen::Vector2d> PointsOf(const ScanLine& line) {
  std::vector<Eigen::Vector2d> points;
  for (int beam = 0; beam < line.num_beams(); ++beam) {
    const double range = static_cast<double>(line.ranges[static_cast<size_t>(beam)]);
    if (std::isfinite(range)) points.push_back(range * line.BeamDirection(beam));
  }
  return points;
}

// One row of the picture.
class TopicRow {
 public:
  TopicRow(const CheckReport& report, size_t topic, double y, SvgCanvas* canvas)
      : report_(report),
        topic_(report.survey.topics[topic]),
        index_(topic),
        y_(y),
        canvas_(canvas) {}

  void Draw() {
    canvas_->Text({kMargin, y_ + 14.0}, topic_.name, 14, "start", ColourOf(index_), true);
    DrawLine({kMargin, y_ + 22.0, 200.0, 195.0});
    DrawTime(
        {270.0, y_ + 34.0, 460.0, 70.0},
        "scan lines a second",
        [](const SurveyedSecond& second) { return static_cast<double>(second.num_lines); });
    DrawTime({270.0, y_ + 132.0, 460.0, 70.0},
             "beams with a return, %",
             [](const SurveyedSecond& second) {
               return second.num_beams == 0 ? 0.0
                                            : 100.0 * static_cast<double>(second.num_returns) /
                                                  static_cast<double>(second.num_beams);
             });
    DrawBeams({790.0, y_ + 34.0, 385.0, 168.0});
  }

 private:
  void DrawLine(const Box& box) {
    const std::vector<ScanLine>& lines = report_.survey.sample[index_];
    if (lines.empty()) {
      canvas_->Frame(box.x, box.y, box.width, box.height);
      canvas_->Text(box.centre(), "no scan line", 11, "middle", "#c00000");
      return;
    }
    const std::vector<Eigen::Vector2d> points = PointsOf(lines[lines.size() / 2]);
    const double extent = ExtentOf(points);
    Scene scene(box, extent, canvas_);
    canvas_->Line(scene.At({0.0, 0.0}), scene.At({0.25 * extent, 0.0}), "#222222", 1.5);
    canvas_->Circle(scene.At({0.0, 0.0}), 2.5, "#222222", "#222222");
    scene.Dots(points, ColourOf(index_), 2.0);
    canvas_->Text(box.At(0.02, 0.98), "one scan line; angle 0 to the right", 9);
  }

  void DrawTime(const Box& box,
                const std::string& title,
                const std::function<double(const SurveyedSecond&)>& value) {
    const double num_seconds = std::max(1.0, std::ceil(report_.survey.duration_s()));
    canvas_->Text({box.x, box.y - 4.0}, title, 10);
    // A long recording has more seconds than the strip has pixels: the worst of each stands.
    const auto step = static_cast<int64_t>(1.0 + num_seconds / box.width);
    const auto num_steps =
        static_cast<size_t>(std::ceil(num_seconds / static_cast<double>(step)));
    std::vector<double> least(num_steps, 0.0);
    std::vector<int64_t> num_present(num_steps, 0);
    double most = 1e-9;
    for (const SurveyedSecond& second : topic_.seconds) {
      const auto at = static_cast<size_t>(second.second / step);
      if (at >= num_steps) continue;  // the last line may lie on the end itself
      least[at] = num_present[at]++ == 0 ? value(second) : std::min(least[at], value(second));
      most = std::max(most, value(second));
    }
    const double width = box.width * static_cast<double>(step) / num_seconds;
    for (size_t i = 0; i < num_steps; ++i) {
      const double x = box.x + width * static_cast<double>(i);
      const double until =
          std::min(num_seconds, static_cast<double>(step) * static_cast<double>(i + 1));
      const double expected = until - static_cast<double>(step) * static_cast<double>(i);
      const double drawn = box.width * expected / num_seconds;
      if (least[i] <= 0.0 || static_cast<double>(num_present[i]) < expected) {
        canvas_->Rectangle(x, box.y, drawn, box.height, "#f3b0b0");
      } else {
        const double height = box.height * least[i] / most;
        canvas_->Rectangle(x, box.y + box.height - height, drawn, height, ColourOf(index_));
      }
    }
    canvas_->Frame(box.x, box.y, box.width, box.height);
    canvas_->Text({box.x - 4.0, box.y + 9.0}, Decimal(most, 0), 10, "end");
    canvas_->Text({box.x - 4.0, box.y + box.height}, "0", 10, "end");
    canvas_->Text({box.x + box.width, box.y + box.height + 12.0},
                  Decimal(num_seconds, 0) + " s",
                  10,
                  "end");
  }

  void DrawBeams(const Box& box) {
    canvas_->Text({box.x, box.y - 4.0}, "returns by beam angle, %", 10);
    const std::vector<BeamCounts>& beams = topic_.beams;
    if (!beams.empty()) {
      std::vector<Eigen::Vector2d> corners = {{box.x, box.y + box.height}};
      const auto columns = static_cast<size_t>(box.width);
      for (size_t column = 0; column < columns; ++column) {
        const size_t beam = column * beams.size() / columns;
        const double share =
            beams[beam].num_lines == 0
                ? 0.0
                : static_cast<double>(beams[beam].num_returns) / beams[beam].num_lines;
        const double x = box.x + static_cast<double>(column);
        corners.push_back({x, box.y + box.height * (1.0 - share)});
      }
      corners.push_back({box.x + box.width, box.y + box.height});
      canvas_->Polygon(corners, "none", ColourOf(index_), 0.6);
    }
    canvas_->Frame(box.x, box.y, box.width, box.height);
    canvas_->Text({box.x - 4.0, box.y + 9.0}, "100", 10, "end");
    canvas_->Text({box.x - 4.0, box.y + box.height}, "0", 10, "end");
    const double last =
        topic_.angle_min + std::max(0, topic_.num_beams - 1) * topic_.angle_increment;
    for (const double share : {0.0, 0.5, 1.0}) {
      const double angle = topic_.angle_min + share * (last - topic_.angle_min);
      canvas_->Text({box.x + share * box.width, box.y + box.height + 12.0},
                    Decimal(angle * kDegreesPerRadian, 0) + " deg",
                    10,
                    share == 0.0 ? "start" : (share == 1.0 ? "end" : "middle"));
    }
  }

  const CheckReport& report_;
  const TopicSurvey& topic_;
  size_t index_;
  double y_;
  SvgCanvas* canvas_;
};

// The rig and what it saw in its first second, from above or from the side.
class RigView {
 public:
  // axes: takes a point of the body frame to the picture's right and up.
  RigView(const CheckReport& report, const Eigen::Matrix<double, 2, 3>& axes)
      : report_(report), axes_(axes) {}

  void Draw(const Box& box, const std::string& title, bool has_heights, SvgCanvas* canvas) {
    std::vector<std::vector<Eigen::Vector2d>> points;
    std::vector<Eigen::Vector2d> all;
    for (size_t i = 0; i < report_.rig->scanners.size(); ++i) {
      points.push_back(FirstPoints(i));
      all.insert(all.end(), points.back().begin(), points.back().end());
    }
    const double extent = std::max(2.0, ExtentOf(all));
    Scene scene(box, extent, canvas);
    canvas->Text({box.x, box.y - 5.0}, title, 11, "start", "#222222", true);
    for (size_t i = 0; i < points.size(); ++i) {
      if (has_heights) DrawHeights(i, extent, &scene, canvas);
      scene.Dots(points[i], ColourOf(ColourIndex(i)), 1.4);
    }
    for (size_t i = 0; i < points.size(); ++i) {
      DrawPlane(i, kPlaneRadius * extent, &scene, canvas);
      canvas->Text({box.x + 8.0, box.y + 16.0 + 13.0 * static_cast<double>(i)},
                   report_.rig->scanners[i].name,
                   11,
                   "start",
                   ColourOf(ColourIndex(i)));
    }
  }

 private:
  size_t ColourIndex(size_t scanner) const {
    const int topic = report_.topics_of_scanners[scanner];
    return topic < 0 ? report_.survey.topics.size() + scanner : static_cast<size_t>(topic);
  }

  Eigen::Vector2d Project(size_t scanner, const Eigen::Vector2d& p) const {
    return axes_ * (report_.rig->scanners[scanner].body_from_scanner *
                    Eigen::Vector3d(p.x(), p.y(), 0.0));
  }

  std::vector<Eigen::Vector2d> FirstPoints(size_t scanner) const {
    std::vector<Eigen::Vector2d> points;
    const int topic = report_.topics_of_scanners[scanner];
    if (topic < 0) return points;
    const std::vector<ScanLine>& lines = report_.survey.sample[static_cast<size_t>(topic)];
    for (const ScanLine& line : lines) {
      if (SecondsBetween(lines.front().stamp_ns, line.stamp_ns) > kFirst) break;
      for (const Eigen::Vector2d& p : PointsOf(line)) points.push_back(Project(scanner, p));
    }
    if (points.size() <= kMaxDots) return points;
    const size_t stride = 1 + points.size() / kMaxDots;
    std::vector<Eigen::Vector2d> fewer;
    for (size_t i = 0; i < points.size(); i += stride) fewer.push_back(points[i]);
    return fewer;
  }

  void DrawPlane(size_t scanner, double radius, Scene* scene, SvgCanvas* canvas) const {
    const int topic = report_.topics_of_scanners[scanner];
    double first = -0.75 * M_PI;
    double field = 1.5 * M_PI;
    if (topic >= 0) {
      const TopicSurvey& survey = report_.survey.topics[static_cast<size_t>(topic)];
      first = survey.angle_min;
      field = std::max(0, survey.num_beams - 1) * survey.angle_increment;
    }
    std::vector<Eigen::Vector2d> corners = {scene->At(Project(scanner, {0.0, 0.0}))};
    for (int i = 0; i <= 36; ++i) {
      const double angle = first + field * i / 36.0;
      corners.push_back(scene->At(
          Project(scanner, radius * Eigen::Vector2d(std::cos(angle), std::sin(angle)))));
    }
    const std::string colour = ColourOf(ColourIndex(scanner));
    canvas->Polygon(corners, colour, colour, 0.15);
    canvas->Line(corners.front(), scene->At(Project(scanner, {radius, 0.0})), colour, 2.0);
    canvas->Circle(corners.front(), 3.0, colour, colour);
  }

  void DrawHeights(size_t scanner, double extent, Scene* scene, SvgCanvas* canvas) const {
    const HeightView& view = report_.heights[scanner];
    for (const LevelTraces& traces : {view.floor, view.ceiling}) {
      if (!traces.is_seen) continue;
      canvas->Line(scene->At({-extent, traces.height_m}),
                   scene->At({extent, traces.height_m}),
                   ColourOf(ColourIndex(scanner)),
                   1.0,
                   "6 4");
    }
  }

  const CheckReport& report_;
  Eigen::Matrix<double, 2, 3> axes_;
};

// Writes the findings, and returns where they end.
double DrawFindings(const CheckReport& report, double y, SvgCanvas* canvas) {
  constexpr size_t kMaxFindings = 12;
  constexpr size_t kLineLetters = 170;
  for (size_t i = 0; i < std::min(kMaxFindings, report.findings.size()); ++i) {
    const Finding& finding = report.findings[i];
    std::string text = NameOf(finding.severity) + "  " +
                       (finding.subject.empty() ? "" : finding.subject + ": ") +
                       finding.sentence;
    if (!finding.advice.empty()) text += " -> " + finding.advice;
    std::istringstream lines(Wrapped(text, "", "", kLineLetters));
    for (std::string line; std::getline(lines, line); y += 16.0) {
      canvas->Text({kMargin, y}, line, 11, "start", ColourOf(finding.severity));
    }
  }
  if (report.findings.size() > kMaxFindings) {
    canvas->Text(
        {kMargin, y},
        "and " + std::to_string(report.findings.size() - kMaxFindings) + " more in check.json",
        11);
    y += 16.0;
  }
  return y;
}

}  // namespace

std::string DrawCheck(const CheckReport& report) {
  SvgCanvas canvas;
  canvas.Text({kMargin, 26.0}, report.survey.path, 15, "start", "#222222", true);
  canvas.Text({kMargin, 48.0},
              report.verdict,
              14,
              "start",
              report.mappable == Mappable::kNot ? "#c00000" : "#007040",
              true);
  double y = DrawFindings(report, 70.0, &canvas) + 12.0;
  for (size_t i = 0; i < report.survey.topics.size(); ++i) {
    TopicRow(report, i, y, &canvas).Draw();
    y += kRowHeight + 10.0;
  }
  if (report.rig) {
    y += 16.0;
    const double width = 0.5 * (kWidth - 3.0 * kMargin);
    Eigen::Matrix<double, 2, 3> axes;
    axes << 0.0, -1.0, 0.0, 1.0, 0.0, 0.0;
    RigView(report, axes)
        .Draw({kMargin, y, width, kViewHeight},
              "from above, forward is up: rig as in the rig file, points of the first second",
              false,
              &canvas);
    axes << 1.0, 0.0, 0.0, 0.0, 0.0, 1.0;
    RigView(report, axes)
        .Draw({2.0 * kMargin + width, y, width, kViewHeight},
              "from the right side, forward is to the right; dashed: floor and ceiling found",
              true,
              &canvas);
    y += kViewHeight + kMargin;
  }
  return canvas.Finish(kWidth, y + kMargin, "plumbline_check " + report.survey.path);
}

}  // namespace plumbline
