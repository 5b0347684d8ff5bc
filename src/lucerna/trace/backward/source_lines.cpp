// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/backward/source_lines.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lucerna/random.h"
#include "lucerna/ray_statistics.h"

namespace lucerna {

namespace {

constexpr std::size_t kPilotRays = 4096;
constexpr double kLineShares[] = {0.5, 0.9, 0.99};
/// Rings of lines end where they hold these shares.
constexpr double kRingShares[] = {0.25, 0.5, 0.75, 0.9, 0.95, 0.98, 0.99, 0.995, 1.0};

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

}  // namespace

std::uint64_t direct_samples(std::uint64_t samples) {
  constexpr std::uint64_t kPart = 4;
  return std::max<std::uint64_t>(1, samples / kPart);
}

std::uint64_t source_stream(std::uint64_t seed, std::size_t source) {
  constexpr std::uint64_t kStep = 0xD1B54A32D192ED03u;
  return detail::mix_bits(seed + kStep * (source + 1));
}

LineDisks::LineDisks(const PlacedSource& placed, const LuminanceSource& light) {
  const SourceLines lines = lines_of(placed);
  centre_mm_ = placed.world_from_source.point(lines.focus_mm);
  const LightBound bound = light.light_bound();
  const double all = length(bound.centre_mm - lines.focus_mm) + bound.radius_mm;
  for (const double share : kLineShares)
    radii_mm_.push_back(std::min(all, std::max(1e-3 * all, quantile(lines.miss_mm, share))));
  radii_mm_.push_back(all);
  double inside_mm = 0.0, inside_share = 0.0;
  for (const double share : kRingShares) {
    const double radius = std::max(quantile(lines.miss_mm, share), inside_mm + 1e-3 * all);
    rings_.push_back({radius, (share - inside_share) / (radius * radius - inside_mm * inside_mm)});
    inside_mm = radius;
    inside_share = share;
  }
  for (std::size_t i = rings_.size() - 1; i-- > 0;)
    rings_[i].brightness = std::max(rings_[i].brightness, rings_[i + 1].brightness);
  const double brightest = rings_.front().brightness;
  for (Ring& r : rings_) r.brightness = std::sqrt(r.brightness / brightest);
}

double LineDisks::brightness(double miss_mm) const {
  for (const Ring& r : rings_) {
    if (miss_mm < r.radius_mm) return r.brightness;
  }
  return 0.0;
}

LineDisks::Place LineDisks::place(double u, double v, const Direction& line, double widest) const {
  const auto count = static_cast<double>(radii_mm_.size());
  const auto disk = static_cast<std::size_t>(u * count);
  const auto radius_of = [&](std::size_t i) {
    return i + 1 == radii_mm_.size() ? widest * radii_mm_[i] : radii_mm_[i];
  };
  const double radius = radius_of(disk) * std::sqrt(u * count - static_cast<double>(disk));
  double pdf = 0.0;
  for (std::size_t i = 0; i < radii_mm_.size(); ++i) {
    const double r = radius_of(i);
    pdf += radius <= r ? 1.0 / (count * std::numbers::pi * r * r) : 0.0;
  }
  const double turn = 2.0 * std::numbers::pi * v;
  const Frame across = Frame::from_z(line);
  return {centre_mm_ + radius * std::cos(turn) * across.ex() + radius * std::sin(turn) * across.ey(), pdf};
}

}  // namespace lucerna
