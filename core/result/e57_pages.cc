#include "core/result/e57_pages.h"

#include <glog/logging.h>

#include <algorithm>
#include <boost/crc.hpp>

namespace plumbline {
namespace {

constexpr size_t kPayloadBytes = 1020;
constexpr size_t kPageBytes = 1024;

// The page's payload with its checksum, the most significant byte first.
std::string WithChecksum(const std::string& payload) {
  boost::crc_optimal<32, 0x1EDC6F41, 0xFFFFFFFF, 0xFFFFFFFF, true, true> crc32c;
  crc32c.process_bytes(payload.data(), payload.size());
  std::string page = payload;
  for (int shift = 24; shift >= 0; shift -= 8) {
    page.push_back(static_cast<char>((crc32c.checksum() >> shift) & 0xFF));
  }
  return page;
}

}  // namespace

E57Pages::E57Pages(const std::string& path, const std::string& name) : file_(path, name) {}

uint64_t E57Pages::PhysicalOffset(uint64_t logical_offset) {
  return logical_offset / kPayloadBytes * kPageBytes + logical_offset % kPayloadBytes;
}

uint64_t E57Pages::physical_size() const {
  return (logical_size_ + kPayloadBytes - 1) / kPayloadBytes * kPageBytes;
}

void E57Pages::Append(const std::string& bytes) {
  logical_size_ += bytes.size();
  for (size_t at = 0; at < bytes.size();) {
    const size_t taken = std::min(bytes.size() - at, kPayloadBytes - page_.size());
    page_.append(bytes, at, taken);
    at += taken;
    if (page_.size() == kPayloadBytes) WritePage();
  }
}

void E57Pages::WritePage() {
  page_.resize(kPayloadBytes, '\0');
  const std::string page = WithChecksum(page_);
  file_.Append(page.data(), page.size());
  if (first_page_.empty()) first_page_ = page_;
  page_.clear();
}

void E57Pages::Finish(const std::string& beginning) {
  if (!page_.empty()) WritePage();
  CHECK_LE(beginning.size(), first_page_.size());
  first_page_.replace(0, beginning.size(), beginning);
  file_.Finish(WithChecksum(first_page_));
}

}  // namespace plumbline
