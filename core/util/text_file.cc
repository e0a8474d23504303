#include "core/util/text_file.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>

#include "core/util/error.h"

namespace plumbline {

std::string ReadTextFile(const std::string& path) {
  errno = 0;
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  if (!stream || (text.tellp() <= 0 && errno != 0)) {
    throw Error(path + ": can not be read: " + std::strerror(errno != 0 ? errno : EIO));
  }
  return text.str();
}

}  // namespace plumbline
