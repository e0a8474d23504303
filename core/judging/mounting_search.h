#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "core/judging/view_comparison.h"

namespace plumbline {

// PairAgreement says on how many of the places that both see two scanners agree.
struct PairAgreement {
  size_t a = 0;
  size_t b = 0;
  int num_compared = 0;
  double near_share = 0.0;  // of these, within a decimetre of each other
  double median_m = 0.0;    // of the distances' sizes

  // Whether the two see other places than the rig file says.
  bool IsApart() const;
};

// One element for each pair of scanners.
std::vector<PairAgreement> AgreementsOf(const std::vector<std::vector<SampledLine>>& sample,
                                        const MountedRig& rig);

// Another way in which the rig may be built, under which its scanners agree.
struct OtherMounting {
  std::vector<size_t> scanners;  // that are mounted otherwise than the rig file says
  std::string words;             // "scanner top is mirrored ..."
  std::string advice;
  double share_as_stated = 0.0;  // of the places that these compare with others, near
  double share_so = 0.0;
  double share_of_all = 0.0;  // so, of the places of all pairs
  MountedRig rig;
};

// Tries scanners that are mirrored, turned in their planes by quarter turns, exchanged for one
// another, or measure in another unit. Returns the one change under which the scanners agree
// clearly better than as the rig file says; nothing where there is none.
std::optional<OtherMounting> FindOtherMounting(
    const std::vector<std::vector<SampledLine>>& sample,
    const MountedRig& rig,
    const std::vector<std::string>& names);

// Tries turns of single scanners by any angle, about the vertical and in their own planes.
// Takes a second; for rigs that nothing else explains.
std::optional<OtherMounting> FindTurn(const std::vector<std::vector<SampledLine>>& sample,
                                      const MountedRig& rig,
                                      const std::vector<std::string>& names);

}  // namespace plumbline
