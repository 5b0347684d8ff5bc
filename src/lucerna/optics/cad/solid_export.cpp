// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <vector>

#include "lucerna/cad.h"
#include "lucerna/core/io/error.h"
#include "lucerna/optics/cad/step_curves.h"
#include "lucerna/optics/cad/step_writer.h"
#include "lucerna/optics/shapes/faced_outline.h"
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

  /// The wall from a corner up to the rim of `face`, in two half cylinders, and the face, which is `shape`.
  /// `is_top`: the body is below the face and within the wall, else above and outside.
  void add_face(std::size_t corner, const BsplineShape& shape, const HeightSurface& face, bool is_top) {
    const SolidRing low = ring(corner);
    const auto [r, z] = corners_[corner];
    const FaceRim rim = face_rim(face, r);
    const Vec3 near_low{r, 0.0, z}, far_low{-r, 0.0, z};
    const int near = straight_edge(low.near, rim.vertex[0], near_low, rim.curve[0].poles.front());
    const int far = straight_edge(low.far, rim.vertex[2], far_low, rim.curve[2].poles.front());
    const int wall = step_.revolution(step_.curve(straight(near_low, {r, 0.0, rim.top_mm})));
    const auto& q = rim.edge;
    const auto add = [&](int surface, std::vector<StepEdge> loop) {
      if (!is_top) loop = backward(loop);
      step_.face(surface, is_top, step_.loop(loop), {});
    };
    add(wall, {{low.first_half, true}, {far, true}, {q[1], false}, {q[0], false}, {near, false}});
    add(wall, {{low.second_half, true}, {near, true}, {q[3], false}, {q[2], false}, {far, false}});
    add(step_.surface(step_surface(shape)), {{q[0], true}, {q[1], true}, {q[2], true}, {q[3], true}});
  }

  std::string text(const std::string& name) { return step_.text(name, true); }

 private:
  /// The rim of a face in quarters from +x, and the height that it stays below.
  struct FaceRim {
    std::array<StepCurve, 4> curve;
    std::array<int, 4> vertex{}, edge{};
    double top_mm = 0.0;
  };

  FaceRim face_rim(const HeightSurface& face, double radius_mm) {
    FaceRim out;
    out.top_mm = face.at(radius_mm, 0.0).z_mm;
    for (std::size_t i = 0; i < 4; ++i) {
      out.curve[i] = step_quarter(face, radius_mm, static_cast<int>(i));
      out.vertex[i] = step_.vertex(out.curve[i].poles.front());
      // The rim is in the hull of its poles.
      for (const Vec3& p : out.curve[i].poles) out.top_mm = std::max(out.top_mm, p.z);
    }
    for (std::size_t i = 0; i < 4; ++i) {
      out.curve[i].poles.back() = out.curve[(i + 1) % 4].poles.front();
      out.edge[i] = step_.edge(out.vertex[i], out.vertex[(i + 1) % 4], step_.curve(out.curve[i]));
    }
    return out;
  }

  /// The same loop the other way round.
  static std::vector<StepEdge> backward(const std::vector<StepEdge>& loop) {
    std::vector<StepEdge> out(loop.rbegin(), loop.rend());
    for (auto& [edge, forward] : out) forward = !forward;
    return out;
  }

  static StepCurve straight(const Vec3& from, const Vec3& to) {
    const Vec3 third = (1.0 / 3.0) * (to - from);
    return {{from, from + third, to - third, to}, {0.0, length(to - from)}, {4, 4}};
  }

  int straight_edge(int from, int to, const Vec3& from_mm, const Vec3& to_mm) {
    return step_.edge(from, to, step_.curve(straight(from_mm, to_mm)));
  }

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

const BsplineShape& spline_of(const HeightSurface& face) {
  const auto* const spline = dynamic_cast<const SmoothSurface<BsplineShape>*>(&face);
  if (spline == nullptr)
    throw InputError(
        "CAD: STEP: found a face of a solid that is no B-spline, expected one with coefficients");
  return spline->shape();
}

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

std::string solid_step_text(std::span<const OutlinePoint> outline_mm, const BodyFaces& faces,
                            double smooth_below_deg, const std::string& name) {
  check_faced_outline(outline_mm, faces, smooth_below_deg);
  const FacedBase base = faced_base(outline_mm, smooth_below_deg);
  SolidStep step(base.corners);
  for (const OutlineRun& run : base.runs) step.add(run);
  step.add_face(outline_mm.size() - 2, spline_of(faces.top), faces.top, true);
  if (faces.bottom) step.add_face(1, spline_of(*faces.bottom), *faces.bottom, false);
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
