// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "lucerna/core/io/error.h"
#include "lucerna/intensity.h"

namespace lucerna {

namespace {

bool ascending(const std::vector<double>& values) {
  return std::adjacent_find(values.begin(), values.end(), [](double a, double b) { return !(a < b); }) ==
         values.end();
}

/// Number of steps in `range`, or InputError if `step` does not divide it.
std::size_t steps(double range, double step, const char* name) {
  const double n = std::round(range / step);
  if (!(step > 0.0) || n < 1.0 || n > 1e6 || std::abs(n * step - range) > 1e-9 * range) {
    throw InputError(fmt::format("{} step {} deg does not divide {} deg", name, step, range));
  }
  return static_cast<std::size_t>(n);
}

}  // namespace

std::string grid_fault(const IntensityDistribution& d) {
  const auto finite = [](double v) { return std::isfinite(v); };
  if (d.c_deg.empty()) return "no C plane";
  if (d.gamma_deg.size() < 2) return fmt::format("{} gamma angles, at least 2 needed", d.gamma_deg.size());
  if (!std::all_of(d.c_deg.begin(), d.c_deg.end(), finite) || !ascending(d.c_deg)) {
    return "C planes do not ascend";
  }
  if (d.c_deg.front() != 0.0) return fmt::format("first C plane is {}, not 0", d.c_deg.front());
  if (d.c_deg.back() >= 360.0) return fmt::format("last C plane is {}, not below 360", d.c_deg.back());
  if (!std::all_of(d.gamma_deg.begin(), d.gamma_deg.end(), finite) || !ascending(d.gamma_deg)) {
    return "gamma angles do not ascend";
  }
  if (d.gamma_deg.front() < 0.0 || d.gamma_deg.back() > 180.0) return "gamma angles leave [0, 180]";
  if (d.cd.size() != d.c_deg.size() * d.gamma_deg.size()) {
    return fmt::format("{} values for {} x {} angles", d.cd.size(), d.c_deg.size(), d.gamma_deg.size());
  }
  for (std::size_t i = 0; i < d.cd.size(); ++i) {
    if (!finite(d.cd[i]) || d.cd[i] < 0.0) {
      return fmt::format("intensity {} at C {} gamma {}", d.cd[i], d.c_deg[i / d.gamma_deg.size()],
                         d.gamma_deg[i % d.gamma_deg.size()]);
    }
  }
  return {};
}

IntensityDistribution zero_distribution(std::vector<double> c_deg, std::vector<double> gamma_deg,
                                        FluxUnit unit) {
  IntensityDistribution d;
  d.cd.assign(c_deg.size() * gamma_deg.size(), 0.0);
  d.c_deg = std::move(c_deg);
  d.gamma_deg = std::move(gamma_deg);
  d.unit = unit;
  if (const std::string fault = grid_fault(d); !fault.empty()) throw InputError("intensity grid: " + fault);
  return d;
}

IntensityDistribution uniform_distribution(double c_step_deg, double gamma_step_deg, FluxUnit unit) {
  const std::size_t planes = c_step_deg == 0.0 ? 1 : steps(360.0, c_step_deg, "C");
  const std::size_t bands = steps(180.0, gamma_step_deg, "gamma");
  std::vector<double> c(planes), g(bands + 1);
  for (std::size_t i = 0; i < planes; ++i)
    c[i] = 360.0 * static_cast<double>(i) / static_cast<double>(planes);
  for (std::size_t i = 0; i <= bands; ++i) g[i] = 180.0 * static_cast<double>(i) / static_cast<double>(bands);
  return zero_distribution(std::move(c), std::move(g), unit);
}

double intensity_at(const IntensityDistribution& d, double c_deg, double gamma_deg) {
  const auto& g = d.gamma_deg;
  if (!(gamma_deg >= g.front() && gamma_deg <= g.back())) return 0.0;
  const auto above = std::upper_bound(g.begin(), g.end(), gamma_deg);
  const std::size_t g1 = std::min<std::size_t>(static_cast<std::size_t>(above - g.begin()), g.size() - 1);
  const std::size_t g0 = g1 - 1;
  const double tg = (gamma_deg - g[g0]) / (g[g1] - g[g0]);
  const auto along = [&](std::size_t plane) { return (1.0 - tg) * d.at(plane, g0) + tg * d.at(plane, g1); };
  if (d.c_deg.size() == 1) return along(0);
  double c = std::fmod(c_deg, 360.0);
  if (c < 0.0) c += 360.0;
  if (c >= 360.0) c = 0.0;
  const auto next = std::upper_bound(d.c_deg.begin(), d.c_deg.end(), c);
  const std::size_t c0 = static_cast<std::size_t>(next - d.c_deg.begin()) - 1;
  const std::size_t c1 = c0 + 1 == d.c_deg.size() ? 0 : c0 + 1;
  const double end = c1 == 0 ? 360.0 : d.c_deg[c1];
  const double tc = (c - d.c_deg[c0]) / (end - d.c_deg[c0]);
  return (1.0 - tc) * along(c0) + tc * along(c1);
}

double intensity_in(const IntensityDistribution& distribution, const Direction& direction) {
  const TypeCAngles angles = type_c_angles(direction);
  return intensity_at(distribution, degrees(angles.c_rad), std::min(180.0, degrees(angles.gamma_rad)));
}

void scale(IntensityDistribution& distribution, double factor) {
  for (double& value : distribution.cd) value *= factor;
}

}  // namespace lucerna
