// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <vector>

#include "lucerna/bsdf.h"
#include "lucerna/optics/shapes/faceted_surface.h"
#include "lucerna/source.h"
#include "lucerna/source/emitters/draw_rays.h"
#include "lucerna/trace.h"
#include "tests/support/meshes.h"

/// What both the CPU's stand-in for a GPU and real GPUs are tested with.
namespace lucerna::test {

/// A lamp in a deep mirror with a second mirror across its light and a third along it, which is met on both
/// sides, and every kind of detector.
inline Scene scene_of(std::shared_ptr<const RaySource> rays) {
  const Reflector deep = profile_reflector({{0.0, 0.0}, {10.0, 3.0}, {20.0, 4.0}, {30.0, 12.0}, {45.0, 40.0}},
                                           Aperture::circle(90.0, 8.0));
  const Reflector flat = conic_reflector(ConicPreset::parabola, 200.0, 0.0, Aperture::rectangle(30.0, 40.0));
  Scene scene;
  scene.sources = {{std::move(rays), Frame::from_axis(Direction::from({1, 2, 3}), 0.3, {1, 0, 0}), 800.0}};
  scene.reflectors = {
      {deep, Frame::from_axis(Direction::from({0.1, 0, -1}), 0.0, {0, 0, 15}),
       Reflectance({{0.0, 0.9}, {45.0, 0.8}, {80.0, 0.95}}), 0.0},
      {flat, Frame::from_axis(Direction{}, 0.0, {10, 0, -50}), Reflectance(0.7), 3.0},
      {flat, Frame::from_axis(Direction::from({1, 0, 0.3}), 0.0, {-20, 0, -60}), Reflectance(0.6), 0.0}};
  scene.far_fields = {{"far", 5.0, 1.0}, {"coarse", 30.0, 10.0}};
  scene.planes = {{"road", {Frame::from_axis(Direction{}, 0.0, {0, 0, -3000}), 9000.0, 9000.0, 50, 40}}};
  scene.luminances = {
      {"view",
       {Frame::from_axis(Direction::from({0, 0.1, -1}), 0.0, {0, 0, 0}), 120.0, 120.0, 30, 30},
       10.0}};
  scene.ray_detectors = {{}};
  return scene;
}

inline std::shared_ptr<const RaySource> cylinder() { return make_emitter({.kind = EmitterKind::cylinder}); }

inline std::shared_ptr<RaySet> rays_of(const RaySource& source, std::size_t n) {
  auto set = std::make_shared<RaySet>();
  set->header.set_flux(1000.0);
  set->rays = draw_rays(source, Sequence(SequenceKind::random, 5), n);
  return set;
}

inline void expect_same(const TraceResult& a, const TraceResult& b) {
  ASSERT_EQ(a.replicates.size(), b.replicates.size());
  for (std::size_t r = 0; r < a.replicates.size(); ++r) EXPECT_TRUE(a.replicates[r] == b.replicates[r]) << r;
  EXPECT_TRUE(a.out_rays == b.out_rays);
  EXPECT_TRUE(a.out_runs == b.out_runs);
}

/// What every sum of a replicate must add up to.
inline void expect_closed(const TraceResult& result) {
  for (const Tally& t : result.replicates) {
    std::int64_t ends = t.out_direct + t.out_reflected;
    for (const std::int64_t x : t.absorbed) ends += x;
    for (const std::int64_t x : t.lost) ends += x;
    EXPECT_EQ(t.emitted, ends);
  }
}

/// A mirror of every family that is traced as a height field.
inline std::vector<Reflector> families() {
  const Aperture round = Aperture::circle(90.0, 12.0), box = Aperture::rectangle(90.0, 70.0);
  return {conic_reflector(ConicPreset::parabola, 15.0, 0.0, round),
          conic_reflector(ConicPreset::ellipse, 25.0, 120.0, round),
          conic_reflector(ConicPreset::hyperbola, 25.0, 120.0, box),
          profile_reflector({{0.0, 10.0}, {20.0, 6.0}, {30.0, 3.0}, {45.0, -5.0}}, round),
          conic_trough(ConicPreset::parabola, 10.0, 0.0, box)};
}

/// Mirrors of every family that is no height field: profiles that close in again, revolved and drawn along y,
/// and facets, flat and bulging.
inline std::vector<Reflector> exact_families() {
  const std::vector<ProfileKnot> closing{{6.0, 0.0}, {30.0, 5.0}, {45.0, 30.0}, {40.0, 48.0}, {36.0, 52.0}};
  const Reflector base = conic_reflector(ConicPreset::parabola, 15.0, 0.0, Aperture::circle(90.0, 12.0));
  const Aperture box = Aperture::rectangle(90.0, 70.0);
  return {
      deep_ellipse_reflector(12.0, 90.0, 40.0),
      profile_reflector(closing, Aperture::circle(72.0, 12.0)),
      profile_trough(closing, Aperture::rectangle(92.0, 70.0)),
      {std::make_shared<FacetedSurface>(base.surface, 6.0, 20.0), base.aperture},
      {std::make_shared<FacetedSurface>(base.surface, 4.0, std::numeric_limits<double>::infinity()), box}};
}

/// The same with one mirror instead of the two.
inline Scene scene_of(std::shared_ptr<const RaySource> rays, const Reflector& mirror) {
  Scene scene = scene_of(std::move(rays));
  scene.reflectors = {{mirror, Frame::from_axis(Direction{}, 0.0, {0, 0, -12}), Reflectance(0.9), 0.0}};
  return scene;
}

/// A clear glass close about the source, a grey one across the light below, and a thick one aslant whose rim
/// takes light.
inline Scene with_glasses(Scene scene) {
  scene.glasses = {
      {.name = "tube",
       .aperture = Aperture::rectangle(40.0, 30.0),
       .thickness_mm = 1.0,
       .world_from_glass = Frame::from_axis(Direction::from({1, 0, 0.2}), 0.0, {4, 0, 0})},
      {.name = "front",
       .aperture = Aperture::circle(120.0),
       .refractive_index = 1.6,
       .absorption_per_mm = 0.02,
       .world_from_glass = Frame::from_axis(Direction{}, 0.0, {0, 0, -40})},
      {.name = "block",
       .aperture = Aperture::circle(30.0),
       .thickness_mm = 15.0,
       .refractive_index = 2.4,
       .absorption_per_mm = 0.01,
       .world_from_glass = Frame::from_axis(Direction::from({0.3, 0.2, 1}), 0.0, {-12, 5, -30})}};
  return scene;
}

/// Lobes of every kind on both mirrors of a scene.
inline Scene with_lobes(Scene scene) {
  scene.reflectors[0].scatter = Scatter({lambert_lobe(0.2), abg_lobe(0.01, 1e-4, 2.0)});
  scene.reflectors[1].scatter = Scatter({gaussian_lobe(0.6, 0.05)});
  return scene;
}

/// A measured table on both, in the angles of Zemax or of LightTools.
inline Scene with_table(Scene scene, bool about_normal) {
  BsdfTable table;
  table.is_about_normal = about_normal;
  table.incidence_deg = {0.0, 40.0};
  table.azimuth_deg = {0.0, 180.0};
  table.radial_deg = {0.0, 5.0, 60.0};
  table.brdf = {5.0, 1.0, 0.0, 5.0, 1.0, 0.1, 7.0, 1.0, 0.0, 7.0, 1.0, 0.2};
  table.total = {0.8, 0.8};
  for (PlacedReflector& mirror : scene.reflectors) mirror.scatter = Scatter(table);
  return scene;
}

/// The lamp's own body about the source, a shield, an open mirror that scatters a little, and a smooth one.
inline Scene with_bodies(Scene scene) {
  const auto add = [&](const char* name, std::shared_ptr<const Mesh> mesh, const Frame& frame,
                       double reflected) {
    Body body;
    body.name = name;
    body.mesh = std::move(mesh);
    body.world_from_body = frame;
    body.reflectance = Reflectance(reflected);
    scene.bodies.push_back(body);
  };
  add("lamp", globe(24, 5.0), {}, 0.0);
  scene.bodies.back().only_returning_light = true;
  add("shield", box_mesh({6.0, 9.0, 1.0}), Frame::from_axis(Direction::from({0.2, 0, 1}), 0.4, {3, 4, -25}),
      0.0);
  add("sheet", sheet(12, 20.0, 0.0, 0.0),
      Frame::from_axis(Direction::from({1, 0.3, 0.5}), 0.1, {-50, 0, -30}), 0.0);
  scene.bodies.back().reflectance = Reflectance({{0.0, 0.6}, {60.0, 0.9}});
  scene.bodies.back().slope_error_mrad = 5.0;
  add("bowl", sheet(40, 25.0, 0.02, 0.0), Frame::from_axis(Direction::from({0, -1, 0.4}), 0.0, {0, 60, -20}),
      0.8);
  scene.bodies.back().smooth_below_deg = 30.0;
  return scene;
}

/// How the rays that left two traces compare, pairwise by number.
struct RayPairs {
  std::size_t rays = 0, differ = 0;
  double max_mm = 0.0, max_direction = 0.0;
};

/// Pairs the rays of two traces of one scene, run by run. Where one of the two has a ray less, the next that
/// both have is looked for.
class RayPairing {
 public:
  RayPairing(const TraceResult& a, const TraceResult& b) : a_(a.out_rays), b_(b.out_rays) {}

  /// Rays [i, i_end) of the first and [j, j_end) of the second.
  void add(std::size_t i, std::size_t i_end, std::size_t j, std::size_t j_end) {
    pairs_.rays += i_end - i;
    while (i < i_end && j < j_end) {
      if (!same(i, j)) {
        std::size_t skip_i = 1, skip_j = 1;
        for (std::size_t s = 1; s <= kLookAhead; ++s) {
          const bool both = i + s < i_end && j + s < j_end && same(i + s, j + s);
          if (!both && !(i + s < i_end && same(i + s, j)) && !(j + s < j_end && same(i, j + s))) continue;
          skip_i = both || (i + s < i_end && same(i + s, j)) ? s : 0;
          skip_j = both || skip_i == 0 ? s : 0;
          break;
        }
        pairs_.differ += std::max(skip_i, skip_j);
        i += skip_i;
        j += skip_j;
        continue;
      }
      pairs_.max_mm = std::max(pairs_.max_mm, apart_mm(i, j));
      pairs_.max_direction = std::max(pairs_.max_direction, turn(i++, j++));
    }
    pairs_.differ += (i_end - i) + (j_end - j);
  }
  const RayPairs& pairs() const { return pairs_; }

 private:
  static constexpr std::size_t kLookAhead = 4;
  double apart_mm(std::size_t i, std::size_t j) const { return length(a_.origin_mm(i) - b_.origin_mm(j)); }
  double turn(std::size_t i, std::size_t j) const {
    return length(a_.direction(i).vec() - b_.direction(j).vec());
  }
  /// Else other hits than rounding explains: a ray that grazes an edge takes another way.
  bool same(std::size_t i, std::size_t j) const { return apart_mm(i, j) <= 1e-4 && turn(i, j) <= 1e-5; }

  const RayBlock &a_, &b_;
  RayPairs pairs_;
};

inline RayPairs compare_rays(const TraceResult& a, const TraceResult& b) {
  RayPairing pairing(a, b);
  std::size_t i = 0, j = 0, k = 0;
  for (const OutRun& run : a.out_runs) {
    while (k < b.out_runs.size() && b.out_runs[k].block < run.block) j += b.out_runs[k++].rays;
    const bool both = k < b.out_runs.size() && b.out_runs[k].block == run.block;
    const std::size_t others = both ? b.out_runs[k++].rays : 0;
    pairing.add(i, i + run.rays, j, j + others);
    i += run.rays;
    j += others;
  }
  return pairing.pairs();
}

}  // namespace lucerna::test
