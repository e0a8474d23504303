#pragma once

#include <cstdint>

namespace plumbline {

// Largest message that is read: a scan line of 16 million beams. Other topics' messages, which
// may be larger, are not read.
inline constexpr uint64_t kMaxMessageBytes = uint64_t{64} << 20;

// The damage that a larger message of a scanner is.
inline constexpr char kTooLarge[] =
    "a message of more than 64 MB is no scan line and was passed over";

}  // namespace plumbline
