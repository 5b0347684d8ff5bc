// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <utility>

#include "lucerna/core/io/error.h"
#include "lucerna/material.h"
#include "lucerna/scene.h"

namespace lucerna {

Reflectance::Reflectance(double value) : Reflectance(std::vector<Entry>{{0.0, value}}) {}

Reflectance::Reflectance(std::vector<Entry> table) : table_(std::move(table)) {
  if (table_.empty()) throw InputError("reflectance: the table is empty, expected at least one entry");
  double before = -1.0;
  for (const Entry& e : table_) {
    if (!(e.value >= 0.0 && e.value <= 1.0)) {
      throw InputError(fmt::format("reflectance: {} is outside 0..1", e.value));
    }
    if (!(e.incidence_deg > before && e.incidence_deg >= 0.0 && e.incidence_deg <= 90.0)) {
      throw InputError(fmt::format("reflectance: angle {} degrees, expected angles ascending within 0..90",
                                   e.incidence_deg));
    }
    before = e.incidence_deg;
  }
}

double Reflectance::max() const {
  double max = 0.0;
  for (const Entry& e : table_) max = std::max(max, e.value);
  return max;
}

Reflectance Reflectance::shifted(double change) const {
  std::vector<Entry> table = table_;
  for (Entry& e : table) e.value = std::clamp(e.value + change, 0.0, 1.0);
  return Reflectance(std::move(table));
}

Reflectance metal_reflectance(std::string_view material, double wavelength_nm) {
  const RefractiveIndex index = refractive_index(material, wavelength_nm);
  if (index.k == 0.0) throw InputError(fmt::format("material '{}' is clear, expected a metal", material));
  std::vector<ReflectanceEntry> table;
  // The reflectance bends most towards grazing incidence.
  for (double deg = 0.0; deg <= 90.0; deg += deg < 50.0 ? 5.0 : deg < 70.0 ? 2.0 : deg < 80.0 ? 1.0 : 0.5) {
    const double cosine = deg < 90.0 ? std::cos(radians(deg)) : 0.0;
    table.push_back({deg, std::min(1.0, fresnel_reflectance(cosine, index))});
  }
  return Reflectance(std::move(table));
}

}  // namespace lucerna
