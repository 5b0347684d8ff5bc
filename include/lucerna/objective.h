// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lucerna/progress.h"
#include "lucerna/project.h"
#include "lucerna/reflector.h"

#pragma GCC visibility push(default)
namespace lucerna {

/// How an Objective looks at its problem.
struct ObjectiveOptions {
  /// Rays of every evaluation: the same ones each time, so that it is a smooth function of the parameters but
  /// where rays cross a rim. Rounded up to a multiple of 8192; > 0.
  std::uint64_t rays = std::uint64_t{1} << 18;
  /// Of these rays.
  std::uint64_t seed = 1;
  /// Width of the strip within the mirror's rims from which the derivatives estimate the light that crosses
  /// the rims as the surface moves. 0 leaves that out: the derivatives are then exactly those of the sums
  /// over the given rays. >= 0; absent: 2 % of the mirror's radius, which fits converge better with.
  std::optional<double> rim_mm;
};

/// A design problem at one set of parameters.
struct ObjectiveValue {
  /// See Objective; dimensionless.
  std::vector<double> residuals;
  /// d residual / d parameter, 1/mm, row by row: residuals.size() x parameter count. Empty unless asked for.
  std::vector<double> jacobian;
  /// Of the light in the bins, without limits: root of the weighted sum of squared differences over that of
  /// the target; and what the counting noise alone makes of it.
  double relative_rms = 0.0, floor = 0.0;
  /// What the light is multiplied by to stand beside the target: 1 in absolute mode.
  double scale = 1.0;
  /// Share of the sources' flux that leaves the luminaire.
  double efficiency = 0.0;
};

/// The design problem of a project as a function for any least-squares solver: residuals of a mirror's light
/// against the target, with their exact pathwise derivatives through all reflections.
///
/// Parameters are heights in mm of the mirror's coefficients over its paraboloid. Residuals, in this order:
/// one for each smooth bin over the target's window (48 x 48 tents; 48 rings for a mirror of revolution), (s
/// F - T) / sqrt(Omega) over the norm of T / sqrt(Omega), with the flux F that the mirror puts into the bin,
/// the target's T, the bin's solid angle (or area) Omega, and s the best scale in shape mode (whose
/// derivative is in the Jacobian), 1 in absolute mode; in shape mode one for light that misses the window;
/// where the project has [design.limits], one that is the root of what breaking them costs, 0 where all hold.
/// The sum of the squares of the first is the squared relative RMS error. Zones of the target have no
/// residuals.
///
/// Immutable; thread safe. Memory: 28 bytes a ray.
class Objective {
 public:
  /// Draws the rays. `name` is what messages call the project. Throws InputError as `design` does, on a
  /// project that has zones alone as its target, and on numbers out of range. Progress phase "rays".
  Objective(Project project, const std::string& name, const ObjectiveOptions& options = {},
            Progress& progress = no_progress());
  ~Objective();
  /// Takes the problem of another, which may then only be destroyed or assigned to.
  Objective(Objective&&) noexcept;
  /// Likewise.
  Objective& operator=(Objective&&) noexcept;

  /// How many parameters there are.
  std::size_t parameter_count() const;
  /// How many residuals there are.
  std::size_t residual_count() const;
  /// The parameters of the mirror to begin with.
  std::vector<double> start() const;

  /// At `parameters`: parameter_count() finite numbers, else InputError. Uses all threads; about a
  /// microsecond a ray and core with the derivatives, half of that without.
  [[nodiscard]] ObjectiveValue at(std::span<const double> parameters, bool jacobian = true) const;

  /// The mirror of `parameters` in its own frame. Errors as above.
  [[nodiscard]] Reflector reflector(std::span<const double> parameters) const;
  /// The project with that mirror, as text that `parse_project` reads.
  [[nodiscard]] std::string project_text(std::span<const double> parameters) const;

 private:
  struct Problem;
  std::unique_ptr<const Problem> problem_;
};

}  // namespace lucerna
#pragma GCC visibility pop
