#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <unordered_map>

#include "core/util/last_found.h"

namespace plumbline {

// A direction in which a cell says where its surface lies.
struct SurfaceDirection {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // to the side that was seen
  double variance = 0.0;                              // m^2, of the cell's points along it
};

// LocalCell holds the normal distribution of the points in one cell of space.
class LocalCell {
 public:
  explicit LocalCell(const Eigen::Vector3d& centre_world) : centre_(centre_world) {}

  // from_world: the scanner.
  void Add(const Eigen::Vector3d& p_world,
           const Eigen::Vector3d& from_world,
           double scan_normal_z,
           int scan_index);
  // Whether the points are of a surface's other side than the one that this point is on, which
  // a scanner sees from there.
  bool IsOtherSide(const Eigen::Vector3d& p_world, const Eigen::Vector3d& from_world) const;

  int num_points() const { return num_points_; }
  int last_scan() const { return last_scan_; }
  int age_scans() const { return last_scan_ - first_scan_; }
  void Touch(int scan_index) { last_scan_ = scan_index; }
  Eigen::Vector3d Mean() const { return centre_ + sum_ / num_points_; }
  // The directions that the points determine: at most two.
  int num_directions() const { return num_directions_; }
  const SurfaceDirection& direction(int i) const {
    return directions_[static_cast<size_t>(i)];
  }

 private:
  friend class LocalMap;
  // Finds the directions anew.
  void Determine(bool planar, double cell_m);

  Eigen::Vector3d centre_;
  Eigen::Vector3d sum_ = Eigen::Vector3d::Zero();        // of p - centre
  Eigen::Matrix3d products_ = Eigen::Matrix3d::Zero();   // of p - centre with themselves
  Eigen::Vector3d sum_views_ = Eigen::Vector3d::Zero();  // from the points to the scanners
  double sum_scan_normal_z2_ = 0.0;
  int num_points_ = 0;
  int num_scans_ = 0;  // that the points are of
  int first_scan_ = 0;
  int last_scan_ = 0;
  int num_determined_ = 0;  // points when the directions were found
  int num_directions_ = 0;
  std::array<SurfaceDirection, 2> directions_;
};

// LocalMap holds what the scanners saw around the rig lately, plane or not: normal
// distributions of the points in cubes (Magnusson 2009, "The three-dimensional
// normal-distributions transform"), with two differences. A single scan line is thin across
// its scan plane whatever it meets: a cell gives only the directions that its points
// determine, across a patch that several sweeps have covered, or, for level scan planes,
// across a line or around a post, taken to be upright. A cell that has seen enough takes
// in no more points: it would follow the drift of the poses that it is to hold. And a wall has
// two sides, which lie in one cube where it is thinner than that: points that can not be seen
// from where the others were have a cell of their own.
class LocalMap {
 public:
  // min_age_scans: number of scans after which a cell counts: what somebody who walks along
  // with the rig leaves behind is no place.
  LocalMap(double cell_m, bool planar, int min_age_scans);

  // Adds a point that a scanner at from_world with this scan plane normal saw. Points of one
  // scan come together; scan_index never decreases. may_found: whether it may be the first of
  // its cell.
  void Add(const Eigen::Vector3d& p_world,
           const Eigen::Vector3d& from_world,
           const Eigen::Vector3d& scan_normal,
           int scan_index,
           bool may_found);
  // The cell of a point, seen from there, or nullptr where too little was seen.
  const LocalCell* Find(const Eigen::Vector3d& p_world,
                        const Eigen::Vector3d& from_world) const;
  // Forgets the cells that were not seen since this scan.
  void ForgetBefore(int scan_index);

 private:
  using Key = uint64_t;
  Key KeyOf(const Eigen::Vector3d& p_world) const;
  Eigen::Vector3d CentreOf(Key key) const;
  // The cell in one of the maps, made if there is none and it may be; or nullptr.
  LocalCell* CellIn(std::unordered_map<Key, LocalCell>* cells, Key key, bool may_found) const;

  double cell_m_;
  bool planar_;
  int min_age_scans_;
  std::unordered_map<Key, LocalCell> cells_;
  std::unordered_map<Key, LocalCell> other_sides_;  // of surfaces that cells_ has
  // The cell of the last point: most often it is that of the next one as well.
  LastFound<Key, LocalCell> last_;
};

}  // namespace plumbline
