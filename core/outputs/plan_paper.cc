#include "core/outputs/plan_paper.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace plumbline {
namespace {

constexpr double kMinWidthMm = 180.0;  // of the sheet: the legend's
constexpr double kMaxWidthMm = 380.0;  // of the drawing
constexpr double kMaxHeightMm = 250.0;
constexpr int kScales[] = {20, 50, 100, 200, 500, 1000, 2000, 5000};

// Half of a box's extent along a direction.
double HalfExtent(const TextBox& box, const Eigen::Vector2d& direction) {
  return 0.5 * (box.width * std::abs(box.Along().dot(direction)) +
                box.height * std::abs(box.Up().dot(direction)));
}

}  // namespace

Paper::Paper(const FloorPlans& plan) {
  Eigen::AlignedBox2d box;
  for (const StoreyPlan& storey : plan.storeys) {
    for (const Room& room : storey.rooms) {
      for (const RoomEdge& edge : room.loops.front()) box.extend(edge.from);
    }
  }
  turned_ = box.sizes().y() > box.sizes().x();
  origin_ = turned_ ? Eigen::Vector2d(box.min().y(), -box.min().x())
                    : Eigen::Vector2d(box.min().x(), box.max().y());
  const Eigen::Vector2d size =
      turned_ ? Eigen::Vector2d(box.sizes().y(), box.sizes().x()) : box.sizes();
  for (const int scale : kScales) {
    scale_ = scale;
    mm_per_m_ = 1000.0 / scale;
    if (size.x() * mm_per_m_ <= kMaxWidthMm && size.y() * mm_per_m_ <= kMaxHeightMm) break;
  }
  width_mm_ = std::max(kMinWidthMm, size.x() * mm_per_m_ + 2.0 * kMarginMm);
  height_mm_ = size.y() * mm_per_m_ + 2.0 * kMarginMm + kFootMm;
}

Eigen::Vector2d Paper::At(const Eigen::Vector2d& p) const {
  const Eigen::Vector2d turned = Turn(p);
  return {kMarginMm + (turned.x() - origin_.x()) * mm_per_m_,
          kMarginMm + (origin_.y() - turned.y()) * mm_per_m_};
}

Eigen::Vector2d Paper::ModelAt(const Eigen::Vector2d& on_paper) const {
  const Eigen::Vector2d turned(origin_.x() + (on_paper.x() - kMarginMm) / mm_per_m_,
                               origin_.y() - (on_paper.y() - kMarginMm) / mm_per_m_);
  return turned_ ? Eigen::Vector2d(-turned.y(), turned.x()) : turned;
}

Eigen::Vector2d Paper::Direction(const Eigen::Vector2d& v) const {
  const Eigen::Vector2d turned = Turn(v);
  return {turned.x(), -turned.y()};
}

Eigen::Vector2d TextBox::Along() const {
  const double angle = angle_deg * M_PI / 180.0;
  return {std::cos(angle), std::sin(angle)};
}

Eigen::Vector2d TextBox::Up() const {
  const Eigen::Vector2d along = Along();
  return {along.y(), -along.x()};
}

bool Overlap(const TextBox& a, const TextBox& b) {
  constexpr double kTouchMm = 1e-9;
  const Eigen::Vector2d between = b.centre - a.centre;
  for (const Eigen::Vector2d& axis : {a.Along(), a.Up(), b.Along(), b.Up()}) {
    if (std::abs(between.dot(axis)) >= HalfExtent(a, axis) + HalfExtent(b, axis) - kTouchMm) {
      return false;
    }
  }
  return true;
}

double TextWidth(const std::string& text, double size) {
  double width = 0.0;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if ((byte & 0xC0) == 0x80) continue;  // the rest of a character
    if (byte >= 0x80) {
      width += 0.84;
    } else if (c == 'm' || c == 'w') {
      width += 0.98;
    } else if (c == '.' || c == ',' || c == ' ') {
      width += 0.32;
    } else {
      width += 0.64;
    }
  }
  return width * size;
}

}  // namespace plumbline
