// SPDX-License-Identifier: Apache-2.0
#include "lucerna/results/folders/trace_folder.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"
#include "lucerna/results/folders/trace_files.h"
#include "lucerna/version.h"
#include "tests/support/random_rays.h"
#include "tests/support/temp_dir.h"

namespace lucerna {
namespace {

constexpr const char* kHeader = "c_deg,gamma_deg,intensity_cd,standard_error_cd\n";

std::string fault(const std::string& csv) {
  return test::message_of<InputError>([&] { far_field_table(csv, "f.csv"); });
}

TEST(TraceFolder, TableIsTheInverseOfItsWriter) {
  FarFieldResult figures;
  figures.intensity.distribution = uniform_distribution(90.0, 45.0);
  auto& d = figures.intensity.distribution;
  for (std::size_t i = 0; i < d.cd.size(); ++i) {
    d.cd[i] = 0.1 * static_cast<double>(i * i);
    figures.intensity.standard_error_cd.push_back(0.01 * static_cast<double>(i));
  }
  const FarFieldTable table = far_field_table(far_field_csv(figures), "f.csv");
  EXPECT_EQ(table.distribution.c_deg, d.c_deg);
  EXPECT_EQ(table.distribution.gamma_deg, d.gamma_deg);
  EXPECT_EQ(table.standard_error.size(), d.cd.size());
  for (std::size_t i = 0; i < d.cd.size(); ++i)
    EXPECT_NEAR(table.distribution.cd[i], d.cd[i], 1e-8 * d.cd[i]);
  figures.intensity.standard_error_cd.clear();
  EXPECT_TRUE(far_field_table(far_field_csv(figures), "f.csv").standard_error.empty());
}

TEST(TraceFolder, BrokenTablesNameTheirLine) {
  const std::string head = kHeader;
  EXPECT_NE(fault("nonsense\n").find("f.csv: line 1: found 'nonsense'"), std::string::npos);
  EXPECT_NE(fault(head + "0,0,1,\n0,x,1,\n").find("line 3: found 'x'"), std::string::npos);
  EXPECT_NE(fault(head + "0,0,nan,\n").find("line 2"), std::string::npos);
  EXPECT_NE(fault(head + "0,0,-1,\n").find("line 2"), std::string::npos);
  EXPECT_NE(fault(head + "0,0,1,\n0,90,1,\n90,0,1,\n90,80,1,\n").find("line 5"), std::string::npos);
  EXPECT_NE(fault(head + "0,0,1,\n0,90,1,\n90,0,1,\n"), "no exception");
  EXPECT_NE(fault(head), "no exception");
}

TEST(TraceFolder, PlaneTablesAreTheInverseOfTheirWriter) {
  PlaneMetrics figures;
  figures.image.grid = {Frame(), 30.0, 20.0, 3, 2};
  for (std::size_t i = 0; i < 6; ++i) {
    figures.image.value.push_back(0.1 * static_cast<double>(i * i));
    figures.image.standard_error.push_back(0.01 * static_cast<double>(i));
  }
  for (const bool seen : {false, true}) {
    if (seen) figures.view = LuminanceDetector();
    for (const FluxUnit unit : {FluxUnit::lumen, FluxUnit::watt}) {
      figures.image.unit = unit;
      const PlaneTable t = plane_table(plane_csv(figures), "p.csv");
      EXPECT_EQ(t.luminance, seen);
      EXPECT_EQ(t.unit, unit);
      EXPECT_EQ(t.value_unit, plane_unit(figures));
      EXPECT_EQ(t.x_mm, (std::vector<double>{-10, 0, 10}));
      EXPECT_EQ(t.y_mm, (std::vector<double>{-5, 5}));
      ASSERT_EQ(t.value.size(), 6u);
      for (std::size_t i = 0; i < 6; ++i) {
        EXPECT_NEAR(t.value[i], figures.image.value[i], 1e-8);
        EXPECT_NEAR(t.standard_error[i], figures.image.standard_error[i], 1e-8);
      }
    }
  }
  figures.image.standard_error.assign(6, std::nan(""));
  EXPECT_TRUE(plane_table(plane_csv(figures), "p.csv").standard_error.empty());
}

TEST(TraceFolder, BrokenPlaneTablesNameTheirLine) {
  const std::string head = "x_mm,y_mm,illuminance_lx,standard_error_lx\n";
  const auto wrong = [](const std::string& csv) {
    return test::message_of<InputError>([&] { plane_table(csv, "p.csv"); });
  };
  EXPECT_NE(wrong("x_mm,y_mm,lux\n").find("p.csv: line 1: found 'x_mm,y_mm,lux'"), std::string::npos);
  EXPECT_NE(wrong(head).find("no cell"), std::string::npos);
  EXPECT_NE(wrong(head + "0,0,1,\n1,0,-1,\n").find("line 3"), std::string::npos);
  EXPECT_NE(wrong(head + "0,0,1,\n1,0,1,\n0,1,1,\n").find("short"), std::string::npos);
  EXPECT_NE(wrong(head + "0,0,1,\n1,0,1,\n0,1,1,\n0,2,1,\n").find("line 5: the row before"),
            std::string::npos);
  EXPECT_NE(wrong(head + "0,0,1,\n1,0,1,\n0,1,1,\n2,1,1,\n").find("line 5: found x 2"), std::string::npos);
  EXPECT_NE(wrong(head + "0,0,1,\n1,0,1,\n0,-1,1,\n1,-1,1,\n").find("line 4"), std::string::npos);
}

TEST(TraceFolder, SaysWhatIsNoTrace) {
  const test::TempDir dir;
  const auto message = [&] { return test::message_of<InputError>([&] { read_trace_folder(dir.path()); }); };
  EXPECT_NE(message().find("result.json"), std::string::npos);
  write_file(dir / "result.json", "{");
  EXPECT_NE(message().find("is no JSON"), std::string::npos);
  write_file(dir / "result.json", "{}");
  EXPECT_NE(message().find("expected the result of a trace"), std::string::npos);
  write_file(dir / "result.json", R"({"ledger": {}, "detectors": [], "schema_version": 99})");
  EXPECT_NE(message().find(fmt::format("found 99, expected 4 to {}", kJsonSchemaVersion)), std::string::npos);
  write_file(dir / "result.json", R"({"ledger": {}, "detectors": [], "schema_version": "4"})");
  EXPECT_NE(message().find("found \"4\", expected 4 to"), std::string::npos);
  write_file(dir / "result.json", R"({"ledger": {}, "detectors": [], "schema_version": 4})");
  EXPECT_EQ(message().find("schema_version"), std::string::npos) << "of an older trace: " << message();
  write_file(dir / "project.toml", "");
  const auto write_detector = [&](const std::string& name, const std::string& kind) {
    write_file(dir / "result.json",
               fmt::format(R"({{"ledger": {{}}, "detectors": [{{"name": "{}", "kind": "{}"}}], )"
                           R"("schema_version": {}}})",
                           name, kind, kJsonSchemaVersion));
  };
  write_detector("../x", "far-field");
  EXPECT_NE(message().find("../x"), std::string::npos);
  write_detector("x", "eye");
  EXPECT_NE(message().find("found the kind \"eye\""), std::string::npos);
}

// The flux of a trace is known better than the sum of its values' errors would say.
TEST(TraceFolder, FluxHasItsOwnError) {
  const test::TempDir dir;
  write_file(dir / "project.toml", "");
  write_file(dir / "far.csv", std::string(kHeader) + "0,0,1,0.1\n0,90,1,0.1\n");
  const auto read = [&](const std::string& flux) {
    write_file(dir / "result.json",
               fmt::format(R"({{"ledger": {{}}, "detectors": [{{"name": "far", "kind": "far-field"{}}}], )"
                           R"("schema_version": {}}})",
                           flux, kJsonSchemaVersion));
    return read_trace_folder(dir.path()).far_fields.front().flux_standard_error;
  };
  EXPECT_EQ(read(R"(, "flux": {"value": 5.0, "standard_error": 0.25})"), 0.25);
  EXPECT_FALSE(read(R"(, "flux": {"value": 5.0, "standard_error": null})"));
  EXPECT_FALSE(read(""));
}

}  // namespace
}  // namespace lucerna
