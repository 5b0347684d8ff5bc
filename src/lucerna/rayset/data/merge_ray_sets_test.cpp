// SPDX-License-Identifier: Apache-2.0
#include "lucerna/rayset/data/merge_ray_sets.h"

#include <gtest/gtest.h>

#include <numeric>

#include "lucerna/core/io/error.h"

namespace lucerna {
namespace {

RaySet set_of(std::size_t n, double flux, float weight) {
  RaySet set;
  set.header.flux_lm = flux;
  set.rays.resize(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    set.rays.set(i, {{static_cast<double>(n), 0, 0}, Direction()});
    set.rays.weight[i] = weight;
  }
  return set;
}

TEST(MergeRaySets, FluxesAddWhateverTheWeightsAre) {
  RaySet all;
  merge_ray_sets(all, set_of(10, 30.0, 5.0f), "blue");
  merge_ray_sets(all, set_of(40, 90.0, 0.1f), "yellow");
  EXPECT_EQ(all.rays.size(), 50u);
  EXPECT_EQ(*all.header.flux(), 120.0);
  const auto& w = all.rays.weight;
  EXPECT_NEAR(std::accumulate(w.begin(), w.begin() + 10, 0.0), 30.0, 1e-5);
  EXPECT_NEAR(std::accumulate(w.begin() + 10, w.end(), 0.0), 90.0, 1e-4);
}

TEST(MergeRaySets, UnitsAreNeverMixedAndFluxMustBeKnown) {
  RaySet all;
  merge_ray_sets(all, set_of(10, 30.0, 1.0f), "a");
  RaySet watts = set_of(10, 3.0, 1.0f);
  watts.header.flux_unit = FluxUnit::watt;
  watts.header.flux_w = 3.0;
  EXPECT_THROW(merge_ray_sets(all, watts, "b"), InputError);
  RaySet unknown = set_of(10, 3.0, 1.0f);
  unknown.header.flux_lm.reset();
  EXPECT_THROW(merge_ray_sets(all, unknown, "c"), InputError);
}

TEST(MergeRaySets, ColumnsThatOnlyOneHasAreDropped) {
  RaySet all, other = set_of(2, 1.0, 1.0f);
  merge_ray_sets(all, set_of(3, 1.0, 1.0f), "a");
  other.header.columns.push_back({ColumnKind::wavelength_nm, "wavelength"});
  other.rays.resize(2, 1);
  merge_ray_sets(all, other, "b");
  EXPECT_EQ(all.rays.size(), 5u);
  EXPECT_TRUE(all.rays.extra.empty());
  EXPECT_TRUE(all.header.columns.empty());
}

}  // namespace
}  // namespace lucerna
