#include "core/judging/passages.h"

#include <algorithm>
#include <cstdlib>
#include <utility>

namespace plumbline {
namespace {

// Least distance in time between two looks at a place: a jolt that is over within a second is
// no contradiction between times.
constexpr int kApart = 2;  // s

// The shares of seconds, summed surface by surface.
class SharesOfSurfaces {
 public:
  SharesOfSurfaces(const MapState& state, int num_seconds)
      : state_(state),
        total_(static_cast<size_t>(num_seconds)),
        worst_(total_.size()),
        current_(total_.size()) {}

  // The share of a second on a surface; surfaces come one after the other.
  Share& Of(int landmark_id, int second) {
    if (landmark_id != landmark_id_) FinishSurface();
    landmark_id_ = landmark_id;
    return current_[static_cast<size_t>(second)];
  }
  ContradictedPassages Finish() {
    FinishSurface();
    SharesOverTime without_worst = total_;
    for (size_t i = 0; i < total_.size(); ++i) {
      without_worst[i].contradicted -= worst_[i].contradicted;
      without_worst[i].comparable -= worst_[i].comparable;
    }
    return {std::move(total_), std::move(without_worst)};
  }

 private:
  void FinishSurface() {
    const bool may_move =
        landmark_id_ >= 0 &&
        TraitsOf(state_.landmarks[static_cast<size_t>(landmark_id_)]).has_doorways;
    for (size_t i = 0; i < total_.size(); ++i) {
      total_[i].contradicted += current_[i].contradicted;
      total_[i].comparable += current_[i].comparable;
      if (may_move && current_[i].contradicted > worst_[i].contradicted) {
        worst_[i] = current_[i];
      }
      current_[i] = {};
    }
  }

  const MapState& state_;
  SharesOverTime total_;
  SharesOverTime worst_;
  SharesOverTime current_;
  int landmark_id_ = -1;
};

}  // namespace

ContradictedPassages FindContradictedPassages(const MapState& state,
                                              const Sightings& sightings) {
  SharesOfSurfaces shares(state, sightings.num_seconds());
  sightings.ForEachCell([&](const Sighting* first, const Sighting* last) {
    int all_solid = 0;
    int all_passed = 0;
    for (const Sighting* one = first; one != last; ++one) {
      all_solid += one->is_solid() ? 1 : 0;
      all_passed += one->is_passed() ? 1 : 0;
    }
    for (const Sighting* now = first; now != last; ++now) {
      if (!now->is_solid() && !now->is_passed()) continue;
      int num_solid = all_solid;
      int num_passed = all_passed;
      for (const Sighting* near = std::max(first, now - kApart + 1);
           near != std::min(last, now + kApart);
           ++near) {
        if (std::abs(near->second - now->second) >= kApart) continue;
        num_solid -= near->is_solid() ? 1 : 0;
        num_passed -= near->is_passed() ? 1 : 0;
      }
      if (num_solid + num_passed == 0) continue;
      const int num_against = now->is_solid() ? num_passed : num_solid;
      Share& share = shares.Of(now->landmark_id, now->second);
      share.comparable += 1.0;
      share.contradicted += static_cast<double>(num_against) / (num_solid + num_passed);
    }
  });
  return shares.Finish();
}

}  // namespace plumbline
