// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "lucerna/core/direction.h"

namespace lucerna {

/// Some rays as a structure of arrays, in the precision of ray files (float32). All arrays have the same
/// length. The unit of streaming: readers fill it, sources emit it, tracers take it.
struct RayBlock {
  /// Where each ray starts, mm.
  std::vector<float> x_mm, y_mm, z_mm;
  /// Its direction cosines; unit length to float precision once a reader has checked them.
  std::vector<float> kx, ky, kz;
  /// Relative flux, >= 0. A ray carries flux * weight / (sum of all weights), whatever unit the file gave its
  /// weights.
  std::vector<float> weight;
  /// Further numbers per ray, one array for each entry of RaySetHeader::columns.
  std::vector<std::vector<float>> extra;

  std::size_t size() const { return weight.size(); }
  bool empty() const { return weight.empty(); }

  /// Makes room for exactly `n` rays and `columns` extra columns; new values are zero.
  void resize(std::size_t n, std::size_t columns);
  void resize(std::size_t n) { resize(n, extra.size()); }

  /// Makes appending up to `n` rays free of further allocations.
  void reserve(std::size_t n);

  /// Appends ray `i` of `other`, which has the same extra columns.
  void append(const RayBlock& other, std::size_t i);
  /// Appends all of `other`.
  void append(const RayBlock& other);

  Vec3 origin_mm(std::size_t i) const { return {x_mm[i], y_mm[i], z_mm[i]}; }
  /// Normalised in double, so that it is unit to a few ulp.
  Direction direction(std::size_t i) const { return Direction::from({kx[i], ky[i], kz[i]}); }
  Ray ray(std::size_t i) const { return {origin_mm(i), direction(i)}; }

  /// Sets start and direction of ray `i`; weight and extra columns stay.
  void set(std::size_t i, const Ray& ray);

  friend bool operator==(const RayBlock&, const RayBlock&) = default;
};

}  // namespace lucerna
