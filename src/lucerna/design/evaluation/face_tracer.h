// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "lucerna/design/evaluation/design_rays.h"
#include "lucerna/design/evaluation/evaluation_kernel.h"
#include "lucerna/design/evaluation/refracting_face.h"
#include "lucerna/trace/kernels/hit_kernels.h"

namespace lucerna {

static_assert(kBlockRays <= kHitBatch);

/// Traces blocks of rays through a face of a lens: the last one, or the first one and then a last one that
/// stays as it is.
class FaceTracer {
 public:
  /// `last`: null where the shape is the last face itself.
  FaceTracer(const EvaluationView<BsplineView>& view, const MediumView& medium, const DesignShape* last)
      : view_(view),
        media_(last == nullptr ? media_of_last_face(medium) : media_of_first_face(medium)),
        face_(hit_mirror(view.shape, view.aperture)) {
    if (last == nullptr) return;
    const BsplineView shape = std::get<BsplineShape>(last->family()).view();
    last_.emplace(
        LastFace{shape, last->aperture(), hit_mirror(shape, last->aperture()), media_of_last_face(medium)});
  }

  /// Sums as EvaluationView::count tells them.
  template <class Sums>
  void add(const DesignRays::Block& block, Sums& sums) {
    for (std::size_t i = 0; i < kBlockRays; ++i) {
      sums.weight += static_cast<double>(block.weight[i]);
      put(i, {block.x_mm[i], block.y_mm[i], block.z_mm[i]}, {block.kx[i], block.ky[i], block.kz[i]});
    }
    kernels_.bspline(face_, rays_, kBlockRays, ends_);
    std::size_t n = 0;
    for (std::size_t i = 0; i < kBlockRays; ++i) {
      const auto weight = static_cast<double>(block.weight[i]);
      if (!(weight > 0.0) || !meets(view_.shape, media_, i, weight, hit_[n], sums)) continue;
      if (!last_) {
        count({hit_[n], nullptr}, weight, sums);
      } else {
        weight_[n++] = weight;
      }
    }
    if (last_) leave(n, sums);
  }

 private:
  struct LastFace {
    BsplineView shape;
    Aperture aperture;
    HitMirror<BsplineHitTable> hits;
    FaceMedia media;
  };
  /// Where a ray meets the shape, and the last face behind it, if there is one.
  struct Way {
    const FaceHit& hit;
    const FaceHit* last;
    const FaceHit& end() const { return last ? *last : hit; }
    double share() const { return hit.share * (last ? last->share : 1.0); }
  };
  using Support = std::array<double, BsplineView::kSupport>;

  void put(std::size_t i, const Vec3& from, const Vec3& along) {
    rays_.x[i] = from.x;
    rays_.y[i] = from.y;
    rays_.z[i] = from.z;
    rays_.dx[i] = along.x;
    rays_.dy[i] = along.y;
    rays_.dz[i] = along.z;
    rays_.on_mirror[i] = rays_.slope[i] = 0.0;
  }

  /// Whether ray i of the batch goes on beyond a face.
  template <class Sums>
  bool meets(const BsplineView& shape, const FaceMedia& media, std::size_t i, double weight, FaceHit& hit,
             Sums& sums) const {
    if (ends_.what[i] != kHitFront) {
      sums.ended(PathEnd::lost, weight, 0.0);
      return false;
    }
    const Vec3 o{rays_.x[i], rays_.y[i], rays_.z[i]}, d{rays_.dx[i], rays_.dy[i], rays_.dz[i]};
    if (refract_at(shape, media, o, d, ends_.t[i], hit)) return true;
    sums.ended(PathEnd::back, weight, 0.0);
    return false;
  }

  /// The first n hits go on to the last face.
  template <class Sums>
  void leave(std::size_t n, Sums& sums) {
    for (std::size_t i = 0; i < n; ++i) put(i, hit_[i].point, hit_[i].out);
    kernels_.bspline(last_->hits, rays_, n, ends_);
    FaceHit last;
    for (std::size_t i = 0; i < n; ++i) {
      if (meets(last_->shape, last_->media, i, weight_[i], last, sums))
        count({hit_[i], &last}, weight_[i], sums);
    }
  }

  template <class Sums>
  void count(const Way& way, double weight, Sums& sums) const {
    const double flux = weight * way.share();
    sums.ended(PathEnd::reflected, flux, weight - flux);
    TentDeposit to;
    view_.bins.deposit(way.end().point, way.end().out, to);
    for (int k = 0; k < to.n; ++k) {
      const auto i = static_cast<std::size_t>(k);
      sums.add(to.bin[i], flux * to.weight[i]);
    }
    if (view_.derivatives && to.n > 0) differentiate(way, flux, to, sums);
  }

  /// Light moves from bin to bin, what passes changes, and so does what the rims let through.
  template <class Sums>
  void differentiate(const Way& way, double flux, const TentDeposit& to, Sums& sums) const {
    const FaceHit& end = way.end();
    const TentGradient in_u = view_.bins.gradient_u(end.point, end.out);
    const Support u = gradient(way, {in_u.direction, in_u.origin}, 0.0, 0.0);
    Support v{};
    if (!view_.bins.is_rings()) {
      const TentGradient in_v = view_.bins.gradient_v(end.point, end.out);
      v = gradient(way, {in_v.direction, in_v.origin}, 0.0, 0.0);
    }
    const Support share = share_gradient(way);
    const Support none{};
    for (std::size_t k = 0; k < static_cast<std::size_t>(to.n); ++k) {
      Support all;
      for (std::size_t i = 0; i < all.size(); ++i)
        all[i] = to.du[k] * u[i] + to.dv[k] * v[i] + to.weight[k] * share[i];
      view_.shape.add(way.hit.local, flux, all.data(), 0.0, none.data(), sums.row(to.bin[k]));
    }
  }

  /// Of the logarithm of the light that passes: by Fresnel's share, by the medium, and by the rims.
  Support share_gradient(const Way& way) const {
    const FaceHit& hit = way.hit;
    Support out = gradient({hit, nullptr}, {}, hit.log_by_c, hit.log_by_way);
    add_rim({hit, nullptr}, view_.aperture, out);
    if (!way.last) return out;
    add(gradient(way, {}, way.last->log_by_c, way.last->log_by_way), 1.0, out);
    add_rim(way, last_->aperture, out);
    return out;
  }

  /// What a strip inside the rim of the way's last face says of light that crosses it.
  void add_rim(const Way& way, const Aperture& aperture, Support& out) const {
    const RimDistance rim = rim_distance(aperture, way.end().point.x, way.end().point.y);
    if (rim.inside_mm < view_.rim_mm)
      add(gradient(way, {{}, rim.gradient}, 0.0, 0.0), 1.0 / view_.rim_mm, out);
  }

  static void add(const Support& from, double times, Support& to) {
    for (std::size_t i = 0; i < to.size(); ++i) to[i] += times * from[i];
  }

  /// Of a figure at the end of a way, by the coefficients of the shape.
  Support gradient(const Way& way, const RayGradient& at_end, double by_c, double by_way) const {
    HitAdjoint by;
    if (way.last) {
      const RayGradient between = ray_adjoint(*way.last, at_end.direction, at_end.point, by_c, by_way);
      by = face_adjoint(way.hit, between.direction, between.point, 0.0, 0.0);
    } else {
      by = face_adjoint(way.hit, at_end.direction, at_end.point, by_c, by_way);
    }
    Support out;
    view_.shape.gradient(way.hit.local, by.alpha, by.beta, by.gamma, out.data());
    return out;
  }

  const EvaluationView<BsplineView>& view_;
  FaceMedia media_;
  HitMirror<BsplineHitTable> face_;
  std::optional<LastFace> last_;
  const HitKernels& kernels_ = best_hit_kernels();
  HitRays rays_{};
  HitEnds ends_;
  /// Of the rays that are on their way to the last face; without one, of the ray at work.
  std::array<FaceHit, kBlockRays> hit_;
  std::array<double, kBlockRays> weight_;
};

}  // namespace lucerna
