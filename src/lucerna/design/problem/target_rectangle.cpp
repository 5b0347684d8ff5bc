// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/problem/target_rectangle.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "lucerna/core/io/error.h"
#include "lucerna/design/problem/target.h"
#include "lucerna/intensity.h"

namespace lucerna {

namespace {

/// Share of the flux that is cut off at each side.
constexpr double kCut = 0.0025;
/// A rectangle is never narrower, so that boxes keep a size that float32 directions resolve.
constexpr double kMinSide = 1e-4;

/// Cells of a marginal over direction cosines: far below the boxes of a narrow spot.
constexpr std::size_t kCosineCells = std::size_t{1} << 16;

/// The flux by one coordinate in fine cells over a range.
class Marginal {
 public:
  Marginal(double from, double to, std::size_t cells) : from_(from), to_(to), flux_(cells, 0.0) {}

  void add(double x, double flux) {
    const auto n = static_cast<double>(flux_.size());
    const double cell = (x - from_) / (to_ - from_) * n;
    flux_[static_cast<std::size_t>(std::clamp(cell, 0.0, n - 1.0))] += flux;
    total_ += flux;
  }

  /// Below which `share` of the flux lies; linear within a cell.
  double quantile(double share) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < flux_.size(); ++i) {
      if (sum + flux_[i] < share * total_ || flux_[i] == 0.0) {
        sum += flux_[i];
        continue;
      }
      const double part = std::clamp((share * total_ - sum) / flux_[i], 0.0, 1.0);
      return from_ + (to_ - from_) * (static_cast<double>(i) + part) / static_cast<double>(flux_.size());
    }
    return to_;
  }
  double total() const { return total_; }

 private:
  double from_, to_, total_ = 0.0;
  std::vector<double> flux_;
};

/// Calls `add(direction, flux)` for small patches that cover the table's angles: at most a quarter of a
/// degree of gamma and one degree of C, and at least two a table's step.
template <class Add>
void for_patches(const IntensityDistribution& d, const Add& add) {
  const auto pieces = [](double step_deg, double max_deg) {
    return std::max(2, static_cast<int>(std::ceil(step_deg / max_deg)));
  };
  for (std::size_t c = 0; c < d.c_deg.size(); ++c) {
    const std::size_t next = c + 1 == d.c_deg.size() ? 0 : c + 1;
    const double width = (next == 0 ? 360.0 : d.c_deg[next]) - d.c_deg[c];
    const int nc = pieces(width, 1.0);
    for (std::size_t g = 0; g + 1 < d.gamma_deg.size(); ++g) {
      const double height = d.gamma_deg[g + 1] - d.gamma_deg[g];
      const int ng = pieces(height, 0.25);
      const double corner[4] = {d.at(c, g), d.at(c, g + 1), d.at(next, g), d.at(next, g + 1)};
      if (corner[0] + corner[1] + corner[2] + corner[3] == 0.0) continue;
      for (int j = 0; j < ng; ++j) {
        const double tg = (j + 0.5) / ng, gamma = radians(d.gamma_deg[g] + tg * height);
        const double near = (1.0 - tg) * corner[0] + tg * corner[1];
        const double far = (1.0 - tg) * corner[2] + tg * corner[3];
        const double sr = std::sin(gamma) * radians(height / ng) * radians(width / nc);
        for (int i = 0; i < nc; ++i) {
          const double tc = (i + 0.5) / nc;
          add(direction_from_type_c({radians(d.c_deg[c] + tc * width), gamma}),
              sr * ((1.0 - tc) * near + tc * far));
        }
      }
    }
  }
}

/// The luminaire's axis nearest to a vector, with the two others as x and y; nadir where several are as near.
Frame nearest_axis(const Vec3& mean) {
  const Frame axes[] = {{{1, 0, 0}, {0, -1, 0}, {0, 0, -1}, {}}, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {}},
                        {{0, 1, 0}, {0, 0, 1}, {1, 0, 0}, {}},   {{0, 1, 0}, {0, 0, -1}, {-1, 0, 0}, {}},
                        {{1, 0, 0}, {0, 0, -1}, {0, 1, 0}, {}},  {{1, 0, 0}, {0, 0, 1}, {0, -1, 0}, {}}};
  const double margin = 1e-9 * length(mean);
  const Frame* best = &axes[0];
  for (const Frame& axis : axes) {
    if (dot(axis.ez(), mean) > dot(best->ez(), mean) + margin) best = &axis;
  }
  return *best;
}

void set_sides(TargetRectangle& rectangle, const Marginal& u, const Marginal& v, double min_side) {
  const auto sides = [&](const Marginal& m, double& low, double& high) {
    low = m.quantile(kCut);
    high = m.quantile(1.0 - kCut);
    const double missing = 0.5 * std::max(0.0, min_side - (high - low));
    low -= missing;
    high += missing;
  };
  sides(u, rectangle.u_min, rectangle.u_max);
  sides(v, rectangle.v_min, rectangle.v_max);
}

}  // namespace

TargetRectangle target_rectangle(const IntensityDistribution& target) {
  if (const std::string fault = grid_fault(target); !fault.empty()) throw InputError("target: " + fault);
  Vec3 mean;
  for_patches(target, [&](const Direction& d, double flux) { mean += flux * d.vec(); });
  TargetRectangle rectangle;
  rectangle.world_from_rectangle = nearest_axis(mean);
  const Frame& axes = rectangle.world_from_rectangle;
  Marginal u(-1.0, 1.0, kCosineCells), v(-1.0, 1.0, kCosineCells);
  for_patches(target, [&](const Direction& d, double flux) {
    if (dot(d, axes.ez()) <= 0.0) return;
    u.add(dot(d, axes.ex()), flux);
    v.add(dot(d, axes.ey()), flux);
  });
  if (!(u.total() > 0.0 && std::isfinite(u.total()))) throw InputError("target: has no light");
  set_sides(rectangle, u, v, kMinSide);
  rectangle.u_min = std::max(rectangle.u_min, -1.0);
  rectangle.u_max = std::min(rectangle.u_max, 1.0);
  rectangle.v_min = std::max(rectangle.v_min, -1.0);
  rectangle.v_max = std::min(rectangle.v_max, 1.0);
  return rectangle;
}

TargetRectangle target_rectangle(const PlaneTarget& target) {
  constexpr int kPlaces = 1024;  // in the centres of the marginals' cells
  const double half_x = 0.5 * target.size_x_mm, half_y = 0.5 * target.size_y_mm;
  Marginal u(-half_x, half_x, kPlaces), v(-half_y, half_y, kPlaces);
  for (int j = 0; j < kPlaces; ++j) {
    const double y = half_y * ((2.0 * j + 1.0) / kPlaces - 1.0);
    for (int i = 0; i < kPlaces; ++i) {
      const double x = half_x * ((2.0 * i + 1.0) / kPlaces - 1.0), flux = target.at(x, y);
      u.add(x, flux);
      v.add(y, flux);
    }
  }
  if (!(u.total() > 0.0 && std::isfinite(u.total()))) throw InputError("target: has no light");
  TargetRectangle rectangle;
  rectangle.world_from_rectangle = target.world_from_plane;
  rectangle.is_plane = true;
  set_sides(rectangle, u, v, kMinSide * std::min(half_x, half_y));
  return rectangle;
}

TargetRectangle target_rectangle(const DesignTarget& target) {
  return target.plane ? target_rectangle(*target.plane) : target_rectangle(target.distribution);
}

}  // namespace lucerna
