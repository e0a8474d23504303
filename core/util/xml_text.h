#pragma once

#include <string>

namespace plumbline {

// A text as it stands in an element or an attribute of XML or SVG.
std::string XmlEscaped(const std::string& text);

}  // namespace plumbline
