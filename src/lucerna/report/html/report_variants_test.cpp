// SPDX-License-Identifier: Apache-2.0
#include "lucerna/report/html/report_variants.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/support/html_check.h"
#include "tests/support/text_scan.h"

namespace lucerna {
namespace {

using Json = nlohmann::ordered_json;
using test::has;

const Json kEstimate{{"value", 0.8312}, {"standard_error", 0.0012}};
const Json kNone{{"value", nullptr}, {"standard_error", nullptr}};

Json boxes(double excess) {
  const Json box{{"value", excess}, {"floor", 0.001}, {"excess", excess}, {"standard_error", 0.0003}};
  return {{"c12", box}, {"c24", box}, {"c48", box}};
}

Json a_design() {
  return {
      {"error", boxes(0.0323)},
      {"in_rectangle", kEstimate},
      {"warnings", {"far: too <coarse>", "no light"}},
      {"pareto",
       {{{"light_weight", 0.25},
         {"vertex_moved_mm", -1.5},
         {"error", boxes(0.041)},
         {"in_rectangle", kEstimate}}}},
      {"advice",
       {{{"change", "a wider mirror"}, {"error", boxes(0.02)}, {"in_rectangle", kEstimate}, {"helps", true}},
        {{"change", "half the hole"},
         {"error", boxes(0.05)},
         {"in_rectangle", kEstimate},
         {"helps", false}}}},
      {"tolerances",
       {{"source_shift_mm", 0.5},
        {"source_tilt_deg", 1.0},
        {"slope_error_mrad", 2.0},
        {"reflectance", 0.02},
        {"samples", 40},
        {"rays", 1000},
        {"spread",
         {{"peak/cd",
           {{"nominal", kEstimate},
            {"mean", kEstimate},
            {"standard_deviation", kEstimate},
            {"min", kEstimate},
            {"max", kNone}}}}}}}};
}

TEST(ReportVariants, HaveEveryMirrorAndItsFigures) {
  const Json json = a_design();
  const std::string html = variants_html(ResultFigures(json, "result.json"));
  EXPECT_EQ(test::html_fault(html), "");
  const auto seen = test::check_keyed_figures(html, json);
  for (const char* key :
       {"/error/c48/excess", "/pareto/0/vertex_moved_mm", "/pareto/0/light_weight",
        "/pareto/0/error/c48/excess", "/pareto/0/in_rectangle/value", "/advice/0/error/c48/excess",
        "/advice/1/error/c48/standard_error", "/advice/1/in_rectangle/value", "/tolerances/samples",
        "/tolerances/source_shift_mm", "/tolerances/source_tilt_deg", "/tolerances/slope_error_mrad",
        "/tolerances/reflectance", "/tolerances/spread/peak~1cd/nominal/value",
        "/tolerances/spread/peak~1cd/max/value", "/tolerances/spread/peak~1cd/standard_deviation/value"})
    EXPECT_TRUE(seen.contains(key)) << key;
  EXPECT_TRUE(has(html, "a wider mirror"));
  EXPECT_TRUE(has(html, "<strong>helps</strong>") && has(html, "does not help"));
}

TEST(ReportVariants, AreLeftOutWhereThereAreNone) {
  const Json json{{"error", boxes(0.03)}, {"pareto", Json::array()}};
  EXPECT_EQ(variants_html(ResultFigures(json, "result.json")), "");
  EXPECT_EQ(warnings_html(ResultFigures(json, "result.json")), "");
}

TEST(ReportVariants, AdviceOnZonesHasNoErrorToBeat) {
  Json json = a_design();
  json.erase("error");
  EXPECT_EQ(test::html_fault(variants_html(ResultFigures(json, "result.json"))), "");
}

TEST(ReportVariants, WarningsAreShownAsText) {
  const Json json = a_design();
  const std::string html = warnings_html(ResultFigures(json, "result.json"));
  EXPECT_EQ(test::html_fault(html), "");
  EXPECT_TRUE(has(html, "far: too &lt;coarse&gt;")) << html;
  EXPECT_EQ(test::between(html, "<p", "</p>").size(), 2u);
}

}  // namespace
}  // namespace lucerna
