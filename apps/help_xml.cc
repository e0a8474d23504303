#include "apps/help_xml.h"

#include <gflags/gflags.h>

#include <algorithm>

#include "apps/version.h"

namespace plumbline {
namespace {

std::string Escaped(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

std::string Element(const char* name, const std::string& text) {
  return std::string("<") + name + ">" + Escaped(text) + "</" + name + ">";
}

}  // namespace

std::string HelpXml(const std::string& program,
                    const std::string& purpose,
                    const std::string& source_file,
                    const std::vector<std::string>& required_flags) {
  std::string xml = "<?xml version=\"1.0\"?>\n<AllFlags>\n" + Element("program", program) +
                    Element("version", Version()) + Element("usage", purpose) + "\n";
  std::vector<gflags::CommandLineFlagInfo> flags;
  gflags::GetAllFlags(&flags);
  for (const gflags::CommandLineFlagInfo& flag : flags) {
    if (flag.filename != source_file) continue;
    const bool is_required =
        std::find(required_flags.begin(), required_flags.end(), flag.name) !=
        required_flags.end();
    xml += "<flag>" + Element("name", flag.name) + Element("meaning", flag.description) +
           Element("default", flag.default_value) + Element("type", flag.type) +
           (is_required ? "<required/>" : "") + "</flag>\n";
  }
  return xml + "</AllFlags>\n";
}

}  // namespace plumbline
