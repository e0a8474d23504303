#include "core/estimation/border_solver.h"

#include <glog/logging.h>

#include <algorithm>
#include <utility>

namespace plumbline {
namespace {

// Pieces of a level that wait for more. Loads reach over the end of a subdomain, and those of
// several scanners go back and forth over it.
constexpr size_t kNumOpen = 2;

// Makes room for this many columns, those that are new being zero.
void Reserve(Eigen::Index num_columns, Eigen::MatrixXd* matrix) {
  const Eigen::Index before = matrix->cols();
  if (num_columns <= before) return;
  matrix->conservativeResize(Eigen::NoChange, std::max(num_columns, before + before / 2));
  matrix->rightCols(matrix->cols() - before).setZero();
}

}  // namespace

BorderSolver::BorderSolver(const ArrowheadCholesky& factor)
    : factor_(factor),
      num_border_(factor.size() - factor.num_band_),
      open_(factor.levels_.size()),
      border_(num_border_, 0) {}

Eigen::Ref<Eigen::VectorXd> BorderSolver::BorderColumn(int column) {
  num_columns_ = std::max<Eigen::Index>(num_columns_, column + 1);
  Reserve(num_columns_, &border_);
  return border_.col(column);
}

void BorderSolver::AddToBorder(int row,
                               const Eigen::Ref<const Eigen::MatrixXd>& loads,
                               const std::vector<int>& columns) {
  for (Eigen::Index j = 0; j < loads.cols(); ++j) {
    BorderColumn(columns[static_cast<size_t>(j)]).segment(row, loads.rows()) += loads.col(j);
  }
}

void BorderSolver::AddToBand(int row,
                             const Eigen::Ref<const Eigen::MatrixXd>& loads,
                             const std::vector<int>& columns) {
  for (Eigen::Index done = 0; done < loads.rows();) {
    const int first = row + static_cast<int>(done);
    const int at = first % factor_.tile_size_;
    const Eigen::Index size =
        std::min<Eigen::Index>(loads.rows() - done, factor_.tile_size_ - at);
    AddToTile(0,
              static_cast<size_t>(first / factor_.tile_size_),
              at,
              loads.middleRows(done, size),
              columns);
    done += size;
  }
}

BorderSolver::Piece& BorderSolver::PieceOf(size_t level, size_t subdomain) {
  std::vector<Piece>& open = open_[level];
  const auto found = std::find_if(open.begin(), open.end(), [&](const Piece& piece) {
    return piece.subdomain == subdomain;
  });
  if (found != open.end()) {
    if (&*found != &open.back()) std::rotate(found, found + 1, open.end());
    return open.back();
  }
  if (open.size() == kNumOpen) {
    Piece oldest = std::move(open.front());
    open.erase(open.begin());
    Eliminate(level, std::move(oldest));
  }
  Piece& piece = open.emplace_back();
  piece.subdomain = subdomain;
  piece.rows.resize(factor_.levels_[level].NumRows(subdomain), 0);
  return piece;
}

void BorderSolver::AddToTile(size_t level,
                             size_t tile,
                             int at,
                             const Eigen::Ref<const Eigen::MatrixXd>& block,
                             const std::vector<int>& columns) {
  const std::vector<size_t>& separators = factor_.levels_[level].separators;
  const auto next = std::lower_bound(separators.begin(), separators.end(), tile);
  const auto subdomain = static_cast<size_t>(next - separators.begin());
  if (next != separators.end() && *next == tile) {
    AddToTile(level + 1, subdomain, at, block, columns);
    return;
  }
  Piece& piece = PieceOf(level, subdomain);
  const size_t begin = factor_.levels_[level].subdomains[subdomain].begin;
  const Eigen::Index row = static_cast<Eigen::Index>(tile - begin) * factor_.tile_size_ + at;
  for (Eigen::Index j = 0; j < block.cols(); ++j) {
    const int column = columns[static_cast<size_t>(j)];
    const auto [position, is_new] =
        piece.positions.try_emplace(column, static_cast<int>(piece.columns.size()));
    if (is_new) {
      piece.columns.push_back(column);
      Reserve(static_cast<Eigen::Index>(piece.columns.size()), &piece.rows);
    }
    piece.rows.col(position->second).segment(row, block.rows()) += block.col(j);
  }
}

void BorderSolver::Eliminate(size_t level, Piece piece) {
  const ArrowheadCholesky::Subdomain& subdomain =
      factor_.levels_[level].subdomains[piece.subdomain];
  const Eigen::Index num_left = subdomain.left < 0 ? 0 : factor_.tile_size_;
  const Eigen::Index num_right = subdomain.right < 0 ? 0 : factor_.tile_size_;
  const auto num_seen = static_cast<Eigen::Index>(subdomain.seen.size());
  const auto num_columns = static_cast<Eigen::Index>(piece.columns.size());
  piece.rows.conservativeResize(Eigen::NoChange, num_columns);
  Eigen::MatrixXd left_over =
      Eigen::MatrixXd::Zero(num_left + num_seen + num_right, num_columns);
  ArrowheadCholesky::Forward(factor_.levels_[level], subdomain, &piece.rows, &left_over);
  for (Eigen::Index j = 0; j < num_columns; ++j) {
    Eigen::Ref<Eigen::VectorXd> column = BorderColumn(piece.columns[static_cast<size_t>(j)]);
    for (Eigen::Index i = 0; i < num_seen; ++i) {
      column[subdomain.seen[static_cast<size_t>(i)]] += left_over(num_left + i, j);
    }
  }
  if (num_left > 0) {
    AddToTile(level + 1,
              static_cast<size_t>(subdomain.left),
              0,
              left_over.topRows(num_left),
              piece.columns);
  }
  if (num_right > 0) {
    AddToTile(level + 1,
              static_cast<size_t>(subdomain.right),
              0,
              left_over.bottomRows(num_right),
              piece.columns);
  }
}

Eigen::MatrixXd BorderSolver::TakeSolution() {
  for (size_t level = 0; level < open_.size(); ++level) {
    for (Piece& piece : std::exchange(open_[level], {})) Eliminate(level, std::move(piece));
  }
  border_.conservativeResize(Eigen::NoChange, num_columns_);
  factor_.SolveCorner(border_);
  return std::move(border_);
}

}  // namespace plumbline
