// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lucerna/bounding_surface.h"
#include "lucerna/flux_unit.h"
#include "lucerna/random.h"
#include "lucerna/rays.h"

#pragma GCC visibility push(default)
namespace lucerna {

class RayWavelengths;

/// Anything that light can be drawn from by number: an analytic emitter, a compressed model, the rays of a
/// file. Immutable once made; `emit` is thread safe.
class RaySource {
 public:
  virtual ~RaySource() = default;

  /// Total flux in `flux_unit`; > 0.
  virtual double flux() const = 0;
  /// lm or W.
  virtual FluxUnit flux_unit() const = 0;

  /// Distinct rays there are (a ray file), or nothing when any number can be drawn.
  virtual std::optional<std::uint64_t> ray_count() const { return std::nullopt; }

  /// Replaces the rays of `out` (keeping its size, no extra columns) by rays `first` .. `first + size - 1` of
  /// the numbered stream that `sequence` fixes; the same numbers give the same bits, in whatever pieces they
  /// are asked for. Weights are relative with mean 1 over the source, so that n rays carry about n * flux() /
  /// n. A finite source visits every ray once before it repeats; any first part of the visit is spread over
  /// the file.
  virtual void emit(const Sequence& sequence, std::uint64_t first, RayBlock& out) const = 0;

  /// True if wavelengths of the rays are known (`emit_wavelengths`).
  virtual bool has_wavelengths() const { return false; }
  /// Sets the wavelengths of rays `first` .. `first + nm.size() - 1` of the stream of `emit`, nm. Only for
  /// sources that have them. Thread safe.
  virtual void emit_wavelengths(const Sequence& sequence, std::uint64_t first, std::span<float> nm) const;
  /// Spectra that are known of the source as a whole, where its rays have no wavelengths.
  virtual std::span<const SpectralTable> spectra() const { return {}; }
};

/// Analytic sources, exactly known: to make ray sets, to trace without a file, and to measure models against.
///
/// - point: the origin; isotropic.
/// - disk (radius), rectangle (size): in z = 0; Lambertian to +z.
/// - cylinder (radius, length; lateral surface about z, no ends), sphere (radius): Lambertian outward.
/// - filament: wire of radius 0.06 mm coiled 12 times about x, coil radius and length; Lambertian, windings
///   do not shade each other. A share of `ghost_share` leaves from the coil's inverted image, as a concentric
///   bulb reflects it.
/// - led: four 1 mm dies 0.1 mm apart in z = 0, of relative luminance 1, 0.95, 1.05, 1; 1 % of the flux from
///   the package, a disk of radius 2.5 mm. Lambertian to +z.
/// - phong500: uniform on the sphere; Phong lobe of exponent 500 about the outward normal.
/// - phong25: uniform on the sphere; exponent 25, times a pattern over the direction's angle to z: six bands
///   of equal solid angle, alternately 1 and 0.25, which makes three bright bands.
/// - radial: on the sphere, with a positional pattern; along the outward normal (no étendue).
/// - cosine: on the sphere, with the same pattern; Lambertian outward.
///
/// The positional pattern is a checker of 16 sectors of azimuth by 8 bands of equal area, alternately 1 and
/// 0.25. The last four are the synthetic sets of Mas et al. (docs/theory/clusters.md); their patterns are
/// ours.
enum class EmitterKind {
  point,
  disk,
  rectangle,
  cylinder,
  sphere,
  filament,
  led,
  phong500,
  phong25,
  radial,
  cosine
};

/// The names above.
std::string_view to_string(EmitterKind kind);
/// The kind of a name above. Throws UsageError with the list on anything else.
EmitterKind emitter_kind(std::string_view name);

/// Which emitter, and its sizes.
struct EmitterOptions {
  /// Which of the sources above.
  EmitterKind kind = EmitterKind::point;
  /// Disk, cylinder, sphere, filament (coil), and the sphere of the synthetic sets; > 0. Absent: 1, but
  /// filament 0.6, synthetic sets 10.
  std::optional<double> radius_mm;
  /// Cylinder, filament; > 0. Absent: 6, filament 8.
  std::optional<double> length_mm;
  /// Rectangle; > 0. Absent: 1 x 1.
  std::optional<std::array<double, 2>> size_mm;
  /// Filament: share of the flux in the image, [0, 1). Absent: 0.05.
  std::optional<double> ghost_share;
  /// Total flux in `flux_unit`; > 0.
  double flux = 1000.0;
  /// lm or W.
  FluxUnit flux_unit = FluxUnit::lumen;
  /// Rays are slid forward to this surface, which must enclose the emitter (or lie above it). Absent: led a
  /// sphere of 3 mm, filament a sphere of 20 mm, else none: rays start where they are emitted.
  std::optional<BoundingSurface> surface;
};

/// The emitter. Throws InputError for sizes or fluxes out of range, a size that its kind does not have, or a
/// surface that the emitter does not fit in. A ray takes five numbers of the sequence: 0, 1 direction; 2, 3
/// position; 4 which part. Cost: about 0.1 us a ray.
[[nodiscard]] std::unique_ptr<RaySource> make_emitter(const EmitterOptions& options);

/// The surface that `options` asks for or its kind has by default.
[[nodiscard]] BoundingSurface emission_surface(const EmitterOptions& options);

/// The rays of a file as a source. Ray j of the stream is a ray of the file: blocks of 64 neighbours are
/// visited in golden-ratio steps from a start that the sequence's seed fixes, so any first part of the visit
/// is spread over a file whatever its order, all rays come once before any comes twice, and memory is still
/// read in runs.
class RaySetSource final : public RaySource {
 public:
  /// Throws InputError without rays, without a stated flux > 0, or when all weights are zero. `name` is for
  /// messages.
  RaySetSource(std::shared_ptr<const RaySet> rays, const std::string& name);

  double flux() const override { return flux_; }
  /// The unit of the file's weights.
  FluxUnit flux_unit() const override { return rays_->header.flux_unit; }
  std::optional<std::uint64_t> ray_count() const override { return rays_->rays.size(); }
  void emit(const Sequence& sequence, std::uint64_t first, RayBlock& out) const override;
  /// True for a column of wavelengths, one wavelength of all rays, or spectra.
  bool has_wavelengths() const override;
  /// The ray's own; else drawn from the spectrum that the ray's index names, or the first one (of the lumens
  /// where weights are lumens), the same at every visit; else that of all rays.
  void emit_wavelengths(const Sequence& sequence, std::uint64_t first, std::span<float> nm) const override;

 private:
  /// Calls `copy(from, count, to)` for each run of neighbours in the file that rays `first` .. `first + size
  /// - 1` of the stream are, with their place among these.
  template <class Copy>
  void visit(const Sequence& sequence, std::uint64_t first, std::size_t size, const Copy& copy) const;
  std::shared_ptr<const RaySet> rays_;
  std::shared_ptr<const RayWavelengths> wavelengths_;
  double flux_ = 0.0;
  /// n / sum of weights: makes the mean weight 1.
  double weight_scale_ = 0.0;
  std::uint64_t blocks_ = 0, stride_ = 1;
};

}  // namespace lucerna
#pragma GCC visibility pop
