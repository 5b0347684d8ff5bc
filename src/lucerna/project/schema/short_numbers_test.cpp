// SPDX-License-Identifier: Apache-2.0
#include "lucerna/project/schema/short_numbers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "lucerna/project/schema/toml_text.h"
#include "lucerna/random.h"

namespace lucerna {
namespace {

TEST(ShortNumbers, SayTheSameInFewerDigits) {
  EXPECT_EQ(short_numbers("a = 0.90500000000000003\nb = [ 7.4924999999999997, -2.0 ]\n"),
            "a = 0.905\nb = [ 7.4925, -2.0 ]\n");
  EXPECT_EQ(short_numbers("a = 9.9999999999999995e-08"), "a = 1e-07");
  EXPECT_EQ(short_numbers("a = 2.00000000000000000"), "a = 2.0") << "still no whole number";
  EXPECT_EQ(short_numbers("a=12\nfocal2_mm = inf\nb = true"), "a=12\nfocal2_mm = inf\nb = true");
}

TEST(ShortNumbers, LeaveStringsAlone) {
  for (const char* text : {"a = 'x 0.90500000000000003'", R"(a = "b\" 0.90500000000000003")",
                           "a = \"\"\"\n0.90500000000000003 \" \"\"\"", "a = '''\n0.90500000000000003'''",
                           "a = 'never closed 0.90500000000000003", R"(a = "ends in \)"}) {
    EXPECT_EQ(short_numbers(text), text);
  }
}

TEST(ShortNumbers, GiveTheSameBitsBack) {
  toml::array all;
  for (std::uint64_t i = 0; i < 1000; ++i) {
    Rng rng(1, i);
    all.push_back((rng.uniform() - 0.5) * std::pow(10.0, 40.0 * rng.uniform() - 20.0));
  }
  std::ostringstream text;
  text << toml::table{{"all", all}};
  const std::string brief = short_numbers(text.str());
  EXPECT_LT(brief.size(), text.str().size());
  const toml::table read = parse_toml_text(brief, "brief");
  for (std::size_t i = 0; i < all.size(); ++i)
    EXPECT_EQ(read["all"][i].value<double>(), all[i].value<double>()) << i;
}

}  // namespace
}  // namespace lucerna
