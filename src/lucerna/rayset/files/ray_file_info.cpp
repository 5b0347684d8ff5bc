// SPDX-License-Identifier: Apache-2.0
#include "lucerna/rayset/files/ray_file_info.h"

#include <fmt/format.h>

#include <algorithm>

#include "lucerna/ray_file.h"

namespace lucerna {

namespace {

constexpr std::uint64_t kMaxRetained = 1 << 20;

/// Wavelengths of the rays seen so far.
struct Range {
  float low = 0.0F, high = 0.0F;
  bool any = false;
  void add(const std::vector<float>& values) {
    if (values.empty()) return;
    const auto [a, b] = std::ranges::minmax(values);
    low = any ? std::min(low, a) : a;
    high = any ? std::max(high, b) : b;
    any = true;
  }
};

std::string describe_spectrum(const RaySetHeader& header, const Range& wavelengths) {
  if (wavelengths.any) return fmt::format("{:g} to {:g} nm, one per ray", wavelengths.low, wavelengths.high);
  if (header.wavelength_nm) return fmt::format("{:g} nm for all rays", *header.wavelength_nm);
  if (header.spectra.empty()) return "none";
  if (header.spectra.size() > 1) return fmt::format("{} tables, one per ray", header.spectra.size());
  const SpectralTable& table = header.spectra.front();
  if (table.wavelength_nm.empty()) return "an empty table";
  return fmt::format("{:g} to {:g} nm, table of {} points", table.wavelength_nm.front(),
                     table.wavelength_nm.back(), table.wavelength_nm.size());
}

}  // namespace

RayFileInfo describe_ray_file(const std::filesystem::path& path, const ReadOptions& options,
                              Progress& progress) {
  const auto reader = open_ray_file(path, options);
  const auto wavelength = find_column(reader->header().columns, ColumnKind::wavelength_nm);
  const std::uint64_t step =
      std::max<std::uint64_t>(1, (reader->ray_count() + kMaxRetained - 1) / kMaxRetained);
  RayStatistics statistics;
  Range range;
  RayBlock retained;
  std::uint64_t first = 0;
  for_each_block(*reader, progress, "info", [&](const RayBlock& block) {
    statistics.add(block);
    if (wavelength) range.add(block.extra[*wavelength]);
    for (std::uint64_t i = (step - first % step) % step; i < block.size(); i += step) {
      retained.resize(retained.size() + 1, 0);
      retained.set(retained.size() - 1, block.ray(i));
      retained.weight.back() = block.weight[i];
    }
    first += block.size();
  });
  RayFileInfo info;
  info.format = reader->format();
  info.length_unit = reader->length_unit();
  info.header = reader->header();
  info.summary = statistics.result();
  if (const auto flux = info.header.flux()) info.flux_ratio = info.summary.weight_sum / *flux;
  info.surface = guess_surface(retained);
  info.spectrum = describe_spectrum(info.header, range);
  info.warnings = reader->warnings();
  info.some_rays = std::move(retained);
  return info;
}

}  // namespace lucerna
