#include "core/util/one_line.h"

#include <cstdint>
#include <cstdio>

namespace plumbline {
namespace {

// The bytes of the printable character at the text's position; 0 where none is.
size_t PrintableLength(const std::string& text, size_t position) {
  const auto byte = [&text](size_t at) { return static_cast<uint8_t>(text[at]); };
  const uint8_t lead = byte(position);
  if (lead < 0x80) return lead >= 0x20 && lead != 0x7f ? 1 : 0;
  const size_t length = lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : 2;
  if (lead < 0xc2 || lead > 0xf4 || text.size() - position < length) return 0;
  uint32_t code = lead & (0xffu >> (length + 1));
  for (size_t i = 1; i < length; ++i) {
    if ((byte(position + i) & 0xc0) != 0x80) return 0;
    code = code << 6 | (byte(position + i) & 0x3fu);
  }
  const bool overlong = (length == 3 && code < 0x800) || (length == 4 && code < 0x10000);
  const bool surrogate = code >= 0xd800 && code < 0xe000;
  const bool control = code < 0xa0 || code == 0x2028 || code == 0x2029;
  return overlong || surrogate || control || code > 0x10ffff ? 0 : length;
}

std::string Escaped(char c) {
  if (c == '\n') return "\\n";
  if (c == '\r') return "\\r";
  if (c == '\t') return "\\t";
  char text[8];
  std::snprintf(text, sizeof(text), "\\x%02x", static_cast<unsigned>(static_cast<uint8_t>(c)));
  return text;
}

}  // namespace

std::string OnOneLine(const std::string& text) {
  std::string line;
  for (size_t position = 0; position < text.size();) {
    const size_t length = PrintableLength(text, position);
    if (length > 0) {
      line.append(text, position, length);
      position += length;
    } else {
      line += Escaped(text[position++]);
    }
  }
  return line;
}

std::string OnOneLine(const std::string& text, size_t max_bytes) {
  if (text.size() <= max_bytes) return OnOneLine(text);
  size_t end = max_bytes;  // not within a character
  while (end > 0 && (static_cast<uint8_t>(text[end]) & 0xc0) == 0x80) --end;
  return OnOneLine(text.substr(0, end)) + "...";
}

}  // namespace plumbline
