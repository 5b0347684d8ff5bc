// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/initial/supporting_paraboloids.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <optional>

#include "lucerna/core/parallel/parallel.h"

namespace lucerna {

namespace {

/// Directions of the source that are transported; more only smooth what the entropy smooths anyway.
constexpr std::size_t kMaxSources = 1024;

/// -log(1 - d . o): the logarithm of the polar radius at d of a paraboloid about o with parameter 1.
double log_radius(const Direction& d, const Direction& o) {
  return -std::log(std::max(1e-9, 1.0 - dot(d, o)));
}

/// The source's light towards the mirror, thinned to kMaxSources of equal share of the list.
std::vector<DirectedFlux> towards(const DesignShape& shape, const PointSource& source) {
  std::vector<DirectedFlux> hits;
  for (const DirectedFlux& l : source.light) {
    if (!(l.flux > 0.0)) continue;
    // First crossing of the plain surface along the ray, in steps: it need not be exact.
    const double reach = 4.0 * shape.aperture().outer_radius_mm();
    for (double t = 0.0; t < reach; t += 0.01 * reach) {
      const Vec3 p = source.at_mm + t * l.direction.vec();
      if (!shape.aperture().contains(p.x, p.y)) {
        if (std::hypot(p.x, p.y) > shape.aperture().hole_radius_mm()) break;
        continue;
      }
      if (p.z > shape.at(p.x, p.y).z_mm) continue;
      hits.push_back(l);
      break;
    }
  }
  if (hits.size() <= kMaxSources) return hits;
  std::vector<DirectedFlux> thinned;
  for (std::size_t i = 0; i < kMaxSources; ++i) thinned.push_back(hits[i * hits.size() / kMaxSources]);
  return thinned;
}

/// Entropic optimal transport between directions; the potential over the source's is the envelope.
class Envelope {
 public:
  /// `sign` +1: the envelope from inside (least radius), -1: from outside.
  Envelope(std::span<const DirectedFlux> from, std::span<const DirectedFlux> to, double sign, double entropy)
      : to_(to.begin(), to.end()), sign_(sign), entropy_(entropy) {
    const auto n = static_cast<Eigen::Index>(from.size()), m = static_cast<Eigen::Index>(to.size());
    Eigen::MatrixXd cost(m, n);  // a column for each direction of the source
    parallel_blocks(from.size(), 64, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) {
        for (std::size_t j = 0; j < to.size(); ++j) {
          cost(static_cast<Eigen::Index>(j), static_cast<Eigen::Index>(i)) =
              sign * log_radius(from[i].direction, to[j].direction);
        }
      }
    });
    const Eigen::VectorXd a = log_shares(from), b = log_shares(to);
    g_ = Eigen::VectorXd::Zero(m);
    Eigen::VectorXd f(n);
    constexpr int kRounds = 10;
    for (double e = 0.25;; e *= 0.5) {
      e = std::max(e, entropy_);
      for (int round = 0; round < kRounds; ++round) {
        parallel_blocks(from.size(), 64, [&](std::size_t first, std::size_t last) {
          for (auto i = static_cast<Eigen::Index>(first); i < static_cast<Eigen::Index>(last); ++i) {
            f[i] = soft_min(((g_ - cost.col(i)) / e + b).array(), e);
          }
        });
        parallel_blocks(to.size(), 16, [&](std::size_t first, std::size_t last) {
          for (auto j = static_cast<Eigen::Index>(first); j < static_cast<Eigen::Index>(last); ++j) {
            g_[j] = soft_min(((f - cost.row(j).transpose()) / e + a).array(), e);
          }
        });
      }
      if (e <= entropy_) break;
    }
    b_ = b;
  }

  /// Polar radius towards a direction, up to a factor.
  double radius(const Direction& d) const {
    Eigen::ArrayXd terms(static_cast<Eigen::Index>(to_.size()));
    for (std::size_t j = 0; j < to_.size(); ++j) {
      const auto k = static_cast<Eigen::Index>(j);
      terms[k] = (g_[k] - sign_ * log_radius(d, to_[j].direction)) / entropy_ + b_[k];
    }
    return std::exp(sign_ * soft_min(terms, entropy_));
  }

 private:
  static Eigen::VectorXd log_shares(std::span<const DirectedFlux> light) {
    double total = 0.0;
    for (const DirectedFlux& l : light) total += l.flux;
    Eigen::VectorXd log(static_cast<Eigen::Index>(light.size()));
    for (std::size_t i = 0; i < light.size(); ++i) {
      log[static_cast<Eigen::Index>(i)] = std::log(light[i].flux / total);
    }
    return log;
  }
  /// -entropy * log(sum of exp(terms)).
  static double soft_min(const Eigen::ArrayXd& terms, double entropy) {
    const double max = terms.maxCoeff();
    return -entropy * (max + std::log((terms - max).exp().sum()));
  }

  std::vector<DirectedFlux> to_;
  double sign_, entropy_;
  Eigen::VectorXd g_, b_;
};

/// Height over (x, y) of the surface at the polar radius `scale` * envelope, by bisection along the vertical.
std::optional<double> height_at(const Envelope& envelope, double scale, const Vec3& source,
                                double distance_mm, double x, double y) {
  const auto outside = [&](double z) {
    const Vec3 v{x - source.x, y - source.y, z - source.z};
    return length(v) > scale * envelope.radius(Direction::from(v));
  };
  const double reach = std::hypot(x - source.x, y - source.y) + 4.0 * distance_mm;
  double low = source.z - 4.0 * reach, high = source.z + 0.9 * reach;
  if (!outside(low)) return std::nullopt;
  // From below: the first height that is inside.
  constexpr int kSteps = 48;
  double z = low;
  while (z < high && outside(z)) z += (high - low) / kSteps;
  if (outside(z)) return std::nullopt;
  high = z;
  low = z - (high - low) / kSteps;
  for (int i = 0; i < 36; ++i) {
    const double middle = 0.5 * (low + high);
    (outside(middle) ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace

std::vector<DesignShape> supporting_paraboloids(const DesignShape& family, const PointSource& source,
                                                std::span<const DirectedFlux> target_flux, double blur_rad) {
  std::vector<DirectedFlux> to;
  double max = 0.0;
  for (const DirectedFlux& l : target_flux) max = std::max(max, l.flux);
  for (const DirectedFlux& l : target_flux) {
    if (l.flux > 1e-4 * max) to.push_back(l);
  }
  std::vector<DesignShape> shapes;
  const double vertex = family.at(0.0, 0.0).z_mm, distance = source.at_mm.z - vertex;
  if (!(distance > 0.0) || to.empty()) return shapes;
  for (const double sign : {1.0, -1.0}) {
    DesignShape shape = family;
    bool whole = true;
    for (int round = 0; round < 2 && whole; ++round) {  // again with what the new shape catches
      const std::vector<DirectedFlux> from = towards(shape, source);
      if (from.size() < 16) return shapes;
      const Envelope envelope(from, to, sign, std::max(1e-3, blur_rad * blur_rad));
      const Vec3 down{-source.at_mm.x, -source.at_mm.y, -distance};
      const double scale = length(down) / envelope.radius(Direction::from(down));
      shape = family.through([&](double x, double y) {
        const std::optional<double> z = height_at(envelope, scale, source.at_mm, distance, x, y);
        if (!z) whole = false;
        return z.value_or(0.0);
      });
    }
    if (whole) shapes.push_back(shape);
  }
  return shapes;
}

}  // namespace lucerna
