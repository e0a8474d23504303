#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace YAML {
class Node;
}

namespace plumbline {

// A YAML mapping, sequence or scalar that is read strictly: every key must be asked for, none
// may stand twice, types and ranges must fit. Every error is an Error whose message starts
// with "file:line: ". Reading code names each key once:
//
//   YamlNode root = YamlNode::ReadFile("rig.yaml");
//   for (const YamlNode& scanner : root["scanners"].Elements()) {
//     name = scanner["name"].AsString();
//     noise = scanner["range_noise_m"].AsDouble(0.0001, 1.0);
//     scanner.Optional("time_offset_s", &offset, -10.0, 10.0);  // keeps the default if absent
//     scanner.RejectUnreadKeys();                               // last, on each mapping
//   }
class YamlNode {
 public:
  static YamlNode ReadFile(const std::string& path);
  static YamlNode ReadText(const std::string& text, const std::string& name);

  bool IsMapping() const;
  bool Has(const std::string& key) const;             // marks the key as known
  YamlNode operator[](const std::string& key) const;  // Error when the key is missing
  std::vector<YamlNode> Elements() const;             // of a sequence

  std::string AsString() const;
  bool AsBool() const;
  int AsInt(int min, int max) const;
  double AsDouble(double min, double max) const;  // finite, min <= value <= max
  // A sequence of exactly size numbers (size < 0: any number of them).
  std::vector<double> AsDoubles(int size, double min, double max) const;
  // One of the allowed words; returns its index.
  int AsChoice(const std::vector<std::string>& allowed) const;

  // Read the key into *value where it is present.
  void Optional(const std::string& key, bool* value) const;
  void Optional(const std::string& key, int* value, int min, int max) const;
  void Optional(const std::string& key, double* value, double min, double max) const;
  void Optional(const std::string& key, std::string* value) const;

  // Error that names the first key that nobody asked for, with its line.
  void RejectUnreadKeys() const;
  // Error where a key stands that has another name now: it names both.
  void RejectRenamed(const std::string& old_key, const std::string& new_key) const;
  // Error where a key stands that nothing reads any more: it gives the reason.
  void RejectRemoved(const std::string& key, const std::string& why) const;
  // Declares a key as known without reading it (another program's part of a shared file).
  void Ignore(const std::string& key) const;

  [[noreturn]] void Fail(const std::string& message) const;  // Error at this node's line
  std::string Location() const;                              // "file:line"

 private:
  struct State;
  YamlNode(std::shared_ptr<State> state);
  std::shared_ptr<State> state_;
};

}  // namespace plumbline
