#include "core/judging/doubled_surfaces.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/judging/verdict_levels.h"

namespace plumbline {
namespace {

constexpr double kMinSeparation = 0.015;  // m, above what flat walls and noise make
constexpr double kMaxSeparation = 1.0;    // m, farther apart no slip's planes would be missed
// Least number of cells that a pair covers: half a square metre. A moved chair has fewer.
constexpr int kMinCells = 8;
// Least number of seconds in which each surface of a pair was seen.
constexpr int kMinSeconds = 2;
// Seconds in which both were seen, of those of the one seen less, of a slip's pair at most:
// around the slip itself both may be.
constexpr double kMaxTogether = 0.15;

// Common cells and seconds of a pair.
struct Overlap {
  std::vector<std::pair<CellGrid::Cell, CellGrid::Cell>> cells;  // of a, of b
  double separation_m = 0.0;
};

std::vector<int> SecondsOfHits(const Sightings& sightings,
                               int landmark_id,
                               const std::vector<CellGrid::Cell>& cells) {
  std::vector<int> seconds;
  for (const CellGrid::Cell& cell : cells) {
    const auto [first, last] = sightings.Of(landmark_id, cell);
    for (const Sighting* one = first; one != last; ++one) {
      if (one->num_hits > 0) seconds.push_back(one->second);
    }
  }
  std::sort(seconds.begin(), seconds.end());
  seconds.erase(std::unique(seconds.begin(), seconds.end()), seconds.end());
  return seconds;
}

// How many of the seconds are, to one second, among the others.
int NumTogether(const std::vector<int>& seconds, const std::vector<int>& others) {
  return static_cast<int>(std::count_if(seconds.begin(), seconds.end(), [&](int second) {
    const auto at = std::lower_bound(others.begin(), others.end(), second - 1);
    return at != others.end() && *at <= second + 1;
  }));
}

class DoubleFinder {
 public:
  DoubleFinder(const MapState& state, const Sightings& sightings)
      : state_(state), sightings_(sightings) {}

  DoubledSurfaces Find() {
    found_.shares.resize(static_cast<size_t>(sightings_.num_seconds()));
    for (const Sighting& one : sightings_.all()) {
      if (one.num_hits > 0) found_.shares[static_cast<size_t>(one.second)].comparable += 1.0;
    }
    std::vector<const Landmark*> landmarks;
    for (const Landmark& landmark : state_.landmarks) {
      if (landmark.num_segments > 0 && landmark.extent.cells().num_occupied() >= kMinCells) {
        landmarks.push_back(&landmark);
      }
    }
    for (size_t i = 0; i < landmarks.size(); ++i) {
      for (size_t j = i + 1; j < landmarks.size(); ++j) Compare(*landmarks[i], *landmarks[j]);
    }
    Mark();
    return std::move(found_);
  }

 private:
  struct Doubled {
    Sighting key;
    double share = 0.0;
  };

  void Compare(const Landmark& a, const Landmark& b) {
    if (a.NormalNear(b.extent.Centre()).dot(b.NormalNear(b.extent.Centre())) <
        kSameDirection) {
      return;
    }
    if (std::abs(a.SignedDistance(b.extent.Centre())) > 3.0 * kMaxSeparation) return;
    if (!a.extent.MayBeNear(b.extent, 0.0)) return;
    const Overlap overlap = OverlapOf(a, b);
    if (static_cast<int>(overlap.cells.size()) < kMinCells) return;
    std::vector<CellGrid::Cell> cells_a;
    std::vector<CellGrid::Cell> cells_b;
    for (const auto& [cell_a, cell_b] : overlap.cells) {
      cells_a.push_back(cell_a);
      cells_b.push_back(cell_b);
    }
    std::sort(cells_a.begin(), cells_a.end());
    cells_a.erase(std::unique(cells_a.begin(), cells_a.end()), cells_a.end());
    const std::vector<int> seconds_a = SecondsOfHits(sightings_, a.id, cells_a);
    const std::vector<int> seconds_b = SecondsOfHits(sightings_, b.id, cells_b);
    const size_t fewer = std::min(seconds_a.size(), seconds_b.size());
    if (fewer < kMinSeconds) return;
    const int together =
        std::min(NumTogether(seconds_a, seconds_b), NumTogether(seconds_b, seconds_a));
    if (together > kMaxTogether * static_cast<double>(fewer)) return;
    found_.pairs.push_back({a.id,
                            b.id,
                            overlap.separation_m,
                            PatchExtent::kCellSize * PatchExtent::kCellSize *
                                static_cast<double>(overlap.cells.size())});
    const auto num_a = static_cast<double>(seconds_a.size());
    const auto num_b = static_cast<double>(seconds_b.size());
    Note(a.id, cells_a, num_b / (num_a + num_b));
    Note(b.id, cells_b, num_a / (num_a + num_b));
  }

  // The cells that both have, and their mean separation.
  static Overlap OverlapOf(const Landmark& a, const Landmark& b) {
    Overlap overlap;
    double sum = 0.0;
    b.extent.cells().Any([&](const CellGrid::Cell& cell_b, int) {
      const Eigen::Vector2d middle((cell_b.first + 0.5) * PatchExtent::kCellSize,
                                   (cell_b.second + 0.5) * PatchExtent::kCellSize);
      const Eigen::Vector3d p_world = b.extent.ToWorld(middle);
      const double separation = std::abs(a.SignedDistance(p_world));
      if (separation < kMinSeparation || separation > kMaxSeparation) return false;
      const CellGrid::Cell cell_a = PatchExtent::CellAt(a.extent.Project(p_world));
      if (a.extent.cells().Count(cell_a) == 0) return false;
      overlap.cells.emplace_back(cell_a, cell_b);
      sum += separation;
      return false;
    });
    if (!overlap.cells.empty()) {
      overlap.separation_m = sum / static_cast<double>(overlap.cells.size());
    }
    return overlap;
  }

  void Note(int landmark_id, const std::vector<CellGrid::Cell>& cells, double share) {
    for (const CellGrid::Cell& cell : cells) {
      doubled_.push_back({{landmark_id, cell, 0, 0, 0}, share});
    }
  }

  // Gives each second the doubled cells that it hit, each once.
  void Mark() {
    const auto key = [](const Doubled& one) {
      return std::make_pair(one.key.landmark_id, one.key.cell);
    };
    std::sort(doubled_.begin(), doubled_.end(), [&](const Doubled& a, const Doubled& b) {
      return key(a) != key(b) ? key(a) < key(b) : a.share > b.share;
    });
    for (size_t i = 0; i < doubled_.size(); ++i) {
      if (i > 0 && key(doubled_[i]) == key(doubled_[i - 1])) continue;
      const auto [first, last] =
          sightings_.Of(doubled_[i].key.landmark_id, doubled_[i].key.cell);
      for (const Sighting* one = first; one != last; ++one) {
        if (one->num_hits == 0) continue;
        found_.shares[static_cast<size_t>(one->second)].contradicted += doubled_[i].share;
      }
    }
  }

  const MapState& state_;
  const Sightings& sightings_;
  DoubledSurfaces found_;
  std::vector<Doubled> doubled_;
};

}  // namespace

DoubledSurfaces FindDoubledSurfaces(const MapState& state, const Sightings& sightings) {
  return DoubleFinder(state, sightings).Find();
}

}  // namespace plumbline
