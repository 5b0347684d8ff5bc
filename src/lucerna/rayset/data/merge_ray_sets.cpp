// SPDX-License-Identifier: Apache-2.0
#include "lucerna/rayset/data/merge_ray_sets.h"

#include <numeric>

#include "lucerna/core/io/error.h"

namespace lucerna {

namespace {

/// Scales the weights so that they sum to the stated flux.
void weights_to_flux(RaySet& set) {
  const double sum = std::accumulate(set.rays.weight.begin(), set.rays.weight.end(), 0.0);
  if (!(sum > 0.0)) return;
  const auto factor = static_cast<float>(*set.header.flux() / sum);
  for (float& weight : set.rays.weight) weight *= factor;
}

void drop_columns(RaySet& set) {
  set.header.columns.clear();
  set.header.spectra.clear();
  set.header.wavelength_nm.reset();
  set.rays.extra.clear();
}

}  // namespace

void merge_ray_sets(RaySet& all, RaySet other, const std::string& name) {
  if (!other.header.flux()) {
    throw InputError(fmt::format("{}: states no total flux, which adding ray sets needs", name));
  }
  if (all.rays.empty()) {
    all = std::move(other);
    return;
  }
  if (all.header.flux_unit != other.header.flux_unit) {
    throw InputError(fmt::format("{}: carries {}, the sets before it {}; lumen and watt are never mixed",
                                 name, symbol(other.header.flux_unit), symbol(all.header.flux_unit)));
  }
  const bool same_columns = all.header.columns == other.header.columns &&
                            all.header.spectra == other.header.spectra &&
                            all.header.wavelength_nm == other.header.wavelength_nm;
  if (!same_columns) {
    drop_columns(all);
    drop_columns(other);
  }
  weights_to_flux(all);
  weights_to_flux(other);
  all.rays.append(other.rays);
  all.header.set_flux(*all.header.flux() + *other.header.flux());
}

}  // namespace lucerna
