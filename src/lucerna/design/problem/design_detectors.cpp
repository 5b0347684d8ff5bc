// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/problem/design_detectors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "lucerna/design/evaluation/window.h"
#include "lucerna/project/schema/project_tables.h"

namespace lucerna {

void check_detector_names(TomlReader& root, std::string_view shape) {
  for (TomlReader& detector : root.tables("detector")) {
    const std::string name = detector.text("name").value_or("");
    const bool is_plane = detector.word("kind").value_or("") == "plane";
    if (name == shape || name == "history" || name == "tolerances" || (name == kTargetPlane && !is_plane)) {
      detector.fail("name", fmt::format("found '{}', which a design's own files are named by; expected "
                                        "another name",
                                        name));
    }
  }
}

namespace {

/// A detector of the target's name is what the result is compared with.
void check_same_plane(const PlaneTarget& target, const PlaneGrid& found) {
  const Frame &a = target.world_from_plane, &b = found.world_from_plane;
  const double size_mm = std::hypot(target.size_x_mm, target.size_y_mm);
  const bool same = length(a.origin_mm() - b.origin_mm()) < 1e-6 * size_mm &&
                    length(a.ex() - b.ex()) + length(a.ey() - b.ey()) < 1e-6 &&
                    std::abs(target.size_x_mm - found.size_x_mm) < 1e-6 * size_mm &&
                    std::abs(target.size_y_mm - found.size_y_mm) < 1e-6 * size_mm;
  if (!same) {
    throw InputError(
        fmt::format("detector '{}': found another plane than that of [target]; expected its position_mm, "
                    "normal, turn_deg and size_mm, or another name",
                    kTargetPlane),
        ErrorCause::contradiction);
  }
}

}  // namespace

void add_design_detectors(Project& project, const DesignTarget& target) {
  Scene& scene = project.scene;
  if (scene.far_fields.empty()) {
    scene.far_fields.emplace_back();
    scene.far_fields.back().name = "far";
  }
  if (toml_tables(project)["detector"].as_array() == nullptr)
    toml_tables(project).insert_or_assign("detector", toml::array{});
  toml::array& tables = *toml_tables(project)["detector"].as_array();
  const auto is_far = [](const toml::node& n) {
    const auto* t = n.as_table();
    return t != nullptr && (*t)["kind"].value_or(std::string()) == "far-field";
  };
  if (std::none_of(tables.begin(), tables.end(), is_far)) {
    const FarFieldDetector& far = scene.far_fields.front();
    tables.push_back(toml::table{{"name", far.name},
                                 {"kind", "far-field"},
                                 {"c_step_deg", far.c_step_deg},
                                 {"gamma_step_deg", far.gamma_step_deg}});
  }
  const auto is_target = [](const PlaneDetector& p) { return p.name == kTargetPlane; };
  if (!target.plane) return;
  const PlaneTarget& plane = *target.plane;
  if (const auto given = std::ranges::find_if(scene.planes, is_target); given != scene.planes.end()) {
    check_same_plane(plane, given->grid);
    return;
  }
  const auto point = [](const Vec3& p) { return toml::array{p.x, p.y, p.z}; };
  const int cells = WindowOptions().count;
  const auto n = static_cast<std::size_t>(cells);
  scene.planes.push_back({kTargetPlane, {plane.world_from_plane, plane.size_x_mm, plane.size_y_mm, n, n}});
  tables.push_back(toml::table{{"name", kTargetPlane},
                               {"kind", "plane"},
                               {"position_mm", point(plane.world_from_plane.origin_mm())},
                               {"normal", point(plane.world_from_plane.ez())},
                               {"turn_deg", plane.turn_deg},
                               {"size_mm", toml::array{plane.size_x_mm, plane.size_y_mm}},
                               {"cells", toml::array{cells, cells}}});
}

}  // namespace lucerna
