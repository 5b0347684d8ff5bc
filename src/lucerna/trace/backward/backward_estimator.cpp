// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/backward/backward_estimator.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lucerna/core/io/error.h"
#include "lucerna/core/parallel/parallel.h"
#include "lucerna/ray_statistics.h"

namespace lucerna {

namespace {

constexpr std::size_t kPilotRays = 4096;
/// Radii that hold these shares of a source's lines, and the one that holds all, take equal shares of the
/// samples.
constexpr double kLineShares[] = {0.5, 0.9, 0.99};
/// Mirrors are looked at where they reflect lines within the radius of this share.
constexpr double kGuideShare = 0.98;
/// A start on a mirror, in front of it by this share of its distance from the mirror's origin.
constexpr double kOffSurface = 1e-10;
/// Of the samples of the mirrors, each source has directly.
constexpr std::uint64_t kDirectPart = 4;
/// Numbers the streams of a seed: the mirrors' and each source's own.
constexpr std::uint64_t kStreamStep = 0xD1B54A32D192ED03u;

int checked(int max_bounces) {
  if (max_bounces < 1) throw UsageError(fmt::format("{} bounces: expected at least 1", max_bounces));
  return max_bounces;
}

double distance_mm(const Ray& line, const Vec3& point) {
  const Vec3 to = point - line.origin_mm;
  return length(to - dot(to, line.direction.vec()) * line.direction.vec());
}

/// How far the lines of a source's rays pass its focus, ascending.
struct SourceLines {
  Vec3 focus_mm;
  std::vector<double> miss_mm;
};

SourceLines lines_of(const PlacedSource& placed) {
  RayBlock rays;
  rays.resize(kPilotRays, 0);
  placed.rays->emit(Sequence(SequenceKind::sobol, 1), 0, rays);
  const auto focus = summarize(rays).virtual_focus;
  SourceLines lines{focus ? focus->point_mm : Vec3{}, {}};
  for (std::size_t i = 0; i < rays.size(); ++i)
    lines.miss_mm.push_back(distance_mm(rays.ray(i), lines.focus_mm));
  std::sort(lines.miss_mm.begin(), lines.miss_mm.end());
  return lines;
}

double quantile(const std::vector<double>& ascending, double share) {
  return ascending[static_cast<std::size_t>(share * static_cast<double>(ascending.size() - 1))];
}

std::vector<GuideSource> guide_sources(const Scene& scene) {
  std::vector<GuideSource> out;
  for (const PlacedSource& placed : scene.sources) {
    const SourceLines lines = lines_of(placed);
    out.push_back({placed.world_from_source.point(lines.focus_mm), quantile(lines.miss_mm, kGuideShare)});
  }
  return out;
}

}  // namespace

BackwardEstimator::BackwardEstimator(const Scene& scene, int max_bounces)
    : scene_(scene, checked(max_bounces)), guide_(scene_, guide_sources(scene)) {
  for (std::size_t i = 0; i < scene.sources.size(); ++i)
    disks_.push_back(disks_of(scene.sources[i], scene_.sources()[i]));
}

BackwardEstimator::LineDisks BackwardEstimator::disks_of(const PlacedSource& placed,
                                                         const BackwardScene::Source& source) {
  const SourceLines lines = lines_of(placed);
  LineDisks disks{placed.world_from_source.point(lines.focus_mm), {}};
  const LightBound bound = source.light->light_bound();
  const double all = length(bound.centre_mm - lines.focus_mm) + bound.radius_mm;
  for (const double share : kLineShares)
    disks.radii_mm.push_back(std::min(all, std::max(1e-3 * all, quantile(lines.miss_mm, share))));
  disks.radii_mm.push_back(all);
  return disks;
}

template <class Sink>
void BackwardEstimator::sample_mirrors(const DirectionCell& cell, const CellGuide& guide,
                                       std::uint64_t samples, std::uint64_t seed, const Sink& sink) const {
  const Sequence sequence(SequenceKind::sobol, seed);
  BackwardScene::Scratch scratch;
  for (std::uint64_t i = 0; i < samples; ++i) {
    const auto u = sequence.point<4>(i);
    const TypeCAngles angles = cell.at(u[2], u[3]);
    const MirrorPlace place = guide.place(u[0], u[1]);
    const BackwardScene::Mirror& mirror = scene_.mirrors()[place.mirror];
    const Reflector& reflector = mirror.placed->reflector;
    if (!reflector.aperture.contains(place.x_mm, place.y_mm)) continue;
    const SurfacePoint s = reflector.surface->at(place.x_mm, place.y_mm);
    const Frame& world_from_mirror = mirror.placed->world_from_reflector;
    const Vec3 upward = world_from_mirror.vector({-s.dzdx, -s.dzdy, 1.0});
    const Direction out = direction_from_type_c(angles);
    const double area = dot(upward, out.vec());  // of the surface as seen from there, over that of the plane
    if (!(area > 0.0)) continue;
    const double off = kOffSurface * (1.0 + std::hypot(place.x_mm, place.y_mm) + std::abs(s.z_mm));
    const Vec3 point = world_from_mirror.point({place.x_mm, place.y_mm, s.z_mm + off});
    const double luminance =
        scene_.reflected_luminance(mirror, point, Direction::from(upward), out, {seed, i, 0}, scratch);
    if (luminance > 0.0 && scene_.escapes(point, out, true))
      sink(u[2], angles, luminance * area / place.pdf_plane / static_cast<double>(samples));
  }
}

template <class Sink>
void BackwardEstimator::sample_source(const DirectionCell& cell, std::size_t source, std::uint64_t samples,
                                      std::uint64_t seed, const Sink& sink) const {
  const Sequence sequence(SequenceKind::sobol, seed);
  const LineDisks& disks = disks_[source];
  const auto count = static_cast<double>(disks.radii_mm.size());
  BackwardScene::Scratch scratch;
  for (std::uint64_t i = 0; i < samples; ++i) {
    const auto u = sequence.point<4>(i);
    const TypeCAngles angles = cell.at(u[2], u[3]);
    const Direction out = direction_from_type_c(angles);
    const auto disk = static_cast<std::size_t>(u[0] * count);
    const double radius = disks.radii_mm[disk] * std::sqrt(u[0] * count - static_cast<double>(disk));
    double pdf = 0.0;
    for (const double r : disks.radii_mm) pdf += radius <= r ? 1.0 / (count * std::numbers::pi * r * r) : 0.0;
    const double turn = 2.0 * std::numbers::pi * u[1];
    const Frame across = Frame::from_z(out);
    const Vec3 point =
        disks.centre_mm + radius * std::cos(turn) * across.ex() + radius * std::sin(turn) * across.ey();
    const double luminance = scene_.direct_luminance(scene_.sources()[source], {point, out}, scratch);
    if (luminance > 0.0) sink(u[2], angles, luminance / pdf / static_cast<double>(samples));
  }
}

template <class Sink>
void BackwardEstimator::sample_cell(const DirectionCell& cell, const CellGuide& guide, std::uint64_t samples,
                                    std::uint64_t seed, const Sink& sink) const {
  if (!guide.empty()) sample_mirrors(cell, guide, samples, seed, sink);
  for (std::size_t s = 0; s < disks_.size(); ++s) {
    const std::uint64_t stream = detail::mix_bits(seed + kStreamStep * (s + 1));
    sample_source(cell, s, std::max<std::uint64_t>(1, samples / kDirectPart), stream, sink);
  }
}

std::vector<double> BackwardEstimator::cell_flux(const DirectionCell& cell, std::size_t c_parts,
                                                 std::size_t gamma_parts, std::uint64_t samples,
                                                 std::span<const std::uint64_t> seeds) const {
  const CellGuide guide = guide_.for_cell(cell);
  const double solid_angle = cell.solid_angle_sr(), height = cell.gamma1_rad - cell.gamma0_rad;
  const auto part = [](double u, std::size_t parts) {
    return std::min(parts - 1, static_cast<std::size_t>(std::max(0.0, u) * static_cast<double>(parts)));
  };
  std::vector<double> flux(seeds.size() * c_parts * gamma_parts, 0.0);
  for (std::size_t k = 0; k < seeds.size(); ++k) {
    const std::span<double> to = std::span(flux).subspan(k * c_parts * gamma_parts, c_parts * gamma_parts);
    sample_cell(cell, guide, samples, seeds[k], [&](double u, const TypeCAngles& a, double cd) {
      const std::size_t g = part((a.gamma_rad - cell.gamma0_rad) / height, gamma_parts);
      to[part(u, c_parts) * gamma_parts + g] += cd * solid_angle;
    });
  }
  return flux;
}

Estimate BackwardEstimator::intensity_cd(const Direction& direction, std::uint64_t samples,
                                         std::uint64_t replicates, std::uint64_t seed) const {
  LUCERNA_CHECK(replicates >= 2, "{} replicates", replicates);
  const TypeCAngles a = type_c_angles(direction);
  const DirectionCell cell{a.c_rad, a.c_rad, a.gamma_rad, a.gamma_rad};
  const CellGuide guide = guide_.for_cell(cell);
  std::vector<double> cd(replicates, 0.0);
  parallel_blocks(replicates, 1, [&](std::size_t r, std::size_t) {
    sample_cell(cell, guide, samples, detail::mix_bits(seed * replicates + r),
                [&](double, const TypeCAngles&, double part) { cd[r] += part; });
  });
  const auto n = static_cast<double>(replicates);
  double sum = 0.0, squares = 0.0;
  for (const double v : cd) {
    sum += v;
    squares += v * v;
  }
  const double mean = sum / n;
  return {mean, std::sqrt(std::max(0.0, squares / n - mean * mean) / (n - 1.0))};
}

}  // namespace lucerna
