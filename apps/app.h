#pragma once

#include <functional>
#include <string>
#include <vector>

namespace plumbline {

// Does what every app does around its work, and returns the exit code: 0 after --help, which
// shows the flags that source_file defines, after --helpxml (apps/help.h) and --version; 2
// after wrong usage (an unknown flag, a bad value, a missing required flag, a stray argument);
// 0 after run(), or 1 when run() throws. Errors are one line on stderr. bare_flag: the flag
// whose value may also stand alone, once; where "..." follows its name any number of times, a
// line each in its value; none where it is empty.
int RunApp(int argc,
           char** argv,
           const std::string& purpose,
           const std::string& source_file,
           const std::vector<std::string>& required_flags,
           const std::function<void()>& run,
           const std::string& bare_flag = "");

// Returns a function that says whether Ctrl-C or SIGTERM has asked the program to end early.
// Up to its first call, both end the program at once, and so does the second of them
// afterwards.
std::function<bool()> StopSignals();

}  // namespace plumbline
