// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/adaptive/sampling/adaptive_model.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "lucerna/core/cpu/huge_pages.h"
#include "lucerna/core/io/error.h"
#include "lucerna/core/parallel/parallel.h"
#include "lucerna/simd/vector_clones.h"
#include "lucerna/source/adaptive/charts/number_batch.h"
#include "lucerna/source/adaptive/charts/support_batch.h"
#include "lucerna/source/emitters/warp.h"

namespace lucerna {

namespace {

constexpr std::size_t kQuadrature = 4096;

bool has_volume(const TreeBox& box) {
  for (std::size_t d = 0; d < 4; ++d) {
    if (box.width(d) <= 0.0) return false;
  }
  return true;
}

/// Outward normal of a bounding surface at a point on it.
Vec3 normal_at(const BoundingSurface& surface, const Vec3& point_mm) {
  const Vec3 p = surface.world_from_surface.inverse().point(point_mm);
  const Vec3& h = surface.half_size_mm;
  Vec3 n{0, 0, 1};
  if (surface.kind == SurfaceKind::sphere) n = p / std::max(length(p), 1e-300);
  if (surface.kind == SurfaceKind::cylinder) {
    const double rho = std::hypot(p.x, p.y);
    const bool cap = h.z - std::abs(p.z) < surface.radius_mm - rho;
    n = cap ? Vec3{0, 0, p.z > 0 ? 1.0 : -1.0} : Vec3{p.x / rho, p.y / rho, 0};
  }
  if (surface.kind == SurfaceKind::box) {
    const double gx = h.x - std::abs(p.x), gy = h.y - std::abs(p.y), gz = h.z - std::abs(p.z);
    if (gx <= gy && gx <= gz)
      n = {p.x > 0 ? 1.0 : -1.0, 0, 0};
    else if (gy <= gz)
      n = {0, p.y > 0 ? 1.0 : -1.0, 0};
    else
      n = {0, 0, p.z > 0 ? 1.0 : -1.0};
  }
  return surface.world_from_surface.vector(n);
}

/// The leaves of a batch of rays as columns.
struct LeafBatch {
  std::array<std::array<float, kSupportBatch>, 4> low, width;
  BitColumn first, length;  // a length of 2^32 is 0
};

/// adaptive_place_in and the other three numbers, for all rays of a batch.
LUCERNA_VECTOR_CLONES void place_in_leaves(const std::array<BitColumn, 4>& bits, const LeafBatch& leaves,
                                           std::array<BatchColumn, 4>& to) {
  std::array<BatchColumn, 4> c;
  for (std::size_t i = 0; i < kSupportBatch; ++i) {
    const double part = static_cast<double>(bits[0][i] - leaves.first[i]) + 0.5;
    const double t = part / (static_cast<double>(leaves.length[i] - 1u) + 1.0);
    c[0][i] = static_cast<double>(leaves.low[0][i]) + t * static_cast<double>(leaves.width[0][i]);
  }
  for (std::size_t d = 1; d < 4; ++d) {
    for (std::size_t i = 0; i < kSupportBatch; ++i) {
      const double u = static_cast<double>(bits[d][i]) * 0x1p-32;
      c[d][i] = static_cast<double>(leaves.low[d][i]) + u * static_cast<double>(leaves.width[d][i]);
    }
  }
  to = c;
}

/// The first `n` rays in float32, to places `at` on.
LUCERNA_VECTOR_CLONES void put_batch(const RayBatch& rays, std::size_t n, std::size_t at, RayBlock& out) {
  const std::array<const BatchColumn*, 6> from{&rays.x, &rays.y, &rays.z, &rays.kx, &rays.ky, &rays.kz};
  const std::array<float*, 6> to{out.x_mm.data(), out.y_mm.data(), out.z_mm.data(),
                                 out.kx.data(),   out.ky.data(),   out.kz.data()};
  for (std::size_t k = 0; k < 6; ++k) {
    for (std::size_t i = 0; i < n; ++i) to[k][at + i] = static_cast<float>((*from[k])[i]);
  }
}

/// Ray j to place at + which[j].
void put_scattered(const RayBatch& rays, std::span<const std::uint32_t> which, std::size_t at,
                   RayBlock& out) {
  for (std::size_t j = 0; j < which.size(); ++j) {
    const std::size_t i = at + which[j];
    out.x_mm[i] = static_cast<float>(rays.x[j]);
    out.y_mm[i] = static_cast<float>(rays.y[j]);
    out.z_mm[i] = static_cast<float>(rays.z[j]);
    out.kx[i] = static_cast<float>(rays.kx[j]);
    out.ky[i] = static_cast<float>(rays.ky[j]);
    out.kz[i] = static_cast<float>(rays.kz[j]);
  }
}

}  // namespace

std::size_t AdaptiveData::leaves() const {
  std::size_t n = 0;
  for (const AdaptiveLayer& layer : layers) {
    for (const AdaptiveChart& chart : layer.charts) {
      for (const DensityTree& tree : chart.trees) n += tree.leaves();
    }
  }
  return n;
}

AdaptiveModel::AdaptiveModel(AdaptiveData data) : data_(std::move(data)) { build_sampler(); }

std::unique_ptr<AdaptiveModel> AdaptiveModel::from_nfl(const NflFile& file, std::string_view name) {
  return std::make_unique<AdaptiveModel>(decode_adaptive(file, name));
}

void AdaptiveModel::build_sampler() {
  constexpr double kAll = 4294967296.0;
  double before = 0.0, total = 0.0;
  leaves_.reserve(data_.leaves() + 1);
  advise_huge_pages(leaves_.data(), leaves_.capacity() * sizeof(SamplerLeaf));
  for (const AdaptiveLayer& layer : data_.layers) {
    for (const AdaptiveChart& chart : layer.charts) total += layer.share * chart.share;
  }
  for (const AdaptiveLayer& layer : data_.layers) {
    for (const AdaptiveChart& chart : layer.charts) {
      const double share = layer.share * chart.share / total;
      has_etendue_ = has_etendue_ && has_volume(chart.box);
      places_.push_back(
          {&layer.support, chart.chart, layer.band, share / static_cast<double>(chart.trees.size()), {}});
      sampler_places_.push_back({layer.support, chart.chart});
      const auto place = static_cast<std::uint32_t>(places_.size() - 1);
      for (const DensityTree& tree : chart.trees) {
        places_.back().trees.emplace_back(tree, chart.box);
        for_each_leaf(tree, chart.box, [&](const TreeBox& box, double leaf_share) {
          const double first = std::round(before * kAll);
          before += leaf_share * places_[place].share;
          if (std::round(before * kAll) <= first || first >= kAll) return;
          SamplerLeaf leaf;
          for (std::size_t d = 0; d < 4; ++d) {
            leaf.low[d] = static_cast<float>(box.low[d]);
            leaf.width[d] = static_cast<float>(box.width(d));
          }
          leaf.first = static_cast<std::uint32_t>(first);
          leaf.place = place;
          leaves_.push_back(leaf);
        });
      }
    }
  }
  LUCERNA_CHECK(!leaves_.empty(), "an adaptive model of {} layers has no leaf", data_.layers.size());
  leaves_.front().first = 0;
  leaves_.push_back({});  // where the last one ends: 2^32, as 32 bits have it
  // One more, as the search looks ahead.
  last_bits_.reserve(leaves_.size());
  advise_huge_pages(last_bits_.data(), last_bits_.capacity() * sizeof(std::uint32_t));
  last_bits_.assign(leaves_.size(), ~std::uint32_t{0});
  for (std::size_t k = 0; k + 1 < leaves_.size(); ++k) last_bits_[k] = leaves_[k + 1].first - 1;
  unsigned bits = 1;
  while (bits < 24 && (std::size_t{1} << bits) < leaves_.size()) ++bits;
  guide_shift_ = 32 - bits;
  guide_.reserve(std::size_t{1} << bits);
  advise_huge_pages(guide_.data(), guide_.capacity() * sizeof(std::uint32_t));
  guide_.resize(std::size_t{1} << bits);
  std::size_t leaf = 0;
  for (std::size_t g = 0; g < guide_.size(); ++g) {
    while (leaf + 2 < leaves_.size() && leaves_[leaf + 1].first <= g << guide_shift_) ++leaf;
    guide_[g] = static_cast<std::uint32_t>(leaf);
  }
}

std::size_t AdaptiveModel::leaf_of(std::uint32_t bits) const {
  return adaptive_leaf(leaves_.data(), leaves_.size(), guide_.data(), guide_shift_, bits);
}

Ray AdaptiveModel::sample(const std::array<double, 4>& u) const { return sample_adaptive(view(), u); }

/// Chooses the leaves of the rays of some batches and their numbers in them. A leaf is a jump in memory: step
/// by step all rays ask for what they read in the next step, and no branch hangs on what is read.
void AdaptiveModel::choose(const Sequence& sequence, std::uint64_t first, std::size_t batches,
                           Piece& to) const {
  std::array<std::array<BitColumn, 4>, kPieceBatches> bits;
  std::array<BitColumn, kPieceBatches> leaf;
  for (std::size_t b = 0; b < batches; ++b) {
    number_batch(sequence, first + b * kSupportBatch, bits[b]);
    for (const std::uint32_t u : bits[b][0]) __builtin_prefetch(&guide_[u >> guide_shift_]);
  }
  const std::uint32_t* last = last_bits_.data();
  for (std::size_t b = 0; b < batches; ++b) {
    for (std::size_t i = 0; i < kSupportBatch; ++i) {
      const std::uint32_t u = bits[b][0][i];
      std::uint32_t k = guide_[u >> guide_shift_];
      // Nearly always one of the first three.
      k += (u > last[k] ? 1u : 0u) + (u > last[k + 1] ? 1u : 0u);
      while (u > last[k]) ++k;
      leaf[b][i] = k;
      const char* at = reinterpret_cast<const char*>(&leaves_[k]);
      __builtin_prefetch(at);
      __builtin_prefetch(at + sizeof(SamplerLeaf) - 1);
    }
  }
  for (std::size_t b = 0; b < batches; ++b) {
    LeafBatch columns;
    for (std::size_t i = 0; i < kSupportBatch; ++i) {
      const std::uint32_t k = leaf[b][i];
      const SamplerLeaf& from = leaves_[k];
      for (std::size_t d = 0; d < 4; ++d)
        columns.low[d][i] = from.low[d], columns.width[d][i] = from.width[d];
      columns.first[i] = from.first;
      columns.length[i] = last[k] - from.first + 1;
      to[b].place[i] = from.place;
    }
    place_in_leaves(bits[b], columns, to[b].c);
  }
}

void AdaptiveModel::make(std::uint32_t place, const std::array<BatchColumn, 4>& c, std::size_t n,
                         RayBatch& rays) const {
  rays_from_chart(*places_[place].support, places_[place].chart, c, rays);
  start_batch_on(data_.surface, n, rays);
}

/// Up to kPieceBatches batches at once: rays of one place are gathered from all of them, so that batches of a
/// support of many charts are full too.
void AdaptiveModel::emit_piece(const Sequence& sequence, std::uint64_t first, std::size_t at, std::size_t n,
                               RayBlock& out) const {
  Piece chosen;
  std::vector<std::uint32_t> order(n), count(places_.size() + 1, 0);
  choose(sequence, first + at, block_count(n, kSupportBatch), chosen);
  for (std::size_t b = 0; b * kSupportBatch < n; ++b) {
    const std::size_t size = std::min(kSupportBatch, n - b * kSupportBatch);
    for (std::size_t i = 0; i < size; ++i) ++count[chosen[b].place[i] + 1];
  }
  RayBatch rays;
  const bool one_place = count[chosen[0].place[0] + 1] == n;
  for (std::size_t b = 0; one_place && b * kSupportBatch < n; ++b) {
    const std::size_t size = std::min(kSupportBatch, n - b * kSupportBatch);
    make(chosen[0].place[0], chosen[b].c, size, rays);
    put_batch(rays, size, at + b * kSupportBatch, out);
  }
  if (one_place) return;
  for (std::size_t p = 0; p + 1 < count.size(); ++p) count[p + 1] += count[p];
  for (std::uint32_t i = 0; i < n; ++i) {
    order[count[chosen[i / kSupportBatch].place[i % kSupportBatch]]++] = i;
  }
  // `count` has moved on: it now holds where each place ends.
  std::array<BatchColumn, 4> packed{};
  std::size_t from = 0;
  for (std::uint32_t place = 0; place < places_.size(); ++place) {
    for (; from < count[place]; from += std::min<std::size_t>(kSupportBatch, count[place] - from)) {
      const std::size_t m = std::min<std::size_t>(kSupportBatch, count[place] - from);
      for (std::size_t j = 0; j < m; ++j) {
        const Chosen& c = chosen[order[from + j] / kSupportBatch];
        for (std::size_t d = 0; d < 4; ++d) packed[d][j] = c.c[d][order[from + j] % kSupportBatch];
      }
      make(place, packed, m, rays);
      put_scattered(rays, {order.data() + from, m}, at, out);
    }
  }
}

void AdaptiveModel::emit(const Sequence& sequence, std::uint64_t first, RayBlock& out) const {
  constexpr std::size_t kPiece = kPieceBatches * kSupportBatch;
  for (std::size_t at = 0; at < out.size(); at += kPiece) {
    emit_piece(sequence, first, at, std::min(kPiece, out.size() - at), out);
  }
  std::fill(out.weight.begin(), out.weight.end(), 1.0f);
}

void AdaptiveModel::emit_wavelengths(const Sequence& sequence, std::uint64_t first,
                                     std::span<float> nm) const {
  LUCERNA_CHECK(has_wavelengths(), "wavelengths of a model without, {} wanted", nm.size());
  for (std::size_t i = 0; i < nm.size(); ++i) {
    const auto u = sequence.point<5>(first + i);
    const SamplerLeaf& leaf = leaves_[leaf_of(static_cast<std::uint32_t>(u[0] * 4294967296.0))];
    nm[i] = data_.wavelengths[places_[leaf.place].band].at(u[4]);
  }
}

double AdaptiveModel::density(const Ray& ray) const {
  double sum = 0.0;
  const Support* last = nullptr;
  std::optional<ChartPoint> p;
  for (const Place& place : places_) {
    if (place.support != last) p = place.support->to_chart(ray), last = place.support;
    if (!p || p->chart != place.chart) continue;
    const double share = place.share / place.support->etendue_ratio();
    for (const TreeLookup& tree : place.trees) sum += share * tree.density(p->c);
  }
  return sum;
}

double AdaptiveModel::pdf_etendue(const Ray& ray) const {
  if (!has_etendue_) {
    throw InputError(
        "this source's rays fill no étendue (all on one point or line, or parallel): it has no "
        "density per mm^2 sr");
  }
  return density(ray);
}

double AdaptiveModel::radiance_at(const Vec3& point_mm, const Direction& d) const {
  const double g = density({point_mm, d});
  if (!has_etendue_) {
    // The density is per sr for rays through a point; on a line the azimuth's area function shrinks with the
    // sine of the angle to it.
    const Support& s = data_.layers.front().support;
    if (s.kind != SupportKind::axis) return g;
    const double cosine = dot(d.vec(), s.world_from_support.ez());
    return g * std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
  }
  if (data_.surface.kind == SurfaceKind::none) return g;
  return g * std::max(0.0, std::abs(dot(d.vec(), normal_at(data_.surface, point_mm))));
}

double AdaptiveModel::pdf_area(const Vec3& point_mm) const {
  if (!has_etendue_ || data_.surface.kind == SurfaceKind::none) {
    throw InputError("this source's ray origins fill no area: it has no density per mm^2");
  }
  const double size = length(point_mm) + 1.0;
  if (std::abs(data_.surface.outside_mm(point_mm)) > 1e-5 * size) return 0.0;
  const Direction normal = Direction::from(normal_at(data_.surface, point_mm));
  const Sequence sequence(SequenceKind::sobol, 1);
  double sum = 0.0;
  for (std::size_t i = 0; i < kQuadrature; ++i) {
    const auto u = sequence.point<2>(i);
    sum += density({point_mm, warp::about(normal, warp::cosine_hemisphere(u[0], u[1]))});
  }
  return std::numbers::pi * sum / static_cast<double>(kQuadrature);
}

double AdaptiveModel::pdf_solid_angle(const Vec3& point_mm, const Direction& direction) const {
  const Sequence sequence(SequenceKind::sobol, 1);
  double sum = 0.0;
  for (std::size_t i = 0; i < kQuadrature; ++i) {
    const auto u = sequence.point<2>(i);
    sum += radiance_at(point_mm, warp::sphere(u[0], u[1]));
  }
  const double all = 4.0 * std::numbers::pi * sum / static_cast<double>(kQuadrature);
  return all > 0.0 ? radiance_at(point_mm, direction) / all : 0.0;
}

AdaptiveView AdaptiveModel::view() const {
  return {leaves_.data(),
          guide_.data(),
          sampler_places_.data(),
          static_cast<std::uint32_t>(leaves_.size()),
          static_cast<std::uint32_t>(guide_.size()),
          static_cast<std::uint32_t>(sampler_places_.size()),
          guide_shift_,
          data_.surface};
}

}  // namespace lucerna
