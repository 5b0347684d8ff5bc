// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lucerna/design.h"
#include "lucerna/intensity_comparison.h"
#include "lucerna/photometric_file.h"
#include "lucerna/progress.h"
#include "lucerna/ray_comparison.h"

#pragma GCC visibility push(default)
namespace lucerna {

/// How `compare` compares two files.
struct FileComparisonOptions {
  /// Rays drawn from a source model, and the seed of their random numbers.
  std::uint64_t rays = 4'000'000, seed = 1;
  /// Sides of the square cells on the focus plane, um, above 0.
  std::vector<double> cells_um{12.0, 24.0, 48.0, 96.0, 240.0};
  /// How IES and EULUMDAT files are read; with `strict` ray files that raise a warning are refused too.
  PhotometricReadOptions photometric;
  /// Folder for pictures, which is there: luminance images of rays, polar.svg of light distributions. Empty:
  /// no pictures.
  std::filesystem::path pictures;
};

/// Étendue in mm2 sr of the brightest 50, 90 and 99 % of the flux.
struct EtendueShares {
  /// Of that share.
  double p50_mm2sr = 0.0, p90_mm2sr = 0.0, p99_mm2sr = 0.0;
};

/// A PNG of reference, test and their difference side by side.
struct LuminancePicture {
  /// Its name in FileComparisonOptions::pictures.
  std::string file;
  /// Half of what it shows across.
  double half_width_mm = 0.0;
  /// Luminance over flux that is white, and the difference that is full red or blue, 1/(mm2 sr).
  double white_per_mm2sr = 0.0, full_colour_per_mm2sr = 0.0;
};

/// How far two ray files or source models are apart.
struct RayFileComparison {
  /// How many rays were compared.
  std::uint64_t reference_rays = 0, test_rays = 0;
  /// The five views.
  RaySetComparison views;
  /// One for each of FileComparisonOptions::cells_um.
  std::vector<PlaneDifference> focus_plane;
  /// Near, middle and far field.
  FieldCorrelations fields;
  /// Of a model from its density, of rays by way of a model of them.
  EtendueShares reference_etendue, test_etendue;
  /// If they were asked for, and there is light to see.
  std::vector<LuminancePicture> pictures;
};

/// How far two light distributions are apart.
struct LightFileComparison {
  /// Relative RMS, Bergen fit, Wasserstein distance and more.
  DistributionComparison distributions;
  /// As a design is evaluated: the first file as target, by shape.
  DesignError boxes;
};

/// What `compare` found; one of the two is there.
struct FileComparison {
  /// Of ray files and source models.
  std::optional<RayFileComparison> rays;
  /// Of photometric files and folders of traces.
  std::optional<LightFileComparison> light;
  /// What was odd about ray files.
  std::vector<std::string> warnings;
};

/// Compares two files: each a ray file of any format or a source model (.nfl), or each an IES or EULUMDAT
/// file or the folder of a trace (its first far field, with errors). What they are is told by their content.
/// Cost: seconds, and about a second per million rays. Uses all threads; other calls may run at the same
/// time. Throws InputError where a file cannot be read or the two are of different kinds.
[[nodiscard]] FileComparison compare(const std::filesystem::path& reference,
                                     const std::filesystem::path& test,
                                     const FileComparisonOptions& options = {},
                                     Progress& progress = no_progress());

}  // namespace lucerna
#pragma GCC visibility pop
