// SPDX-License-Identifier: Apache-2.0
#include "lucerna/rayset/data/luminous_spectrum.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "lucerna/core/io/error.h"

namespace lucerna {

namespace {

constexpr double kFirst_nm = 380.0, kStep_nm = 5.0;
constexpr std::array<double, 81> kEfficiency{
    0.000039,  0.000064,  0.00012,  0.000217,  0.000396, 0.00064,   0.00121, 0.00218,   0.004,
    0.0073,    0.0116,    0.01684,  0.023,     0.0298,   0.038,     0.048,   0.06,      0.0739,
    0.09098,   0.1126,    0.13902,  0.1693,    0.20802,  0.2586,    0.323,   0.4073,    0.503,
    0.6082,    0.71,      0.7932,   0.862,     0.91485,  0.954,     0.9803,  0.99495,   1.0,
    0.995,     0.9786,    0.952,    0.9154,    0.87,     0.8163,    0.757,   0.6949,    0.631,
    0.5668,    0.503,     0.4412,   0.381,     0.321,    0.265,     0.217,   0.175,     0.1382,
    0.107,     0.0816,    0.061,    0.04458,   0.032,    0.0232,    0.017,   0.01192,   0.00821,
    0.005723,  0.004102,  0.002929, 0.002091,  0.001484, 0.001047,  0.00074, 0.00052,   0.0003611,
    0.0002492, 0.0001719, 0.00012,  0.0000848, 0.00006,  0.0000424, 0.00003, 0.0000212, 0.000015};
constexpr double kLast_nm = kFirst_nm + kStep_nm * (kEfficiency.size() - 1);

}  // namespace

double luminous_efficiency(double wavelength_nm) {
  if (!(wavelength_nm >= kFirst_nm && wavelength_nm <= kLast_nm)) return 0.0;
  const double at = (wavelength_nm - kFirst_nm) / kStep_nm;
  const auto below = std::min(static_cast<std::size_t>(at), kEfficiency.size() - 2);
  return std::lerp(kEfficiency[below], kEfficiency[below + 1], at - static_cast<double>(below));
}

void check_spectrum(const SpectralTable& spectrum, const std::string& what) {
  const auto& nm = spectrum.wavelength_nm;
  const auto& power = spectrum.relative_power;
  const auto fail = [&](const std::string& found) { throw InputError(fmt::format("{}: {}", what, found)); };
  if (nm.size() != power.size())
    fail(fmt::format("found {} wavelengths and {} powers, expected equally many", nm.size(), power.size()));
  for (std::size_t i = 0; i < nm.size(); ++i) {
    const double at = nm[i];
    if (!(at >= kShortest_nm && at <= kLongest_nm))
      fail(fmt::format("found {:g} nm, expected {:g} to {:g}", at, kShortest_nm, kLongest_nm));
    if (i > 0 && !(nm[i] > nm[i - 1]))
      fail(fmt::format("found {:g} nm after {:g}, expected wavelengths to ascend", at, nm[i - 1]));
    if (!(power[i] >= 0.0F && std::isfinite(power[i])))
      fail(fmt::format("found a power of {:g} at {:g} nm, expected a finite number >= 0", power[i], at));
  }
  if (!power.empty() && std::ranges::all_of(power, [](float p) { return p == 0.0F; }))
    fail("found no power above 0");
}

SpectralTable luminous_spectrum(const SpectralTable& power) {
  SpectralTable out;
  bool is_visible = false;
  const auto add = [&](double nm, double watts) {
    out.wavelength_nm.push_back(static_cast<float>(nm));
    out.relative_power.push_back(static_cast<float>(watts * luminous_efficiency(nm)));
    is_visible = is_visible || out.relative_power.back() > 0.0F;
  };
  for (std::size_t i = 0; i < power.wavelength_nm.size(); ++i) {
    const double nm = power.wavelength_nm[i], watts = power.relative_power[i];
    if (i > 0) {
      const double last_nm = power.wavelength_nm[i - 1], last_watts = power.relative_power[i - 1];
      // V is 0 beyond its table.
      const double first = std::max((std::floor(last_nm / kStep_nm) + 1.0) * kStep_nm, kFirst_nm - kStep_nm);
      for (double at = first; at < nm && at <= kLast_nm + kStep_nm; at += kStep_nm)
        add(at, std::lerp(last_watts, watts, (at - last_nm) / (nm - last_nm)));
    }
    add(nm, watts);
  }
  return power.wavelength_nm.size() > 1 && is_visible ? out : power;
}

}  // namespace lucerna
