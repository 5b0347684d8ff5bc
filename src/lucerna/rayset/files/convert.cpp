// SPDX-License-Identifier: Apache-2.0
#include "lucerna/rayset/files/convert.h"

#include <cmath>

#include "lucerna/core/io/error.h"
#include "lucerna/ray_file.h"
#include "lucerna/ray_statistics.h"
#include "lucerna/rayset/data/subset.h"
#include "lucerna/rayset/files/named_warnings.h"

namespace lucerna {

namespace {

/// What the chosen rays' weights must grow by so that their sum is that of all rays.
double weight_factor(const std::filesystem::path& in, const RaySubset& subset, const ReadOptions& options,
                     Progress& progress) {
  double all = 0.0, chosen = 0.0;
  std::uint64_t first = 0;
  const auto reader = open_ray_file(in, options);
  for_each_block(*reader, progress, "choose rays", [&](const RayBlock& block) {
    RayBlock part;
    subset.select(block, first, part);
    first += block.size();
    all += sum_of_weights(block);
    chosen += sum_of_weights(part);
  });
  return chosen > 0.0 ? all / chosen : 1.0;
}

/// Refuses rays that are beyond what a file can hold.
void check_finite(const RayBlock& block) {
  for (std::size_t i = 0; i < block.size(); ++i) {
    const Vec3 at = block.origin_mm(i);
    if (std::isfinite(at.x) && std::isfinite(at.y) && std::isfinite(at.z)) continue;
    throw UsageError(
        fmt::format("a ray would begin at ({}, {}, {}) mm, which no ray file holds", at.x, at.y, at.z),
        "move");
  }
}

}  // namespace

void transform(RayBlock& block, const Frame& new_from_old) {
  for (std::size_t i = 0; i < block.size(); ++i) block.set(i, new_from_old.ray(block.ray(i)));
}

RayConversionResult convert_ray_file(const std::filesystem::path& in, const std::filesystem::path& out,
                                     const std::string& format, const RayConversion& conversion,
                                     const ReadOptions& read_options, Progress& progress) {
  const auto reader = open_ray_file(in, read_options);
  RaySetHeader header = reader->header();
  if (conversion.flux) header.set_flux(*conversion.flux);
  const bool moves = !(conversion.new_from_old == Frame());
  std::optional<RaySubset> subset;
  double factor = 1.0;
  if (conversion.rays) {
    subset.emplace(reader->ray_count(), *conversion.rays, conversion.seed);
    factor = weight_factor(in, *subset, read_options, progress);
  }
  const std::uint64_t count = subset ? subset->count() : reader->ray_count();
  const auto writer = create_ray_file(out, format, header, count, {.length_unit = conversion.length_unit});
  RayConversionResult result{0, header.flux(), header.flux_unit, {}};
  std::uint64_t first = 0;
  for_each_block(*reader, progress, "convert", [&](const RayBlock& block) {
    RayBlock retained;
    retained.extra.resize(block.extra.size());
    if (subset) {
      subset->select(block, first, retained);
      for (float& weight : retained.weight) weight = static_cast<float>(factor * static_cast<double>(weight));
    } else {
      retained = block;
    }
    first += block.size();
    if (moves) {
      transform(retained, conversion.new_from_old);
      check_finite(retained);
    }
    writer->write(retained);
    result.rays += retained.size();
  });
  add_named_warnings(in, reader->warnings(), result.warnings);
  if (conversion.strict && !result.warnings.empty()) throw InputError(result.warnings.front());
  writer->finish();
  result.warnings.insert(result.warnings.end(), writer->warnings().begin(), writer->warnings().end());
  return result;
}

}  // namespace lucerna
