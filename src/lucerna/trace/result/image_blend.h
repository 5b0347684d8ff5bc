// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lucerna/photometry/binning/jackknife.h"
#include "lucerna/trace.h"

namespace lucerna {

/// A second, independent estimate of an image, to be averaged with the counted one.
struct ImageBlend {
  /// Its part of the average; the counted image has the rest. 0: there is none.
  double weight = 0.0;
  /// Values of the cells in the image's unit, and those without each replicate.
  JackknifedFlux values;
  /// Of a cell: where nothing was found its error is not known either, and the counted value stays.
  double weight_of(std::size_t cell) const { return weight > 0.0 && values.flux(cell) > 0.0 ? weight : 0.0; }
};

/// The average; its flux is that of the average's values as the counted one is of the counted values.
PlaneImage blended(PlaneImage counted, const ImageBlend& blend);

/// An image as it was counted, and what it becomes: the same object where nothing is averaged.
struct ImageParts {
  const PlaneImage& counted;
  const ImageBlend& blend;
  const PlaneImage& average;
};

}  // namespace lucerna
