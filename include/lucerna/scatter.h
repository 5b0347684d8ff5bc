// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "lucerna/bsdf.h"
#include "lucerna/geometry.h"

#pragma GCC visibility push(default)
namespace lucerna {

// How a surface scatters the light that it returns.
//
// Directions are given by their cosines along the surface. A lobe's density is one over the offset d, the
// distance between the cosines of the scattered and of the mirrored direction, or even for Lambert's law. So
// what a lobe adds to the BRDF is the same with the directions exchanged (Helmholtz). An offset that leads
// below the horizon is not taken: that light is mirrored. So a surface scatters the less, the more grazing
// the light.

/// No two directions' cosines along a surface are farther apart.
inline constexpr double kLargestScatterOffset = 2.0;

/// The shape of a lobe.
enum class ScatterKind {
  lambert,   ///< the same luminance from all sides
  gaussian,  ///< normal in each of the two cosines
  abg,       ///< a / (b + d^g), as optical shops measure polished and machined surfaces
};

/// One lobe. Made by the functions below, which check it.
struct ScatterLobe {
  /// Its shape.
  ScatterKind kind = ScatterKind::lambert;
  /// Of the light that the surface returns, in (0, 1]: the lobe's, were nothing of it below the horizon.
  double share = 0.0;
  /// Of a Gaussian: standard deviation of each cosine.
  double sigma = 0.0;
  /// Of ABg, and the integral of 1 / (b + d^g) over offsets.
  double b = 0.0, g = 0.0, scale = 1.0;
};

/// Even luminance. Throws InputError unless 0 < share <= 1.
[[nodiscard]] ScatterLobe lambert_lobe(double share);

/// Throws InputError unless 0 < share <= 1 and 1e-6 <= sigma <= 1. For small angles at normal incidence sigma
/// is the standard deviation of the angle about each axis, rad.
[[nodiscard]] ScatterLobe gaussian_lobe(double share, double sigma);

/// A BRDF over reflectance of a / (b + d^g), 1/sr, for offsets up to 2; the share follows. Throws InputError
/// unless a > 0, 1e-12 <= b <= 1e6, 0.1 <= g <= 10, and the share is at most 1. A millisecond.
[[nodiscard]] ScatterLobe abg_lobe(double a, double b, double g);

/// What a data sheet of reflector sheet says: shares in [0, 1], as DIN 5036-3 has them.
struct ReflectorSheet {
  /// All light that is returned.
  double total = 0.0;
  /// What of it leaves outside of the mirrored direction's neighbourhood, of the incident light.
  double diffuse = 0.0;
  /// Gloss at 60 degrees (ISO 7668, ISO 2813), gloss units; negative: not stated.
  double gloss_60 = -1.0;
};

class MeasuredScatter;

/// The lobes of a surface, or a measured table; none: a mirror. Immutable and thread safe.
class Scatter {
 public:
  /// A mirror.
  Scatter() = default;
  /// Throws InputError where the shares' sum is more than 1.
  explicit Scatter(std::vector<ScatterLobe> lobes);
  /// As a table has it: of light at an incidence between two of its own the shares of both, beyond them that
  /// of the nearest, each moved along the plane of incidence to where the light is mirrored
  /// (docs/theory/scatter.md). Throws InputError where the table has no light above the surface, its angles
  /// do not ascend or values are missing. Some 100 evaluations a value.
  explicit Scatter(const BsdfTable& table);

  /// What the table's own values add up to at each of its incidences, a reflectance; empty without one.
  std::vector<double> integrals() const;
  /// The table; null for lobes.
  const MeasuredScatter* measured() const { return measured_.get(); }
  /// The lobes as given.
  const std::vector<ScatterLobe>& lobes() const { return lobes_; }
  /// True for a mirror.
  bool empty() const { return lobes_.empty() && measured_ == nullptr; }

  /// What is scattered adds to the BRDF, over the reflectance, 1/sr. `normal`, and the directions to the
  /// light and to the eye, all on the same side; 0 where one is below the horizon.
  double brdf(const Direction& normal, const Direction& to_light, const Direction& to_eye) const;

  /// Share of the returned light that is not mirrored, at a cosine of incidence in (0, 1]. Within 1e-4; a
  /// millisecond a lobe.
  double total(double cos_incidence) const;

 private:
  std::vector<ScatterLobe> lobes_;
  std::shared_ptr<const MeasuredScatter> measured_;
};

/// Lobes that agree with a data sheet. **Assumed**: what is diffuse follows Lambert's law, and the rest is
/// one Gaussian lobe about the mirrored direction. Its width gives the stated gloss: the light in the
/// receptor of 4.4 x 11.7 degrees of ISO 2813, over what black glass of index 1.567 returns at 60 degrees
/// (10.0 %). Without a gloss the rest is mirrored. Throws InputError unless 0 <= diffuse <= total <= 1 and
/// total > 0, and where that gloss needs more light than there is.
[[nodiscard]] Scatter scatter_of(const ReflectorSheet& sheet);

}  // namespace lucerna
#pragma GCC visibility pop
