#pragma once

#include <Eigen/Core>
#include <deque>
#include <set>
#include <vector>

#include "core/estimation/block_layout.h"
#include "core/surface/landmark.h"
#include "core/window/marginal_prior.h"
#include "factors/linear_algebra/elimination.h"

namespace plumbline {

// InactiveLandmarks are planes that have been out of view for a while, left out of the
// marginal prior and kept as a Gaussian conditional on blocks that it still holds,
//
//   y = mean + gain x + e,    e ~ N(0, covariance),
//
// y the inactive landmarks' parameters, x how far the blocks of given() are from the values
// they have in the marginal prior. The marginal prior then only needs to hold the cost of all
// the rest, and no step of the window's touches the inactive landmarks: marginal prior and
// conditional together are the same Gaussian, to rounding, that a marginal prior on all planes
// would be. Taking planes in and giving them back takes (inactive landmarks)^2 operations for
// each of them, never a new factorisation.
//
// The blocks x must stay in the marginal prior until the next planes are taken in. For control
// points that the window has left behind this means that they stay as retained control points.
class InactiveLandmarks {
 public:
  bool empty() const { return ids_.empty(); }
  bool Contains(int landmark_id) const { return ids_.count(landmark_id) > 0; }
  const std::vector<BlockId>& given() const { return given_; }
  bool DependsOn(const BlockId& block) const;

  // Moves these planes from the marginal prior to the inactive ones, and drops the marginal
  // prior's control points before first_control_point, its retained control points. Throws
  // Error when the marginal prior does not determine them.
  void Deactivate(const std::set<int>& landmark_ids,
                  int first_control_point,
                  MarginalPrior* prior);

  // Moves these planes back to the marginal prior, where they are about the landmarks'
  // parameters.
  void Activate(const std::set<int>& landmark_ids,
                const std::deque<Landmark>& landmarks,
                MarginalPrior* prior);

  // The marginal prior's values move by this much (its rows): what is given is measured from
  // there.
  void Rebase(const MarginalPrior& prior, const Eigen::VectorXd& moved);

  // Plane `from` of the marginal prior becomes part of its plane `into`; from's parameters are
  // measured from values that are `shift` larger, and by_into is their derivative by into's.
  // hold_first: into's first parameter never moves.
  void Merge(int into,
             int from,
             const Eigen::VectorXd& shift,
             const Eigen::MatrixXd& by_into,
             bool hold_first);

  // Sets the landmarks' parameters and covariances as they follow from the marginal prior's
  // blocks: their steps from the marginal prior's values, their joint covariance.
  void Update(const MarginalPrior& prior,
              const Eigen::VectorXd& steps,
              const Eigen::MatrixXd& covariance,
              std::deque<Landmark>* landmarks) const;

 private:
  struct Plane {
    int id;
    int row;  // first of its rows
    int size;
  };
  // Rows of given() in the marginal prior.
  std::vector<int> GivenRows(const MarginalPrior& prior) const;
  // The gain with respect to these rows of the marginal prior.
  Eigen::MatrixXd ByPrior(const MarginalPrior& prior, const std::vector<int>& rows) const;
  // Replaces what leaves the marginal prior by what it is given the rest, and appends the
  // first num_taken variables that leave, their means zero; returns these, from the marginal
  // prior's values. Columns of by_leaving, by_staying: as `elimination` eliminates, keeps.
  Eigen::VectorXd Compose(const Elimination& elimination,
                          Eigen::Index num_taken,
                          const Eigen::MatrixXd& by_leaving,
                          const Eigen::MatrixXd& by_staying);
  std::vector<int> RowsOfLandmarks(const std::set<int>& landmark_ids) const;
  // The part of covariance_ that is in use.
  Eigen::Block<const Eigen::MatrixXd> Covariance() const {
    return covariance_.topLeftCorner(mean_.size(), mean_.size());
  }
  // Makes room for `size` rows in covariance_.
  void Reserve(Eigen::Index size);
  // Keeps only these planes' rows.
  void RemoveLandmarks(const std::set<int>& landmark_ids);

  std::set<int> ids_;
  std::vector<Plane> planes_;
  std::vector<BlockId> given_;
  std::vector<int> given_offsets_ = {0};
  Eigen::VectorXd mean_;
  Eigen::MatrixXd gain_;
  // The covariance is the first mean_.size() rows and columns; the rest is room for more
  // planes. Planes come and go all the time: a matrix of hundreds of them is not to be copied
  // for each.
  Eigen::MatrixXd covariance_;
};

}  // namespace plumbline
