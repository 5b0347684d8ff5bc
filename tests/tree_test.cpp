// SPDX-License-Identifier: Apache-2.0
// Files and functions stay short, every file carries its licence, and no two types of one namespace share a
// name.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "tests/support/paths.h"
#include "tests/support/source_tree.h"
#include "tests/support/text_scan.h"

namespace lucerna::test {
namespace {

namespace fs = std::filesystem;

TEST(Tree, FilesAreShortAndLicensed) {
  for (const fs::path& file : source_files()) {
    const auto lines = lines_of(file);
    EXPECT_LE(lines.size(), 600u) << file << ": one concept a file";
    ASSERT_FALSE(lines.empty()) << file;
    EXPECT_EQ(lines.front(), "// SPDX-License-Identifier: Apache-2.0") << file;
  }
}

/// The types that a header defines in a namespace, for all who include it: `struct Name {`, `enum class Name
/// : base {` at the left margin. Names in `detail` and other inner namespaces count too.
std::vector<std::string> types_of(const std::vector<std::string>& lines) {
  std::vector<std::string> types;
  for (const std::string& line : lines) {
    for (const char* word : {"struct ", "class ", "enum class ", "enum "}) {
      if (line.rfind(word, 0) != 0 || line.find('{') == std::string::npos) continue;
      const std::size_t begin = std::string(word).size(), end = line.find_first_of(" :{<", begin);
      const bool nested = line.substr(end, 2) == "::";
      if (end > begin && !nested && line.substr(begin, 6) != "class ")
        types.push_back(line.substr(begin, end - begin));
    }
  }
  return types;
}

// Two classes of one name in one library: the linker takes one's functions for the other's, and says nothing.
TEST(Tree, NoTwoHeadersDefineTypesOfOneName) {
  // Two sides of an #if, never in one program.
  const std::set<std::string> kTwoSides{"Float", "Int", "Mask", "SimdDouble"};
  std::map<std::string, fs::path> owner;
  for (const fs::path& file : source_files()) {
    if (file.extension() != ".h") continue;
    for (const std::string& type : types_of(lines_of(file))) {
      const auto [at, first] = owner.emplace(type, file);
      if (!first && at->second != file && !kTwoSides.contains(type)) {
        ADD_FAILURE() << type << " is in " << at->second << " and in " << file;
      }
    }
  }
  EXPECT_GT(owner.size(), 100u);
}

TEST(Tree, CheckSeesTypes) {
  EXPECT_EQ(types_of({"struct A {", "class B final : public A {", "enum class C { one };", "class D;",
                      "  struct E {", "template <class T>", "struct F {", "struct G::H {"}),
            (std::vector<std::string>{"A", "B", "C", "F"}));
}

/// Types of the parameters of `text`, which begins after the opening bracket: what stands before each
/// parameter's name, without defaults.
std::string parameter_types(const std::string& text) {
  std::string types, word;
  int depth = 0;
  for (const char c : text + ")") {
    const bool ends = depth == 0 && (c == ',' || c == ')');
    if (!ends) {
      depth += (c == '<' || c == '(' || c == '{') - (c == '>' || c == ')' || c == '}');
      word += c;
      continue;
    }
    word = word.substr(0, word.find(" = "));
    const std::size_t name = word.find_last_of(" &*");
    types += word.substr(0, name == std::string::npos ? word.size() : name + 1) + ",";
    word.clear();
    if (c == ')') break;
  }
  std::erase(types, ' ');
  return types;
}

/// What the line at the left margin defines in an unnamed namespace: a type, the constants of that line, or a
/// function with its parameters (which may go on in the lines after).
std::vector<std::string> names_of(const std::vector<std::string>& lines, std::size_t at) {
  const std::string& line = lines[at];
  if (auto types = types_of({line}); !types.empty()) return types;
  if (line.empty() || std::string("} #/)").find(line[0]) != std::string::npos) return {};
  if (line.starts_with("constexpr ")) {
    std::vector<std::string> names;
    for (const std::string& rest : between(line.substr(0, line.find("//")), " k", " =")) {
      if (rest.find_first_of(" (;") == std::string::npos) names.push_back("k" + rest);
    }
    return names;
  }
  const std::size_t open = line.find('('), name = line.find_last_of(" &*", open) + 1;
  if (open == std::string::npos || name == 0 || name >= open || line.starts_with("using ")) return {};
  std::string parameters = line.substr(open + 1);
  for (std::size_t i = at; lines[i].find(')') == std::string::npos && i + 1 < lines.size(); ++i)
    parameters += lines[i + 1];
  return {line.substr(name, open - name) + "(" + parameter_types(parameters)};
}

std::vector<std::string> unnamed_names(const std::vector<std::string>& lines) {
  std::vector<std::string> names;
  bool inside = false;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (lines[i] == "namespace {") {
      inside = true;
    } else if (lines[i] == "}  // namespace") {
      inside = false;
    } else if (inside) {
      for (const std::string& name : names_of(lines, i)) names.push_back(name);
    }
  }
  return names;
}

// Sources of a room are compiled many at a time (cmake/LucernaQuickBuild.cmake): what each hides from the
// others by an unnamed namespace shares one with them then.
TEST(Tree, UnnamedNamespacesOfARoomShareNoName) {
  std::map<std::string, fs::path> owner;
  for (const fs::path& file : source_files()) {
    if (file.extension() != ".cpp") continue;
    const std::string room = place_of(file).begin()->string() + (is_test(file) ? " tests: " : ": ");
    for (const std::string& name : unnamed_names(lines_of(file))) {
      const auto [at, first] = owner.emplace(room + name, file);
      if (!first && at->second != file) ADD_FAILURE() << at->first << " is in " << at->second << ", " << file;
    }
  }
  EXPECT_GT(owner.size(), 500u);
}

TEST(Tree, CheckSeesUnnamedNames) {
  const std::vector<std::string> lines{"int f(int a) {",
                                       "}",
                                       "namespace {",
                                       "struct A {",
                                       "  int kInner = 1;",
                                       "constexpr int kOne = 1, kTwo = 2;  // not kThree = 3",
                                       "const B& g(const C& c, int n = 3,",
                                       "           std::map<D, E> m) {",
                                       "int g(int other) { return h(other); }",
                                       "}  // namespace",
                                       "int k(int a) {"};
  EXPECT_EQ(unnamed_names(lines),
            (std::vector<std::string>{"A", "kOne", "kTwo", "g(constC&,int,std::map<D,E>,", "g(int,"}));
}

/// Lines of the longest function, after the one that opens its body to the one that closes it. Goes by the
/// form that clang-format gives: a line that ends with the list of parameters and a brace, and the first
/// brace as far left as the function, two left of its body. clang-tidy counts more exactly (`make check
/// STAGES=tidy`), but takes minutes.
std::size_t longest_function(const std::vector<std::string>& lines) {
  const auto indent = [](const std::string& line) { return line.find_first_not_of(' '); };
  std::size_t longest = 0;
  for (std::size_t i = 0; i + 1 < lines.size(); ++i) {
    const std::string& line = lines[i];
    const bool opens = line.ends_with(") {") || line.ends_with(") const {") ||
                       line.ends_with(") override {") || line.ends_with(") const override {") ||
                       line.ends_with(") noexcept {");
    const std::size_t body = indent(lines[i + 1]);
    if (!opens || body == std::string::npos || body < 2 || body > 6) continue;
    const std::string start = line.substr(indent(line), 5);
    const auto begins = [&](const char* word) { return start.starts_with(word); };
    if (begins("if ") || begins("for ") || begins("while") || begins("switc") || begins("}")) continue;
    for (std::size_t end = i + 1; end < lines.size(); ++end) {
      if (indent(lines[end]) == body - 2 && lines[end][body - 2] == '}') {
        longest = std::max(longest, end - i);
        break;
      }
    }
  }
  return longest;
}

TEST(Tree, FunctionsAreShort) {
  for (const fs::path& file : source_files()) {
    EXPECT_LE(longest_function(lines_of(file)), 60u) << file;
  }
}

TEST(Tree, CheckSeesALongFunction) {
  std::vector<std::string> lines{"int f(int a,", "      int b) {"};
  lines.insert(lines.end(), 70, "  ++a;");
  lines.insert(lines.end(), {"}", "int g() {", "  return 1;", "}"});
  EXPECT_EQ(longest_function(lines), 71u);
}

/// "Suite.Name" of every test in the sources.
std::set<std::string> names_of_tests() {
  std::vector<fs::path> files = source_files();
  for (const auto& entry : fs::directory_iterator(source_dir() / "tests")) files.push_back(entry.path());
  std::set<std::string> names;
  for (const fs::path& file : files) {
    if (!file.string().ends_with("_test.cpp")) continue;
    for (const std::string& line : lines_of(file)) {
      const std::size_t open = line.find('('), comma = line.find(", ");
      if (!line.starts_with("TEST") || comma == std::string::npos) continue;
      names.insert(line.substr(open + 1, comma - open - 1) + '.' +
                   line.substr(comma + 2, line.find(')') - comma - 2));
    }
  }
  return names;
}

// A test that was renamed would come back to the sanitizers, unseen.
TEST(Tree, LongTestsAreThere) {
  const std::set<std::string> names = names_of_tests();
  EXPECT_GT(names.size(), 1000u);
  std::size_t listed = 0;
  for (const std::string& line : lines_of(source_dir() / "tests" / "LongTests.cmake")) {
    if (!line.starts_with("  ")) continue;
    ++listed;
    EXPECT_TRUE(names.contains(line.substr(2, line.find(')') - 2))) << line;
  }
  EXPECT_GT(listed, 20u);
}

}  // namespace
}  // namespace lucerna::test
