// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "patch.h"

namespace bench {

namespace {

/// Pieces into which knot intervals are cut, until flat ones are as near as this, or there are so many.
constexpr double kChordMm = 1e-3;
constexpr std::size_t kMinSteps = 128;
/// Edges are looked at in so many places until they are cut into more pieces than this.
constexpr int kFirstPlaces = 7;
constexpr std::size_t kFirstPieces = 2;
/// Newton's method ends at this distance between ray and surface.
constexpr double kExactMm = 1e-10;

class PatchSurface final : public Surface {
 public:
  PatchSurface(std::unique_ptr<const Patch> patch, const Frame& place)
      : patch_(std::move(patch)), place_(place) {
    cut();
    for (const Vec3& p : mesh_.corners) size_ = std::max(size_, length(p - mesh_.corners[0]));
  }

  const Triangles& triangles() const override { return mesh_; }
  bool whole(const std::array<std::uint32_t, 3>& t) const override {
    return kept(t[0]) && kept(t[1]) && kept(t[2]);
  }
  std::vector<Vec3> extent() const override {
    if (!patch_->trimmed()) return mesh_.corners;
    std::vector<Vec3> out;
    for (std::size_t k = 0; k < mesh_.corners.size(); ++k) {
      if (kept(k)) out.push_back(mesh_.corners[k]);
    }
    for (const auto& t : mesh_.triangles) {
      for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t a = t[i], b = t[(i + 1) % 3];
        if (kept(a) && !kept(b)) out.push_back(rim(a, b));
      }
    }
    return out;
  }

  bool refine(const Vec3& origin, const Vec3& direction, const FlatHit& flat, Hit& hit) const override {
    auto [u, v] = on_quad(flat);
    double t = flat.t;
    const Vec3 o = place_.local_point(origin), d = place_.local_vector(direction);
    SurfaceJet jet;
    for (int step = 0;; ++step) {
      jet = patch_->jet(u, v);
      const Vec3 off = jet.point - o - t * d;
      if (length(off) < kExactMm) break;
      const Vec3 n = cross(jet.by_u, jet.by_v);
      const double across = dot(n, d);
      if (step == 12 || across == 0.0) return false;
      // off + du Pu + dv Pv = dt d, solved by triple products.
      const double dt = dot(off, n) / across;
      const Vec3 rest = dt * d - off;
      const double nn = dot(n, n);
      u += dot(cross(rest, jet.by_v), n) / nn;
      v += dot(cross(jet.by_u, rest), n) / nn;
      t += dt;
    }
    if (std::abs(t - flat.t) > 0.01 * size_ || !patch_->keeps(u, v, jet.point)) return false;
    hit.t = t;
    hit.normal = hit.geometric = place_.vector(patch_->side() * unit(cross(jet.by_u, jet.by_v)));
    return true;
  }

 private:
  Vec3 point(double u, double v) const { return patch_->jet(u, v).point; }
  bool kept(double u, double v) const { return patch_->keeps(u, v, point(u, v)); }
  bool kept(std::size_t corner) const { return kept_[corner] != 0; }
  double u_of(std::size_t corner) const { return u_[corner / v_.size()]; }
  double v_of(std::size_t corner) const { return v_[corner % v_.size()]; }
  /// Of two triangles a quad, as `cut` makes them.
  std::array<double, 2> on_quad(const FlatHit& flat) const {
    const std::size_t quad = flat.triangle / 2, i = quad / (v_.size() - 1), j = quad % (v_.size() - 1);
    const double both = flat.b1 + flat.b2;
    const double by_u = flat.triangle % 2 == 0 ? both : flat.b1,
                 by_v = flat.triangle % 2 == 0 ? flat.b2 : both;
    return {u_[i] + by_u * (u_[i + 1] - u_[i]), v_[j] + by_v * (v_[j + 1] - v_[j])};
  }
  /// Where the rim crosses the edge from a corner that is kept to one that is not.
  Vec3 rim(std::uint32_t kept_corner, std::uint32_t other) const {
    double in = 0.0, out = 1.0;
    const auto at = [&](double x) {
      return std::array{(1.0 - x) * u_of(kept_corner) + x * u_of(other),
                        (1.0 - x) * v_of(kept_corner) + x * v_of(other)};
    };
    for (int step = 0; step < 40; ++step) {
      const double x = 0.5 * (in + out);
      (kept(at(x)[0], at(x)[1]) ? in : out) = x;
    }
    return place_.point(point(at(in)[0], at(in)[1]));
  }
  std::vector<double> grid(std::size_t axis, std::size_t pieces) const {
    const auto ends = patch_->breaks(axis);
    std::vector<double> out{ends.front()};
    for (std::size_t k = 1; k < ends.size(); ++k) {
      for (std::size_t i = 1; i <= pieces; ++i)
        out.push_back(ends[k - 1] +
                      (ends[k] - ends[k - 1]) * static_cast<double>(i) / static_cast<double>(pieces));
    }
    out.back() = ends.back();
    return out;
  }
  /// Largest distance of an edge along an axis from the surface, by `places` within it: few of them can all
  /// lie on a polynomial that leaves the edge.
  double chord(const std::vector<double>& along, const std::vector<double>& across, std::size_t axis,
               int places) const {
    double worst = 0.0;
    for (std::size_t k = 1; k < along.size(); ++k) {
      for (const double w : across) {
        const auto at = [&](double x) { return axis == 0 ? point(x, w) : point(w, x); };
        const Vec3 from = at(along[k - 1]), to = at(along[k]);
        for (int i = 1; i <= places; ++i) {
          const double t = static_cast<double>(i) / (places + 1);
          const Vec3 flat = from + t * (to - from);
          worst = std::max(worst, length(at(along[k - 1] + t * (along[k] - along[k - 1])) - flat));
        }
      }
    }
    return worst;
  }
  /// Largest distance of the middle of a quad from that of the diagonal that cuts it: of a surface that is
  /// straight along an axis and yet twisted.
  double twist(const std::vector<double>& u, const std::vector<double>& v) const {
    double worst = 0.0;
    for (std::size_t i = 1; i < u.size(); ++i) {
      for (std::size_t j = 1; j < v.size(); ++j) {
        const Vec3 flat = 0.5 * (point(u[i - 1], v[j - 1]) + point(u[i], v[j]));
        worst = std::max(worst, length(point(0.5 * (u[i - 1] + u[i]), 0.5 * (v[j - 1] + v[j])) - flat));
      }
    }
    return worst;
  }
  void cut() {
    std::array<std::size_t, 2> pieces{1, 1};
    std::array<std::vector<double>, 2> at{grid(0, 1), grid(1, 1)};
    const auto coarse = [&](std::size_t axis) {
      // Trimmed surfaces have steps that their rims can be found between.
      if (patch_->trimmed() && at[axis].size() < kMinSteps) return true;
      // A quad's middle is as far off as the chords of its curved sides, too.
      if (patch_->straight(axis)) return twist(at[0], at[1]) > 2.0 * kChordMm;
      const int places = pieces[axis] <= kFirstPieces ? kFirstPlaces : 1;
      return chord(at[axis], grid(1 - axis, 2), axis, places) > kChordMm;
    };
    std::array<bool, 2> cut_more{true, true};
    while (2 * at[0].size() * at[1].size() <= kMaxQuads) {
      for (std::size_t axis = 0; axis < 2; ++axis) cut_more[axis] = cut_more[axis] && coarse(axis);
      if (!cut_more[0] && !cut_more[1]) break;
      // Where there is room for one of both, the one with fewer pieces: long thin triangles are poor guesses.
      const bool both = cut_more[0] && cut_more[1];
      const std::size_t axis = both ? (at[0].size() <= at[1].size() ? 0 : 1) : cut_more[0] ? 0 : 1;
      at[axis] = grid(axis, pieces[axis] *= 2);
    }
    u_ = std::move(at[0]);
    v_ = std::move(at[1]);
    for (const double u : u_) {
      for (const double v : v_) {
        const Vec3 p = point(u, v);
        kept_.push_back(patch_->keeps(u, v, p) ? 1 : 0);
        mesh_.corners.push_back(place_.point(p));
      }
    }
    const auto row = static_cast<std::uint32_t>(v_.size());
    for (std::uint32_t i = 0; i + 1 < u_.size(); ++i) {
      for (std::uint32_t j = 0; j + 1 < row; ++j) {
        const std::uint32_t k = i * row + j;
        mesh_.triangles.push_back({k, k + row, k + row + 1});
        mesh_.triangles.push_back({k, k + row + 1, k + 1});
      }
    }
  }

  std::unique_ptr<const Patch> patch_;
  Frame place_;
  double size_ = 0.0;
  Triangles mesh_;
  /// The lines of the quads' corners; a corner for each pair, along v first.
  std::vector<double> u_, v_;
  /// By corner: is it within the trim?
  std::vector<char> kept_;
};

}  // namespace

std::unique_ptr<Surface> surface_of(std::unique_ptr<const Patch> patch, const Frame& place) {
  return std::make_unique<PatchSurface>(std::move(patch), place);
}

}  // namespace bench
