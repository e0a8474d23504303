// Feeds the reader of recordings with bytes that libFuzzer makes up. The recording is a file in
// memory, its rig has the two topics that the corpus' bags have.

#include <glog/logging.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <string>

#include "core/sensor/recording.h"
#include "core/sensor/rig.h"
#include "core/util/error.h"

namespace plumbline {
namespace {

Rig TwoScanners() {
  Rig rig;
  for (const char* name : {"top", "left"}) {
    Scanner scanner;
    scanner.name = name;
    scanner.topic = "/" + scanner.name + "_scan";
    rig.scanners.push_back(scanner);
  }
  return rig;
}

void ReadRecording(const std::string& path, const Rig& rig) {
  try {
    RecordingReader reader(path, rig);
    for (int pass = 0; pass < 2; ++pass) {
      ScanLine scan_line;
      int num_read = 0;
      while (reader.Next(&scan_line)) ++num_read;
      CHECK_EQ(num_read, reader.num_scan_lines());
      reader.Rewind();
    }
    for (const std::string& warning : reader.warnings()) CHECK_EQ(warning, OnOneLine(warning));
  } catch (const Error& error) {
    CHECK_EQ(std::string(error.what()).rfind(path + ": ", 0), 0u) << error.what();
  }
}

}  // namespace
}  // namespace plumbline

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const int file = memfd_create("recording.bag", MFD_CLOEXEC);
  static const std::string path = "/proc/self/fd/" + std::to_string(file);
  static const plumbline::Rig rig = plumbline::TwoScanners();
  CHECK_EQ(ftruncate(file, 0), 0);
  CHECK_EQ(pwrite(file, data, size, 0), static_cast<ssize_t>(size));
  plumbline::ReadRecording(path, rig);
  return 0;
}
