#include "core/util/date.h"

#include <ctime>

namespace plumbline {

std::string FormatDate(int64_t time_ns) {
  const auto seconds = static_cast<std::time_t>(time_ns / 1'000'000'000);
  std::tm date = {};
  gmtime_r(&seconds, &date);
  char text[64];
  return std::string(text, std::strftime(text, sizeof(text), "%Y-%m-%d %H:%M:%S UTC", &date));
}

}  // namespace plumbline
