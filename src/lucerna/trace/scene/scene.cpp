// SPDX-License-Identifier: Apache-2.0
#include "lucerna/scene.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "lucerna/core/io/error.h"
#include "lucerna/optics/shapes/swept_curve.h"
#include "lucerna/rayset/data/luminous_spectrum.h"
#include "lucerna/trace/detectors/far_field_grid.h"

namespace lucerna {

namespace {

bool is_behind(const Reflector& mirror, const Vec3& p) {
  if (mirror.curve) {
    // There may be nothing over this place: the narrow end of a concentrator is open.
    const double r = mirror.curve->sweep() == Sweep::trough ? std::abs(p.x) : std::hypot(p.x, p.y);
    if (r < mirror.curve->r_min_mm() || r > mirror.curve->r_max_mm()) return false;
  }
  return mirror.aperture.contains(p.x, p.y) && p.z < mirror.surface->at(p.x, p.y).z_mm;
}

}  // namespace

double total_flux(std::span<const PlacedSource> sources) {
  double flux = 0.0;
  for (const PlacedSource& s : sources) flux += s.total_flux();
  return flux;
}

double share_behind(const PlacedSource& source, const PlacedReflector& mirror) {
  RayBlock rays;
  rays.resize(
      static_cast<std::size_t>(std::min<std::uint64_t>(4096, source.rays->ray_count().value_or(4096))));
  if (rays.empty()) return 0.0;
  source.rays->emit(Sequence(SequenceKind::random, 1), 0, rays);
  const Frame mirror_from_source = mirror.world_from_reflector.inverse() * source.world_from_source;
  std::size_t behind = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Vec3 p = mirror_from_source.point(rays.origin_mm(i));
    if (is_behind(mirror.reflector, p)) ++behind;
  }
  return static_cast<double>(behind) / static_cast<double>(rays.size());
}

const SpectralTable* PlacedSource::drawn_spectrum() const {
  if (!spectrum.wavelength_nm.empty()) return &spectrum;
  return !rays->has_wavelengths() && rays->spectra().size() == 1 ? rays->spectra().data() : nullptr;
}

namespace {

void check_wavelengths(const Scene& scene) {
  for (std::size_t i = 0; i < scene.sources.size(); ++i)
    check_spectrum(scene.sources[i].spectrum, fmt::format("source {}: spectrum", i + 1));
  const auto disperses =
      std::ranges::find_if(scene.solids, [](const Solid& s) { return s.dispersion != nullptr; });
  if (disperses == scene.solids.end()) return;
  for (std::size_t i = 0; i < scene.sources.size(); ++i) {
    const PlacedSource& s = scene.sources[i];
    if (s.drawn_spectrum() != nullptr || s.rays->has_wavelengths()) continue;
    throw InputError(
        fmt::format(
            "source {}: found no wavelengths, expected a spectrum or rays with wavelengths: solid '{}' "
            "disperses",
            i + 1, disperses->name),
        ErrorCause::missing);
  }
}

}  // namespace

void check(const Scene& scene) {
  if (scene.sources.empty()) throw InputError("the scene has no source");
  const FluxUnit unit = scene.sources.front().rays->flux_unit();
  for (std::size_t i = 0; i < scene.sources.size(); ++i) {
    const PlacedSource& s = scene.sources[i];
    if (!(s.total_flux() > 0.0 && std::isfinite(s.total_flux()))) {
      throw InputError(fmt::format("source {}: the flux is {} {}, expected a finite number above 0", i + 1,
                                   s.total_flux(), symbol(s.rays->flux_unit())));
    }
    if (s.rays->flux_unit() != unit) {
      throw InputError(fmt::format("source {} counts {}, source 1 counts {}; they cannot be added", i + 1,
                                   symbol(s.rays->flux_unit()), symbol(unit)));
    }
    if (s.rays->ray_count() == 0) throw InputError(fmt::format("source {} has no rays", i + 1));
  }
  check_wavelengths(scene);
  for (std::size_t i = 0; i < scene.reflectors.size(); ++i) {
    const double slope = scene.reflectors[i].slope_error_mrad;
    if (!(slope >= 0.0 && slope <= 1000.0)) {
      throw InputError(fmt::format("reflector {}: slope_error_mrad = {}, expected 0 to 1000", i + 1, slope));
    }
  }
  std::set<std::string> causes{"mirror", "mirror_back"};
  const auto add_cause = [&](const std::string& name) {
    if (!causes.insert(name).second) throw InputError(fmt::format("two causes of loss are named '{}'", name));
  };
  for (const Body& b : scene.bodies) {
    check(b);
    add_cause(b.name);
  }
  for (const CoverGlass& g : scene.glasses) {
    check(g);
    add_cause(g.name);
  }
  for (const Solid& s : scene.solids) {
    check(s);
    add_cause(s.name);
  }
  std::set<std::string> names;
  const auto add_name = [&](const std::string& name) {
    if (!names.insert(name).second) throw InputError(fmt::format("two detectors are named '{}'", name));
  };
  for (const FarFieldDetector& d : scene.far_fields) {
    const FarFieldGrid checked(d);
    add_name(d.name);
  }
  for (const PlaneDetector& d : scene.planes) {
    check(d);
    add_name(d.name);
  }
  for (const LuminanceDetector& d : scene.luminances) {
    check(d);
    add_name(d.name);
  }
  for (const RayDetector& d : scene.ray_detectors) {
    check(d);
    add_name(d.name);
  }
}

}  // namespace lucerna
