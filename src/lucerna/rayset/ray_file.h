// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "lucerna/core/progress.h"
#include "lucerna/rayset/ray_stream.h"

/// Ray files of every format: what the rest of the program calls. All functions are thread safe (on different
/// files).
namespace lucerna {

/// The names of all formats, as `--to` takes them.
std::span<const std::string_view> ray_formats();

/// The usual ending of a format's files, with its dot. UsageError if it is no format.
std::string_view ray_file_ending(std::string_view format);

/// The format that the file's content says, never its name; absent if it is no ray file. InputError if it
/// cannot be read, is empty, or its content fits several formats (the text names them and the option that
/// decides).
std::optional<std::string> detect_ray_format(const std::filesystem::path& path);

/// Opens a ray file for streaming. Throws InputError if it cannot be read, is no ray file, or its header does
/// not add up; UsageError if `options.format` is no format.
std::unique_ptr<RayReader> open_ray_file(const std::filesystem::path& path, const ReadOptions& options = {});

/// Starts a ray file. `ray_count` is what the caller means to write; the count in the file is what was
/// written. Throws UsageError if `format` is no format, InputError if the place cannot be written.
std::unique_ptr<RayWriter> create_ray_file(const std::filesystem::path& path, std::string_view format,
                                           const RaySetHeader& header, std::uint64_t ray_count,
                                           const WriteOptions& options = {});

/// The format to write `path` in: `to` if not empty, else what the ending says ("tm25ray", "sdf", "dis").
/// Throws UsageError if it is no format, or if the ending could mean several or none.
std::string ray_format_for(const std::filesystem::path& path, std::string_view to = {});

/// The whole file in memory. `warnings`, if given, gets the reader's.
RaySet read_ray_set(const std::filesystem::path& path, const ReadOptions& options = {},
                    Progress& progress = no_progress(), std::vector<std::string>* warnings = nullptr);

/// Writes all of `set`; returns the writer's warnings.
std::vector<std::string> write_ray_set(const std::filesystem::path& path, const RaySet& set,
                                       std::string_view format, const WriteOptions& options = {});

/// Calls `use(block)` for the rest of the rays, in blocks of kStreamBlock, with progress under `phase`.
template <class Use>
void for_each_block(RayReader& reader, Progress& progress, std::string_view phase, const Use& use) {
  RayBlock block;
  std::uint64_t done = 0;
  while (const std::size_t n = reader.read(block, kStreamBlock)) {
    use(static_cast<const RayBlock&>(block));
    progress.step(phase, done += n, reader.ray_count());
  }
}

/// The file's total flux in its unit; InputError that asks for --flux if the file does not state one.
double require_flux(const RaySetHeader& header, std::string_view name);

}  // namespace lucerna
