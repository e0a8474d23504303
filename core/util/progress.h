#pragma once

#include <functional>

namespace plumbline {

// Called now and then with the share of the work that is done, 0 to 1, roughly by the time it
// takes.
using ProgressCallback = std::function<void(double share_done)>;

}  // namespace plumbline
