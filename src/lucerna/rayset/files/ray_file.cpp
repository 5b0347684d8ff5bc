// SPDX-License-Identifier: Apache-2.0
#include "lucerna/ray_file.h"

#include <algorithm>
#include <array>

#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"
#include "lucerna/rayset/formats/asap/asap.h"
#include "lucerna/rayset/formats/lighttools/lighttools_ascii.h"
#include "lucerna/rayset/formats/lighttools/lighttools_binary.h"
#include "lucerna/rayset/formats/mcpl/mcpl.h"
#include "lucerna/rayset/formats/speos/speos.h"
#include "lucerna/rayset/formats/text/text_rays.h"
#include "lucerna/rayset/formats/tm25/tm25.h"
#include "lucerna/rayset/formats/zemax/zemax_binary.h"
#include "lucerna/rayset/formats/zemax/zemax_text.h"

namespace lucerna {

namespace {

/// One line per format: "to add a format, add a line here". Binary ones first: text is what is left.
struct Format {
  std::string_view name;
  bool (*looks_like)(const InputFile&);
  std::unique_ptr<RayReader> (*open)(InputFile, const ReadOptions&);
  std::unique_ptr<RayWriter> (*create)(const std::filesystem::path&, const RaySetHeader&,
                                       const WriteOptions&);
  std::string_view ending;
};

constexpr std::array kFormats{
    Format{"tm25", looks_like_tm25, open_tm25, create_tm25, ".tm25ray"},
    Format{"zemax-binary", looks_like_zemax_binary, open_zemax_binary, create_zemax_binary, ".sdf"},
    Format{"lighttools-binary", looks_like_lighttools_binary, open_lighttools_binary,
           create_lighttools_binary, ".ray"},
    Format{"speos", looks_like_speos, open_speos, create_speos, ".ray"},
    Format{"mcpl", looks_like_mcpl, open_mcpl, create_mcpl, ".mcpl"},
    Format{"asap", looks_like_asap, open_asap, create_asap, ".dis"},
    Format{"lighttools-ascii", looks_like_lighttools_ascii, open_lighttools_ascii, create_lighttools_ascii,
           ".ray"},
    Format{"zemax-text", looks_like_zemax_text, open_zemax_text, create_zemax_text, ".dat"},
    Format{"text", looks_like_text_rays, open_text_rays, create_text_rays, ".txt"}};

constexpr auto kNames = [] {
  std::array<std::string_view, kFormats.size()> names;
  for (std::size_t i = 0; i < names.size(); ++i) names[i] = kFormats[i].name;
  return names;
}();

const Format& format_named(std::string_view name) {
  const auto found = std::ranges::find(kFormats, name, &Format::name);
  if (found == kFormats.end()) {
    throw UsageError(fmt::format("unknown ray format '{}': {} expected", name, fmt::join(kNames, ", ")));
  }
  return *found;
}

std::optional<std::string> detect(const InputFile& file) {
  if (file.size() == 0)
    throw InputError(fmt::format("{}: empty file, rays expected", file.name()), ErrorCause::damaged);
  std::vector<std::string> candidates;
  for (const Format& format : kFormats) {
    if (format.looks_like(file)) candidates.emplace_back(format.name);
  }
  if (candidates.size() > 1) {
    throw InputError(
        fmt::format("{}: could be {}: the format must be given", file.name(), fmt::join(candidates, " or ")),
        ErrorCause::missing, "format");
  }
  if (candidates.empty()) return std::nullopt;
  return candidates.front();
}

}  // namespace

std::span<const std::string_view> ray_formats() { return kNames; }

std::string_view ray_file_ending(std::string_view format) { return format_named(format).ending; }

std::optional<std::string> detect_ray_format(const std::filesystem::path& path) {
  return detect(InputFile(path));
}

std::unique_ptr<RayReader> open_ray_file(const std::filesystem::path& path, const ReadOptions& options) {
  InputFile file(path);
  const std::optional<std::string> name = options.format.empty() ? detect(file) : options.format;
  if (!name) {
    std::array<unsigned char, 4> head{};
    file.read_at(0, std::as_writable_bytes(std::span(head)).first(std::min<std::uint64_t>(4, file.size())));
    throw_input_error(file.name(), "byte 0",
                      "no ray file of a known format: begins with {:02x}, expected one of {}",
                      fmt::join(head, " "), fmt::join(kNames, ", "));
  }
  return format_named(*name).open(std::move(file), options);
}

std::unique_ptr<RayWriter> create_ray_file(const std::filesystem::path& path, std::string_view format,
                                           const RaySetHeader& header, std::uint64_t /*ray_count*/,
                                           const WriteOptions& options) {
  return format_named(format).create(path, header, options);
}

std::string ray_format_for(const std::filesystem::path& path, std::string_view to) {
  if (!to.empty()) return std::string(format_named(to).name);
  const std::string ending = lower_ending(path);
  if (ending == ".tm25ray" || ending == ".tm25") return "tm25";
  if (ending == ".sdf") return "zemax-binary";
  if (ending == ".dis") return "asap";
  if (ending == ".mcpl") return "mcpl";
  throw UsageError(fmt::format("{}: the ending '{}' does not say the format: expected one of {}",
                               path.string(), ending, fmt::join(kNames, ", ")),
                   "format");
}

RaySet read_ray_set(const std::filesystem::path& path, const ReadOptions& options, Progress& progress,
                    std::vector<std::string>* warnings) {
  const auto reader = open_ray_file(path, options);
  RaySet set;
  set.rays.resize(0, reader->header().columns.size());
  set.rays.reserve(reader->ray_count());
  for_each_block(*reader, progress, "read", [&](const RayBlock& block) { set.rays.append(block); });
  set.header = reader->header();
  if (warnings != nullptr) *warnings = reader->warnings();
  return set;
}

void RayReader::skip(std::uint64_t rays) {
  RayBlock passed;
  while (rays > 0) {
    const auto some = static_cast<std::size_t>(std::min<std::uint64_t>(rays, kStreamBlock));
    const std::size_t n = read(passed, some);
    if (n == 0) return;
    rays -= n;
  }
}

std::vector<std::string> write_ray_set(const std::filesystem::path& path, const RaySet& set,
                                       std::string_view format, const WriteOptions& options) {
  const auto writer = create_ray_file(path, format, set.header, set.rays.size(), options);
  writer->write(set.rays);
  writer->finish();
  return writer->warnings();
}

double require_flux(const RaySetHeader& header, std::string_view name) {
  if (const auto flux = header.flux()) return *flux;
  throw InputError(
      fmt::format("{}: states no total flux in {}: it has to be given", name, symbol(header.flux_unit)),
      ErrorCause::missing, "flux");
}

}  // namespace lucerna
