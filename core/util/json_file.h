#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "core/util/error.h"
#include "core/util/text_file.h"

namespace plumbline {

// Reads a JSON file. Json: a type of nlohmann::basic_json. Throws Error naming the file where
// it can not be read, is not valid, or is nested so deeply that whatever walks through it by
// recursion would run out of stack.
template <typename Json>
Json ReadJsonFile(const std::string& path) {
  constexpr int kMaxDepth = 100;  // files of a result have at most five
  const std::string text = ReadTextFile(path);
  try {
    return Json::parse(
        text, [&path](int depth, typename Json::parse_event_t /*event*/, Json& /*parsed*/) {
          if (depth <= kMaxDepth) return true;
          throw Error(path + ": its arrays and objects are nested more than " +
                      std::to_string(kMaxDepth) + " deep");
        });
  } catch (const typename Json::parse_error& error) {
    throw Error(path + ": byte " + std::to_string(error.byte) + ": is not valid JSON");
  } catch (const typename Json::exception& error) {
    throw Error(path + ": is not valid JSON: " + error.what());
  }
}

// Reads a JSON file that holds an object. Throws Error as ReadJsonFile, and where it holds
// anything else.
template <typename Json>
Json ReadJsonObject(const std::string& path) {
  Json json = ReadJsonFile<Json>(path);
  if (!json.is_object()) throw Error(path + ": is not an object");
  return json;
}

}  // namespace plumbline
