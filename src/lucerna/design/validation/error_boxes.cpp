// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/validation/error_boxes.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "lucerna/core/io/error.h"
#include "lucerna/core/parallel/parallel.h"

namespace lucerna {

namespace {

/// Cells a side of the outer grid, at most.
constexpr double kMaxOuter = 256.0;
/// Cells with less of a whole cell's measure are slivers.
constexpr double kSliver = 0.01;
/// Cells that are integrated at a time.
constexpr std::size_t kTask = 64;

/// Gauss-Legendre on [0, 1], four points.
constexpr std::array<double, 4> kNode{0.06943184420297371, 0.33000947820757187, 0.66999052179242813,
                                      0.93056815579702629};
constexpr std::array<double, 4> kWeight{0.17392742256872693, 0.32607257743127307, 0.32607257743127307,
                                        0.17392742256872693};

/// Calls f(x, weight) at the nodes of `pieces` equal pieces of [a, b].
template <class F>
void for_nodes(double a, double b, int pieces, const F& f) {
  const double h = (b - a) / pieces;
  for (int k = 0; k < pieces; ++k) {
    for (std::size_t i = 0; i < kNode.size(); ++i) f(a + (k + kNode[i]) * h, kWeight[i] * h);
  }
}

/// Where [u0, u1] is cut so that the boundaries v0 and v1 cross the horizon only at ends of pieces.
std::vector<double> cuts(double u0, double u1, double v0, double v1) {
  std::vector<double> at{std::max(u0, -1.0), std::min(u1, 1.0)};
  if (at[0] >= at[1]) return {};
  for (const double v : {v0, v1}) {
    if (std::abs(v) >= 1.0) continue;
    for (const double u : {-std::sqrt(1.0 - v * v), std::sqrt(1.0 - v * v)}) {
      if (u > at[0] && u < at[1]) at.push_back(u);
    }
  }
  std::sort(at.begin(), at.end());
  return at;
}

int pieces_for(double width, double step) {
  return static_cast<int>(std::clamp(std::ceil(2.0 * width / step), 1.0, 8.0));
}

}  // namespace

ErrorBoxes::ErrorBoxes(const TargetRectangle& rectangle)
    : rectangle_(rectangle),
      step_u_(rectangle.width() / kErrorBoxes),
      step_v_(rectangle.height() / kErrorBoxes) {
  LUCERNA_CHECK(step_u_ > 0.0 && step_v_ > 0.0, "a target rectangle of {} x {}", rectangle.width(),
                rectangle.height());
  set_outer_grid();
  if (rectangle_.is_plane) {
    measure_.assign(kInside + columns_ * rows_ + 1, step_u_ * step_v_);
    for (std::size_t c = 0; c < columns_ * rows_; ++c) {
      if (in_rectangle(outer_range(c % columns_, c / columns_))) measure_[kInside + c] = 0.0;
    }
    measure_.back() = 0.0;
    return;
  }
  measure_.assign(kInside + 2 * columns_ * rows_, 1.0);
  measure_ = flux_of([](const Direction&) { return 1.0; }, 1.0);
  drop_slivers();
}

void ErrorBoxes::set_outer_grid() {
  if (rectangle_.is_plane) {
    first_column_ = first_row_ = -kErrorBoxes;
    columns_ = rows_ = std::size_t{3} * kErrorBoxes;
    return;
  }
  // A multiple that divides 48, or that 48 divides: the rectangle is whole cells, or within one.
  for (const int m : {1, 2, 3, 4, 6, 8, 12, 16, 24, 48, 96, 192, 384, 768, 1536, 3072, 6144, 12288}) {
    multiple_ = m;
    if (2.0 / (m * std::min(step_u_, step_v_)) <= kMaxOuter) break;
  }
  const auto span = [&](double min, double step, long& first, std::size_t& count) {
    first = static_cast<long>(std::floor((-1.0 - min) / step / multiple_));
    count =
        static_cast<std::size_t>(static_cast<long>(std::floor((1.0 - min) / step / multiple_)) - first + 1);
  };
  span(rectangle_.u_min, step_u_, first_column_, columns_);
  span(rectangle_.v_min, step_v_, first_row_, rows_);
}

std::size_t ErrorBoxes::outer_cell(double i, double j, bool behind) const {
  const double column = std::floor(i / multiple_) - static_cast<double>(first_column_);
  const double row = std::floor(j / multiple_) - static_cast<double>(first_row_);
  const auto nx = static_cast<double>(columns_), ny = static_cast<double>(rows_);
  if (rectangle_.is_plane && !(column >= 0.0 && row >= 0.0 && column < nx && row < ny)) {
    return measure_.size() - 1;
  }
  // A direction is within the sphere up to rounding.
  const auto c = static_cast<std::size_t>(std::clamp(column, 0.0, nx - 1.0));
  const auto r = static_cast<std::size_t>(std::clamp(row, 0.0, ny - 1.0));
  return kInside + (behind ? columns_ * rows_ : 0) + r * columns_ + c;
}

ErrorBoxes::Range ErrorBoxes::outer_range(std::size_t column, std::size_t row) const {
  const double u = multiple_ * step_u_, v = multiple_ * step_v_;
  const double i = static_cast<double>(first_column_ + static_cast<long>(column));
  const double j = static_cast<double>(first_row_ + static_cast<long>(row));
  return {rectangle_.u_min + i * u, rectangle_.u_min + (i + 1.0) * u, rectangle_.v_min + j * v,
          rectangle_.v_min + (j + 1.0) * v};
}

ErrorBoxes::Range ErrorBoxes::inner_range(std::size_t box) const {
  const auto i = static_cast<double>(box % kErrorBoxes), j = static_cast<double>(box / kErrorBoxes);
  return {rectangle_.u_min + i * step_u_, rectangle_.u_min + (i + 1.0) * step_u_,
          rectangle_.v_min + j * step_v_, rectangle_.v_min + (j + 1.0) * step_v_};
}

bool ErrorBoxes::in_rectangle(const Range& r) const {
  const double u = 0.5 * (r.u0 + r.u1), v = 0.5 * (r.v0 + r.v1);
  return u > rectangle_.u_min && u < rectangle_.u_max && v > rectangle_.v_min && v < rectangle_.v_max;
}

void ErrorBoxes::drop_slivers() {
  for (std::size_t c = 0; c < measure_.size(); ++c) {
    const double whole = step_u_ * step_v_ * (c < kInside ? 1.0 : multiple_ * multiple_);
    if (measure_[c] < kSliver * whole) measure_[c] = 0.0;
  }
}

double ErrorBoxes::integral(const Range& r, bool behind, int pieces,
                            const std::function<double(const Direction&)>& intensity) const {
  const Frame& f = rectangle_.world_from_rectangle;
  const std::vector<double> ends = cuts(r.u0, r.u1, r.v0, r.v1);
  double sum = 0.0;
  for (std::size_t k = 0; k + 1 < ends.size(); ++k) {
    for_nodes(ends[k], ends[k + 1], pieces, [&](double u, double du) {
      // With v = sqrt(1 - u^2) sin a the solid angle du dv / w is du da.
      const double across = std::sqrt(1.0 - u * u);
      const double from = std::asin(std::clamp(r.v0 / across, -1.0, 1.0));
      const double to = std::asin(std::clamp(r.v1 / across, -1.0, 1.0));
      if (!(to > from)) return;
      for_nodes(from, to, pieces, [&](double a, double da) {
        const double w = across * std::cos(a);
        const Vec3 d{u, across * std::sin(a), behind ? -w : w};
        sum += du * da * intensity(f.direction(Direction::from_unit(d)));
      });
    });
  }
  return sum;
}

std::vector<double> ErrorBoxes::flux_of(const std::function<double(const Direction&)>& intensity,
                                        double step_rad) const {
  LUCERNA_CHECK(!rectangle_.is_plane, "intensity on a plane");
  std::vector<double> flux(size(), 0.0);
  const double width = std::max(step_u_, step_v_);
  const int inner = std::max(2, pieces_for(width, step_rad));
  const int outer = std::clamp(pieces_for(multiple_ * width, step_rad), 1, 4);
  parallel_blocks(size(), kTask, [&](std::size_t first, std::size_t last) {
    for (std::size_t c = first; c < last; ++c) {
      if (c < kInside) {
        flux[c] = integral(inner_range(c), false, inner, intensity);
        continue;
      }
      const std::size_t grid = columns_ * rows_, k = (c - kInside) % grid;
      const bool behind = c >= kInside + grid;
      const Range range = outer_range(k % columns_, k / columns_);
      if (behind || multiple_ > kErrorBoxes || !in_rectangle(range)) {
        flux[c] = integral(range, behind, outer, intensity);
      }
    }
  });
  if (multiple_ > kErrorBoxes) {
    // The rectangle is within one cell of the outer grid: what is in its boxes is not there.
    double inside = 0.0;
    for (std::size_t c = 0; c < kInside; ++c) inside += flux[c];
    double& around = flux[outer_cell(0.0, 0.0, false)];
    around = std::max(0.0, around - inside);
  }
  return flux;
}

std::vector<double> ErrorBoxes::flux_of(const IntensityDistribution& distribution) const {
  double step_deg = 180.0;
  for (std::size_t g = 1; g < distribution.gamma_deg.size(); ++g) {
    step_deg = std::min(step_deg, distribution.gamma_deg[g] - distribution.gamma_deg[g - 1]);
  }
  return flux_of([&](const Direction& d) { return intensity_in(distribution, d); }, radians(step_deg));
}

std::vector<double> ErrorBoxes::flux_on(
    const std::function<double(double x_mm, double y_mm)>& density_per_mm2, double step_mm) const {
  LUCERNA_CHECK(rectangle_.is_plane, "a density over directions");
  std::vector<double> flux(size(), 0.0);
  const int pieces = std::max(2, pieces_for(std::max(step_u_, step_v_), step_mm));
  parallel_blocks(size() - 1, kTask, [&](std::size_t first, std::size_t last) {
    for (std::size_t c = first; c < last; ++c) {
      if (measure_[c] == 0.0) continue;
      const std::size_t k = c - std::min(c, kInside);
      const Range r = c < kInside ? inner_range(c) : outer_range(k % columns_, k / columns_);
      for_nodes(r.u0, r.u1, pieces, [&](double x, double dx) {
        for_nodes(r.v0, r.v1, pieces,
                  [&](double y, double dy) { flux[c] += dx * dy * density_per_mm2(x, y); });
      });
    }
  });
  return flux;
}

}  // namespace lucerna
