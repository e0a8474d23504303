#pragma once

#include <functional>
#include <string>
#include <vector>

namespace plumbline {

// What every app does around its work: --help shows the flags that source_file defines and
// returns 0; wrong usage (unknown flag, bad value, a required flag missing, stray argument)
// returns 2; otherwise returns 0 after run(), or 1 with one line on stderr when it throws.
int RunApp(int argc,
           char** argv,
           const std::string& purpose,
           const std::string& source_file,
           const std::vector<std::string>& required_flags,
           const std::function<void()>& run);

}  // namespace plumbline
