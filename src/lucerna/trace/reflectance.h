// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace lucerna {

/// The share of light that a mirror returns: a number, or a table over the angle of incidence, linear in the
/// angle between its entries and constant beyond them. Thread safe.
class Reflectance {
 public:
  /// The same at every angle. Throws InputError unless it is in [0, 1].
  explicit Reflectance(double value);

  struct Entry {
    /// From the normal, [0, 90].
    double incidence_deg = 0.0;
    double value = 0.0;
  };
  /// Throws InputError unless angles ascend within [0, 90] and values are in [0, 1]; at least one entry.
  explicit Reflectance(std::vector<Entry> table);

  /// `cos_incidence` in [0, 1].
  double at(double cos_incidence) const {
    return table_.size() == 1 ? table_[0].value : interpolate(cos_incidence);
  }
  /// True if it does not depend on the angle.
  bool is_constant() const { return table_.size() == 1; }

 private:
  double interpolate(double cos_incidence) const;
  std::vector<Entry> table_;
};

}  // namespace lucerna
