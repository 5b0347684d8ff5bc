// SPDX-License-Identifier: Apache-2.0
#include "lucerna/rayset/files/thinned_ray_set.h"

#include <gtest/gtest.h>

#include <numeric>

#include "lucerna/ray_file.h"
#include "tests/support/temp_dir.h"

namespace lucerna {
namespace {

/// A file of `n` rays along z, which start at x = 0, 1, ... and carry `flux_lm` together.
std::filesystem::path file_of(const test::TempDir& dir, const std::string& name, std::size_t n,
                              double flux_lm) {
  RaySet set;
  set.header.set_flux(flux_lm);
  set.rays.resize(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    set.rays.set(i, {{static_cast<double>(i), 0, 0}, Direction()});
    set.rays.weight[i] = 1.0f;
  }
  write_ray_set(dir / name, set, "tm25");
  return dir / name;
}

double weight_of(const RayBlock& rays, std::size_t first, std::size_t last) {
  return std::accumulate(rays.weight.begin() + static_cast<std::ptrdiff_t>(first),
                         rays.weight.begin() + static_cast<std::ptrdiff_t>(last), 0.0);
}

TEST(ThinnedRaySet, AllRaysWhereThereAreNoMore) {
  const test::TempDir dir;
  const auto file = file_of(dir, "a", 500, 3.0);
  const ThinnedRaySet all = thinned_ray_set({file}, 500, 1, no_progress());
  EXPECT_EQ(all.of, 500u);
  EXPECT_EQ(all.set, read_ray_set(file));
}

TEST(ThinnedRaySet, IsSpreadOverTheFile) {
  const test::TempDir dir;
  const ThinnedRaySet some = thinned_ray_set({file_of(dir, "a", 200'000, 3.0)}, 1000, 1, no_progress());
  EXPECT_EQ(some.of, 200'000u);
  ASSERT_EQ(some.set.rays.size(), 1000u);
  for (std::size_t i = 0; i < 1000; ++i) EXPECT_EQ(static_cast<std::size_t>(some.set.rays.x_mm[i]) / 200, i);
}

/// The one ray that is left of a small file carries all of its flux.
TEST(ThinnedRaySet, EveryFileKeepsItsFlux) {
  const test::TempDir dir;
  const std::vector<std::filesystem::path> files{file_of(dir, "a", 100'000, 90.0),
                                                 file_of(dir, "b", 3, 10.0)};
  const ThinnedRaySet some = thinned_ray_set(files, 1000, 1, no_progress());
  const std::size_t n = some.set.rays.size();
  EXPECT_EQ(n, 1000u);
  EXPECT_DOUBLE_EQ(*some.set.header.flux(), 100.0);
  EXPECT_NEAR(weight_of(some.set.rays, 0, n - 1), 90.0, 1e-4);
  EXPECT_NEAR(weight_of(some.set.rays, n - 1, n), 10.0, 1e-5);
}

}  // namespace
}  // namespace lucerna
