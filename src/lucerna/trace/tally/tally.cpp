// SPDX-License-Identifier: Apache-2.0
#include "lucerna/core/io/error.h"
#include "lucerna/trace.h"

namespace lucerna {

namespace {

template <class T>
void add(std::vector<T>& to, const std::vector<T>& from) {
  LUCERNA_CHECK(to.size() == from.size(), "{} and {} sums", to.size(), from.size());
  for (std::size_t i = 0; i < to.size(); ++i) to[i] += from[i];
}

}  // namespace

Tally& Tally::operator+=(const Tally& other) {
  rays += other.rays;
  reflections += other.reflections;
  emitted += other.emitted;
  out_direct += other.out_direct;
  out_reflected += other.out_reflected;
  add(absorbed, other.absorbed);
  add(lost, other.lost);
  add(lost_rays, other.lost_rays);
  LUCERNA_CHECK(bins.size() == other.bins.size(), "{} and {} detectors", bins.size(), other.bins.size());
  for (std::size_t d = 0; d < bins.size(); ++d) add(bins[d], other.bins[d]);
  return *this;
}

}  // namespace lucerna
