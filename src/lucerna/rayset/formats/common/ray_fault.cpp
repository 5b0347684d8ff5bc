// SPDX-License-Identifier: Apache-2.0
#include "lucerna/rayset/formats/common/ray_fault.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string_view>

namespace lucerna {

namespace {

/// Directions nearer to unit length than this keep their bits: float32 cannot do better, and read(write(x)) =
/// x.
constexpr float kFloatUnit = 1e-6F;

constexpr float kMax = std::numeric_limits<float>::max();

bool must_be_finite(const ColumnSpec& column) {
  return column.kind != ColumnKind::stokes && column.kind != ColumnKind::additional;
}

std::string not_finite(std::string_view name, float value) {
  return fmt::format("{} is {}, a finite number expected", name, value);
}

/// Makes direction i unit, unless it is as unit as float32 can be.
void normalise(RayBlock& b, std::size_t i) {
  const double kx = b.kx[i], ky = b.ky[i], kz = b.kz[i];
  const double square = kx * kx + ky * ky + kz * kz;
  if (std::abs(square - 1.0) <= static_cast<double>(kFloatUnit)) return;
  const double scale = 1.0 / std::sqrt(square);
  b.kx[i] = static_cast<float>(kx * scale);
  b.ky[i] = static_cast<float>(ky * scale);
  b.kz[i] = static_cast<float>(kz * scale);
}

/// What is wrong with ray i, empty if nothing; normalises its direction.
std::string fault_of(RayBlock& b, const std::vector<ColumnSpec>& columns, std::size_t i) {
  const std::array<std::pair<std::string_view, float>, 7> values{{{"x", b.x_mm[i]},
                                                                  {"y", b.y_mm[i]},
                                                                  {"z", b.z_mm[i]},
                                                                  {"kx", b.kx[i]},
                                                                  {"ky", b.ky[i]},
                                                                  {"kz", b.kz[i]},
                                                                  {"flux", b.weight[i]}}};
  for (const auto& [name, value] : values) {
    if (!std::isfinite(value)) return not_finite(name, value);
  }
  const double kx = b.kx[i], ky = b.ky[i], kz = b.kz[i];
  const double square = kx * kx + ky * ky + kz * kz;
  if (std::abs(square - 1.0) > kDirectionTolerance) {
    return fmt::format("direction ({:g}, {:g}, {:g}) has length {:g}, 1 expected", kx, ky, kz,
                       std::sqrt(square));
  }
  if (b.weight[i] < 0.0F) return fmt::format("flux is {:g}, >= 0 expected", static_cast<double>(b.weight[i]));
  for (std::size_t c = 0; c < columns.size(); ++c) {
    if (must_be_finite(columns[c]) && !std::isfinite(b.extra[c][i])) {
      return not_finite(columns[c].label.empty() ? fmt::format("column {}", 8 + c) : columns[c].label,
                        b.extra[c][i]);
    }
  }
  normalise(b, i);
  return {};
}

/// What a first, vectorised look at a range says.
struct Look {
  bool faulty = false;  // look closer
  bool rough = false;   // some direction is not unit to float32 rounding
};

Look look_at(const RayBlock& b, const std::vector<ColumnSpec>& columns, std::size_t first, std::size_t last) {
  std::uint32_t bad = 0, rough = 0;
  const float *x = b.x_mm.data(), *y = b.y_mm.data(), *z = b.z_mm.data(), *w = b.weight.data();
  const float *kx = b.kx.data(), *ky = b.ky.data(), *kz = b.kz.data();
  for (std::size_t i = first; i < last; ++i) {
    const float off = std::abs(kx[i] * kx[i] + ky[i] * ky[i] + kz[i] * kz[i] - 1.0F);
    const auto finite = static_cast<std::uint32_t>(std::abs(x[i]) <= kMax) &
                        static_cast<std::uint32_t>(std::abs(y[i]) <= kMax) &
                        static_cast<std::uint32_t>(std::abs(z[i]) <= kMax);
    const auto weight = static_cast<std::uint32_t>(w[i] >= 0.0F) & static_cast<std::uint32_t>(w[i] <= kMax);
    bad |=
        (finite & weight & static_cast<std::uint32_t>(off <= static_cast<float>(kDirectionTolerance))) ^ 1U;
    rough |= static_cast<std::uint32_t>(off > kFloatUnit);
  }
  for (std::size_t c = 0; c < columns.size(); ++c) {
    if (!must_be_finite(columns[c])) continue;
    const float* v = b.extra[c].data();
    for (std::size_t i = first; i < last; ++i) bad |= static_cast<std::uint32_t>(std::abs(v[i]) <= kMax) ^ 1U;
  }
  return {bad != 0, rough != 0};
}

void move_ray(RayBlock& b, std::size_t from, std::size_t to) {
  for (auto* a : {&b.x_mm, &b.y_mm, &b.z_mm, &b.kx, &b.ky, &b.kz, &b.weight}) (*a)[to] = (*a)[from];
  for (auto& a : b.extra) a[to] = a[from];
}

}  // namespace

std::optional<RayFault> check_rays(RayBlock& block, const std::vector<ColumnSpec>& columns, std::size_t first,
                                   std::size_t last) {
  const Look look = look_at(block, columns, first, last);
  if (!look.faulty) {
    for (std::size_t i = first; look.rough && i < last; ++i) normalise(block, i);
    return std::nullopt;
  }
  for (std::size_t i = first; i < last; ++i) {
    if (std::string what = fault_of(block, columns, i); !what.empty()) return RayFault{i, std::move(what)};
  }
  return std::nullopt;
}

std::size_t drop_faulty_rays(RayBlock& block, const std::vector<ColumnSpec>& columns, RayFault& example) {
  std::size_t retained = 0, dropped = 0;
  for (std::size_t i = 0; i < block.size(); ++i) {
    std::string what = fault_of(block, columns, i);
    if (what.empty()) {
      if (retained != i) move_ray(block, i, retained);
      ++retained;
    } else if (dropped++ == 0) {
      example = {i, std::move(what)};
    }
  }
  block.resize(retained);
  return dropped;
}

}  // namespace lucerna
