// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "lucerna/bsdf.h"
#include "lucerna/geometry.h"
#include "lucerna/trace/kernels/bsdf_kernel.h"

namespace lucerna {

/// A measured table, ready to be drawn from. Immutable and thread safe.
class MeasuredScatter {
 public:
  /// Throws InputError as Scatter does. 64 to 1024 evaluations a cell.
  explicit MeasuredScatter(const BsdfTable& table);
  MeasuredScatter(const MeasuredScatter&) = delete;
  MeasuredScatter& operator=(const MeasuredScatter&) = delete;

  /// Valid as long as this lives.
  const BsdfView& view() const { return view_; }
  /// Of light that the surface returns, by solid angle, what goes from `mirrored` to `out`, 1/sr; both above
  /// the surface of `normal`.
  double density(const Direction& normal, const Direction& mirrored, const Direction& out) const;
  /// What the table's values add up to at each incidence: a reflectance.
  const std::vector<double>& integrals() const { return integrals_; }

 private:
  static constexpr int kShifts = 40;

  /// Of the table of one incidence for light of another; `out` by the cosines along the surface's axes.
  double density(std::int32_t slice, double incidence, const Vec3& out) const;
  /// What the values of a table add up to, each times the spread of the shift.
  double spread_light(std::int32_t slice, const BsdfShift& shift) const;

  std::vector<double> incidence_, azimuth_, radial_, brdf_, sums_, integrals_;
  /// Of these.
  BsdfView view_;
  /// By incidence and shift; made where `density` asks for it, which tracing does not.
  mutable std::vector<std::array<double, kShifts + 1>> spread_;
  std::unique_ptr<std::once_flag[]> made_;
};

}  // namespace lucerna
