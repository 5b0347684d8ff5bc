// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/lens/lens_limits.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "lucerna/design/lens/lens_curves.h"
#include "lucerna/geometry.h"

namespace lucerna {

namespace {

/// What a limit is kept by, mm and sines.
constexpr double kLengthMargin = 0.02, kDraftMargin = 0.01;
/// Points of a piece.
constexpr int kFitPoints = 4, kCheckPoints = 40;
/// A limit that is met exactly is held, whatever rounding makes of it.
constexpr double kRounding = 1e-9;

/// A point of the curve with its derivatives by the parameters; without these the rows are empty.
struct OutlineSample {
  OutlinePoint at{};
  double nr = 0.0, nz = 0.0;
  std::size_t face = 0;
  Eigen::RowVectorXd by_r, by_z, by_nz;
};

bool share_corner(const LensForm& form, std::size_t a, std::size_t b) {
  const OutlineRun &p = form.faces[a].run, &q = form.faces[b].run;
  for (const std::size_t i : {p.from, p.to}) {
    for (const std::size_t k : {q.from, q.to}) {
      if (corner_number(form, i) == corner_number(form, k)) return true;
    }
  }
  return false;
}

std::vector<OutlineSample> samples_of(const LensShape& shape, int points, bool derivatives) {
  const LensForm& form = shape.form();
  const auto n = static_cast<Eigen::Index>(shape.parameter_count());
  const Eigen::MatrixXd jacobian = derivatives ? number_jacobian(shape) : Eigen::MatrixXd();
  std::vector<OutlineSample> out;
  Eigen::Index first = 0;
  for (std::size_t f = 0; f < form.faces.size(); ++f) {
    const LensFace& face = form.faces[f];
    for (const OutlinePiece<double>& c : run_curve(shape.corners(), face.run)) {
      for (int k = 0; k <= points; ++k) {
        const double u = static_cast<double>(k) / points;
        const CurvePoint p = curve_point(c, u);
        const double speed = std::hypot(p.first[0], p.first[1]);
        OutlineSample s{p.at, p.first[1] / speed, -p.first[0] / speed, f, {}, {}, {}};
        if (derivatives) {
          s.by_r = s.by_z = s.by_nz = Eigen::RowVectorXd::Zero(n);
          const PieceBasis basis = piece_basis(u);
          for (int i = 0; face.is_free && i < 4; ++i) {
            const auto b = static_cast<std::size_t>(i);
            const Eigen::Index of_r = first + 2 * Eigen::Index{i};
            const auto r = jacobian.row(of_r), z = jacobian.row(of_r + 1);
            s.by_r += basis.at[b] * r;
            s.by_z += basis.at[b] * z;
            s.by_nz -= basis.first[b] * s.nr / speed * (s.nr * r + s.nz * z);
          }
        }
        out.push_back(std::move(s));
      }
      if (face.is_free) first += kPieceNumbers;
    }
  }
  return out;
}

/// Collects hinges.
class Hinges {
 public:
  explicit Hinges(ResidualRows& rows) : rows_(rows) {}

  /// `over`: by how much a limit is exceeded; `slope`: its derivative. What no parameter changes costs
  /// nothing.
  void add(double over, double margin, const Eigen::RowVectorXd& slope) {
    const double residual = over / margin + 1.0;
    if (!(residual > 0.0) || slope.isZero(0.0)) return;
    cost += residual * residual;
    rows_.begin(residual);
    for (Eigen::Index i = 0; i < slope.size(); ++i) {
      if (slope[i] != 0.0) rows_.add(static_cast<int>(i), slope[i] / margin);
    }
  }

  double cost = 0.0;

 private:
  ResidualRows& rows_;
};

const OutlineSample& outermost(const std::vector<OutlineSample>& all, std::size_t axis, double sign) {
  return *std::max_element(all.begin(), all.end(), [&](const OutlineSample& a, const OutlineSample& b) {
    return sign * a.at[axis] < sign * b.at[axis];
  });
}

/// Calls `visit(a, b, distance)` for each point and the nearest of the faces that its own does not meet, and
/// for the two points on the axis.
template <class Visit>
void for_thickness(const LensForm& form, const std::vector<OutlineSample>& all, const Visit& visit) {
  const OutlineSample* low = nullptr;
  const OutlineSample* high = nullptr;
  for (const OutlineSample& a : all) {
    if (a.at[0] < 1e-9) {
      if (low == nullptr || a.at[1] < low->at[1]) low = &a;
      if (high == nullptr || a.at[1] > high->at[1]) high = &a;
    }
    const OutlineSample* nearest = nullptr;
    double least = std::numeric_limits<double>::infinity();
    for (const OutlineSample& b : all) {
      if (b.face <= a.face || share_corner(form, a.face, b.face)) continue;
      // Through the medium, not through the air of a pocket.
      const double dr = b.at[0] - a.at[0], dz = b.at[1] - a.at[1];
      if (dr * a.nr + dz * a.nz >= 0.0) continue;
      const double d = std::hypot(dr, dz);
      if (d < least) {
        least = d;
        nearest = &b;
      }
    }
    if (nearest != nullptr && least > 0.0) visit(a, *nearest, least);
  }
  if (low != nullptr && high->at[1] > low->at[1]) visit(*low, *high, high->at[1] - low->at[1]);
}

}  // namespace

std::vector<double> draft_signs(const LensShape& shape) {
  std::vector<double> sum(shape.form().faces.size(), 0.0);
  for (const OutlineSample& s : samples_of(shape, kFitPoints, false)) sum[s.face] += s.nz;
  for (double& x : sum) x = x < 0.0 ? -1.0 : 1.0;
  return sum;
}

double lens_limits_cost(const LensLimits& limits, const LensShape& shape, const std::vector<double>& signs,
                        ResidualRows& rows) {
  if (!limits.any()) return 0.0;
  const auto all = samples_of(shape, kFitPoints, true);
  Hinges hinges(rows);
  if (limits.max_height_mm) {
    // All that is too high, not the highest alone: its neighbours would take its place.
    const OutlineSample& low = outermost(all, 1, -1.0);
    for (const OutlineSample& s : all)
      hinges.add(s.at[1] - low.at[1] - *limits.max_height_mm, kLengthMargin, s.by_z - low.by_z);
  }
  if (limits.max_diameter_mm) {
    for (const OutlineSample& s : all)
      hinges.add(2.0 * s.at[0] - *limits.max_diameter_mm, kLengthMargin, 2.0 * s.by_r);
  }
  if (limits.min_thickness_mm) {
    for_thickness(shape.form(), all, [&](const OutlineSample& a, const OutlineSample& b, double d) {
      const Eigen::RowVectorXd slope =
          (b.at[0] - a.at[0]) / d * (b.by_r - a.by_r) + (b.at[1] - a.at[1]) / d * (b.by_z - a.by_z);
      hinges.add(*limits.min_thickness_mm - d, kLengthMargin, -slope);
    });
  }
  if (limits.min_draft_deg) {
    const double least = std::sin(radians(*limits.min_draft_deg));
    for (const OutlineSample& s : all) {
      if (!shape.form().faces[s.face].is_free) continue;
      hinges.add(least - signs[s.face] * s.nz, kDraftMargin, -signs[s.face] * s.by_nz);
    }
  }
  return hinges.cost;
}

LimitCheck at_most(const char* limit, double allowed, double found) {
  return {limit, allowed, {found, 0.0}, found <= allowed * (1.0 + kRounding)};
}

LimitCheck at_least(const char* limit, double allowed, double found) {
  return {limit, allowed, {found, 0.0}, found >= allowed * (1.0 - kRounding)};
}

std::vector<LimitCheck> check_lens_limits(const LensLimits& limits, const LensShape& shape,
                                          const std::vector<double>& signs) {
  std::vector<LimitCheck> out;
  if (!limits.any()) return out;
  const auto all = samples_of(shape, kCheckPoints, false);
  if (limits.max_diameter_mm)
    out.push_back(at_most("max_diameter_mm", *limits.max_diameter_mm, 2.0 * outermost(all, 0, 1.0).at[0]));
  if (limits.max_height_mm) {
    out.push_back(at_most("max_height_mm", *limits.max_height_mm,
                          outermost(all, 1, 1.0).at[1] - outermost(all, 1, -1.0).at[1]));
  }
  if (limits.min_thickness_mm) {
    double least = std::numeric_limits<double>::infinity();
    for_thickness(shape.form(), all,
                  [&](const OutlineSample&, const OutlineSample&, double d) { least = std::min(least, d); });
    out.push_back(at_least("min_thickness_mm", *limits.min_thickness_mm, least));
  }
  if (limits.min_draft_deg) {
    double least = 1.0;
    for (const OutlineSample& s : all) {
      if (shape.form().faces[s.face].is_free) least = std::min(least, signs[s.face] * s.nz);
    }
    out.push_back(
        at_least("min_draft_deg", *limits.min_draft_deg, degrees(std::asin(std::clamp(least, -1.0, 1.0)))));
  }
  return out;
}

}  // namespace lucerna
