#include "apps/help.h"

#include <gflags/gflags.h>

#include <algorithm>
#include <sstream>

#include "apps/version.h"
#include "core/util/xml_text.h"

namespace plumbline {
namespace {

std::vector<gflags::CommandLineFlagInfo> OurFlags(const Help& help) {
  std::vector<gflags::CommandLineFlagInfo> all;
  gflags::GetAllFlags(&all);
  std::vector<gflags::CommandLineFlagInfo> ours;
  for (const gflags::CommandLineFlagInfo& flag : all) {
    if (flag.filename == help.source_file) ours.push_back(flag);
  }
  return ours;
}

bool IsRequired(const Help& help, const std::string& flag) {
  return std::find(help.required_flags.begin(), help.required_flags.end(), flag) !=
         help.required_flags.end();
}

// Returns the words of a text in lines of `width`; all lines but the first begin with `indent`
// spaces, where the first one has begun already.
std::string Wrapped(const std::string& text, size_t indent, size_t width) {
  std::istringstream words(text);
  std::string wrapped;
  size_t column = indent;
  for (std::string word; words >> word;) {
    if (column > indent && column + 1 + word.size() > width) {
      wrapped += "\n" + std::string(indent, ' ');
      column = indent;
    }
    if (column > indent) wrapped += ' ';
    column += word.size() + (column > indent ? 1 : 0);
    wrapped += word;
  }
  return wrapped;
}

std::string Element(const char* name, const std::string& text) {
  return std::string("<") + name + ">" + XmlEscaped(text) + "</" + name + ">";
}

}  // namespace

std::string HelpText(const Help& help, size_t width) {
  const std::vector<gflags::CommandLineFlagInfo> flags = OurFlags(help);
  std::string usage = "Usage: " + help.program;
  for (const std::string& flag : help.required_flags) usage += " --" + flag + "=...";
  std::string text = Wrapped(help.program + ": " + help.purpose, 0, width) + "\n\n" +
                     Wrapped(usage + " [other flags]", 0, width) + "\n\nFlags:\n";
  size_t longest = 0;
  for (const gflags::CommandLineFlagInfo& flag : flags) {
    longest = std::max(longest, flag.name.size());
  }
  const size_t indent = longest + 6;
  for (const gflags::CommandLineFlagInfo& flag : flags) {
    std::string meaning = flag.description;
    if (IsRequired(help, flag.name)) meaning += " (required)";
    if (!flag.default_value.empty()) meaning += " (default: " + flag.default_value + ")";
    std::string name = "  --" + flag.name;
    name.resize(indent, ' ');
    text += name + Wrapped(meaning, indent, width) + "\n";
  }
  return text + "\n" +
         Wrapped(
             "The files are described in docs/inputs.md and docs/outputs.md. --version says "
             "which version this is.",
             0,
             width) +
         "\n";
}

std::string HelpXml(const Help& help) {
  std::string xml = "<?xml version=\"1.0\"?>\n<AllFlags>\n" +
                    Element("program", help.program) + Element("version", Version()) +
                    Element("usage", help.purpose) + "\n";
  for (const gflags::CommandLineFlagInfo& flag : OurFlags(help)) {
    xml += "<flag>" + Element("name", flag.name) + Element("meaning", flag.description) +
           Element("default", flag.default_value) + Element("type", flag.type) +
           (IsRequired(help, flag.name) ? "<required/>" : "") + "</flag>\n";
  }
  return xml + "</AllFlags>\n";
}

}  // namespace plumbline
