// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/lens/other_light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "lucerna/core/io/error.h"
#include "lucerna/core/parallel/parallel.h"
#include "lucerna/design/lens/free_face.h"
#include "lucerna/design/lens/lens_blocks.h"
#include "lucerna/design/problem/target_rectangle.h"
#include "lucerna/random.h"

namespace lucerna {

namespace {

/// How near to its face a ray leaves by it, mm.
constexpr double kOnFace_mm = 1e-6;
constexpr std::size_t kLightParts = 16;
/// Of the target's rectangle, and the copies of a ray that are spread over it.
constexpr double kBlur = 1.0 / 30.0;
constexpr int kCopies = 16;

/// What one ray becomes: copies about it, whose directions are spread by `blur` (radians).
class Blur {
 public:
  explicit Blur(double blur) {
    for (int i = 0; i < kCopies; ++i) {
      // A Gaussian in equal shares, on a golden spiral.
      const double r = blur * std::sqrt(-2.0 * std::log(1.0 - (i + 0.5) / kCopies));
      const double turn = std::numbers::pi * (3.0 - std::sqrt(5.0)) * i;
      offset_.push_back({r * std::cos(turn), r * std::sin(turn)});
    }
  }

  /// Adds the copies, turned as a whole by `turn`, with their share of `flux`.
  void deposit(const Ray& ray, double turn, double flux, const TentBins& bins, Eigen::VectorXd& sums) const {
    const Frame about_ray = Frame::from_z(ray.direction);
    const double c = std::cos(turn), s = std::sin(turn);
    TentDeposit to;
    for (const auto& [u, v] : offset_) {
      const Vec3 beside = about_ray.vector({c * u - s * v, s * u + c * v, 1.0});
      bins.deposit(ray.origin_mm, Direction::from(beside).vec(), to);
      for (std::size_t k = 0; k < static_cast<std::size_t>(to.n); ++k)
        sums[static_cast<Eigen::Index>(to.bin[k])] += flux / kCopies * to.weight[k];
    }
  }

 private:
  std::vector<std::array<double, 2>> offset_;
};

/// Sums rays that leave by other ways than straight through.
class OtherTally {
 public:
  OtherTally(const DesignShape& face, const Frame& design_from_world, const TentBins& bins, const Blur& blur,
             std::uint64_t part)
      : flux(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(bins.size()))),
        face_(face),
        design_from_world_(design_from_world),
        bins_(bins),
        blur_(blur),
        turns_(1, part) {}
  void emitted(double share) { all += share; }
  void absorbed(double) {}
  void lost(double) {}
  void left(const Ray& ray, double share, int surfaces) {
    const Ray in_design = design_from_world_.ray(ray);
    if (surfaces == 2 && is_on_face(in_design.origin_mm)) return;
    blur_.deposit(in_design, 2.0 * std::numbers::pi * turns_.uniform(), share, bins_, flux);
  }

  Eigen::VectorXd flux;
  double all = 0.0;

 private:
  bool is_on_face(const Vec3& p) const {
    return face_.aperture().contains(p.x, p.y) && std::abs(face_.at(p.x, p.y).z_mm - p.z) < kOnFace_mm;
  }

  const DesignShape& face_;
  const Frame& design_from_world_;
  const TentBins& bins_;
  const Blur& blur_;
  Rng turns_;
};

/// In radians: of a plane, about as it is seen from the lens.
double blur_of(const LensProblem& problem) {
  const TargetRectangle r = target_rectangle(problem.target);
  const double size = std::sqrt(r.width() * r.height());
  if (!r.is_plane) return kBlur * size;
  const Vec3 middle{0.5 * (r.u_min + r.u_max), 0.5 * (r.v_min + r.v_max), 0.0};
  return kBlur * size / length(r.world_from_rectangle.point(middle) - problem.world_from_lens.origin_mm());
}

/// A start may cut what is below its face.
bool is_closed(const Solid& lens) {
  try {
    check(lens);
  } catch (const InputError&) {
    return false;
  }
  return true;
}

}  // namespace

Eigen::VectorXd other_light(const LensProblem& problem, const ShapedLens& shaped, const TentBins& bins,
                            std::uint64_t rays, std::uint64_t seed) {
  const Project project = with_lens(problem, shaped);
  if (!is_closed(project.scene.solids.front()))
    return Eigen::VectorXd::Zero(static_cast<Eigen::Index>(bins.size()));
  const LensBlocks lens(project.scene, LensSurface::exact, seed ^ 0x4F54484552ull);
  const Frame design_from_world = (problem.world_from_lens * lens_from_design()).inverse();
  const Blur blur(blur_of(problem));
  std::vector<OtherTally> parts;
  for (std::uint64_t part = 0; part < kLightParts; ++part)
    parts.emplace_back(shaped.face.value(), design_from_world, bins, blur, part);
  const std::uint64_t each = std::max<std::uint64_t>(1, rays / kBlockRays / kLightParts);
  parallel_blocks(kLightParts, 1, [&](std::size_t part, std::size_t) {
    RayBlock block;
    for (std::uint64_t b = 0; b < each; ++b) lens.follow(part * each + b, block, parts[part]);
  });
  Eigen::VectorXd out = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(bins.size()));
  double all = 0.0;
  for (const OtherTally& part : parts) {
    out += part.flux;
    all += part.all;
  }
  return out / all;
}

}  // namespace lucerna
