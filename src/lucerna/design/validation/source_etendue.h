// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "lucerna/design/evaluation/design_rays.h"
#include "lucerna/rayset/statistics/etendue_curve.h"
#include "lucerna/source.h"

namespace lucerna {

/// The étendue curves of a design's sources, each made when it is first asked for. Not for several threads at
/// once.
class SourceEtendue {
 public:
  /// From the first 2^18 of the rays at most, which it copies, and their sources, which must outlive it.
  explicit SourceEtendue(const DesignRays& rays);

  const RayBlock& rays() const { return rays_; }
  /// Of the focus plane: can be too large, never far too small, so what it allows is allowed. Half a second;
  /// the searched one where that takes less.
  const EtendueCurve& quick();
  /// The one to judge by what the quick one forbids (model_etendue.h): of a single source's own density where
  /// it knows it (a tenth of a second), else of a searched support (some seconds).
  const EtendueCurve& searched();

 private:
  /// The only source, if there is one.
  const RaySource* only_ = nullptr;
  RayBlock rays_;
  std::optional<EtendueCurve> quick_, searched_;
};

}  // namespace lucerna
