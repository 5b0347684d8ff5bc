// SPDX-License-Identifier: Apache-2.0
#include "lucerna/rayset/statistics/surface_guess.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <functional>
#include <limits>
#include <tuple>
#include <vector>

#include "lucerna/random.h"
#include "lucerna/rayset/data/eigen_vec.h"

namespace lucerna {

namespace {

using Eigen::Matrix3d, Eigen::Vector3d;

constexpr std::size_t kSample = 4096;
/// Trials of each consensus search: with 30 % of the points on the face in question, four of them on it are
/// missed in 200 trials with probability 0.2; on a surface that holds 90 % of the starts, never.
constexpr std::uint64_t kTrials = 200;
constexpr std::size_t kMinOnFace = 8;  // points on a surface that make it one
constexpr double kSimplerBy = 0.03;

/// Some of the starts, and what is needed of them.
struct Starts {
  std::vector<Vector3d> points;
  std::vector<double> weights;
  double total = 0.0, tolerance = 0.0;
  Vector3d mean = Vector3d::Zero(), flux = Vector3d::Zero();
  Matrix3d axes = Matrix3d::Identity();  // columns: principal axes, widest last
  Vector3d spread = Vector3d::Zero();    // standard deviations along them

  template <class Distance>
  double share(const Distance& distance) const {
    double on = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (std::abs(distance(points[i])) <= tolerance) on += weights[i];
    }
    return on / total;
  }
};

Starts sample_starts(const RayBlock& rays) {
  Starts s;
  const std::size_t n = std::min(kSample, rays.size());
  Vector3d low = Vector3d::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (std::size_t j = 0; j < n; ++j) {
    // One ray of each of n equal ranges, at a random place in it: file order may be anything.
    const std::size_t first = rays.size() * j / n, next = rays.size() * (j + 1) / n;
    const auto i = first + static_cast<std::size_t>(Rng(1, j).uniform() * static_cast<double>(next - first));
    s.points.push_back(to_eigen(rays.origin_mm(i)));
    s.weights.push_back(static_cast<double>(rays.weight[i]));
    s.total += s.weights.back();
    low = low.cwiseMin(s.points.back());
    high = high.cwiseMax(s.points.back());
    s.flux += s.weights.back() * Vector3d(rays.kx[i], rays.ky[i], rays.kz[i]);
    s.mean += s.points.back();
  }
  if (n == 0) return s;
  if (!(s.total > 0.0)) s.weights.assign(n, 1.0), s.total = static_cast<double>(n);
  s.mean /= static_cast<double>(n);
  const double largest = std::max(low.cwiseAbs().maxCoeff(), high.cwiseAbs().maxCoeff());
  s.tolerance = std::max(1e-4 * (high - low).norm(),
                         4.0 * static_cast<double>(std::numeric_limits<float>::epsilon()) * largest);
  Matrix3d covariance = Matrix3d::Zero();
  for (const Vector3d& p : s.points) covariance += (p - s.mean) * (p - s.mean).transpose();
  const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(covariance / static_cast<double>(n));
  s.axes = solver.eigenvectors();
  s.spread = solver.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  return s;
}

struct Plane {
  Vector3d normal = Vector3d::UnitZ();
  double offset = 0.0;
  double share = 0.0;
  double distance(const Vector3d& p) const { return normal.dot(p) - offset; }
};

struct Sphere {
  Vector3d centre = Vector3d::Zero();
  double radius = 0.0;
  double share = 0.0;
  double distance(const Vector3d& p) const { return (p - centre).norm() - radius; }
};

std::vector<Vector3d> near_points(const Starts& s, const auto& shape) {
  std::vector<Vector3d> found;
  for (const Vector3d& p : s.points) {
    if (std::abs(shape.distance(p)) <= s.tolerance) found.push_back(p);
  }
  return found;
}

/// The best of kTrials shapes made from `needed` random points each, then of those refined on the points that
/// lie on it.
template <class Shape>
Shape consensus(const Starts& s, std::size_t needed,
                const std::function<std::optional<Shape>(const std::vector<Vector3d>&)>& fit) {
  Shape best;
  if (s.points.size() < needed) return best;
  const auto consider = [&](const std::vector<Vector3d>& points) {
    auto shape = fit(points);
    if (!shape) return false;
    shape->share = s.share([&](const Vector3d& p) { return shape->distance(p); });
    if (shape->share <= best.share) return false;
    best = *shape;
    return true;
  };
  for (std::uint64_t t = 0; t < kTrials; ++t) {
    Rng rng(2, t);
    std::vector<Vector3d> few;
    for (std::size_t k = 0; k < needed; ++k) {
      few.push_back(s.points[static_cast<std::size_t>(rng.uniform() * static_cast<double>(s.points.size()))]);
    }
    consider(few);
  }
  for (int round = 0; round < 5; ++round) {
    if (!consider(near_points(s, best))) break;
  }
  return best;
}

std::optional<Plane> fit_plane(const std::vector<Vector3d>& points) {
  if (points.size() < 3) return std::nullopt;
  Vector3d mean = Vector3d::Zero();
  for (const Vector3d& p : points) mean += p / static_cast<double>(points.size());
  Matrix3d m = Matrix3d::Zero();
  for (const Vector3d& p : points) m += (p - mean) * (p - mean).transpose();
  const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(m);
  if (!(solver.eigenvalues()[1] > 0.0)) return std::nullopt;
  const Vector3d normal = solver.eigenvectors().col(0);
  return Plane{normal, normal.dot(mean)};
}

/// Algebraic least squares: |p|^2 = 2 c p + (r^2 - c^2), about the mean; `dimensions` 2 leaves z alone (a
/// circle).
std::optional<Sphere> fit_round(const std::vector<Vector3d>& points, int dimensions) {
  if (points.size() < static_cast<std::size_t>(dimensions) + 1) return std::nullopt;
  Vector3d mean = Vector3d::Zero();
  for (const Vector3d& p : points) mean += p / static_cast<double>(points.size());
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(dimensions + 1, dimensions + 1);
  Eigen::VectorXd b = Eigen::VectorXd::Zero(dimensions + 1), row(dimensions + 1);
  for (const Vector3d& p : points) {
    const Eigen::VectorXd q = (p - mean).head(dimensions);
    row << 2.0 * q, 1.0;
    a += row * row.transpose();
    b += q.squaredNorm() * row;
  }
  const Eigen::FullPivLU<Eigen::MatrixXd> lu(a);
  if (!lu.isInvertible()) return std::nullopt;
  const Eigen::VectorXd x = lu.solve(b);
  const double square = x[dimensions] + x.head(dimensions).squaredNorm();
  if (!x.allFinite() || !(square > 0.0)) return std::nullopt;
  Sphere sphere;
  sphere.centre.head(dimensions) = mean.head(dimensions) + x.head(dimensions);
  sphere.radius = std::sqrt(square);
  return sphere;
}

Plane find_plane(const Starts& s) { return consensus<Plane>(s, 3, fit_plane); }

Frame frame_of(const Matrix3d& axes, const Vector3d& origin) {
  return {to_vec3(axes.col(0)), to_vec3(axes.col(1)), to_vec3(axes.col(2)), to_vec3(origin)};
}

/// Right-handed axes with z along `z`, x as near to the world's x (or y) as can be.
Matrix3d axes_about(const Vector3d& z, const Vector3d& x_hint) {
  Matrix3d m;
  m.col(2) = z.normalized();
  m.col(0) = (x_hint - x_hint.dot(m.col(2)) * m.col(2)).normalized();
  m.col(1) = m.col(2).cross(m.col(0));
  return m;
}

Matrix3d axes_about(const Vector3d& z) {
  return axes_about(z, std::abs(z.normalized().x()) < 0.9 ? Vector3d::UnitX() : Vector3d::UnitY());
}

/// The starts in a frame whose columns are `axes`.
Starts turned(const Starts& s, const Matrix3d& axes) {
  Starts t = s;
  for (Vector3d& p : t.points) p = axes.transpose() * p;
  return t;
}

/// Where the lowest and the highest face across axis `axis` are: the outermost places where 1 % of the starts
/// lie within the tolerance; without such places the outermost starts. So stray starts outside a body do not
/// enlarge it.
std::pair<double, double> faces(const Starts& s, int axis) {
  std::vector<double> x;
  for (const Vector3d& p : s.points) x.push_back(p[axis]);
  if (x.empty()) return {0.0, 0.0};
  std::ranges::sort(x);
  const std::size_t many = std::max(kMinOnFace, x.size() / 100);
  const auto outermost = [&](const std::vector<double>& sorted) {
    for (std::size_t i = 0; i + many <= sorted.size(); ++i) {
      if (std::abs(sorted[i + many - 1] - sorted[i]) <= s.tolerance) {
        return 0.5 * (sorted[i + many - 1] + sorted[i]);
      }
    }
    return sorted.front();
  };
  const double low = outermost(x);
  std::ranges::reverse(x);
  return {low, outermost(x)};
}

std::pair<Vector3d, Vector3d> extent(const Starts& s) {
  Vector3d low, high;
  for (int c = 0; c < 3; ++c) std::tie(low[c], high[c]) = faces(s, c);
  return {low, high};
}

SurfaceGuess guess_with(const Starts& s, const BoundingSurface& surface) {
  SurfaceGuess guess;
  guess.shape = StartShape::surface;
  guess.surface = surface;
  guess.tolerance_mm = s.tolerance;
  guess.share = s.share([&](const Vector3d& p) { return surface.outside_mm(to_vec3(p)); });
  return guess;
}

/// A circle across the z axis.
struct Circle : Sphere {
  double distance(const Vector3d& p) const {
    return std::hypot(p.x() - centre.x(), p.y() - centre.y()) - radius;
  }
};

Circle find_circle(const Starts& s) {
  return consensus<Circle>(s, 3, [](const std::vector<Vector3d>& points) -> std::optional<Circle> {
    const auto round = fit_round(points, 2);
    if (!round) return std::nullopt;
    return Circle{*round};
  });
}

/// One Gauss-Newton step for the tilt of a cylinder along z, on the points that lie within `tolerance` of it:
/// distance = |(x - cx - a z, y - cy - b z)| - r. Returns (a, b), and moves the circle.
Eigen::Vector2d tilt_step(const Starts& s, Circle& circle, double tolerance) {
  using Vector5 = Eigen::Matrix<double, 5, 1>;
  Eigen::Matrix<double, 5, 5> normal = Eigen::Matrix<double, 5, 5>::Identity() * 1e-12;
  Vector5 right = Vector5::Zero();
  for (const Vector3d& p : s.points) {
    const double distance = circle.distance(p);
    if (std::abs(distance) > tolerance) continue;
    const Eigen::Vector2d out = (p - circle.centre).head(2).normalized();
    Vector5 row;
    row << out, p.z() * out, 1.0;
    normal += row * row.transpose();
    right += distance * row;
  }
  const Vector5 x = normal.ldlt().solve(right);
  circle.centre.head(2) += x.head(2);
  circle.radius += x[4];
  return x.segment(2, 2);
}

/// Turns `axes` so that a cylinder roughly along their z becomes one along z, closing in on its wall.
Matrix3d straightened(const Starts& s, Matrix3d axes) {
  Starts about_mean = s;
  for (Vector3d& p : about_mean.points) p -= s.mean;
  Starts t = turned(about_mean, axes);
  t.tolerance = 0.02 * s.spread.norm();
  Circle circle = find_circle(t);
  for (double tolerance = 2.0 * t.tolerance; tolerance > s.tolerance; tolerance *= 0.6) {
    const Eigen::Vector2d tilt = tilt_step(t, circle, tolerance);
    if (!tilt.allFinite() || tilt.norm() > 0.5) return axes;
    axes = axes_about(axes * Vector3d(tilt.x(), tilt.y(), 1.0), axes.col(0));
    t = turned(about_mean, axes);
  }
  return axes;
}

/// A circular cylinder roughly along the z of `roughly`, closed at its farthest faces.
SurfaceGuess try_cylinder(const Starts& s, const Matrix3d& roughly) {
  SurfaceGuess best;
  for (const Matrix3d& axes : {roughly, straightened(s, roughly)}) {
    const Starts t = turned(s, axes);
    const Circle circle = find_circle(t);
    if (near_points(t, circle).size() < kMinOnFace) continue;
    const auto [low, high] = faces(t, 2);
    const Vector3d middle(circle.centre.x(), circle.centre.y(), 0.5 * (low + high));
    BoundingSurface surface = BoundingSurface::cylinder(circle.radius, high - low);
    surface.world_from_surface = frame_of(axes, axes * middle);
    const SurfaceGuess guess = guess_with(s, surface);
    if (guess.share > best.share) best = guess;
  }
  return best;
}

SurfaceGuess try_box(const Starts& s, const Matrix3d& axes) {
  const auto [low, high] = extent(turned(s, axes));
  BoundingSurface surface = BoundingSurface::box(to_vec3(high - low));
  surface.world_from_surface = frame_of(axes, axes * (0.5 * (low + high)));
  return guess_with(s, surface);
}

/// Axes along which a cylinder or box may lie: the world's, the principal ones, and those that the faces
/// found have.
std::vector<Matrix3d> candidate_axes(const Starts& s, const Plane& face) {
  std::vector<Matrix3d> all{Matrix3d::Identity()};
  Matrix3d principal = s.axes;
  if (principal.determinant() < 0.0) principal.col(0) *= -1.0;
  all.push_back(principal);
  Starts rest = s;
  rest.points.clear();
  rest.weights.clear();
  // Neither the face found nor the one opposite to it.
  const auto [low, high] = extent(turned(s, axes_about(face.normal)));
  for (std::size_t i = 0; i < s.points.size(); ++i) {
    const double z = face.normal.dot(s.points[i]);
    if (z - low.z() <= 2.0 * s.tolerance || high.z() - z <= 2.0 * s.tolerance) continue;
    rest.points.push_back(s.points[i]);
    rest.weights.push_back(s.weights[i]);
  }
  all.push_back(axes_about(face.normal));
  const Plane second = find_plane(rest);
  if (second.share > 0.0 && second.normal.cross(face.normal).norm() > 0.5)
    all.push_back(axes_about(face.normal, second.normal));
  return all;
}

/// For cylinders: each of the axes of `all` once as z.
std::vector<Matrix3d> as_z(const std::vector<Matrix3d>& all) {
  std::vector<Matrix3d> out;
  for (const Matrix3d& m : all) {
    for (int c = 0; c < 3; ++c) out.push_back(axes_about(m.col(c)));
  }
  return out;
}

template <class Guess>
SurfaceGuess best_of(const Starts& s, const std::vector<Matrix3d>& axes, const Guess& guess_on) {
  SurfaceGuess best;
  for (const Matrix3d& m : axes) {
    const SurfaceGuess guess = guess_on(s, m);
    // More than noise better, so that the world's axes win where others fit equally well.
    if (guess.share > best.share + 1e-9) best = guess;
  }
  return best;
}

}  // namespace

SurfaceGuess guess_surface(const RayBlock& rays, double min_share) {
  const Starts s = sample_starts(rays);
  SurfaceGuess none;
  if (s.points.empty()) return none;
  none.tolerance_mm = s.tolerance;
  none.point_mm = to_vec3(s.mean);
  const double point_tolerance =
      4.0 * static_cast<double>(std::numeric_limits<float>::epsilon()) * (1.0 + s.mean.norm());
  if (s.spread[2] <= point_tolerance || s.spread[1] <= 1e-6 * s.spread[2]) {
    none.shape = s.spread[2] <= point_tolerance ? StartShape::point : StartShape::line;
    none.line = Direction::from_unit(to_vec3(s.axes.col(2)));
    none.share = 1.0;
    return none;
  }
  const Plane plane = find_plane(s);
  std::vector<SurfaceGuess> guesses;
  {
    const Vector3d normal = plane.normal.dot(s.flux) < 0.0 ? Vector3d(-plane.normal) : plane.normal;
    const std::vector<Vector3d> on = near_points(s, plane);
    Vector3d middle = Vector3d::Zero();
    for (const Vector3d& p : on) middle += p / static_cast<double>(on.size());
    BoundingSurface surface = BoundingSurface::plane(0.0);
    surface.world_from_surface = frame_of(axes_about(normal), middle);
    guesses.push_back(guess_with(s, surface));
  }
  // A sphere of any radius holds what a plane holds: the simpler one goes first.
  const double enough = std::max(min_share, 1.0 - kSimplerBy);
  if (guesses.back().share >= enough) return guesses.back();
  const auto sphere =
      consensus<Sphere>(s, 4, [](const std::vector<Vector3d>& points) { return fit_round(points, 3); });
  if (near_points(s, sphere).size() >= kMinOnFace) {
    BoundingSurface surface = BoundingSurface::sphere(sphere.radius);
    surface.world_from_surface = frame_of(Matrix3d::Identity(), sphere.centre);
    guesses.push_back(guess_with(s, surface));
  }
  if (guesses.back().share >= enough) return guesses.back();
  const std::vector<Matrix3d> axes = candidate_axes(s, plane);
  guesses.push_back(best_of(s, as_z(axes), try_cylinder));
  guesses.push_back(best_of(s, axes, try_box));
  const double best = std::ranges::max(guesses, {}, &SurfaceGuess::share).share;
  if (best < min_share) return none;
  return *std::ranges::find_if(
      guesses, [&](const SurfaceGuess& g) { return g.share >= std::max(min_share, best - kSimplerBy); });
}

std::string describe(const SurfaceGuess& guess) {
  const auto at = [](const Vec3& p) { return fmt::format("({:.5g}, {:.5g}, {:.5g})", p.x, p.y, p.z); };
  const Frame& frame = guess.surface.world_from_surface;
  const std::string centre = at(frame.origin_mm());
  const std::string share = fmt::format("{:.1f} % of the flux starts on a ", 100.0 * guess.share);
  if (guess.shape == StartShape::point) return fmt::format("all rays start at {} mm", at(guess.point_mm));
  if (guess.shape == StartShape::line) {
    return fmt::format("all rays start on a line through {} mm along {}", at(guess.point_mm),
                       at(guess.line.vec()));
  }
  switch (guess.surface.kind) {
    case SurfaceKind::none:
      break;
    case SurfaceKind::plane:
      return fmt::format("{}plane through {} mm with normal {}", share, centre, at(frame.ez()));
    case SurfaceKind::sphere:
      return fmt::format("{}sphere of radius {:.5g} mm about {} mm", share, guess.surface.radius_mm, centre);
    case SurfaceKind::cylinder:
      return fmt::format("{}cylinder of radius {:.5g} mm and length {:.5g} mm about {} mm along {}", share,
                         guess.surface.radius_mm, 2.0 * guess.surface.half_size_mm.z, centre, at(frame.ez()));
    case SurfaceKind::box:
      return fmt::format("{}box of {:.5g} x {:.5g} x {:.5g} mm about {} mm", share,
                         2.0 * guess.surface.half_size_mm.x, 2.0 * guess.surface.half_size_mm.y,
                         2.0 * guess.surface.half_size_mm.z, centre);
  }
  return "the ray origins lie on no plane, sphere, cylinder or box";
}

}  // namespace lucerna
