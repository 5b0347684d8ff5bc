// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/reflectance.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lucerna/core/direction.h"
#include "lucerna/core/error.h"

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

double Reflectance::interpolate(double cos_incidence) const {
  const double angle = degrees(std::acos(std::clamp(cos_incidence, 0.0, 1.0)));
  const auto after = std::upper_bound(table_.begin(), table_.end(), angle,
                                      [](double a, const Entry& e) { return a < e.incidence_deg; });
  if (after == table_.begin()) return after->value;
  const Entry& a = *(after - 1);
  if (after == table_.end()) return a.value;
  return a.value +
         (after->value - a.value) * (angle - a.incidence_deg) / (after->incidence_deg - a.incidence_deg);
}

}  // namespace lucerna
