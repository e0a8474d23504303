#include "core/sensor/scan_line.h"

#include <algorithm>

namespace plumbline {

double ScanLine::IrregularAngle(int beam) const {
  const int inside = std::clamp(beam, 0, static_cast<int>(angles->size()) - 1);
  return (*angles)[static_cast<size_t>(inside)] + (beam - inside) * angle_increment;
}

double ScanLine::IrregularBeamsTo(double turn, int beam) const {
  const double angle = BeamAngle(beam) + turn;
  const double direction = angle_increment > 0.0 ? 1.0 : -1.0;
  const auto comes_before = [direction](double known, double asked) {
    return direction * known < direction * asked;
  };
  const auto next = std::lower_bound(angles->begin(), angles->end(), angle, comes_before);
  const auto index = static_cast<int>(next - angles->begin());
  const int last = static_cast<int>(angles->size()) - 1;
  if (index == 0) return (angle - angles->front()) / angle_increment - beam;
  if (index > last) return last + (angle - angles->back()) / angle_increment - beam;
  const double before = (*angles)[static_cast<size_t>(index - 1)];
  return index - 1 + (angle - before) / (*next - before) - beam;
}

}  // namespace plumbline
