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
#include "lucerna/optics/cad/step_curves.h"
#include "lucerna/optics/cad/step_writer.h"
#include "lucerna/optics/shapes/profile.h"
#include "lucerna/optics/shapes/smooth_shape.h"

namespace lucerna {

namespace {

/// The closed loop of a circle, counter-clockwise seen from +z.
int circle_loop(StepWriter& step, const HeightSurface& surface, double r) {
  std::array<StepCurve, 4> curve;
  std::array<int, 4> vertex{}, edge{};
  for (int i = 0; i < 4; ++i) {
    curve[static_cast<std::size_t>(i)] = step_quarter(surface, r, i);
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

void write_free_form(StepWriter& step, const BsplineShape& shape, const HeightSurface& surface,
                     const Aperture& aperture) {
  const StepSurface s = step_surface(shape);
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
  const std::vector<double> c = clamped_coefficients(shape.coefficients());
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
        step_cubic(reflector.aperture.hole_radius_mm(), reflector.aperture.half_x_mm(), [&](double radius) {
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
