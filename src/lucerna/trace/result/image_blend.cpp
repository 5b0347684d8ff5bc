// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/result/image_blend.h"

#include <cmath>

namespace lucerna {

PlaneImage blended(PlaneImage counted, const ImageBlend& blend) {
  double counted_sum = 0.0;
  Jackknife sum(blend.values.replicates());
  for (std::size_t k = 0; k < counted.value.size(); ++k) {
    counted_sum += counted.value[k];
    sum.add(1.0, blend.values.row(k));
    const double w = blend.weight_of(k);
    const Estimate other = blend.values.at(k).estimate();
    counted.value[k] = (1.0 - w) * counted.value[k] + w * other.mean;
    counted.standard_error[k] = std::hypot((1.0 - w) * counted.standard_error[k], w * other.standard_error);
  }
  if (!(counted_sum > 0.0)) return counted;
  const double w = blend.weight;
  const Estimate other = sum.map([&](double v) { return v / counted_sum * counted.flux.mean; }).estimate();
  counted.flux = {(1.0 - w) * counted.flux.mean + w * other.mean,
                  std::hypot((1.0 - w) * counted.flux.standard_error, w * other.standard_error)};
  return counted;
}

}  // namespace lucerna
