#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace plumbline {

// Bytes that the page unpacks: an HTML element of the name as its id, which holds the bytes in
// zlib's format as base64.
struct DataSection {
  std::string name;
  std::vector<uint8_t> bytes;
};

// Makes the elements of the sections, one a line, in their order; packs them side by side on
// the caller's threads.
std::string FormatSections(const std::vector<DataSection>& sections);

// Returns the bytes in base64, with padding.
std::string Base64(const std::vector<uint8_t>& bytes);

}  // namespace plumbline
