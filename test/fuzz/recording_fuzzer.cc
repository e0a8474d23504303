// Feeds the readers of all formats with bytes that libFuzzer makes up. The recording is a file
// of its own, since SQLite opens no file in memory.

#include <glog/logging.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "core/recording/recording_source.h"
#include "core/util/error.h"

namespace plumbline {
namespace {

void CheckScanLine(const ScanLineMessage& scan_line) {
  CHECK_EQ(scan_line.ranges.size(), scan_line.num_beams);
  CHECK(scan_line.angles.empty() || scan_line.angles.size() == scan_line.num_beams);
}

// Reads everything, and each scan line once more.
void ReadRecording(const std::string& path) {
  try {
    const std::unique_ptr<RecordingSource> source = OpenRecording(path);
    std::vector<MessageRef> messages;
    RecordingVisitor visitor;
    visitor.scan_line = [&](const MessageRef& message, const ScanLineMessage& scan_line) {
      CheckScanLine(scan_line);
      messages.push_back(message);
    };
    visitor.odometry = [](const MessageRef&, const OdometryMessage&) {};
    source->Visit(visitor);
    for (const std::string& warning : source->warnings()) CHECK(!warning.empty());
    ScanLineMessage scan_line;
    for (const MessageRef& message : messages) {
      source->ReadScanLine(message, &scan_line);
      CheckScanLine(scan_line);
    }
  } catch (const Error& error) {
    CHECK_EQ(std::string(error.what()).rfind(path + ": ", 0), 0u) << error.what();
  }
}

// A file that is gone when the process ends.
class TemporaryFile {
 public:
  TemporaryFile() { CHECK_GE(file_ = mkstemp(path_.data()), 0); }
  ~TemporaryFile() { unlink(path_.c_str()); }

  const std::string& path() const { return path_; }
  void Write(const uint8_t* data, size_t size) const {
    CHECK_EQ(ftruncate(file_, 0), 0);
    CHECK_EQ(pwrite(file_, data, size, 0), static_cast<ssize_t>(size));
  }

 private:
  std::string path_ = "/tmp/plumbline_fuzz_XXXXXX";
  int file_ = -1;
};

}  // namespace
}  // namespace plumbline

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const plumbline::TemporaryFile file;
  file.Write(data, size);
  plumbline::ReadRecording(file.path());
  return 0;
}
