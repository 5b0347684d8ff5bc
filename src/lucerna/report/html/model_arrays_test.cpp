// SPDX-License-Identifier: Apache-2.0
#include "lucerna/report/html/model_arrays.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "lucerna/report/html/report_model.h"
#include "lucerna/source.h"
#include "lucerna/source/adaptive/compression/adaptive_compress.h"
#include "lucerna/source/clusters/cluster_compress.h"
#include "lucerna/source/emitters/draw_rays.h"
#include "tests/support/html_check.h"

namespace lucerna {
namespace {

using Json = nlohmann::ordered_json;

/// A disk of 1 mm radius on a sphere of 10 mm about it, 500 lm.
RaySet disk_rays(EmitterKind kind = EmitterKind::disk, std::size_t n = 40'000) {
  const auto emitter = make_emitter({.kind = kind, .flux = 500.0, .surface = BoundingSurface::sphere(10.0)});
  RaySet set;
  set.header.set_flux(500.0);
  set.rays = draw_rays(*emitter, Sequence(SequenceKind::random, 3), n);
  return set;
}

Json result_of(const SourceModel& model) {
  return {{"program_version", "0"},
          {"command", "lucerna compress"},
          {"seed", 1},
          {"threads", 2},
          {"inputs", Json::array()},
          {"wall_s", {{"compress", 0.1}}},
          {"method", std::string(model.method())},
          {"rays", model.training_rays()},
          {"bytes", 12345},
          {"layers", model.layers()},
          {"leaves", model.leaves()},
          {"flux_lm", model.flux()}};
}

TEST(ModelArrays, TreesAreTheModel) {
  const auto model = compress_adaptive(disk_rays(), {});
  const auto json = model_arrays_json(*model);
  ASSERT_TRUE(json);
  std::size_t leaves = 0;
  for (const Json& layer : (*json)["layers"]) {
    for (const Json& chart : layer["charts"]) {
      for (const Json& tree : chart["trees"]) {
        const auto value = test::unpacked<float>(tree["value"]);
        const auto link = test::unpacked<std::uint32_t>(tree["link"]);
        ASSERT_EQ(value.size(), link.size());
        for (std::size_t i = 0; i < link.size(); ++i) {
          leaves += link[i] == 0 ? 1 : 0;
          EXPECT_LT(i + link[i] / 4, link.size());
        }
      }
    }
  }
  EXPECT_EQ(leaves, model->leaves());
  // A Lambertian disk of 1 mm: flux / (pi A) = 500 / (pi^2 mm^2 sr) everywhere on it.
  const double wanted = 500.0 / (M_PI * M_PI) * 1e6;
  EXPECT_NEAR((*json)["peak"].get<double>(), wanted, 0.5 * wanted);
  EXPECT_NEAR((*json)["radius_mm"].get<double>(), 1.0, 0.1);
  ASSERT_GE((*json)["probes"].size(), 8u);
}

TEST(ModelArrays, PiecesOfAClustersModelCarryAllLight) {
  const auto model = compress_clusters(disk_rays());
  const auto json = model_arrays_json(*model);
  ASSERT_TRUE(json);
  const auto corner = test::unpacked<float>((*json)["pieces"]["corner"]);
  const auto floats = test::unpacked<float>((*json)["pieces"]["density"]);
  const std::vector<double> density(floats.begin(), floats.end());
  double flux = 0.0;
  for (std::size_t t = 0; 9 * t < corner.size(); ++t) {
    const auto at = [&](std::size_t k) {
      return Vec3{corner[9 * t + 3 * k], corner[9 * t + 3 * k + 1], corner[9 * t + 3 * k + 2]};
    };
    const double area = 0.5 * length(cross(at(1) - at(0), at(2) - at(0)));
    flux += area * (density[3 * t] + density[3 * t + 1] + density[3 * t + 2]) / 3.0;
  }
  EXPECT_NEAR(flux, 1.0, 1e-4);
  const auto begin = test::unpacked<std::uint32_t>((*json)["clusters"]["leaf_begin"]);
  EXPECT_EQ(begin.size(), model->clusters() + 1);
  EXPECT_EQ(test::unpacked<float>((*json)["clusters"]["density"]).size(), model->leaves());
}

TEST(ModelArrays, LightOfAPointHasNoLuminance) {
  RaySet set = disk_rays(EmitterKind::point);
  for (auto* column : {&set.rays.x_mm, &set.rays.y_mm, &set.rays.z_mm})
    std::fill(column->begin(), column->end(), 0.0f);
  EXPECT_FALSE(model_arrays_json(*compress_adaptive(set, {})));
  EXPECT_FALSE(model_arrays_json(*compress_clusters(set)));
}

TEST(ReportModel, IsWellFormedAndItsFiguresAreThoseOfTheJson) {
  const RaySet set = disk_rays();
  const auto model = compress_adaptive(set, {});
  ModelReportOptions options{.title = "disk <1>.nfl", .rays = &set.rays, .model_rays = 100'000};
  const std::string html = model_report_html(*model, result_of(*model), options);
  EXPECT_EQ(test::html_fault(html), "");
  EXPECT_EQ(html.find("disk <1>"), std::string::npos);
  const Json result = test::embedded(html, "result");
  const auto seen = test::check_keyed_figures(html, result);
  for (const char* key :
       {"/flux_lm", "/bytes", "/views/far/error", "/views/four_d/raw", "/etendue_mm2sr/model/p90"})
    EXPECT_TRUE(seen.contains(key)) << key;
  // The views of a model of an easy source are good; its étendue is pi^2 r^2 / 2 at half the flux.
  EXPECT_LT(result["views"]["focus"]["excess"].get<double>(), 0.1);
  for (const char* side : {"model", "rays"})
    EXPECT_NEAR(result["etendue_mm2sr"][side]["p50"].get<double>(), 0.5 * M_PI * M_PI, 0.5) << side;
  EXPECT_EQ(test::embedded(html, "grids").size(), 15u);
}

TEST(ReportModel, WithoutRaysItSaysSo) {
  const auto model = compress_clusters(disk_rays());
  const std::string html = model_report_html(*model, result_of(*model), {.title = "m.nfl"});
  EXPECT_EQ(test::html_fault(html), "");
  EXPECT_NE(html.find("were not given"), std::string::npos);
  EXPECT_TRUE(test::embedded(html, "grids").is_null());
  EXPECT_FALSE(test::embedded(html, "model").is_null());
}

}  // namespace
}  // namespace lucerna
