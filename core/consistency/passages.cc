#include "core/consistency/passages.h"

#include <algorithm>
#include <cstdlib>

namespace plumbline {
namespace {

// Least distance in time between two looks at a place: a jolt that is over within a second is
// no contradiction between times.
constexpr int kApart = 2;  // s

}  // namespace

SharesOverTime FindContradictedPassages(const Sightings& sightings) {
  SharesOverTime shares(static_cast<size_t>(sightings.num_seconds()));
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
      Share& share = shares[static_cast<size_t>(now->second)];
      share.comparable += 1.0;
      share.contradicted += static_cast<double>(num_against) / (num_solid + num_passed);
    }
  });
  return shares;
}

}  // namespace plumbline
