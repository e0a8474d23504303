#pragma once

#include <functional>
#include <string>
#include <vector>

namespace plumbline {

// Does what every app does around its work, and returns the exit code: 0 after --help, which
// shows the flags that source_file defines; 2 after wrong usage (an unknown flag, a bad value,
// a missing required flag, a stray argument); 0 after run(), or 1 when run() throws. Errors
// are one line on stderr.
int RunApp(int argc,
           char** argv,
           const std::string& purpose,
           const std::string& source_file,
           const std::vector<std::string>& required_flags,
           const std::function<void()>& run);

// From now on, the first Ctrl-C or SIGTERM asks the program to end early, and the next one ends
// it at once. Returns whether it has been asked to.
std::function<bool()> WatchStopSignals();

}  // namespace plumbline
