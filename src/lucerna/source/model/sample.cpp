// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "lucerna/error.h"
#include "lucerna/source/emitters/draw_rays.h"
#include "lucerna/source_model.h"
#include "lucerna/version.h"

namespace lucerna {

namespace {

RaySetHeader header_of(const SourceModel& model, const std::string& origin) {
  RaySetHeader header;
  header.flux_unit = model.flux_unit();
  header.set_flux(model.flux());
  header.texts.light_source = "sampled from " + (origin.empty() ? "a model" : origin);
  header.texts.file_creator = fmt::format("Lucerna {}", version());
  header.creation_method = 0;
  header.spectra.assign(model.spectra().begin(), model.spectra().end());
  if (model.has_wavelengths()) {
    header.columns.push_back({ColumnKind::wavelength_nm, standard_label(ColumnKind::wavelength_nm)});
  }
  return header;
}

}  // namespace

std::vector<std::string> sample(const SourceModel& model, std::uint64_t rays,
                                const std::filesystem::path& file, const SampleOptions& options,
                                Progress& progress) {
  const std::string format = ray_format_for(file, options.format);
  if (rays == 0) throw InputError("zero rays asked for, expected at least one");
  return draw_rays(model, Sequence(options.sequence, options.seed), rays,
                   *create_ray_file(file, format, header_of(model, options.origin), rays), progress);
}

RayBlock sample(const RaySource& source, std::size_t rays, const Sequence& sequence) {
  return draw_rays(source, sequence, rays);
}

}  // namespace lucerna
