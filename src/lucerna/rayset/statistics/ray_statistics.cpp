// SPDX-License-Identifier: Apache-2.0
#include "lucerna/ray_statistics.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <limits>
#include <numeric>

#include "lucerna/core/parallel/parallel.h"
#include "lucerna/rayset/data/eigen_vec.h"

namespace lucerna {

namespace {

/// Rays summed by one thread at a time.
constexpr std::size_t kSummedRays = 1 << 14;

/// Mean squared sine of the rays about their common axis below which they count as parallel (10 microradian
/// squared).
constexpr double kParallel = 1e-10;

}  // namespace

RayStatistics::Sums::Sums() {
  std::fill_n(low, 3, std::numeric_limits<float>::infinity());
  std::fill_n(high, 3, -std::numeric_limits<float>::infinity());
  w_low = std::numeric_limits<float>::infinity();
  w_high = 0.0F;
}

void RayStatistics::Sums::add(const Sums& o) {
  w += o.w;
  w2 += o.w2;
  back += o.back;
  x += o.x;
  k += o.k;
  kkx += o.kkx;
  for (int i = 0; i < 6; ++i) kk[i] += o.kk[i];
  for (int i = 0; i < 3; ++i) {
    low[i] = std::min(low[i], o.low[i]);
    high[i] = std::max(high[i], o.high[i]);
  }
  w_low = std::min(w_low, o.w_low);
  w_high = std::max(w_high, o.w_high);
}

RayStatistics::Sums RayStatistics::sums_of(const RayBlock& b, std::size_t first, std::size_t last,
                                           const Vec3& about) {
  Sums s;
  for (std::size_t i = first; i < last; ++i) {
    const double w = b.weight[i];
    const Vec3 x = b.origin_mm(i) - about, k{b.kx[i], b.ky[i], b.kz[i]};
    const Vec3 wk = w * k;
    s.w += w;
    s.w2 += w * w;
    s.back += k.z < 0.0 ? w : 0.0;
    s.x += w * x;
    s.k += wk;
    s.kkx += dot(k, x) * wk;
    s.kk[0] += wk.x * k.x;
    s.kk[1] += wk.x * k.y;
    s.kk[2] += wk.x * k.z;
    s.kk[3] += wk.y * k.y;
    s.kk[4] += wk.y * k.z;
    s.kk[5] += wk.z * k.z;
    s.low[0] = std::min(s.low[0], b.x_mm[i]), s.high[0] = std::max(s.high[0], b.x_mm[i]);
    s.low[1] = std::min(s.low[1], b.y_mm[i]), s.high[1] = std::max(s.high[1], b.y_mm[i]);
    s.low[2] = std::min(s.low[2], b.z_mm[i]), s.high[2] = std::max(s.high[2], b.z_mm[i]);
    s.w_low = std::min(s.w_low, b.weight[i]), s.w_high = std::max(s.w_high, b.weight[i]);
  }
  return s;
}

void RayStatistics::add(const RayBlock& block) {
  if (block.empty()) return;
  if (count_ == 0) about_ = block.origin_mm(0);
  for (const Sums& part : parallel_map_blocks<Sums>(
           block.size(), kSummedRays,
           [&](std::size_t first, std::size_t last) { return sums_of(block, first, last, about_); })) {
    sums_.add(part);
  }
  count_ += block.size();
}

RaySummary RayStatistics::result() const {
  RaySummary r;
  r.count = count_;
  if (count_ == 0) return r;
  const Sums& s = sums_;
  r.weight_sum = s.w;
  r.weight_min = s.w_low;
  r.weight_max = s.w_high;
  r.equal_weights = static_cast<double>(s.w_high - s.w_low) <= 1e-6 * static_cast<double>(s.w_high);
  r.extent_min_mm = Vec3{s.low[0], s.low[1], s.low[2]};
  r.extent_max_mm = Vec3{s.high[0], s.high[1], s.high[2]};
  if (!(s.w > 0.0)) return r;
  r.effective_rays = s.w * s.w / s.w2;
  r.backwards_share = s.back / s.w;
  r.mean_start_mm = about_ + s.x / s.w;
  r.mean_direction = s.k / s.w;

  // A = sum w (I - k k^T), A (F - about) = sum w (I - k k^T) (x - about), all over sum w (Muschaweck 2019).
  Eigen::Matrix3d kk;
  kk << s.kk[0], s.kk[1], s.kk[2], s.kk[1], s.kk[3], s.kk[4], s.kk[2], s.kk[4], s.kk[5];
  const Eigen::Matrix3d a = (kk.trace() * Eigen::Matrix3d::Identity() - kk) / s.w;
  const Eigen::Vector3d mean = to_eigen(s.x) / s.w;
  // About the mean start, so that an axis without information leaves the mean where it is.
  const Eigen::Vector3d b = (to_eigen(s.x) - to_eigen(s.kkx)) / s.w - a * mean;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(a);
  Eigen::Vector3d focus = mean;
  VirtualFocus found;
  for (int i = 0; i < 3; ++i) {
    const double value = solver.eigenvalues()[i];
    const Eigen::Vector3d axis = solver.eigenvectors().col(i);
    if (value > kParallel) {
      focus += axis.dot(b) / value * axis;
    } else {
      found.determined = false;
    }
  }
  found.point_mm = about_ + to_vec3(focus);
  r.virtual_focus = found;
  return r;
}

RaySummary summarize(const RayBlock& rays) {
  RayStatistics statistics;
  statistics.add(rays);
  return statistics.result();
}

double sum_of_weights(const RayBlock& rays) {
  return std::accumulate(rays.weight.begin(), rays.weight.end(), 0.0);
}

}  // namespace lucerna
