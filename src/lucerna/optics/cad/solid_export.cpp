// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <map>
#include <vector>

#include "lucerna/cad.h"
#include "lucerna/core/io/error.h"
#include "lucerna/optics/cad/step_writer.h"
#include "lucerna/optics/shapes/outline_curve.h"

namespace lucerna {

namespace {

/// What faces share at a corner of the outline that is not within a curve: vertices on both sides of the
/// axis and the two halves of the circle; one vertex where it lies on the axis.
struct SolidRing {
  int near = 0, far = 0, first_half = 0, second_half = 0;
  bool on_axis = false;
};

/// A run as a cubic B-spline of the half plane y = 0 on the side of `sign`: C1 knots where pieces meet.
StepCurve step_curve(const std::vector<OutlinePiece<double>>& curve, double sign) {
  StepCurve out;
  const auto pole = [&](double r, double z) { out.poles.push_back({sign * r, 0.0, z}); };
  double at = 0.0;
  pole(curve.front().from[0], curve.front().from[1]);
  out.knots.push_back(at);
  for (const OutlinePiece<double>& c : curve) {
    pole(c.from[0] + c.from_slope[0] / 3.0, c.from[1] + c.from_slope[1] / 3.0);
    pole(c.to[0] - c.to_slope[0] / 3.0, c.to[1] - c.to_slope[1] / 3.0);
    at += std::hypot(c.to[0] - c.from[0], c.to[1] - c.from[1]);  // the spline's own parameter
    out.knots.push_back(at);
  }
  pole(curve.back().to[0], curve.back().to[1]);
  out.multiplicity.assign(out.knots.size(), 2);
  out.multiplicity.front() = out.multiplicity.back() = 4;
  return out;
}

class SolidStep {
 public:
  explicit SolidStep(const std::vector<OutlinePoint>& corners) : corners_(corners) {}

  /// Two half turns, so that no edge is its own neighbour.
  void add(const OutlineRun& run) {
    const auto curve = run_curve(corners_, run);
    const SolidRing from = ring(run.from), to = ring(run.to);
    const int profile = step_.curve(step_curve(curve, 1.0));
    const int near = step_.edge(from.near, to.near, profile);
    const int far = step_.edge(from.far, to.far, step_.curve(step_curve(curve, -1.0)));
    const int swept = step_.revolution(profile);
    for (const bool first : {true, false}) {
      std::vector<StepEdge> loop;
      if (!from.on_axis) loop.emplace_back(first ? from.first_half : from.second_half, true);
      loop.emplace_back(first ? far : near, true);
      if (!to.on_axis) loop.emplace_back(first ? to.first_half : to.second_half, false);
      loop.emplace_back(first ? near : far, false);
      step_.face(swept, true, step_.loop(loop), {});
    }
  }

  std::string text(const std::string& name) { return step_.text(name, true); }

 private:
  SolidRing ring(std::size_t corner) {
    const std::size_t i = corner % corners_.size();
    const auto known = rings_.find(i);
    if (known != rings_.end()) return known->second;
    const auto [r, z] = corners_[i];
    SolidRing out;
    out.on_axis = r == 0.0;
    out.near = step_.vertex({r, 0.0, z});
    out.far = out.on_axis ? out.near : step_.vertex({-r, 0.0, z});
    if (!out.on_axis) {
      const int circle = step_.circle(z, r);
      out.first_half = step_.edge(out.near, out.far, circle);
      out.second_half = step_.edge(out.far, out.near, circle);
    }
    return rings_.emplace(i, out).first->second;
  }

  const std::vector<OutlinePoint>& corners_;
  std::map<std::size_t, SolidRing> rings_;
  StepWriter step_;
};

}  // namespace

std::string solid_step_text(std::span<const OutlinePoint> outline_mm, double smooth_below_deg,
                            const std::string& name) {
  static_cast<void>(outline_sides(outline_mm, smooth_below_deg, 1e-3 * outline_reach_mm(outline_mm)));
  const std::vector<OutlinePoint> corners = counter_clockwise(outline_mm);
  const auto runs = outline_runs(corners, smooth_below_deg);
  if (runs.empty()) throw InputError("CAD: STEP: the outline has no edge");
  SolidStep step(corners);
  for (const OutlineRun& run : runs) step.add(run);
  return step.text(name);
}

std::vector<std::array<double, 2>> solid_profile(std::span<const OutlinePoint> outline_mm,
                                                 double smooth_below_deg, double chord_mm) {
  std::vector<OutlinePoint> out;
  for (const OutlineSide& side : outline_sides(outline_mm, smooth_below_deg, chord_mm)) {
    if (out.empty() || out.back() != side.from) out.push_back(side.from);
    out.push_back(side.to);
  }
  if (out.front() != out.back()) out.push_back(out.front());
  return out;
}

}  // namespace lucerna
