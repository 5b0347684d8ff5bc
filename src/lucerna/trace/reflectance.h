// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include "lucerna/core/direction.h"
#include "lucerna/core/host_device.h"

namespace lucerna {

/// One entry of a table of reflectance over the angle of incidence.
struct ReflectanceEntry {
  /// From the normal, [0, 90].
  double incidence_deg = 0.0;
  double value = 0.0;
};

/// The table's value at `cos_incidence` in [0, 1]; at least one entry.
LUCERNA_HD inline double reflectance_at(const ReflectanceEntry* table, std::size_t n, double cos_incidence) {
  if (n == 1) return table[0].value;
  const double cosine = cos_incidence < 0.0 ? 0.0 : cos_incidence > 1.0 ? 1.0 : cos_incidence;
  const double angle = degrees(std::acos(cosine));
  std::size_t after = 0;
  while (after < n && !(angle < table[after].incidence_deg)) ++after;
  if (after == 0) return table[0].value;
  const ReflectanceEntry& a = table[after - 1];
  if (after == n) return a.value;
  const ReflectanceEntry& b = table[after];
  return a.value + (b.value - a.value) * (angle - a.incidence_deg) / (b.incidence_deg - a.incidence_deg);
}

/// The share of light that a mirror returns: a number, or a table over the angle of incidence, linear in the
/// angle between its entries and constant beyond them. Thread safe.
class Reflectance {
 public:
  /// The same at every angle. Throws InputError unless it is in [0, 1].
  explicit Reflectance(double value);

  using Entry = ReflectanceEntry;
  /// Throws InputError unless angles ascend within [0, 90] and values are in [0, 1]; at least one entry.
  explicit Reflectance(std::vector<Entry> table);

  /// `cos_incidence` in [0, 1].
  double at(double cos_incidence) const {
    return reflectance_at(table_.data(), table_.size(), cos_incidence);
  }
  /// The largest value at any angle.
  double greatest() const;
  /// The same over the angle with `change` added to every value, within [0, 1].
  Reflectance shifted(double change) const;
  /// True if it does not depend on the angle.
  bool is_constant() const { return table_.size() == 1; }
  const std::vector<Entry>& table() const { return table_; }

 private:
  std::vector<Entry> table_;
};

}  // namespace lucerna
