// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <complex>

#include "lucerna/material.h"

namespace lucerna {

double fresnel_reflectance(double cos_incidence, const RefractiveIndex& medium) {
  if (medium.n == 1.0 && medium.k == 0.0) return 0.0;  // no boundary; 0 / 0 at grazing incidence
  const double c = std::clamp(cos_incidence, 0.0, 1.0);
  const std::complex<double> index(medium.n, medium.k), squared = index * index;
  // Normal component of the wave vector inside, over that in vacuum.
  const std::complex<double> inside = std::sqrt(squared - (1.0 - c * c));
  const double s = std::norm((c - inside) / (c + inside));
  const double p = std::norm((squared * c - inside) / (squared * c + inside));
  return 0.5 * (s + p);
}

}  // namespace lucerna
