// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/constraints/limits.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <type_traits>
#include <utility>

#include "lucerna/core/io/error.h"
#include "lucerna/design/constraints/keep_out.h"

namespace lucerna {

namespace {

constexpr double kHeightMargin_mm = 0.02, kSlopeMargin = 0.01, kCurvatureMargin = 0.02;
/// How many margins inside a limit on heights its cost begins: what a surface may rise between two places.
constexpr double kInside = 2.0;
/// Places looked at in a knot interval: as a cost beside the light, and where a limit itself must be held.
constexpr int kCoarsePlaces = 4, kFinePlaces = 12;
/// Gauss-Newton steps on the limits alone; hinges settle in a few dozen.
constexpr int kMaxSteps = 200;

/// Places where the surface is looked at: a grid of `per_interval` to a knot interval, and the outline.
template <class Place>
std::vector<Place> places_of(const DesignShape& shape, int per_interval) {
  const Aperture& a = shape.aperture();
  std::vector<Place> out;
  const double hole = a.hole_radius_mm();
  if (shape.is_revolution()) {
    const int n = std::max(48, per_interval * shape.intervals_x());
    for (int i = 0; i <= n; ++i) out.push_back({hole + (a.half_x_mm() - hole) * i / n, 0.0});
    return out;
  }
  const int nx = std::clamp(per_interval * shape.intervals_x(), 24, 160);
  const int ny = std::clamp(per_interval * shape.intervals_y(), 24, 160);
  for (int j = 0; j <= ny; ++j) {
    for (int i = 0; i <= nx; ++i) {
      const Place p{a.half_x_mm() * (2.0 * i / nx - 1.0), a.half_y_mm() * (2.0 * j / ny - 1.0)};
      if (a.contains(p.x, p.y)) out.push_back(p);
    }
  }
  const auto ring = [&](double r) {
    for (int i = 0; i < 4 * nx; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / (4.0 * nx);
      out.push_back({r * std::cos(angle), r * std::sin(angle)});
    }
  };
  if (a.shape() == ApertureShape::circle) ring(a.half_x_mm());
  if (hole > 0.0) ring(hole);
  return out;
}

/// A linear form of the parameters: the few coefficients that reach a place.
class Row {
 public:
  explicit Row(const DesignShape& design) : design_(design) {}

  /// Adds value * h + slope_x * h_x + slope_y * h_y at a place.
  void add(double x, double y, double value, double slope_x, double slope_y) {
    std::visit(
        [&](const auto& shape) {
          const auto view = shape.view();
          const auto local = view.local(x, y);
          std::array<double, std::decay_t<decltype(view)>::kSupport> d;
          view.gradient(local, value, slope_x, slope_y, d.data());
          view.add(local, 1.0, d.data(), 0.0, d.data(), Coefficients{*this});
        },
        design_.family());
  }
  /// Adds a second derivative: `along` of the slopes' change from place to place.
  void add_second(double x, double y, double xx, double xy, double yy) {
    const double e = 1e-4 * design_.aperture().outer_radius_mm(), per = 0.5 / e;
    add(x + e, y, 0.0, per * xx, per * xy);
    add(x - e, y, 0.0, -per * xx, -per * xy);
    add(x, y + e, 0.0, per * xy, per * yy);
    add(x, y - e, 0.0, -per * xy, -per * yy);
  }

  /// Adds the hinge `excess`, whose gradient this row is.
  void add_to(ResidualRows& rows, double excess) const {
    rows.begin(excess);
    for (std::size_t i = 0; i < index_.size(); ++i) rows.add(index_[i], value_[i]);
  }

 private:
  struct Coefficients {
    Row& row;
    void add(int coefficient, double value) const { row.put(coefficient, value); }
  };
  void put(int coefficient, double value) {
    const int parameter = design_.parameter_of()[static_cast<std::size_t>(coefficient)];
    const auto found = std::find(index_.begin(), index_.end(), parameter);
    if (found != index_.end()) {
      value_[static_cast<std::size_t>(found - index_.begin())] += value;
    } else {
      index_.push_back(parameter);
      value_.push_back(value);
    }
  }
  const DesignShape& design_;
  std::vector<int> index_;
  std::vector<double> value_;
};

/// The stronger principal curvature of a graph at a place, and what its direction takes from the second
/// derivatives.
struct Curvature {
  double value = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;
};

Curvature curvature_at(const DesignShape& design, double x, double y) {
  return std::visit(
      [&](const auto& shape) {
        const auto l = shape.view().local(x, y);
        const double w = std::sqrt(1.0 + l.hx * l.hx + l.hy * l.hy);
        const double e = 1.0 + l.hx * l.hx, f = l.hx * l.hy, g = 1.0 + l.hy * l.hy, det = e * g - f * f;
        const double a = l.hxx / w, b = l.hxy / w, c = l.hyy / w;
        const double mean = (e * c - 2.0 * f * b + g * a) / (2.0 * det), gauss = (a * c - b * b) / det;
        const double root = std::sqrt(std::max(0.0, mean * mean - gauss));
        Curvature k;
        k.value = mean >= 0.0 ? mean + root : mean - root;
        double vx = -(b - k.value * f), vy = a - k.value * e;
        if (std::abs(vx) + std::abs(vy) < 1e-12 * (1.0 + std::abs(k.value))) {
          vx = c - k.value * g;
          vy = -(b - k.value * f);
        }
        if (std::abs(vx) + std::abs(vy) < 1e-12 * (1.0 + std::abs(k.value))) vx = 1.0;  // a sphere: any
        const double norm = w * (e * vx * vx + 2.0 * f * vx * vy + g * vy * vy);
        k.xx = vx * vx / norm;
        k.xy = vx * vy / norm;
        k.yy = vy * vy / norm;
        return k;
      },
      design.family());
}

}  // namespace

ShapeLimits::ShapeLimits(const DesignLimits& limits, const DesignShape& start,
                         std::span<const HeightBounds> bounds) {
  const auto add = [&](Kind kind, double value, std::string text) {
    limits_.push_back({kind, value, std::move(text), {}});
  };
  if (limits.max_height_mm) {
    add(Kind::height, *limits.max_height_mm, fmt::format("max_height_mm = {}", *limits.max_height_mm));
  }
  if (limits.max_slope_deg) {
    add(Kind::slope, std::tan(radians(*limits.max_slope_deg)),
        fmt::format("max_slope_deg = {}", *limits.max_slope_deg));
  }
  if (limits.min_radius_mm) {
    add(Kind::radius, *limits.min_radius_mm, fmt::format("min_radius_mm = {}", *limits.min_radius_mm));
  }
  for (const KeepOut& zone : limits.keep_out) limits_.push_back(keep_out(zone, start));
  if (bounds.empty()) return;
  Limit between{Kind::keep_out, 0.0, "the bounds on the heights", {}};
  for (const HeightBounds& b : bounds) {
    if (std::isfinite(b.low_mm)) between.walls.push_back({{b.x_mm, b.y_mm}, b.low_mm, false});
    if (std::isfinite(b.high_mm)) between.walls.push_back({{b.x_mm, b.y_mm}, b.high_mm, true});
  }
  limits_.push_back(std::move(between));
}

ShapeLimits::Limit ShapeLimits::keep_out(const KeepOut& zone, const DesignShape& start) const {
  Limit limit{Kind::keep_out, zone.clearance_mm, zone.name, {}};
  const std::vector<ZoneColumn> columns = zone_columns(zone, start.aperture(), start.is_revolution());
  double above = 0.0;  // of the zone's middle, over the whole of it
  for (const ZoneColumn& c : columns) above += start.at(c.x_mm, c.y_mm).z_mm - 0.5 * (c.low_mm + c.high_mm);
  for (const ZoneColumn& c : columns) {
    limit.walls.push_back({{c.x_mm, c.y_mm}, above > 0.0 ? c.high_mm : c.low_mm, above <= 0.0});
  }
  return limit;
}

std::vector<const ShapeLimits::Limit*> ShapeLimits::all() const {
  std::vector<const Limit*> out;
  for (const Limit& l : limits_) out.push_back(&l);
  return out;
}

double ShapeLimits::cost(const DesignShape& shape, ResidualRows* rows) const {
  return cost(shape, all(), kCoarsePlaces, rows);
}

double ShapeLimits::cost(const DesignShape& shape, std::span<const Limit* const> limits, int per_interval,
                         ResidualRows* rows) const {
  double cost = 0.0;
  const auto hinge = [&](double excess, const auto& fill) {
    if (!(excess > 0.0)) return;
    cost += excess * excess;
    if (rows == nullptr) return;
    Row row(shape);
    fill(row);
    row.add_to(*rows, excess);
  };
  const std::vector<Place> look = places(shape, limits, per_interval);
  for (const Limit* limit : limits) {
    if (limit->kind == Kind::height) {  // both ways from the middle of lowest and highest
      const auto ends = std::minmax_element(look.begin(), look.end(), [&](const Place& p, const Place& q) {
        return shape.at(p.x, p.y).z_mm < shape.at(q.x, q.y).z_mm;
      });
      const auto low = ends.first, high = ends.second;  // clang 14 captures no structured bindings
      const double middle = 0.5 * (shape.at(low->x, low->y).z_mm + shape.at(high->x, high->y).z_mm);
      for (const Place& p : look) {
        const double off = shape.at(p.x, p.y).z_mm - middle,
                     sign = (off > 0.0 ? 1.0 : -1.0) / kHeightMargin_mm;
        hinge(sign * off - 0.5 * limit->value / kHeightMargin_mm + kInside, [&](Row& row) {
          row.add(p.x, p.y, sign, 0.0, 0.0);
          row.add(low->x, low->y, -0.5 * sign, 0.0, 0.0);
          row.add(high->x, high->y, -0.5 * sign, 0.0, 0.0);
        });
      }
    }
    if (limit->kind == Kind::slope) {
      // In units of the angle's tangent, which grows without end: the margin grows with its square.
      const double per = 1.0 / (kSlopeMargin * (1.0 + limit->value * limit->value));
      for (const Place& p : look) {
        const SurfacePoint s = shape.at(p.x, p.y);
        const double steep = std::hypot(s.dzdx, s.dzdy);
        hinge(per * (steep - limit->value) + 1.0,
              [&](Row& row) { row.add(p.x, p.y, 0.0, per * s.dzdx / steep, per * s.dzdy / steep); });
      }
    }
    if (limit->kind == Kind::radius) {
      const double per = limit->value / kCurvatureMargin;
      for (const Place& p : look) {
        const Curvature k = curvature_at(shape, p.x, p.y);
        const double sign = k.value >= 0.0 ? per : -per;
        hinge(sign * k.value - 1.0 / kCurvatureMargin + 1.0,
              [&](Row& row) { row.add_second(p.x, p.y, sign * k.xx, sign * k.xy, sign * k.yy); });
      }
    }
    for (const Wall& w : limit->walls) {
      const double per = (w.below ? 1.0 : -1.0) / kHeightMargin_mm;
      hinge(per * (shape.at(w.place.x, w.place.y).z_mm - w.z_mm) + kInside,
            [&](Row& row) { row.add(w.place.x, w.place.y, per, 0.0, 0.0); });
    }
  }
  return cost;
}

std::vector<ShapeLimits::Place> ShapeLimits::places(const DesignShape& shape,
                                                    std::span<const Limit* const> limits, int per_interval) {
  // Walls have places of their own.
  const bool look = std::ranges::any_of(limits, [](const Limit* l) { return l->kind != Kind::keep_out; });
  return look ? places_of<Place>(shape, per_interval) : std::vector<Place>();
}

bool ShapeLimits::held(const DesignShape& shape) const { return held(shape, all()); }

bool ShapeLimits::held(const DesignShape& shape, std::span<const Limit* const> limits) const {
  const std::vector<Place> look = places(shape, limits, kFinePlaces);
  for (const Limit* limit : limits) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    const std::span<const Place> looked_at = limit->kind == Kind::keep_out ? std::span<const Place>() : look;
    for (const Place& p : looked_at) {
      const SurfacePoint s = shape.at(p.x, p.y);
      low = std::min(low, s.z_mm);
      high = std::max(high, s.z_mm);
      if (limit->kind == Kind::slope && std::hypot(s.dzdx, s.dzdy) > limit->value) return false;
      if (limit->kind == Kind::radius && std::abs(curvature_at(shape, p.x, p.y).value) * limit->value > 1.0) {
        return false;
      }
    }
    if (limit->kind == Kind::height && high - low > limit->value) return false;
    for (const Wall& w : limit->walls) {
      const double z = shape.at(w.place.x, w.place.y).z_mm;
      if (w.below ? z > w.z_mm : z < w.z_mm) return false;
    }
  }
  return true;
}

namespace {

/// Parameters that no limit reaches stay where they are.
Eigen::VectorXd own_squares(const Eigen::VectorXd& diagonal) {
  return diagonal.array() + 1e-2 * diagonal.mean() + 1e-300;
}

Eigen::VectorXd damped(const NormalEquations& e, double lambda) { return damped_step(e, lambda); }
Eigen::VectorXd damped(const SparseEquations& e, double lambda) {
  SparseSymmetric metric(e.gradient.size(), e.gradient.size());
  metric.setIdentity();
  metric.diagonal() = own_squares(e.hessian.diagonal());
  return damped_step(e, metric, lambda);
}

void make_empty(NormalEquations& e, Eigen::Index n) { e.hessian = Eigen::MatrixXd::Zero(n, n); }
void make_empty(SparseEquations& e, Eigen::Index n) { e.hessian.resize(n, n); }

/// Gauss-Newton on `cost(shape, rows)` alone, from a shape until nothing is left of it or no step helps.
template <class Equations, class Cost>
DesignShape minimised(DesignShape now, const Cost& cost) {
  const auto equations_at = [&](const DesignShape& s) {
    Equations e;
    const auto n = static_cast<Eigen::Index>(s.parameter_count());
    e.gradient = Eigen::VectorXd::Zero(n);
    make_empty(e, n);
    ResidualRows rows;
    e.cost = cost(s, &rows);
    rows.add_to(e);
    return e;
  };
  Equations equations = equations_at(now);
  double lambda = 1e-3;
  for (int step = 0; step < kMaxSteps && equations.cost > 1e-12 && lambda < 1e8; ++step) {
    const Eigen::VectorXd move = damped(equations, lambda);
    if (!move.allFinite()) {
      lambda *= 10.0;
      continue;
    }
    const DesignShape trial = now.with(now.parameters() + move);
    Equations next = equations_at(trial);
    if (next.cost < equations.cost) {
      now = trial;
      equations = std::move(next);
      lambda = std::max(1e-9, 0.3 * lambda);
    } else {
      lambda *= 10.0;
    }
  }
  return now;
}

/// Parameters from which a dense factorisation takes longer than a sparse one.
constexpr std::size_t kManyParameters = 400;

}  // namespace

std::optional<DesignShape> ShapeLimits::solve(const DesignShape& shape,
                                              std::span<const Limit* const> limits) const {
  const auto excess = [&](const DesignShape& s, ResidualRows* rows) {
    return cost(s, limits, kFinePlaces, rows);
  };
  const DesignShape now = shape.parameter_count() > kManyParameters
                              ? minimised<SparseEquations>(shape, excess)
                              : minimised<NormalEquations>(shape, excess);
  if (held(now, limits)) return now;
  return std::nullopt;
}

std::optional<DesignShape> ShapeLimits::held_nearby(const DesignShape& shape) const {
  return held(shape) ? shape : solve(shape, all());
}

DesignShape ShapeLimits::nearest(const DesignShape& shape) const {
  if (const auto found = held_nearby(shape)) return *found;
  for (const Limit& a : limits_) {
    const Limit* one = &a;
    if (!solve(shape, {&one, 1})) {
      throw InputError(
          fmt::format("design.limits: {} contradicts the reflector's aperture and knots: no mirror "
                      "over it holds the limit",
                      a.text),
          ErrorCause::contradiction);
    }
  }
  for (std::size_t i = 0; i < limits_.size(); ++i) {
    for (std::size_t k = i + 1; k < limits_.size(); ++k) {
      const std::array<const Limit*, 2> pair{&limits_[i], &limits_[k]};
      if (!solve(shape, pair)) {
        throw InputError(
            fmt::format(
                "design.limits: {} and {} contradict each other: no mirror of this aperture holds both",
                pair[0]->text, pair[1]->text),
            ErrorCause::contradiction);
      }
    }
  }
  std::string names;
  for (const Limit& l : limits_) names += (names.empty() ? "" : ", ") + l.text;
  throw InputError(
      fmt::format("design.limits: {} leave no mirror of this aperture, though any two of them do", names),
      ErrorCause::contradiction);
}

}  // namespace lucerna
