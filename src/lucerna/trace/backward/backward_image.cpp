// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/backward/backward_image.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lucerna/core/math/units.h"
#include "lucerna/random.h"

namespace lucerna {

namespace {

/// Nearest place to a source, in radii of the ball that its light leaves, and to a mirror, in patches.
constexpr double kNearest = 1.5;

/// Of (u, v) in the unit square, in the plane's frame.
Vec3 place_in_cell(const PlaneGrid& grid, std::size_t cell, double u, double v) {
  const double width = grid.size_x_mm / static_cast<double>(grid.nx);
  const double height = grid.size_y_mm / static_cast<double>(grid.ny);
  return {grid.cell_x_mm(cell) + (u - 0.5) * width, grid.cell_y_mm(cell) + (v - 0.5) * height, 0.0};
}

double half_diagonal_mm(const PlaneGrid& grid) {
  return 0.5 * std::hypot(grid.size_x_mm / static_cast<double>(grid.nx),
                          grid.size_y_mm / static_cast<double>(grid.ny));
}

/// A disk point by its area.
Vec3 place_in_disk(double u, double v, double radius) {
  const double r = radius * std::sqrt(u), turn = 2.0 * std::numbers::pi * v;
  return {r * std::cos(turn), r * std::sin(turn), 0.0};
}

/// Lines of an observer through the places of a cell, in the plane's frame.
class View {
 public:
  struct Line {
    Direction direction;
    /// The density of what light of luminance 1 carries over that of the draw.
    double weight = 1.0;
    /// Light from further along the line does not count.
    double end_mm = BackwardScene::kNoEnd;
  };

  View(const LuminanceDetector& d, std::size_t cell) : d_(d) {
    if (d.distance_mm <= 0.0) return;
    const double pupil_mm2 = std::numbers::pi * d.pupil_radius_mm * d.pupil_radius_mm;
    weight_ = d.distance_mm * d.distance_mm * d.grid.cell_mm2() * pupil_mm2 / etendue_mm2sr(d, cell);
  }

  Line line(const Vec3& place, double u, double v) const {
    if (d_.distance_mm <= 0.0) {
      const Vec3 p = place_in_disk(u, v, std::sin(radians(d_.half_angle_deg)));
      return {Direction::from({p.x, p.y, std::sqrt(1.0 - p.x * p.x - p.y * p.y)})};
    }
    const Vec3 to = place_in_disk(u, v, d_.pupil_radius_mm) + Vec3{0.0, 0.0, d_.distance_mm} - place;
    const double r2 = dot(to, to);
    return {Direction::from(to), weight_ / (r2 * r2), std::sqrt(r2)};
  }

 private:
  const LuminanceDetector& d_;
  double weight_ = 1.0;
};

}  // namespace

std::string no_backward_image_reason(const Scene& scene) {
  const std::string reason = no_backward_reason(scene);
  return reason.empty() && !scene.glasses.empty() ? "there is a cover glass" : reason;
}

BackwardImage::BackwardImage(const Scene& scene, int max_bounces) : sampler_(scene, max_bounces) {
  const std::string reason = no_backward_image_reason(scene);
  if (!reason.empty()) throw InputError("light cannot be followed backward from a detector: " + reason);
}

bool BackwardImage::can_see(const PlaneGrid& grid) const {
  const Frame plane_from_world = grid.world_from_plane.inverse();
  const auto distance_mm = [&](const Vec3& place) {
    const Vec3 p = plane_from_world.point(place);
    const double dx = std::max(0.0, std::abs(p.x) - 0.5 * grid.size_x_mm);
    const double dy = std::max(0.0, std::abs(p.y) - 0.5 * grid.size_y_mm);
    return length(Vec3{dx, dy, p.z});
  };
  return sampler_.guide().further_than(kNearest, distance_mm) &&
         std::ranges::all_of(sampler_.disks(), [&](const LineDisks& disks) {
           return distance_mm(disks.centre_mm()) > kNearest * disks.radius_mm();
         });
}

double BackwardImage::by_mirrors(const PlaneGrid& grid, std::size_t cell, const CellGuide& guide,
                                 std::uint64_t samples, std::uint64_t seed) const {
  const Sequence sequence(SequenceKind::sobol, seed);
  const Vec3 lit = grid.world_from_plane.ez();
  BackwardScene::Scratch scratch;
  double sum = 0.0;
  for (std::uint64_t i = 0; i < samples; ++i) {
    const auto u = sequence.point<4>(i);
    const MirrorPlace place = guide.place(u[0], u[1]);
    const auto from = mirror_point(sampler_.scene(), place);
    if (!from) continue;
    const Vec3 to = grid.world_from_plane.point(place_in_cell(grid, cell, u[2], u[3])) - from->point_mm;
    const Direction out = Direction::from(to);
    const double cosine = -dot(lit, out.vec());
    if (cosine > 0.0)
      sum += cosine / dot(to, to) *
             sampler_.intensity_sample(place, *from, out, Exit::onward, {seed, i, 0}, scratch);
  }
  return sum / static_cast<double>(samples);
}

double BackwardImage::by_source(const PlaneGrid& grid, std::size_t cell, std::size_t source,
                                std::uint64_t samples, std::uint64_t seed) const {
  const Sequence sequence(SequenceKind::sobol, seed);
  const LineDisks& disks = sampler_.disks()[source];
  const BackwardScene& scene = sampler_.scene();
  const Vec3 lit = grid.world_from_plane.ez();
  BackwardScene::Scratch scratch;
  double sum = 0.0;
  for (std::uint64_t i = 0; i < samples; ++i) {
    const auto u = sequence.point<4>(i);
    const Vec3 place = grid.world_from_plane.point(place_in_cell(grid, cell, u[2], u[3]));
    const Vec3 from_centre = place - disks.centre_mm();
    const double near = disks.radius_mm() / length(from_centre);
    const Direction axis = Direction::from(from_centre);
    const LineDisks::Place passed = disks.place(u[0], u[1], axis, 1.0 / std::sqrt(1.0 - near * near));
    const Vec3 to = place - passed.point_mm;
    const Direction out = Direction::from(to);
    const double cosine = -dot(lit, out.vec());
    if (!(cosine > 0.0)) continue;
    const double luminance = scene.direct_luminance(scene.sources()[source], {passed.point_mm, out},
                                                    Exit::onward, {seed, i, 0}, scratch, length(to));
    sum += luminance * cosine * dot(axis.vec(), out.vec()) / dot(to, to) / passed.pdf_area;
  }
  return sum / static_cast<double>(samples);
}

std::vector<double> BackwardImage::illuminance(const PlaneGrid& grid, std::size_t cell, std::uint64_t samples,
                                               std::span<const std::uint64_t> seeds) const {
  const CellGuide guide = sampler_.guide().for_point(
      grid.world_from_plane.point(place_in_cell(grid, cell, 0.5, 0.5)), half_diagonal_mm(grid));
  std::vector<double> out;
  for (const std::uint64_t seed : seeds) {
    double sum = guide.empty() ? 0.0 : by_mirrors(grid, cell, guide, samples, seed);
    for (std::size_t s = 0; s < sampler_.disks().size(); ++s)
      sum += by_source(grid, cell, s, direct_samples(samples), source_stream(seed, s));
    out.push_back(kSquareMillimetresPerSquareMetre * sum);
  }
  return out;
}

std::vector<double> BackwardImage::luminance(const LuminanceDetector& detector, std::size_t cell,
                                             std::uint64_t samples,
                                             std::span<const std::uint64_t> seeds) const {
  const PlaneGrid& grid = detector.grid;
  const View view(detector, cell);
  std::vector<double> out;
  BackwardScene::Scratch scratch;
  for (const std::uint64_t seed : seeds) {
    const Sequence sequence(SequenceKind::sobol, seed);
    double sum = 0.0;
    for (std::uint64_t i = 0; i < samples; ++i) {
      const auto u = sequence.point<4>(i);
      const Vec3 place = place_in_cell(grid, cell, u[0], u[1]);
      const View::Line seen = view.line(place, u[2], u[3]);
      const Ray line{grid.world_from_plane.point(place), grid.world_from_plane.direction(seen.direction)};
      sum += seen.weight * sampler_.scene().leaving_luminance(line, {seed, i, 0}, scratch, seen.end_mm);
    }
    out.push_back(kSquareMillimetresPerSquareMetre * sum / static_cast<double>(samples));
  }
  return out;
}

}  // namespace lucerna
