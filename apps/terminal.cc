#include "apps/terminal.h"

#include <glog/logging.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdlib>
#include <mutex>

namespace plumbline {
namespace {

constexpr char kClearLine[] = "\r\033[K";

std::mutex mutex;  // guards what is written, and the status line

// Text of the terminal's last line. Never destroyed: messages may come up to the end.
std::string& StatusLine() {
  static auto* const line = new std::string;
  return *line;
}

// glog's messages, on their way to stderr.
class TerminalSink : public google::LogSink {
 public:
  void send(google::LogSeverity severity,
            const char* full_filename,
            const char* base_filename,
            int line,
            const google::LogMessageTime& time,
            const char* message,
            size_t message_length) override {
    (void)full_filename;
    if (severity == google::GLOG_FATAL) return;  // glog prints these itself
    if (!IsTerminal(stderr)) {
      PrintOnStderr(ToString(severity, base_filename, line, time, message, message_length));
      return;
    }
    const std::string text(message, message_length);
    if (severity == google::GLOG_INFO) {
      PrintOnStderr(text);
    } else {
      PrintOnStderr(Coloured("warning: ", Colour::kYellow, stderr) + text);
    }
  }
};

}  // namespace

bool IsTerminal(FILE* stream) {
  const char* terminal = std::getenv("TERM");
  return isatty(fileno(stream)) == 1 && terminal != nullptr && std::string(terminal) != "dumb";
}

size_t Columns(int descriptor) {
  winsize size{};
  if (ioctl(descriptor, TIOCGWINSZ, &size) != 0 || size.ws_col == 0) return 80;
  return size.ws_col;
}

std::string Coloured(const std::string& text, Colour colour, FILE* stream) {
  const char* no_colour = std::getenv("NO_COLOR");
  if (!IsTerminal(stream) || (no_colour != nullptr && *no_colour != '\0')) return text;
  const char* code = colour == Colour::kGreen ? "32" : colour == Colour::kYellow ? "33" : "31";
  return std::string("\033[") + code + "m" + text + "\033[0m";
}

void ShowStatus(const std::string& text) {
  const std::lock_guard<std::mutex> lock(mutex);
  if (text.empty() && StatusLine().empty()) return;
  // A line that reached the last column would wrap, and could not be rewritten.
  StatusLine() = text.substr(0, Columns(STDERR_FILENO) - 1);
  std::fprintf(stderr, "%s%s", kClearLine, StatusLine().c_str());
}

void PrintOnStderr(const std::string& line) {
  const std::lock_guard<std::mutex> lock(mutex);
  if (StatusLine().empty()) {
    std::fprintf(stderr, "%s\n", line.c_str());
  } else {
    std::fprintf(stderr, "%s%s\n%s", kClearLine, line.c_str(), StatusLine().c_str());
  }
}

void LogToTerminal(const char* program) {
  static TerminalSink* const sink = [program] {
    for (int severity = 0; severity < google::NUM_SEVERITIES; ++severity) {
      google::SetLogDestination(severity, "");  // no files
    }
    FLAGS_logtostderr = false;
    FLAGS_stderrthreshold = google::GLOG_FATAL;
    if (!google::IsGoogleLoggingInitialized()) google::InitGoogleLogging(program);
    auto* new_sink = new TerminalSink;  // never deleted: messages may come up to the end
    google::AddLogSink(new_sink);
    return new_sink;
  }();
  (void)sink;
}

}  // namespace plumbline
