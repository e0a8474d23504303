#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace plumbline {

// LevelOrSlope is a floor or a ceiling that may slope: n.x = d in the model frame, n.z not 0.
struct LevelOrSlope {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  double distance = 0.0;  // m

  double HeightAt(const Eigen::Vector2d& p) const {
    return (distance - normal.head<2>().dot(p)) / normal.z();
  }
};

// FloorArea is one of the floors that meet in a storey, with what hangs above it.
struct FloorArea {
  LevelOrSlope floor;
  std::optional<LevelOrSlope> ceiling;  // none was seen
};

// FloorMap says on which of its floors a place of a storey lies: the one that was seen there,
// elsewhere the nearest one.
class FloorMap {
 public:
  // cells: where floors were seen, as x, y of the model frame (m) and a position in areas. Of
  // several in one square, the one that was seen most counts. There must be one at least.
  struct Sighting {
    Eigen::Vector2d p = Eigen::Vector2d::Zero();
    size_t area = 0;
  };
  FloorMap(std::vector<FloorArea> areas, const std::vector<Sighting>& sightings);

  const FloorArea& At(const Eigen::Vector2d& p) const;
  // The lowest and the highest floor wherever one was seen, model frame, m.
  double lowest_m() const { return lowest_m_; }
  double highest_m() const { return highest_m_; }

 private:
  size_t Index(const Eigen::Vector2d& p) const;  // of the square, the nearest one outside
  void FillFromNearest();

  std::vector<FloorArea> areas_;
  Eigen::AlignedBox2d box_;
  double cell_m_ = 0.0;
  int num_columns_ = 0;
  int num_rows_ = 0;
  std::vector<int> area_of_cell_;
  double lowest_m_ = 0.0;
  double highest_m_ = 0.0;
};

}  // namespace plumbline
