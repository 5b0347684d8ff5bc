// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/shape/conjugate_solution.h"

#include <algorithm>

namespace lucerna {

namespace {

/// z0 + r^2 / (4 (source - z0)): a paraboloid about a source, known by its vertex.
struct Confocal {
  double source_z_mm, across, vertex_z_mm;

  double focal_mm() const { return source_z_mm - vertex_z_mm; }
  double square(double x, double y) const { return x * x + across * y * y; }
  double at(double x, double y) const { return vertex_z_mm + 0.25 / focal_mm() * square(x, y); }
  double by_vertex(double x, double y) const { return 1.0 + 0.25 / (focal_mm() * focal_mm()) * square(x, y); }
};

/// The one that the shape departs least from, in the mean square over its bounds.
Confocal nearest_confocal(const DesignShape& shape, double source_z_mm) {
  constexpr int kGrid = 10, kSteps = 6;
  const double half_x = shape.aperture().half_x_mm(), half_y = shape.aperture().half_y_mm();
  const double vertex = shape.at(0.0, 0.0).z_mm;
  const bool above = source_z_mm > vertex;
  Confocal p{above ? source_z_mm : vertex + shape.focal_mm(), shape.is_trough() ? 0.0 : 1.0, vertex};
  for (int step = 0; step < kSteps; ++step) {
    double along = 0.0, square = 0.0;
    for (int j = -kGrid; j <= kGrid; ++j) {
      for (int i = -kGrid; i <= kGrid; ++i) {
        const double x = half_x * i / kGrid, y = half_y * j / kGrid, by = p.by_vertex(x, y);
        along += by * (shape.at(x, y).z_mm - p.at(x, y));
        square += by * by;
      }
    }
    // Never more than half the way to the source, where there is no paraboloid.
    p.vertex_z_mm += std::min(along / square, 0.5 * p.focal_mm());
  }
  return p;
}

}  // namespace

DesignShape conjugate_solution(const DesignShape& shape, double source_z_mm) {
  const Confocal p = nearest_confocal(shape, source_z_mm);
  return shape.through([&](double x, double y) { return 2.0 * p.at(x, y) - shape.at(-x, -y).z_mm; });
}

}  // namespace lucerna
