// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/adaptive/search/support_moves.h"

#include <cmath>

namespace lucerna {

namespace {

/// One step of a support's dome: moved by `length_mm`, stronger or weaker, of another index but as strong.
std::optional<Support> moved_dome(const Support& s, int move, double length_mm, double angle) {
  if (!s.dome.exists()) return std::nullopt;
  constexpr double kMin = 1.02, kMax = 4.0;
  Support t = s;
  const Frame& f = s.world_from_support;
  if (move < 3) {
    const Vec3 axis = move == 0 ? f.ex() : move == 1 ? f.ey() : f.ez();
    t.dome.centre_mm = s.dome.centre_mm + length_mm * axis;
    return t;
  }
  if (move == 3) {
    t.dome.radius_mm = s.dome.radius_mm * std::exp(angle);
    return t;
  }
  t.dome.index = 1.0 + (s.dome.index - 1.0) * std::exp(angle);
  if (t.dome.index < kMin || t.dome.index > kMax) return std::nullopt;
  const auto weakness = [](double index) { return 1.0 - 1.0 / index; };
  t.dome.radius_mm = s.dome.radius_mm * weakness(t.dome.index) / weakness(s.dome.index);
  return t;
}

}  // namespace

std::optional<Support> moved(const Support& s, int move, double length_mm, double angle) {
  Support t = s;
  const Frame& f = s.world_from_support;
  const bool flat = s.kind == SupportKind::plane, round = s.radius_mm > 0.0;
  if (move < 3) {
    if (flat && move < 2) return std::nullopt;  // a plane moved in itself is the same plane
    const Vec3 axis = move == 0 ? f.ex() : move == 1 ? f.ey() : f.ez();
    t.world_from_support = {f.ex(), f.ey(), f.ez(), f.origin_mm() + length_mm * axis};
    return t;
  }
  if (move < 6) {
    const Direction local = move == 3   ? Direction::from({1, 0, 0})
                            : move == 4 ? Direction::from({0, 1, 0})
                                        : Direction();
    t.world_from_support = f * Frame::rotation(local, angle);
    return t;
  }
  if (move == 6 && round) {
    t.radius_mm = s.radius_mm + length_mm;
    if (!(t.radius_mm > 0.2 * s.radius_mm)) return std::nullopt;
    if (s.kind == SupportKind::cylinder) t.half_size_mm.x = t.half_size_mm.y = t.radius_mm;
    return t;
  }
  if (move == 7 && s.kind == SupportKind::cylinder) {
    t.half_size_mm.z = s.half_size_mm.z + 2.0 * length_mm;
    if (!(t.half_size_mm.z > 0.2 * s.half_size_mm.z)) return std::nullopt;
    return t;
  }
  if (move >= 8) return moved_dome(s, move - 8, length_mm, angle);
  return std::nullopt;
}

}  // namespace lucerna
