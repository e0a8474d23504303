#pragma once

#include <cstdint>
#include <string>

#include "core/util/large_file.h"

namespace plumbline {

// The pages of an E57 file (ASTM E2807): 1020 bytes each, and their CRC-32C. Offsets that
// count the bytes without the checksums are logical, those that count them are physical.
class E57Pages {
 public:
  // Throws Error, as the functions below do, naming the file.
  E57Pages(const std::string& path, const std::string& name);

  void Append(const std::string& bytes);
  // Size of the bytes appended, without checksums.
  uint64_t logical_size() const { return logical_size_; }
  // Size of the file that Finish() leaves if nothing more is appended.
  uint64_t physical_size() const;
  static uint64_t PhysicalOffset(uint64_t logical_offset);

  // Fills up the last page and writes `beginning` over the first bytes, which the first page
  // must hold. Call once, at the end.
  void Finish(const std::string& beginning);

 private:
  void WritePage();

  LargeFile file_;
  uint64_t logical_size_ = 0;
  std::string page_;        // begun, without its checksum
  std::string first_page_;  // once it is written
};

}  // namespace plumbline
