// SPDX-License-Identifier: Apache-2.0
#include "lucerna/results/json/trace_json.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "lucerna/photometric_metrics.h"
#include "lucerna/source.h"
#include "lucerna/trace.h"

namespace lucerna {
namespace {

/// A disk over a paraboloid that catches part of its light.
Scene half_caught(double flux) {
  Scene scene;
  PlacedSource source;
  source.rays = make_emitter({.kind = EmitterKind::sphere, .radius_mm = 1.0, .flux = flux});
  scene.sources.push_back(source);
  const Reflector mirror = conic_reflector(ConicPreset::parabola, 15.0, 0.0, Aperture::circle(60.0));
  const Frame placed = Frame::from_axis(Direction::from({0, 0, -1}), 0.0, {0, 0, 15});
  scene.reflectors.push_back({mirror, placed, Reflectance(0.8)});
  scene.far_fields.push_back({"far", 15.0, 2.5});
  return scene;
}

TEST(TraceMetrics, EverythingThatLeavesIsInTheFarField) {
  TraceOptions options;
  options.last_ray = 40'000;
  const TraceMetrics figures = trace_metrics(trace(half_caught(500.0), options));
  const Ledger& l = figures.ledger;
  EXPECT_GT(l.out_direct.mean, 100.0);
  EXPECT_GT(l.out_reflected.mean, 100.0);
  ASSERT_EQ(figures.far_fields.size(), 1u);
  const FarFieldResult& f = figures.far_fields[0];
  const Estimate flux = f.metrics.flux;
  EXPECT_NEAR(flux.mean, l.out_direct.mean + l.out_reflected.mean, 1e-9);
  EXPECT_NEAR(total_flux(f.intensity.distribution), flux.mean, 1e-6 * flux.mean);
  EXPECT_GT(f.noise, 0.0);
  EXPECT_GT(f.node_noise, 0.0);
  EXPECT_GT(f.metrics.axis_cd.standard_error, 0.0);
  EXPECT_LT(f.metrics.axis_cd.standard_error, 0.2 * f.metrics.axis_cd.mean);
}

TEST(TraceMetrics, NoiseFallsWithTheRootOfTheRays) {
  TraceOptions options;
  options.sequence = SequenceKind::random;
  options.last_ray = 1 << 17;
  const double few = trace_metrics(trace(half_caught(500.0), options)).far_fields[0].noise;
  options.last_ray = 1 << 21;
  const double many = trace_metrics(trace(half_caught(500.0), options)).far_fields[0].noise;
  EXPECT_NEAR(few / many, 4.0, 0.6);
}

TEST(TraceMetrics, JsonClosesAndUnknownErrorsAreNull) {
  TraceOptions options;
  options.last_ray = 300;  // one replicate only: no error can be known
  const nlohmann::ordered_json json = trace_json(trace_metrics(trace(half_caught(500.0), options)));
  const auto& ledger = json["ledger"];
  double sum = 0.0;
  for (const char* part : {"out_direct", "out_reflected", "lost"}) sum += ledger[part]["value"].get<double>();
  for (const auto& [cause, flux] : ledger["absorbed"].items()) sum += flux["value"].get<double>();
  EXPECT_NEAR(sum, ledger["emitted"].get<double>(), 1e-9);
  EXPECT_TRUE(ledger["out_direct"]["standard_error"].is_null());
  EXPECT_TRUE(json["detectors"][0]["noise"].is_null());
  EXPECT_TRUE(json["detectors"][0]["centre"]["intensity"]["standard_error"].is_null());
}

}  // namespace
}  // namespace lucerna
