// Feeds the readers of YAML with texts that libFuzzer makes up: the rig's, the mapper's settings,
// and one that asks a file for every type of value.

#include <glog/logging.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <string>

#include "core/options/config.h"
#include "core/sensor/rig.h"
#include "core/util/error.h"
#include "core/util/yaml_node.h"

namespace plumbline {
namespace {

// Whatever the call throws must be an Error on one line that begins with the file.
template <typename Call>
void Try(const std::string& path, const Call& call) {
  try {
    call();
  } catch (const Error& error) {
    const std::string message = error.what();
    CHECK_EQ(message.rfind(path + ":", 0), 0u) << message;
    CHECK_EQ(message, OnOneLine(message));
  }
}

void AskForEverything(const std::string& path, const YamlNode& node, int depth) {
  Try(path, [&] { node.AsString(); });
  Try(path, [&] { node.AsBool(); });
  Try(path, [&] { node.AsInt(-10, 10); });
  Try(path, [&] { node.AsDouble(-10.0, 10.0); });
  Try(path, [&] { node.AsDoubles(3, -10.0, 10.0); });
  Try(path, [&] { node.AsChoice({"automatic", "planar"}); });
  Try(path, [&] { node.RejectUnreadKeys(); });
  if (depth == 0) return;
  Try(path, [&] {
    for (const YamlNode& element : node.Elements()) AskForEverything(path, element, depth - 1);
  });
  for (const char* key : {"scanners", "name", "body_from_scanner", "translation", "a"}) {
    Try(path, [&] { AskForEverything(path, node[key], depth - 1); });
  }
}

}  // namespace
}  // namespace plumbline

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const int file = memfd_create("fuzz.yaml", MFD_CLOEXEC);
  static const std::string path = "/proc/self/fd/" + std::to_string(file);
  CHECK_EQ(ftruncate(file, 0), 0);
  CHECK_EQ(pwrite(file, data, size, 0), static_cast<ssize_t>(size));
  using plumbline::Try;
  Try(path, [] { plumbline::AskForEverything(path, plumbline::YamlNode::ReadFile(path), 3); });
  Try(path, [] { plumbline::ReadRig(path); });
  Try(path, [] { plumbline::ReadMapperOptions(path); });
  return 0;
}
