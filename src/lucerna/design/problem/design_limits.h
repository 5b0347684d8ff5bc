// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lucerna/design/shape/design_shape.h"
#include "lucerna/mesh.h"
#include "lucerna/project/schema/toml_reader.h"
#include "lucerna/scene.h"

namespace lucerna {

/// Room that the mirror must leave to something else.
struct KeepOut {
  /// What messages call it: "keep_out[0]", "body housing".
  std::string name;
  /// In the mirror's frame.
  Mesh mesh;
  /// Least distance between the two, mm; >= 0.
  double clearance_mm = 0.0;
};

/// No more than this intensity farther than an angle from the mirror's axis, averaged over cells of about 5
/// by 30 degrees.
struct GlareLimit {
  double beyond_deg = 0.0;
  /// Per unit of the sources' flux: cd/lm, or 1/sr for radiometric sources.
  double max_per_flux = 0.0;
  /// As it was given, for messages.
  std::string text;
};

/// What a design must not do: [design.limits] of a project. Lengths in mm, in the mirror's own frame.
struct DesignLimits {
  std::optional<double> max_diameter_mm, min_opening_mm, min_hole_diameter_mm;
  /// Maximum minus minimum height of the mirror along its axis.
  std::optional<double> max_height_mm;
  /// Largest angle between the surface's normal and the mirror's axis: draft for the tool.
  std::optional<double> max_slope_deg;
  /// Smallest radius of curvature anywhere, hollow or round: the tool's own radius.
  std::optional<double> min_radius_mm;
  std::vector<KeepOut> keep_out;
  std::optional<GlareLimit> glare;
  /// Share of the sources' flux that leaves the luminaire.
  std::optional<double> min_efficiency;
  ShapeSymmetry symmetry = ShapeSymmetry::none;

  bool any_on_form() const {
    return max_diameter_mm || min_opening_mm || min_hole_diameter_mm || max_height_mm || max_slope_deg ||
           min_radius_mm || !keep_out.empty();
  }
};

/// Reads `symmetry` of [design.limits]: of a shape whose frame must have its x axis along that of the
/// directions, or across it. Throws InputError where it does not, or where a free form is to be rotational.
ShapeSymmetry read_symmetry(TomlReader& reader, bool revolution, const Frame& world_from_shape);

/// Reads [design.limits]: max_diameter_mm, min_opening_mm, min_hole_diameter_mm, max_height_mm,
/// max_slope_deg, min_radius_mm, symmetry, min_efficiency; [[design.limits.keep_out]] with kind = "box"
/// (min_mm, max_mm), "cylinder" (from_mm, to_mm, radius_mm) or "mesh" (file), in the luminaire frame, and
/// clearance_mm; body_clearance_mm, which keeps clear of all `bodies`; [design.limits.glare] with beyond_deg
/// and max_cd or max_cd_per_klm. Throws InputError with file, line, key, found and expected, also where two
/// limits, or a limit and the aperture, leave no mirror: naming both.
DesignLimits read_limits(TomlReader reader, const Aperture& aperture, bool revolution,
                         const Frame& world_from_mirror, const std::vector<Body>& bodies, double source_flux);

}  // namespace lucerna
