#include "core/judging/svg_canvas.h"

#include "core/judging/words.h"
#include "core/util/one_line.h"
#include "core/util/xml_text.h"

namespace plumbline {
namespace {

std::string Number(double value) {
  std::string text = Decimal(value, 1);
  if (text.size() > 2 && text.compare(text.size() - 2, 2, ".0") == 0) {
    text.resize(text.size() - 2);
  }
  return text;
}

std::string Attribute(const std::string& name, const std::string& value) {
  return " " + name + "=\"" + value + "\"";
}
std::string Attribute(const std::string& name, double value) {
  return Attribute(name, Number(value));
}

std::string Escaped(const std::string& text) { return XmlEscaped(OnOneLine(text)); }

std::string Pair(const Eigen::Vector2d& p) { return Number(p.x()) + " " + Number(p.y()); }

}  // namespace

void SvgCanvas::Rectangle(
    double x, double y, double width, double height, const std::string& fill) {
  body_ += "<rect" + Attribute("x", x) + Attribute("y", y) + Attribute("width", width) +
           Attribute("height", height) + Attribute("fill", fill) +
           Attribute("shape-rendering", "crispEdges") + "/>\n";
}

void SvgCanvas::Frame(double x, double y, double width, double height) {
  body_ += "<rect" + Attribute("x", x) + Attribute("y", y) + Attribute("width", width) +
           Attribute("height", height) + Attribute("fill", "none") +
           Attribute("stroke", "#999999") + "/>\n";
}

void SvgCanvas::Line(const Eigen::Vector2d& from,
                     const Eigen::Vector2d& to,
                     const std::string& colour,
                     double width,
                     const std::string& dashes) {
  body_ += "<path" + Attribute("d", "M" + Pair(from) + "L" + Pair(to)) +
           Attribute("stroke", colour) + Attribute("stroke-width", width) +
           (dashes.empty() ? "" : Attribute("stroke-dasharray", dashes)) + "/>\n";
}

void SvgCanvas::Circle(const Eigen::Vector2d& centre,
                       double radius,
                       const std::string& colour,
                       const std::string& fill) {
  body_ += "<circle" + Attribute("cx", centre.x()) + Attribute("cy", centre.y()) +
           Attribute("r", radius) + Attribute("stroke", colour) + Attribute("fill", fill) +
           "/>\n";
}

void SvgCanvas::Polygon(const std::vector<Eigen::Vector2d>& corners,
                        const std::string& colour,
                        const std::string& fill,
                        double opacity) {
  std::string path;
  for (const Eigen::Vector2d& corner : corners)
    path += (path.empty() ? "M" : "L") + Pair(corner);
  body_ += "<path" + Attribute("d", path + "Z") + Attribute("stroke", colour) +
           Attribute("fill", fill) + Attribute("fill-opacity", Decimal(opacity, 2)) + "/>\n";
}

void SvgCanvas::Dots(const std::vector<Eigen::Vector2d>& points,
                     const std::string& colour,
                     double size) {
  std::string path;
  for (const Eigen::Vector2d& point : points) path += "M" + Pair(point) + "h0";
  if (path.empty()) return;
  body_ += "<path" + Attribute("d", path) + Attribute("stroke", colour) +
           Attribute("stroke-width", size) + Attribute("stroke-linecap", "round") + "/>\n";
}

void SvgCanvas::Text(const Eigen::Vector2d& at,
                     const std::string& text,
                     double size,
                     const std::string& anchor,
                     const std::string& colour,
                     bool bold) {
  body_ += "<text" + Attribute("x", at.x()) + Attribute("y", at.y()) +
           Attribute("font-size", size) + Attribute("text-anchor", anchor) +
           Attribute("fill", colour) + (bold ? Attribute("font-weight", "bold") : "") + ">" +
           Escaped(text) + "</text>\n";
}

std::string SvgCanvas::Finish(double width, double height, const std::string& title) const {
  return "<svg xmlns=\"http://www.w3.org/2000/svg\"" + Attribute("width", width) +
         Attribute("height", height) +
         Attribute("viewBox", "0 0 " + Number(width) + " " + Number(height)) +
         Attribute("font-family", "sans-serif") + ">\n<title>" + Escaped(title) +
         "</title>\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n" + body_ +
         "</svg>\n";
}

}  // namespace plumbline
