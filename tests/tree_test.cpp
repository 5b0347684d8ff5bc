// SPDX-License-Identifier: Apache-2.0
// Checks on the source tree: includes point one way only, files stay short, every file carries its licence,
// no two types of one namespace share a name; and on the docs: what they point to is there.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "tests/support/paths.h"
#include "tests/support/text_scan.h"

namespace fs = std::filesystem;

namespace {

using Layers = std::map<std::string, std::set<std::string>>;

/// Which room (the first folder below src/lucerna) may include which: the table of ARCHITECTURE.md. A room
/// may always include itself.
const Layers kMayInclude{
    {"core", {}},
    {"simd", {"core"}},
    {"rayset", {"core", "simd"}},
    {"photometry", {"core", "simd"}},
    {"optics", {"core", "simd"}},
    {"source", {"core", "simd", "rayset"}},
    {"trace", {"core", "simd", "rayset", "photometry", "optics", "source"}},
    {"project", {"core", "simd", "rayset", "photometry", "optics", "source", "trace"}},
    {"design", {"core", "simd", "rayset", "photometry", "optics", "source", "trace", "project"}},
    {"results", {"core", "simd", "rayset", "photometry", "optics", "source", "trace", "project", "design"}},
    {"report",
     {"core", "simd", "rayset", "photometry", "optics", "source", "trace", "project", "design", "results"}},
    {"cli",
     {"core", "simd", "rayset", "photometry", "optics", "source", "trace", "project", "design", "results",
      "report"}},
};

/// The sub-rooms of each room, and which of the others each may include: rooms without one are not divided.
const std::map<std::string, Layers> kSubRooms{
    {"core",
     {
         {"cpu", {}},
         {"io", {}},
         {"image", {"io"}},
         {"math", {}},
         {"parallel", {}},
         {"random", {"io"}},
     }},
    {"rayset",
     {
         {"comparison", {}},
         {"data", {}},
         {"formats/common", {}},
         {"formats/asap", {"formats/common"}},
         {"formats/lighttools", {"formats/common"}},
         {"formats/speos", {"formats/common"}},
         {"formats/zemax", {"formats/common"}},
         {"formats/text", {"formats/common", "formats/lighttools", "formats/zemax"}},
         {"formats/tm25", {"formats/common"}},
         {"statistics", {"data"}},
         {"files",
          {"data", "formats/asap", "formats/lighttools", "formats/speos", "formats/text", "formats/tm25",
           "formats/zemax", "statistics"}},
     }},
    {"photometry",
     {
         {"binning", {}},
         {"data", {}},
         {"comparison", {"binning", "data"}},
         {"formats", {"data"}},
         {"metrics", {"binning"}},
     }},
    {"optics",
     {
         {"shapes", {}},
         {"cad", {"shapes"}},
         {"height_field", {}},
         {"mesh", {}},
     }},
    {"source",
     {
         {"emitters", {}},
         {"adaptive/charts", {"emitters"}},
         {"adaptive/tree", {"adaptive/charts"}},
         {"adaptive/search", {"adaptive/charts", "adaptive/tree"}},
         {"adaptive/mixture", {"adaptive/search"}},
         {"file", {}},
         {"adaptive/sampling", {"adaptive/charts", "adaptive/mixture", "adaptive/tree", "emitters", "file"}},
         {"adaptive/codec", {"adaptive/sampling", "adaptive/tree", "file"}},
         {"adaptive/compression", {"adaptive/mixture", "adaptive/sampling", "adaptive/search", "file"}},
         {"clusters", {"file"}},
         {"model", {"adaptive/compression", "adaptive/sampling", "clusters", "emitters", "file"}},
     }},
    {"trace",
     {
         {"detectors", {}},
         {"tally", {}},
         {"kernels", {"detectors", "tally"}},
         {"engines", {"detectors", "kernels", "tally"}},
         {"backward", {"detectors", "engines", "kernels"}},
         {"benchmark", {"engines", "kernels"}},
         {"device", {"detectors", "engines", "kernels", "tally"}},
         {"result", {"detectors"}},
         {"metrics", {"backward", "result"}},
         {"run", {"detectors", "device", "engines", "result", "tally"}},
         {"scene", {"detectors"}},
     }},
    {"project",
     {
         {"schema", {}},
         {"sections", {"schema"}},
         {"template", {}},
     }},
    {"design",
     {
         {"shape", {}},
         {"evaluation", {"shape"}},
         {"problem", {"evaluation", "shape"}},
         {"solver", {"evaluation", "problem", "shape"}},
         {"constraints", {"problem", "solver"}},
         {"fit", {"constraints", "evaluation", "problem", "shape", "solver"}},
         {"initial", {"constraints", "evaluation", "fit", "shape"}},
         {"optimizers", {}},
         {"search", {"constraints", "fit", "initial", "optimizers", "shape"}},
         {"validation", {"evaluation", "problem", "shape", "solver"}},
         {"run", {"constraints", "evaluation", "fit", "problem", "search", "solver", "validation"}},
     }},
    {"results",
     {
         {"metrics", {}},
         {"svg", {}},
         {"json", {"metrics", "svg"}},
         {"folders", {"json", "svg"}},
         {"comparison", {"folders", "svg"}},
     }},
    {"report",
     {
         {"html", {}},
     }},
    {"cli",
     {
         {"parse", {}},
         {"output", {"parse"}},
         {"commands", {"output", "parse"}},
         {"manual", {"commands", "parse"}},
     }},
};

/// Files that lie directly in a room which has sub-rooms.
const std::set<std::string> kDirectly{"cli/main.cpp"};

/// The room of src/lucerna that each public header (include/lucerna) belongs to: what it defines is
/// implemented there, and it may be included where that room may.
const std::map<std::string, std::string> kPublicHeaders{
    {"diagnostic.h", "core"},
    {"error.h", "core"},
    {"error_parts.h", "core"},
    {"estimate.h", "core"},
    {"flux_unit.h", "core"},
    {"geometry.h", "core"},
    {"host_device.h", "core"},
    {"progress.h", "core"},
    {"random.h", "core"},
    {"version.h", "core"},
    {"ray_comparison.h", "rayset"},
    {"ray_file.h", "rayset"},
    {"ray_statistics.h", "rayset"},
    {"rays.h", "rayset"},
    {"intensity.h", "photometry"},
    {"intensity_comparison.h", "photometry"},
    {"far_field_metrics.h", "photometry"},
    {"photometric_metrics.h", "photometry"},
    {"photometric_file.h", "photometry"},
    {"bounding_surface.h", "rayset"},
    {"source.h", "source"},
    {"source_model.h", "source"},
    {"build_info.h", "trace"},
    {"cad.h", "optics"},
    {"diagram.h", "results"},
    {"objective.h", "design"},
    {"trace_file.h", "results"},
    {"mesh.h", "optics"},
    {"reflector.h", "optics"},
    {"detectors.h", "trace"},
    {"project.h", "project"},
    {"scene.h", "trace"},
    {"trace.h", "trace"},
    {"trace_metrics.h", "trace"},
    {"design.h", "design"},
    {"comparison.h", "results"},
    {"report.h", "report"},
    {"lucerna.h", "cli"},  // all of them
};

std::vector<fs::path> source_files() {
  std::vector<fs::path> files;
  for (const char* top : {"src/lucerna", "include/lucerna"}) {
    for (const auto& entry : fs::recursive_directory_iterator(lucerna::test::source_dir() / top)) {
      const std::string ending = entry.path().extension().string();
      if (ending == ".h" || ending == ".cpp" || ending == ".cu") files.push_back(entry.path());
    }
  }
  return files;
}

bool is_public(const fs::path& file) { return file.parent_path().parent_path().filename() == "include"; }

/// Where a file of ours is below its top folder: "trace/kernels/kernel.h".
fs::path place_of(const fs::path& file) {
  return file.lexically_relative(lucerna::test::source_dir() / "src/lucerna");
}

/// The room that a file belongs to; empty if it is in none that is known.
std::string room_of(const fs::path& file) {
  if (!is_public(file)) return place_of(file).begin()->string();
  const auto found = kPublicHeaders.find(file.filename());
  return found == kPublicHeaders.end() ? "" : found->second;
}

/// The folders between room and file: "" for "cli/main.cpp", "formats/tm25" for "rayset/formats/tm25/tm25.h".
std::string sub_room_of(const fs::path& place) {
  const std::string folders = place.parent_path().generic_string();
  const std::size_t slash = folders.find('/');
  return slash == std::string::npos ? "" : folders.substr(slash + 1);
}

bool is_test(const fs::path& file) { return file.stem().string().ends_with("_test"); }

std::vector<std::string> lines_of(const fs::path& file) {
  std::ifstream in(file);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

/// What a line includes: `lucerna/core/math/vec.h`, `vector`; empty for any other line. `open`: the quote
/// before.
std::string included(const std::string& line, char open) {
  const std::size_t word = line.find_first_not_of(" \t");
  if (word == std::string::npos || line[word] != '#') return "";
  const char* close = open == '<' ? ">" : "\"";
  const auto found = lucerna::test::between(line, std::string("include ") + open, close);
  return found.empty() ? "" : found.front();
}

/// The room of an include of ours; empty for any other line.
std::string included_room(const std::string& line) {
  const std::string path = included(line, '"');
  if (!path.starts_with("lucerna/")) return "";
  const std::string rest = path.substr(8);
  const auto header = kPublicHeaders.find(rest);
  return header == kPublicHeaders.end() ? rest.substr(0, rest.find('/')) : header->second;
}

/// What a public header may not include: anything but public headers and the standard library.
std::vector<std::string> not_public(const std::vector<std::string>& lines) {
  std::vector<std::string> bad;
  for (const std::string& line : lines) {
    const std::string ours = included(line, '"'), other = included(line, '<');
    if (!ours.empty() && (!ours.starts_with("lucerna/") || !kPublicHeaders.contains(ours.substr(8))))
      bad.push_back(ours);
    if (other.find_first_of("./") != std::string::npos) bad.push_back(other);
  }
  return bad;
}

/// The lines whose includes `room` may not have.
std::vector<std::string> forbidden_includes(const std::string& room, const std::vector<std::string>& lines) {
  std::vector<std::string> bad;
  for (const std::string& line : lines) {
    const std::string to = included_room(line);
    if (!to.empty() && to != room && !kMayInclude.at(room).contains(to)) bad.push_back(line);
  }
  return bad;
}

TEST(Layering, IncludesPointLeft) {
  const auto files = source_files();
  ASSERT_GT(files.size(), 10u);
  for (const fs::path& file : files) {
    const std::string room = room_of(file);
    ASSERT_TRUE(kMayInclude.contains(room)) << file << " is in no known room";
    for (const auto& line : forbidden_includes(room, lines_of(file))) ADD_FAILURE() << file << ": " << line;
  }
}

/// What is wrong with a file's sub-room and with what it includes of its own room. `place` as place_of has
/// it. Tests may include all of their room.
std::vector<std::string> faults_within_room(const fs::path& place, const std::vector<std::string>& lines) {
  const std::string room = place.begin()->string(), sub = sub_room_of(place);
  const auto known = kSubRooms.find(room);
  if (known == kSubRooms.end()) return {};
  if (sub.empty() && !kDirectly.contains(place.generic_string())) return {"lies directly in its room"};
  if (!sub.empty() && !known->second.contains(sub)) return {sub + " is no sub-room of " + room};
  std::vector<std::string> bad;
  for (const std::string& line : lines) {
    const std::string path = included(line, '"');
    if (is_test(place) || sub.empty() || !path.starts_with("lucerna/" + room + "/")) continue;
    const std::string to = sub_room_of(path.substr(8));
    if (to != sub && !known->second.at(sub).contains(to)) bad.push_back(line);
  }
  return bad;
}

/// True if one can go from a sub-room to itself along what the table allows.
bool has_cycle(const Layers& table) {
  std::set<std::string> done;  // those from which no way leads on but to others of these
  for (bool changed = true; changed;) {
    changed = false;
    for (const auto& [from, to] : table) {
      const auto is_done = [&](const std::string& s) { return done.contains(s); };
      if (!done.contains(from) && std::all_of(to.begin(), to.end(), is_done))
        changed = done.insert(from).second;
    }
  }
  return done.size() < table.size();
}

TEST(Layering, SubRoomsIncludeDownward) {
  std::set<std::string> seen;
  for (const fs::path& file : source_files()) {
    if (is_public(file)) continue;
    const fs::path place = place_of(file);
    seen.insert(place.parent_path().generic_string());
    for (const auto& fault : faults_within_room(place, lines_of(file)))
      ADD_FAILURE() << place << ": " << fault;
  }
  for (const auto& [room, table] : kSubRooms) {
    EXPECT_FALSE(has_cycle(table)) << room;
    for (const auto& [sub, may_include] : table)
      EXPECT_TRUE(seen.contains(room + "/" + sub)) << room << " " << sub;
  }
}

TEST(Layering, CheckSeesSubRooms) {
  const std::vector<std::string> up{"#include \"lucerna/trace/run/x.h\""};
  EXPECT_EQ(faults_within_room("trace/kernels/a.h", up).size(), 1u);
  EXPECT_TRUE(faults_within_room("trace/kernels/a_test.cpp", up).empty());
  EXPECT_TRUE(faults_within_room("trace/run/a.h", up).empty());
  EXPECT_TRUE(faults_within_room("trace/run/a.h", {"#include \"lucerna/trace/engines/x.h\""}).empty());
  EXPECT_EQ(faults_within_room("rayset/formats/common/a.h", {"#include \"lucerna/rayset/formats/tm25/x.h\""})
                .size(),
            1u);
  EXPECT_EQ(faults_within_room("trace/a.h", {}).size(), 1u);
  EXPECT_EQ(faults_within_room("trace/other/a.h", {}).size(), 1u);
  EXPECT_TRUE(faults_within_room("cli/main.cpp", {}).empty());
  EXPECT_TRUE(has_cycle({{"a", {"b"}}, {"b", {"c"}}, {"c", {"a"}}, {"d", {}}}));
  EXPECT_FALSE(has_cycle({{"a", {"b", "c"}}, {"b", {"c"}}, {"c", {}}}));
}

TEST(Layering, CheckSeesABackwardInclude) {
  EXPECT_EQ(forbidden_includes("core", {"#include \"lucerna/trace/run/trace.h\""}).size(), 1u);
  EXPECT_EQ(forbidden_includes("photometry", {"#include \"lucerna/rays.h\""}).size(), 1u);
  EXPECT_TRUE(forbidden_includes("photometry", {"#include \"lucerna/geometry.h\""}).empty());
  EXPECT_TRUE(forbidden_includes("trace", {"#include \"lucerna/core/math/vec.h\""}).empty());
}

// No type or macro of another library reaches who includes ours; private headers are not installed.
TEST(Layering, PublicHeadersIncludePublicHeadersAndTheStandardLibrary) {
  std::size_t seen = 0;
  for (const fs::path& file : source_files()) {
    if (!is_public(file)) continue;
    ++seen;
    for (const std::string& bad : not_public(lines_of(file))) ADD_FAILURE() << file << " includes " << bad;
  }
  EXPECT_EQ(seen, kPublicHeaders.size());
}

TEST(Layering, CheckSeesWhatIsNotPublic) {
  EXPECT_EQ(not_public({"#include <vector>", "#include <Eigen/Core>", "#include <zstd.h>",
                        "#include \"lucerna/rays.h\"", "#include \"lucerna/core/io/file.h\""}),
            (std::vector<std::string>{"Eigen/Core", "zstd.h", "lucerna/core/io/file.h"}));
}

/// True if all that a header declares stays visible where names are hidden by default: its namespace is
/// within
/// `#pragma GCC visibility push(default)` and `pop`.
bool shows_its_names(const std::vector<std::string>& lines) {
  const auto opens = std::find(lines.begin(), lines.end(), "namespace lucerna {");
  if (opens == lines.end()) return true;
  return opens != lines.begin() && *(opens - 1) == "#pragma GCC visibility push(default)" &&
         lines.back() == "#pragma GCC visibility pop";
}

// The library is compiled with -fvisibility=hidden: what a public header forgets to show cannot be linked.
TEST(Layering, PublicHeadersShowTheirNames) {
  for (const fs::path& file : source_files()) {
    if (!is_public(file)) continue;
    EXPECT_TRUE(shows_its_names(lines_of(file))) << file;
  }
}

TEST(Layering, CheckSeesHiddenNames) {
  EXPECT_TRUE(shows_its_names(
      {"#pragma GCC visibility push(default)", "namespace lucerna {", "}", "#pragma GCC visibility pop"}));
  EXPECT_FALSE(shows_its_names({"#pragma once", "namespace lucerna {", "}", "#pragma GCC visibility pop"}));
  EXPECT_FALSE(shows_its_names({"#pragma GCC visibility push(default)", "namespace lucerna {", "}"}));
}

TEST(Layering, TheUmbrellaHasEveryPublicHeader) {
  std::set<std::string> listed{"lucerna.h", "host_device.h"};  // the second holds macros for the others
  for (const std::string& line : lines_of(lucerna::test::source_dir() / "include/lucerna/lucerna.h")) {
    if (const std::string path = included(line, '"'); !path.empty()) listed.insert(path.substr(8));
  }
  for (const auto& [header, folder] : kPublicHeaders) EXPECT_TRUE(listed.contains(header)) << header;
}

/// Which rooms may include a header of another library: the library's own folder of headers, or the header.
/// What is not here is the standard library's, the system's or the tests'.
const Layers kThirdParty{
    {"CLI", {"cli"}},
    {"Eigen", {"rayset", "photometry", "optics", "source", "design"}},
    {"cuda_runtime.h", {"trace", "design"}},
    {"embree3", {"trace", "design"}},
    {"fmt",
     {"core", "rayset", "photometry", "optics", "source", "trace", "project", "design", "results", "report",
      "cli"}},
    {"immintrin.h", {"simd"}},
    {"libqhull_r", {"source"}},
    {"nlohmann", {"results", "report", "cli"}},
    {"oneapi", {"core"}},
    {"openssl", {"core", "source"}},
    {"pmmintrin.h", {"trace"}},
    {"toml++", {"project"}},
    {"xmmintrin.h", {"trace"}},
    {"zlib.h", {"core"}},
    {"zstd.h", {"source", "results"}},
};
const std::set<std::string> kSystemHeaders{"gmock", "gtest",  "stddef.h", "stdint.h",
                                           "sys",   "time.h", "unistd.h"};

/// The headers of other libraries that `lines` include and `room` may not.
std::vector<std::string> forbidden_libraries(const std::string& room, const std::vector<std::string>& lines) {
  std::vector<std::string> bad;
  for (const std::string& line : lines) {
    const std::string header = included(line, '<');
    const std::string name = header.substr(0, header.find('/'));
    if (name == header && !header.ends_with(".h")) continue;
    const auto known = kThirdParty.find(name);
    const bool allowed =
        known == kThirdParty.end() ? kSystemHeaders.contains(name) : known->second.contains(room);
    if (!allowed) bad.push_back(header);
  }
  return bad;
}

TEST(Layering, OtherLibrariesStayInTheirFolders) {
  for (const fs::path& file : source_files()) {
    if (is_public(file)) continue;
    for (const std::string& header : forbidden_libraries(room_of(file), lines_of(file)))
      ADD_FAILURE() << file << " includes <" << header << ">";
  }
}

TEST(Layering, CheckSeesOtherLibraries) {
  const std::vector<std::string> lines{"#include <vector>", "#include <fmt/format.h>",
                                       "#include <toml++/toml.h>", "#include <boost/any.hpp>",
                                       "#include <unistd.h>"};
  EXPECT_EQ(forbidden_libraries("report", lines),
            (std::vector<std::string>{"toml++/toml.h", "boost/any.hpp"}));
  EXPECT_EQ(forbidden_libraries("project", lines), (std::vector<std::string>{"boost/any.hpp"}));
}

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
    for (const std::string& rest : lucerna::test::between(line.substr(0, line.find("//")), " k", " =")) {
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
    const std::string room = room_of(file) + (is_test(file) ? " tests: " : ": ");
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

/// What a page of ours links to, as written: [text](target), not addresses of the web, nor places within the
/// page.
std::vector<std::string> links_of(const std::string& page) {
  std::vector<std::string> links;
  for (const std::string& target : lucerna::test::between(page, "](", ")")) {
    if (target.find("://") == std::string::npos && !target.starts_with('#'))
      links.push_back(target.substr(0, target.find('#')));
  }
  return links;
}

/// The files of ours that a page names in backquotes: those that begin with a folder of the tree and have an
/// ending.
std::vector<std::string> paths_of(const std::string& page) {
  std::vector<std::string> paths;
  for (const char* folder :
       {"src/", "include/", "tests/", "docs/", "scripts/", "cmake/", "fuzz/corpus", "bench/"}) {
    for (const std::string& rest : lucerna::test::between(page, std::string("`") + folder, "`")) {
      const bool plain =
          rest.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./") ==
          std::string::npos;
      const std::size_t dot = rest.rfind('.');
      if (plain && dot != std::string::npos && dot + 1 < rest.size()) paths.push_back(folder + rest);
    }
  }
  return paths;
}

/// The private sources that a page names in backquotes by their place below src/lucerna:
/// `trace/run/trace.cpp`.
std::vector<std::string> places_of(const std::string& page) {
  std::vector<std::string> places;
  for (const auto& [room, may_include] : kMayInclude) {
    for (const std::string& rest : lucerna::test::between(page, "`" + room + "/", "`")) {
      const std::string ending = fs::path(rest).extension().string();
      const bool any = rest.find_first_of("ABCDEFGHIJKLMNOPQRSTUVWXYZ") != std::string::npos;  // COMMAND.cpp
      if (!any && (ending == ".h" || ending == ".cpp" || ending == ".cu"))
        places.push_back(room + "/" + rest);
    }
  }
  return places;
}

std::string text_of(const fs::path& file) {
  std::string text;
  for (const std::string& line : lines_of(file)) text += line + "\n";
  return text;
}

std::vector<fs::path> pages() {
  const fs::path root = lucerna::test::source_dir();
  std::vector<fs::path> pages;
  for (const auto& entry : fs::directory_iterator(root)) pages.push_back(entry.path());
  for (const auto& entry : fs::recursive_directory_iterator(root / "docs")) pages.push_back(entry.path());
  std::erase_if(pages, [](const fs::path& p) { return p.extension() != ".md"; });
  return pages;
}

TEST(Docs, LinksAndPathsLeadSomewhere) {
  std::size_t seen = 0;
  for (const fs::path& page : pages()) {
    const std::string text = text_of(page);
    for (const std::string& link : links_of(text)) {
      ++seen;
      EXPECT_TRUE(fs::exists(page.parent_path() / link)) << page << " links to " << link;
    }
    for (const std::string& path : paths_of(text)) {
      ++seen;
      EXPECT_TRUE(fs::exists(lucerna::test::source_dir() / path)) << page << " names " << path;
    }
    for (const std::string& place : places_of(text)) {
      ++seen;
      EXPECT_TRUE(fs::exists(lucerna::test::source_dir() / "src/lucerna" / place))
          << page << " names " << place;
    }
  }
  EXPECT_GT(seen, 20u);
}

TEST(Docs, CheckSeesLinksAndPaths) {
  const std::string page =
      "[a](docs/a.md#part) [b](https://example.org) [c](#here) `tests/x_test.cpp` `src/lucerna` "
      "`scripts/y.sh Z`";
  EXPECT_EQ(links_of(page), (std::vector<std::string>{"docs/a.md"}));
  EXPECT_EQ(paths_of(page), (std::vector<std::string>{"tests/x_test.cpp"}));
  EXPECT_EQ(
      places_of(
          "`trace/run/x.cpp` `cli/commands/COMMAND.cpp` `trace/result.json` `core/io/y.h: f` `core/io/z.h`"),
      (std::vector<std::string>{"core/io/z.h", "trace/run/x.cpp"}));
}

}  // namespace
