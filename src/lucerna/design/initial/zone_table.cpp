// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/initial/zone_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <variant>

#include "lucerna/core/io/error.h"
#include "lucerna/core/parallel/parallel.h"
#include "lucerna/trace/tally/flux_quanta.h"

namespace lucerna {

namespace {

constexpr std::size_t kZones = 100, kHeightLevels = 5;
/// Cells of arriving light per zone at most, and turns.
constexpr double kMaxTableCells = 4096.0, kMaxTurns = 400.0;
/// Longest step of an angle over what the source spreads.
constexpr double kStepShare = 0.06;
/// Where light hits a zone nearly along its face, how much more of it a tilted zone may catch.
constexpr double kMaxGain = 8.0;
/// Parts that the rays are counted in, by their number alone: sums never depend on threads.
constexpr std::uint64_t kParts = 4;

/// Of so many blocks of rays one is looked at for where the source is and how far it spreads its light.
constexpr std::uint64_t kLookAtBlocks = 16;
/// Stands for light beside the window, where half a ring inside the axis is -0.5.
constexpr float kNoRing = -2.0f;

/// The point of the axis that the rays pass nearest to.
double middle_z_of(const DesignRays& rays, std::uint64_t blocks) {
  double along = 0.0, weights = 0.0;
  for (std::uint64_t b = 0; b < blocks; b += kLookAtBlocks) {
    const DesignRays::Block& block = rays.block(b);
    for (std::size_t i = 0; i < kBlockRays; ++i) {
      const Vec3 o{block.x_mm[i], block.y_mm[i], block.z_mm[i]}, d{block.kx[i], block.ky[i], block.kz[i]};
      const double weight = block.weight[i];
      along += weight * (o.z - d.z * dot(o, d));
      weights += weight * (1.0 - d.z * d.z);
    }
  }
  return along / std::max(weights, 1e-12);
}

}  // namespace

/// Light is counted in cells of chi, from the middle's, and of beta, the angle out of the plane through the
/// axis. Two steps of chi are one of the turn, so that where a cell goes depends on a whole number.
struct ZoneTable::Grid {
  double half_chi = 0.0, step = 0.0;
  std::size_t chis = 0, betas = 0;
  /// Where between the rings a cell goes, by |steps off the axis| and beta.
  std::vector<float> ring;
};

/// Light that arrives at the zones of a level, zones x chis x betas, and all light that was sent.
struct ZoneTable::Light {
  std::vector<float> flux;
  double all = 0.0;
};

/// One ray where it hits the face of the base paraboloid raised to a level. `across`: its flux over the
/// projection of a square mm of the face.
struct ZoneTable::Arrival {
  double r = 0.0, z = 0.0, chi = 0.0, beta = 0.0, across = 0.0;
};

double ZoneTable::middle_chi(double r_mm, double z_mm) const { return std::atan2(r_mm, middle_z_mm_ - z_mm); }

ZoneTable::ZoneTable(const DesignShape& family, const Reflectance& reflectance, const DesignRays& rays,
                     std::uint64_t count, const TentBins& bins, double half_height_mm,
                     Eigen::VectorXd constant)
    : rings_(bins.size()),
      base_per_r_(0.5 / family.focal_mm()),
      radius_mm_(family.aperture().outer_radius_mm()),
      hole_mm_(family.aperture().hole_radius_mm()),
      half_height_mm_(half_height_mm),
      level_step_mm_(2.0 * half_height_mm / (kHeightLevels - 1)),
      middle_z_mm_(middle_z_of(rays, count / kBlockRays)),
      axis_turn_(bins.axes().ez().z > 0.0 ? 0.0 : std::numbers::pi),
      constant_(std::move(constant)) {
  LUCERNA_CHECK(family.is_revolution() && bins.is_rings(), "zones of a mirror without symmetry");
  for (std::size_t j = 0; j < kZones; ++j) {
    zone_r_mm_.push_back(radius_mm_ * (static_cast<double>(j) + 0.5) / kZones);
  }
  const double cell = bins.extent() / static_cast<double>(rings_);
  const Grid grid = make_grid(rays, count / kBlockRays, bins.extent(), cell);
  const std::vector<Light> light = arriving(rays, count / kBlockRays, grid);
  table_.assign(kHeightLevels * kZones * turns_ * rings_, 0.0f);
  parallel_blocks(kHeightLevels * kZones, 4, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      fill(i / kZones, i % kZones, light[i / kZones], reflectance, grid);
    }
  });
}

ZoneTable::Grid ZoneTable::make_grid(const DesignRays& rays, std::uint64_t blocks, double extent,
                                     double cell) {
  Grid grid;
  double half_chi = 0.0, max_beta = 0.0;  // how far the source spreads its light about its middle
  for (std::uint64_t b = 0; b < blocks; b += kLookAtBlocks) {
    for (std::size_t i = 0; i < kBlockRays; ++i) {
      for (const double level_mm : {-half_height_mm_, half_height_mm_}) {
        Arrival a;
        if (!arrive(rays.block(b), i, level_mm, a)) continue;
        half_chi = std::max(half_chi, std::abs(a.chi - middle_chi(a.r, a.z)));
        max_beta = std::max(max_beta, a.beta);
      }
    }
  }
  // Fine beside the rings, and beside what one zone throws.
  const double extent_of_turns = std::min(std::numbers::pi, extent + cell + half_chi + max_beta);
  grid.step = std::min(0.5 * cell, kStepShare * std::max(half_chi, max_beta));
  grid.step = std::max(grid.step, extent_of_turns / kMaxTurns);
  const double cells = (2.0 * half_chi / grid.step + 1.0) * (max_beta / grid.step + 1.0);
  grid.step *= std::max(1.0, std::sqrt(cells / kMaxTableCells));
  grid.chis = 2 * static_cast<std::size_t>(std::ceil(half_chi / grid.step)) + 3;
  grid.half_chi = 0.5 * static_cast<double>(grid.chis - 1) * grid.step;
  grid.betas = static_cast<std::size_t>(std::ceil(max_beta / grid.step)) + 2;

  turn_step_ = 2.0 * grid.step;
  turns_ = 2 * static_cast<std::size_t>(std::ceil(extent_of_turns / turn_step_)) + 1;
  half_turn_ = 0.5 * static_cast<double>(turns_ - 1) * turn_step_;

  const std::size_t max_off = turns_ + grid.chis;
  for (std::size_t off = 0; off < max_off; ++off) {
    for (std::size_t b = 0; b < grid.betas; ++b) {
      const double cosine =
          std::cos(static_cast<double>(b) * grid.step) * std::cos(static_cast<double>(off) * grid.step);
      const double s = std::acos(std::clamp(cosine, -1.0, 1.0)) / cell - 0.5;
      grid.ring.push_back(s < static_cast<double>(rings_) ? static_cast<float>(s) : kNoRing);
    }
  }
  return grid;
}

bool ZoneTable::arrive(const DesignRays::Block& block, std::size_t i, double level_mm, Arrival& a) const {
  const Vec3 o{block.x_mm[i], block.y_mm[i], block.z_mm[i]}, d{block.kx[i], block.ky[i], block.kz[i]};
  const double k = 0.5 * base_per_r_;
  const double c0 = o.z - level_mm - k * (o.x * o.x + o.y * o.y);
  const double c1 = d.z - 2.0 * k * (o.x * d.x + o.y * d.y), c2 = k * (d.x * d.x + d.y * d.y) + 1e-30;
  if (!(c0 > 0.0)) return false;
  const double w = std::sqrt(c1 * c1 + 4.0 * c2 * c0);
  const double t = c1 > 0.0 ? (c1 + w) / (2.0 * c2) : 2.0 * c0 / (w - c1);
  const double x = o.x + t * d.x, y = o.y + t * d.y;
  a.r = std::sqrt(x * x + y * y);
  if (!(a.r < radius_mm_ && a.r >= hole_mm_ && a.r > 0.0)) return false;
  const double d_r = (d.x * x + d.y * y) / a.r, d_phi = (d.y * x - d.x * y) / a.r;
  const double facing = base_per_r_ * a.r * d_r - d.z;
  if (!(facing > 0.0)) return false;
  a.z = o.z + t * d.z;
  a.chi = std::atan2(d_r, -d.z);
  a.beta = std::asin(std::min(1.0, std::abs(d_phi)));
  const double weight = block.weight[i];
  a.across = weight / facing;
  return true;
}

std::vector<ZoneTable::Light> ZoneTable::arriving(const DesignRays& rays, std::uint64_t blocks,
                                                  const Grid& grid) const {
  std::vector<Light> parts(kHeightLevels * kParts);
  parallel_blocks(parts.size(), 1, [&](std::size_t p, std::size_t) {
    const std::uint64_t part = p % kParts;
    Light& light = parts[p];
    light.flux.assign(kZones * grid.chis * grid.betas, 0.0f);
    for (std::uint64_t b = blocks * part / kParts; b < blocks * (part + 1) / kParts; ++b) {
      count(rays.block(b), level_mm(p / kParts), grid, light);
    }
  });
  std::vector<Light> levels(kHeightLevels);
  for (std::size_t p = 0; p < parts.size(); ++p) {
    Light& sum = levels[p / kParts];
    sum.all += parts[p].all;
    if (sum.flux.empty()) {
      sum.flux = std::move(parts[p].flux);
    } else {
      for (std::size_t i = 0; i < sum.flux.size(); ++i) sum.flux[i] += parts[p].flux[i];
    }
  }
  return levels;
}

void ZoneTable::count(const DesignRays::Block& block, double level_mm, const Grid& grid, Light& light) const {
  for (std::size_t i = 0; i < kBlockRays; ++i) {
    const double weight = block.weight[i];
    light.all += weight;
    Arrival a;
    if (!arrive(block, i, level_mm, a)) continue;
    const double s = (a.chi - middle_chi(a.r, a.z) + grid.half_chi) / grid.step, u = a.beta / grid.step;
    if (!(s >= 0.0 && s < static_cast<double>(grid.chis - 1) && u < static_cast<double>(grid.betas - 1))) {
      continue;  // a rare one that the look at the spread did not see
    }
    const auto zone = std::min(kZones - 1, static_cast<std::size_t>(a.r / radius_mm_ * kZones));
    const auto is = static_cast<std::size_t>(s), iu = static_cast<std::size_t>(u);
    const auto fs = static_cast<float>(s - static_cast<double>(is));
    const auto fu = static_cast<float>(u - static_cast<double>(iu)), e = static_cast<float>(a.across);
    float* const to = light.flux.data() + (zone * grid.chis + is) * grid.betas + iu;
    to[0] += (1.0f - fs) * (1.0f - fu) * e;
    to[1] += (1.0f - fs) * fu * e;
    to[grid.betas] += fs * (1.0f - fu) * e;
    to[grid.betas + 1] += fs * fu * e;
  }
}

void ZoneTable::fill(std::size_t level, std::size_t zone, const Light& light, const Reflectance& reflectance,
                     const Grid& grid) {
  struct Cell {
    float flux;
    std::uint32_t beta;
  };
  const float* const at = light.flux.data() + zone * grid.chis * grid.betas;
  const double r = zone_r_mm_[zone], base = base_per_r_ * r;
  const double middle = middle_chi(r, 0.5 * base * r + level_mm(level));
  const double base_angle = std::atan(base);
  // Cells in the order of chi; a column ends where the next begins.
  std::vector<Cell> cells;
  std::vector<std::size_t> column(grid.chis + 1);
  for (std::uint32_t c = 0; c < grid.chis; ++c) {
    column[c] = cells.size();
    for (std::uint32_t b = 0; b < grid.betas; ++b) {
      const double cosine = std::cos(static_cast<double>(b) * grid.step);
      const auto flux = at[c * grid.betas + b] * static_cast<float>(cosine / light.all);
      if (flux > 0.0f) cells.push_back({flux, b});
    }
  }
  column[grid.chis] = cells.size();
  for (std::size_t t = 0; t < turns_; ++t) {
    const double turn = static_cast<double>(t) * turn_step_ - half_turn_ + axis_turn_;
    const double slope = std::remainder(0.5 * (turn + middle), std::numbers::pi);
    float* const to = row(level, zone, t);
    for (std::size_t c = 0; c < grid.chis; ++c) {
      if (column[c] == column[c + 1]) continue;
      const double chi = static_cast<double>(c) * grid.step - grid.half_chi + middle;
      const double facing = std::cos(chi - slope), on_base = std::cos(chi - base_angle);
      if (!(facing > 0.0)) continue;
      // What a flat square mm of the aperture catches, at most kMaxGain times the base's share.
      const double caught = std::min(facing / std::cos(slope), kMaxGain * on_base / std::cos(base_angle));
      const auto gain = static_cast<float>(std::max(0.0, caught) * reflectance.at(std::min(1.0, facing)));
      const auto off = static_cast<std::ptrdiff_t>(c) - static_cast<std::ptrdiff_t>(grid.chis / 2) -
                       2 * (static_cast<std::ptrdiff_t>(t) - static_cast<std::ptrdiff_t>(turns_ / 2));
      const float* const ring = grid.ring.data() + static_cast<std::size_t>(std::abs(off)) * grid.betas;
      for (std::size_t i = column[c]; i < column[c + 1]; ++i) {
        const float s = ring[cells[i].beta], e = gain * cells[i].flux;
        if (s < 0.0f) {
          if (s != kNoRing) to[0] += e;  // the innermost ring is flat at the axis
          continue;
        }
        const auto n = static_cast<std::size_t>(s);
        const float f = s - static_cast<float>(n);
        to[n] += (1.0f - f) * e;
        if (n + 1 < rings_) to[n + 1] += f * e;
      }
    }
  }
}

Evaluation ZoneTable::evaluate(const DesignShape& shape) const {
  const auto& profile = std::get<RevolutionShape>(shape.family());
  const std::vector<int>& parameter_of = shape.parameter_of();
  const auto n = static_cast<Eigen::Index>(shape.parameter_count()), m = static_cast<Eigen::Index>(rings_);
  Eigen::VectorXf flux = Eigen::VectorXf::Zero(m), by_height(m), by_turn(m);
  Eigen::MatrixXf jacobian = Eigen::MatrixXf::Zero(m, n);
  using Row = Eigen::Map<const Eigen::VectorXf>;
  const RevolutionView view = profile.view();
  for (std::size_t j = 0; j < zone_r_mm_.size(); ++j) {
    const double r = zone_r_mm_[j], base = base_per_r_ * r;
    const KnotRow::Place place = profile.row().place(r);
    const CubicBasis basis = cubic_basis(place.t), slope = cubic_basis_slope(place.t);
    const auto [s, s_r] = view.offset_at(r);
    const double p = base + s_r, z = 0.5 * base * r + s;
    const double turn =
        std::remainder(2.0 * std::atan(p) - middle_chi(r, z) - axis_turn_, 2.0 * std::numbers::pi);
    const double a = (turn + half_turn_) / turn_step_;
    const double b = (s + half_height_mm_) / level_step_mm_;
    if (!(a >= 0.0 && a < static_cast<double>(turns_ - 1))) continue;  // out of the window
    const auto it = static_cast<std::size_t>(a);
    const auto ih = static_cast<std::size_t>(std::clamp(b, 0.0, static_cast<double>(kHeightLevels) - 1.001));
    const auto ft = static_cast<float>(a - static_cast<double>(it));
    const auto fh = static_cast<float>(std::clamp(b - static_cast<double>(ih), 0.0, 1.0));
    const Row low(row(ih, j, it), m), low_next(row(ih, j, it + 1), m);
    const Row high(row(ih + 1, j, it), m), high_next(row(ih + 1, j, it + 1), m);
    by_turn = (1.0f - fh) * (low_next - low) + fh * (high_next - high);
    by_height = (1.0f - ft) * (high - low) + ft * (high_next - low_next);
    flux += (1.0f - fh) * low + fh * high + ft * by_turn;
    const double turn_per_slope = 2.0 / ((1.0 + p * p) * profile.row().step_mm);
    const double turn_per_mm = -r / (r * r + (middle_z_mm_ - z) * (middle_z_mm_ - z));
    for (std::size_t c = 0; c < 4; ++c) {
      const double turned = (turn_per_slope * slope[c] + turn_per_mm * basis[c]) / turn_step_;
      jacobian.col(parameter_of[static_cast<std::size_t>(place.first) + c]) +=
          static_cast<float>(turned) * by_turn + static_cast<float>(basis[c] / level_step_mm_) * by_height;
    }
  }
  Evaluation e;
  e.flux = flux.cast<double>() + constant_;
  e.variance = Eigen::VectorXd::Zero(m);
  e.jacobian = jacobian.cast<double>();
  return e;
}

}  // namespace lucerna
