#include "apps/app.h"

#include <gflags/gflags.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <iostream>
#include <stdexcept>

#include "apps/help.h"
#include "apps/terminal.h"
#include "apps/version.h"

namespace plumbline {
namespace {

class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// After the name of a bare flag that may stand alone several times.
constexpr char kMore[] = "...";

// Sets the flags from the command line. Returns "help", "helpxml" or "version" when it asks
// for that instead of work, else nothing. gflags' own parser leaves with exit code 1 where
// ours has to be 2, and its help lists the flags of every library. bare_flag: see RunApp.
std::string ParseFlags(int argc, char** argv, std::string bare_flag) {
  for (int i = 1; i < argc; ++i) {
    std::string argument = argv[i];
    if (!bare_flag.empty() && !argument.empty() && argument[0] != '-') {
      const std::string flag = bare_flag.substr(0, bare_flag.find(kMore));
      gflags::CommandLineFlagInfo so_far;
      const bool is_first = !gflags::GetCommandLineFlagInfo(flag.c_str(), &so_far) ||
                            so_far.current_value.empty();
      argument = "--" + flag + "=" + (is_first ? "" : so_far.current_value + "\n") + argument;
      if (flag == bare_flag) bare_flag.clear();
    }
    const size_t name_start = argument.find_first_not_of('-');
    if (name_start == 0 || name_start > 2) {
      throw UsageError("unexpected argument '" + argument + "'");
    }
    const size_t equals = argument.find('=');
    const bool has_value = equals != std::string::npos;
    std::string name = argument.substr(name_start, equals - name_start);
    std::string value = has_value ? argument.substr(equals + 1) : "";
    if (name == "help" || name == "helpxml" || name == "version") return name;
    gflags::CommandLineFlagInfo info;
    if (gflags::GetCommandLineFlagInfo(name.c_str(), &info)) {
      if (!has_value && info.type == "bool") value = "true";
      if (!has_value && info.type != "bool") {
        if (++i == argc) throw UsageError("flag --" + name + " needs a value");
        value = argv[i];
      }
    } else if (name.rfind("no", 0) == 0 && !has_value &&
               gflags::GetCommandLineFlagInfo(name.c_str() + 2, &info) &&
               info.type == "bool") {
      name = name.substr(2);
      value = "false";
    } else {
      throw UsageError("unknown flag --" + name);
    }
    if (gflags::SetCommandLineOption(name.c_str(), value.c_str()).empty()) {
      throw UsageError("flag --" + name + " does not take the value '" + value + "'");
    }
  }
  return "";
}

// As wide as the terminal, but no wider than what reads well.
size_t HelpWidth() {
  constexpr size_t kWidest = 100;
  return IsTerminal(stdout) ? std::min(Columns(STDOUT_FILENO), kWidest) : kWidest;
}

void PrintVersion(const std::string& program) {
  std::cout << program << ' ' << Version();
  if (*Commit() != '\0') std::cout << " (commit " << Commit() << ')';
  std::cout << '\n';
}

}  // namespace

int RunApp(int argc,
           char** argv,
           const std::string& purpose,
           const std::string& source_file,
           const std::vector<std::string>& required_flags,
           const std::function<void()>& run,
           const std::string& bare_flag) {
  LogToTerminal(argv[0]);
  const std::string program = std::filesystem::path(argv[0]).filename().string();
  try {
    const std::string wish = ParseFlags(argc, argv, bare_flag);
    if (wish == "version") PrintVersion(program);
    const Help help = {program, purpose, source_file, required_flags};
    if (wish == "help") std::cout << HelpText(help, HelpWidth());
    if (wish == "helpxml") std::cout << HelpXml(help);
    if (!wish.empty()) return 0;
    for (const std::string& name : required_flags) {
      if (gflags::GetCommandLineFlagInfoOrDie(name.c_str()).current_value.empty()) {
        throw UsageError("flag --" + name + " is missing");
      }
    }
    run();
    return 0;
  } catch (const UsageError& error) {
    PrintOnStderr(Coloured(program + ": ", Colour::kRed, stderr) + error.what() + "; see " +
                  program + " --help");
    return 2;
  } catch (const std::exception& error) {
    PrintOnStderr(Coloured(program + ": ", Colour::kRed, stderr) + error.what());
    return 1;
  }
}

namespace {

volatile std::sig_atomic_t stop_requested = 0;

// Only what POSIX allows in a signal handler, which is why there is no stream here.
extern "C" void NoteStopSignal(int signal) {
  if (stop_requested != 0) {
    std::signal(signal, SIG_DFL);
    raise(signal);
    return;
  }
  stop_requested = 1;
  constexpr char kText[] = "\nfinishing the map of what was read so far; again: at once\n";
  const ssize_t ignored = write(STDERR_FILENO, kText, sizeof(kText) - 1);
  (void)ignored;
}

void NoteStopSignals() {
  for (const int signal : {SIGINT, SIGTERM}) {
    // What ignores a signal from its start shall go on to, such as a job in the background.
    if (std::signal(signal, NoteStopSignal) == SIG_IGN) std::signal(signal, SIG_IGN);
  }
}

}  // namespace

std::function<bool()> StopSignals() {
  return [] {
    static const bool is_noted = (NoteStopSignals(), true);
    (void)is_noted;
    return stop_requested != 0;
  };
}

}  // namespace plumbline
