// SPDX-License-Identifier: Apache-2.0
#include "lucerna/project/sections/project_parts.h"
#include "lucerna/ray_file.h"
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
  if (const auto size = reader.numbers("size_mm", 2)) options.size_mm = {(*size)[0], (*size)[1]};
  options.ghost_share = reader.number("ghost_share", options.ghost_share);
  options.surface = read_surface(reader);
  if (flux) {
    options.flux = flux->flux;
    options.flux_unit = flux->unit;
  }
  return at_key(reader, "kind", [&] { return make_emitter(options); });
}

std::shared_ptr<const RaySource> read_ray_file_source(TomlReader& reader, const fs::path& file,
                                                      const std::optional<GivenFlux>& flux, Project& project,
                                                      Progress& progress) {
  std::vector<std::string> warnings;
  auto rays = std::make_shared<RaySet>(read_ray_set(file, {}, progress, &warnings));
  project.warnings.insert(project.warnings.end(), warnings.begin(), warnings.end());
  if (flux) {
    if (flux->unit != rays->header.flux_unit) {
      reader.fail(flux->unit == FluxUnit::lumen ? "flux_lm" : "flux_w",
                  fmt::format("the rays of {} carry {}; lumen and watt are never mixed", file.string(),
                              symbol(rays->header.flux_unit)));
    }
    rays->header.set_flux(flux->flux);
  }
  return std::make_shared<RaySetSource>(std::move(rays), file.string());
}

/// A model; PlacedSource::flux overrides what it holds.
std::shared_ptr<const RaySource> read_model_source(TomlReader& reader, const fs::path& file,
                                                   const std::optional<GivenFlux>& flux) {
  std::shared_ptr<const RaySource> model = load_source_model(file);
  if (flux && flux->unit != model->flux_unit()) {
    reader.fail(flux->unit == FluxUnit::lumen ? "flux_lm" : "flux_w",
                fmt::format("the model {} carries {}; lumen and watt are never mixed", file.string(),
                            symbol(model->flux_unit())));
  }
  return model;
}

}  // namespace

PlacedSource read_source(TomlReader reader, Project& project, Progress& progress) {
  PlacedSource source;
  source.world_from_source = read_placement(reader);
  const auto flux = read_flux(reader);
  const auto file = reader.file("file");
  if (file) {
    if (reader.has("kind")) reader.fail("kind", "a source has either a file or a kind");
    project.inputs.push_back(*file);
    if (is_source_model(*file)) {
      source.rays = read_model_source(reader, *file, flux);
      if (flux) source.flux = flux->flux;
    } else {
      source.rays = read_ray_file_source(reader, *file, flux, project, progress);
    }
  } else {
    if (!reader.has("kind")) reader.missing("kind", "a source needs a file or a kind");
    source.rays = read_emitter(reader, flux);
  }
  reader.finish();
  return source;
}

}  // namespace lucerna::project_parts
