// SPDX-License-Identifier: Apache-2.0
#include "lucerna/scatter.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lucerna/core/io/error.h"
#include "lucerna/trace/kernels/measured_scatter.h"

namespace lucerna {

namespace {

/// ISO 2813: half widths of the receptor of 60 degrees across and along the plane of incidence, and what
/// black glass of index 1.567, whose gloss is 100, returns.
constexpr double kReceptorAcross_deg = 0.5 * 11.7, kReceptorAlong_deg = 0.5 * 4.4;
constexpr double kGlossIncidence_deg = 60.0, kBlackGlass = 0.1000;

void require_share(double share) {
  if (!(share > 0.0 && share <= 1.0))
    throw InputError(fmt::format("scatter: share = {}, expected 0 < share <= 1", share));
}

/// ABg without its factor a.
double abg_shape(const ScatterLobe& lobe, double offset) { return 1.0 / (lobe.b + std::pow(offset, lobe.g)); }

/// Integral of f(d) 2 pi d over offsets from 0 to the largest, f without `lobe`'s scale: by Simpson's rule in
/// the logarithm of d / (a part of the lobe's width), the rest within that as even.
template <class Function>
double over_offsets(const ScatterLobe& lobe, Function&& f) {
  constexpr int kSteps = 4000;
  const double width = lobe.kind == ScatterKind::gaussian ? lobe.sigma : std::pow(lobe.b, 1.0 / lobe.g);
  const double low = 1e-4 * std::min(width, 1.0), high = kLargestScatterOffset,
               step = std::log(high / low) / kSteps;
  double sum = 0.0;
  for (int i = 0; i <= kSteps; ++i) {
    const double d = low * std::exp(step * i), weight = i == 0 || i == kSteps ? 1.0 : i % 2 == 1 ? 4.0 : 2.0;
    sum += weight * f(d) * d * d;
  }
  return 2.0 * std::numbers::pi * (sum * step / 3.0 + 0.5 * low * low * f(low));
}

/// Density over the plane of cosines at an offset of a lobe that is not Lambert's.
double density(const ScatterLobe& lobe, double offset) {
  if (lobe.kind == ScatterKind::gaussian) {
    const double x = offset / lobe.sigma;
    return std::exp(-0.5 * x * x) / (2.0 * std::numbers::pi * lobe.sigma * lobe.sigma);
  }
  return offset > kLargestScatterOffset ? 0.0 : abg_shape(lobe, offset) / lobe.scale;
}

/// Share of the circle of radius d about a point at `r` < 1 from the centre of the unit disk that lies within
/// the disk.
double within_disk(double r, double d) {
  if (d <= 1.0 - r) return 1.0;
  if (d >= 1.0 + r) return 0.0;
  return std::acos(std::clamp((d * d + r * r - 1.0) / (2.0 * d * r), -1.0, 1.0)) / std::numbers::pi;
}

/// Share of a Gaussian about the mirrored direction that the receptor of gloss takes. The cosine in the plane
/// of incidence changes by the cosine of incidence times the angle.
double in_receptor(double sigma) {
  const double along = std::cos(radians(kGlossIncidence_deg)) * std::sin(radians(kReceptorAlong_deg));
  const double across = std::sin(radians(kReceptorAcross_deg));
  return std::erf(along / (std::numbers::sqrt2 * sigma)) * std::erf(across / (std::numbers::sqrt2 * sigma));
}

/// Of what Lambert's law sends anywhere, that in the receptor.
double lambert_in_receptor() {
  const double along = std::cos(radians(kGlossIncidence_deg)) * std::sin(radians(kReceptorAlong_deg));
  return 4.0 * along * std::sin(radians(kReceptorAcross_deg)) / std::numbers::pi;
}

}  // namespace

ScatterLobe lambert_lobe(double share) {
  require_share(share);
  return {.kind = ScatterKind::lambert, .share = share};
}

ScatterLobe gaussian_lobe(double share, double sigma) {
  require_share(share);
  if (!(sigma >= 1e-6 && sigma <= 1.0))
    throw InputError(fmt::format("scatter: sigma = {}, expected 1e-6 to 1", sigma));
  return {.kind = ScatterKind::gaussian, .share = share, .sigma = sigma};
}

ScatterLobe abg_lobe(double a, double b, double g) {
  if (!(a > 0.0 && std::isfinite(a)))
    throw InputError(fmt::format("scatter: a = {}, expected a number above 0", a));
  if (!(b >= 1e-12 && b <= 1e6)) throw InputError(fmt::format("scatter: b = {}, expected 1e-12 to 1e6", b));
  if (!(g >= 0.1 && g <= 10.0)) throw InputError(fmt::format("scatter: g = {}, expected 0.1 to 10", g));
  ScatterLobe lobe{.kind = ScatterKind::abg, .b = b, .g = g};
  lobe.scale = over_offsets(lobe, [&](double d) { return abg_shape(lobe, d); });
  lobe.share = a * lobe.scale;
  if (!(lobe.share <= 1.0)) {
    throw InputError(
        fmt::format("scatter: a = {}, b = {}, g = {} scatter {:.4g} times the light, expected 1 at most", a,
                    b, g, lobe.share));
  }
  return lobe;
}

Scatter::Scatter(std::vector<ScatterLobe> lobes) : lobes_(std::move(lobes)) {
  double sum = 0.0;
  for (const ScatterLobe& lobe : lobes_) sum += lobe.share;
  if (sum > 1.0 + 1e-12)
    throw InputError(fmt::format("scatter: the lobes' shares add up to {}, expected 1 at most", sum));
}

Scatter::Scatter(const BsdfTable& table) : measured_(std::make_shared<const MeasuredScatter>(table)) {}

std::vector<double> Scatter::integrals() const {
  return measured_ != nullptr ? measured_->integrals() : std::vector<double>();
}

double Scatter::brdf(const Direction& normal, const Direction& to_light, const Direction& to_eye) const {
  if (!(dot(normal, to_light) > 0.0 && dot(normal, to_eye) > 0.0)) return 0.0;
  if (measured_ != nullptr) {
    const Direction mirrored = reflect(-to_light, normal);
    return measured_->density(normal, mirrored, to_eye) / dot(normal, to_eye);
  }
  // Along the surface the mirrored direction is the light's turned round.
  const Vec3 both = to_light.vec() + to_eye.vec();
  const double offset = length(both - dot(both, normal) * normal.vec());
  double sum = 0.0;
  for (const ScatterLobe& lobe : lobes_)
    sum += lobe.share * (lobe.kind == ScatterKind::lambert ? 1.0 / std::numbers::pi : density(lobe, offset));
  return sum;
}

double Scatter::total(double cos_incidence) const {
  if (measured_ != nullptr) return 1.0;
  const double r = std::sqrt(std::max(0.0, 1.0 - cos_incidence * cos_incidence));
  double sum = 0.0;
  for (const ScatterLobe& lobe : lobes_) {
    sum += lobe.share * (lobe.kind == ScatterKind::lambert ? 1.0 : over_offsets(lobe, [&](double d) {
             return density(lobe, d) * within_disk(r, d);
           }));
  }
  return sum;
}

namespace {

/// Of light at 60 degrees that a Gaussian lobe returns, what the receptor takes: with what stays mirrored
/// since the lobe would send it below the horizon.
double caught_at_60(double sigma) {
  return in_receptor(sigma) + 1.0 -
         Scatter({gaussian_lobe(1.0, sigma)}).total(std::cos(radians(kGlossIncidence_deg)));
}

/// From 1 at narrow lobes it falls to a least and rises again, as more and more stays mirrored.
double widest_sigma() {
  double best = 1e-6;
  for (double sigma = 0.01; sigma < 0.5; sigma *= 1.05) {
    if (caught_at_60(sigma) < caught_at_60(best)) best = sigma;
  }
  return best;
}

/// The width of the lobe about the mirrored direction; 0 for a mirror.
double sigma_of_gloss(const ReflectorSheet& sheet) {
  const double near = sheet.total - sheet.diffuse, diffuse = sheet.diffuse * lambert_in_receptor();
  const double wanted = (sheet.gloss_60 / 100.0 * kBlackGlass - diffuse) / near;
  double narrow = 1e-6, wide = widest_sigma();
  const double least = caught_at_60(wide);
  if (!(wanted <= 1.0 + 1e-9 && wanted >= least)) {
    const auto gloss = [&](double caught) { return 100.0 / kBlackGlass * (near * caught + diffuse); };
    throw InputError(
        fmt::format("gloss_60 = {}: expected {:.4g} to {:.4g} of a surface with total = {} and diffuse = {}",
                    sheet.gloss_60, gloss(least), gloss(1.0), sheet.total, sheet.diffuse));
  }
  if (wanted >= caught_at_60(narrow)) return 0.0;
  for (int i = 0; i < 40; ++i) {
    const double middle = std::sqrt(narrow * wide);
    (caught_at_60(middle) > wanted ? narrow : wide) = middle;
  }
  return wide;
}

}  // namespace

Scatter scatter_of(const ReflectorSheet& sheet) {
  if (!(sheet.total > 0.0 && sheet.total <= 1.0))
    throw InputError(fmt::format("total = {}, expected 0 to 1", sheet.total));
  if (!(sheet.diffuse >= 0.0 && sheet.diffuse <= sheet.total))
    throw InputError(fmt::format("diffuse = {}, expected 0 to the total, {}", sheet.diffuse, sheet.total));
  std::vector<ScatterLobe> lobes;
  const double diffuse = sheet.diffuse / sheet.total;
  if (diffuse > 0.0) lobes.push_back(lambert_lobe(diffuse));
  if (sheet.gloss_60 < 0.0) return Scatter(std::move(lobes));
  if (diffuse >= 1.0) {
    throw InputError(
        fmt::format("gloss_60 = {}: found diffuse = total, which leaves no light for a gloss; "
                    "expected less diffuse light, or no gloss_60",
                    sheet.gloss_60));
  }
  if (const double sigma = sigma_of_gloss(sheet); sigma > 0.0)
    lobes.push_back(gaussian_lobe(1.0 - diffuse, sigma));
  return Scatter(std::move(lobes));
}

}  // namespace lucerna
