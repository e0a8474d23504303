#pragma once

#include <cstdint>
#include <string>

namespace plumbline {

// "1970-01-01 00:00:00 UTC", of an instant in ns since 1970.
std::string FormatDate(int64_t time_ns);

}  // namespace plumbline
