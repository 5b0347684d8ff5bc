// SPDX-License-Identifier: Apache-2.0
#include "lucerna/cli/parse/input_kind.h"

#include <fmt/format.h>

#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"
#include "lucerna/photometric_file.h"
#include "lucerna/ray_file.h"
#include "lucerna/source_model.h"

namespace lucerna::cli {

namespace {

/// Empty for what may be a ray file.
std::string other_kind(const std::filesystem::path& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) return "a folder; lucerna check takes folders of files";
  if (!std::filesystem::is_regular_file(path, ignored)) return "";
  if (is_source_model(path)) {
    return "a source model; lucerna sample draws rays from it, lucerna info, check, compare and projects "
           "take it as it is";
  }
  if (is_photometric_file(path))
    return "a light distribution (IES or EULUMDAT); lucerna info, check, convert and compare take it";
  if (is_project_file(path)) return "a project file; lucerna trace, design and check take it";
  return "";
}

/// Throws what is wrong with a file that is called light and has neither light nor rays in it.
void refuse_broken_light(const std::filesystem::path& path) {
  const std::string ending = lower_ending(path);
  std::error_code ignored;
  if ((ending != ".ies" && ending != ".ldt") || !std::filesystem::is_regular_file(path, ignored)) return;
  if (std::filesystem::file_size(path, ignored) == 0) {
    throw InputError(
        fmt::format("{}: empty, the IES or EULUMDAT file expected that its name says", path.string()),
        ErrorCause::damaged);
  }
  if (!detect_ray_format(path)) static_cast<void>(read_photometric_file(path));
}

}  // namespace

bool is_project_file(const std::filesystem::path& path) { return lower_ending(path) == ".toml"; }

void require_ray_file(const std::filesystem::path& path) {
  const std::string kind = other_kind(path);
  if (!kind.empty()) throw InputError(fmt::format("{}: rays expected, this is {}", path.string(), kind));
  refuse_broken_light(path);
}

}  // namespace lucerna::cli
