#include "core/outputs/viewer_bundle.h"

// viewer_bytes.S defines these.
extern "C" const char plumbline_viewer_begin[];
extern "C" const char plumbline_viewer_end[];

namespace plumbline {

std::string ViewerBundle() { return {plumbline_viewer_begin, plumbline_viewer_end}; }

}  // namespace plumbline
