// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <vector>

#include "lucerna/design/evaluation/tent_view.h"
#include "lucerna/geometry.h"

namespace lucerna {

/// Smooth bins over the light that leaves: bilinear tents at the centres of equal cells, so that what a bin
/// holds changes continuously, and almost everywhere differentiably, with every ray. Four kinds: a square of
/// direction cosines (u, v) about an axis; the angle gamma from the axis alone, for surfaces of revolution; a
/// rectangle of a plane that the light falls on; and a zone of (gamma, C) about an axis, for limits on glare.
/// Light outside fades out over one cell beyond the outermost centres. Immutable, thread safe.
class TentBins {
 public:
  /// count x count bins over |u|, |v| <= half_width (0 < half_width <= 1); `axes` maps the window's frame
  /// (its z is the axis) into the frame of the directions that will be binned.
  static TentBins square(const Frame& axes, double half_width, int count);
  /// Squares of direction cosines over the whole hemisphere about the axis, or of a plane (`half_x_mm`,
  /// `half_y_mm` are the units of its coordinates): fine over a window, growing outwards. Both axes have the
  /// same number of cells.
  static TentBins graded(const Frame& axes, const TentAxis& u, const TentAxis& v);
  static TentBins graded_plane(const Frame& axes, double half_x_mm, double half_y_mm, const TentAxis& u,
                               const TentAxis& v);
  /// `count` bins over [0, gamma_max_rad], gamma_max <= pi.
  static TentBins rings(const Frame& axes, double gamma_max_rad, int count);
  /// count x count bins over |x| <= half_x_mm, |y| <= half_y_mm of the xy plane of `axes`; light counts that
  /// falls on the side its z points to. `widen` scales both.
  static TentBins plane(const Frame& axes, double half_x_mm, double half_y_mm, int count, double widen = 1.0);
  /// `rings` x `sectors` bins over gamma in [gamma_min_rad, pi] and all C (from x towards y of `axes`); the
  /// outermost tents end where the zone ends. 0 <= gamma_min < pi.
  static TentBins zone(const Frame& axes, double gamma_min_rad, int rings, int sectors);

  bool is_rings() const { return view_.is_rings(); }
  bool is_plane() const { return view_.kind == TentKind::plane; }
  int count() const { return view_.count; }
  std::size_t size() const { return measure_.size(); }
  const Frame& axes() const { return view_.axes; }
  /// Whether a bin lies in the window, not in the cells that grow around it.
  bool in_window(std::size_t bin) const {
    const auto n = static_cast<std::size_t>(view_.count);
    return inside(view_.axis_u, bin % n) && inside(view_.axis_v, bin / n);
  }
  /// Half width in direction cosines, the largest gamma in radians, or what a plane was widened by.
  double extent() const { return view_.extent; }
  double half_x_mm() const { return view_.half_x_mm; }
  double half_y_mm() const { return view_.half_y_mm; }
  /// Integral of a bin's tent over solid angle in sr, or over the plane's area in mm2; 0 for squares wholly
  /// beyond the horizon.
  const std::vector<double>& measure() const { return measure_; }

  /// Integral of intensity * tent over solid angle for every bin (8 x 8 points per cell; 64 circles per ring,
  /// 360 points each): the flux that an intensity function puts into the bins. Not for planes. Calls
  /// `intensity` from several threads where bins are rings.
  std::vector<double> flux_of(const std::function<double(const Direction&)>& intensity) const;
  /// Integral of a density over (x, y) in mm * tent over the plane's area in mm2 (8 x 8 points per cell).
  std::vector<double> flux_on(const std::function<double(double x_mm, double y_mm)>& density_per_mm2) const;

  /// See tent_view.h.
  using Deposit = TentDeposit;
  using Gradient = TentGradient;
  void deposit(const Vec3& origin, const Vec3& direction, Deposit& out) const {
    view_.deposit(origin, direction, out);
  }
  Gradient gradient_u(const Vec3& origin, const Vec3& direction) const {
    return view_.gradient_u(origin, direction);
  }
  Gradient gradient_v(const Vec3& origin, const Vec3& direction) const {
    return view_.gradient_v(origin, direction);
  }
  /// All but the measure, as a GPU reads it.
  const TentBinsView& view() const { return view_; }

 private:
  TentBins(TentKind kind, const Frame& axes, double extent, int count);
  static bool inside(const TentAxis& axis, std::size_t i) {
    return axis.outer == 0 ||
           (i >= static_cast<std::size_t>(axis.outer) &&
            i < static_cast<std::size_t>(axis.outer) + static_cast<std::size_t>(axis.inner));
  }
  /// Points of a grid with `fine` to a cell along each axis, half a cell beyond the outermost, with their
  /// areas.
  void over_grid(int fine, const std::function<void(double u, double v, double area)>& visit) const;
  void set_axes(const TentAxis& u, const TentAxis& v);
  std::vector<double> flux_of_rings(const std::function<double(const Direction&)>& intensity) const;

  TentBinsView view_;
  std::vector<double> measure_;
};

/// Middle of a bin as a direction in the mirror's frame; for a plane as seen from `from_mm`, for rings at C0.
Direction bin_direction(const TentBins& bins, std::size_t i, const Vec3& from_mm);

}  // namespace lucerna
