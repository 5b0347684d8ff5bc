// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/problem/target.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "lucerna/core/image/png.h"
#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"
#include "lucerna/design/run/design.h"
#include "tests/support/temp_dir.h"

namespace lucerna {
namespace {

using test::TempDir;
using testing::HasSubstr;

constexpr const char* kScene = R"(
[[source]]
kind = "disk"
radius_mm = 1.0
[[reflector]]
family = "bspline"
focal_mm = 8
diameter_mm = 60.0
position_mm = [0, 0, 8]
axis = "-z"
)";

DesignProblem target_problem(const std::filesystem::path& folder, const std::string& target,
                             const std::string& design = "intervals = 3\n") {
  write_file(folder / "p.toml", kScene + ("[target]\n" + target) + "[design]\n" + design);
  return design_problem(read_project(folder / "p.toml"), folder / "p.toml");
}

constexpr const char* kFloor =
    "kind = \"plane\"\nfile = \"e.csv\"\nposition_mm = [100, 0, -1500]\nnormal = \"+z\"\nsize_mm = [800, "
    "500]\n";

TEST(PlaneTarget, TheEquivalentLuminaireLightsThePlaneAsWanted) {
  const TempDir folder;
  write_file(folder / "e.csv", "1,2,3\n4,5,6\n");
  const DesignProblem p = target_problem(folder.path(), kFloor);
  const PlaneTarget& plane = *p.target.plane;
  const Vec3 lamp = p.world_from_mirror.origin_mm();
  for (const auto& [x, y] : {std::pair{0.0, 0.0}, std::pair{150.0, -80.0}, std::pair{-200.0, 100.0}}) {
    const Vec3 at = plane.world_from_plane.point({x, y, 0}) - lamp;
    const double r = length(at), cosine = -dot(at, plane.world_from_plane.ez()) / r;
    const double lx = intensity_in(p.target.distribution, Direction::from(at)) * 1e6 * cosine / (r * r);
    EXPECT_NEAR(lx / plane.at(x, y), 1.0, 0.02) << x << " " << y;
  }
  EXPECT_EQ(intensity_in(p.target.distribution, Direction::from(Vec3{0, 0, 1})), 0.0);
  EXPECT_NEAR(plane.flux(), 3.5 * 0.8 * 0.5, 1e-12);
}

TEST(PlaneTarget, BinsHoldTheFluxOfTheMap) {
  const TempDir folder;
  write_file(folder / "e.csv", "2\n");
  const DesignProblem p = target_problem(folder.path(), std::string(kFloor) + "mode = \"absolute\"\n");
  const TentBins bins = target_window(p);
  ASSERT_TRUE(bins.is_plane());
  const Eigen::VectorXd flux = target_flux(p.target, p.world_from_mirror, 1000.0)(bins);
  // An even rectangle: an eighth of a cell is missing along each of four sides.
  EXPECT_NEAR(flux.sum() * 1000.0, p.target.plane->flux() * (1.0 - 0.5 / 48.0),
              1e-3 * p.target.plane->flux());
}

TEST(PlaneTarget, AMirrorIsShapedForARectangleOnTheFloor) {
  const TempDir folder;
  write_file(folder / "e.csv", "1\n");
  DesignOptions options;
  options.max_rays = 1 << 14;
  options.validation_rays = 1 << 17;
  const DesignProblem p =
      target_problem(folder.path(), kFloor, "intervals = 2\nrestarts = 1\ntime_s = 1e6\n");
  const DesignResult result = design(p, options);
  EXPECT_LT(result.error.c12.excess, 0.25 * result.start_error.c12.excess);  // 0.12
  EXPECT_GT(result.error.in_rectangle.mean, 0.3);
}

TEST(PlaneTarget, NamesWhatIsWrong) {
  const TempDir folder;
  write_file(folder / "e.csv", "1\n");
  write_file(folder / "CAMERA.CSV", "1\n");
  write_png(folder / "e.png", 1, 1, std::vector<std::uint8_t>(3, 255));
  const auto message = [&](const std::string& target) {
    try {
      target_problem(folder.path(), target);
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_THAT(message("kind = \"wall\"\nfile = \"e.csv\"\n"), HasSubstr("target.kind: found 'wall'"));
  EXPECT_THAT(message("kind = \"plane\"\n"), HasSubstr("target.file: is missing: a CSV or PNG"));
  EXPECT_THAT(message("kind = \"plane\"\nfile = \"e.csv\"\n"), HasSubstr("target.position_mm: is missing"));
  const std::string placed = "kind = \"plane\"\nposition_mm = [0, 0, -1500]\nsize_mm = [800, 500]\n";
  EXPECT_THAT(message(placed + "file = \"e.csv\"\n"), HasSubstr("target.normal: is missing"));
  EXPECT_THAT(message(placed + "file = \"e.csv\"\nnormal = \"-z\"\n"), HasSubstr("looks away"));
  EXPECT_THAT(message(placed + "file = \"CAMERA.CSV\"\nnormal = \"-z\"\n"), HasSubstr("looks away"));
  EXPECT_THAT(message(placed + "file = \"e.ldt\"\nnormal = \"z\"\n"),
              HasSubstr("expected a .csv, .txt or .png"));
  EXPECT_THAT(message(placed + "file = \"e.png\"\nnormal = \"z\"\nmode = \"absolute\"\n"),
              HasSubstr("target.white_lx: is missing"));
  EXPECT_THAT(message(placed + "file = \"none.csv\"\nnormal = \"z\"\n"), HasSubstr("none.csv"));
  EXPECT_THAT(message(std::string(kFloor) + "siz_mm = 3\n"), HasSubstr("size_mm"));
  EXPECT_EQ(message(placed + "file = \"e.png\"\nnormal = \"z\"\nmode = \"absolute\"\nwhite_lx = 100\n"), "");
}

}  // namespace
}  // namespace lucerna
