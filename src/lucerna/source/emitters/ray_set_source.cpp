// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "lucerna/core/io/error.h"
#include "lucerna/rayset/data/ray_wavelengths.h"
#include "lucerna/source.h"

namespace lucerna {

namespace {

constexpr std::uint64_t kRun = 64;

/// The largest quotient in Euclid's algorithm on (a, n); the smaller it is, the more evenly the multiples of
/// a spread over 0 .. n - 1 in every first part of their round. Infinite when they miss some number.
std::uint64_t unevenness(std::uint64_t a, std::uint64_t n) {
  std::uint64_t largest = 1;
  while (a > 1) {
    largest = std::max(largest, n / a);
    n = std::exchange(a, n % a);
  }
  return a == 1 ? largest : std::numeric_limits<std::uint64_t>::max();
}

/// A step near `n` divided by the golden ratio that visits all of 0 .. n - 1, evenly at every stage.
std::uint64_t golden_stride(std::uint64_t n) {
  const auto golden = static_cast<std::uint64_t>(static_cast<double>(n) * 0.6180339887498949);
  std::uint64_t best = 1;
  for (std::uint64_t a = std::max<std::uint64_t>(golden, 33) - 32; a < std::min(n, golden + 33); ++a) {
    if (best == 1 || unevenness(a, n) < unevenness(best, n)) best = a;
  }
  return best;
}

}  // namespace

RaySetSource::RaySetSource(std::shared_ptr<const RaySet> rays, const std::string& name)
    : rays_(std::move(rays)) {
  const RayBlock& block = rays_->rays;
  if (block.empty()) throw InputError(fmt::format("{}: holds no rays", name));
  const auto flux = rays_->header.flux();
  if (!flux || !(*flux > 0.0)) {
    throw InputError(fmt::format("{}: states no total flux; give flux_{} in the project", name,
                                 rays_->header.flux_unit == FluxUnit::lumen ? "lm" : "w"));
  }
  flux_ = *flux;
  const double sum = std::accumulate(block.weight.begin(), block.weight.end(), 0.0);
  if (!(sum > 0.0)) throw InputError(fmt::format("{}: all {} rays have zero flux", name, block.size()));
  weight_scale_ = static_cast<double>(block.size()) / sum;
  blocks_ = (block.size() + kRun - 1) / kRun;
  stride_ = golden_stride(blocks_);
  wavelengths_ = std::make_shared<const RayWavelengths>(rays_->header, flux_unit());
}

template <class Copy>
void RaySetSource::visit(const Sequence& sequence, std::uint64_t first, std::size_t size,
                         const Copy& copy) const {
  const std::uint64_t n = rays_->rays.size(), start = detail::mix_bits(sequence.seed()) % blocks_;
  // The visit as if every block were full; the numbers that the last, short block lacks are passed over by
  // giving it the last place of the visit: block `blocks_ - 1` is swapped with whatever the steps put there.
  const std::uint64_t last_visited = (start + (blocks_ - 1) * stride_) % blocks_;
  const auto block_of = [&](std::uint64_t j) {
    const std::uint64_t block = (start + (j / kRun) * stride_) % blocks_;
    return block == blocks_ - 1 ? last_visited : block == last_visited ? blocks_ - 1 : block;
  };
  for (std::size_t i = 0; i < size;) {
    const std::uint64_t j = (first + i) % n;
    const auto from = static_cast<std::size_t>(block_of(j) * kRun + j % kRun);
    const auto count = static_cast<std::size_t>(std::min({kRun - j % kRun, std::uint64_t{size - i}, n - j}));
    copy(from, count, i);
    i += count;
  }
}

void RaySetSource::emit(const Sequence& sequence, std::uint64_t first, RayBlock& out) const {
  const RayBlock& in = rays_->rays;
  visit(sequence, first, out.size(), [&](std::size_t from, std::size_t count, std::size_t to) {
    const auto copy = [&](const std::vector<float>& a, std::vector<float>& b) {
      std::copy_n(a.begin() + static_cast<std::ptrdiff_t>(from), count,
                  b.begin() + static_cast<std::ptrdiff_t>(to));
    };
    copy(in.x_mm, out.x_mm);
    copy(in.y_mm, out.y_mm);
    copy(in.z_mm, out.z_mm);
    copy(in.kx, out.kx);
    copy(in.ky, out.ky);
    copy(in.kz, out.kz);
    for (std::size_t k = 0; k < count; ++k)
      out.weight[to + k] = static_cast<float>(weight_scale_ * static_cast<double>(in.weight[from + k]));
  });
}

bool RaySetSource::has_wavelengths() const { return wavelengths_->are_known(); }

void RaySetSource::emit_wavelengths(const Sequence& sequence, std::uint64_t first,
                                    std::span<float> nm) const {
  LUCERNA_CHECK(has_wavelengths(), "wavelengths of rays without, {} wanted", nm.size());
  visit(sequence, first, nm.size(), [&](std::size_t from, std::size_t count, std::size_t to) {
    for (std::size_t k = 0; k < count; ++k) nm[to + k] = wavelengths_->of(rays_->rays, from + k, from + k);
  });
}

}  // namespace lucerna
