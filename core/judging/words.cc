#include "core/judging/words.h"

#include <array>
#include <cstdio>

#include "core/judging/levels.h"

namespace plumbline {

std::string Decimal(double value, int digits) {
  std::array<char, 64> text;
  std::snprintf(text.data(), text.size(), "%.*f", digits, value);
  const std::string written = text.data();
  const bool is_zero = written.find_first_not_of("-0.") == std::string::npos;
  return is_zero && written[0] == '-' ? written.substr(1) : written;
}

std::string PercentOf(double share) {
  const double percent = 100.0 * share;
  return Decimal(percent, percent > 0.0 && percent < 1.0 ? 1 : 0) + " %";
}

std::string SpansInWords(const std::vector<int64_t>& seconds, size_t min_length) {
  std::string words;
  int num_spans = 0;
  for (size_t first = 0, last = 0; first < seconds.size(); first = last) {
    while (last < seconds.size() &&
           seconds[last] - seconds[first] == static_cast<int64_t>(last - first)) {
      ++last;
    }
    if (last - first >= min_length && ++num_spans <= kMaxNamed) {
      words += (words.empty() ? "from " : ", from ") + std::to_string(seconds[first]) +
               " to " + std::to_string(seconds[last - 1] + 1) + " s";
    }
  }
  if (num_spans > kMaxNamed)
    words += " and " + std::to_string(num_spans - kMaxNamed) + " more";
  return words;
}

std::string Enumerate(const std::vector<std::string>& names) {
  std::string words;
  for (size_t i = 0; i < names.size(); ++i) {
    if (i > 0) words += i + 1 == names.size() ? " and " : ", ";
    words += names[i];
  }
  return words;
}

std::string Wrapped(const std::string& text,
                    const std::string& first,
                    const std::string& indent,
                    size_t width) {
  std::string wrapped;
  std::string line = first;
  size_t begin = 0;
  bool is_new = true;
  while (begin < text.size()) {
    size_t end = text.find(' ', begin);
    if (end == std::string::npos) end = text.size();
    const std::string word = text.substr(begin, end - begin);
    if (!is_new && line.size() + 1 + word.size() > width) {
      wrapped += line + "\n";
      line = indent;
      is_new = true;
    }
    line += (is_new ? "" : " ") + word;
    is_new = false;
    begin = end + 1;
  }
  return wrapped + line + "\n";
}

}  // namespace plumbline
