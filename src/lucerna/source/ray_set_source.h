// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "lucerna/rayset/ray_set.h"
#include "lucerna/source/ray_source.h"

namespace lucerna {

/// The rays of a file as a source. Ray j of the stream is a ray of the file: blocks of 64 neighbours are
/// visited in golden-ratio steps from a start that the sequence's seed fixes, so any first part of the visit
/// is spread over a file whatever its order, all rays come once before any comes twice, and memory is still
/// read in runs.
class RaySetSource final : public RaySource {
 public:
  /// Throws InputError without rays, without a stated flux > 0, or when all weights are zero. `name` is for
  /// messages.
  RaySetSource(std::shared_ptr<const RaySet> rays, const std::string& name);

  double flux() const override { return flux_; }
  FluxUnit flux_unit() const override { return rays_->header.flux_unit; }
  std::optional<std::uint64_t> ray_count() const override { return rays_->rays.size(); }
  void emit(const Sequence& sequence, std::uint64_t first, RayBlock& out) const override;

 private:
  std::shared_ptr<const RaySet> rays_;
  double flux_ = 0.0;
  /// n / sum of weights: makes the mean weight 1.
  double weight_scale_ = 0.0;
  std::uint64_t blocks_ = 0, stride_ = 1;
};

}  // namespace lucerna
