// SPDX-License-Identifier: Apache-2.0
#include "lucerna/photometry/metrics/plane_illuminance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "lucerna/core/io/error.h"
#include "lucerna/core/parallel/parallel.h"

namespace lucerna {

namespace {

constexpr std::size_t kMaxCells = std::size_t{1} << 24;

void check(const IlluminatedPlane& plane) {
  for (const double size : {plane.size_x_mm, plane.size_y_mm}) {
    if (!std::isfinite(size) || !(size > 0.0))
      throw InputError(fmt::format("illuminated plane: size {} mm is not above 0", size));
  }
  if (plane.nx < 2 || plane.ny < 2 || plane.nx > kMaxCells / plane.ny)
    throw InputError(
        fmt::format("illuminated plane: {} x {} cells, 2 x 2 to {} expected", plane.nx, plane.ny, kMaxCells));
}

struct Corner {
  double x = 0.0, y = 0.0, lx = 0.0;
};

/// Adds the part of a mesh cell between four cell centres where the illuminance, linear along the edges, is
/// at least `level`.
struct AreaSum {
  double level = 0.0, area = 0.0;
  double x0 = std::numeric_limits<double>::max(), x1 = -x0, y0 = x0, y1 = -x0;

  void add(const std::array<Corner, 4>& corners) {
    std::array<Corner, 8> part;
    std::size_t n = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      const Corner &a = corners[i], &b = corners[(i + 1) % 4];
      if (a.lx >= level) part[n++] = a;
      if ((a.lx >= level) == (b.lx >= level)) continue;
      const double t = (level - a.lx) / (b.lx - a.lx);
      part[n++] = {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y), level};
    }
    for (std::size_t i = 0; i < n; ++i) {
      const Corner &a = part[i], &b = part[(i + 1) % n];
      area += 0.5 * (a.x * b.y - b.x * a.y);
      x0 = std::min(x0, a.x), x1 = std::max(x1, a.x);
      y0 = std::min(y0, a.y), y1 = std::max(y1, a.y);
    }
  }
};

}  // namespace

Frame plane_frame(const PlanePlacement& placement) {
  if (!std::isfinite(placement.distance_mm) || !(placement.distance_mm > 0.0))
    throw InputError(fmt::format("illuminated plane: distance {} mm is not above 0", placement.distance_mm));
  // From nadir: the plane's z is up, which is where `from_axis` starts; its antipode keeps x.
  const Frame facing = Frame::from_axis(-placement.aim, 0.0, placement.distance_mm * placement.aim.vec());
  const Frame about_x = Frame::rotation(Direction::from_unit({1.0, 0.0, 0.0}), radians(placement.tilt_x_deg));
  const Frame about_y = Frame::rotation(Direction::from_unit({0.0, 1.0, 0.0}), radians(placement.tilt_y_deg));
  return facing * about_x * about_y;
}

double illuminance_lx(const IntensityDistribution& distribution, const Vec3& point_mm,
                      const Direction& normal) {
  const double r_mm = length(point_mm);
  if (!(r_mm > 0.0)) throw InputError("illuminance: the point is the luminaire's photometric centre");
  const Direction direction = Direction::from_unit(point_mm / r_mm);
  const double cosine = -dot(direction, normal);
  if (!(cosine > 0.0)) return 0.0;
  return intensity_in(distribution, direction) * cosine / (r_mm * r_mm * 1e-6);
}

LitArea lit_area(const PlaneIlluminance& e, double fraction) {
  LitArea lit{.fraction = fraction};
  if (!(e.max_lx > 0.0)) return lit;
  AreaSum sum{.level = fraction * e.max_lx};
  const std::size_t nx = e.plane.nx, ny = e.plane.ny;
  const auto corner = [&](std::size_t ix, std::size_t iy) {
    return Corner{e.plane.x_mm(ix), e.plane.y_mm(iy), e.lx[iy * nx + ix]};
  };
  for (std::size_t iy = 0; iy < ny; ++iy) {
    for (std::size_t ix = 0; ix < nx; ++ix) {
      const bool edge = ix == 0 || iy == 0 || ix + 1 == nx || iy + 1 == ny;
      lit.cut = lit.cut || (edge && e.lx[iy * nx + ix] >= sum.level);
      if (ix + 1 == nx || iy + 1 == ny) continue;
      sum.add({corner(ix, iy), corner(ix + 1, iy), corner(ix + 1, iy + 1), corner(ix, iy + 1)});
    }
  }
  lit.area_mm2 = sum.area;
  lit.diameter_mm = 2.0 * std::sqrt(sum.area / std::numbers::pi);
  lit.width_x_mm = sum.x1 - sum.x0;
  lit.width_y_mm = sum.y1 - sum.y0;
  return lit;
}

PlaneIlluminance plane_illuminance(const IntensityDistribution& distribution, const IlluminatedPlane& plane) {
  if (const std::string fault = grid_fault(distribution); !fault.empty())
    throw InputError("illuminated plane: " + fault);
  check(plane);
  PlaneIlluminance e{.plane = plane, .lx = std::vector<double>(plane.nx * plane.ny)};
  const Frame& frame = plane.luminaire_from_plane;
  const Direction normal = Direction::from_unit(frame.ez());
  parallel_blocks(e.lx.size(), 4096, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const Vec3 place = frame.point({plane.x_mm(i % plane.nx), plane.y_mm(i / plane.nx), 0.0});
      e.lx[i] = illuminance_lx(distribution, place, normal);
    }
  });
  e.centre_lx = illuminance_lx(distribution, frame.origin_mm(), normal);
  double sum = 0.0;
  for (const double lx : e.lx) sum += lx;
  e.mean_lx = sum / static_cast<double>(e.lx.size());
  e.min_lx = *std::min_element(e.lx.begin(), e.lx.end());
  const auto brightest = static_cast<std::size_t>(std::max_element(e.lx.begin(), e.lx.end()) - e.lx.begin());
  e.max_lx = e.lx[brightest];
  e.max_x_mm = plane.x_mm(brightest % plane.nx);
  e.max_y_mm = plane.y_mm(brightest / plane.nx);
  e.uniformity = e.mean_lx > 0.0 ? e.min_lx / e.mean_lx : 0.0;
  e.half = lit_area(e, 0.5);
  e.tenth = lit_area(e, 0.1);
  return e;
}

}  // namespace lucerna
