// SPDX-License-Identifier: Apache-2.0
#include "lucerna/photometry/binning/node_errors.h"

#include <algorithm>
#include <cmath>

#include "lucerna/core/io/error.h"
#include "lucerna/photometry/binning/jackknife.h"

namespace lucerna {

namespace {

/// Rings to either side: five rings of three planes have 15 * 15 degrees of freedom, an error's error of 5 %.
constexpr std::size_t kRings = 2;

struct CellSums {
  double flux = 0.0, squares = 0.0;
};

}  // namespace

std::vector<double> pooled_errors(const IntensityDistribution& d, std::span<const double> variance,
                                  std::span<const double> solid_angle_sr,
                                  std::span<const std::size_t> pooled_planes) {
  const std::size_t planes = d.c_deg.size(), gammas = d.gamma_deg.size(), n = d.cd.size();
  LUCERNA_CHECK(variance.size() == n && solid_angle_sr.size() == n && pooled_planes.size() == gammas,
                "{} variances and {} solid angles for {} values", variance.size(), solid_angle_sr.size(), n);
  CellSums all;
  std::vector<CellSums> of(n);
  for (std::size_t i = 0; i < n; ++i) {
    of[i] = {d.cd[i] * solid_angle_sr[i], variance[i] * solid_angle_sr[i] * solid_angle_sr[i]};
    all.flux += of[i].flux;
    all.squares += of[i].squares;
  }
  std::vector<double> errors(n, 0.0);
  if (all.flux <= 0.0) return errors;
  for (std::size_t c = 0; c < planes; ++c) {
    for (std::size_t g = 0; g < gammas; ++g) {
      CellSums near;
      for (std::size_t k = g - std::min(g, kRings); k <= std::min(gammas - 1, g + kRings); ++k) {
        const std::size_t reach = std::min(std::max<std::size_t>(1, pooled_planes[k]), (planes - 1) / 2);
        // Values that were pooled from the same cells say the same.
        const double share = 1.0 / static_cast<double>(std::max<std::size_t>(1, 2 * pooled_planes[k]));
        for (std::size_t j = 0; j <= 2 * reach; ++j) {
          const CellSums& s = of[(c + planes - reach + j) % planes * gammas + k];
          near.flux += share * s.flux;
          near.squares += share * s.squares;
        }
      }
      const double ray =
          near.flux > 0.0 && near.squares > 0.0 ? near.squares / near.flux : all.squares / all.flux;
      const std::size_t i = c * gammas + g;
      errors[i] = error_of_rays(of[i].flux, ray) / solid_angle_sr[i];
    }
  }
  return errors;
}

}  // namespace lucerna
