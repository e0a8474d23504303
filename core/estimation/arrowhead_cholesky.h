#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <utility>
#include <vector>

#include "core/estimation/arrowhead_inverse.h"
#include "core/estimation/arrowhead_matrix.h"

namespace plumbline {

// When the border's variables are eliminated: all after the band, so that the inverse has all
// that they have in common; or each with the first subdomain outside of which nothing sees it,
// which takes less time and memory where planes are seen for a while only.
enum class BorderElimination { kLast, kNested };

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
  ArrowheadCholesky(ArrowheadMatrix matrix, BorderElimination border);

  int size() const { return num_band_ + static_cast<int>(corner_.size()); }
  // The solution for each column of the right side, in the right side's own memory.
  Eigen::MatrixXd Solve(Eigen::MatrixXd right_side) const;

  // The inverse's entries by Takahashi's recursion, from the last elimination to the first, in
  // the factorisation's own memory, which it takes away. CHECKs that the border came last.
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
    // Of what is seen, what is eliminated with the subdomain, after its tiles, and what is
    // not.
    std::vector<int> own;
    std::vector<int> kept;
    // Rows of the border that are own, and the others; the Cholesky factor of the former, and
    // the rows below it of the latter.
    std::vector<int> own_rows;
    std::vector<int> other_rows;
    Eigen::MatrixXd own_factor;
    Eigen::MatrixXd own_below;
  };
  // What eliminated subdomains have left on border variables.
  struct Front {
    std::vector<int> variables;  // ascending
    Eigen::MatrixXd lower;       // triangle

    void Add(const std::vector<int>& added, const Eigen::MatrixXd& block);
  };
  struct Level {
    std::vector<ArrowheadTile> tiles;
    std::vector<size_t> separators;  // positions of the tiles that the next level holds
    std::vector<Subdomain> subdomains;

    Eigen::Index NumRows(size_t subdomain) const;
  };

  static void Cut(Level* level);
  // Finds what each subdomain sees. fronts: by subdomain.
  static void FindSeen(const std::vector<Front>& fronts, Level* level);
  // Finds which variables are eliminated with a subdomain.
  void FindOwn(Level* level);
  // Takes the front that earlier levels left; adds to `rest`, the separators, and to the
  // fronts of the next level.
  void Eliminate(Level* level,
                 Subdomain* subdomain,
                 Front front,
                 std::vector<ArrowheadTile>* rest,
                 std::vector<Front>* fronts);
  // Eliminates the subdomain's own variables; schur: on its border, afterwards on the others.
  void EliminateOwn(int num_left, Subdomain* subdomain, Eigen::MatrixXd* schur);
  static void AddToRest(const Subdomain& subdomain,
                        const Eigen::MatrixXd& schur,
                        std::vector<ArrowheadTile>* rest,
                        Front* front);
  // Factors what no subdomain has eliminated.
  void FactorCorner(Front front);
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
  // Sets the rows of own variables in the border, too.
  static void Backward(const Level& level,
                       const Subdomain& subdomain,
                       Eigen::MatrixXd* border,
                       Eigen::MatrixXd* rows);
  // x: the border's rows, of which it sets those that came last.
  void SolveCorner(Eigen::Ref<Eigen::MatrixXd> x) const;
  // Rows of all variables in a subdomain's tiles, and of those in its last tile's border.
  static std::vector<int> TileRows(const Level& level, const Subdomain& subdomain);
  std::vector<int> BorderRows(const Level& level, const Subdomain& subdomain) const;

  int num_band_;
  int tile_size_;
  std::vector<Level> levels_;
  std::vector<std::vector<std::pair<int, double>>> corner_;  // as in ArrowheadMatrix
  BorderElimination border_;
  std::vector<bool> is_eliminated_;  // by border variable: with a subdomain
  std::vector<int> last_;            // border variables that are not
  Eigen::LLT<Eigen::MatrixXd> corner_factor_;
  Eigen::VectorXd corner_scale_;  // the factor is that of S corner S, S = diag(scale)

  friend class BorderSolver;
};

}  // namespace plumbline
