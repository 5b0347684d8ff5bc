// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string_view>

#include "lucerna/rayset/ray_set.h"
#include "lucerna/source/nfl.h"
#include "lucerna/source/ray_source.h"

namespace lucerna {

/// A ray set compressed to a density of rays: any number of rays can be drawn, and the density of each is
/// known. Whatever the method, a model is immutable and thread safe, and the same file gives the same rays to
/// the bit.
class SourceModel : public RaySource {
 public:
  /// "clusters" or "adaptive".
  virtual std::string_view method() const = 0;
  /// Supports that rays start on.
  virtual std::size_t layers() const = 0;
  /// Constant pieces of density that are stored.
  virtual std::size_t leaves() const = 0;
  /// Rays that the model was made from; 0 = not known.
  virtual std::uint64_t training_rays() const = 0;
  /// Spectra that the ray file had beside its rays.
  virtual std::span<const SpectralTable> spectra() const { return {}; }

  /// Density of starts, 1/mm^2 on the surface; 0 off it. Starts that have no area (single points, lines) are
  /// not in it. Throws InputError when no start has an area (rays on one point or line).
  virtual double pdf_area(const Vec3& point_mm) const = 0;
  /// Density of directions at a start, 1/sr. Exists for every model.
  virtual double pdf_solid_angle(const Vec3& point_mm, const Direction& direction) const = 0;
  /// Density of rays, 1/(mm^2 sr) projected: pdf_area * pdf_solid_angle / |cosine to the surface's normal|;
  /// infinite at grazing directions that the model emits. Throws as pdf_area.
  virtual double pdf_etendue(const Ray& ray) const = 0;

  /// What the file holds.
  virtual NflFile to_nfl() const = 0;
};

/// Reads a model file of any version and method. Throws InputError, one line that names the file, the place
/// and what is wrong, on anything that is not a whole, undamaged model.
std::unique_ptr<SourceModel> load_source_model(const std::filesystem::path& path);

/// Writes `model`; returns the bytes of the file.
std::uint64_t save_source_model(const std::filesystem::path& path, const SourceModel& model);

/// Does the file begin as a model file does? False for files that are missing or too short; reads 8 bytes.
bool is_source_model(const std::filesystem::path& path);

}  // namespace lucerna
