// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/initial/transport_guess.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "lucerna/core/parallel/parallel.h"
#include "lucerna/design/evaluation/point_source.h"
#include "lucerna/design/evaluation/tent_bins.h"
#include "lucerna/design/initial/transport.h"
#include "lucerna/trace/tally/flux_quanta.h"

namespace lucerna {

namespace {

/// Meridians and places along each where the mirror is put together; fewer where only its edges are asked
/// for.
constexpr int kMeridians = 96, kPlaces = 160, kPlacesForEdges = 64;
/// Beyond the rim the surface is followed so far, over its radius: the spline's edge needs to be held.
constexpr double kBeyondRim = 1.04;
/// A mirror that turns back before so much of its radius is none.
constexpr double kMinRimReach = 0.85;
/// A lens's face that lets less of the light within out is none. Light of a flat source need not come to the
/// rim.
constexpr double kMinFaceShare = 0.7;
/// Directions with less than this share of the densest cell's light are beside the light.
constexpr double kBesideLight = 0.01;
/// A face is followed so much farther from the axis than a point source's light, over its angle: light of a
/// wide source goes there too. Beyond, it levels off within a share of the rim's radius, so that it stays
/// within its limits: from kSteepest at most. Its places there have a share of a lit one's weight.
constexpr double kBeyondLight = 1.3, kLevelWithin = 0.2, kUnlitWeight = 0.1, kSteepest = 1.0;
/// Beyond the light it is followed as long as it rises by no more than so much of the rim's radius from knot
/// to knot: no spline follows a wall.
constexpr double kRiseOfKnots = 0.5;
/// Weight of a third difference of coefficients against that of a point: nothing where there are points.
constexpr double kSmoothness = 1e-4;

/// The outline of the aperture at an azimuth, in mm from the axis.
double rim_mm(const Aperture& a, double cos_phi, double sin_phi) {
  if (a.shape() == ApertureShape::circle) return a.half_x_mm();
  return std::min(a.half_x_mm() / std::max(std::abs(cos_phi), 1e-9),
                  a.half_y_mm() / std::max(std::abs(sin_phi), 1e-9));
}

Vec3 meridian(int m) {
  const double phi = 2.0 * std::numbers::pi * m / kMeridians;
  return {std::cos(phi), std::sin(phi), 0.0};
}

/// Angles from -z, by azimuth, between which the source's light hits the mirror.
struct Catch {
  std::array<double, kMeridians> hole{}, rim{};

  bool has(const Direction& d) const {
    const double phi = std::atan2(d.y(), d.x());
    const double m = (phi < 0.0 ? phi + 2.0 * std::numbers::pi : phi) * kMeridians / (2.0 * std::numbers::pi);
    const auto i = static_cast<std::size_t>(m) % kMeridians, j = (i + 1) % kMeridians;
    const double f = m - std::floor(m), theta = std::acos(std::clamp(-d.z(), -1.0, 1.0));
    return theta >= (1.0 - f) * hole[i] + f * hole[j] && theta < (1.0 - f) * rim[i] + f * rim[j];
  }
  double widest() const { return *std::max_element(rim.begin(), rim.end()); }
};

/// The widest angle from -z of cells that are not beside the light, by azimuth, and half of a cell more at
/// least (told in the stereographic plane).
std::array<double, kMeridians> widest_light(const std::vector<DirectedFlux>& cells, double half_cell) {
  double densest = 0.0;
  for (const DirectedFlux& c : cells) densest = std::max(densest, c.flux);
  std::array<double, kMeridians> out{};
  for (const DirectedFlux& c : cells) {
    if (c.flux < kBesideLight * densest) continue;
    const Vec3 d = c.direction.vec();
    const double theta = std::acos(std::clamp(-d.z, -1.0, 1.0)) + half_cell;
    const double across = std::hypot(d.x, d.y);
    // A cell stands for the meridians that it covers.
    const double covers = across > half_cell ? half_cell / across : std::numbers::pi;
    for (int m = 0; m < kMeridians; ++m) {
      const Vec3 along = meridian(m);
      const double beside =
          std::abs(std::atan2(along.x * d.y - along.y * d.x, along.x * d.x + along.y * d.y));
      double& widest = out[static_cast<std::size_t>(m)];
      if (beside <= covers) widest = std::max(widest, theta);
    }
  }
  return out;
}

/// That of the paraboloid about the source.
Catch first_catch(const Aperture& a, double distance) {
  Catch c;
  for (int m = 0; m < kMeridians; ++m) {
    const Vec3 along = meridian(m);
    c.rim[static_cast<std::size_t>(m)] = 2.0 * std::atan(rim_mm(a, along.x, along.y) / (2.0 * distance));
    c.hole[static_cast<std::size_t>(m)] = 2.0 * std::atan(a.hole_radius_mm() / (2.0 * distance));
  }
  return c;
}

/// The light that is caught, in cells of the stereographic plane about -z; and the bins that the rest lights.
struct SplitLight {
  std::vector<DirectedFlux> caught;
  /// Half of a cell of the stereographic plane.
  double half_cell = 0.0;
  double caught_share = 0.0;
  Eigen::VectorXd direct;
};

SplitLight split(const TransportProblem& problem, const Vec3& source, const Catch& edges) {
  const double reach = std::tan(0.5 * std::min(edges.widest(), 0.95 * std::numbers::pi)) * (1.0 + 1e-9);
  const int across = problem.source_cells;
  const double cell = 2.0 * reach / across;
  struct Cell {
    Vec3 direction;
    double flux = 0.0;
  };
  std::vector<Cell> cells(static_cast<std::size_t>(across) * static_cast<std::size_t>(across));
  SplitLight out;
  out.direct = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(problem.bins.size()));
  double all = 0.0;
  TentDeposit deposit;
  const std::uint64_t blocks = std::min(problem.ray_count, problem.rays->size()) / kBlockRays;
  for (std::uint64_t b = 0; b < blocks; ++b) {
    const DesignRays::Block& block = problem.rays->block(b);
    for (std::size_t i = 0; i < kBlockRays; ++i) {
      const Direction d = Direction::from_unit({block.kx[i], block.ky[i], block.kz[i]});
      const double w = block.weight[i];
      all += w;
      if (!edges.has(d)) {
        if (!problem.direct_light || d.z() < 0.0) continue;  // down is the hole's light, or none
        problem.bins.deposit(source, d, deposit);
        for (int k = 0; k < deposit.n; ++k) {
          out.direct[deposit.bin[static_cast<std::size_t>(k)]] +=
              w * deposit.weight[static_cast<std::size_t>(k)];
        }
        continue;
      }
      const double x = d.x() / (1.0 - d.z()), y = d.y() / (1.0 - d.z());
      const int u = std::clamp(static_cast<int>((x + reach) / cell), 0, across - 1);
      const int v = std::clamp(static_cast<int>((y + reach) / cell), 0, across - 1);
      Cell& c = cells[static_cast<std::size_t>(v * across + u)];
      c.direction += w * d.vec();
      c.flux += w;
    }
  }
  for (const Cell& c : cells) {
    if (!(c.flux > 0.0)) continue;
    out.caught.push_back({Direction::from(c.direction), c.flux});
    out.caught_share += c.flux / all;
  }
  out.direct /= all;
  out.half_cell = 0.5 * cell;
  return out;
}

/// What is left for the mirror to make: bins with prescribed light, and that light.
struct PrescribedLight {
  std::vector<Eigen::Index> bins;
  std::vector<DirectedFlux> flux;
};

PrescribedLight prescribed_light(const TransportProblem& problem, const SplitLight& light,
                                 const Vec3& vertex) {
  const double total = problem.reflectance * light.caught_share + light.direct.sum();
  const Eigen::VectorXd flux = (total / problem.target.sum() * problem.target - light.direct).cwiseMax(0.0);
  const double max = flux.maxCoeff();
  PrescribedLight out;
  for (Eigen::Index i = 0; i < flux.size(); ++i) {
    if (!(flux[i] > 1e-6 * max)) continue;
    out.bins.push_back(i);
    out.flux.push_back({bin_direction(problem.bins, static_cast<std::size_t>(i), vertex), flux[i]});
  }
  return out;
}

/// The mirror along its meridians, from the axis outwards, and what it catches.
struct Outline {
  std::vector<SurfacePointWeight> points;
  Catch edges;
  /// How far its shortest meridian goes before it turns back, over the rim's radius.
  double reach = 1.0;
};

/// Takes a meridian that ends within the rim on to it, level but for the slope that it ended with (at most
/// kSteepest: where light meets the face at the limit of total reflection it ends like a wall).
void level_off(const Vec3& along, double rim, std::vector<SurfacePointWeight>& points) {
  if (points.size() < 2) return;
  const auto radius = [](const SurfacePointWeight& p) { return std::hypot(p.x_mm, p.y_mm); };
  const SurfacePointWeight before = points[points.size() - 2], last = points.back();
  const double from = radius(last), step = rim / kPlacesForEdges, within = kLevelWithin * rim;
  const double slope = std::clamp((last.z_mm - before.z_mm) / (from - radius(before)), -kSteepest, kSteepest);
  for (double r = from + step; r < kBeyondRim * rim + step; r += step) {
    const double z = last.z_mm + slope * within * (1.0 - std::exp((from - r) / within));
    points.push_back({r * along.x, r * along.y, z, kUnlitWeight * r * step});
  }
}

/// As far as a lens's face has light, by azimuth, and how steep it may be beyond.
struct LitFace {
  std::array<double, kMeridians> widest{};
  double steepest = 1.0;
};

/// `face`: null for a mirror.
Outline outline(const PointTransport& transport, const Aperture& aperture, const Vec3& source,
                double distance, int places, const LitFace* face) {
  const double scale = distance / transport.radius(Direction::from({0.0, 0.0, -1.0}));
  struct Meridian {
    std::vector<SurfacePointWeight> points;
    double hole = 0.0, rim = 0.0, reach = 0.0;
  };
  const auto follow = [&](std::size_t m, std::size_t) {
    const Vec3 along = meridian(static_cast<int>(m));
    const double rim = rim_mm(aperture, along.x, along.y), hole = aperture.hole_radius_mm();
    Meridian out;
    double r_before = 0.0, theta_before = 0.0;
    double max_angle = 0.9 * std::numbers::pi;
    const double lit = face != nullptr ? face->widest[m] : max_angle;
    if (face != nullptr) max_angle = std::min(max_angle, kBeyondLight * lit);
    for (int k = 0; k < places; ++k) {
      const double theta = max_angle * (k + 0.5) / places;
      const Direction d = Direction::from_unit(std::sin(theta) * along + Vec3{0.0, 0.0, -std::cos(theta)});
      const Vec3 at = source + (scale * transport.radius(d)) * d.vec();
      const double r = std::hypot(at.x, at.y);
      if (r <= r_before) break;  // it turns back inwards
      const bool beyond = face != nullptr && theta > lit && !out.points.empty();
      if (beyond && std::abs(at.z - out.points.back().z_mm) > face->steepest * (r - r_before)) break;
      const double per = (theta - theta_before) / (r - r_before);
      if (r_before < hole && r >= hole) out.hole = theta_before + (hole - r_before) * per;
      if (r_before < rim && r >= rim) out.rim = theta_before + (rim - r_before) * per;
      out.points.push_back({at.x, at.y, at.z, r * (r - r_before)});
      r_before = r;
      theta_before = theta;
      if (r > kBeyondRim * rim) break;
    }
    out.reach = r_before / rim;
    if (out.rim == 0.0) out.rim = theta_before;  // what it would catch up to where it ends
    if (face != nullptr) level_off(along, rim, out.points);
    return out;
  };
  const auto meridians = parallel_map_blocks<Meridian>(kMeridians, 1, follow);
  Outline out;
  for (std::size_t m = 0; m < kMeridians; ++m) {
    out.points.insert(out.points.end(), meridians[m].points.begin(), meridians[m].points.end());
    out.edges.hole[m] = meridians[m].hole;
    out.edges.rim[m] = meridians[m].rim;
    out.reach = std::min(out.reach, meridians[m].reach);
  }
  return out;
}

/// Angle between neighbouring bins in the middle, as seen from a place; bins of a plane are told in mm.
double bin_width_rad(const TentBins& bins, const Vec3& from_mm) {
  const auto count = static_cast<std::size_t>(bins.count()), middle = (count / 2) * count + count / 2;
  const Direction here = bin_direction(bins, middle, from_mm);
  const double u = angle_between(here, bin_direction(bins, middle + 1, from_mm));
  return std::sqrt(u * angle_between(here, bin_direction(bins, middle + count, from_mm)));
}

}  // namespace

DesignShape fitted_to_points(const DesignShape& family, const std::vector<SurfacePointWeight>& points) {
  const auto& spline = std::get<BsplineShape>(family.family());
  const KnotRow &row_x = spline.row_x(), &row_y = spline.row_y();
  const int nx = row_x.coefficients(), ny = row_y.coefficients();
  const auto n = static_cast<Eigen::Index>(family.parameter_count());
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
  double weight = 0.0;
  const auto add = [&](const auto& index, const auto& value, double height_mm, double w) {
    for (std::size_t i = 0; i < index.size(); ++i) {
      right[index[i]] += w * value[i] * height_mm;
      for (std::size_t j = 0; j < index.size(); ++j) {
        if (index[j] <= index[i]) entries.emplace_back(index[i], index[j], w * value[i] * value[j]);
      }
    }
  };
  for (const SurfacePointWeight& p : points) {
    const double x = std::clamp(p.x_mm, row_x.start_mm, row_x.end_mm());
    const double y = std::clamp(p.y_mm, row_y.start_mm, row_y.end_mm());
    if (x != p.x_mm || y != p.y_mm) continue;
    const KnotRow::Place px = row_x.place(x), py = row_y.place(y);
    const CubicBasis bx = cubic_basis(px.t), by = cubic_basis(py.t);
    std::array<int, 16> index{};
    std::array<double, 16> value{};
    for (std::size_t k = 0; k < 16; ++k) {
      const int c = (py.first + static_cast<int>(k / 4)) * nx + px.first + static_cast<int>(k % 4);
      index[k] = family.parameter_of()[static_cast<std::size_t>(c)];
      value[k] = by[k / 4] * bx[k % 4];
    }
    add(index, value, p.z_mm - 0.25 / family.focal_mm() * (x * x + y * y), p.weight);
    weight += p.weight;
  }
  constexpr std::array<double, 4> kThird{-1.0, 3.0, -3.0, 1.0};
  const double w = kSmoothness * weight / static_cast<double>(n);
  const auto third = [&](int first, int stride) {
    std::array<int, 4> index{};
    for (std::size_t k = 0; k < 4; ++k) {
      index[k] = family.parameter_of()[static_cast<std::size_t>(first + static_cast<int>(k) * stride)];
    }
    add(index, kThird, 0.0, w);
  };
  for (int j = 0; j < ny; ++j) {
    for (int i = 0; i < nx; ++i) {
      if (i + 3 < nx) third(j * nx + i, 1);
      if (j + 3 < ny) third(j * nx + i, nx);
    }
  }
  Eigen::SparseMatrix<double> a(n, n);
  a.setFromTriplets(entries.begin(), entries.end());
  Eigen::SparseMatrix<double> little(n, n);
  little.setIdentity();
  a += (1e-9 * weight / static_cast<double>(n)) * little;
  const Eigen::SimplicialLLT<Eigen::SparseMatrix<double>, Eigen::Lower> solver(a);
  return family.with(solver.solve(right));
}

std::optional<DesignShape> transport_guess(const TransportProblem& problem, const DesignShape& family,
                                           const TransportChoice& choice) {
  const Vec3 source = point_source(*problem.rays, std::uint64_t{1} << 14).at_mm;
  const Aperture& aperture = family.aperture();
  const std::optional<MediumView>& medium = problem.rays->medium();
  const Vec3 vertex{0.0, 0.0, source.z - choice.vertex_distance_mm};
  Catch edges = first_catch(aperture, choice.vertex_distance_mm);
  std::optional<Outline> mirror;
  Eigen::VectorXf potentials = Eigen::VectorXf::Zero(problem.target.size());
  for (int round = 0; round < problem.rounds; ++round) {
    const SplitLight light = split(problem, source, edges);
    const PrescribedLight to = prescribed_light(problem, light, vertex);
    if (light.caught.size() < 16 || to.bins.size() < 4) return std::nullopt;
    const double source_cell = 2.0 * edges.widest() / problem.source_cells;
    const double bin = bin_width_rad(problem.bins, vertex);
    // What the aperture catches changes from round to round, and the transport little.
    const Eigen::VectorXf guess = potentials(to.bins);
    const PointTransport transport(light.caught, to.flux, choice.sign, 0.5 * source_cell * bin,
                                   round > 0 ? &guess : nullptr, medium ? 1.0 / medium->index : 1.0);
    potentials(to.bins) = transport.potentials();
    std::optional<LitFace> face;
    if (medium) {
      face = {widest_light(light.caught, light.half_cell), 0.5 * kRiseOfKnots * family.intervals_x()};
    }
    const bool last = round + 1 == problem.rounds;
    mirror = outline(transport, aperture, source, choice.vertex_distance_mm, last ? kPlaces : kPlacesForEdges,
                     face ? &*face : nullptr);
    edges = mirror->edges;
  }
  const bool too_small =
      medium ? split(problem, source, edges).caught_share < kMinFaceShare : mirror->reach < kMinRimReach;
  if (too_small) return std::nullopt;
  return fitted_to_points(family, mirror->points);
}

}  // namespace lucerna
