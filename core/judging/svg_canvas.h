#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace plumbline {

// SvgCanvas collects shapes of a picture, in pixels, y down.
class SvgCanvas {
 public:
  void Rectangle(double x, double y, double width, double height, const std::string& fill);
  void Frame(double x, double y, double width, double height);
  void Line(const Eigen::Vector2d& from,
            const Eigen::Vector2d& to,
            const std::string& colour,
            double width,
            const std::string& dashes = "");
  void Circle(const Eigen::Vector2d& centre,
              double radius,
              const std::string& colour,
              const std::string& fill = "none");
  void Polygon(const std::vector<Eigen::Vector2d>& corners,
               const std::string& colour,
               const std::string& fill,
               double opacity);
  // One dot for each point.
  void Dots(const std::vector<Eigen::Vector2d>& points,
            const std::string& colour,
            double size);
  // anchor: "start", "middle" or "end". size: pixels.
  void Text(const Eigen::Vector2d& at,
            const std::string& text,
            double size,
            const std::string& anchor = "start",
            const std::string& colour = "#222222",
            bool bold = false);

  // The whole picture on white.
  std::string Finish(double width, double height, const std::string& title) const;

 private:
  std::string body_;
};

}  // namespace plumbline
