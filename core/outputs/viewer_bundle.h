#pragma once

#include <string>

namespace plumbline {

// Returns the page's program, viewer/dist/viewer.js, which is part of this library.
std::string ViewerBundle();

}  // namespace plumbline
