// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/lens/entry_face.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "lucerna/design/lens/free_face.h"
#include "lucerna/error.h"
#include "lucerna/project.h"
#include "lucerna/source.h"

namespace lucerna {
namespace {

/// A dome of 12 mm radius whose free face is side 2, over a flat base.
LensShape flat_lens(double smooth_below_deg = 20.0) {
  std::vector<OutlinePoint> corners{{0, 1}, {12, 1}};
  for (const double r : {12.0, 11.0, 10.0, 9.0, 8.0, 7.0, 6.0, 5.0, 4.0, 3.0, 2.0, 1.0, 0.0})
    corners.push_back({r, 9.0 - r * r / 24.0});
  return {corners, smooth_below_deg, std::vector<std::size_t>{2}, 0};
}

double ellipse_mm(const Cavity& c, double r) {
  return r < c.radius_mm ? c.depth_mm * std::sqrt(1.0 - std::pow(r / c.radius_mm, 2.0)) : 0.0;
}

TEST(EntryFace, IsHalfAnEllipsoidOverTheBase) {
  for (const Cavity& c : {Cavity{4.0, 1.0}, Cavity{4.0, 4.0}, Cavity{3.0, 6.0}}) {
    const LensShape lens = with_cavity(flat_lens(), c);
    ASSERT_TRUE(lens.is_valid());
    const FaceSeat seat = face_seat(lens);
    EXPECT_EQ(seat.radius_mm(), 12.0);
    for (double r = 0.0; r < 12.0; r += 0.3) {
      if (std::abs(r - c.radius_mm) < 0.05) continue;
      EXPECT_NEAR(seat.height_mm(r), 1.0 + ellipse_mm(c, r), 0.004 * c.depth_mm)
          << r << ": " << c.radius_mm << " x " << c.depth_mm;
    }
  }
}

TEST(EntryFace, LiftsAFaceThatItWouldCutAndNoOther) {
  const LensShape flat = flat_lens();
  const auto vertex = [](const LensShape& lens) { return -face_of(lens, 24).at(0.0, 0.0).z_mm; };
  EXPECT_NEAR(vertex(with_cavity(flat, {4.0, 4.0})), 9.0, 0.01);
  const LensShape deep = with_cavity(flat, {8.0, 9.0});
  EXPECT_TRUE(deep.is_valid());
  EXPECT_GT(vertex(deep), 10.3) << "over the cavity's 10 mm";
  EXPECT_NEAR(-face_of(deep, 24).at(11.9, 0.0).z_mm, -face_of(flat, 24).at(11.9, 0.0).z_mm, 0.2)
      << "the wall is where it was";
}

TEST(EntryFace, WithoutDepthTheBaseIsFlat) {
  const FaceSeat seat = face_seat(with_cavity(with_cavity(flat_lens(), {4.0, 4.0}), {}));
  EXPECT_EQ(seat.height_mm(0.0), 1.0);
  EXPECT_EQ(seat.height_mm(6.0), 1.0);
}

// Light of a point in the middle of a hemisphere enters without a bend; with a flat base it bends.
TEST(EntryFace, AHemisphereAboutTheSourceBendsNothing) {
  const LensShape round = with_cavity(flat_lens(), {5.0, 5.0});
  const auto into = into_lens(round, {1.5, 0.0}), into_flat = into_lens(flat_lens(), {1.5, 0.0});
  for (const double deg : {5.0, 40.0, 75.0}) {
    const double a = deg * std::numbers::pi / 180.0;
    // A design's light goes down.
    const Ray given{{0.0, 0.0, -1.0}, Direction::from({std::sin(a), 0.0, -std::cos(a)})};
    Ray ray = given;
    EXPECT_NEAR(into(ray), 0.96, 1e-4) << "Fresnel's loss at normal incidence";
    EXPECT_NEAR(angle_between(ray.direction, given.direction), 0.0, 2e-3) << deg;
    EXPECT_NEAR(std::hypot(ray.origin_mm.x, ray.origin_mm.z + 1.0), 5.0, 5e-3);
  }
  Ray bent{{0.0, 0.0, -0.5}, Direction::from({0.6, 0.0, -0.8})};
  ASSERT_GT(into_flat(bent), 0.9);
  EXPECT_NEAR(bent.direction.x(), 0.4, 1e-9);
}

/// The angle between the side of a cavity at its rim and the axis.
double draft_deg(const LensShape& lens, const Cavity& c) {
  const FaceSeat seat = face_seat(lens);
  const double r = 0.98 * c.radius_mm, d = 0.01 * c.radius_mm;
  return degrees(std::atan2(d, seat.height_mm(r) - seat.height_mm(r + d)));
}

TEST(EntryFace, HasADraft) {
  const Cavity c{5.0, 3.0};
  const LensShape upright = with_cavity(flat_lens(), c), drafted = with_cavity(flat_lens(), c, 25.0);
  EXPECT_LT(draft_deg(upright, c), 20.0);
  EXPECT_GT(draft_deg(drafted, c), 25.0);
  EXPECT_LT(draft_deg(drafted, c), 32.0);
  EXPECT_NEAR(face_seat(drafted).height_mm(0.0), 4.0, 1e-9) << "as deep as without";
  EXPECT_EQ(face_seat(drafted).height_mm(5.5), 1.0);
  EXPECT_THROW(static_cast<void>(with_cavity(flat_lens(), {3.0, 6.0}, 15.0)), InputError)
      << "no ellipsoid so deep has that draft";
}

TEST(EntryFace, FitsWithinTheBaseAndTheHeight) {
  const CavityRange free = cavity_range(flat_lens(), {});
  EXPECT_NEAR(free.max_radius_mm, 0.95 * 12.0, 1e-12);
  EXPECT_NEAR(free.max_depth_mm, 0.8 * 12.0, 1e-12) << "of the wall's radius, which is more than the height";
  LensLimits limits;
  limits.max_height_mm = 10.0;
  EXPECT_NEAR(cavity_range(flat_lens(), limits).max_depth_mm, 8.0, 1e-12);
  LensLimits thick;
  thick.min_thickness_mm = 2.0;
  EXPECT_NEAR(cavity_range(flat_lens(), thick).max_radius_mm, 10.0, 1e-12) << "of the ring about it";
  // A cavity that is there, with a flat base about it.
  const CavityRange again = cavity_range(with_cavity(flat_lens(), {4.0, 4.0}), limits);
  EXPECT_NEAR(again.max_radius_mm, free.max_radius_mm, 1e-12);
  // A cavity whose base rises ends at its rim.
  const std::vector<OutlinePoint> cone{{0, 3}, {5, 1}, {12, 2}, {12, 4}, {8, 6.2}, {4, 7.3}, {0, 7.6}};
  const LensShape rising(cone, 20.0, std::vector<std::size_t>{3}, 0);
  EXPECT_NEAR(cavity_range(rising, limits).max_radius_mm, 0.95 * 5.0, 1e-12);
}

TEST(EntryFace, SmoothOutlinesHaveMoreCorners) {
  const LensShape fine = with_cavity(flat_lens(5.0), {6.0, 1.0});
  EXPECT_GT(fine.corners().size(), with_cavity(flat_lens(), {6.0, 1.0}).corners().size());
  EXPECT_NEAR(face_seat(fine).height_mm(5.0), 1.0 + ellipse_mm({6.0, 1.0}, 5.0), 1e-3) << "no edges within";
}

// A disk of 2 mm radius at 1.5 mm, half a millimetre over the plane of the base, within a cavity.
TEST(EntryFace, MayNotTakeTheSourceIn) {
  const LensShape given = with_cavity(flat_lens(), {5.0, 5.0});
  const Project project = parse_project(R"([[source]]
kind = "disk"
radius_mm = 2
position_mm = [0, 0, 1.5]
)",
                                        "source.toml");
  DesignRays rays(project.scene.sources, Frame(), 1);
  rays.grow(1 << 12);
  EXPECT_FALSE(takes_source_in(given, given, rays));
  EXPECT_FALSE(takes_source_in(with_cavity(given, {3.0, 3.0}), given, rays));
  EXPECT_TRUE(takes_source_in(with_cavity(given, {1.5, 3.0}), given, rays)) << "the disk's rim";
  EXPECT_TRUE(takes_source_in(with_cavity(given, {}), given, rays));
  // Where all of the source is in the medium to begin with, it may be.
  EXPECT_FALSE(takes_source_in(with_cavity(flat_lens(), {0.5, 0.2}), flat_lens(), rays));
}

/// Of a point source at the origin of the lens.
DesignRays point_below() {
  EmitterOptions options;
  options.kind = EmitterKind::point;
  DesignRays rays({{make_emitter(options), Frame(), {}}}, lens_from_design().inverse(), 1);
  rays.grow(kBlockRays * kDesignTasks);
  return rays;
}

TEST(FreeEntry, IsTheBaseWithinAFlange) {
  const DesignShape flat = entry_of(flat_lens(), {}, 24);
  EXPECT_NEAR(flat.aperture().half_x_mm(), 0.98 * 12.0, 1e-12);
  EXPECT_NEAR(-flat.at(0.0, 10.0).z_mm, 1.06, 1e-9) << "a little above the base";
  const LensShape lens = with_cavity(flat_lens(), {6.0, 3.0}, 40.0);
  const DesignShape entry = entry_of(lens, {}, 24);
  EXPECT_NEAR(entry.aperture().half_x_mm(), 6.0, 1e-12) << "as wide as the cavity";
  for (const double r : {0.0, 2.0, 4.0, 5.9})
    EXPECT_NEAR(-entry.at(0.0, r).z_mm, face_seat(lens).height_mm(r) + 0.06, 0.02) << r;
  EXPECT_NEAR(-entry.at(6.0, 0.0).z_mm, 1.06, 0.02) << "up to the rim, beyond which it falls on";
  const FaceSeat seat = seat_over(lens, entry);
  EXPECT_EQ(seat.radius_mm(), 12.0);
  EXPECT_EQ(seat.lowest_mm(), 1.0);
  EXPECT_EQ(seat.height_mm(3.0, 1.0), -entry.at(3.0, 1.0).z_mm);
  EXPECT_EQ(seat.height_mm(11.9), 1.0);
  Solid solid;
  solid.outline_mm = lens.corners();
  EXPECT_NO_THROW(check(with_face(solid, seat, face_of(lens, 16))));
}

// Each limit by itself: broken by what is beyond it, and by nothing else.
TEST(FreeEntry, StaysBetweenBaseSourceAndLastFace) {
  const LensShape lens = flat_lens();
  const DesignShape entry = entry_of(lens, {}, 8), last = face_of(lens, 16);
  const SourceEnd source = source_end(point_below());
  EXPECT_NEAR(source.low_mm, 0.0, 1e-6);
  EXPECT_NEAR(source.radius_mm, 0.0, 1e-6);
  const auto cost = [&](const LensLimits& limits, const DesignShape& with) {
    return entry_limits(limits, lens, entry, last, source, kFitRings).cost(with, nullptr);
  };
  const auto at = [&](double z) { return entry.through([z](double, double) { return -z; }); };
  LensLimits limits;
  EXPECT_EQ(cost(limits, at(2.0)), 0.0);
  EXPECT_GT(cost(limits, at(0.9)), 0.1) << "below the base";
  EXPECT_GT(cost(limits, at(8.0)), 0.1) << "through the last face, whose rim is at 3";
  limits.min_thickness_mm = 2.0;
  EXPECT_GT(cost(limits, at(2.0)), 0.1) << "1.2 mm below the rim";
  const auto cone = entry.through([](double x, double y) { return -1.2 - 0.1 * std::hypot(x, y); });
  EXPECT_EQ(cost({}, cone), 0.0);
  LensLimits draft;
  draft.min_draft_deg = 86.0;
  EXPECT_GT(cost(draft, cone), 0.1) << "it leaves the axis by 84 degrees";
}

// Snell and Fresnel in closed form, at a tilted plane.
TEST(FreeEntry, RaysComeInByIt) {
  const DesignShape flat =
      entry_of(flat_lens(), {}, 4).through([](double x, double) { return -2.0 - 0.5 * x; });
  const auto into = into_entry(flat, {1.5, 0.1});
  Ray ray{{0, 0, 0}, Direction::from({0, 0, -1})};
  const double share = into(ray);
  const double c = 2.0 / std::sqrt(5.0), t = std::sqrt(1.0 - (1.0 - c * c) / 2.25);
  const double s = (c - 1.5 * t) / (c + 1.5 * t), p = (1.5 * c - t) / (1.5 * c + t);
  EXPECT_NEAR(share, 1.0 - 0.5 * (s * s + p * p), 1e-9);
  EXPECT_NEAR(ray.origin_mm.z, -2.0, 1e-9);
  // The tangential part over the index: the tangent is along (1, 0, -0.5).
  const Vec3 tangent = Direction::from({1, 0, -0.5}).vec();
  EXPECT_NEAR(dot(ray.direction, tangent), dot(Vec3{0, 0, -1}, tangent) / 1.5, 1e-9);
  Ray aside{{11.9, 0, 0}, Direction::from({0, 0, -1})};
  EXPECT_EQ(into(aside), 0.0) << "on the flange";
  Ray up{{0, 0, -4}, Direction::from({0, 0, 1})};
  EXPECT_EQ(into(up), 0.0) << "from within";
}

}  // namespace
}  // namespace lucerna
