#pragma once

#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <string>

#include "core/util/error.h"

namespace plumbline {

// A file of this name in a folder of the running test's own.
inline std::string WriteTestFile(const std::string& name, const std::string& text) {
  const testing::TestInfo* info = testing::UnitTest::GetInstance()->current_test_info();
  const std::string path =
      testing::TempDir() + info->test_suite_name() + "_" + info->name() + "_" + name;
  std::ofstream(path) << text;
  return path;
}

// The message of the Error that the call throws; empty when it throws none.
inline std::string ErrorOf(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace plumbline
