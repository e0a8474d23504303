#pragma once

#include <Eigen/Core>
#include <string>

#include "core/outputs/floor_plan.h"

namespace plumbline {

// Paper is where the model frame's points lie on paper, mm from its upper left corner, y
// downwards: the same for all storeys, turned by 90 degrees where the building is longer that
// way.
class Paper {
 public:
  static constexpr double kMarginMm = 14.0;
  static constexpr double kFootMm = 28.0;  // below the drawing: legend, title and scale bar

  explicit Paper(const FloorPlans& plan);
  // Makes a paper that is not turned, and without end: x to the right, y upwards.
  explicit Paper(int scale) : scale_(scale), mm_per_m_(1000.0 / scale) {}

  Eigen::Vector2d At(const Eigen::Vector2d& p) const;
  Eigen::Vector2d ModelAt(const Eigen::Vector2d& on_paper) const;  // the inverse
  // Turns a vector to the paper; its length stays.
  Eigen::Vector2d Direction(const Eigen::Vector2d& v) const;

  int scale() const { return scale_; }
  double mm_per_m() const { return mm_per_m_; }
  double width_mm() const { return width_mm_; }
  double height_mm() const { return height_mm_; }

 private:
  // Clockwise, so that the model frame's y axis points to the right.
  Eigen::Vector2d Turn(const Eigen::Vector2d& p) const {
    return turned_ ? Eigen::Vector2d(p.y(), -p.x()) : p;
  }

  bool turned_ = false;
  Eigen::Vector2d origin_ = Eigen::Vector2d::Zero();
  int scale_ = 100;
  double mm_per_m_ = 10.0;
  double width_mm_ = 0.0;
  double height_mm_ = 0.0;
};

// TextBox is the room that a line of text takes on paper, mm; turned clockwise about its
// centre.
struct TextBox {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  double width = 0.0;
  double height = 0.0;
  double angle_deg = 0.0;

  Eigen::Vector2d Along() const;  // as it is read
  Eigen::Vector2d Up() const;
};

// Whether the boxes share more than a border.
bool Overlap(const TextBox& a, const TextBox& b);

// Returns the largest width of a text of height `size`, mm: fonts differ, and the widest of
// those that stand in for Helvetica counts.
double TextWidth(const std::string& text, double size);

}  // namespace plumbline
