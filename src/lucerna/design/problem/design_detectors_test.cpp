// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/problem/design_detectors.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "lucerna/project/schema/project_tables.h"

namespace lucerna {
namespace {

constexpr const char* kLampAlone = "[[source]]\nkind = \"disk\"\n";

std::string text_of(const Project& project) {
  std::ostringstream text;
  text << toml_tables(project);
  return text.str();
}

TEST(DesignDetectors, AFarFieldAndTheTargetsPlaneAreThereOnce) {
  Project project = parse_project(kLampAlone, "p.toml");
  DesignTarget target;
  target.plane.emplace();
  target.plane->size_x_mm = 800;
  target.plane->size_y_mm = 600;
  add_design_detectors(project, target);
  const std::string once = text_of(project);
  add_design_detectors(project, target);
  EXPECT_EQ(text_of(project), once);
  ASSERT_EQ(project.scene.far_fields.size(), 1u);
  ASSERT_EQ(project.scene.planes.size(), 1u);
  EXPECT_EQ(project.scene.planes.front().name, kTargetPlane);
  const Project again = parse_project(once, "p.toml");
  ASSERT_EQ(again.scene.planes.size(), 1u) << once;
  EXPECT_EQ(again.scene.planes.front().name, kTargetPlane);
}

TEST(DesignDetectors, APlaneOfTheTargetsNameIsTheTargets) {
  const auto add = [](const std::string& size) {
    Project project = parse_project(
        std::string(kLampAlone) + "[[detector]]\nname = \"target\"\nkind = \"plane\"\n" + size, "p.toml");
    DesignTarget target;
    target.plane.emplace();
    target.plane->size_x_mm = 800;
    target.plane->size_y_mm = 600;
    add_design_detectors(project, target);
    return project.scene.planes.size();
  };
  EXPECT_EQ(add("size_mm = [800, 600]\n"), 1u);
  EXPECT_THROW(add("size_mm = [800, 500]\n"), InputError);
  EXPECT_THROW(add("size_mm = [800, 600]\nposition_mm = [0, 0, -1]\n"), InputError);
  EXPECT_THROW(add("size_mm = [800, 600]\nturn_deg = 90\n"), InputError);
}

TEST(DesignDetectors, WhatTheProjectHasIsKept) {
  Project project = parse_project(
      std::string(kLampAlone) + "[[detector]]\nname = \"mine\"\nkind = \"far-field\"\nc_step_deg = 5.0\n",
      "p.toml");
  const std::string before = text_of(project);
  add_design_detectors(project, DesignTarget{});
  EXPECT_EQ(text_of(project), before);
  ASSERT_EQ(project.scene.far_fields.size(), 1u);
  EXPECT_EQ(project.scene.far_fields.front().name, "mine");
}

}  // namespace
}  // namespace lucerna
