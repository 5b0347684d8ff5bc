// SPDX-License-Identifier: Apache-2.0
// Whole scores of scenes whose light is known by formula. All rays are fixed by their seed; bounds are 5
// standard errors (one false alarm in 1.7 million) unless a line says otherwise.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include "scene.h"
#include "support.h"

namespace bench::test {
namespace {

constexpr std::uint64_t kRays = 1 << 19;
using Light = std::function<double(double u, double v)>;

/// |s f - t| / |t| over 48 x 48 boxes of a square, by the midpoint rule: what a scene must score without
/// noise. f, t: light per du dv; `measure` likewise.
double analytic_error(double half, const Light& f, const Light& t, const Light& measure) {
  constexpr int kN = 48, kFine = 40;
  double ft = 0.0, ff = 0.0, tt = 0.0;
  for (int b = 0; b < kN * kN; ++b) {
    double fb = 0.0, tb = 0.0, mb = 0.0;
    for (int k = 0; k < kFine * kFine; ++k) {
      const double u = half * (2.0 * (b % kN + (k % kFine + 0.5) / kFine) / kN - 1.0);
      const double v = half * (2.0 * (b / kN + (k / kFine + 0.5) / kFine) / kN - 1.0);
      fb += f(u, v);
      tb += t(u, v);
      mb += measure(u, v);
    }
    if (mb < 0.01 * kFine * kFine) continue;
    ft += fb * tb / mb;
    ff += fb * fb / mb;
    tt += tb * tb / mb;
  }
  return std::sqrt(std::max(0.0, 1.0 - ft * ft / (ff * tt)));
}

Json cosine(double power, const char* axis = "-z") {
  return {{"kind", "far_field"},
          {"axis", axis},
          {"function", "cosine_power"},
          {"power", power},
          {"edge_deg", 90}};
}
const Json kDisk{{"emitter", "disk"}, {"radius_mm", 1.0}};

/// A flat mirror of 4 m that looks down, 5 mm above the source: the light of a disk stays Lambertian.
Json flat_mirror() { return submission_json({mirror_json(bowl_json(0.0, 2000.0), place(5.0, -1.0))}); }

TEST(Score, LambertianLightHitsALambertianTarget) {
  const Score s = scored(task_json(kDisk, cosine(1.0)), flat_mirror(), kRays).score;
  EXPECT_LT(s.n48.excess, 5.0 * s.n48.standard_error);
  EXPECT_LT(s.n12.excess, 5.0 * s.n12.standard_error);
  EXPECT_NEAR(s.n48.floor, std::sqrt(48.0 * 48.0 / static_cast<double>(kRays)), 0.01);
  EXPECT_GT(s.nmae.noise, 0.0);
  EXPECT_NEAR(s.nmae.value, s.nmae.noise, 0.1 * s.nmae.noise);
}

// cos^1 light against a cos^3 target: light per du dv is 1 and 1 - u^2 - v^2, solid angle 1 / w.
TEST(Score, KnownMirrorScoresItsAnalyticError) {
  const Scored found = scored(task_json(kDisk, cosine(3.0)), flat_mirror(), kRays);
  const double half = found.json["rectangle"]["high"][0].get<double>();
  // The marginal of (1 - u^2 - v^2) is (1 - u^2)^(3/2): 0.25 % of it lie above the rectangle.
  double above = 0.0, all = 0.0;
  for (int k = 0; k < 1'000'000; ++k) {
    const double u = 2.0 * (k + 0.5) / 1e6 - 1.0, flux = std::pow(1.0 - u * u, 1.5);
    all += flux;
    if (u > half) above += flux;
  }
  EXPECT_NEAR(above / all, 0.0025, 2e-5);
  const auto w2 = [](double u, double v) { return std::max(0.0, 1.0 - u * u - v * v); };
  const double expected = analytic_error(
      half, [&](double u, double v) { return w2(u, v) > 0.0 ? 1.0 : 0.0; }, w2,
      [&](double u, double v) { return w2(u, v) > 0.0 ? 1.0 / std::sqrt(w2(u, v)) : 0.0; });
  EXPECT_GT(expected, 0.1);
  const BoxError& e = found.score.n48;
  EXPECT_NEAR(e.excess, expected, 5.0 * e.standard_error + 2e-4);
}

constexpr double kFocal = 20.0, kHalf = 30.0, kFar = 1000.0;
/// A point source in the focus of a paraboloid, an even square target below.
Scored beam(double shift_mm) {
  const Json target{{"kind", "plane"},
                    {"place", place(-kFar)},
                    {"function", "uniform_rectangle"},
                    {"size_mm", {2.0 * kHalf, 2.0 * kHalf}},
                    {"cells", {30, 30}}};
  Json bowl = bowl_json(1.0 / (4.0 * kFocal), 120.0);
  return scored(task_json({{"emitter", "point"}}, target),
                submission_json({mirror_json(bowl, place(kFocal + shift_mm, -1.0))}), 2 * kRays);
}

/// Illuminance of the beam: 1 / (4 pi f^2 (1 + (r / 2f)^2)^2), and of what falls directly: d / (4 pi s^3).
double illuminance(double x, double y) {
  const double r2 = x * x + y * y, q = 1.0 + r2 / (4.0 * kFocal * kFocal);
  const double s2 = kFar * kFar + r2;
  return (1.0 / (kFocal * kFocal * q * q) + kFar / (s2 * std::sqrt(s2))) / (4.0 * std::numbers::pi);
}

double beam_analytic() {
  const auto one = [](double, double) { return 1.0; };
  return analytic_error(0.995 * kHalf, illuminance, one, one);
}

TEST(Score, ParaboloidScoresItsAnalyticError) {
  const Score s = beam(0.0).score;
  EXPECT_NEAR(s.n48.excess, beam_analytic(), 5.0 * s.n48.standard_error + 2e-4);
  double mean = 0.0;
  for (int k = 0; k < 10'000; ++k)
    mean += illuminance(kHalf * ((k % 100) / 50.0 - 0.99), kHalf * ((k / 100) / 50.0 - 0.99)) / 1e4;
  EXPECT_NEAR(s.efficiency.mean, 4.0 * kHalf * kHalf * mean, 5.0 * s.efficiency.standard_error);
  // RSD over the cells wholly in 95 % of the window: 28 x 28.
  double m = 0.0, m2 = 0.0;
  for (int k = 0; k < 28 * 28; ++k) {
    const double e = illuminance(2.0 * (k % 28 - 13.5), 2.0 * (k / 28 - 13.5));
    m += e / 784.0;
    m2 += e * e / 784.0;
  }
  ASSERT_TRUE(s.rsd);
  EXPECT_NEAR(s.rsd->without_noise, std::sqrt(m2 - m * m) / m, 0.01);
}

// 1 mm along the axis: the score is not the analytic one any more by far more than noise.
TEST(Score, ShiftedMirrorIsCaught) {
  const Score s = beam(1.0).score;
  EXPECT_GT(std::abs(s.n48.excess - beam_analytic()), 10.0 * s.n48.standard_error);
}

TEST(Score, LossesAreCounted) {
  Json task = task_json(kDisk, cosine(1.0));
  task["optics"]["reflectance"] = 0.8;
  const Score s = scored(task, flat_mirror(), 1 << 16).score;
  EXPECT_NEAR(s.efficiency.mean, 0.8 * s.efficiency_lossless.mean, 1e-9);
  EXPECT_NEAR(s.mirror.mean, 0.2, 1e-3);
  EXPECT_NEAR(s.in_rectangle.mean + s.outside.mean + s.mirror.mean, 1.0, 1e-9);
}

TEST(Score, BackOfAMirrorAbsorbs) {
  const Json up = submission_json({mirror_json(bowl_json(0.0, 2000.0), place(5.0, 1.0))});
  const Score s = scored(task_json(kDisk, cosine(1.0)), up, 1 << 16).score;
  EXPECT_NEAR(s.mirror_back.mean, 1.0, 1e-3);
  Json flipped = up;
  flipped["surfaces"][0]["flip"] = true;
  EXPECT_EQ(scored(task_json(kDisk, cosine(1.0)), flipped, 1 << 16).score.mirror_back.mean, 0.0);
}

// A flat mirror sends all light of a disk back down; the part that meets the source again is lost there.
TEST(Score, SourceTakesWhatComesBack) {
  Json square{{"emitter", "rectangle"}, {"size_mm", {2.0, 2.0}}, {"blocks", true}};
  const double lost = scored(task_json(square, cosine(1.0)), flat_mirror(), kRays).score.source.mean;
  // The exchange factor of two parallel squares of side 2 at a distance of 10 (the image of the source).
  const double x = 0.2, a = 1.0 + x * x, b = std::sqrt(a);
  const double factor =
      2.0 / (std::numbers::pi * x * x) *
      (0.5 * std::log(a * a / (1.0 + 2.0 * x * x)) + 2.0 * x * b * std::atan(x / b) - 2.0 * x * std::atan(x));
  EXPECT_NEAR(lost, factor, 5.0 * std::sqrt(factor / static_cast<double>(kRays)));
}

TEST(Score, StripStaysLambertianInTwoDimensions) {
  const Json strip{{"emitter", "strip"}, {"half_width_mm", 1.0}, {"right_to_left_luminance", 3.0}};
  Json target = cosine(1.0);
  target["kind"] = "angle";
  const Scored found = scored(task_json(strip, target), flat_mirror(), kRays);
  EXPECT_LT(found.score.n48.excess, 5.0 * found.score.n48.standard_error);
  EXPECT_NEAR(found.score.nmae.value, found.score.nmae.noise, 0.35 * found.score.nmae.noise);
  target["power"] = 3.0;
  EXPECT_GT(scored(task_json(strip, target), flat_mirror(), kRays).score.n48.excess, 0.1);
}

Json glass_task(const char* model) {
  Json task = task_json(kDisk, cosine(1.0, "+z"));
  task["optics"] = {
      {"roles", {"interface"}},
      {"interface", {{"model", model}, {"refractive_index", {1.3, 1.6}}, {"absorption_per_mm", 0.0}}}};
  if (std::string(model) == "fixed") task["optics"]["interface"]["loss"] = 0.02;
  return task;
}
Json face(double z, double up) {
  Json s = mirror_json(bowl_json(0.0, 2000.0), place(z, up));
  s["role"] = "interface";
  s["refractive_index"] = 1.5;
  return s;
}

/// Unpolarised reflectance of an interface, written by tangents and sines.
double fresnel(double theta, double n) {
  const double inner = std::asin(std::sin(theta) / n);
  if (theta < 1e-6) return std::pow((n - 1.0) / (n + 1.0), 2);
  return 0.5 * (std::pow(std::sin(theta - inner) / std::sin(theta + inner), 2) +
                std::pow(std::tan(theta - inner) / std::tan(theta + inner), 2));
}

// Light through a plate with all reflections inside: (1 - R_s) / (1 + R_s) for each polarisation; the tracer
// takes unpolarised light at every hit: (1 - R) / (1 + R).
TEST(Score, PlateTransmitsByFresnelsEquations) {
  const Scored found =
      scored(glass_task("fresnel"), submission_json({face(5.0, -1.0), face(6.0, 1.0)}), kRays);
  const double half = found.json["rectangle"]["high"][0].get<double>();
  double expected = 0.0;
  constexpr int kFine = 2000;
  for (int k = 0; k < kFine * kFine; ++k) {
    const double u = half * (2.0 * (k % kFine + 0.5) / kFine - 1.0),
                 v = half * (2.0 * (k / kFine + 0.5) / kFine - 1.0);
    if (u * u + v * v >= 1.0) continue;
    const double r = fresnel(std::asin(std::sqrt(u * u + v * v)), 1.5);
    expected += (1.0 - r) / (1.0 + r) * std::pow(2.0 * half / kFine, 2) / std::numbers::pi;
  }
  const Score& s = found.score;
  EXPECT_NEAR(s.in_rectangle.mean, expected, 5.0 * s.in_rectangle.standard_error + 1e-4);
  EXPECT_GT(s.efficiency_lossless.mean, s.efficiency.mean + 0.05);
  EXPECT_TRUE(found.json["counts"].get<bool>());
}

TEST(Score, FixedLossesMultiply) {
  const Score s =
      scored(glass_task("fixed"), submission_json({face(5.0, -1.0), face(6.0, 1.0)}), 1 << 16).score;
  EXPECT_NEAR(s.efficiency.mean / s.efficiency_lossless.mean, 0.98 * 0.98, 1e-6);
}

TEST(Score, AbsorptionFollowsItsLaw) {
  Json task = glass_task("fixed");
  task["optics"]["interface"]["absorption_per_mm"] = 0.1;
  const Score s = scored(task, submission_json({face(5.0, -1.0), face(6.0, 1.0)}), 1 << 18).score;
  // Lambertian light refracted into index 1.5: paths of 1 mm / cos, cos^2 even from 1 - 1 / 2.25 to 1.
  double expected = 0.0;
  for (int k = 0; k < 10'000; ++k) {
    const double c = std::sqrt(1.0 - (k + 0.5) / 1e4 / 2.25);
    expected += 0.98 * (1.0 - std::exp(-0.1 / c)) / 1e4;
  }
  EXPECT_NEAR(s.bulk.mean, expected, 5.0 * s.bulk.standard_error + 1e-4);
}

TEST(Score, OpenLensDoesNotCount) {
  const Scored found = scored(glass_task("fresnel"), submission_json({face(5.0, -1.0)}), 1 << 16);
  EXPECT_GT(found.score.wrong_side.mean, 0.8);
  EXPECT_FALSE(found.json["counts"].get<bool>());
  EXPECT_NE(found.json["faults"][0].get<std::string>().find("are the solids closed?"), std::string::npos);
}

/// A flat sheet at z, on [x_low, x_high], from `y_far` to the parabola y = x^2 / 1000: half of the top of a
/// plate.
Json half_top(double z, double x_low, double x_high, double y_far) {
  Json s = face(z, 1.0);
  Json points = Json::array();
  const std::array<double, 3> x{x_low, 0.5 * (x_low + x_high), x_high},
      x2{x_low * x_low, x_low * x_high, x_high * x_high};
  for (std::size_t i = 0; i < 3; ++i) {
    const Json seam{x[i], x2[i] / 1000.0, 0.0}, far{x[i], y_far, 0.0};
    points.push_back(y_far > 0.0 ? Json{seam, far} : Json{far, seam});
  }
  s["bspline"] = {{"format", "lucerna-bench-surface"},
                  {"version", 1},
                  {"degree", {2, 1}},
                  {"knots_u", {0, 0, 0, 1, 1, 1}},
                  {"knots_v", {0, 0, 1, 1}},
                  {"points_mm", points}};
  return s;
}

// Two faces meet in a bent edge in full light, and each is cut into triangles at other places: some 10^-4 of
// the light passes between their chords.
TEST(Score, NoLightSlipsThroughASeam) {
  Json task = glass_task("fresnel");
  task["source"]["radius_mm"] = 0.1;
  const std::vector<Json> plate{face(0.05, -1.0), half_top(1.05, -200.0, 200.0, -200.0),
                                half_top(1.05, -200.0, 170.0, 200.0)};
  const Scored found = scored(task, submission_json(plate), kRays);
  EXPECT_EQ(found.score.wrong_side.mean, 0.0);
  EXPECT_TRUE(found.json["counts"].get<bool>());
}

TEST(Score, LimitsThatAreBrokenDoNotCount) {
  Json task = task_json(kDisk, cosine(1.0));
  task["limits"] = {{{"kind", "inside_cylinder"}, {"radius_mm", 3000}, {"z_mm", {0, 5}}},
                    {{"kind", "outside_sphere"}, {"centre_mm", {0, 0, 0}}, {"radius_mm", 6}},
                    {{"kind", "inside_box"}, {"low_mm", {-1, -1, -1}}, {"high_mm", {1, 1, 9}}}};
  const Scored found = scored(task, flat_mirror(), 1 << 14);
  const auto& limits = found.json["limits"];
  EXPECT_TRUE(limits[0]["held"].get<bool>());
  EXPECT_FALSE(limits[1]["held"].get<bool>());
  EXPECT_FALSE(limits[2]["held"].get<bool>());
  EXPECT_FALSE(found.json["counts"].get<bool>());
}

/// One sheet, folded to and fro, so many layers of 4 m above the source, with a hole through all of them:
/// light through the hole meets only what is trimmed.
Json folded(int layers) {
  Json points = Json::array(), knots{0};
  for (int i = 0; i <= layers; ++i) {
    const double x = i % 2 == 0 ? -2000.0 : 2000.0, z = 5.0 + i;
    points.push_back({{x, -2000.0, z}, {x, 2000.0, z}});
    knots.push_back(i);
  }
  knots.push_back(layers);
  const Json sheet{{"format", "lucerna-bench-surface"},
                   {"version", 1},
                   {"degree", {1, 1}},
                   {"knots_u", knots},
                   {"knots_v", {0, 0, 1, 1}},
                   {"points_mm", points},
                   {"trim", {{"kind", "circle"}, {"diameter_mm", 4000.0}, {"hole_diameter_mm", 3900.0}}}};
  return submission_json({mirror_json(sheet, place(0.0))});
}

// Triangles whose surface is trimmed away are passed, however many.
TEST(Score, LightPassesAnyNumberOfTrimmedLayers) {
  const Score s = scored(task_json(kDisk, cosine(1.0, "+z")), folded(201), 1 << 14).score;
  EXPECT_GT(s.in_rectangle.mean + s.outside.mean, 0.9);
  // All light ends somewhere.
  EXPECT_NEAR(s.in_rectangle.mean + s.outside.mean + s.mirror.mean + s.mirror_back.mean, 1.0, 1e-9);
}

// With glass: splitting and chance are in it.
TEST(Score, SameBitsOnAnyNumberOfThreads) {
  const auto bits = [](unsigned threads) {
    auto json =
        scored(glass_task("fresnel"), submission_json({face(5.0, -1.0), face(6.0, 1.0)}), 1 << 17, threads)
            .json;
    json.erase("run");
    return json.dump();
  };
  const std::string one = bits(1);
  EXPECT_EQ(one, bits(2));
  EXPECT_EQ(one, bits(5));
}

TEST(Refract, FollowsSnellAndFresnel) {
  const double brewster = std::atan(1.5);
  const Vec3 d{std::sin(brewster), 0, -std::cos(brewster)};
  const Refraction r = refract(d, {0, 0, 1}, 1.0, 1.5);
  EXPECT_NEAR(r.direction.x, std::sin(brewster) / 1.5, 1e-12);
  EXPECT_NEAR(r.reflected, 0.5 * std::pow(std::sin(2.0 * brewster - std::numbers::pi / 2), 2), 1e-12);
  EXPECT_NEAR(refract({0, 0, -1}, {0, 0, 1}, 1.0, 1.5).reflected, 0.04, 1e-12);
  EXPECT_EQ(refract(d, {0, 0, 1}, 1.5, 1.0).reflected, 1.0);
}

}  // namespace
}  // namespace bench::test
