// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "lucerna/flux_unit.h"
#include "lucerna/geometry.h"
#include "lucerna/photometry/binning/jackknife.h"

namespace lucerna {

/// No kernel looks further along C than this.
inline constexpr double kWidestKernelC_deg = 30.0;

/// How far a kernel about a direction reaches, in degrees.
struct Kernel {
  double radius_deg = 0.0;
  /// Along C, where the light changes less that way than along gamma; at least `radius_deg`. No further than
  /// 30 degrees of C: about the poles a kernel is round.
  double c_radius_deg = 0.0;

  explicit Kernel(double radius, double along_c = 0.0)
      : radius_deg(radius), c_radius_deg(along_c > radius ? along_c : radius) {}
};

/// A quadratic through the intensities about a direction: sum of coefficients times 1, x, y, x^2, x y, y^2.
/// x and y are the place along C and along gamma in units of the kernel's radii: on the sphere where it is
/// round, else the angle C times the sine of the centre's gamma, so that it follows a ring of light.
struct LocalFit {
  TypeCAngles centre;
  double x_radius_rad = 1.0, y_radius_rad = 1.0;
  bool round = true;
  std::array<Jackknife, 6> coefficients;

  /// Intensity at (x, y), |x|, |y| <= 1.
  Jackknife at(double x, double y) const;
  /// The direction of (x, y).
  Direction direction(double x, double y) const;
};

/// Flux on the whole sphere in equal steps of C and gamma, as a trace has counted it, with what the run is
/// without each replicate; the intensity about any direction is estimated from as many cells as are asked
/// for, so the estimate does not know the poles of the grid. Cells are centred on C 0, step, ... and gamma
/// 0, step, ..., 180; numbered c * gammas + gamma; those of the first and last gamma are half cells.
/// Thread safe.
class CountedSphere {
 public:
  /// Throws InputError unless `flux` has planes * gammas cells, at least 1 * 3. `tent`: the flux was dealt to
  /// the angles by tents (intensity_from_tents). Planes further apart than 5 degrees are cut, their flux
  /// taken as even: for a grid that asks for few planes, what lies between them is not known.
  CountedSphere(std::size_t planes, std::size_t gammas, FluxUnit unit, const JackknifedFlux& flux,
                bool tent = false);

  FluxUnit unit() const { return unit_; }
  std::size_t replicates() const { return flux_.replicates(); }
  /// The smallest radius of a kernel that the steps of gamma allow. A kernel that spans too few planes is
  /// widened along C alone.
  double resolution_deg() const;
  /// The radius below which the kernel of `mean_cd` is widened along C at a direction.
  double resolution_along_c_deg(const Direction& direction) const;

  /// Mean intensity by the kernel 1 - (angle / radius)^2; its bias is radius^2 / 12 times the Laplacian of
  /// the intensity. O(cells within the radius). 0 where there are none.
  Jackknife mean_cd(const Direction& direction, const Kernel& kernel) const;
  /// The same of the whole run alone.
  double mean_of_all_cd(const Direction& direction, const Kernel& kernel) const {
    return mean_cd_of(all_, direction, kernel);
  }
  /// The same of other flux of the cells.
  double mean_cd_of(std::span<const double> flux, const Direction& direction, const Kernel& kernel) const;
  /// Flux of the cells as half of the replicates have it (half_estimate).
  std::vector<double> half_of_flux(bool odd) const;
  /// Least squares with the same kernel: what is left of the bias is of the fourth order.
  LocalFit fit(const Direction& direction, const Kernel& kernel) const;

  /// Flux with `from` <= gamma < `to`; of a row of cells that is cut the share of its solid angle.
  Jackknife zone_flux(double from_deg, double to_deg) const;
  /// The part of `zone_flux` within 90 degrees of the plane `c_deg` in C.
  Jackknife half_zone_flux(double from_deg, double to_deg, double c_deg) const;

 private:
  /// The kernel at one direction: what it spans there.
  struct Window {
    TypeCAngles at;
    Vec3 centre, to_c, to_gamma;
    double high_rad, wide_rad;
    bool round;
  };
  Window window(const Direction& direction, const Kernel& kernel, double planes) const;
  /// `visit(cell, gamma, x, y, weight)` for every cell under it; x along C and y along gamma, in radii.
  template <class Visit>
  void for_cells_in(const Window& w, const Visit& visit) const;
  template <class Visit>
  void for_cells_of_row(const Window& w, std::size_t g, double half_c_rad, const Visit& visit) const;
  template <class Share>
  Jackknife band_flux(double from_deg, double to_deg, const Share& share_of_plane) const;

  std::size_t planes_ = 0, gammas_ = 0;
  FluxUnit unit_;
  double c_step_rad_ = 0.0, gamma_step_rad_ = 0.0;
  /// Of each row: where its cells' centroids are and how large they are; of each plane: its direction.
  std::vector<double> gamma_rad_, cos_gamma_, sin_gamma_, solid_angle_sr_, cos_c_, sin_c_;
  JackknifedFlux flux_;
  /// The whole run's, by itself: searches read nothing else.
  std::vector<double> all_;
};

}  // namespace lucerna
