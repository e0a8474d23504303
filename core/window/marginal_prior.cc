#include "core/window/marginal_prior.h"

#include <glog/logging.h>

#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/estimation/block_layout.h"
#include "core/estimation/normal_equations.h"

namespace plumbline {

Eigen::Vector2d AnchorOf(const Landmark& landmark) {
  if (landmark.heading_fixed) return Eigen::Vector2d::Zero();
  return landmark.extent.axes().anchor.head<2>();
}

Eigen::VectorXd AnchoredParameters(const Landmark& landmark) {
  return landmark.ParametersAbout(AnchorOf(landmark)).head(landmark.num_parameters());
}

void SetFromAnchored(const Eigen::VectorXd& anchored, Landmark* landmark) {
  Eigen::Map<Eigen::VectorXd> parameters(landmark->parameters.data(),
                                         landmark->num_parameters());
  parameters = anchored;
  parameters = landmark->ParametersAbout(-AnchorOf(*landmark)).head(parameters.size());
}

Eigen::MatrixXd ParametersByAnchored(const Landmark& landmark) {
  const Eigen::Index size = landmark.num_parameters();
  return landmark.ByParametersAbout(AnchorOf(landmark)).topLeftCorner(size, size);
}

void SetCovarianceFromAnchored(const Eigen::MatrixXd& covariance, Landmark* landmark) {
  const Eigen::MatrixXd by_anchored = ParametersByAnchored(*landmark);
  landmark->covariance.setZero();
  landmark->covariance.topLeftCorner(covariance.rows(), covariance.cols()) =
      by_anchored * covariance * by_anchored.transpose();
}

namespace {

// Calls visit(row, landmark) for each landmark's first row.
template <typename Visit>
void ForEachLandmark(const std::deque<Landmark>& landmarks,
                     const NormalEquations& equations,
                     Visit visit) {
  for (size_t i = 0; i < equations.blocks.size(); ++i) {
    if (!IsLandmark(equations.blocks[i])) continue;
    visit(equations.offsets[i], landmarks[static_cast<size_t>(equations.blocks[i].index)]);
  }
}

// The rows from this one on are measured in other coordinates; by_new: the derivative of those
// that they have been measured in.
void ChangeCoordinates(const Eigen::MatrixXd& by_new, int row, NormalEquations* equations) {
  const Eigen::Index size = by_new.rows();
  auto columns = equations->hessian.middleCols(row, size);
  columns = (columns * by_new).eval();
  auto rows = equations->hessian.middleRows(row, size);
  rows = (by_new.transpose() * rows).eval();
  auto gradient = equations->gradient.segment(row, size);
  gradient = (by_new.transpose() * gradient).eval();
}

// The derivative of the marginal prior's coordinates of one landmark by those of another that
// is the same plane.
Eigen::MatrixXd ByOther(const Landmark& landmark, const Landmark& other) {
  const auto plane_by_anchored = [](const Landmark& of) -> Eigen::MatrixXd {
    return of.PlaneByParameters().leftCols(of.num_parameters()) * ParametersByAnchored(of);
  };
  // Both columns span what the plane may do, so that nothing is left over.
  return plane_by_anchored(landmark).householderQr().solve(plane_by_anchored(other));
}

}  // namespace

void EquationsToAnchored(const std::deque<Landmark>& landmarks, NormalEquations* equations) {
  ForEachLandmark(landmarks, *equations, [&](int row, const Landmark& landmark) {
    ChangeCoordinates(ParametersByAnchored(landmark), row, equations);
  });
}

void CovarianceToAnchored(const std::deque<Landmark>& landmarks,
                          const NormalEquations& equations,
                          Eigen::MatrixXd* covariance) {
  ForEachLandmark(landmarks, equations, [&](int row, const Landmark& landmark) {
    const Eigen::MatrixXd by_parameters = ParametersByAnchored(landmark).inverse();
    auto columns = covariance->middleCols(row, by_parameters.rows());
    columns = (columns * by_parameters.transpose()).eval();
    auto rows = covariance->middleRows(row, by_parameters.rows());
    rows = (by_parameters * rows).eval();
  });
}

Reanchoring MergePlanes(const Landmark& into, const Landmark& from, MarginalPrior* prior) {
  NormalEquations& past = prior->equations;
  const size_t from_at = FindBlock(past, LandmarkBlock(from.id));
  CHECK_LT(from_at, past.blocks.size());
  const size_t into_at = FindBlock(past, LandmarkBlock(into.id));
  const int row = past.offsets[from_at];
  const int size = BlockSize(past, from_at);
  // The plane that both are taken to be, by either anchor.
  Landmark as_into = into;
  Landmark as_from = from;
  Reanchoring change;
  change.shift = Eigen::VectorXd::Zero(size);
  if (into_at < past.blocks.size()) {
    SetFromAnchored(prior->at[into_at], &as_into);
    as_from.SetPlane(as_into.Normal(), as_into.Distance());
    change.shift = AnchoredParameters(as_from) - prior->at[from_at];
    if (TraitsOf(into).has_heading) {
      change.shift[0] = std::remainder(change.shift[0], 2.0 * M_PI);
    }
    past.gradient += past.hessian.middleCols(row, size) * change.shift;
  } else {
    SetFromAnchored(prior->at[from_at], &as_from);
    as_into.SetPlane(as_from.Normal(), as_from.Distance());
  }
  change.by_into = ByOther(as_from, as_into);
  ChangeCoordinates(change.by_into, row, &past);

  std::vector<BlockId> names = past.blocks;
  names[from_at] = LandmarkBlock(into.id);
  std::map<BlockId, Eigen::VectorXd> at;
  std::map<BlockId, int> sizes;
  for (size_t i = 0; i < names.size(); ++i) {
    at[names[i]] = prior->at[i];
    sizes[names[i]] = BlockSize(past, i);
  }
  at[LandmarkBlock(into.id)] = AnchoredParameters(as_into);
  NormalEquations merged = ZeroSystem(sizes);
  AddTo(past, names, &merged);
  prior->at.clear();
  for (size_t i = 0; i < merged.blocks.size(); ++i) {
    const BlockId& block = merged.blocks[i];
    prior->at.push_back(at.at(block));
    if (!(block == LandmarkBlock(into.id)) || !into.heading_fixed) continue;
    merged.hessian.row(merged.offsets[i]).setZero();  // a held direction has no say
    merged.hessian.col(merged.offsets[i]).setZero();
    merged.gradient[merged.offsets[i]] = 0.0;
  }
  past = std::move(merged);
  return change;
}

}  // namespace plumbline
