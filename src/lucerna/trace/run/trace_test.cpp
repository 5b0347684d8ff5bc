// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "lucerna/core/io/error.h"
#include "lucerna/core/parallel/parallel.h"
#include "lucerna/source.h"
#include "lucerna/trace/detectors/far_field_grid.h"
#include "lucerna/trace/engines/reference_tracer.h"
#include "lucerna/trace/result/far_field_counts.h"

namespace lucerna {
namespace {

PlacedSource emitter_at(const EmitterOptions& options, const Vec3& position_mm = {}) {
  return {make_emitter(options), Frame::from_axis(Direction{}, 0.0, position_mm), std::nullopt};
}

/// A paraboloid of 100 mm with the light source at its focus, opening along -z as a downlight does.
Scene downlight(PlacedSource source, double reflectance = 0.9) {
  const Reflector mirror = conic_reflector(ConicPreset::parabola, 15.0, 0.0, Aperture::circle(100.0, 4.0));
  const Frame placed = Frame::from_axis(Direction::from({0, 0, -1}), 0.0, {0, 0, 15});
  return {{std::move(source)}, {{mirror, placed, Reflectance(reflectance)}}, {{"far", 5.0, 1.0}}};
}

double sum_of(const std::vector<double>& v) { return std::accumulate(v.begin(), v.end(), 0.0); }

TEST(Trace, ParaboloidCollimatesAPointAtItsFocus) {
  Scene scene = downlight(emitter_at({.kind = EmitterKind::point, .flux = 500.0}));
  scene.far_fields = {{"fine", 360.0, 1e-3}};
  const TraceResult result = trace(scene, {.last_ray = 100000});
  const FarField far = far_field(result, 0);
  const Ledger l = ledger(result);
  // All reflected light is in the cell about nadir, half a thousandth of a degree wide; the direct light that
  // goes the same way is less than 1e-9 of it.
  EXPECT_NEAR(far.flux[0], l.out_reflected.mean, 1e-6 * l.emitted);
  EXPECT_GT(l.out_reflected.mean, 200.0);
}

// Solid angles in closed form: the rim of the paraboloid is seen from its focus at angle theta with
// tan(theta / 2) = r / (2 f); what passes rim and hole leaves directly.
TEST(TraceStatistical, SharesOfAPointSourceAreSolidAngles) {
  const TraceResult result = trace(downlight(emitter_at({.kind = EmitterKind::point, .flux = 1.0})),
                                   {.last_ray = 400000, .sequence = SequenceKind::random});
  const Ledger l = ledger(result);
  const double rim = 2.0 * std::atan(50.0 / 30.0), hole = 2.0 * std::atan(2.0 / 30.0);
  const double caught = 0.5 * (std::cos(hole) - std::cos(rim));
  EXPECT_NEAR(l.out_direct.mean, 1.0 - caught, 5.0 * l.out_direct.standard_error);
  EXPECT_NEAR(l.out_reflected.mean, 0.9 * caught, 5.0 * l.out_reflected.standard_error);
  const double binomial = std::sqrt(caught * (1.0 - caught) / 400000.0);
  EXPECT_NEAR(l.out_direct.standard_error, binomial, 0.6 * binomial);
}

TEST(Trace, LedgerClosesToTheUnit) {
  const TraceResult result =
      trace(downlight(emitter_at({.kind = EmitterKind::sphere, .radius_mm = 6.0}, {15, 0, 0})),
            {.last_ray = 50000, .max_bounces = 1});
  std::int64_t lost = 0, binned = 0, out = 0;
  for (const Tally& t : result.replicates) {
    const std::int64_t absorbed = t.absorbed[0] + t.absorbed[1];
    lost += t.lost[0] + t.lost[1];
    EXPECT_EQ(t.emitted, t.out_direct + t.out_reflected + absorbed + t.lost[0] + t.lost[1]);
    binned += std::accumulate(t.bins[0].begin(), t.bins[0].end(), std::int64_t{0});
    out += t.out_direct + t.out_reflected;
  }
  EXPECT_EQ(binned, out);
  EXPECT_GT(lost, 0) << "after one reflection some light must still be inside";
  const Ledger l = ledger(result);
  double total = l.out_direct.mean + l.out_reflected.mean;
  for (const auto& [cause, e] : l.absorbed) total += e.mean;
  for (const auto& [cause, e] : l.lost) total += e.mean;
  EXPECT_NEAR(total, l.emitted, 1e-9 * l.emitted);
  EXPECT_NEAR(sum_of(far_field(result, 0).flux), l.out_direct.mean + l.out_reflected.mean, 1e-9 * l.emitted);
}

TEST(Trace, EllipseSendsFocusToFocus) {
  const double f1 = 10.0, f2 = 80.0;
  const ReferenceTracer mirror(conic_reflector(ConicPreset::ellipse, f1, f2, Aperture::circle(50.0)));
  RayBlock rays;
  rays.resize(5000);
  make_emitter({.kind = EmitterKind::point})->emit(Sequence(SequenceKind::random, 1), 0, rays);
  int met = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Ray ray{{0, 0, f1}, rays.direction(i)};
    const auto hit = mirror.first_hit(ray);
    if (!hit) continue;
    ++met;
    const Vec3 to_focus = Vec3{0, 0, f2} - hit->point_mm;
    EXPECT_LT(length(cross(reflect(ray.direction, hit->normal).vec(), to_focus)), 1e-8);
  }
  EXPECT_GT(met, 1000);
}

TEST(Trace, SameBitsForAnyNumberOfThreads) {
  const Scene scene = downlight(emitter_at({.kind = EmitterKind::cylinder}));
  const auto run = [&](int threads) {
    const ThreadLimit limit(threads);
    return trace(scene, {.last_ray = 70001, .seed = 9}).replicates;
  };
  EXPECT_EQ(run(1), run(2));
  EXPECT_NE(run(1), trace(scene, {.last_ray = 70001, .seed = 10}).replicates) << "the seed must matter";
}

TEST(Trace, RangesAddToTheSameBits) {
  Scene scene = downlight(emitter_at({.kind = EmitterKind::led}));
  scene.sources.push_back(emitter_at({.kind = EmitterKind::disk, .flux = 300.0}, {1, 2, 0}));
  const TraceResult whole = trace(scene, {.last_ray = 60000});
  const TraceResult a = trace(scene, {.last_ray = 12345});
  const TraceResult b = trace(scene, {.first_ray = 12345, .last_ray = 60000});
  const TraceResult sum = merge(b, a);
  EXPECT_EQ(sum.replicates, whole.replicates);
  EXPECT_EQ(sum.first_ray, 0u);
  EXPECT_EQ(sum.last_ray, 60000u);
  EXPECT_THROW(merge(a, a), InputError);
  EXPECT_THROW(merge(a, trace(scene, {.first_ray = 12345, .last_ray = 60000, .seed = 5})), InputError);
}

TEST(TraceStatistical, TwoSourcesAdd) {
  const PlacedSource one = emitter_at({.kind = EmitterKind::cylinder, .flux = 700.0});
  const PlacedSource two = emitter_at({.kind = EmitterKind::disk, .flux = 300.0}, {0, 0, 2});
  Scene both = downlight(one);
  both.sources.push_back(two);
  both.far_fields = {{"far", 30.0, 10.0}};
  const auto run = [&](std::vector<PlacedSource> sources) {
    Scene scene = both;
    scene.sources = std::move(sources);
    return trace(scene, {.last_ray = 200000, .sequence = SequenceKind::random});
  };
  const TraceResult sum = run({one, two}), first = run({one}), second = run({two});
  EXPECT_EQ(ledger(sum).emitted, 1000.0);
  const FarField s = far_field(sum, 0), a = far_field(first, 0), b = far_field(second, 0);
  double chi2 = 0.0;
  int cells = 0;
  for (std::size_t i = 0; i < s.flux.size(); ++i) {
    if (s.flux[i] < 1.0) continue;
    const double e = std::hypot(s.standard_error[i], std::hypot(a.standard_error[i], b.standard_error[i]));
    chi2 += std::pow((s.flux[i] - a.flux[i] - b.flux[i]) / e, 2);
    ++cells;
  }
  ASSERT_GT(cells, 50);
  EXPECT_LT(chi2 / cells, 2.0);
}

TEST(Trace, ARayFileGivesEveryRayOnceWithItsWeight) {
  auto set = std::make_shared<RaySet>();
  set->header.set_flux(337.0);
  set->rays.resize(10007, 0);
  for (std::size_t i = 0; i < set->rays.size(); ++i) {
    // Alternately up and down the axis, with weights 1 and 3.
    set->rays.set(i, {{30, 0, 60}, Direction::from({0, 0, i % 2 == 0 ? 1.0 : -1.0})});
    set->rays.weight[i] = i % 2 == 0 ? 1.0f : 3.0f;
  }
  Scene scene = downlight({std::make_shared<RaySetSource>(set, "set"), {}, std::nullopt});
  scene.reflectors.clear();
  EXPECT_EQ(default_ray_count(scene), 10007u);
  const TraceResult result = trace(scene, {});
  const FarField far = far_field(result, 0);
  const double up = 5004.0, down = 3.0 * 5003.0;
  EXPECT_NEAR(far.flux.front(), 337.0 * down / (up + down), 1e-5);
  EXPECT_NEAR(ledger(result).out_direct.mean, 337.0, 1e-9);
}

TEST(Trace, LightFromBehindIsAbsorbedByTheBack) {
  Scene scene = downlight(emitter_at({.kind = EmitterKind::point}, {0, 0, 40}));
  scene.reflectors[0].reflector.aperture = Aperture::circle(100.0);
  const Ledger l = ledger(trace(scene, {.last_ray = 100000}));
  EXPECT_EQ(l.absorbed[1].first, "mirror_back");
  // The cone about the axis that touches the paraboloid: 25 mm above the vertex it does so 25 mm below it.
  const double touch = std::sqrt(60.0 * 25.0);
  const double shadow = 0.5 * (1.0 - 50.0 / std::hypot(50.0, touch));
  EXPECT_NEAR(l.absorbed[1].second.mean, shadow * l.emitted, 5e-4 * l.emitted);
  EXPECT_EQ(l.out_reflected.mean, 0.0);
}

TEST(Trace, ErrorsAreUnknownForOneReplicate) {
  const Ledger l = ledger(trace(downlight(emitter_at({})), {.last_ray = 100}));
  EXPECT_TRUE(std::isnan(l.out_direct.standard_error));
  EXPECT_EQ(l.rays, 100u);
}

TEST(Trace, RefusesScenesThatCannotBeTraced) {
  EXPECT_THROW(trace({}, {}), InputError);
  Scene units = downlight(emitter_at({}));
  units.sources.push_back(emitter_at({.flux_unit = FluxUnit::watt}));
  EXPECT_THROW(trace(units, {}), InputError);
  Scene steps = downlight(emitter_at({}));
  steps.far_fields[0].gamma_step_deg = 7.0;
  EXPECT_THROW(trace(steps, {}), InputError);
  Scene twins = downlight(emitter_at({}));
  twins.far_fields.push_back(twins.far_fields[0]);
  EXPECT_THROW(trace(twins, {}), InputError);
  const Scene good = downlight(emitter_at({}));
  EXPECT_THROW(trace(good, {.first_ray = 5, .last_ray = 5}), UsageError);
  EXPECT_THROW(trace(good, {.last_ray = 10, .max_bounces = 0}), UsageError);
}

TEST(Trace, StopsWhenAsked) {
  class Stop final : public Progress {
   public:
    void update(std::string_view, std::uint64_t done, std::uint64_t) override { seen_ = done; }
    bool stop_requested() const override { return seen_ > 0; }

   private:
    std::uint64_t seen_ = 0;
  } stop;
  EXPECT_THROW(trace(downlight(emitter_at({})), {}, stop), Interrupted);
}

// The fast engine sees the same rays as the reference: bins differ only by rays within rounding of a border.
TEST(Trace, FastAndReferenceEnginesAgree) {
  Scene scene = downlight(emitter_at({.kind = EmitterKind::cylinder}, {0, 0, 1}));
  scene.reflectors[0].slope_error_mrad = 2.0;
  scene.reflectors[0].scatter =
      Scatter({lambert_lobe(0.1), gaussian_lobe(0.2, 0.02), abg_lobe(0.01, 1e-4, 2.0)});
  scene.reflectors[0].reflectance = Reflectance({{0.0, 0.95}, {80.0, 0.7}});
  const Reflector shield = profile_reflector({{0.0, 0.0}, {8.0, 2.0}, {12.0, 6.0}}, Aperture::circle(24.0));
  scene.reflectors.push_back(
      {shield, Frame::from_axis(Direction{}, 0.0, {0, 0, -12}), Reflectance(0.8), 0.0});
  const auto run = [&](EngineKind engine, const std::string& isa) {
    return trace(scene, {.last_ray = 60000, .engine = engine, .cells = 512, .isa = isa});
  };
  const TraceResult exact = run(EngineKind::reference, "");
  EXPECT_EQ(exact.isa, "reference");
  const FarField a = far_field(exact, 0);
  for (const char* isa : {"", "portable"}) {
    const TraceResult fast = run(EngineKind::fast, isa);
    EXPECT_THROW(merge(fast, exact), InputError);
    const FarField b = far_field(fast, 0);
    double moved = 0.0;
    for (std::size_t i = 0; i < a.flux.size(); ++i) moved += std::abs(a.flux[i] - b.flux[i]);
    EXPECT_LT(moved, 2e-3 * ledger(exact).emitted);
    EXPECT_NEAR(ledger(fast).out_direct.mean, ledger(exact).out_direct.mean, 1e-4 * ledger(exact).emitted);
    EXPECT_NEAR(ledger(fast).absorbed[0].second.mean, ledger(exact).absorbed[0].second.mean,
                1e-4 * ledger(exact).emitted);
    EXPECT_GT(ledger(fast).reflections_per_ray.mean, 0.9);
    for (const Tally& t : fast.replicates) {
      EXPECT_EQ(t.emitted,
                t.out_direct + t.out_reflected + t.absorbed[0] + t.absorbed[1] + t.lost[0] + t.lost[1]);
    }
  }
}

// A mirror with slope error s spreads a beam by 2 s in the plane of incidence and by 2 s cos i across it. On
// a paraboloid cos^2 i = (1 + cos theta) / 2 for light that leaves its focus at theta from the vertex, evenly
// in cos theta.
TEST(TraceStatistical, SlopeErrorDoublesInTheBeam) {
  Scene scene = downlight(emitter_at({.kind = EmitterKind::point}), 1.0);
  scene.reflectors[0].slope_error_mrad = 20.0;
  scene.far_fields = {{"far", 360.0, 0.05}};
  const TraceResult result = trace(scene, {.last_ray = 200000});
  const FarField far = far_field(result, 0);
  double flux = 0.0, square = 0.0;
  for (std::size_t g = 0; g < 400; ++g) {  // to 20 degrees: nearly 9 sigma; direct light is counted off below
    const double angle = radians(0.05 * static_cast<double>(g));
    const double direct = 1000.0 * 0.5 * std::sin(angle) * radians(0.05);
    flux += far.flux[g] - direct;
    square += (far.flux[g] - direct) * std::sin(angle) * std::sin(angle);
  }
  const double mean_cos =
      0.5 * (std::cos(2.0 * std::atan(50.0 / 30.0)) + std::cos(2.0 * std::atan(2.0 / 30.0)));
  EXPECT_NEAR(square / flux, 0.0016 * (1.0 + 0.5 * (1.0 + mean_cos)), 0.0016 * 0.02);
}

// A Lambertian disk of radius a lights a point on its axis at distance d with pi L a^2 / (a^2 + d^2).
TEST(TraceStatistical, IlluminanceAndLuminanceOfADisk) {
  Scene scene = downlight(emitter_at({.kind = EmitterKind::disk, .radius_mm = 5.0, .flux = 1000.0}));
  scene.reflectors.clear();
  const Frame facing_down = Frame::from_axis(Direction::from({0, 0, -1}), 0.0, {0, 0, 50});
  scene.planes = {{"plane", {facing_down, 10.0, 10.0, 1, 1}}};
  scene.luminances = {{"image", {Frame(), 20.0, 20.0, 5, 5}, 10.0}};
  for (const EngineKind engine : {EngineKind::reference, EngineKind::fast}) {
    const TraceResult result = trace(scene, {.last_ray = 1000000, .engine = engine});
    const double luminance_cd_m2 = 1000.0 / (std::numbers::pi * std::numbers::pi * 25.0) * 1e6;
    const PlaneImage lx = illuminance(result, 0);
    const double expected = std::numbers::pi * luminance_cd_m2 * 25.0 / (25.0 + 2500.0);
    // The mean over the 10 mm square is a little below the value in its middle: cos^4 falls by 2 x (x/50)^2.
    EXPECT_NEAR(lx.value[0], expected * (1.0 - 2.0 * (100.0 / 6.0) / 2525.0), 0.01 * expected);
    EXPECT_LT(std::abs(lx.standard_error[0]), 0.01 * expected);
    const PlaneImage cd = luminance(result, 0);
    EXPECT_NEAR(cd.value[12], luminance_cd_m2, 0.02 * luminance_cd_m2);
    EXPECT_EQ(cd.value[0], 0.0);
  }
}

TEST(Trace, KeptRaysCarryWhatLeft) {
  Scene scene = downlight(emitter_at({.kind = EmitterKind::cylinder}));
  scene.ray_detectors = {{}};
  const auto run = [&](int threads) {
    const ThreadLimit limit(threads);
    return trace(scene, {.last_ray = 50000});
  };
  const TraceResult a = run(1), b = run(2);
  EXPECT_EQ(a.out_rays, b.out_rays);
  double sum = 0.0;
  const FarFieldGrid grid(scene.far_fields[0]);
  std::vector<double> bins(grid.size());
  for (std::size_t i = 0; i < a.out_rays.size(); ++i) {
    sum += static_cast<double>(a.out_rays.weight[i]);
    bins[grid.cell(a.out_rays.direction(i))] += static_cast<double>(a.out_rays.weight[i]);
  }
  const Ledger l = ledger(a);
  EXPECT_NEAR(sum / 50000.0, (l.out_direct.mean + l.out_reflected.mean) / l.emitted, 1e-6);
  const FarField far = far_field(a, 0);
  double moved = 0.0;
  for (std::size_t i = 0; i < bins.size(); ++i)
    moved += std::abs(bins[i] / 50000.0 - far.flux[i] / l.emitted);
  EXPECT_LT(moved, 1e-3);
}

TEST(Reflectance, TableIsLinearInTheAngle) {
  const Reflectance r({{10.0, 0.9}, {60.0, 0.8}});
  EXPECT_NEAR(r.at(1.0), 0.9, 1e-15);
  EXPECT_NEAR(r.at(std::cos(radians(35.0))), 0.85, 1e-12);
  EXPECT_NEAR(r.at(0.0), 0.8, 1e-15);
  EXPECT_THROW(Reflectance(1.2), InputError);
  EXPECT_THROW(Reflectance({{10.0, 0.9}, {10.0, 0.8}}), InputError);
}

}  // namespace
}  // namespace lucerna
