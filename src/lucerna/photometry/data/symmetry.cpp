// SPDX-License-Identifier: Apache-2.0
#include "lucerna/photometry/data/symmetry.h"

#include <algorithm>
#include <cmath>

#include "lucerna/core/io/error.h"
#include "lucerna/photometric_metrics.h"

namespace lucerna {

namespace {

constexpr double kSameAngle_deg = 1e-6;

/// For each plane the plane at `about - C`; empty if one is missing.
std::vector<std::size_t> mirror_images(const IntensityDistribution& d, double about_deg) {
  std::vector<std::size_t> images;
  for (const double c : d.c_deg) {
    const std::ptrdiff_t image = plane_index(d, about_deg - c);
    if (image < 0) return {};
    images.push_back(static_cast<std::size_t>(image));
  }
  return images;
}

bool planes_equal(const IntensityDistribution& d, std::size_t a, std::size_t b, double tolerance) {
  for (std::size_t g = 0; g < d.gamma_deg.size(); ++g) {
    if (std::abs(d.at(a, g) - d.at(b, g)) > tolerance) return false;
  }
  return true;
}

bool mirrored(const IntensityDistribution& d, double about_deg, double tolerance) {
  const auto images = mirror_images(d, about_deg);
  if (images.empty()) return false;
  for (std::size_t c = 0; c < images.size(); ++c) {
    if (!planes_equal(d, c, images[c], tolerance)) return false;
  }
  return true;
}

/// Each plane replaced by the mean of itself and its mirror image.
void average_mirror(IntensityDistribution& d, double about_deg) {
  const auto images = mirror_images(d, about_deg);
  if (images.empty()) {
    throw InputError(fmt::format("C planes do not mirror onto each other about C {}", 0.5 * about_deg));
  }
  const IntensityDistribution before = d;
  for (std::size_t c = 0; c < images.size(); ++c) {
    for (std::size_t g = 0; g < d.gamma_deg.size(); ++g) {
      d.at(c, g) = 0.5 * (before.at(c, g) + before.at(images[c], g));
    }
  }
}

}  // namespace

std::ptrdiff_t plane_index(const IntensityDistribution& d, double c_deg) {
  double c = std::fmod(c_deg, 360.0);
  if (c < 0.0) c += 360.0;
  if (360.0 - c <= kSameAngle_deg) c = 0.0;
  const auto at = std::lower_bound(d.c_deg.begin(), d.c_deg.end(), c - kSameAngle_deg);
  return at != d.c_deg.end() && *at <= c + kSameAngle_deg ? at - d.c_deg.begin() : -1;
}

Symmetry find_symmetry(const IntensityDistribution& d, double tolerance) {
  bool rotational = true;
  for (std::size_t c = 1; c < d.c_deg.size() && rotational; ++c)
    rotational = planes_equal(d, 0, c, tolerance);
  if (rotational) return Symmetry::rotational;
  // A mirror plane must itself be stored.
  const bool across = plane_index(d, 180.0) >= 0 && mirrored(d, 360.0, tolerance);
  const bool along = plane_index(d, 90.0) >= 0 && plane_index(d, 270.0) >= 0 && mirrored(d, 180.0, tolerance);
  if (across && along) return Symmetry::both_planes;
  if (across) return Symmetry::plane_c0_c180;
  return along ? Symmetry::plane_c90_c270 : Symmetry::none;
}

IntensityDistribution turned(const IntensityDistribution& d, double c_origin_deg) {
  std::vector<double> planes = d.c_deg;
  double origin = std::fmod(c_origin_deg, 360.0);
  if (origin < 0.0) origin += 360.0;
  if (d.c_deg.size() > 1 && plane_index(d, origin) < 0) {
    planes.insert(std::upper_bound(planes.begin(), planes.end(), origin), origin);
  }
  std::vector<std::pair<double, double>> turned_planes;  // new C, old C
  for (const double c : planes) {
    double t = d.c_deg.size() == 1 ? 0.0 : c - origin;
    if (t < -kSameAngle_deg) t += 360.0;
    if (t <= kSameAngle_deg || 360.0 - t <= kSameAngle_deg) t = 0.0;
    turned_planes.emplace_back(t, c);
  }
  std::sort(turned_planes.begin(), turned_planes.end());
  IntensityDistribution result;
  result.gamma_deg = d.gamma_deg;
  result.unit = d.unit;
  for (const auto& [t, c] : turned_planes) {
    result.c_deg.push_back(t);
    const std::ptrdiff_t from = plane_index(d, c);
    for (std::size_t g = 0; g < d.gamma_deg.size(); ++g) {
      result.cd.push_back(from >= 0 ? d.at(static_cast<std::size_t>(from), g)
                                    : intensity_at(d, c, d.gamma_deg[g]));
    }
  }
  return result;
}

IntensityDistribution symmetrised(const IntensityDistribution& d, Symmetry symmetry) {
  IntensityDistribution result = d;
  if (symmetry == Symmetry::rotational) {
    const std::vector<double> means = ring_means(d);
    for (std::size_t i = 0; i < result.cd.size(); ++i) result.cd[i] = means[i % means.size()];
  }
  if (symmetry == Symmetry::plane_c0_c180 || symmetry == Symmetry::both_planes) average_mirror(result, 360.0);
  if (symmetry == Symmetry::plane_c90_c270 || symmetry == Symmetry::both_planes)
    average_mirror(result, 180.0);
  return result;
}

}  // namespace lucerna
