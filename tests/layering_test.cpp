// SPDX-License-Identifier: Apache-2.0
// Includes point one way only: between rooms, between their sub-rooms, and to other libraries.
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
    {"distributed",
     {"core", "simd", "rayset", "photometry", "optics", "source", "trace", "project", "design", "results"}},
    {"cli",
     {"core", "simd", "rayset", "photometry", "optics", "source", "trace", "project", "design", "results",
      "report", "distributed"}},
    {"mpi",
     {"core", "simd", "rayset", "photometry", "optics", "source", "trace", "project", "design", "results",
      "report", "distributed", "cli"}},
};

/// The sub-rooms of each room, and which of the others each may include: rooms without one are not divided.
const std::map<std::string, Layers> kSubRooms{
    {"core",
     {
         {"cpu", {}},
         {"io", {}},
         {"image", {"io"}},
         {"math", {}},
         {"parallel", {"io"}},
         {"random", {"io"}},
     }},
    {"rayset",
     {
         {"comparison", {}},
         {"data", {}},
         {"formats/common", {}},
         {"formats/asap", {"formats/common"}},
         {"formats/lighttools", {"formats/common"}},
         {"formats/mcpl", {"data", "formats/common"}},
         {"formats/speos", {"data", "formats/common"}},
         {"formats/zemax", {"formats/common"}},
         {"formats/text", {"formats/common", "formats/lighttools", "formats/zemax"}},
         {"formats/tm25", {"formats/common"}},
         {"statistics", {"data"}},
         {"files",
          {"data", "formats/asap", "formats/lighttools", "formats/mcpl", "formats/speos", "formats/text",
           "formats/tm25", "formats/zemax", "statistics"}},
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
         {"materials", {}},
         {"mesh", {"shapes"}},
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
         {"adaptive/compression",
          {"adaptive/mixture", "adaptive/sampling", "adaptive/search", "adaptive/tree", "file"}},
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
         {"result", {"detectors", "tally"}},
         {"metrics", {"backward", "result", "tally"}},
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
         {"constraints", {"evaluation", "problem", "solver"}},
         {"fit", {"constraints", "evaluation", "problem", "shape", "solver"}},
         {"initial", {"constraints", "evaluation", "fit", "shape"}},
         {"optimizers", {}},
         {"search", {"constraints", "evaluation", "fit", "initial", "optimizers", "shape"}},
         {"validation", {"evaluation", "problem", "shape", "solver"}},
         {"lens", {"constraints", "evaluation", "fit", "problem", "search", "shape", "solver", "validation"}},
         {"run", {"constraints", "evaluation", "fit", "lens", "problem", "search", "solver", "validation"}},
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
    {"held_out.h", "source"},
    {"source.h", "source"},
    {"source_model.h", "source"},
    {"build_info.h", "trace"},
    {"bsdf.h", "optics"},
    {"cad.h", "optics"},
    {"diagram.h", "results"},
    {"objective.h", "design"},
    {"trace_file.h", "results"},
    {"glass_catalogue.h", "optics"},
    {"material.h", "optics"},
    {"mesh.h", "optics"},
    {"reflector.h", "optics"},
    {"detectors.h", "trace"},
    {"project.h", "project"},
    {"scatter.h", "trace"},
    {"scene.h", "trace"},
    {"trace.h", "trace"},
    {"trace_metrics.h", "trace"},
    {"design.h", "design"},
    {"comparison.h", "results"},
    {"report.h", "report"},
    {"lucerna.h", "cli"},  // all of them
};

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

/// What a line includes: `lucerna/core/math/vec.h`, `vector`; empty for any other line. `open`: the quote
/// before.
std::string included(const std::string& line, char open) {
  const std::size_t word = line.find_first_not_of(" \t");
  if (word == std::string::npos || line[word] != '#') return "";
  const char* close = open == '<' ? ">" : "\"";
  const auto found = between(line, std::string("include ") + open, close);
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
  for (const std::string& line : lines_of(source_dir() / "include/lucerna/lucerna.h")) {
    if (const std::string path = included(line, '"'); !path.empty()) listed.insert(path.substr(8));
  }
  for (const auto& [header, folder] : kPublicHeaders) EXPECT_TRUE(listed.contains(header)) << header;
}

/// Which rooms may include a header of another library: the library's own folder of headers, or the header.
/// What is not here is the standard library's, the system's or the tests'.
const Layers kThirdParty{
    {"CLI", {"cli", "mpi"}},
    {"Eigen", {"rayset", "photometry", "optics", "source", "design"}},
    {"cuda_runtime.h", {"trace", "design"}},
    {"embree3", {"trace", "design"}},
    {"fmt",
     {"core", "rayset", "photometry", "optics", "source", "trace", "project", "design", "results", "report",
      "distributed", "cli", "mpi"}},
    {"immintrin.h", {"simd"}},
    {"libqhull_r", {"source"}},
    {"mpi.h", {"mpi"}},
    {"nlohmann", {"results", "report", "cli", "mpi"}},
    {"oneapi", {"core"}},
    {"openssl", {"core", "source"}},
    {"pmmintrin.h", {"trace"}},
    {"toml++", {"project"}},
    {"xmmintrin.h", {"trace"}},
    {"zlib.h", {"core", "rayset"}},
    {"zstd.h", {"source", "results"}},
};
const std::set<std::string> kSystemHeaders{"gmock",    "gtest", "signal.h", "stddef.h",
                                           "stdint.h", "sys",   "time.h",   "unistd.h"};

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

}  // namespace
}  // namespace lucerna::test
