#include "core/estimation/arrowhead_cholesky.h"

#include <glog/logging.h>

#include <algorithm>
#include <iterator>
#include <numeric>

#include "core/util/error.h"

namespace plumbline {
namespace {

// Tiles of a subdomain. Longer ones see more planes, shorter ones leave more separators.
constexpr size_t kPieceTiles = 8;

// The Cholesky factorisation of an eliminated tile, and its transpose.
auto LowerOf(const ArrowheadTile& tile) {
  return tile.diagonal.triangularView<Eigen::Lower>();
}
auto UpperOf(const ArrowheadTile& tile) {
  return tile.diagonal.transpose().triangularView<Eigen::Upper>();
}

}  // namespace

ArrowheadCholesky::ArrowheadCholesky(ArrowheadMatrix matrix, BorderElimination border)
    : num_band_(matrix.num_band_),
      tile_size_(matrix.tile_size_),
      corner_(std::move(matrix.corner_)),
      border_(border),
      is_eliminated_(corner_.size(), false) {
  std::vector<ArrowheadTile> tiles = std::move(matrix.tiles_);
  std::vector<Front> fronts;
  while (!tiles.empty()) {
    Level& level = levels_.emplace_back();
    level.tiles = std::move(tiles);
    Cut(&level);
    fronts.resize(level.subdomains.size());
    FindSeen(fronts, &level);
    FindOwn(&level);
    tiles.clear();
    for (size_t i = 0; i < level.separators.size(); ++i) {
      ArrowheadTile& from = level.tiles[level.separators[i]];
      ArrowheadTile separator = from;
      from.diagonal.resize(0, 0);
      from.border.resize(0, 0);
      const int num_next =
          i + 1 < level.separators.size() ? level.tiles[level.separators[i + 1]].size() : 0;
      separator.next.setZero(num_next, separator.size());
      tiles.push_back(std::move(separator));
    }
    std::vector<Front> next_fronts(tiles.size() / (kPieceTiles + 1) + 1);
    for (size_t i = 0; i < level.subdomains.size(); ++i) {
      Eliminate(&level, &level.subdomains[i], std::move(fronts[i]), &tiles, &next_fronts);
    }
    fronts = std::move(next_fronts);
  }
  FactorCorner(fronts.empty() ? Front() : std::move(fronts.front()));
}

void ArrowheadCholesky::FactorCorner(Front front) {
  std::vector<int> positions(corner_.size(), -1);
  for (size_t variable = 0; variable < corner_.size(); ++variable) {
    if (is_eliminated_[variable]) continue;
    positions[variable] = static_cast<int>(last_.size());
    last_.push_back(static_cast<int>(variable));
  }
  const auto size = static_cast<Eigen::Index>(last_.size());
  // Makes room for what no tile sees.
  if (front.variables != last_) front.Add(last_, Eigen::MatrixXd::Zero(size, size));
  Eigen::MatrixXd corner = std::move(front.lower);
  for (const int variable : last_) {
    const int column = positions[static_cast<size_t>(variable)];
    for (const auto& [other, value] : corner_[static_cast<size_t>(variable)]) {
      const int row = positions[static_cast<size_t>(other)];
      if (row >= column) corner(row, column) += value;
    }
  }
  // Scaled to a unit diagonal, so that metres and radians do not spoil the condition.
  corner_scale_ = corner.diagonal().cwiseSqrt().cwiseInverse();
  corner_factor_.compute(corner_scale_.asDiagonal() * corner * corner_scale_.asDiagonal());
  if (size > 0 && corner_factor_.info() != Eigen::Success) {
    throw Error("the scans do not determine where the planes lie");
  }
}

void ArrowheadCholesky::Cut(Level* level) {
  const size_t count = level->tiles.size();
  for (size_t begin = 0; begin < count;) {
    Subdomain subdomain;
    subdomain.begin = begin;
    subdomain.end = begin + kPieceTiles;
    subdomain.left = static_cast<int>(level->separators.size()) - 1;
    if (subdomain.end + 1 < count) {
      level->separators.push_back(subdomain.end);
      subdomain.right = subdomain.left + 1;
    } else {
      subdomain.end = count;
    }
    begin = subdomain.end + 1;
    level->subdomains.push_back(std::move(subdomain));
  }
}

void ArrowheadCholesky::FindSeen(const std::vector<Front>& fronts, Level* level) {
  for (size_t i = 0; i < level->subdomains.size(); ++i) {
    Subdomain& subdomain = level->subdomains[i];
    subdomain.seen = fronts[i].variables;
    for (size_t k = subdomain.begin; k < subdomain.end; ++k) {
      const std::vector<int>& of_tile = level->tiles[k].seen;
      std::vector<int> all;
      std::set_union(subdomain.seen.begin(),
                     subdomain.seen.end(),
                     of_tile.begin(),
                     of_tile.end(),
                     std::back_inserter(all));
      subdomain.seen = std::move(all);
    }
  }
}

void ArrowheadCholesky::FindOwn(Level* level) {
  std::vector<int> num_places(corner_.size(), 0);  // subdomains and separators that see it
  for (const Subdomain& subdomain : level->subdomains) {
    for (const int variable : subdomain.seen) ++num_places[static_cast<size_t>(variable)];
  }
  for (const size_t separator : level->separators) {
    for (const int variable : level->tiles[separator].seen) {
      ++num_places[static_cast<size_t>(variable)];
    }
  }
  for (Subdomain& subdomain : level->subdomains) {
    const std::vector<int>& seen = subdomain.seen;
    const auto is_own = [&](int variable) {
      const auto& column = corner_[static_cast<size_t>(variable)];
      return border_ == BorderElimination::kNested &&
             num_places[static_cast<size_t>(variable)] == 1 &&
             std::all_of(column.begin(), column.end(), [&](const auto& entry) {
               return is_eliminated_[static_cast<size_t>(entry.first)] ||
                      std::binary_search(seen.begin(), seen.end(), entry.first);
             });
    };
    std::partition_copy(seen.begin(),
                        seen.end(),
                        std::back_inserter(subdomain.own),
                        std::back_inserter(subdomain.kept),
                        is_own);
  }
}

void ArrowheadCholesky::EliminateOwn(int num_left,
                                     Subdomain* subdomain,
                                     Eigen::MatrixXd* schur) {
  const auto row_of = [&](int variable) {
    return num_left + PositionsOf({variable}, subdomain->seen).front();
  };
  for (const int variable : subdomain->own) {
    const int row = row_of(variable);
    for (const auto& [other, value] : corner_[static_cast<size_t>(variable)]) {
      if (is_eliminated_[static_cast<size_t>(other)]) continue;
      const int other_row = row_of(other);
      (*schur)(std::max(row, other_row), std::min(row, other_row)) += value;
    }
    is_eliminated_[static_cast<size_t>(variable)] = true;  // with all its entries
    subdomain->own_rows.push_back(row);
  }
  std::vector<int> rows(static_cast<size_t>(schur->rows()));
  std::iota(rows.begin(), rows.end(), 0);
  std::set_difference(rows.begin(),
                      rows.end(),
                      subdomain->own_rows.begin(),
                      subdomain->own_rows.end(),
                      std::back_inserter(subdomain->other_rows));
  const Eigen::MatrixXd full = schur->selfadjointView<Eigen::Lower>();
  const Eigen::LLT<Eigen::MatrixXd> factor(full(subdomain->own_rows, subdomain->own_rows));
  if (factor.info() != Eigen::Success) {
    throw Error("the scans do not determine where the planes lie");
  }
  subdomain->own_factor = factor.matrixL();
  subdomain->own_below = full(subdomain->other_rows, subdomain->own_rows);
  factor.matrixU().solveInPlace<Eigen::OnTheRight>(subdomain->own_below);
  *schur = full(subdomain->other_rows, subdomain->other_rows);
  schur->selfadjointView<Eigen::Lower>().rankUpdate(subdomain->own_below, -1.0);
}

void ArrowheadCholesky::Eliminate(Level* level,
                                  Subdomain* subdomain,
                                  Front front,
                                  std::vector<ArrowheadTile>* rest,
                                  std::vector<Front>* fronts) {
  std::vector<ArrowheadTile>& tiles = level->tiles;
  const Eigen::Index num_left =
      subdomain->left < 0 ? 0 : (*rest)[static_cast<size_t>(subdomain->left)].size();
  const Eigen::Index num_right =
      subdomain->right < 0 ? 0 : (*rest)[static_cast<size_t>(subdomain->right)].size();
  const Eigen::Index num_first = num_left + static_cast<Eigen::Index>(subdomain->seen.size());
  Eigen::MatrixXd schur = Eigen::MatrixXd::Zero(num_first + num_right, num_first + num_right);
  for (size_t k = subdomain->begin; k < subdomain->end; ++k) {
    ArrowheadTile& tile = tiles[k];
    const bool last = k + 1 == subdomain->end;
    Eigen::MatrixXd border =
        Eigen::MatrixXd::Zero(num_first + (last ? num_right : 0), tile.size());
    std::vector<int> rows = PositionsOf(tile.seen, subdomain->seen);
    for (int& row : rows) row += static_cast<int>(num_left);
    border(rows, Eigen::all) = tile.border;
    if (k == subdomain->begin) {
      if (num_left > 0) border.topRows(num_left) = tiles[k - 1].next.transpose();
    } else {
      const ArrowheadTile& before = tiles[k - 1];
      tile.diagonal.selfadjointView<Eigen::Lower>().rankUpdate(before.next, -1.0);
      border.topRows(num_first).noalias() -= before.border * before.next.transpose();
    }
    if (last && num_right > 0) {
      border.bottomRows(num_right) = tile.next;
      tile.next.resize(0, tile.size());
    }
    const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factor(tile.diagonal);
    if (factor.info() != Eigen::Success) {
      throw Error("the scans do not determine the trajectory");
    }
    UpperOf(tile).solveInPlace<Eigen::OnTheRight>(border);
    UpperOf(tile).solveInPlace<Eigen::OnTheRight>(tile.next);
    schur.topLeftCorner(border.rows(), border.rows())
        .selfadjointView<Eigen::Lower>()
        .rankUpdate(border, -1.0);
    tile.border = std::move(border);
    tile.seen.clear();
  }
  std::vector<int> in_front = PositionsOf(front.variables, subdomain->seen);
  for (int& row : in_front) row += static_cast<int>(num_left);
  schur(in_front, in_front) += front.lower;
  front = Front();  // of a long recording, memory
  if (!subdomain->own.empty()) {
    EliminateOwn(static_cast<int>(num_left), subdomain, &schur);
  }
  // It goes to one of the next level's subdomains that has a tile beside this one.
  const auto is_separator = [&](size_t tile) {
    return tile % (kPieceTiles + 1) == kPieceTiles && tile + 1 < rest->size();
  };
  auto beside = static_cast<size_t>(std::max(0, subdomain->right));
  if (subdomain->left >= 0 && (subdomain->right < 0 || is_separator(beside))) {
    beside = static_cast<size_t>(subdomain->left);
  }
  AddToRest(*subdomain, schur, rest, &(*fronts)[beside / (kPieceTiles + 1)]);
}

void ArrowheadCholesky::AddToRest(const Subdomain& subdomain,
                                  const Eigen::MatrixXd& schur,
                                  std::vector<ArrowheadTile>* rest,
                                  Front* front) {
  const std::vector<int>& kept = subdomain.kept;
  const auto num_kept = static_cast<Eigen::Index>(kept.size());
  Eigen::Index at = 0;
  if (subdomain.left >= 0) {
    ArrowheadTile& left = (*rest)[static_cast<size_t>(subdomain.left)];
    const Eigen::Index size = left.size();
    left.diagonal += schur.topLeftCorner(size, size);
    left.AddBorder(kept, schur.block(size, 0, num_kept, size));
    if (subdomain.right >= 0) left.next += schur.bottomLeftCorner(left.next.rows(), size);
    at = size;
  }
  front->Add(kept, schur.block(at, at, num_kept, num_kept));
  if (subdomain.right < 0) return;
  ArrowheadTile& right = (*rest)[static_cast<size_t>(subdomain.right)];
  const Eigen::Index size = right.size();
  right.diagonal += schur.bottomRightCorner(size, size);
  right.AddBorder(kept, schur.block(at + num_kept, at, size, num_kept).transpose());
}

void ArrowheadCholesky::Front::Add(const std::vector<int>& added,
                                   const Eigen::MatrixXd& block) {
  std::vector<int> all;
  std::set_union(
      variables.begin(), variables.end(), added.begin(), added.end(), std::back_inserter(all));
  if (all.size() > variables.size()) {
    const auto size = static_cast<Eigen::Index>(all.size());
    Eigen::MatrixXd larger = Eigen::MatrixXd::Zero(size, size);
    const std::vector<int> before = PositionsOf(variables, all);
    larger(before, before) = lower;
    lower = std::move(larger);
    variables = std::move(all);
  }
  const std::vector<int> at = PositionsOf(added, variables);
  lower(at, at) += block;
}

std::vector<int> ArrowheadCholesky::BorderRows(const Level& level,
                                               const Subdomain& subdomain) const {
  std::vector<int> rows;
  // Only the band's last tile may be smaller than the others, and it is no separator.
  const auto add_tile = [&](int separator) {
    if (separator < 0) return;
    const int first = level.tiles[level.separators[static_cast<size_t>(separator)]].first;
    for (int row = first; row < first + tile_size_; ++row) rows.push_back(row);
  };
  add_tile(subdomain.left);
  for (const int variable : subdomain.seen) rows.push_back(num_band_ + variable);
  add_tile(subdomain.right);
  return rows;
}

std::vector<int> ArrowheadCholesky::TileRows(const Level& level, const Subdomain& subdomain) {
  std::vector<int> rows;
  for (size_t k = subdomain.begin; k < subdomain.end; ++k) {
    for (int i = 0; i < level.tiles[k].size(); ++i) rows.push_back(level.tiles[k].first + i);
  }
  return rows;
}

Eigen::Index ArrowheadCholesky::Level::NumRows(size_t subdomain) const {
  Eigen::Index sum = 0;
  for (size_t k = subdomains[subdomain].begin; k < subdomains[subdomain].end; ++k) {
    sum += tiles[k].size();
  }
  return sum;
}

void ArrowheadCholesky::Forward(const Level& level,
                                const Subdomain& subdomain,
                                Eigen::MatrixXd* rows,
                                Eigen::MatrixXd* border) {
  Eigen::Index at = 0;
  for (size_t k = subdomain.begin; k < subdomain.end; ++k) {
    const ArrowheadTile& tile = level.tiles[k];
    auto y = rows->middleRows(at, tile.size());
    if (k > subdomain.begin) {
      const ArrowheadTile& before = level.tiles[k - 1];
      y.noalias() -= before.next * rows->middleRows(at - before.size(), before.size());
    }
    LowerOf(tile).solveInPlace(y);
    border->topRows(tile.border.rows()).noalias() -= tile.border * y;
    at += tile.size();
  }
  if (subdomain.own.empty()) return;
  Eigen::MatrixXd own = (*border)(subdomain.own_rows, Eigen::all);
  subdomain.own_factor.triangularView<Eigen::Lower>().solveInPlace(own);
  (*border)(subdomain.own_rows, Eigen::all) = own;
  (*border)(subdomain.other_rows, Eigen::all) -= subdomain.own_below * own;
}

void ArrowheadCholesky::Backward(const Level& level,
                                 const Subdomain& subdomain,
                                 Eigen::MatrixXd* border,
                                 Eigen::MatrixXd* rows) {
  if (!subdomain.own.empty()) {
    Eigen::MatrixXd own = (*border)(subdomain.own_rows, Eigen::all);
    own.noalias() -=
        subdomain.own_below.transpose() * (*border)(subdomain.other_rows, Eigen::all);
    subdomain.own_factor.transpose().triangularView<Eigen::Upper>().solveInPlace(own);
    (*border)(subdomain.own_rows, Eigen::all) = own;
  }
  Eigen::Index at = rows->rows();
  for (size_t k = subdomain.end; k-- > subdomain.begin;) {
    const ArrowheadTile& tile = level.tiles[k];
    at -= tile.size();
    auto y = rows->middleRows(at, tile.size());
    y.noalias() -= tile.border.transpose() * border->topRows(tile.border.rows());
    if (k + 1 < subdomain.end) {
      y.noalias() -= tile.next.transpose() *
                     rows->middleRows(at + tile.size(), level.tiles[k + 1].size());
    }
    UpperOf(tile).solveInPlace(y);
  }
}

void ArrowheadCholesky::SolveCorner(Eigen::Ref<Eigen::MatrixXd> x) const {
  if (last_.empty()) return;
  Eigen::MatrixXd last = corner_scale_.asDiagonal() * x(last_, Eigen::all);
  corner_factor_.solveInPlace(last);
  x(last_, Eigen::all) = corner_scale_.asDiagonal() * last;
}

Eigen::MatrixXd ArrowheadCholesky::Solve(Eigen::MatrixXd right_side) const {
  Eigen::MatrixXd& x = right_side;
  for (const Level& level : levels_) {
    for (const Subdomain& subdomain : level.subdomains) {
      const std::vector<int> tiles = TileRows(level, subdomain);
      const std::vector<int> borders = BorderRows(level, subdomain);
      Eigen::MatrixXd rows = x(tiles, Eigen::all);
      Eigen::MatrixXd border = x(borders, Eigen::all);
      Forward(level, subdomain, &rows, &border);
      x(tiles, Eigen::all) = rows;
      x(borders, Eigen::all) = border;
    }
  }
  SolveCorner(x.bottomRows(x.rows() - num_band_));
  for (auto level = levels_.rbegin(); level != levels_.rend(); ++level) {
    for (const Subdomain& subdomain : level->subdomains) {
      const std::vector<int> tiles = TileRows(*level, subdomain);
      const std::vector<int> borders = BorderRows(*level, subdomain);
      Eigen::MatrixXd rows = x(tiles, Eigen::all);
      Eigen::MatrixXd border = x(borders, Eigen::all);
      Backward(*level, subdomain, &border, &rows);
      x(tiles, Eigen::all) = rows;
      x(borders, Eigen::all) = border;
    }
  }
  return right_side;
}

Eigen::MatrixXd ArrowheadCholesky::BorderInverse(const Subdomain& subdomain,
                                                 const std::vector<ArrowheadTile>& rest,
                                                 const Eigen::MatrixXd& corner) const {
  const auto tile_at = [&](int separator) {
    return separator < 0 ? nullptr : &rest[static_cast<size_t>(separator)];
  };
  const ArrowheadTile* left = tile_at(subdomain.left);
  const ArrowheadTile* right = tile_at(subdomain.right);
  const Eigen::Index num_left = left == nullptr ? 0 : left->size();
  const Eigen::Index num_right = right == nullptr ? 0 : right->size();
  const auto num_seen = static_cast<Eigen::Index>(subdomain.seen.size());
  const Eigen::Index size = num_left + num_seen + num_right;
  Eigen::MatrixXd lower = Eigen::MatrixXd::Zero(size, size);
  lower.block(num_left, num_left, num_seen, num_seen) = corner(subdomain.seen, subdomain.seen);
  if (left != nullptr) {
    lower.topLeftCorner(num_left, num_left) = left->diagonal;
    lower.block(num_left, 0, num_seen, num_left) =
        left->border(PositionsOf(subdomain.seen, left->seen), Eigen::all);
  }
  if (right != nullptr) {
    lower.bottomRightCorner(num_right, num_right) = right->diagonal;
    lower.block(num_left + num_seen, num_left, num_right, num_seen) =
        right->border(PositionsOf(subdomain.seen, right->seen), Eigen::all).transpose();
  }
  if (left != nullptr && right != nullptr) {
    lower.bottomLeftCorner(num_right, num_left) = left->next;
  }
  return lower.selfadjointView<Eigen::Lower>();
}

// With M = [ next; border ] L^-1 below a tile's pivot and Z the inverse on those rows,
//   Z_below,k = -Z M,    Z_kk = L^-T L^-1 - M^T Z_below,k.
void ArrowheadCholesky::Invert(const Eigen::MatrixXd& border_inverse,
                               int num_right,
                               const Subdomain& subdomain,
                               std::vector<ArrowheadTile>* tiles) {
  const Eigen::Index num_first = border_inverse.rows() - num_right;
  for (size_t k = subdomain.end; k-- > subdomain.begin;) {
    ArrowheadTile& tile = (*tiles)[k];
    const bool last = k + 1 == subdomain.end;
    const Eigen::Index num_border = tile.border.rows();
    Eigen::MatrixXd inverse_root = Eigen::MatrixXd::Identity(tile.size(), tile.size());
    LowerOf(tile).solveInPlace(inverse_root);
    const Eigen::MatrixXd below = tile.border * inverse_root;
    Eigen::MatrixXd border = -border_inverse.topLeftCorner(num_border, num_border) * below;
    Eigen::MatrixXd diagonal = inverse_root.transpose() * inverse_root;
    if (last) {
      tile.next = border.bottomRows(num_right);
    } else {
      const ArrowheadTile& after = (*tiles)[k + 1];
      const Eigen::MatrixXd next = tile.next * inverse_root;
      const auto cross = after.border.topRows(num_first);
      border.noalias() -= cross * next;
      tile.next.noalias() = -after.diagonal * next;
      tile.next.noalias() -= cross.transpose() * below;
      diagonal.noalias() -= next.transpose() * tile.next;
    }
    diagonal.noalias() -= below.transpose() * border;
    tile.diagonal = 0.5 * (diagonal + diagonal.transpose());
    tile.border = std::move(border);
  }
}

ArrowheadInverse ArrowheadCholesky::TakeInverse() {
  CHECK(border_ == BorderElimination::kLast);
  const Eigen::Index num_border = corner_scale_.size();
  Eigen::MatrixXd corner = Eigen::MatrixXd::Identity(num_border, num_border);
  if (num_border > 0) {
    corner_factor_.solveInPlace(corner);
    corner = corner_scale_.asDiagonal() * corner * corner_scale_.asDiagonal();
  }
  std::vector<ArrowheadTile> rest;  // the level above, inverted
  while (!levels_.empty()) {
    Level& level = levels_.back();
    const bool lowest = levels_.size() == 1;
    for (const Subdomain& subdomain : level.subdomains) {
      const int num_right =
          subdomain.right < 0 ? 0 : rest[static_cast<size_t>(subdomain.right)].size();
      const int num_left =
          subdomain.left < 0 ? 0 : rest[static_cast<size_t>(subdomain.left)].size();
      Invert(BorderInverse(subdomain, rest, corner), num_right, subdomain, &level.tiles);
      if (num_left > 0) {
        level.tiles[subdomain.begin - 1].next =
            level.tiles[subdomain.begin].border.topRows(num_left).transpose();
      }
      for (size_t k = subdomain.begin; k < subdomain.end; ++k) {
        ArrowheadTile& tile = level.tiles[k];
        if (lowest) {
          tile.border.resize(0, 0);  // nobody asks for it any more
        } else {
          const auto num_seen = static_cast<Eigen::Index>(subdomain.seen.size());
          tile.border = tile.border.middleRows(num_left, num_seen).eval();
          tile.seen = subdomain.seen;
        }
      }
    }
    for (size_t i = 0; i < level.separators.size(); ++i) {
      ArrowheadTile& tile = level.tiles[level.separators[i]];
      Eigen::MatrixXd next = std::move(tile.next);
      tile = std::move(rest[i]);
      tile.next = std::move(next);
    }
    rest = std::move(level.tiles);
    levels_.pop_back();
  }
  return ArrowheadInverse(tile_size_, std::move(rest), std::move(corner));
}

}  // namespace plumbline
