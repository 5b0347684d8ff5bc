// SPDX-License-Identifier: Apache-2.0
#include "lucerna/core/io/number_table.h"
#include "lucerna/project/sections/project_memory.h"
#include "lucerna/project/sections/project_parts.h"
#include "lucerna/ray_file.h"
#include "lucerna/rayset/data/luminous_spectrum.h"
#include "lucerna/rayset/files/named_warnings.h"
#include "lucerna/source.h"
#include "lucerna/source_model.h"

namespace lucerna::project_parts {

namespace {

namespace fs = std::filesystem;

struct GivenFlux {
  double flux = 0.0;
  FluxUnit unit = FluxUnit::lumen;
};

std::optional<GivenFlux> read_flux(TomlReader& reader) {
  const auto lm = reader.number("flux_lm"), w = reader.number("flux_w");
  if (lm && w) reader.fail("flux_w", "flux_lm and flux_w exclude each other");
  if (lm) return GivenFlux{*lm, FluxUnit::lumen};
  if (w) return GivenFlux{*w, FluxUnit::watt};
  return std::nullopt;
}

/// `surface` with `surface_mm`: one number or an array of them.
std::optional<BoundingSurface> read_surface(TomlReader& reader) {
  const auto name = reader.word("surface");
  const auto mm = reader.number_or_numbers("surface_mm");
  if (!name && mm) reader.fail("surface_mm", "needs surface");
  if (!name) return std::nullopt;
  return at_key(reader, mm ? "surface_mm" : "surface", [&] {
    return BoundingSurface::from_sizes(surface_kind(*name), mm.value_or(std::vector<double>()));
  });
}

std::shared_ptr<const RaySource> read_emitter(TomlReader& reader, const std::optional<GivenFlux>& flux) {
  EmitterOptions options;
  options.kind = emitter_kind(reader.required_word("kind"));
  options.radius_mm = reader.number("radius_mm");
  options.length_mm = reader.number("length_mm");
  if (const auto size = reader.numbers("size_mm", 2)) options.size_mm = {{(*size)[0], (*size)[1]}};
  options.ghost_share = reader.number("ghost_share");
  options.surface = read_surface(reader);
  if (flux) {
    options.flux = flux->flux;
    options.flux_unit = flux->unit;
  }
  return at_key(reader, "kind", [&] { return make_emitter(options); });
}

/// The flux of a project must be in the unit of what it is for; `what` names that.
void check_unit(const TomlReader& reader, const std::optional<GivenFlux>& flux, FluxUnit unit,
                const std::string& what) {
  if (!flux || flux->unit == unit) return;
  reader.fail(flux->unit == FluxUnit::lumen ? "flux_lm" : "flux_w",
              fmt::format("{} {}; lumen and watt are never mixed", what, symbol(unit)));
}

std::shared_ptr<const RaySource> read_ray_source(const TomlReader& reader, const fs::path& file,
                                                 const std::optional<GivenFlux>& flux, Project& project,
                                                 Progress& progress) {
  std::shared_ptr<const RaySet> rays = in_memory(project.memory.rays, file);
  if (rays == nullptr) {
    std::vector<std::string> warnings;
    rays = std::make_shared<RaySet>(read_ray_set(file, {}, progress, &warnings));
    add_named_warnings(file, warnings, project.warnings);
    project.inputs.push_back(file);
  }
  check_unit(reader, flux, rays->header.flux_unit, fmt::format("the rays of {} carry", file.string()));
  if (flux && !rays->header.flux()) {  // a source needs a flux of its own
    RaySet stated = *rays;
    stated.header.set_flux(flux->flux);
    rays = std::make_shared<RaySet>(std::move(stated));
  }
  return std::make_shared<RaySetSource>(std::move(rays), file.string());
}

std::shared_ptr<const RaySource> read_model_source(const TomlReader& reader, const fs::path& file,
                                                   const std::optional<GivenFlux>& flux, Project& project) {
  std::shared_ptr<const SourceModel> model = in_memory(project.memory.models, file);
  if (model == nullptr) {
    if (!is_source_model(file)) return nullptr;
    model = load_source_model(file);
    project.inputs.push_back(file);
  }
  check_unit(reader, flux, model->flux_unit(), fmt::format("the model {} carries", file.string()));
  return model;
}

/// `wavelength_nm` or `spectrum`; empty for neither.
SpectralTable read_spectrum(TomlReader& reader, Project& project) {
  const auto nm = reader.number("wavelength_nm");
  const auto file = reader.file("spectrum");
  if (nm && file) reader.fail("spectrum", "found `wavelength_nm` too; expected one of both");
  if (nm) return {{static_cast<float>(*nm)}, {1.0F}};
  if (!file) return {};
  project.inputs.push_back(*file);
  return at_key(reader, "spectrum", [&] {
    const NumberTable table = read_number_table(*file, TableHeader::optional);
    if (table.columns != 2 || table.rows == 0) {
      throw InputError(fmt::format("{}: found {} lines of {} numbers, expected lines of two: nm and power",
                                   file->string(), table.rows, table.columns));
    }
    SpectralTable out;
    for (std::size_t i = 0; i < table.rows; ++i) {
      out.wavelength_nm.push_back(static_cast<float>(table.numbers[2 * i]));
      out.relative_power.push_back(static_cast<float>(table.numbers[2 * i + 1]));
    }
    check_spectrum(out, file->string());
    return out;
  });
}

}  // namespace

PlacedSource read_source(TomlReader reader, Project& project, Progress& progress) {
  PlacedSource source;
  source.world_from_source = read_placement(reader);
  const auto flux = read_flux(reader);
  source.spectrum = read_spectrum(reader, project);
  const auto file = reader.file("file");
  if (file) {
    if (reader.has("kind")) reader.fail("kind", "a source has either a file or a kind");
    source.rays = read_model_source(reader, *file, flux, project);
    if (source.rays == nullptr) source.rays = read_ray_source(reader, *file, flux, project, progress);
    if (flux) source.flux = flux->flux;
  } else {
    if (!reader.has("kind")) reader.missing("kind", "a source needs a file or a kind");
    source.rays = read_emitter(reader, flux);
  }
  reader.finish();
  return source;
}

}  // namespace lucerna::project_parts
