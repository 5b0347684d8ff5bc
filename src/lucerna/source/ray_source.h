// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "lucerna/core/error.h"
#include "lucerna/core/flux_unit.h"
#include "lucerna/core/sequence.h"
#include "lucerna/rayset/ray_block.h"

namespace lucerna {

/// Anything that light can be drawn from by number: an analytic emitter, a compressed model, the rays of a
/// file. Immutable once made; `emit` is thread safe.
class RaySource {
 public:
  virtual ~RaySource() = default;

  /// Total flux in `flux_unit`; > 0.
  virtual double flux() const = 0;
  virtual FluxUnit flux_unit() const = 0;

  /// Distinct rays there are (a ray file), or nothing when any number can be drawn.
  virtual std::optional<std::uint64_t> ray_count() const { return std::nullopt; }

  /// Replaces the rays of `out` (keeping its size, no extra columns) by rays `first` .. `first + size - 1` of
  /// the numbered stream that `sequence` fixes; the same numbers give the same bits, in whatever pieces they
  /// are asked for. Weights are relative with mean 1 over the source, so that n rays carry about n * flux() /
  /// n. A finite source visits every ray once before it repeats; any first part of the visit is spread over
  /// the file.
  virtual void emit(const Sequence& sequence, std::uint64_t first, RayBlock& out) const = 0;

  /// Have the rays wavelengths of their own? `emit_wavelengths` is for those that have: it sets those of rays
  /// `first` .. `first + nm.size() - 1` of the same stream, nm. Thread safe.
  virtual bool has_wavelengths() const { return false; }
  virtual void emit_wavelengths(const Sequence&, std::uint64_t /*first*/, std::span<float> nm) const {
    LUCERNA_CHECK(nm.empty(), "{} wavelengths of a source without", nm.size());
  }
};

}  // namespace lucerna
