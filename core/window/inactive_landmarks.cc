#include "core/window/inactive_landmarks.h"

#include <glog/logging.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

#include "core/estimation/block_layout.h"
#include "core/estimation/normal_equations.h"
#include "core/util/error.h"
#include "factors/linear_algebra/elimination.h"
#include "factors/linear_algebra/symmetric_inverse.h"

namespace plumbline {
namespace {

constexpr char kNotDetermined[] =
    "the scans do not determine where the planes lie";

// The marginal prior without its leading variables, in the order [ leaving rows | other rows
// ]; the elimination that takes them out.
Elimination EliminateRows(const std::vector<int>& leaving,
                          const std::vector<int>& staying,
                          const NormalEquations& equations) {
  std::vector<int> order = leaving;
  order.insert(order.end(), staying.begin(), staying.end());
  std::optional<Elimination> elimination =
      Elimination::Make(equations.hessian(order, order),
                        equations.gradient(order),
                        static_cast<Eigen::Index>(leaving.size()));
  if (!elimination) throw Error(kNotDetermined);
  return std::move(*elimination);
}

// Moves these rows and columns, ascending, to the front, in place.
void MoveToFront(const std::vector<int>& kept, Eigen::MatrixXd* matrix) {
  const auto size = static_cast<int>(kept.size());
  int first = 0;  // of those that move
  while (first < size && kept[static_cast<size_t>(first)] == first) ++first;
  for (int column = 0; column < size; ++column) {
    const int from_column = kept[static_cast<size_t>(column)];
    const double* from = matrix->col(from_column).data();
    double* to = matrix->col(column).data();
    if (from_column != column) std::copy_n(from, first, to);
    for (int row = first; row < size; ++row) to[row] = from[kept[static_cast<size_t>(row)]];
  }
}

}  // namespace

bool InactiveLandmarks::DependsOn(const BlockId& block) const {
  return std::find(given_.begin(), given_.end(), block) != given_.end();
}

std::vector<int> InactiveLandmarks::GivenRows(const MarginalPrior& prior) const {
  std::vector<int> rows;
  for (const BlockId& block : given_) {
    const size_t at = FindBlock(prior.equations, block);
    CHECK_LT(at, prior.equations.blocks.size());
    for (int k = 0; k < BlockSize(prior.equations, at); ++k) {
      rows.push_back(prior.equations.offsets[at] + k);
    }
  }
  return rows;
}

std::vector<int> InactiveLandmarks::RowsOfLandmarks(const std::set<int>& landmark_ids) const {
  std::vector<int> rows;
  for (const Plane& plane : planes_) {
    if (landmark_ids.count(plane.id) == 0) continue;
    for (int k = 0; k < plane.size; ++k) rows.push_back(plane.row + k);
  }
  return rows;
}

Eigen::MatrixXd InactiveLandmarks::ByPrior(const MarginalPrior& prior,
                                           const std::vector<int>& rows) const {
  Eigen::MatrixXd by_prior = Eigen::MatrixXd::Zero(mean_.size(), prior.equations.size());
  by_prior(Eigen::all, GivenRows(prior)) = gain_;
  return by_prior(Eigen::all, rows);
}

void InactiveLandmarks::Reserve(Eigen::Index size) {
  if (covariance_.rows() >= size) return;
  Eigen::MatrixXd larger(2 * size, 2 * size);
  larger.topLeftCorner(mean_.size(), mean_.size()) = Covariance();
  covariance_ = std::move(larger);
}

Eigen::VectorXd InactiveLandmarks::Compose(const Elimination& elimination,
                                           Eigen::Index num_taken,
                                           const Eigen::MatrixXd& by_leaving,
                                           const Eigen::MatrixXd& by_staying) {
  const Eigen::VectorXd mean =
      elimination.BackSubstitute(Eigen::VectorXd::Zero(by_staying.cols()));
  const Eigen::MatrixXd gain = elimination.Gain();
  const Eigen::MatrixXd root = elimination.ConditionalRoot();
  const Eigen::MatrixXd covariance = root.transpose() * root;
  const Eigen::MatrixXd spread = by_leaving * covariance;
  const Eigen::Index num_before = mean_.size();
  const Eigen::Index size = num_before + num_taken;
  Reserve(size);
  auto joint = covariance_.topLeftCorner(size, size);
  joint.topLeftCorner(num_before, num_before).noalias() += spread * by_leaving.transpose();
  joint.bottomLeftCorner(num_taken, num_before) = spread.leftCols(num_taken).transpose();
  joint.topRightCorner(num_before, num_taken) = spread.leftCols(num_taken);
  joint.bottomRightCorner(num_taken, num_taken) =
      covariance.topLeftCorner(num_taken, num_taken);
  gain_.resize(size, by_staying.cols());
  gain_.topRows(num_before) = by_staying + by_leaving * gain;
  gain_.bottomRows(num_taken) = gain.topRows(num_taken);
  mean_ += by_leaving * mean;
  mean_.conservativeResize(size);
  mean_.tail(num_taken).setZero();
  return mean.head(num_taken);
}

void InactiveLandmarks::Deactivate(const std::set<int>& landmark_ids,
                                   int first_control_point,
                                   MarginalPrior* prior) {
  const auto is_taken = [&](const BlockId& block) {
    return IsLandmark(block) && landmark_ids.count(block.index) > 0;
  };
  const auto is_anchor = [&](const BlockId& block) {
    return IsBefore(block, first_control_point);
  };
  const NormalEquations& past = prior->equations;
  std::vector<int> leaving = RowsOf(past, is_taken);
  const auto num_taken = static_cast<Eigen::Index>(leaving.size());
  const std::vector<int> anchors = RowsOf(past, is_anchor);
  leaving.insert(leaving.end(), anchors.begin(), anchors.end());
  const std::vector<int> staying = RowsOf(
      past, [&](const BlockId& block) { return !is_taken(block) && !is_anchor(block); });
  const Elimination elimination = EliminateRows(leaving, staying, past);
  const auto num_before = static_cast<int>(mean_.size());
  const Eigen::VectorXd means =
      Compose(elimination, num_taken, ByPrior(*prior, leaving), ByPrior(*prior, staying));

  MarginalPrior rest;
  given_.clear();
  given_offsets_.assign(1, 0);
  int row = num_before;
  for (size_t i = 0; i < past.blocks.size(); ++i) {
    const BlockId& block = past.blocks[i];
    const int block_size = BlockSize(past, i);
    if (is_taken(block)) {
      mean_.segment(row, block_size) =
          prior->at[i] + means.segment(row - num_before, block_size);
      planes_.push_back({block.index, row, block_size});
      ids_.insert(block.index);
      row += block_size;
    } else if (!is_anchor(block)) {
      rest.equations.blocks.push_back(block);
      rest.equations.offsets.push_back(rest.equations.offsets.back() + block_size);
      rest.at.push_back(std::move(prior->at[i]));
      given_.push_back(block);
      given_offsets_.push_back(given_offsets_.back() + block_size);
    }
  }
  rest.equations.hessian = elimination.hessian();
  rest.equations.gradient = elimination.gradient();
  *prior = std::move(rest);
}

void InactiveLandmarks::Activate(const std::set<int>& landmark_ids,
                                 const std::deque<Landmark>& landmarks,
                                 MarginalPrior* prior) {
  const std::vector<int> rows = RowsOfLandmarks(landmark_ids);
  if (rows.empty()) return;
  const auto size = static_cast<Eigen::Index>(rows.size());
  const Eigen::Index num_given = gain_.cols();
  // As measurements of the planes: r = y - mean - gain x, with the inverse covariance.
  const std::optional<Eigen::MatrixXd> weight = SymmetricInverse(Covariance()(rows, rows));
  if (!weight) throw Error(kNotDetermined);
  NormalEquations part;
  part.blocks = given_;
  part.offsets = given_offsets_;
  std::map<BlockId, Eigen::VectorXd> at;
  for (size_t i = 0; i < prior->at.size(); ++i) {
    at[prior->equations.blocks[i]] = prior->at[i];
  }
  Eigen::VectorXd residual(size);
  Eigen::Index row = 0;
  for (const Plane& plane : planes_) {
    if (landmark_ids.count(plane.id) == 0) continue;
    const Landmark& landmark = landmarks[static_cast<size_t>(plane.id)];
    const Eigen::VectorXd value = AnchoredParameters(landmark);
    residual.segment(row, plane.size) = value - mean_.segment(plane.row, plane.size);
    part.blocks.push_back(LandmarkBlock(plane.id));
    part.offsets.push_back(part.offsets.back() + plane.size);
    at[part.blocks.back()] = value;
    row += plane.size;
  }
  Eigen::MatrixXd jacobian(size, num_given + size);
  jacobian << -gain_(rows, Eigen::all), Eigen::MatrixXd::Identity(size, size);
  const Eigen::MatrixXd weighted = *weight * jacobian;
  part.hessian = jacobian.transpose() * weighted;
  part.gradient = weighted.transpose() * residual;

  std::map<BlockId, int> sizes;
  for (size_t i = 0; i < part.blocks.size(); ++i) {
    sizes[part.blocks[i]] = BlockSize(part, i);
  }
  for (size_t i = 0; i < prior->equations.blocks.size(); ++i) {
    sizes[prior->equations.blocks[i]] = BlockSize(prior->equations, i);
  }
  NormalEquations all = ZeroSystem(sizes);
  AddTo(prior->equations, prior->equations.blocks, &all);
  AddTo(part, part.blocks, &all);
  prior->equations = std::move(all);
  prior->at.clear();
  for (const BlockId& block : prior->equations.blocks) prior->at.push_back(at.at(block));

  // The others, given these too.
  const Eigen::MatrixXd regression = Covariance()(Eigen::all, rows) * *weight;
  mean_ += regression * residual;
  Eigen::MatrixXd gain(mean_.size(), num_given + size);
  gain.leftCols(num_given) = gain_;
  gain.leftCols(num_given).noalias() -= regression * gain_(rows, Eigen::all);
  gain.rightCols(size) = regression;
  const Eigen::MatrixXd cross = Covariance()(rows, Eigen::all);
  covariance_.topLeftCorner(mean_.size(), mean_.size()).noalias() -= regression * cross;
  gain_ = std::move(gain);
  given_ = std::move(part.blocks);
  given_offsets_ = std::move(part.offsets);
  RemoveLandmarks(landmark_ids);
}

void InactiveLandmarks::RemoveLandmarks(const std::set<int>& landmark_ids) {
  std::vector<int> rows;
  std::vector<Plane> planes;
  for (Plane plane : planes_) {
    if (landmark_ids.count(plane.id) > 0) {
      ids_.erase(plane.id);
      continue;
    }
    const auto row = static_cast<int>(rows.size());
    for (int k = 0; k < plane.size; ++k) rows.push_back(plane.row + k);
    plane.row = row;
    planes.push_back(plane);
  }
  planes_ = std::move(planes);
  mean_ = mean_(rows).eval();
  gain_ = gain_(rows, Eigen::all).eval();
  MoveToFront(rows, &covariance_);
}

void InactiveLandmarks::Rebase(const MarginalPrior& prior, const Eigen::VectorXd& moved) {
  mean_ += gain_ * moved(GivenRows(prior));
}

void InactiveLandmarks::Merge(int into,
                              int from,
                              const Eigen::VectorXd& shift,
                              const Eigen::MatrixXd& by_into,
                              bool hold_first) {
  const auto find = [&](int id) {
    return static_cast<size_t>(std::find(given_.begin(), given_.end(), LandmarkBlock(id)) -
                               given_.begin());
  };
  const size_t from_at = find(from);
  if (from_at == given_.size()) return;
  const int size = given_offsets_[from_at + 1] - given_offsets_[from_at];
  mean_ += gain_.middleCols(given_offsets_[from_at], size) * shift;
  gain_.middleCols(given_offsets_[from_at], size) *= by_into;
  // Planes that are given back must not make a direction free that is held.
  if (hold_first) gain_.col(given_offsets_[from_at]).setZero();
  const size_t into_at = find(into);
  if (into_at == given_.size()) {
    given_[from_at] = LandmarkBlock(into);
    return;
  }
  gain_.middleCols(given_offsets_[into_at], size) +=
      gain_.middleCols(given_offsets_[from_at], size);
  std::vector<int> columns(static_cast<size_t>(gain_.cols()));
  std::iota(columns.begin(), columns.end(), 0);
  columns.erase(columns.begin() + given_offsets_[from_at],
                columns.begin() + given_offsets_[from_at + 1]);
  gain_ = gain_(Eigen::all, columns).eval();
  given_.erase(given_.begin() + static_cast<std::ptrdiff_t>(from_at));
  given_offsets_.erase(given_offsets_.begin() + static_cast<std::ptrdiff_t>(from_at) + 1);
  for (size_t i = from_at + 1; i < given_offsets_.size(); ++i) given_offsets_[i] -= size;
}

void InactiveLandmarks::Update(const MarginalPrior& prior,
                               const Eigen::VectorXd& steps,
                               const Eigen::MatrixXd& covariance,
                               std::deque<Landmark>* landmarks) const {
  const std::vector<int> rows = GivenRows(prior);
  const Eigen::VectorXd estimate = mean_ + gain_ * steps(rows);
  const Eigen::MatrixXd of_given = covariance(rows, rows);
  const Eigen::MatrixXd spread = gain_ * of_given;
  for (const Plane& plane : planes_) {
    Landmark& landmark = (*landmarks)[static_cast<size_t>(plane.id)];
    SetFromAnchored(estimate.segment(plane.row, plane.size), &landmark);
    SetCovarianceFromAnchored(covariance_.block(plane.row, plane.row, plane.size, plane.size) +
                                  spread.middleRows(plane.row, plane.size) *
                                      gain_.middleRows(plane.row, plane.size).transpose(),
                              &landmark);
  }
}

}  // namespace plumbline
