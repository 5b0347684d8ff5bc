// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <initializer_list>
#include <numbers>
#include <utility>
#include <vector>

#include "lucerna/cad.h"
#include "lucerna/core/io/error.h"
#include "lucerna/geometry.h"
#include "lucerna/optics/cad/step_writer.h"
#include "lucerna/optics/shapes/profile.h"
#include "lucerna/optics/shapes/smooth_shape.h"

namespace lucerna {

namespace {

using std::numbers::pi;

/// Coefficients on knots with full multiplicity at both ends, from those on equal knots. A coefficient is the
/// polynomial's blossom at three neighbouring knots (L. Ramshaw, "Blossoms are polar forms", 1989): only two
/// at each end change.
std::vector<double> clamped(const std::vector<double>& c) {
  const std::size_t n = c.size();
  std::vector<double> d = c;
  d[0] = (c[0] + 4.0 * c[1] + c[2]) / 6.0;
  d[1] = (2.0 * c[1] + c[2]) / 3.0;
  d[n - 2] = (c[n - 3] + 2.0 * c[n - 2]) / 3.0;
  d[n - 1] = (c[n - 3] + 4.0 * c[n - 2] + c[n - 1]) / 6.0;
  return d;
}

/// Knots of a row: where they are, and the clamped coefficients of x and x^2.
struct ClampedRow {
  explicit ClampedRow(const KnotRow& row) {
    for (int i = 0; i <= row.intervals; ++i) {
      knots.push_back(i == row.intervals ? row.end_mm() : row.start_mm + row.step_mm * i);
      multiplicity.push_back(i == 0 || i == row.intervals ? 4 : 1);
    }
    const auto knot = [&](int i) { return knots[static_cast<std::size_t>(std::clamp(i, 0, row.intervals))]; };
    for (int i = 0; i < row.coefficients(); ++i) {
      const double a = knot(i - 2), b = knot(i - 1), c = knot(i);
      x.push_back((a + b + c) / 3.0);
      square.push_back((a * b + b * c + c * a) / 3.0);
    }
  }
  std::vector<double> knots, x, square;
  std::vector<int> multiplicity;
};

/// The cubic with continuous tangent through places and slopes of a curve on [a, b], in so many equal pieces
/// that its middles are within 1e-6 mm.
StepCurve hermite(double a, double b, const std::function<std::array<Vec3, 2>(double)>& curve) {
  constexpr double kClose_mm = 1e-6;
  constexpr int kMaxPieces = 1 << 14;
  for (int n = 8;; n *= 2) {
    StepCurve out;
    const double h = (b - a) / n;
    double worst = 0.0;
    auto [p, d] = curve(a);
    out.poles = {p};
    for (int i = 0; i < n; ++i) {
      const auto [q, e] = curve(i + 1 == n ? b : a + h * (i + 1));
      const Vec3 b1 = p + (h / 3.0) * d, b2 = q - (h / 3.0) * e;
      const Vec3 middle = 0.125 * p + 0.375 * b1 + 0.375 * b2 + 0.125 * q;
      worst = std::max(worst, length(middle - curve(a + h * (i + 0.5))[0]));
      out.poles.push_back(b1);
      out.poles.push_back(b2);
      p = q;
      d = e;
    }
    out.poles.push_back(p);
    for (int i = 0; i <= n; ++i) {
      out.knots.push_back(i == n ? b : a + h * i);
      out.multiplicity.push_back(i == 0 || i == n ? 4 : 2);
    }
    if (worst <= kClose_mm) return out;
    if (n >= kMaxPieces) {
      throw InputError("CAD: STEP: the surface bends too sharply at its rim to follow it within 1e-6 mm");
    }
  }
}

/// A quarter of the circle of radius r about the axis, on a surface.
StepCurve quarter(const HeightSurface& surface, double r, int quadrant) {
  return hermite(0.5 * pi * quadrant, 0.5 * pi * (quadrant + 1), [&](double angle) {
    const double c = r * std::cos(angle), s = r * std::sin(angle);
    const SurfacePoint p = surface.at(c, s);
    return std::array<Vec3, 2>{Vec3{c, s, p.z_mm}, Vec3{-s, c, -s * p.dzdx + c * p.dzdy}};
  });
}

/// The closed loop of a circle, counter-clockwise seen from +z.
int circle_loop(StepWriter& step, const HeightSurface& surface, double r) {
  std::array<StepCurve, 4> curve;
  std::array<int, 4> vertex{}, edge{};
  for (int i = 0; i < 4; ++i) {
    curve[static_cast<std::size_t>(i)] = quarter(surface, r, i);
    vertex[static_cast<std::size_t>(i)] = step.vertex(curve[static_cast<std::size_t>(i)].poles.front());
  }
  for (std::size_t i = 0; i < 4; ++i) {
    curve[i].poles.back() = curve[(i + 1) % 4].poles.front();
    edge[i] = step.edge(vertex[i], vertex[(i + 1) % 4], step.curve(curve[i]));
  }
  return step.loop({{edge[0], true}, {edge[1], true}, {edge[2], true}, {edge[3], true}});
}

/// The outline of the whole rectangle: the surface's own first and last rows of poles.
int rectangle_loop(StepWriter& step, const StepSurface& s) {
  const std::size_t nu = s.count_u, nv = s.poles.size() / nu;
  const auto line = [&](std::size_t first, std::size_t stride, std::size_t n, bool along_u) {
    StepCurve c;
    for (std::size_t i = 0; i < n; ++i) c.poles.push_back(s.poles[first + i * stride]);
    c.knots = along_u ? s.knots_u : s.knots_v;
    c.multiplicity = along_u ? s.multiplicity_u : s.multiplicity_v;
    return c;
  };
  const int a = step.vertex(s.poles[0]), b = step.vertex(s.poles[nu - 1]);
  const int c = step.vertex(s.poles[nu * nv - 1]), d = step.vertex(s.poles[nu * (nv - 1)]);
  const int ab = step.edge(a, b, step.curve(line(0, 1, nu, true)));
  const int bc = step.edge(b, c, step.curve(line(nu - 1, nu, nv, false)));
  const int dc = step.edge(d, c, step.curve(line(nu * (nv - 1), 1, nu, true)));
  const int ad = step.edge(a, d, step.curve(line(0, nu, nv, false)));
  return step.loop({{ab, true}, {bc, true}, {dc, false}, {ad, false}});
}

StepSurface surface_of(const BsplineShape& shape) {
  const ClampedRow x(shape.row_x()), y(shape.row_y());
  const std::size_t nx = x.x.size(), ny = y.x.size();
  std::vector<std::vector<double>> rows(ny);  // along x first, then along y
  for (std::size_t j = 0; j < ny; ++j) {
    const auto from = shape.coefficients().begin() + static_cast<std::ptrdiff_t>(j * nx);
    rows[j] = clamped({from, from + static_cast<std::ptrdiff_t>(nx)});
  }
  StepSurface s{nx, {}, x.knots, y.knots, x.multiplicity, y.multiplicity};
  s.poles.resize(nx * ny);
  const double k = 0.25 / shape.focal_mm();
  for (std::size_t i = 0; i < nx; ++i) {
    std::vector<double> column(ny);
    for (std::size_t j = 0; j < ny; ++j) column[j] = rows[j][i];
    column = clamped(column);
    for (std::size_t j = 0; j < ny; ++j) {
      s.poles[j * nx + i] = {x.x[i], y.x[j], k * (x.square[i] + y.square[j]) + column[j]};
    }
  }
  return s;
}

void write_free_form(StepWriter& step, const BsplineShape& shape, const HeightSurface& surface,
                     const Aperture& aperture) {
  const StepSurface s = surface_of(shape);
  const int outer = aperture.shape() == ApertureShape::circle
                        ? circle_loop(step, surface, aperture.half_x_mm())
                        : rectangle_loop(step, s);
  std::vector<int> holes;
  if (aperture.hole_radius_mm() > 0.0) holes.push_back(circle_loop(step, surface, aperture.hole_radius_mm()));
  step.face(step.surface(s), true, outer, holes);
}

/// The meridian in the half plane y = 0, x >= 0.
StepCurve meridian(const RevolutionShape& shape) {
  const ClampedRow row(shape.row());
  const std::vector<double> c = clamped(shape.coefficients());
  StepCurve curve{{}, row.knots, row.multiplicity};
  for (std::size_t i = 0; i < c.size(); ++i) {
    curve.poles.push_back({row.x[i], 0.0, 0.25 / shape.focal_mm() * row.square[i] + c[i]});
  }
  return curve;
}

/// Two half turns, so that no edge is its own neighbour; the hole's rim or the axis between them.
void write_revolution(StepWriter& step, const StepCurve& profile, const HeightSurface& surface,
                      const Aperture& aperture) {
  if (aperture.shape() != ApertureShape::circle) {
    throw InputError("CAD: STEP: a surface of revolution needs aperture = \"circle\"");
  }
  const double outer = aperture.half_x_mm(), hole = aperture.hole_radius_mm();
  const auto at = [&](double x) { return Vec3{x, 0.0, surface.at(std::abs(x), 0.0).z_mm}; };
  StepCurve opposite = profile;
  for (Vec3& p : opposite.poles) p.x = -p.x;
  const int swept = step.revolution(step.curve(profile));
  const int a = step.vertex(at(outer)), b = step.vertex(at(-outer));
  const int in_a = step.vertex(at(hole)), in_b = hole > 0.0 ? step.vertex(at(-hole)) : in_a;
  const int spoke_a = step.edge(in_a, a, step.curve(profile));
  const int spoke_b = step.edge(in_b, b, step.curve(opposite));
  const int rim = step.circle(at(outer).z, outer);
  const int rim_ab = step.edge(a, b, rim), rim_ba = step.edge(b, a, rim);
  std::vector<StepEdge> first{{spoke_a, true}, {rim_ab, true}, {spoke_b, false}};
  std::vector<StepEdge> second{{spoke_b, true}, {rim_ba, true}, {spoke_a, false}};
  if (hole > 0.0) {
    const int inner = step.circle(at(hole).z, hole);
    first.emplace_back(step.edge(in_a, in_b, inner), false);
    second.emplace_back(step.edge(in_b, in_a, inner), false);
  }
  // Angle first, radius second: the swept surface's own normal looks away from the light.
  step.face(swept, false, step.loop(first), {});
  step.face(swept, false, step.loop(second), {});
}

}  // namespace

std::string step_text(const Reflector& reflector, const std::string& name) {
  StepWriter step;
  const HeightSurface& surface = *reflector.surface;
  if (const auto* s = dynamic_cast<const SmoothSurface<BsplineShape>*>(&surface)) {
    write_free_form(step, s->shape(), surface, reflector.aperture);
  } else if (const auto* r = dynamic_cast<const SmoothSurface<RevolutionShape>*>(&surface)) {
    write_revolution(step, meridian(r->shape()), surface, reflector.aperture);
  } else if (dynamic_cast<const RevolutionSurface*>(&surface) != nullptr) {
    const StepCurve profile =
        hermite(reflector.aperture.hole_radius_mm(), reflector.aperture.half_x_mm(), [&](double radius) {
          const SurfacePoint p = surface.at(radius, 0.0);
          return std::array<Vec3, 2>{Vec3{radius, 0.0, p.z_mm}, Vec3{1.0, 0.0, p.dzdx}};
        });
    write_revolution(step, profile, surface, reflector.aperture);
  } else {
    throw InputError("CAD: STEP has no surface for this family; expected revolution or bspline");
  }
  return step.text(name);
}

}  // namespace lucerna
