// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/constraints/zone_cost.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace lucerna {

namespace {

/// Of a bound: the margin without noise, with all noise, and of a narrow band (share of its half width).
constexpr double kZoneMargin = 0.02, kMaxMargin = 0.15, kBandShare = 0.4;
/// Light of a zone whose bounds do not say how much there is, as a share of the sources'.
constexpr double kUsualShare = 0.2;
/// Places across a cell where the bins are looked at.
constexpr int kCellPlaces = 4;
/// By level of a search: bounds, and a guide.
constexpr std::array<ZoneStage, 4> kStages{{{0.02, 1.0}, {0.1, 0.3}, {1.0, 0.05}, {3.0, 0.02}}};

/// Weights of the bins at a ray's place; false where they see less than all of it.
bool bins_at(const TentBins& bins, const Ray& ray, TentDeposit& d) {
  bins.deposit(ray.origin_mm, ray.direction.vec(), d);
  double sum = 0.0;
  for (int k = 0; k < d.n; ++k) sum += d.weight[static_cast<std::size_t>(k)];
  return sum > 0.5;
}

}  // namespace

ZoneStage zone_stage(int level) {
  return kStages[static_cast<std::size_t>(std::clamp(level, 0, static_cast<int>(kStages.size()) - 1))];
}

ZoneCost::ZoneCost(const ZoneBands& bands, const TentBins& bins, std::uint64_t rays, double weight)
    : cells_(bands.cells),
      source_flux_(bands.source_flux),
      weight_(weight),
      rays_(rays),
      seen_(bands.cells->size(), 1) {
  std::vector<Eigen::Triplet<double>> entries;
  const double per = cells_->unit() * source_flux_ / (kCellPlaces * kCellPlaces);
  for (std::size_t c = 0; c < cells_->size(); ++c) {
    for (int i = 0; i < kCellPlaces * kCellPlaces; ++i) {
      const Ray ray = cells_->ray_into(cells_->cells()[c], (i / kCellPlaces + 0.5) / kCellPlaces,
                                       (i % kCellPlaces + 0.5) / kCellPlaces);
      TentDeposit d;
      if (!bins_at(bins, bands.mirror_from_world.ray(ray), d)) seen_[c] = 0;
      for (std::size_t k = 0; k < static_cast<std::size_t>(d.n); ++k) {
        const double measure = bins.measure()[static_cast<std::size_t>(d.bin[k])];
        if (measure > 0.0) entries.emplace_back(static_cast<int>(c), d.bin[k], per * d.weight[k] / measure);
      }
    }
  }
  mean_.resize(static_cast<Eigen::Index>(cells_->size()), static_cast<Eigen::Index>(bins.size()));
  mean_.setFromTriplets(entries.begin(), entries.end());
}

Eigen::VectorXd ZoneCost::values(const Evaluation& light) const {
  Eigen::VectorXd x = mean_ * light.flux;
  for (Eigen::Index c = 0; c < x.size(); ++c) {
    if (seen_[static_cast<std::size_t>(c)] == 0) x[c] = std::numeric_limits<double>::quiet_NaN();
  }
  return x;
}

Eigen::VectorXd ZoneCost::reference(std::size_t zone, const ZoneBound& bound,
                                    const Eigen::VectorXd& x) const {
  if (bound.reference == ZoneReference::absolute) return {};
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(x.size());
  const std::size_t of = bound.reference == ZoneReference::mean ? bound.mean_of : zone;
  auto best = static_cast<Eigen::Index>(cells_->first(of));
  for (auto c = best; c < static_cast<Eigen::Index>(cells_->first(of + 1)); ++c) {
    if (seen_[static_cast<std::size_t>(c)] == 0) continue;
    weights[c] = cells_->cells()[static_cast<std::size_t>(c)].measure;
    if (x[c] > x[best]) best = c;
  }
  if (bound.reference == ZoneReference::mean) return weights / std::max(weights.sum(), 1e-300);
  weights.setZero();
  weights[best] = 1.0;
  return weights;
}

double ZoneCost::margin(std::size_t zone, const ZoneBound& bound, std::size_t cell) const {
  const double measure = cells_->cells()[cell].measure;
  const bool absolute = bound.reference == ZoneReference::absolute;
  const auto cells = static_cast<double>(cells_->first(zone + 1) - cells_->first(zone));
  const double share =
      absolute ? bound.value * measure / (cells_->unit() * source_flux_) : kUsualShare / cells;
  const double noise = 1.0 / std::sqrt(std::max(1.0, share * static_cast<double>(rays_)));
  double m = std::min(kMaxMargin, kZoneMargin + noise);
  for (const ZoneBound& b : cells_->zones()[zone].bounds) {
    if (b.is_min == bound.is_min || b.reference != bound.reference) continue;
    m = std::min(m, kBandShare * std::abs(b.value - bound.value) / (b.value + bound.value));
  }
  return m;
}

ZoneCost::Broken ZoneCost::broken(std::size_t zone, const ZoneBound& bound, const Eigen::VectorXd& x) const {
  Broken out;
  out.reference = reference(zone, bound, x);
  double level = bound.value;  // what cells are compared with
  if (out.reference.size() > 0) {
    double sum = 0.0;
    for (Eigen::Index c = 0; c < x.size(); ++c)
      sum += out.reference[c] != 0.0 ? out.reference[c] * x[c] : 0.0;
    level *= std::max(sum, 1e-300);
  }
  const std::size_t first = cells_->first(zone), end = cells_->first(zone + 1);
  const double root = std::sqrt(weight_ / std::sqrt(static_cast<double>(end - first)));
  std::vector<double> residual, by_cell, by_reference;
  for (std::size_t c = first; c < end; ++c) {
    if (seen_[c] == 0) continue;
    const double scale = margin(zone, bound, c) * level, sign = bound.is_min ? 1.0 : -1.0;
    const double here = x[static_cast<Eigen::Index>(c)], missing = 1.0 - sign * (here - level) / scale;
    if (!(missing > 0.0)) continue;
    out.cells.push_back(static_cast<Eigen::Index>(c));
    residual.push_back(root * missing);
    by_cell.push_back(-root * sign / scale);
    by_reference.push_back(root * sign / scale * bound.value * here / level);
  }
  const auto n = static_cast<Eigen::Index>(residual.size());
  out.residual = Eigen::Map<const Eigen::VectorXd>(residual.data(), n);
  out.by_cell = Eigen::Map<const Eigen::VectorXd>(by_cell.data(), n);
  out.by_reference = Eigen::Map<const Eigen::VectorXd>(by_reference.data(), n);
  return out;
}

double ZoneCost::cost(const Evaluation& light) const {
  const Eigen::VectorXd x = values(light);
  double cost = 0.0;
  for (std::size_t z = 0; z < cells_->zones().size(); ++z) {
    for (const ZoneBound& bound : cells_->zones()[z].bounds)
      cost += broken(z, bound, x).residual.squaredNorm();
  }
  return cost;
}

void ZoneCost::add(const Broken& b, const Evaluation& light, SparseEquations& equations) const {
  const auto n = static_cast<Eigen::Index>(b.cells.size());
  Matrix pick(n, mean_.rows());
  pick.reserve(Eigen::VectorXi::Constant(n, 1));
  for (Eigen::Index i = 0; i < n; ++i) {
    pick.insert(i, b.cells[static_cast<std::size_t>(i)]) = b.by_cell[i];
  }
  const Matrix weights = pick * mean_;
  const Matrix j = weights * light.rows;  // of the residuals, were the reference fixed
  equations.cost += b.residual.squaredNorm();
  equations.gradient += j.transpose() * b.residual;
  equations.hessian += squared_rows(j);
  if (b.reference.size() == 0) return;
  // A row is j_i + k_i r with r the reference's: what joins them all stays two products.
  const Eigen::VectorXd of_bins = mean_.transpose() * b.reference;
  const Eigen::VectorXd r = light.rows.transpose() * of_bins, &k = b.by_reference;
  const double own = k.squaredNorm();
  const Eigen::VectorXd cross = j.transpose() * k;
  equations.gradient += k.dot(b.residual) * r;
  if (!(own > 0.0)) return;
  equations.products.push_back({r + cross / own, own});
  equations.products.push_back({cross, -1.0 / own});
}

void ZoneCost::add_to(const Evaluation& light, SparseEquations& equations) const {
  const Eigen::VectorXd x = values(light);
  for (std::size_t z = 0; z < cells_->zones().size(); ++z) {
    for (const ZoneBound& bound : cells_->zones()[z].bounds) {
      const Broken b = broken(z, bound, x);
      if (!b.cells.empty()) add(b, light, equations);
    }
  }
}

}  // namespace lucerna
