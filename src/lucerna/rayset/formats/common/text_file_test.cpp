// SPDX-License-Identifier: Apache-2.0
#include "lucerna/rayset/formats/common/text_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lucerna/core/io/error.h"
#include "lucerna/ray_file.h"
#include "tests/support/random_rays.h"
#include "tests/support/temp_dir.h"

namespace lucerna {
namespace {

using test::message_of, test::put_bytes, test::TempDir;
using ::testing::AllOf, ::testing::Contains, ::testing::ElementsAre, ::testing::HasSubstr;

class TextFile : public ::testing::Test {
 protected:
  RaySet read(std::string_view text, const ReadOptions& options = {}) {
    put_bytes(dir_ / "a", text);
    return read_ray_set(dir_ / "a", options, no_progress(), &warnings_);
  }
  std::string refusal(std::string_view text) {
    return message_of<InputError>([&] { read(text); });
  }
  TempDir dir_;
  std::vector<std::string> warnings_;
};

TEST_F(TextFile, NumbersAsPeopleWriteThem) {
  const RaySet set = read(
      "X Pos;Y Pos and so on\r\n\r\n# note\n 1,+2e0;\t-3.5  0 0.6 8.0e-001,1e-017 \r\n\n1 2 3 0 0 1 1e-60");
  ASSERT_EQ(set.rays.size(), 2u);
  EXPECT_EQ(set.rays.origin_mm(0), (Vec3{1, 2, -3.5}));
  EXPECT_EQ(set.rays.kz[0], 0.8F);
  EXPECT_EQ(set.rays.weight[0], 1e-17F);
  EXPECT_EQ(set.rays.weight[1], 0.0F) << "too small for float32";
  EXPECT_THAT(warnings_, AllOf(Contains(HasSubstr("no columns")), Contains(HasSubstr("lm is assumed"))));
}

TEST_F(TextFile, DeclaredColumnsUnitsAndFlux) {
  const std::string text =
      "# columns: wavelength_um flux_w x_cm y_cm z_cm kx ky kz - q\n# flux_w: 2.5\n0.5 3 1 2 3 0 0 1 77 9\n";
  const RaySet set = read(text);
  EXPECT_EQ(set.header.flux_unit, FluxUnit::watt);
  EXPECT_EQ(set.header.flux(), 2.5);
  EXPECT_EQ(set.rays.origin_mm(0), (Vec3{10, 20, 30}));
  ASSERT_EQ(set.header.columns.size(), 2u);
  EXPECT_EQ(set.rays.extra[0][0], 500.0F);
  EXPECT_EQ(set.rays.extra[1][0], 9.0F);
  const RaySet other = read(
      text, {.format = "text", .text_columns = {"x", "flux_lm", "y", "z", "-", "kx", "ky", "kz", "-", "-"}});
  EXPECT_EQ(other.rays.origin_mm(0), (Vec3{0.5, 1, 2}));
  EXPECT_EQ(other.rays.weight[0], 3.0F);
  EXPECT_THAT(refusal("# columns: x y z kx ky kz\n1 2 3 0 0 1\n"), HasSubstr("'flux' expected"));
  EXPECT_THAT(refusal("# columns: x y z kx ky kz flux x\n"), HasSubstr("twice"));
  EXPECT_THAT(refusal("# columns: x_mile y z kx ky kz flux\n"), HasSubstr("x_mile"));
}

TEST_F(TextFile, FaultsNameTheLine) {
  std::string text = "0 0 0 0 0 1 1\n";
  for (int i = 0; i < 200000; ++i) text += i % 1000 == 0 ? "\n# x\n" : "0 0 0 0 0 1 1\n";
  const std::uint64_t lines = 1 + 200000 + 200;
  EXPECT_EQ(read(text).rays.size(), 1u + 200000u - 200u);
  EXPECT_THAT(refusal(text + "0 0 0 0 0 1\n"),
              AllOf(HasSubstr(fmt::format("line {}", lines + 1)), HasSubstr("7 numbers expected, 6 found")));
  EXPECT_THAT(refusal(text + "0 0 0 0 0 1 1 1\n"), HasSubstr("8 found"));
  EXPECT_THAT(refusal(text + "0 0 0 0 0 1 1x\n"), HasSubstr("something else"));
  EXPECT_THAT(refusal(text + "0 0 0 0 0 nan 1\n"), HasSubstr("kz is nan"));
  EXPECT_THAT(refusal(text + "0 0 0 0 0 2 1\n0 0 0\n"),
              AllOf(HasSubstr(fmt::format("line {}", lines + 1)), HasSubstr("length 2")));
  EXPECT_EQ(read(text + "0 0 0 0 0 2 1\n0 0 0\n7 0 0 0 0 1 1\n", {.salvage = true}).rays.x_mm.back(), 7.0F);
  EXPECT_THAT(warnings_, Contains(HasSubstr("left out")));
}

TEST_F(TextFile, ZemaxCountsAreChecked) {
  EXPECT_THAT(refusal("3 4 0 0\n0 0 0 0 0 1 1\n0 0 0 0 0 1 1\n"),
              AllOf(HasSubstr("line 1"), HasSubstr("3 rays expected, 2 lines found")));
  EXPECT_EQ(read("3 4 0 0\n0 0 0 0 0 1 1\n", {.salvage = true}).rays.size(), 1u);
  EXPECT_EQ(read("1 1 0 1\n1 0 0 0 0 1 1\n2 0 0 0 0 1 1\n").rays.x_mm, std::vector<float>{25.4F});
  EXPECT_THAT(warnings_, Contains(HasSubstr("left out")));
  EXPECT_EQ(read("0 4\n").rays.size(), 0u);
  EXPECT_EQ(read("1 4 0 0\n0 0 0 0 0 1 1 0.5\n").rays.extra[0][0], 500.0F);
  EXPECT_THAT(warnings_, ElementsAre(HasSubstr("8 numbers")));
  EXPECT_THAT(refusal("4294967295 4 0 0\n0 0 0 0 0 1 1\n"), HasSubstr("4294967295 rays expected"));
}

TEST_F(TextFile, LightToolsHeaders) {
  const std::string head =
      "LT_FAR_FIELD_DATA: YES\nlt_datatype: luminous_flux\nlt_data_origin: 1 2 3\nlt_length_units: inches\n";
  const RaySet far = read(head + "lt_radiant_flux: 5\nlt_startofdata\n0 0 1 2\nlt_endofdata\n");
  EXPECT_EQ(far.header.flux(), 5.0);
  EXPECT_EQ(far.rays.x_mm[0], 25.4F) << "far-field rays start at the data origin";
  EXPECT_THAT(refusal(head + "lt_startofdata\n0 0 1 2\n"), HasSubstr("lt_endofdata"));
  EXPECT_THAT(refusal(head + "0 0 1 2\n"), HasSubstr("lt_startofdata"));
  EXPECT_THAT(refusal("lt_length_units: cubits\nlt_startofdata\nlt_endofdata\n"),
              AllOf(HasSubstr("line 1"), HasSubstr("cubits")));
  EXPECT_THAT(refusal("lt_color_info: plaid\nlt_startofdata\nlt_endofdata\n"), HasSubstr("plaid"));
  EXPECT_EQ(read("lt_color_info: wavelength\nlt_startofdata\n0 0 0 0 0 1 2 550 1 0 0 0\nlt_endofdata")
                .header.columns.size(),
            5u);
}

}  // namespace
}  // namespace lucerna
