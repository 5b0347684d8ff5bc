// SPDX-License-Identifier: Apache-2.0
#include "lucerna/rayset/files/ray_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "lucerna/ray_file.h"
#include "tests/support/random_rays.h"
#include "tests/support/temp_dir.h"

namespace lucerna {
namespace {

using ::testing::Field, ::testing::HasSubstr, ::testing::IsEmpty;

RaySet honest_set(std::size_t n) {
  RaySet set = test::random_ray_set(n, 1);
  double sum = 0.0;
  for (const float w : set.rays.weight) sum += static_cast<double>(w);
  set.header.set_flux(sum);
  return set;
}

TEST(RayCheck, AGoodFileHasNoDiagnostics) {
  const test::TempDir dir;
  write_ray_set(dir / "a", honest_set(100), "tm25");
  EXPECT_THAT(check_ray_file(dir / "a"), IsEmpty());
}

TEST(RayCheck, EveryFaultHasItsPlace) {
  const test::TempDir dir;
  RaySet set = honest_set(100);
  set.header.set_flux(1.0);
  set.rays.kx[7] = std::numeric_limits<float>::quiet_NaN();
  set.rays.weight[9] = -1.0F;
  write_ray_set(dir / "a", set, "tm25");
  const auto found = check_ray_file(dir / "a");
  ASSERT_GE(found.size(), 4u);
  EXPECT_EQ(found[0].severity, Severity::error);
  EXPECT_EQ(found[0].place, "ray 7 (byte 36484)");
  EXPECT_THAT(found[0].text, HasSubstr("kx is nan"));
  EXPECT_THAT(found, ::testing::Contains(Field(&Diagnostic::text, HasSubstr("2 faulty rays"))));
  EXPECT_THAT(found, ::testing::Contains(Field(&Diagnostic::text, HasSubstr("is stated: the rays share"))));
}

TEST(RayCheck, MissingFluxNoRaysAndNoRayFile) {
  const test::TempDir dir;
  RaySet set = honest_set(3);
  set.header.flux_lm.reset();
  write_ray_set(dir / "a", set, "tm25");
  EXPECT_THAT(check_ray_file(dir / "a"),
              ::testing::ElementsAre(Field(&Diagnostic::text, HasSubstr("it will have to be given"))));
  write_ray_set(dir / "a", honest_set(0), "tm25");
  EXPECT_THAT(check_ray_file(dir / "a"), ::testing::ElementsAre(Field(&Diagnostic::text, "no rays")));
  set.rays.weight.assign(3, 0.0F);
  write_ray_set(dir / "a", set, "tm25");
  EXPECT_EQ(check_ray_file(dir / "a").front().severity, Severity::error);
  test::put_bytes(dir / "a", "not rays");
  const auto found = check_ray_file(dir / "a");
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].place, "byte 0");
  EXPECT_EQ(to_string(found[0].severity), "error");
}

}  // namespace
}  // namespace lucerna
