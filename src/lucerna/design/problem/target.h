// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lucerna/design/evaluation/tent_bins.h"
#include "lucerna/design/problem/target_mode.h"
#include "lucerna/design/problem/zone_cells.h"
#include "lucerna/flux_unit.h"
#include "lucerna/geometry.h"
#include "lucerna/intensity.h"
#include "lucerna/photometry/formats/illuminance_map.h"
#include "lucerna/project.h"
#include "lucerna/project/schema/toml_reader.h"

namespace lucerna {

/// Illuminance prescribed on a rectangle of a plane.
struct PlaneTarget {
  /// Of the rectangle's centre; the light is to fall on the side of its +z.
  Frame world_from_plane;
  /// What the frame was turned by about its normal, as the project said it.
  double turn_deg = 0.0;
  double size_x_mm = 0.0, size_y_mm = 0.0;
  /// In lx (W/m2 where the sources are radiometric); in absolute mode to the letter, else up to a factor.
  IlluminanceMap map;

  /// At a place of the plane in mm from its centre; 0 outside the rectangle.
  double at(double x_mm, double y_mm) const { return map.at(2.0 * x_mm / size_x_mm, 2.0 * y_mm / size_y_mm); }
  /// Flux onto the rectangle, lm (or W).
  double flux() const;
};

/// The prescribed light: [target] of a project.
struct DesignTarget {
  /// For a plane: that of the point luminaire at the mirror's place which would light it just so; a start for
  /// search, never what the result is evaluated by.
  IntensityDistribution distribution;
  TargetMode mode = TargetMode::shape;
  std::string file;
  std::optional<PlaneTarget> plane;
  /// Bounds on the light of zones; null: none.
  std::shared_ptr<const ZoneCells> zones;
  /// True where zones are all there is: no file; distribution or map are only a guide (zone_guide.h).
  bool zones_only = false;
};

/// Reads [target]: `file` (IES, EULUMDAT), or kind = "plane" with `position_mm`, `normal`, `turn_deg`
/// (as a plane detector has them), `size_mm` and a `file` of illuminance (CSV or PNG; `white_lx` is a PNG's
/// white in absolute mode), and `mode`. Also [[target.zone]] (target_zone.h), about `axis` where they are
/// given by h and v; with a zone that asks for light no file is needed. `unit` and `source_flux` are the
/// sources', `luminaire_mm` the mirror's place. The file is in the project's memory or becomes one of its
/// inputs. Throws InputError with file, line, key, found and expected.
DesignTarget read_target(TomlReader reader, FluxUnit unit, double source_flux, const Vec3& luminaire_mm,
                         Project& project);

/// The bins in which a target is compared, in the mirror's frame: 48 x 48 over the target's 99 % window (48
/// rings for `rings`), or over a plane target's rectangle.
TentBins target_bins(const DesignTarget& target, const Frame& world_from_mirror, bool rings);

/// The flux that the target puts into bins in the mirror's frame, as shares of `source_flux`. The target must
/// outlive the function.
std::function<Eigen::VectorXd(const TentBins&)> target_flux(const DesignTarget& target,
                                                            const Frame& world_from_mirror,
                                                            double source_flux);

}  // namespace lucerna
