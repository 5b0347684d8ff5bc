// SPDX-License-Identifier: Apache-2.0
#include "lucerna/results/folders/trace_origin.h"

#include <cmath>
#include <sstream>
#include <utility>

#include "lucerna/core/io/sha256.h"
#include "lucerna/project/schema/project_tables.h"
#include "lucerna/project/sections/project_content.h"
#include "lucerna/version.h"

namespace lucerna {

namespace {

void set_luminous_size(const Scene& scene, TraceOrigin& origin) {
  if (scene.reflectors.empty()) return;
  const PlacedReflector& placed = scene.reflectors.front();
  if (std::abs(placed.world_from_reflector.ez().z) < 0.999) return;
  const Aperture& aperture = placed.reflector.aperture;
  origin.luminous_length_mm = 2.0 * aperture.half_y_mm();
  origin.luminous_width_mm = aperture.shape() == ApertureShape::circle ? 0.0 : 2.0 * aperture.half_x_mm();
}

}  // namespace

TraceOrigin trace_origin(const Project& project) {
  TraceOrigin origin;
  toml::table table = toml_tables(project);
  table.erase("target");
  table.erase("design");
  std::ostringstream text;
  text << content_tables(std::move(table), project.memory);
  origin.scene_id = sha256_of_text(text.str());
  origin.program_version = version();
  origin.project = project_text(project);
  set_luminous_size(project.scene, origin);
  return origin;
}

}  // namespace lucerna
