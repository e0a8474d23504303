#include "core/outputs/quantised_points.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>

namespace plumbline {
namespace {

constexpr double kMaxField = std::numeric_limits<uint16_t>::max();

uint16_t Rounded(double value) {
  return static_cast<uint16_t>(std::lround(std::clamp(value, 0.0, kMaxField)));
}

// Small numbers of either sign become small ones without: 0, -1, 1, -2, 2, ...
uint16_t ZigZag(uint16_t difference) {
  const auto doubled = static_cast<uint16_t>(difference << 1U);
  return difference & 0x8000U ? static_cast<uint16_t>(~doubled) : doubled;
}

}  // namespace

QuantisedPoints::QuantisedPoints(const std::vector<MapPoint>& points,
                                 const std::vector<uint16_t>& plane_fields) {
  CHECK_EQ(points.size(), plane_fields.size());
  fields_[kPlane] = plane_fields;
  if (points.empty()) return;
  Eigen::Array3d lowest = points.front().p_world.cast<double>();
  Eigen::Array3d highest = lowest;
  double last_time_s = 0.0;
  for (const MapPoint& point : points) {
    const Eigen::Array3d p_world = point.p_world.cast<double>();
    lowest = lowest.min(p_world);
    highest = highest.max(p_world);
    last_time_s = std::max(last_time_s, point.time_s);
  }
  origin_ = lowest;
  step_m_ = std::max(kFinestStep, (highest - lowest).maxCoeff() / kMaxField);
  time_step_s_ = std::max(kFinestTime, last_time_s / kMaxField);
  for (int field = kX; field <= kTime; ++field) {
    fields_[static_cast<size_t>(field)].reserve(points.size());
  }
  scanner_.reserve(points.size());
  for (const MapPoint& point : points) {
    const Eigen::Vector3d steps = (point.p_world.cast<double>() - origin_) / step_m_;
    for (int axis = 0; axis < 3; ++axis) {
      fields_[static_cast<size_t>(axis)].push_back(Rounded(steps[axis]));
    }
    fields_[kTime].push_back(Rounded(point.time_s / time_step_s_));
    scanner_.push_back(static_cast<uint8_t>(point.scanner));
  }
}

QuantisedPoints QuantisedPoints::Selection(int64_t count) const {
  if (count >= size()) return *this;
  QuantisedPoints selection;
  selection.origin_ = origin_;
  selection.step_m_ = step_m_;
  selection.time_step_s_ = time_step_s_;
  for (int64_t i = 0; i < count; ++i) {
    const auto from = static_cast<size_t>(i * size() / count);
    for (size_t field = 0; field < kNumFields; ++field) {
      selection.fields_[field].push_back(fields_[field][from]);
    }
    selection.scanner_.push_back(scanner_[from]);
  }
  return selection;
}

std::string QuantisedPoints::HeaderJson() const {
  const nlohmann::ordered_json json = {{"count", size()},
                                       {"origin", {origin_.x(), origin_.y(), origin_.z()}},
                                       {"step_m", step_m_},
                                       {"time_step_s", time_step_s_}};
  return json.dump();
}

std::vector<DataSection> QuantisedPoints::Sections() const {
  static constexpr const char* kNames[kNumFields] = {"x", "y", "z", "time", "plane"};
  std::vector<DataSection> sections;
  for (size_t field = 0; field < kNumFields; ++field) {
    DataSection low{std::string("points-") + kNames[field] + "-0", {}};
    DataSection high{std::string("points-") + kNames[field] + "-1", {}};
    low.bytes.reserve(scanner_.size());
    high.bytes.reserve(scanner_.size());
    uint16_t before = 0;
    for (const uint16_t value : fields_[field]) {
      const uint16_t code = ZigZag(static_cast<uint16_t>(value - before));
      before = value;
      low.bytes.push_back(static_cast<uint8_t>(code & 0xffU));
      high.bytes.push_back(static_cast<uint8_t>(code >> 8U));
    }
    sections.push_back(std::move(low));
    sections.push_back(std::move(high));
  }
  sections.push_back({"points-scanner-0", scanner_});
  return sections;
}

}  // namespace plumbline
