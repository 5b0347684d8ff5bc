// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <utility>

#include "lucerna/core/io/error.h"
#include "lucerna/results/folders/trace_file.h"

namespace lucerna {

namespace {

namespace fs = std::filesystem;

/// One folder's range of rays.
struct Part {
  fs::path folder;
  std::uint64_t first = 0, last = 0;
};

StoredTrace read_part(const fs::path& folder) {
  const fs::path file = folder / kTraceFileName;
  std::error_code none;
  if (!fs::exists(file, none)) {
    throw_input_error(folder.string(), "", "holds no {}; expected a folder with a trace", kTraceFileName);
  }
  return read_trace_file(file);
}

void check_same_scene(const StoredTrace& a, const fs::path& folder_a, const StoredTrace& b,
                      const fs::path& folder_b) {
  if (a.origin.program_version != b.origin.program_version) {
    throw InputError(
        fmt::format("{} was traced by lucerna {}, {} by lucerna {}: they cannot be added", folder_a.string(),
                    a.origin.program_version, folder_b.string(), b.origin.program_version),
        ErrorCause::mismatch);
  }
  if (a.origin.scene_id != b.origin.scene_id) {
    throw InputError(fmt::format("{} and {} are traces of different projects, or of different input files",
                                 folder_a.string(), folder_b.string()),
                     ErrorCause::mismatch);
  }
}

/// Says every gap and every overlap in one line.
void check_ranges(const std::vector<Part>& parts) {
  std::string faults;
  const auto add = [&](std::uint64_t from, std::uint64_t to, const char* what, const Part& a, const Part& b) {
    faults += fmt::format("{}rays {}:{} are {} {} and {}", faults.empty() ? "" : "; ", from, to, what,
                          a.folder.string(), b.folder.string());
  };
  for (std::size_t i = 1; i < parts.size(); ++i) {
    const Part &a = parts[i - 1], &b = parts[i];
    if (a.last < b.first) add(a.last, b.first, "missing between", a, b);
    if (a.last > b.first) add(b.first, std::min(a.last, b.last), "in both", a, b);
  }
  if (!faults.empty()) throw InputError("the traces cannot be added: " + faults, ErrorCause::mismatch);
}

}  // namespace

StoredTrace merge_trace_folders(const std::vector<fs::path>& folders, Progress& progress) {
  if (folders.empty()) throw InputError("no folder to merge");
  std::vector<Part> parts;
  StoredTrace first;
  for (const fs::path& folder : folders) {
    StoredTrace part = read_part(folder);
    parts.push_back({folder, part.result.first_ray, part.result.last_ray});
    progress.step("check", parts.size(), folders.size());
    if (parts.size() == 1) {
      first = std::move(part);
      continue;
    }
    check_same_scene(first, folders.front(), part, folder);
    if (first.result.isa != part.result.isa) {
      throw InputError(
          fmt::format("{} was traced with {}, {} with {}: they cannot be added to the bit",
                      folders.front().string(), first.result.isa, folder.string(), part.result.isa),
          ErrorCause::mismatch);
    }
  }
  std::stable_sort(parts.begin(), parts.end(), [](const Part& a, const Part& b) {
    return std::pair(a.first, a.last) < std::pair(b.first, b.last);
  });
  check_ranges(parts);
  // Neighbours of equal weight are added first, so that kept rays are copied log(parts) times, not parts
  // times.
  std::vector<std::pair<TraceResult, int>> sums;
  const auto add_last_two = [&] {
    TraceResult sum = merge(sums[sums.size() - 2].first, sums.back().first);
    const int weight = sums.back().second + 1;
    sums.resize(sums.size() - 2);
    sums.emplace_back(std::move(sum), weight);
  };
  for (std::size_t i = 0; i < parts.size(); ++i) {
    sums.emplace_back(read_part(parts[i].folder).result, 0);
    while (sums.size() > 1 && sums[sums.size() - 2].second == sums.back().second) add_last_two();
    progress.step("merge", i + 1, parts.size());
  }
  while (sums.size() > 1) add_last_two();
  return {std::move(sums.front().first), std::move(first.origin)};
}

}  // namespace lucerna
