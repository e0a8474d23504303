#include "core/recording/point_cloud.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace plumbline {
namespace {

// How far a point may lie off the scan plane: drivers round, and so do transformations.
constexpr double kMaxOffPlaneM = 0.01;
constexpr double kMaxOffPlaneRatio = 0.005;  // of its range
constexpr double kMaxShareOffPlane = 0.01;

// Two echoes of one beam.
constexpr double kSameDirectionRad = 1e-6;
constexpr double kMaxSpanRad = 2.0 * M_PI + 1e-3;
// Rounding of coordinates, not a scanner's own irregularity.
constexpr double kMaxAngleResidualRad = 1e-5;
// Tolerance of the time from beam to beam.
constexpr double kMaxTimeResidual = 0.25;
// Where times are irregular, the instant of a beam may be off by this: a rig walks 1 mm.
constexpr double kMaxTimeErrorS = 1e-3;
// Largest number of beams for each point: the others had no return.
constexpr size_t kMaxBeamsPerPoint = 20;

struct Field {
  uint32_t offset = 0;
  uint8_t type = 0;  // as sensor_msgs/PointField numbers them
};

struct Layout {
  std::optional<Field> x, y, z, time;
  bool is_big_endian = false;
  uint32_t point_step = 0;
  size_t num_points = 0;
  ByteView data;
};

struct Point {
  double angle = 0.0;   // rad, without jumps by a full turn
  double range = 0.0;   // m
  double time_s = 0.0;  // after the stamp
};

size_t SizeOf(uint8_t type) {
  constexpr size_t kSizes[] = {0, 1, 1, 2, 2, 4, 4, 4, 8};
  return type < std::size(kSizes) ? kSizes[type] : 0;
}

double ValueOf(const Field& field, const uint8_t* point, bool is_big_endian) {
  const uint8_t* at = point + field.offset;
  switch (field.type) {
    case 1:
      return NumberAt<int8_t>(at, is_big_endian);
    case 2:
      return NumberAt<uint8_t>(at, is_big_endian);
    case 3:
      return NumberAt<int16_t>(at, is_big_endian);
    case 4:
      return NumberAt<uint16_t>(at, is_big_endian);
    case 5:
      return NumberAt<int32_t>(at, is_big_endian);
    case 6:
      return NumberAt<uint32_t>(at, is_big_endian);
    case 7:
      return NumberAt<float>(at, is_big_endian);
    default:
      return NumberAt<double>(at, is_big_endian);
  }
}

bool TakeFields(SerialReader* reader, Layout* layout) {
  uint32_t num_fields = 0;
  if (!reader->Take(&num_fields)) return false;
  for (uint32_t i = 0; i < num_fields; ++i) {
    std::string name;
    Field field;
    uint32_t count = 0;
    if (!reader->TakeText(&name) || !reader->Take(&field.offset) ||
        !reader->Take(&field.type) || !reader->Take(&count)) {
      return false;
    }
    if (name == "x") layout->x = field;
    if (name == "y") layout->y = field;
    if (name == "z") layout->z = field;
    for (const char* known : {"time", "t", "timestamp", "time_offset", "offset_time"}) {
      if (name == known) layout->time = field;
    }
  }
  return true;
}

bool TakeLayout(SerialReader* reader, Layout* layout) {
  uint32_t height = 0;
  uint32_t width = 0;
  uint8_t is_big_endian = 0;
  uint32_t row_step = 0;
  uint32_t num_bytes = 0;
  uint8_t is_dense = 0;
  if (!reader->Take(&height) || !reader->Take(&width) || !TakeFields(reader, layout) ||
      !reader->Take(&is_big_endian) || !reader->Take(&layout->point_step) ||
      !reader->Take(&row_step) || !reader->Take(&num_bytes) ||
      !reader->TakeBytes(num_bytes, &layout->data) || !reader->Take(&is_dense) ||
      !reader->IsAtEnd()) {
    return false;
  }
  layout->is_big_endian = is_big_endian != 0;
  // Rows without gaps between them; 64 bits hold the products.
  const uint64_t num_points = uint64_t{height} * width;
  if (layout->point_step == 0 || num_points > num_bytes / layout->point_step) return false;
  if (height > 1 && row_step != uint64_t{width} * layout->point_step) return false;
  layout->num_points = static_cast<size_t>(num_points);
  const auto fits = [layout](const std::optional<Field>& field) {
    const size_t size = field ? SizeOf(field->type) : 0;
    return size > 0 && uint64_t{field->offset} + size <= layout->point_step;
  };
  return fits(layout->x) && fits(layout->y) && fits(layout->z) &&
         (!layout->time || fits(layout->time));
}

// Seconds after the stamp, or since whenever the scanner's own clock began.
double TimeOf(const Layout& layout, const uint8_t* point, int64_t stamp_ns) {
  if (!layout.time) return 0.0;
  const double value = ValueOf(*layout.time, point, layout.is_big_endian);
  const bool is_integer = layout.time->type < 7;
  if (is_integer) return value * 1e-9;
  constexpr double kYear2000S = 946684800.0;
  if (value > kYear2000S * 1e8) return (value - static_cast<double>(stamp_ns)) * 1e-9;
  if (value > kYear2000S) return value - static_cast<double>(stamp_ns) * 1e-9;
  return value;
}

// Times that lie further from the stamp than a scan line lasts are of another clock, such as
// the scanner's uptime, which the stamp is not on: only the differences between them count.
// Drivers stamp with the first point then.
void CountFromFirst(std::vector<Point>* points) {
  if (points->empty()) return;
  double first_s = points->front().time_s;
  for (const Point& point : *points) first_s = std::min(first_s, point.time_s);
  if (std::abs(first_s) <= kMaxScanSeconds) return;
  for (Point& point : *points) point.time_s -= first_s;
}

// The points with a return; false where they do not lie in the scan plane.
bool CollectPoints(const Layout& layout, int64_t stamp_ns, std::vector<Point>* points) {
  size_t num_off_plane = 0;
  for (size_t i = 0; i < layout.num_points; ++i) {
    const uint8_t* at = layout.data.data + i * layout.point_step;
    const double x = ValueOf(*layout.x, at, layout.is_big_endian);
    const double y = ValueOf(*layout.y, at, layout.is_big_endian);
    const double z = ValueOf(*layout.z, at, layout.is_big_endian);
    Point point;
    point.range = std::hypot(x, y);
    point.angle = std::atan2(y, x);
    point.time_s = TimeOf(layout, at, stamp_ns);
    if (!std::isfinite(point.range) || !std::isfinite(z) || !std::isfinite(point.time_s)) {
      continue;
    }
    if (std::abs(z) > kMaxOffPlaneM + kMaxOffPlaneRatio * point.range) {
      ++num_off_plane;
    } else if (point.range > 0.0) {
      points->push_back(point);
    }
  }
  return static_cast<double>(num_off_plane) <=
         kMaxShareOffPlane * static_cast<double>(points->size());
}

// Brings points into the order of the beams and takes the jumps by a full turn out of their
// angles; leaves out all but the first in one direction.
void OrderPoints(bool has_times, std::vector<Point>* points) {
  if (has_times) {
    std::stable_sort(points->begin(), points->end(), [](const Point& a, const Point& b) {
      return a.time_s < b.time_s;
    });
  }
  const auto unwrap = [points] {
    for (size_t i = 1; i < points->size(); ++i) {
      const double before = (*points)[i - 1].angle;
      double* angle = &(*points)[i].angle;
      *angle = before + std::remainder(*angle - before, 2.0 * M_PI);
    }
  };
  unwrap();
  if (!has_times) {
    const auto is_before = [](const Point& a, const Point& b) { return a.angle < b.angle; };
    const auto is_behind = [](const Point& a, const Point& b) { return a.angle > b.angle; };
    if (!std::is_sorted(points->begin(), points->end(), is_before) &&
        !std::is_sorted(points->begin(), points->end(), is_behind)) {
      for (Point& point : *points) point.angle = std::remainder(point.angle, 2.0 * M_PI);
      std::stable_sort(points->begin(), points->end(), is_before);
    }
  }
  const auto is_same = [](const Point& a, const Point& b) {
    return std::abs(a.angle - b.angle) < kSameDirectionRad;
  };
  points->erase(std::unique(points->begin(), points->end(), is_same), points->end());
}

double MedianStep(const std::vector<double>& values) {
  std::vector<double> steps;
  for (size_t i = 1; i < values.size(); ++i) steps.push_back(values[i] - values[i - 1]);
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

// Values as places on a line, value = start + place * step.
struct Grid {
  std::vector<size_t> places;  // of the values, increasing
  double start = 0.0;
  double step = 0.0;
};

// Least squares of the values over their places.
void FitGrid(const std::vector<double>& values, Grid* grid) {
  double sum_place = 0.0, sum_value = 0.0, place2 = 0.0, product = 0.0;
  const auto n = static_cast<double>(values.size());
  for (size_t i = 0; i < values.size(); ++i) {
    const auto place = static_cast<double>(grid->places[i]);
    const double value = values[i] - values.front();
    sum_place += place;
    sum_value += value;
    place2 += place * place;
    product += place * value;
  }
  grid->step = (n * product - sum_place * sum_value) / (n * place2 - sum_place * sum_place);
  grid->start = values.front() + (sum_value - grid->step * sum_place) / n;
}

bool IsOnGrid(const std::vector<double>& values, const Grid& grid, double max_residual) {
  for (size_t i = 0; i < values.size(); ++i) {
    const double on_grid = grid.start + static_cast<double>(grid.places[i]) * grid.step;
    if (!(std::abs(values[i] - on_grid) <= max_residual)) return false;
  }
  return true;
}

// The grid that the values lie on, with gaps, but for the residual; nullopt where they lie on
// none.
std::optional<Grid> FindGrid(const std::vector<double>& values,
                             double max_residual,
                             double max_relative_residual) {
  const double step = MedianStep(values);
  if (step == 0.0) return std::nullopt;
  Grid grid;
  grid.places.push_back(0);
  for (size_t i = 1; i < values.size(); ++i) {
    const double places = std::round((values[i] - values[i - 1]) / step);
    if (!(places >= 1.0 && places <= static_cast<double>(kMaxBeamsPerPoint * values.size()))) {
      return std::nullopt;
    }
    grid.places.push_back(grid.places.back() + static_cast<size_t>(places));
  }
  if (grid.places.back() > kMaxBeamsPerPoint * values.size()) return std::nullopt;
  FitGrid(values, &grid);
  const double residual = std::max(max_residual, max_relative_residual * std::abs(grid.step));
  return IsOnGrid(values, grid, residual) ? std::make_optional(grid) : std::nullopt;
}

// Puts the points on their places, and beams without a return between them.
void PlacePoints(const std::vector<Point>& points,
                 const std::vector<size_t>& places,
                 bool with_ranges,
                 bool with_angles,
                 ScanLineMessage* message) {
  const size_t num_beams = places.back() + 1;
  message->num_beams = static_cast<uint32_t>(num_beams);
  if (with_ranges) {
    message->ranges.assign(num_beams, std::numeric_limits<float>::quiet_NaN());
    for (size_t i = 0; i < points.size(); ++i) {
      message->ranges[places[i]] = static_cast<float>(points[i].range);
    }
  }
  if (!with_angles) return;
  message->angles.resize(num_beams);
  for (size_t i = 0; i < points.size(); ++i) {
    const size_t from = i == 0 ? 0 : places[i - 1];
    const double step = i == 0 ? 0.0
                               : (points[i].angle - points[i - 1].angle) /
                                     static_cast<double>(places[i] - from);
    for (size_t place = i == 0 ? 0 : from + 1; place <= places[i]; ++place) {
      message->angles[place] =
          static_cast<float>(points[i].angle - step * static_cast<double>(places[i] - place));
    }
  }
}

// Whether the beams go round one way, and once at most.
bool GoesRound(const std::vector<double>& angles) {
  const double direction = angles.back() - angles.front();
  if (std::abs(direction) > kMaxSpanRad) return false;
  for (size_t i = 1; i < angles.size(); ++i) {
    if ((angles[i] - angles[i - 1]) * direction <= 0.0) return false;
  }
  return true;
}

// Sets beams and times from two or more ordered points.
void SetBeams(const std::vector<Point>& points,
              bool has_times,
              bool with_ranges,
              ScanLineMessage* message) {
  std::vector<double> angles;
  std::vector<double> times;
  for (const Point& point : points) {
    angles.push_back(point.angle);
    times.push_back(point.time_s);
  }
  if (!GoesRound(angles)) return;  // not usable: no increment
  Grid time_grid;
  std::optional<Grid> grid = FindGrid(angles, kMaxAngleResidualRad, 0.0);
  bool is_regular = grid.has_value();
  if (is_regular) {
    time_grid.places = grid->places;
    FitGrid(times, &time_grid);
    is_regular = IsOnGrid(times, time_grid, kMaxTimeResidual * std::abs(time_grid.step));
  }
  if (!is_regular) {
    grid = has_times ? FindGrid(times, 0.0, kMaxTimeResidual) : std::nullopt;
    if (!grid) {
      grid.emplace();
      for (size_t i = 0; i < points.size(); ++i) grid->places.push_back(i);
    }
    time_grid.places = grid->places;
    FitGrid(times, &time_grid);
  }
  PlacePoints(points, grid->places, with_ranges, !is_regular, message);
  const auto num_steps = static_cast<double>(grid->places.back());
  message->angle_min = static_cast<float>(is_regular ? grid->start : angles.front());
  message->angle_increment = static_cast<float>(
      is_regular ? grid->step : (angles.back() - angles.front()) / num_steps);
  if (!has_times) return;
  message->stamp_ns += std::llround(time_grid.start * 1e9);
  message->time_increment = IsOnGrid(times, time_grid, kMaxTimeErrorS)
                                ? static_cast<float>(time_grid.step)
                                : std::numeric_limits<float>::quiet_NaN();  // not usable
}

}  // namespace

bool ReadPointCloud2(SerialReader reader, bool with_ranges, ScanLineMessage* message) {
  Layout layout;
  if (!reader.TakeHeader(&message->stamp_ns, &message->frame_id) ||
      !TakeLayout(&reader, &layout)) {
    return false;
  }
  message->angle_min = message->angle_increment = message->time_increment = 0.0f;
  message->range_min = message->range_max = 0.0f;
  message->num_beams = 0;
  std::vector<Point> points;
  message->is_planar = CollectPoints(layout, message->stamp_ns, &points);
  CountFromFirst(&points);
  OrderPoints(layout.time.has_value(), &points);
  if (message->is_planar && points.size() >= 2) {
    SetBeams(points, layout.time.has_value(), with_ranges, message);
  }
  return true;
}

}  // namespace plumbline
