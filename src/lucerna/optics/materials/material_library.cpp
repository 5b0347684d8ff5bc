// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <array>
#include <cmath>

#include "lucerna/core/io/error.h"
#include "lucerna/core/io/spelling.h"
#include "lucerna/optics/materials/dispersion.h"

namespace lucerna {

namespace {

// Numbers from the publications named below, as the refractiveindex.info database has them (public domain,
// CC0 1.0; M. Polyanskiy, Sci. Data 11, 94, 2024). Metals to four decimals, each 20 nm.
constexpr std::array<MetalRow, 21> kAluminium{{
    {0.38, 0.3360, 4.0026}, {0.4, 0.3752, 4.2264},  {0.42, 0.4176, 4.4474}, {0.44, 0.4642, 4.6691},
    {0.46, 0.5148, 4.8879}, {0.48, 0.5680, 5.1059}, {0.5, 0.6257, 5.3205},  {0.52, 0.6883, 5.5360},
    {0.54, 0.7545, 5.7465}, {0.56, 0.8292, 5.9582}, {0.58, 0.9086, 6.1652}, {0.6, 0.9925, 6.3690},
    {0.62, 1.0882, 6.5666}, {0.64, 1.1903, 6.7594}, {0.66, 1.3044, 6.9424}, {0.68, 1.4260, 7.1163},
    {0.7, 1.5598, 7.2739},  {0.72, 1.7068, 7.4142}, {0.74, 1.8722, 7.5284}, {0.76, 2.0542, 7.5995},
    {0.78, 2.2315, 7.6039},
}};
constexpr std::array<MetalRow, 21> kSilver{{
    {0.38, 0.0508, 1.8587}, {0.4, 0.0457, 2.1229},  {0.42, 0.0433, 2.3572}, {0.44, 0.0411, 2.5733},
    {0.46, 0.0410, 2.7770}, {0.48, 0.0408, 2.9722}, {0.5, 0.0414, 3.1594},  {0.52, 0.0424, 3.3421},
    {0.54, 0.0434, 3.5222}, {0.56, 0.0445, 3.6970}, {0.58, 0.0468, 3.8707}, {0.6, 0.0474, 4.0419},
    {0.62, 0.0496, 4.2090}, {0.64, 0.0516, 4.3768}, {0.66, 0.0534, 4.5431}, {0.68, 0.0542, 4.7059},
    {0.7, 0.0549, 4.8691},  {0.72, 0.0574, 5.0342}, {0.74, 0.0596, 5.1953}, {0.76, 0.0590, 5.3568},
    {0.78, 0.0635, 5.5130},
}};
constexpr std::array<SellmeierTerm, 3> kBk7{
    {{1.03961212, 0.00600069867}, {0.231792344, 0.0200179144}, {1.01046945, 103.560653}}};
constexpr std::array<SellmeierTerm, 3> kFusedSilica{{{0.6961663, 0.0684043 * 0.0684043},
                                                     {0.4079426, 0.1162414 * 0.1162414},
                                                     {0.8974794, 9.896161 * 9.896161}}};
constexpr std::array<SellmeierTerm, 1> kPolycarbonate{{{1.4182, 0.021304}}};
constexpr std::array<SellmeierTerm, 1> kSilicone{{{1.0093, 0.013185}}};
constexpr std::array<PowerTerm, 7> kPmmaSquared{{{2.1778, 0},
                                                 {6.1209e-3, 2},
                                                 {-1.5004e-3, 4},
                                                 {2.3678e-2, -2},
                                                 {-4.2137e-3, -4},
                                                 {7.3417e-4, -6},
                                                 {-4.5042e-5, -8}}};
constexpr std::array<PowerTerm, 3> kSodaLime{{{1.5130, 0}, {-0.003169, 2}, {0.003962, -2}}};

struct Material {
  MaterialInfo info;
  RefractiveIndex (*index_at)(double wavelength_um);
};

const std::array<Material, 8>& library() {
  constexpr const char* kMcPeak = "K. M. McPeak et al., ACS Photonics 2, 326-333 (2015)";
  static const std::array<Material, 8> all{{
      {{"aluminium", "evaporated film without a coat", kMcPeak, 380.0, 780.0, true},
       [](double w) { return interpolated(kAluminium, w); }},
      {{"silver", "evaporated film without a coat", kMcPeak, 380.0, 780.0, true},
       [](double w) { return interpolated(kSilver, w); }},
      {{"bk7", "SCHOTT N-BK7", "SCHOTT catalogue of 2017-01-20", 300.0, 2500.0, false},
       [](double w) { return RefractiveIndex{sellmeier_index(kBk7, w)}; }},
      {{"fused-silica", "fused silica, 20 degrees C", "I. H. Malitson, J. Opt. Soc. Am. 55, 1205-1208 (1965)",
        210.0, 3710.0, false},
       [](double w) { return RefractiveIndex{sellmeier_index(kFusedSilica, w)}; }},
      {{"pmma", "poly(methyl methacrylate), 20 degrees C",
        "G. Beadie et al., Appl. Opt. 54, F139-F143 (2015)", 420.0, 1620.0, false},
       [](double w) { return RefractiveIndex{std::sqrt(power_sum(kPmmaSquared, w))}; }},
      {{"polycarbonate", "polycarbonate, 20 degrees C",
        "N. Sultanova et al., Acta Phys. Pol. A 116, 585-587 (2009)", 437.0, 1052.0, false},
       [](double w) { return RefractiveIndex{sellmeier_index(kPolycarbonate, w)}; }},
      {{"silicone", "polydimethylsiloxane Sylgard 184",
        "F. Schneider et al., Sens. Actuators A 151, 95-99 (2009)", 350.0, 700.0, false},
       [](double w) { return RefractiveIndex{sellmeier_index(kSilicone, w)}; }},
      {{"soda-lime", "clear window glass", "M. Rubin, Sol. Energy Mater. 12, 275-288 (1985)", 310.0, 4600.0,
        false},
       [](double w) { return RefractiveIndex{power_sum(kSodaLime, w)}; }},
  }};
  return all;
}

}  // namespace

std::vector<MaterialInfo> materials() {
  std::vector<MaterialInfo> all;
  for (const Material& m : library()) all.push_back(m.info);
  return all;
}

namespace {

const Material& find(std::string_view material) {
  for (const Material& m : library()) {
    if (m.info.name == material) return m;
  }
  WordSet known;
  for (const Material& m : library()) known.insert(m.info.name);
  throw InputError(fmt::format("material '{}' is not known; the nearest known one is '{}'", material,
                               nearest_word(material, known)));
}

}  // namespace

RefractiveIndex refractive_index(std::string_view material, double wavelength_nm) {
  const Material& m = find(material);
  if (!(wavelength_nm >= m.info.min_nm && wavelength_nm <= m.info.max_nm)) {
    throw InputError(fmt::format("material '{}': found {} nm, expected {:g} to {:g} nm", material,
                                 wavelength_nm, m.info.min_nm, m.info.max_nm),
                     ErrorCause::out_of_range);
  }
  return m.index_at(1e-3 * wavelength_nm);
}

Dispersion dispersion(std::string_view material) {
  const Material& m = find(material);
  if (m.info.is_metal)
    throw InputError(fmt::format("material '{}' is a metal, expected a clear medium", material));
  return {m.info.min_nm, m.info.max_nm,
          each_nanometre(m.info.min_nm, m.info.max_nm, [&](double nm) { return m.index_at(1e-3 * nm).n; })};
}

}  // namespace lucerna
