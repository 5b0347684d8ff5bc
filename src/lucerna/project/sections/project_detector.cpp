// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <utility>

#include "lucerna/project/sections/project_parts.h"
#include "lucerna/ray_file.h"
#include "lucerna/trace/detectors/far_field_grid.h"

namespace lucerna::project_parts {

namespace {

/// What all detectors have: a name that can name files.
std::string read_name(TomlReader& reader, const std::string& kind) {
  std::string name = reader.text("name").value_or(kind);
  if (name.empty() || name.find_first_of("/\\") != std::string::npos || name[0] == '.')
    reader.fail("name", "names files: not empty, no slash, no leading dot");
  return name;
}

/// `size_mm = [x, y]` and `cells = [nx, ny]`.
void read_cells(TomlReader& reader, PlaneGrid& grid) {
  if (const auto size = reader.numbers("size_mm", 2)) {
    grid.size_x_mm = (*size)[0];
    grid.size_y_mm = (*size)[1];
  }
  if (const auto cells = reader.numbers("cells", 2)) {
    grid.nx = static_cast<std::size_t>((*cells)[0]);
    grid.ny = static_cast<std::size_t>((*cells)[1]);
  }
}

/// Told at the step that is wrong; of too many cells, at the one that is given.
void check_steps(TomlReader& reader, const FarFieldDetector& d) {
  FarFieldDetector planes = d;
  planes.gamma_step_deg = 180.0;
  at_key(reader, "c_step_deg", [&] { return FarFieldGrid(planes).size(); });
  at_key(reader, reader.has("gamma_step_deg") ? "gamma_step_deg" : "c_step_deg",
         [&] { return FarFieldGrid(d).size(); });
}

void read_far_field(TomlReader& reader, Scene& scene) {
  FarFieldDetector d;
  d.name = read_name(reader, "far-field");
  d.c_step_deg = reader.number("c_step_deg", d.c_step_deg);
  d.gamma_step_deg = reader.number("gamma_step_deg", d.gamma_step_deg);
  d.tent = reader.word("bins").value_or("hard") == "tent";
  check_steps(reader, d);
  scene.far_fields.push_back(std::move(d));
}

void read_plane(TomlReader& reader, Scene& scene) {
  PlaneDetector d;
  d.name = read_name(reader, "plane");
  const Vec3 position = reader.vector("position_mm").value_or(Vec3{});
  const Direction normal = reader.axis("normal").value_or(Direction());
  d.grid.world_from_plane = Frame::from_axis(normal, radians(reader.number("turn_deg", 0.0)), position);
  read_cells(reader, d.grid);
  at_key(reader, "cells", [&] { return check(d), 0; });
  scene.planes.push_back(std::move(d));
}

void read_luminance(TomlReader& reader, Scene& scene) {
  LuminanceDetector d;
  d.name = read_name(reader, "luminance");
  d.grid.size_x_mm = d.grid.size_y_mm = 200.0;
  const Vec3 position = reader.vector("position_mm").value_or(Vec3{});
  const auto given_up = reader.axis("up");
  const Vec3 up = given_up.value_or(Direction()).vec();
  const auto from_mm = reader.vector("from_mm");
  const auto from = reader.axis("from");
  if (from && from_mm) reader.fail("from_mm", "a view is from a direction (from) or from a point (from_mm)");
  if (!from && !from_mm)
    reader.missing("from", "where the observer is, a direction (from) or a point (from_mm)");
  const auto half_angle = reader.number("half_angle_deg"), pupil = reader.number("pupil_radius_mm");
  if (from_mm && half_angle) reader.fail("half_angle_deg", "belongs to a view from a direction");
  if (from && pupil) reader.fail("pupil_radius_mm", "belongs to a view from a point");
  Direction towards;
  if (from_mm) {
    const Vec3 line = *from_mm - position;
    d.distance_mm = length(line);
    if (!(d.distance_mm > 0.0)) reader.fail("from_mm", "the observer is at position_mm, where it looks");
    towards = Direction::from(line);
    d.pupil_radius_mm = pupil.value_or(0.02 * d.distance_mm);
  } else {
    towards = *from;
    d.half_angle_deg = half_angle.value_or(d.half_angle_deg);
  }
  if (given_up && length(cross(up, towards.vec())) < 1e-9)
    reader.fail("up", "is along the line of sight, expected a direction across it");
  d.grid.world_from_plane = facing_frame(towards, up, position);
  read_cells(reader, d.grid);
  at_key(reader, "kind", [&] { return check(d), 0; });
  scene.luminances.push_back(std::move(d));
}

void read_rays(TomlReader& reader, Scene& scene) {
  RayDetector d;
  d.name = read_name(reader, "rays");
  d.format = reader.word("format").value_or(d.format);
  scene.ray_detectors.push_back(std::move(d));
}

}  // namespace

std::string read_detector(TomlReader reader, Scene& scene) {
  const std::string kind = reader.required_word("kind");
  if (kind == "far-field") {
    read_far_field(reader, scene);
  } else if (kind == "plane") {
    read_plane(reader, scene);
  } else if (kind == "luminance") {
    read_luminance(reader, scene);
  } else {
    read_rays(reader, scene);
  }
  reader.finish();
  return read_name(reader, kind);
}

}  // namespace lucerna::project_parts
