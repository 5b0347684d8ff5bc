// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "bspline.h"

namespace bench {

namespace {

/// The part of a surface that is there, by x and y of its own frame.
struct Trim {
  bool circle = false, rectangle = false;
  double radius = 0.0, hole_radius = 0.0, half_x = 0.0, half_y = 0.0;

  explicit Trim(const JsonNode& s) {
    if (!s.has("trim")) return;
    const JsonNode t = s.at("trim");
    t.only({"kind", "diameter_mm", "size_mm", "hole_diameter_mm"});
    circle = t.at("kind").one_of({"circle", "rectangle"}) == "circle";
    rectangle = !circle;
    if (circle) radius = 0.5 * t.at("diameter_mm").positive();
    if (rectangle) {
      const auto size = t.at("size_mm").numbers(2);
      half_x = 0.5 * size[0];
      half_y = 0.5 * size[1];
    }
    if (t.has("hole_diameter_mm")) hole_radius = 0.5 * t.at("hole_diameter_mm").number_in(0.0, 1e6);
  }
  bool any() const { return circle || rectangle || hole_radius > 0.0; }
  bool keeps(const Vec3& p) const {
    const double r2 = p.x * p.x + p.y * p.y;
    if (r2 < hole_radius * hole_radius) return false;
    if (circle) return r2 <= radius * radius;
    return !rectangle || (std::abs(p.x) <= half_x && std::abs(p.y) <= half_y);
  }
};

class SplinePatch final : public Patch {
 public:
  explicit SplinePatch(const JsonNode& s) : spline_(s), trim_(s) {
    if (spline_.breaks(0).size() * spline_.breaks(1).size() > kMaxQuads)
      s.at("points_mm").fail("too many pieces", "at most " + std::to_string(kMaxQuads));
    if (trim_.any() && kept_share() < kLeastKept)
      s.at("trim").fail("less than a hundredth of the surface within it",
                        "a surface that ends near its trim: limits see it by a grid");
  }
  SurfaceJet jet(double& u, double& v) const override {
    u = std::clamp(u, spline_.low(0), spline_.high(0));
    v = std::clamp(v, spline_.low(1), spline_.high(1));
    return spline_.at(u, v);
  }
  std::vector<double> breaks(std::size_t axis) const override { return spline_.breaks(axis); }
  bool straight(std::size_t axis) const override { return spline_.degree(axis) == 1; }
  bool trimmed() const override { return trim_.any(); }
  bool keeps(double, double, const Vec3& point) const override { return trim_.keeps(point); }

 private:
  /// Of a grid of parameters, what lies within the trim.
  double kept_share() const {
    constexpr int kSide = 100;
    int kept = 0;
    for (int i = 0; i < kSide * kSide; ++i) {
      const auto at = [&](std::size_t axis, int k) {
        return spline_.low(axis) + (spline_.high(axis) - spline_.low(axis)) * (k + 0.5) / kSide;
      };
      kept += trim_.keeps(spline_.at(at(0, i % kSide), at(1, i / kSide)).point) ? 1 : 0;
    }
    return kept / static_cast<double>(kSide * kSide);
  }

  static constexpr double kLeastKept = 0.01;
  Bspline spline_;
  Trim trim_;
};

}  // namespace

std::unique_ptr<Surface> read_bspline(const JsonNode& surface, const Frame& place) {
  return surface_of(std::make_unique<SplinePatch>(surface), place);
}

}  // namespace bench
