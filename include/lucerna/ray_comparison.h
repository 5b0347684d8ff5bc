// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "lucerna/geometry.h"
#include "lucerna/rays.h"

#pragma GCC visibility push(default)
namespace lucerna {

/// The five ways in which light sources are compared (docs/theory/comparison.md).
enum class ViewKind { far, near, focus, beam, four_d };

/// All of them, in the order of ViewKind.
inline constexpr std::array<ViewKind, 5> kViewKinds{ViewKind::far, ViewKind::near, ViewKind::focus,
                                                    ViewKind::beam, ViewKind::four_d};

/// "far", "near", "focus", "beam", "four_d": the keys of the JSON results.
std::string_view to_string(ViewKind kind);

/// Where a light source is looked at from; all of it comes from the reference's rays.
struct ViewFrame {
  /// z is a, the flux-weighted mean direction (+z where its length is under 0.2); the origin is F, the
  /// virtual focus: the point with the least flux-weighted sum of squared distances to the rays' lines (the
  /// one nearest to the mean start where several are equal, as for parallel rays).
  Frame world_from_view;
  /// Radius about F that holds the starts of 98 % of the flux; 0 when they all are at F.
  double radius_mm = 0.0;
  /// z of the near plane in the view frame: 1 mm beyond the farthest start along a.
  double near_plane_mm = 1.0;
  /// Focal length of the collimator: 1.25 radius_mm, or as much more as clears every start.
  double focal_mm = 1.0;
};

/// A box of `dimensions` axes cut into equal cells, centred on the medians of the reference's flux and scaled
/// to hold 99 % of it. What lies outside is one more cell.
struct ViewWindow {
  /// 2, or 4 for ViewKind::four_d.
  std::size_t dimensions = 2;
  /// Bounds along each axis.
  std::array<double, 4> low{}, high{};
  /// Cells along each axis.
  std::array<std::size_t, 4> cells{1, 1, 1, 1};
};

/// The five views of one reference. Immutable once made; thread safe.
class Views {
 public:
  /// Largest number of rays that fix the windows and the radius (a stratified choice among more): 99 % to
  /// within 0.02 %.
  static constexpr std::size_t kWindowRays = std::size_t{1} << 18;

  /// Throws InputError when `reference` has no rays or no flux. Cost: about 0.5 s and 30 MB beside the rays.
  explicit Views(const RayBlock& reference);

  /// Where the source is observed from.
  const ViewFrame& frame() const { return frame_; }
  /// The window of one view and how it is cut into cells.
  const ViewWindow& window(ViewKind kind) const { return windows_[static_cast<std::size_t>(kind)]; }

  /// Cells of a view, the one for the rest among them (the last).
  std::size_t cell_count(ViewKind kind) const;

  /// The cell that a ray falls in, or nothing when the view does not see it: it leaves away from the near
  /// plane, runs parallel to the focus plane, starts outside the collimator or misses it.
  std::optional<std::size_t> cell(ViewKind kind, const Ray& ray) const;

  /// Coordinates of a ray in a view before they are cut into cells; `window(kind).dimensions` of them count.
  /// far: cosine to a, azimuth / 2 pi in [0, 1); near, focus: mm in the plane; beam: direction cosines of the
  /// reflected ray across a; four_d: focus-plane mm, then the ray's own direction cosines across a.
  std::optional<std::array<double, 4>> coordinates(ViewKind kind, const Ray& ray) const;

 private:
  ViewFrame frame_;
  Frame view_from_world_;
  std::array<ViewWindow, 5> windows_;
};

/// Weights that fell in the cells of the five views, of as many rays as were added. One thread at a time.
class ViewCounts {
 public:
  /// Empty counts for `views`, which must outlive them.
  explicit ViewCounts(const Views& views);

  /// Adds rays, on all threads; the same bits for any number of them. About 0.4 us a ray and thread. Rays
  /// that a view does not see count in the total that shares refer to, and in no cell.
  void add(const RayBlock& rays);

  /// The views that it was made for.
  const Views& views() const { return *views_; }
  /// Sum of the weights of all rays that were added, seen or not.
  double total_weight() const { return total_weight_; }
  /// Sum of weights per cell.
  const std::vector<double>& weights(ViewKind kind) const { return weights_[static_cast<std::size_t>(kind)]; }
  /// Sum of squared weights per cell.
  const std::vector<double>& squares(ViewKind kind) const { return squares_[static_cast<std::size_t>(kind)]; }

 private:
  const Views* views_;
  double total_weight_ = 0.0;
  std::array<std::vector<double>, 5> weights_, squares_;
};

/// How far a test is from its reference in one view; all relative to the l2 norm of the reference's shares.
struct ViewDifference {
  /// |p - q| / |p| with shares p of the reference and q of the test; what is seen, noise included.
  double error = 0.0;
  /// The counting noise of both sets: root of their summed squared weights.
  double floor = 0.0;
  /// sqrt(max(0, error^2 - floor^2)): the test's own error.
  double excess = 0.0;
  /// Standard error of `excess`: floor * (2 / cells)^(1/4) where the excess is small, with the number of
  /// cells that carry the noise; falls as 1 / excess where it is large.
  double standard_error = 0.0;
  /// The noise that the training rays have in this view: excess below raw means a model better than its rays.
  double raw = 0.0;
};

/// How far a test is from its reference in all five views.
struct RaySetComparison {
  /// By view.
  ViewDifference far, near, focus, beam, four_d;
  /// The difference of one view.
  const ViewDifference& operator[](ViewKind kind) const;
  /// The difference of one view, to write.
  ViewDifference& operator[](ViewKind kind);
};

/// Compares what was counted in one set of views. `training` (the rays that a model was made from) gives
/// `raw`; without it the reference is taken to be what the test was made from. Throws InputError when
/// reference or test has no flux.
[[nodiscard]] RaySetComparison compare_view_counts(const ViewCounts& reference, const ViewCounts& test,
                                                   const ViewCounts* training = nullptr);

/// The whole of it for rays in memory: views from `reference`, then all counts. Symmetric in nothing but the
/// noise.
[[nodiscard]] RaySetComparison compare_ray_sets(const RayBlock& reference, const RayBlock& test,
                                                const RayBlock* training = nullptr);

/// How far a test is from its reference in illuminance on the focus plane, in cells of one size. Light
/// outside the window, which in one cell would outweigh small ones, is left to the focus view.
struct ScaleDifference {
  /// Edge of the cells (root of their area): the window of the focus view, an edge of which is cut into 128,
  /// 64, 32, 16 or 8.
  double cell_mm = 0.0;
  /// As in a view.
  ViewDifference difference;
};

/// Illuminance where the lines cross the focus plane, in square cells, all of them however far out.
struct PlaneDifference {
  /// Side of the cells.
  double cell_um = 0.0;
  /// Sum of |q - p| over all cells, with shares p of the reference's and q of the test's flux: 0 equal, 2
  /// nothing in common.
  double l1 = 0.0;
  /// The same for all rays of both, dealt out anew at random to two sets of these sizes: what counting noise
  /// alone gives.
  double floor = 0.0;
};

/// Normalised cross-correlation of two pictures (Pearson's coefficient of their cells' shares): 1 where they
/// have the same pattern, whatever its scale.
struct CrossCorrelation {
  /// The coefficient.
  double value = 0.0;
  /// What counting noise leaves of 1 between two sets of the same source.
  double noise_limit = 1.0;
};

/// Of the near plane (32 x 32), a middle plane (64 x 64: as far beyond the near plane as three radii of the
/// source, at least 3 mm) and the far field (48 x 96): the set of measures of Rotscholl et al., Opt. Express
/// 24, A1597 (2016). Absent where the reference has nothing to see there.
struct FieldCorrelations {
  /// By plane.
  std::optional<CrossCorrelation> near, mid, far;
  /// z of the middle plane in the view frame.
  double mid_plane_mm = 0.0;
};
}  // namespace lucerna
#pragma GCC visibility pop
