// SPDX-License-Identifier: Apache-2.0
// What `lucerna init` writes: every block of it reads.
#include <gtest/gtest.h>

#include <sstream>

#include "lucerna/cad.h"
#include "lucerna/core/image/png.h"
#include "lucerna/core/io/file.h"
#include "lucerna/design/run/design_problem.h"
#include "lucerna/photometric_file.h"
#include "lucerna/ray_file.h"
#include "tests/support/random_rays.h"
#include "tests/support/run_program.h"

namespace lucerna {
namespace {

/// The commented blocks, uncommented: lines that begin with # and no blank after it.
std::vector<std::string> blocks(const std::string& text) {
  std::vector<std::string> all;
  std::istringstream lines(text);
  bool inside = false;
  for (std::string line; std::getline(lines, line);) {
    const bool code = line.size() > 1 && line[0] == '#' && line[1] != ' ';
    if (code && !inside) all.emplace_back();
    if (code) all.back() += line.substr(1) + "\n";
    inside = code;
  }
  return all;
}

/// A folder with all files that the template speaks of.
void make_files(const test::TempDir& dir) {
  write_ray_set(dir / "led.tm25ray", test::random_ray_set(100, 1), "tm25");
  std::string heights;
  for (int i = 0; i < 25; ++i) heights += i % 5 < 4 ? "1," : "1\n";
  write_file(dir / "heights.csv", heights);
  const Mesh closed{{{0, 0, 0}, {9, 0, 0}, {0, 9, 0}, {0, 0, 9}},
                    {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
  const Mesh open{closed.vertices_mm, {{0, 2, 1}}};
  for (const char* name : {"housing.stl", "bulb.stl"}) write_file(dir / name, stl_bytes(closed));
  for (const char* name : {"mirror.stl", "sheet.stl"}) write_file(dir / name, stl_bytes(open));
  IntensityDistribution light = uniform_distribution(30.0, 10.0);
  for (std::size_t c = 0; c < light.c_deg.size(); ++c) light.at(c, 0) = light.at(c, 1) = 100.0;
  write_file(dir / "wanted.ldt", ldt_text({light, {}}));
  write_png(dir / "wanted.png", 2, 2, std::vector<std::uint8_t>(12, 255));
}

class InitCli : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(test::run_lucerna(dir.path(), "init -o p.toml").exit_code, 0);
    text = test::slurp(dir / "p.toml");
    make_files(dir);
  }
  Project read(const std::string& project) {
    write_file(dir / "q.toml", project);
    return read_project(dir / "q.toml");
  }
  test::TempDir dir;
  std::string text;
};

TEST_F(InitCli, ReadsAsItIs) {
  const Project project = read(text);
  EXPECT_EQ(project.scene.sources.size(), 1u);
  EXPECT_EQ(project.scene.reflectors.size(), 1u);
  EXPECT_EQ(project.scene.far_fields.size(), 1u);
  EXPECT_TRUE(project.warnings.empty());
}

TEST_F(InitCli, EveryBlockReadsOnceItIsUncommented) {
  std::size_t sources = 0, reflectors = 0, bodies = 0, detectors = 0, designs = 0;
  const std::vector<std::string> all = blocks(text);
  for (const std::string& block : all) {
    SCOPED_TRACE(block);
    const Project project = read(text + "\n" + block);
    if (block.find("led.tm25ray") == std::string::npos) {
      EXPECT_TRUE(project.warnings.empty()) << project.warnings.front();
    }
    const Scene& s = project.scene;
    sources += s.sources.size() - 1;
    reflectors += s.reflectors.size() - 1 + (block.find("mesh") != std::string::npos ? 1 : 0);
    bodies += block.find("[[body]]") != std::string::npos
                  ? s.bodies.size() + s.glasses.size() + s.solids.size()
                  : 0;
    detectors += s.far_fields.size() + s.planes.size() + s.luminances.size() + s.ray_detectors.size() - 1;
    if (block.find("[target]") == std::string::npos) continue;
    ++designs;
    EXPECT_NO_THROW(design_problem(project, dir / "q.toml"));
  }
  EXPECT_EQ(sources, 2u);
  EXPECT_EQ(reflectors, 8u) << "one of every family, one profile, two that are no function of r";
  EXPECT_EQ(bodies, 6u) << "every role, and a lens array";
  EXPECT_EQ(detectors, 4u) << "every kind";
  EXPECT_EQ(designs, 2u);
  EXPECT_EQ(sources + reflectors + bodies + detectors + designs, all.size());
}

TEST_F(InitCli, AllTogetherTraceIntoAllFiles) {
  std::string project = text;
  for (const std::string& block : blocks(text)) {
    if (block.find("[target]") == std::string::npos) project += "\n" + block;
  }
  write_file(dir / "all.toml", project);
  const auto run = test::run_lucerna(dir.path(), "trace all.toml -o out --rays 3e4");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  for (const char* name : {"far.ldt", "floor.csv", "floor.png", "side.csv", "eye.png", "luminaire.tm25ray",
                           "result.json", "project.toml", "trace.sums"})
    EXPECT_TRUE(std::filesystem::exists(dir / "out" / name)) << name;
  EXPECT_NE(run.out.find("absorbed: housing"), std::string::npos) << run.out;
  EXPECT_EQ(test::run_lucerna(dir.path(), "report out -o r.html").exit_code, 0);
  EXPECT_EQ(test::run_lucerna(dir.path(), "trace out/project.toml -o again --rays 3e4").exit_code, 0);
  EXPECT_EQ(test::slurp(dir / "out" / "floor.csv"), test::slurp(dir / "again" / "floor.csv"));
}

}  // namespace
}  // namespace lucerna
