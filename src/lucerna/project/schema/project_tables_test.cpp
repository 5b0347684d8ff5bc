// SPDX-License-Identifier: Apache-2.0
#include "lucerna/project/schema/project_tables.h"

#include <gtest/gtest.h>

#include <utility>

namespace lucerna {
namespace {

TEST(ProjectTables, ACopyIsOfItsOwn) {
  Project project;
  toml_tables(project).insert_or_assign("a", 1);
  Project copy = project;
  toml_tables(copy).insert_or_assign("a", 2);
  EXPECT_EQ(project_text(project), "a = 1\n");
  EXPECT_EQ(project_text(copy), "a = 2\n");
  project = copy;
  toml_tables(copy).clear();
  EXPECT_EQ(project_text(project), "a = 2\n");
}

TEST(ProjectTables, WhatWasMovedFromIsWhole) {
  Project project;
  toml_tables(project).insert_or_assign("a", 1);
  const Project moved = std::move(project);
  EXPECT_EQ(project_text(moved), "a = 1\n");
  project = Project();
  EXPECT_EQ(project_text(project), "\n");
}

}  // namespace
}  // namespace lucerna
