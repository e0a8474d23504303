#pragma once

#include <vector>

#include "core/sensor/mount.h"

namespace plumbline {

// Sorts samples by time, takes out what is doubled or not finite, and takes a jump by more
// than half a turn as one by less.
void SortAndUnwrap(std::vector<JointSample>* samples);

// Replaces each angle by the value of the polynomial of the fifth order that fits those of the
// time about it best, which takes most of the readings' noise away. Over how much time is told
// by the readings: over that from which each is predicted best by the others
// (cross-validation). Angles without noise stay as they are but for what such polynomials
// leave of them. The samples are sorted and unwrapped.
void Smooth(std::vector<JointSample>* samples);

}  // namespace plumbline
