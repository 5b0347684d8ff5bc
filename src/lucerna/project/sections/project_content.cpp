// SPDX-License-Identifier: Apache-2.0
#include "lucerna/project/sections/project_content.h"

#include <fmt/format.h>

#include <span>

#include "lucerna/core/io/file.h"
#include "lucerna/core/io/sha256.h"
#include "lucerna/project/schema/project_files.h"
#include "lucerna/project/sections/project_memory.h"

namespace lucerna {

namespace {

template <class Number>
std::string hash_of_numbers(const std::vector<Number>& numbers) {
  const auto bytes = std::as_bytes(std::span(numbers));
  return sha256_of_text({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

std::string hash_of(const SourceModel& model) { return sha256_of_text(source_model_bytes(model)); }

std::string hash_of(const RaySet& set) {
  const RayBlock& rays = set.rays;
  std::string all = fmt::format("{} {:.17g} {}", symbol(set.header.flux_unit),
                                set.header.flux().value_or(0.0), set.header.wavelength_nm.value_or(0.0f));
  for (const auto* column : {&rays.x_mm, &rays.y_mm, &rays.z_mm, &rays.kx, &rays.ky, &rays.kz, &rays.weight})
    all += hash_of_numbers(*column);
  for (const auto& column : rays.extra) all += hash_of_numbers(column);
  for (const ColumnSpec& column : set.header.columns)
    all += fmt::format(" {}", static_cast<int>(column.kind));
  for (const SpectralTable& s : set.header.spectra)
    all += hash_of_numbers(s.wavelength_nm) + hash_of_numbers(s.relative_power);
  return sha256_of_text(all);
}

std::string hash_of(const IntensityDistribution& target) {
  return sha256_of_text(fmt::format("{} {} {} {}", symbol(target.unit), hash_of_numbers(target.c_deg),
                                    hash_of_numbers(target.gamma_deg), hash_of_numbers(target.cd)));
}

std::string hash_of(const ProjectMemory& memory, const std::string& file) {
  if (const auto model = in_memory(memory.models, file)) return hash_of(*model);
  if (const auto rays = in_memory(memory.rays, file)) return hash_of(*rays);
  if (const auto target = in_memory(memory.targets, file)) return hash_of(*target);
  return sha256_of_file(file);
}

}  // namespace

toml::table content_tables(toml::table tables, const ProjectMemory& memory) {
  for_each_file(tables, [&](std::string& name) { name = hash_of(memory, name); });
  return tables;
}

}  // namespace lucerna
