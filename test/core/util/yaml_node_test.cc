#include "core/util/yaml_node.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <functional>
#include <string>
#include <thread>

#include "core/util/error.h"

namespace plumbline {
namespace {

// The message of the Error that the call throws; empty when it throws none.
std::string ErrorOf(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

YamlNode Read(const std::string& text) { return YamlNode::ReadText(text, "f.yaml"); }

TEST(YamlNode, ReadsEveryType) {
  const YamlNode root = Read(
      "name: top\nquoted: \"12\"\nflag: true\ncount: 3\nvalue: +1.5e-3\n"
      "list: [1, -2.5]\nmode: b\nmap:\n  inner: 4\n");
  EXPECT_EQ(root["name"].AsString(), "top");
  EXPECT_EQ(root["quoted"].AsString(), "12");
  EXPECT_TRUE(root["flag"].AsBool());
  EXPECT_EQ(root["count"].AsInt(0, 3), 3);
  EXPECT_DOUBLE_EQ(root["value"].AsDouble(0.0, 1.0), 1.5e-3);
  EXPECT_EQ(root["list"].AsDoubles(2, -3.0, 3.0), (std::vector<double>{1.0, -2.5}));
  EXPECT_EQ(root["list"].AsDoubles(-1, -3.0, 3.0).size(), 2u);
  EXPECT_EQ(root["mode"].AsChoice({"a", "b"}), 1);
  EXPECT_EQ(root["map"]["inner"].AsInt(0, 9), 4);
  root["map"].RejectUnreadKeys();
  root.RejectUnreadKeys();
}

TEST(YamlNode, OptionalKeepsDefaults) {
  const YamlNode root = Read("a: 2.5\n");
  double a = 1.0;
  double b = 7.0;
  root.Optional("a", &a, 0.0, 3.0);
  root.Optional("b", &b, 0.0, 3.0);
  EXPECT_EQ(a, 2.5);
  EXPECT_EQ(b, 7.0);
}

TEST(YamlNode, UnknownKeyNamesItsLine) {
  const YamlNode root = Read("a: 1\n\nb: 2\n");
  root["a"].AsInt(0, 9);
  EXPECT_EQ(ErrorOf([&] { root.RejectUnreadKeys(); }), "f.yaml:3: unknown key 'b'");
  root.Ignore("b");
  EXPECT_EQ(ErrorOf([&] { root.RejectUnreadKeys(); }), "");
}

TEST(YamlNode, DuplicateKeyNamesItsLineAlsoInside) {
  EXPECT_EQ(ErrorOf([] { Read("a: 1\na: 2\n"); }), "f.yaml:2: duplicate key 'a'");
  EXPECT_EQ(ErrorOf([] { Read("l:\n  - x: 1\n    y: 1\n    x: 2\n"); }),
            "f.yaml:4: duplicate key 'x'");
}

TEST(YamlNode, MissingKeyNamesTheMapping) {
  const YamlNode root = Read("m:\n  a: 1\n");
  EXPECT_EQ(ErrorOf([&] { root["m"]["b"]; }), "f.yaml:2: missing key 'b'");
}

TEST(YamlNode, IllTypedValuesNameTheirLine) {
  const YamlNode root = Read(
      "text: abc\nquoted: \"1\"\nempty:\nlist: [1, x]\nnan: .nan\ninf: .inf\nnan2: nan\n"
      "long: 1.0m\nbig: 99999999999\nhuge: 1e999\n");
  const auto number = [&](const std::string& key) {
    return ErrorOf([&] { root[key].AsDouble(-1e9, 1e9); });
  };
  EXPECT_EQ(number("text"), "f.yaml:1: 'text' must be a finite number");
  EXPECT_EQ(number("quoted"), "f.yaml:2: 'quoted' must be a finite number");
  EXPECT_EQ(number("empty"), "f.yaml:3: 'empty' must be a finite number");
  EXPECT_EQ(number("list"), "f.yaml:4: 'list' must be a finite number");
  EXPECT_EQ(number("nan"), "f.yaml:5: 'nan' must be a finite number");
  EXPECT_EQ(number("inf"), "f.yaml:6: 'inf' must be a finite number");
  EXPECT_EQ(number("nan2"), "f.yaml:7: 'nan2' must be a finite number");
  EXPECT_EQ(number("long"), "f.yaml:8: 'long' must be a finite number");
  EXPECT_EQ(number("huge"), "f.yaml:10: 'huge' must be a finite number");
  EXPECT_EQ(ErrorOf([&] { root["big"].AsInt(0, 9); }),
            "f.yaml:9: 'big' must be a whole number");
  EXPECT_EQ(ErrorOf([&] { root["list"].AsDoubles(2, 0.0, 9.0); }),
            "f.yaml:4: 'list[1]' must be a finite number");
  EXPECT_EQ(ErrorOf([&] { root["list"].AsDoubles(3, 0.0, 9.0); }),
            "f.yaml:4: 'list' must be a list of 3 numbers");
  EXPECT_EQ(ErrorOf([&] { root["text"].AsBool(); }), "f.yaml:1: 'text' must be true or false");
  EXPECT_EQ(ErrorOf([&] { root["empty"].AsString(); }), "f.yaml:3: 'empty' must be a text");
  EXPECT_EQ(ErrorOf([&] { root["text"].Elements(); }), "f.yaml:1: 'text' must be a list");
  EXPECT_EQ(ErrorOf([&] { root["text"]["x"]; }),
            "f.yaml:1: 'text' must be a mapping (key: value)");
  EXPECT_EQ(ErrorOf([&] {
              root["text"].AsChoice({"p", "q"});
            }),
            "f.yaml:1: 'text' must be one of: p, q");
}

TEST(YamlNode, OutOfRangeNamesTheRange) {
  const YamlNode root = Read("a: 5\n");
  EXPECT_EQ(ErrorOf([&] { root["a"].AsInt(0, 4); }),
            "f.yaml:1: 'a' must lie between 0 and 4, not 5");
  EXPECT_EQ(ErrorOf([&] { root["a"].AsDouble(5.5, 6.0); }),
            "f.yaml:1: 'a' must lie between 5.5 and 6, not 5");
}

TEST(YamlNode, MalformedFilesNameFileAndLine) {
  EXPECT_EQ(ErrorOf([] { Read("a: 1\nb: [1, 2\nc: 3\n"); }).rfind("f.yaml:", 0), 0u);
  EXPECT_NE(ErrorOf([] { Read("a: 1\nb: [1, 2\nc: 3\n"); }).find("not valid YAML"),
            std::string::npos);
  EXPECT_EQ(ErrorOf([] { Read(""); }), "f.yaml:1: the file is empty");
  EXPECT_EQ(ErrorOf([] { Read("a: 1\n---\nb: 2\n"); }),
            "f.yaml:2: only one YAML document is allowed in a file");
  EXPECT_EQ(ErrorOf([] { Read("a: &x [*x]\n"); }).rfind("f.yaml:1: ", 0), 0u);
}

TEST(YamlNode, UnreadableFileIsNamed) {
  EXPECT_EQ(ErrorOf([] { YamlNode::ReadFile("no/such.yaml"); }),
            "no/such.yaml: can not read the file");
  EXPECT_EQ(ErrorOf([] { YamlNode::ReadFile("/"); }), "/: can not read the file");
  EXPECT_EQ(ErrorOf([] { YamlNode::ReadFile("/dev/zero"); }),
            "/dev/zero: can not read the file: it is a device");
}

TEST(YamlNode, APipeIsReadAsItIsWritten) {
  const std::string path = testing::TempDir() + "yaml_pipe_" + std::to_string(getpid());
  ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
  std::thread writer([&path] { std::ofstream(path) << "a: 7\n"; });
  const YamlNode node = YamlNode::ReadFile(path);
  writer.join();
  std::remove(path.c_str());
  EXPECT_TRUE(node.Has("a"));
}

// Each line stands for nine times what the line before does: 9^9 entries in all.
TEST(YamlNode, AliasesWithinAliasesAreRefusedAtOnce) {
  std::string text = "a0: &a0 [x, x, x, x, x, x, x, x, x]\n";
  for (int i = 1; i < 9; ++i) {
    const std::string alias = "*a" + std::to_string(i - 1);
    text += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [" + alias;
    for (int j = 1; j < 9; ++j) text += ", " + alias;
    text += "]\n";
  }
  const std::string error = ErrorOf([&] { Read(text); });
  EXPECT_EQ(error.rfind("f.yaml:", 0), 0u) << error;
  EXPECT_NE(error.find("aliases within aliases (*name) stand for too many entries"),
            std::string::npos)
      << error;
}

// yaml-cpp takes a stray comma for the beginning of documents without end.
TEST(YamlNode, StrayCommaIsAnError) {
  for (const char* text : {",", ", a: 1\n", "\n,\n"}) {
    EXPECT_EQ(ErrorOf([&] { Read(text); }).rfind("f.yaml:", 0), 0u) << text;
  }
}

TEST(YamlNode, AliasesThatRepeatALittleAreRead) {
  std::string text = "a: &a [1, 2, 3]\nlist:\n";
  for (int i = 0; i < 100; ++i) text += "  - *a\n";
  const YamlNode root = Read(text);
  EXPECT_EQ(root["list"].Elements().size(), 100u);
  EXPECT_EQ(root["list"].Elements()[99].AsDoubles(3, 0.0, 9.0)[2], 3.0);
}

TEST(YamlNode, ErrorsStayOnOneLine) {
  EXPECT_EQ(ErrorOf([] { Read("\"a\\nb\": 1\n\"a\\nb\": 2\n"); }),
            "f.yaml:2: duplicate key 'a\\nb'");
  const YamlNode root = Read("\"\\e[2J\\t\": 1\n");
  EXPECT_EQ(ErrorOf([&] { root.RejectUnreadKeys(); }), "f.yaml:1: unknown key '\\x1b[2J\\t'");
}

}  // namespace
}  // namespace plumbline
