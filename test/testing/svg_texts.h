#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <regex>
#include <string>
#include <vector>

namespace plumbline {

// SvgTextBox is one text of a drawing as a reader of SVG places it: the corners of the box
// that its digits and capitals take, in the drawing's unit.
struct SvgTextBox {
  std::string text;
  std::array<Eigen::Vector2d, 4> corners;
};

namespace svg_texts_internal {

inline std::string Attribute(const std::string& element, const std::string& name) {
  std::smatch match;
  const std::regex pattern(name + "[=:]\"?([-a-z0-9.]+)");
  return std::regex_search(element, match, pattern) ? match[1].str() : "";
}

// In the units of Helvetica's metrics (Adobe's AFM file), of a size of 1000.
inline double HelveticaWidth(const std::string& text) {
  double width = 0.0;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if ((byte & 0xC0) == 0x80) continue;
    if (byte >= 0x80) {
      width += 584.0;  // plusminus; the superscript is narrower
    } else if (c == '.' || c == ',' || c == ' ') {
      width += 278.0;
    } else {
      width += c == 'm' ? 833.0 : 556.0;
    }
  }
  return width;
}

}  // namespace svg_texts_internal

// All texts of a drawing that FormatSvg wrote, smaller parts of a line at their own size.
inline std::vector<SvgTextBox> TextsOf(const std::string& svg) {
  using svg_texts_internal::Attribute;
  constexpr double kCapHeight = 0.718;  // of Helvetica
  std::vector<SvgTextBox> texts;
  const std::regex element("<text([^>]*)>(.*)</text>");
  const std::regex part("<tspan([^>]*)>(.*)</tspan>");
  for (std::sregex_iterator at(svg.begin(), svg.end(), element), end; at != end; ++at) {
    const std::string attributes = (*at)[1];
    std::string content = (*at)[2];
    const double size = std::stod(Attribute(attributes, "font-size"));
    double width = 0.0;
    std::smatch small;
    if (std::regex_search(content, small, part)) {
      width += svg_texts_internal::HelveticaWidth(small[2]) * 1e-3 *
               std::stod(Attribute(small[1], "font-size"));
      content = small.prefix();
    }
    width += svg_texts_internal::HelveticaWidth(content) * 1e-3 * size;
    const Eigen::Vector2d origin(std::stod(Attribute(attributes, " x")),
                                 std::stod(Attribute(attributes, " y")));
    double begin = -0.5 * width;
    if (attributes.find("text-anchor:start") != std::string::npos) begin = 0.0;
    if (attributes.find("text-anchor:end") != std::string::npos) begin = -width;
    std::smatch turn;
    double angle = 0.0;
    if (std::regex_search(attributes, turn, std::regex("rotate\\(([-0-9.]+)"))) {
      angle = std::stod(turn[1]) * M_PI / 180.0;
    }
    const Eigen::Vector2d along(std::cos(angle), std::sin(angle));
    const Eigen::Vector2d up = kCapHeight * size * Eigen::Vector2d(along.y(), -along.x());
    const Eigen::Vector2d a = origin + begin * along;
    const Eigen::Vector2d b = a + width * along;
    texts.push_back({(*at)[2], {a, b, b + up, a + up}});
  }
  return texts;
}

// Whether two boxes have a point in common, by the axes of both.
inline bool DoOverlap(const SvgTextBox& a, const SvgTextBox& b) {
  for (const SvgTextBox* box : {&a, &b}) {
    for (size_t i = 0; i < 2; ++i) {
      const Eigen::Vector2d axis = box->corners[i + 1] - box->corners[i];
      double low[2];
      double high[2];
      for (size_t k = 0; k < 2; ++k) {
        const auto& corners = (k == 0 ? a : b).corners;
        low[k] = high[k] = axis.dot(corners[0]);
        for (const Eigen::Vector2d& corner : corners) {
          low[k] = std::min(low[k], axis.dot(corner));
          high[k] = std::max(high[k], axis.dot(corner));
        }
      }
      if (high[0] < low[1] || high[1] < low[0]) return false;
    }
  }
  return true;
}

// The pairs of texts that lie on each other, "a | b".
inline std::vector<std::string> OverlapsIn(const std::string& svg) {
  const std::vector<SvgTextBox> texts = TextsOf(svg);
  std::vector<std::string> overlaps;
  for (size_t i = 0; i < texts.size(); ++i) {
    for (size_t k = i + 1; k < texts.size(); ++k) {
      if (DoOverlap(texts[i], texts[k]))
        overlaps.push_back(texts[i].text + " | " + texts[k].text);
    }
  }
  return overlaps;
}

}  // namespace plumbline
