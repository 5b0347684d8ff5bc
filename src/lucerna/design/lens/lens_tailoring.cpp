// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/lens/lens_tailoring.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "lucerna/core/parallel/parallel.h"
#include "lucerna/design/lens/lens_curves.h"
#include "lucerna/design/lens/lens_path.h"
#include "lucerna/design/lens/lens_smoothness.h"
#include "lucerna/design/solver/levenberg_marquardt.h"
#include "lucerna/design/solver/residual_rows.h"

namespace lucerna {

namespace {

/// Rays of the point between the axis and the one against it.
constexpr int kTailoredRays = 512;
/// Ways with less of the source's light are not tailored; the two with the most are varied.
constexpr double kLeastOfWay = 0.02;
constexpr std::size_t kVariedWays = 2;
/// How far the face over the source is raised, over the lens's radius.
constexpr std::array<double, 4> kRaises{0.0, -0.1, 0.1, 0.2};
/// Longest way of a corner in one step over the radius, and the most steps.
constexpr double kLongestTailoredMove = 0.03;
constexpr int kTailoredSteps = 40;
constexpr double kGainAtEnd = 1e-3;
/// What a ray costs that has left its way, as an angle.
constexpr double kOffWayRad = 0.5;
/// Weight of roughness: a wave of 3 % of the radius with three half periods counts as a degree.
constexpr double kTailoredRoughness = 1e-6;
/// Weight of the limits: in a fit a corner is as good as stopped by them, and here it has far to go.
constexpr double kLimitsWeight = 1e-4;
/// What moves of a corner weigh in a step beside the turns of the sides: in mm alike, whatever rays say of
/// it, else edges go where sides become short.
constexpr double kMoveShare = 0.01;

/// Where the light of a way is to go.
enum class Aim { spread, crossed, collimated };
constexpr std::array kAims{Aim::spread, Aim::crossed, Aim::collimated};

/// The faces that light meets, and whether they reflect it: a way from the source to the outside.
using Way = std::vector<std::pair<std::size_t, bool>>;

Way way_of(const LensPath& path, const LensCurves& curves) {
  Way out;
  for (int i = 0; i < path.hits; ++i) {
    const LensHit& hit = path.hit[static_cast<std::size_t>(i)];
    out.emplace_back(curves.pieces()[static_cast<std::size_t>(hit.piece)].face, hit.reflected);
  }
  return out;
}

/// Rays of the point in the half plane, from +z on, each for a ring of directions.
struct MeridianFan {
  Vec3 from;
  std::vector<double> flux;  ///< in shares of the source's

  Vec3 direction(std::size_t i) const {
    const double theta = (static_cast<double>(i) + 0.5) * std::numbers::pi / static_cast<double>(flux.size());
    return {std::sin(theta), 0.0, std::cos(theta)};
  }
};

/// The ways of the light with more than `kLeastOfWay`, that with the most first.
std::vector<Way> main_ways(const LensShape& shape, const MediumView& medium, const MeridianFan& fan) {
  const LensCurves curves(shape);
  const LensTracer tracer(curves, medium);
  LensPath path;
  std::vector<std::pair<double, Way>> ways;
  for (std::size_t i = 0; i < fan.flux.size(); ++i) {
    if (fan.flux[i] == 0.0) continue;
    tracer.follow(fan.from, fan.direction(i), kNoGhost, path);
    if (path.end != LensEnd::left) continue;
    Way way = way_of(path, curves);
    const auto found = std::find_if(ways.begin(), ways.end(), [&](const auto& w) { return w.second == way; });
    if (found == ways.end()) {
      ways.emplace_back(fan.flux[i], std::move(way));
    } else {
      found->first += fan.flux[i];
    }
  }
  std::stable_sort(ways.begin(), ways.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<Way> out;
  for (auto& [flux, way] : ways) {
    if (flux >= kLeastOfWay) out.push_back(std::move(way));
  }
  return out;
}

/// A shape with the normal equations of where its rays go.
struct TailoredPoint {
  LensShape shape;
  NormalEquations equations;
};

/// Where the rays of a point go, against where they are to go.
class TailoringObjective {
 public:
  TailoringObjective(const LensShape& start, const MediumView& medium, const MeridianFan& fan,
                     const PrescribedAngle& angle, const LensLimits& limits, const std::vector<Way>& ways,
                     std::vector<Aim> aims)
      : medium_(medium),
        fan_(fan),
        angle_(angle),
        limits_(limits),
        ways_(ways),
        aims_(std::move(aims)),
        signs_(draft_signs(start)),
        roughness_(kTailoredRoughness * lens_roughness(start)) {}

  TailoredPoint at(const LensShape& shape) const {
    TailoredPoint out{shape, {}};
    out.equations.cost = std::numeric_limits<double>::infinity();
    if (!shape.is_valid()) return out;
    out.equations = equations(shape);
    const Eigen::VectorXd rough = roughness_ * shape.parameters();
    out.equations.cost += shape.parameters().dot(rough);
    out.equations.gradient += rough;
    out.equations.hessian += roughness_;
    add_limits(shape, out.equations);
    return out;
  }

 private:
  /// A ray that goes one of the ways.
  struct Followed {
    std::size_t way;
    double flux, gamma;
  };

  void add_limits(const LensShape& shape, NormalEquations& to) const {
    NormalEquations broken{0.0, Eigen::VectorXd::Zero(to.gradient.size()),
                           Eigen::MatrixXd::Zero(to.hessian.rows(), to.hessian.cols())};
    ResidualRows rows;
    broken.cost = lens_limits_cost(limits_, shape, signs_, rows);
    rows.add_to(broken);
    to.cost += kLimitsWeight * broken.cost;
    to.gradient += kLimitsWeight * broken.gradient;
    to.hessian += kLimitsWeight * broken.hessian;
  }

  NormalEquations equations(const LensShape& shape) const {
    const LensCurves curves(shape);
    const LensTracer tracer(curves, medium_);
    const auto numbers = static_cast<Eigen::Index>(curves.number_count());
    std::vector<Followed> rays;
    Eigen::MatrixXd slopes(numbers, static_cast<Eigen::Index>(fan_.flux.size()));
    double cost = 0.0;
    LensPath path;
    for (std::size_t i = 0; i < fan_.flux.size(); ++i) {
      if (fan_.flux[i] == 0.0) continue;
      tracer.follow(fan_.from, fan_.direction(i), kNoGhost, path);
      if (path.end == LensEnd::direct) continue;
      const auto way = std::find(ways_.begin(), ways_.end(), way_of(path, curves));
      if (way == ways_.end()) {
        cost += fan_.flux[i] * kOffWayRad * kOffWayRad;
        continue;
      }
      slopes.col(static_cast<Eigen::Index>(rays.size())) = slope(path, curves);
      rays.push_back({static_cast<std::size_t>(way - ways_.begin()), fan_.flux[i],
                      std::atan2(path.direction.x, path.direction.z)});
    }
    const auto n = static_cast<Eigen::Index>(rays.size());
    const Eigen::MatrixXd jacobian = slopes.leftCols(n).transpose() * number_jacobian(shape);
    NormalEquations out;
    const Eigen::VectorXd off = residuals(rays);
    Eigen::VectorXd flux(n);
    for (Eigen::Index i = 0; i < n; ++i) flux[i] = rays[static_cast<std::size_t>(i)].flux;
    out.cost = cost + flux.dot(off.cwiseAbs2());
    out.gradient = jacobian.transpose() * flux.cwiseProduct(off);
    out.hessian = jacobian.transpose() * flux.asDiagonal() * jacobian;
    return out;
  }

  /// How the direction that a ray leaves in, an angle from +z, changes with the numbers of the curves.
  Eigen::VectorXd slope(const LensPath& path, const LensCurves& curves) const {
    Eigen::VectorXd out = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(curves.number_count()));
    std::array<LensAdjoint, kMaxLensHits> by;
    lens_adjoint(path, medium_, path.hits - 1, {path.direction.z, 0.0, -path.direction.x}, {}, false,
                 by.data());
    for (std::size_t i = 0; i < static_cast<std::size_t>(path.hits); ++i) {
      const int first = curves.pieces()[static_cast<std::size_t>(path.hit[i].piece)].first_number;
      if (first < 0) continue;
      const auto numbers = piece_derivatives(path.hit[i], by[i]);
      out.segment<kPieceNumbers>(first) +=
          Eigen::Map<const Eigen::Vector<double, kPieceNumbers>>(numbers.data());
    }
    return out;
  }

  /// By how much each ray leaves in another direction than it is to, rad.
  Eigen::VectorXd residuals(const std::vector<Followed>& rays) const {
    std::vector<double> all(ways_.size(), 0.0), before(ways_.size(), 0.0);
    for (const Followed& r : rays) all[r.way] += r.flux;
    Eigen::VectorXd out(static_cast<Eigen::Index>(rays.size()));
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const Followed& r = rays[i];
      const double wanted = wanted_angle(aims_[r.way], (before[r.way] + 0.5 * r.flux) / all[r.way]);
      before[r.way] += r.flux;
      out[static_cast<Eigen::Index>(i)] = std::remainder(r.gamma - wanted, 2.0 * std::numbers::pi);
    }
    return out;
  }

  /// Of the ray within which that share of its way's light is.
  double wanted_angle(Aim aim, double share) const {
    switch (aim) {
      case Aim::spread:
        return angle_.of(share);
      case Aim::crossed:
        return -angle_.of(share);
      case Aim::collimated:
        break;
    }
    // A beam is collimated along the axis that most of it is near to.
    return angle_.of(0.5) < 0.5 * std::numbers::pi ? 0.0 : std::numbers::pi;
  }

  const MediumView& medium_;
  const MeridianFan& fan_;
  const PrescribedAngle& angle_;
  const LensLimits& limits_;
  const std::vector<Way>& ways_;
  std::vector<Aim> aims_;
  std::vector<double> signs_;
  Eigen::MatrixXd roughness_;
};

/// The shape after the steps.
LensShape tailored(const LensShape& from, const TailoringObjective& objective, const Eigen::MatrixXd& tilt) {
  TailoredPoint now = objective.at(from);
  if (!std::isfinite(now.equations.cost)) return from;
  double lambda = 1e-3;
  const double longest = kLongestTailoredMove * from.radius_mm();
  for (int step = 0; step < kTailoredSteps && lambda < kMaxLambda; ++step) {
    const double before = now.equations.cost;
    const double mean = now.equations.hessian.diagonal().mean();
    Eigen::MatrixXd metric = (kTiltShare * mean) * tilt;
    metric.diagonal().array() += kMoveShare * mean;
    const Eigen::VectorXd p = now.shape.parameters();
    const LevenbergMarquardtStep made = levenberg_marquardt_step(
        now, [&](double damping) { return damped_step(now.equations, metric, damping); }, lambda, longest,
        [&](const Eigen::VectorXd& move) { return objective.at(from.with(p + move)); });
    lambda = made.next_lambda;
    if (made.accepted && before - now.equations.cost < kGainAtEnd * before) break;
  }
  return now.shape;
}

/// The face that the light about the axis meets first, moved along the axis.
LensShape raised(const LensShape& start, std::size_t face_number, double by_mm) {
  const LensForm& form = start.form();
  const LensFace& face = form.faces[face_number];
  Eigen::VectorXd p = start.parameters();
  for (const CornerMove& m : form.moves) {
    for (std::size_t i = face.run.from; i <= face.run.to; ++i) {
      if (corner_number(form, i) == m.corner)
        p[static_cast<Eigen::Index>(m.parameter)] += by_mm * m.direction[1];
    }
  }
  return start.with(std::move(p));
}

/// The given lens, and those whose free entry on the axis is higher or lower.
std::vector<LensShape> raised_lenses(const LensShape& start, const MediumView& medium,
                                     const MeridianFan& fan) {
  const LensCurves curves(start);
  LensPath path;
  LensTracer(curves, medium).follow(fan.from, {0.0, 0.0, 1.0}, kNoGhost, path);
  if (path.hits == 0) return {start};
  const std::size_t face = curves.pieces()[static_cast<std::size_t>(path.hit.front().piece)].face;
  if (!start.form().faces[face].is_free) return {start};
  std::vector<LensShape> out;
  for (const double raise : kRaises) {
    LensShape shape = raised(start, face, raise * start.radius_mm());
    if (shape.is_valid()) out.push_back(std::move(shape));
  }
  return out;
}

/// What the ways are aimed at: all combinations for the first `kVariedWays`, the others spread.
std::vector<std::vector<Aim>> aim_combinations(std::size_t ways) {
  std::vector<std::vector<Aim>> out{std::vector<Aim>(ways, Aim::spread)};
  for (std::size_t w = 0; w < std::min(kVariedWays, ways); ++w) {
    std::vector<std::vector<Aim>> more;
    for (const std::vector<Aim>& aims : out) {
      for (const Aim aim : kAims) {
        more.push_back(aims);
        more.back()[w] = aim;
      }
    }
    out = std::move(more);
  }
  return out;
}

}  // namespace

std::vector<LensShape> tailored_lenses(const LensShape& start, const MediumView& medium,
                                       const PointSource& source, const PrescribedAngle& angle,
                                       const LensLimits& limits) {
  const MeridianFan fan{{0.0, 0.0, source.at_mm.z}, meridian_light(source, kTailoredRays)};
  const std::vector<Way> ways = main_ways(start, medium, fan);
  if (ways.empty()) return {};
  const Eigen::MatrixXd tilt = lens_tilt(start);
  const std::vector<LensShape> from = raised_lenses(start, medium, fan);
  const auto aims = aim_combinations(ways.size());
  std::vector<LensShape> found(from.size() * aims.size(), start);
  parallel_blocks(found.size(), 1, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const TailoringObjective objective(start, medium, fan, angle, limits, ways, aims[i % aims.size()]);
      found[i] = tailored(from[i / aims.size()], objective, tilt);
    }
  });
  return found;
}

}  // namespace lucerna
