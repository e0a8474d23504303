#include "core/outputs/data_section.h"

#include <glog/logging.h>
#include <libdeflate.h>
#include <tbb/parallel_for.h>

#include <memory>

namespace plumbline {
namespace {

// Higher levels take several times as long and save less than a twentieth: most bytes are
// noise, of which only the frequencies of values can be made use of.
constexpr int kDeflateLevel = 1;

std::vector<uint8_t> Deflate(const std::vector<uint8_t>& bytes) {
  const std::unique_ptr<libdeflate_compressor, decltype(&libdeflate_free_compressor)>
      compressor(libdeflate_alloc_compressor(kDeflateLevel), &libdeflate_free_compressor);
  CHECK(compressor != nullptr);
  std::vector<uint8_t> packed(libdeflate_zlib_compress_bound(compressor.get(), bytes.size()));
  const size_t size = libdeflate_zlib_compress(
      compressor.get(), bytes.data(), bytes.size(), packed.data(), packed.size());
  CHECK_GT(size, 0U);
  packed.resize(size);
  return packed;
}

std::string FormatSection(const DataSection& section) {
  return "<script type=\"application/zlib\" id=\"" + section.name + "\">" +
         Base64(Deflate(section.bytes)) + "</script>\n";
}

}  // namespace

std::string Base64(const std::vector<uint8_t>& bytes) {
  static constexpr char kDigits[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text((bytes.size() + 2) / 3 * 4, '=');
  size_t out = 0;
  for (size_t i = 0; i < bytes.size(); i += 3) {
    const size_t count = std::min<size_t>(3, bytes.size() - i);
    uint32_t word = 0;
    for (size_t k = 0; k < 3; ++k) word = word << 8 | (k < count ? bytes[i + k] : 0U);
    for (size_t k = 0; k <= count; ++k) text[out + k] = kDigits[word >> (18 - 6 * k) & 63U];
    out += 4;
  }
  return text;
}

std::string FormatSections(const std::vector<DataSection>& sections) {
  std::vector<std::string> texts(sections.size());
  tbb::parallel_for(
      size_t{0}, sections.size(), [&](size_t i) { texts[i] = FormatSection(sections[i]); });
  std::string all;
  for (const std::string& text : texts) all += text;
  return all;
}

}  // namespace plumbline
