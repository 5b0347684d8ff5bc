// SPDX-License-Identifier: Apache-2.0
#include "lucerna/results/folders/trace_origin.h"

#include <cmath>
#include <sstream>

#include "lucerna/core/io/file.h"
#include "lucerna/core/io/sha256.h"
#include "lucerna/project/schema/project_tables.h"
#include "lucerna/version.h"

namespace lucerna {

namespace {

/// Puts the hash of its bytes in place of every file's name.
void hash_files(toml::table& table) {
  for (auto&& [key, node] : table) {
    if (auto* inner = node.as_table()) hash_files(*inner);
    if (auto* array = node.as_array()) {
      for (auto&& item : *array) {
        if (auto* inner = item.as_table()) hash_files(*inner);
      }
    }
    if (key.str() == "file" && node.is_string()) {
      auto& value = node.as_string()->get();
      value = sha256_of_file(value);
    }
  }
}

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
  hash_files(table);
  std::ostringstream text;
  text << table;
  origin.scene_id = sha256_of_text(text.str());
  origin.program_version = version();
  origin.project = project_text(project);
  set_luminous_size(project.scene, origin);
  return origin;
}

}  // namespace lucerna
