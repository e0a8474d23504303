#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <utility>
#include <vector>

#include "core/estimation/arrowhead_matrix.h"

namespace plumbline {

// ArrowheadInverse holds the entries of the inverse within and between adjacent tiles, and its
// border.
class ArrowheadInverse {
 public:
  ArrowheadInverse() = default;
  ArrowheadInverse(int tile_size, std::vector<ArrowheadTile> tiles, Eigen::MatrixXd border)
      : tile_size_(tile_size), tiles_(std::move(tiles)), border_(std::move(border)) {}

  // Rows and columns first .. first + size - 1 of the band, within two adjacent tiles.
  Eigen::MatrixXd BandBlock(int first, int size) const;
  const Eigen::MatrixXd& border() const { return border_; }

  // Sets this variable's row and column to zero; only for one that no other depends on.
  void Clear(int variable);

 private:
  int tile_size_ = 1;
  std::vector<ArrowheadTile> tiles_;  // diagonal in full
  Eigen::MatrixXd border_;
};

// ArrowheadCholesky factorises a block arrowhead matrix. The band is cut into subdomains of a
// few tiles, each followed by a tile that separates it from the next. Given its two separators
// and the planes seen from it, a subdomain is independent of all others, so that it is
// eliminated with no more than these in its border; the separators, with what the subdomains
// leave on them, are a block arrowhead matrix again, and so on until one subdomain is left.
// Time and memory grow with the band's length, times the planes that are seen together, not
// with all planes (nested dissection: George 1973).
class ArrowheadCholesky {
 public:
  // Throws Error when the matrix is not positive definite.
  explicit ArrowheadCholesky(ArrowheadMatrix matrix);

  int size() const { return num_band_ + static_cast<int>(corner_scale_.size()); }
  // The solution for each column of the right side, in the right side's own memory.
  Eigen::MatrixXd Solve(Eigen::MatrixXd right_side) const;

  // The inverse's entries by Takahashi's recursion, from the last elimination to the first, in
  // the factorisation's own memory, which it takes away.
  ArrowheadInverse TakeInverse();

 private:
  // Tiles begin .. end - 1, eliminated together. Their borders' rows afterwards:
  // [ left separator | seen | right separator, in the last tile only ].
  struct Subdomain {
    size_t begin = 0;
    size_t end = 0;
    int left = -1;  // position among the level's separators, -1: none
    int right = -1;
    std::vector<int> seen;
  };
  struct Level {
    std::vector<ArrowheadTile> tiles;
    std::vector<size_t> separators;  // positions of the tiles that the next level holds
    std::vector<Subdomain> subdomains;

    Eigen::Index NumRows(size_t subdomain) const;
  };

  static void Cut(Level* level);
  // Adds to `rest`, the separators, and to the corner.
  void Eliminate(Level* level, Subdomain* subdomain, std::vector<ArrowheadTile>* rest);
  void AddToRest(const Subdomain& subdomain,
                 const Eigen::MatrixXd& schur,
                 std::vector<ArrowheadTile>* rest);
  // The inverse on a subdomain's border, from that on the next level's tiles.
  Eigen::MatrixXd BorderInverse(const Subdomain& subdomain,
                                const std::vector<ArrowheadTile>& rest,
                                const Eigen::MatrixXd& corner) const;
  static void Invert(const Eigen::MatrixXd& border_inverse,
                     int num_right,
                     const Subdomain& subdomain,
                     std::vector<ArrowheadTile>* tiles);
  // Substitution through a subdomain. rows: of its tiles, one below the other; border: rows of
  // [ left separator | seen | right separator ], which Forward() takes from.
  static void Forward(const Level& level,
                      const Subdomain& subdomain,
                      Eigen::MatrixXd* rows,
                      Eigen::MatrixXd* border);
  static void Backward(const Level& level,
                       const Subdomain& subdomain,
                       const Eigen::MatrixXd& border,
                       Eigen::MatrixXd* rows);
  void SolveCorner(Eigen::Ref<Eigen::MatrixXd> x) const;
  // Rows of all variables in a subdomain's tiles, and of those in its last tile's border.
  static std::vector<int> TileRows(const Level& level, const Subdomain& subdomain);
  std::vector<int> BorderRows(const Level& level, const Subdomain& subdomain) const;

  int num_band_;
  int tile_size_;
  std::vector<Level> levels_;
  Eigen::MatrixXd corner_;  // lower triangle, until it is factored
  Eigen::LLT<Eigen::MatrixXd> corner_factor_;
  Eigen::VectorXd corner_scale_;  // the factor is that of S corner S, S = diag(scale)

  friend class BorderSolver;
};

}  // namespace plumbline
