#include "core/util/yaml_node.h"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <system_error>
#include <utility>

#include "core/util/error.h"
#include "core/util/one_line.h"

namespace plumbline {
namespace {

// Deeper nesting than any file of ours; stops at anchors that refer to themselves.
constexpr int kMaxDepth = 32;

// The text that another process writes into a pipe. Throws Error where it does not begin, or
// does not go on, within some seconds.
std::string TextOfPipe(const std::string& path) {
  constexpr int kPatienceMs = 10'000;
  const int pipe = open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  std::string text;
  ssize_t num_read = -1;
  while (pipe >= 0) {
    pollfd wait = {pipe, POLLIN, 0};
    if (poll(&wait, 1, kPatienceMs) <= 0) break;
    char bytes[4096];
    num_read = read(pipe, bytes, sizeof(bytes));
    if (num_read <= 0) break;
    text.append(bytes, static_cast<size_t>(num_read));
    num_read = -1;
  }
  if (pipe >= 0) close(pipe);
  if (num_read != 0) {
    throw Error(path + ": can not read the file: it is a pipe into which nobody writes");
  }
  return text;
}

std::string LocationOf(const std::string& name, int line) {
  return name + ":" + std::to_string(line);
}

// yaml-cpp counts lines from 0, gives -1 for nodes without a place in the text and the place
// of what follows for an empty value.
int LineOf(const YAML::Node& node, int fallback) {
  const YAML::Mark mark = node.Mark();
  return mark.line < 0 || node.IsNull() ? fallback : mark.line + 1;
}

// Keys and yaml-cpp's own words in messages.
constexpr size_t kMaxQuotedBytes = 100;

std::string Quoted(const std::string& key) {
  return "'" + OnOneLine(key, kMaxQuotedBytes) + "'";
}

// Checks what yaml-cpp lets pass. An alias stands for all that its anchor holds, so a few
// lines of aliases within aliases stand for billions of entries: these are counted as they are
// passed, and without aliases there are at most as many as the text has bytes.
class DocumentCheck {
 public:
  DocumentCheck(const std::string& name, size_t text_bytes)
      : name_(name), entries_left_(kMaxAliasEntries + text_bytes) {}

  void Check(const YAML::Node& node, int line, int depth) {
    line = LineOf(node, line);
    if (depth > kMaxDepth) throw Error(LocationOf(name_, line) + ": nested too deeply");
    if (entries_left_ == 0) {
      throw Error(LocationOf(name_, line) +
                  ": aliases within aliases (*name) stand for too many entries");
    }
    --entries_left_;
    if (node.IsSequence()) {
      for (const auto& element : node) Check(element, line, depth + 1);
    }
    if (node.IsMap()) CheckMapping(node, line, depth);
  }

 private:
  static constexpr size_t kMaxAliasEntries = 10000;

  // yaml-cpp keeps both entries of a key that stands twice and answers with the first.
  void CheckMapping(const YAML::Node& node, int line, int depth) {
    std::set<std::string> keys;
    for (const auto& entry : node) {
      const int key_line = LineOf(entry.first, line);
      if (!entry.first.IsScalar()) {
        throw Error(LocationOf(name_, key_line) + ": a key must be a single word");
      }
      if (!keys.insert(entry.first.Scalar()).second) {
        throw Error(LocationOf(name_, key_line) + ": duplicate key " +
                    Quoted(entry.first.Scalar()));
      }
      Check(entry.second, key_line, depth + 1);
    }
  }

  const std::string& name_;
  size_t entries_left_;
};

// Strict and independent of the locale; nullopt unless the whole text is a number.
template <typename Number>
std::optional<Number> ParseNumber(const std::string& text) {
  const char* begin = text.data();
  const char* end = begin + text.size();
  if (text.size() > 1 && *begin == '+' && begin[1] != '-') ++begin;
  Number value{};
  const auto [rest, error] = std::from_chars(begin, end, value);
  if (error != std::errc() || rest != end) return std::nullopt;
  return value;
}

template <typename Number>
std::string FormatNumber(Number value) {
  std::ostringstream out;
  out << value;
  return out.str();
}

// Notices where each document of a text begins.
class DocumentStarts : public YAML::EventHandler {
 public:
  int last_line() const { return last_line_; }

  void OnDocumentStart(const YAML::Mark& mark) override { last_line_ = mark.line + 1; }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark&, YAML::anchor_t) override {}
  void OnAlias(const YAML::Mark&, YAML::anchor_t) override {}
  void OnScalar(const YAML::Mark&,
                const std::string&,
                YAML::anchor_t,
                const std::string&) override {}
  void OnSequenceStart(const YAML::Mark&,
                       const std::string&,
                       YAML::anchor_t,
                       YAML::EmitterStyle::value) override {}
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark&,
                  const std::string&,
                  YAML::anchor_t,
                  YAML::EmitterStyle::value) override {}
  void OnMapEnd() override {}

 private:
  int last_line_ = 1;
};

// Throws Error when the text holds more than one document. (YAML::LoadAll takes a stray comma
// for documents without end.)
void CheckDocuments(const std::string& text, const std::string& name) {
  std::istringstream in(text);
  YAML::Parser parser(in);
  DocumentStarts starts;
  if (!parser.HandleNextDocument(starts) || !parser.HandleNextDocument(starts)) return;
  throw Error(LocationOf(name, starts.last_line()) +
              ": only one YAML document is allowed in a file");
}

}  // namespace

struct YamlNode::State {
  YAML::Node node;
  std::string file;
  std::string path;  // for messages, "scanners[0].name"; empty for the root
  int line = 1;
  std::set<std::string> known_keys;
  std::map<std::string, std::shared_ptr<State>> children;  // so that known_keys are kept

  std::string What() const { return path.empty() ? "the file" : "'" + path + "'"; }
};

YamlNode::YamlNode(std::shared_ptr<State> state) : state_(std::move(state)) {}

YamlNode YamlNode::ReadFile(const std::string& path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (std::filesystem::is_fifo(status)) return ReadText(TextOfPipe(path), path);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status) &&
      !std::filesystem::is_directory(status)) {
    throw Error(path + ": can not read the file: it is a device");
  }
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  // A directory opens like a file and fails only when it is read.
  if (!in || (in.peek(), in.bad()) || (!in.eof() && !(text << in.rdbuf()))) {
    throw Error(path + ": can not read the file");
  }
  return ReadText(text.str(), path);
}

YamlNode YamlNode::ReadText(const std::string& text, const std::string& name) {
  YAML::Node document;
  try {
    CheckDocuments(text, name);
    document = YAML::Load(text);
  } catch (const YAML::Exception& exception) {
    const int line = exception.mark.line < 0 ? 1 : exception.mark.line + 1;
    throw Error(LocationOf(name, line) +
                ": not valid YAML: " + OnOneLine(exception.msg, kMaxQuotedBytes));
  }
  if (!document.IsDefined() || document.IsNull()) throw Error(name + ":1: the file is empty");
  DocumentCheck(name, text.size()).Check(document, 1, 0);
  auto state = std::make_shared<State>();
  state->node = document;
  state->file = name;
  state->line = LineOf(document, 1);
  return YamlNode(std::move(state));
}

bool YamlNode::IsMapping() const { return state_->node.IsMap(); }

bool YamlNode::Has(const std::string& key) const {
  if (!state_->node.IsMap()) Fail(state_->What() + " must be a mapping (key: value)");
  state_->known_keys.insert(key);
  const YAML::Node& node = state_->node;
  return static_cast<bool>(node[key]);
}

YamlNode YamlNode::operator[](const std::string& key) const {
  if (!Has(key)) Fail("missing key '" + key + "'");
  std::shared_ptr<State>& child = state_->children[key];
  if (child == nullptr) {
    child = std::make_shared<State>();
    child->file = state_->file;
    child->path = state_->path.empty() ? key : state_->path + "." + key;
    for (const auto& entry : state_->node) {
      if (entry.first.Scalar() != key) continue;
      child->node = entry.second;
      child->line = LineOf(entry.second, LineOf(entry.first, state_->line));
    }
  }
  return YamlNode(child);
}

std::vector<YamlNode> YamlNode::Elements() const {
  if (!state_->node.IsSequence()) Fail(state_->What() + " must be a list");
  std::vector<YamlNode> elements;
  for (const auto& element : state_->node) {
    auto state = std::make_shared<State>();
    state->node = YAML::Node(element);
    state->file = state_->file;
    state->path = state_->path + "[" + std::to_string(elements.size()) + "]";
    state->line = LineOf(element, state_->line);
    elements.push_back(YamlNode(std::move(state)));
  }
  return elements;
}

std::string YamlNode::AsString() const {
  if (!state_->node.IsScalar() || state_->node.Scalar().empty()) {
    Fail(state_->What() + " must be a text");
  }
  return state_->node.Scalar();
}

bool YamlNode::AsBool() const {
  if (state_->node.IsScalar() && state_->node.Tag() == "?") {
    if (state_->node.Scalar() == "true") return true;
    if (state_->node.Scalar() == "false") return false;
  }
  Fail(state_->What() + " must be true or false");
}

int YamlNode::AsInt(int min, int max) const {
  // Quoted scalars carry another tag: they are texts.
  std::optional<int> value;
  if (state_->node.IsScalar() && state_->node.Tag() == "?") {
    value = ParseNumber<int>(state_->node.Scalar());
  }
  if (!value) Fail(state_->What() + " must be a whole number");
  if (*value < min || *value > max) {
    Fail(state_->What() + " must lie between " + FormatNumber(min) + " and " +
         FormatNumber(max) + ", not " + FormatNumber(*value));
  }
  return *value;
}

double YamlNode::AsDouble(double min, double max) const {
  std::optional<double> value;
  if (state_->node.IsScalar() && state_->node.Tag() == "?") {
    value = ParseNumber<double>(state_->node.Scalar());
  }
  if (!value || !std::isfinite(*value)) Fail(state_->What() + " must be a finite number");
  if (*value < min || *value > max) {
    Fail(state_->What() + " must lie between " + FormatNumber(min) + " and " +
         FormatNumber(max) + ", not " + FormatNumber(*value));
  }
  return *value;
}

std::vector<double> YamlNode::AsDoubles(int size, double min, double max) const {
  if (!state_->node.IsSequence() ||
      (size >= 0 && state_->node.size() != static_cast<size_t>(size))) {
    Fail(state_->What() + " must be a list of " +
         (size >= 0 ? std::to_string(size) + " numbers" : std::string("numbers")));
  }
  std::vector<double> values;
  for (const YamlNode& element : Elements()) values.push_back(element.AsDouble(min, max));
  return values;
}

int YamlNode::AsChoice(const std::vector<std::string>& allowed) const {
  std::string list;
  for (size_t i = 0; i < allowed.size(); ++i) {
    if (state_->node.IsScalar() && state_->node.Scalar() == allowed[i]) {
      return static_cast<int>(i);
    }
    list += (i == 0 ? "" : ", ") + allowed[i];
  }
  Fail(state_->What() + " must be one of: " + list);
}

void YamlNode::Optional(const std::string& key, bool* value) const {
  if (Has(key)) *value = (*this)[key].AsBool();
}

void YamlNode::Optional(const std::string& key, int* value, int min, int max) const {
  if (Has(key)) *value = (*this)[key].AsInt(min, max);
}

void YamlNode::Optional(const std::string& key, double* value, double min, double max) const {
  if (Has(key)) *value = (*this)[key].AsDouble(min, max);
}

void YamlNode::Optional(const std::string& key, std::string* value) const {
  if (Has(key)) *value = (*this)[key].AsString();
}

void YamlNode::RejectUnreadKeys() const {
  if (!state_->node.IsMap()) Fail(state_->What() + " must be a mapping (key: value)");
  for (const auto& entry : state_->node) {
    const std::string key = entry.first.Scalar();
    if (state_->known_keys.count(key) > 0) continue;
    throw Error(LocationOf(state_->file, LineOf(entry.first, state_->line)) +
                ": unknown key " + Quoted(key));
  }
}

void YamlNode::RejectRenamed(const std::string& old_key, const std::string& new_key) const {
  if (Has(old_key)) (*this)[old_key].Fail("'" + old_key + "' is called '" + new_key + "' now");
}

void YamlNode::RejectRemoved(const std::string& key, const std::string& why) const {
  if (Has(key)) (*this)[key].Fail("leave out '" + key + "': " + why);
}

void YamlNode::Ignore(const std::string& key) const { state_->known_keys.insert(key); }

void YamlNode::Fail(const std::string& message) const {
  throw Error(Location() + ": " + message);
}

std::string YamlNode::Location() const { return LocationOf(state_->file, state_->line); }

}  // namespace plumbline
