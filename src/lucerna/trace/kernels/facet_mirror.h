// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lucerna/reflector.h"
#include "lucerna/trace/kernels/facet_kernel.h"

namespace lucerna {

/// A faceted reflector made ready for the facet kernel: its facets in a table. Immutable and thread safe; can
/// be moved.
class FacetMirror {
 public:
  /// Facets that the tables may have.
  static constexpr double kMaxFacets = 16e6;

  /// `surface` within `aperture`. Throws InputError if the pitch makes more than kMaxFacets facets.
  FacetMirror(const FacetedSurface& surface, const Aperture& aperture);

  /// Valid as long as this lives and is not moved.
  FacetView view() const {
    FacetView v = view_;
    v.facets = facets_.data();
    return v;
  }

 private:
  FacetView view_{};
  std::vector<Facet> facets_;
};

/// The reflector's surface if it is a faceted one, else null.
const FacetedSurface* faceted(const Reflector& reflector);

}  // namespace lucerna
