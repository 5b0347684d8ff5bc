// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/evaluation/body_shadows.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lucerna/cad.h"
#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"
#include "lucerna/design/run/design.h"
#include "lucerna/design/validation/validation.h"
#include "lucerna/photometric_file.h"
#include "lucerna/source.h"
#include "tests/support/temp_dir.h"

namespace lucerna {
namespace {

using test::TempDir;

Mesh box(const Vec3& low, const Vec3& high) {
  Mesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.vertices_mm.push_back(
        {(i & 1) != 0 ? high.x : low.x, (i & 2) != 0 ? high.y : low.y, (i & 4) != 0 ? high.z : low.z});
  }
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

Body body(const Vec3& low, const Vec3& high, double reflectance = 0.0, bool lamp = false) {
  Body out;
  out.mesh = std::make_shared<const Mesh>(box(low, high));
  out.reflectance = Reflectance(reflectance);
  out.only_returning_light = lamp;
  return out;
}

TEST(BodyShadows, EndReflectAndLetPass) {
  const BodyShadows shadows({body({-1, -1, 10}, {1, 1, 11}), body({-1, -1, 20}, {1, 1, 21}, 0.8),
                             body({4, -1, 5}, {6, 1, 6}, 0.0, true)},
                            3);
  const Vec3 up{0, 0, 1};
  const auto shadow = shadows.first({0, 0, 0}, up, 1e9, false);
  ASSERT_TRUE(shadow);
  EXPECT_EQ(shadow->reflected, 0.0);
  EXPECT_NEAR(shadow->origin.z, 10.0, 0.01);
  EXPECT_FALSE(shadows.first({0, 0, 0}, up, 9.0, false)) << "the mirror is nearer";
  const auto mirror = shadows.first({0, 0, 15}, up, 1e9, true);
  ASSERT_TRUE(mirror);
  EXPECT_NEAR(mirror->reflected, 0.8, 1e-12);
  EXPECT_NEAR(mirror->direction.z, -1.0, 1e-12);
  EXPECT_LT(mirror->origin.z, 20.0);
  EXPECT_FALSE(shadows.first({5, 0, 0}, up, 1e9, false)) << "a lamp's own light has left it already";
  EXPECT_TRUE(shadows.first({5, 0, 0}, up, 1e9, true));
}

TEST(BodyShadows, TheBackOfAReflectorAbsorbs) {
  const Body sheet = body({-1, -1, 10}, {1, 1, 11}, 0.9);
  EXPECT_GT(BodyShadows({sheet}, 1).first({0, 0, 0}, {0, 0, 1}, 1e9, false)->reflected, 0.8);
  // From within a face's normal points along the ray.
  const Vec3 inside{0, 0, 10.5};
  EXPECT_GT(BodyShadows({sheet}, 1).first(inside, {0, 0, 1}, 1e9, false)->reflected, 0.8);
  EXPECT_EQ(BodyShadows({sheet}, 0).first(inside, {0, 0, 1}, 1e9, false)->reflected, 0.0);
}

/// A disk that shines up into a mirror of 60 mm; an absorber in its beam, and a mirror beside it.
Scene scene(const DesignShape& shape) {
  EmitterOptions options;
  options.kind = EmitterKind::disk;
  options.radius_mm = 1.0;
  Scene s;
  s.sources.push_back({make_emitter(options), Frame({1, 0, 0}, {0, -1, 0}, {0, 0, -1}, {0, 0, 10}), {}});
  s.reflectors.push_back({shape.reflector(), Frame(), Reflectance(0.9), 0.0});
  s.bodies = {body({-8, -4, 40}, {2, 9, 42}), body({12, -20, 30}, {14, 20, 50}, 0.7)};
  s.bodies[1].name = "plate";
  return s;
}

DesignShape wavy_mirror() {
  const DesignShape plain = DesignShape::bspline(10, Aperture::circle(60, 6), 8, 8);
  Eigen::VectorXd p = plain.parameters();
  for (Eigen::Index i = 0; i < p.size(); ++i) p[i] += 0.3 * std::sin(1.7 * static_cast<double>(i));
  return plain.with(p);
}

/// Evaluation (own tree, exact mirror, double) and validation (Embree, triangles, other rays) see the same
/// light. Shares of 2^18 rays each agree to some 1e-4; a body that is not there changes them by a tenth.
TEST(BodyShadowsStatistical, EvaluationAndValidationAgree) {
  const DesignShape shape = wavy_mirror();
  const Scene s = scene(shape);
  DesignRays rays(s.sources, Frame(), 5);
  rays.grow(std::uint64_t{1} << 18);
  rays.shade_by(shadows_of(s, Frame()));
  const TentBins bins = TentBins::square(Frame(), 0.9, 12);
  EvaluationOptions options;
  options.rays = std::uint64_t{1} << 18;
  options.derivatives = false;
  const Evaluation e = evaluate(shape, Reflectance(0.9), rays, bins, options);
  const TargetRectangle rectangle{Frame(), false, -0.5, 0.5, -0.5, 0.5};
  const ErrorBoxes boxes(rectangle);
  ValidationOptions o;
  o.min_rays = o.max_rays = std::uint64_t{1} << 18;
  const Validation v =
      validate(s, boxes, boxes.flux_of([](const Direction&) { return 1.0; }, 0.1), TargetMode::shape, o);
  EXPECT_GT(v.bodies.mean, 0.08);
  EXPECT_NEAR(e.reflected + e.direct, v.efficiency.mean, 2e-3);
  EXPECT_NEAR(e.bodies, v.bodies.mean, 2e-3);
  EXPECT_NEAR(e.reflected + e.direct + e.absorbed + e.back + e.lost + e.bodies, 1.0, 1e-9);

  rays.shade_by(nullptr);
  const Evaluation open = evaluate(shape, Reflectance(0.9), rays, bins, options);
  EXPECT_GT(open.reflected + open.direct, e.reflected + e.direct + 0.08);
  EXPECT_EQ(open.bodies, 0.0);
}

TEST(BodyShadows, DerivativesAreThoseOfTheLightThatPasses) {
  const DesignShape shape = wavy_mirror();
  Scene s = scene(shape);
  s.bodies.resize(1);
  DesignRays rays(s.sources, Frame(), 5);
  rays.grow(std::uint64_t{1} << 14);
  rays.shade_by(shadows_of(s, Frame()));
  const TentBins bins = TentBins::square(Frame(), 0.9, 12);
  EvaluationOptions options;
  options.rays = std::uint64_t{1} << 14;
  const Evaluation dense = evaluate(shape, Reflectance(0.9), rays, bins, options);
  options.sparse = true;
  const Evaluation sparse = evaluate(shape, Reflectance(0.9), rays, bins, options);
  EXPECT_LT((BinJacobian(sparse.rows) - dense.jacobian).norm(), 1e-9 * dense.jacobian.norm());
  // So small a step moves no ray of these across the body's edge, but for a few.
  Eigen::VectorXd along(static_cast<Eigen::Index>(shape.parameter_count()));
  for (Eigen::Index i = 0; i < along.size(); ++i) along[i] = std::cos(0.3 * static_cast<double>(i));
  constexpr double kStep = 1e-7;
  options.derivatives = options.sparse = false;
  const Eigen::VectorXd up =
      evaluate(shape.with(shape.parameters() + kStep * along), Reflectance(0.9), rays, bins, options).flux;
  const Eigen::VectorXd down =
      evaluate(shape.with(shape.parameters() - kStep * along), Reflectance(0.9), rays, bins, options).flux;
  const Eigen::VectorXd slope = (up - down) / (2.0 * kStep);
  EXPECT_LT((dense.jacobian * along - slope).norm(), 0.01 * slope.norm());
}

/// A shield stands in the beam of the middle of the mirror.
DesignProblem shielded(const TempDir& folder, bool shield) {
  PhotometricFile spot;
  spot.distribution = uniform_distribution(0.0, 1.0);
  for (std::size_t g = 0; g < 60; ++g) {
    const double gamma = spot.distribution.gamma_deg[g];
    spot.distribution.at(0, g) = 1000.0 * std::exp(-gamma * gamma / 300.0);
  }
  write_photometric_file(folder / "spot.ldt", spot, PhotometricFormat::ldt);
  write_file(folder / "shield.stl", stl_bytes(box({-4, -4, -22}, {4, 4, -20})));
  const std::string project = R"([[source]]
kind = "disk"
radius_mm = 1.0
[[reflector]]
family = "revolution"
preset = "parabola"
focal_mm = 8
diameter_mm = 60.0
position_mm = [0, 0, 8]
axis = "-z"
reflectance = 0.9
[target]
file = "spot.ldt"
[design]
restarts = 0
intervals = 8
)" + std::string(shield ? "[[body]]\nfile = \"shield.stl\"\nname = \"shield\"\n" : "");
  write_file(folder / "p.toml", project);
  return design_problem(read_project(folder / "p.toml"), folder / "p.toml");
}

/// The error of a shape behind the shield, by the validation.
DesignError error_behind(const DesignProblem& problem, const DesignShape& shape) {
  Scene s = problem.project.scene;
  s.reflectors.front().reflector = shape.reflector();
  const ErrorBoxes boxes(target_rectangle(problem.target));
  ValidationOptions o;
  o.min_rays = o.max_rays = std::uint64_t{1} << 19;
  return validate(s, boxes, box_target(boxes, problem.target, 1000.0), problem.target.mode, o).error;
}

TEST(BodyShadows, ADesignThatKnowsTheBodyIsNearerToTheTargetBehindIt) {
  const TempDir folder, open_folder;
  const DesignProblem known = shielded(folder, true), ignored = shielded(open_folder, false);
  DesignOptions options;
  options.time_s = 1e6;
  options.max_rays = 1 << 15;
  options.validation_rays = 1 << 17;
  const DesignResult with = design(known, options), without = design(ignored, options);
  EXPECT_GT(with.bodies.mean, 0.02);
  EXPECT_EQ(without.bodies.mean, 0.0);
  const DesignError a = error_behind(known, with.shape), b = error_behind(known, without.shape);
  EXPECT_LT(a.c12.excess, 0.6 * b.c12.excess) << b.c12.excess;
  // The body changes the printed light of one and the same mirror.
  EXPECT_GT(b.c12.excess, error_behind(ignored, without.shape).c12.excess + 0.03);
}

constexpr const char* kTwoMirrors = R"([[source]]
kind = "disk"
radius_mm = 1.0
[[reflector]]
family = "revolution"
preset = "parabola"
focal_mm = 5
diameter_mm = 10
position_mm = [0, 0, -60]
axis = "+z"
[[reflector]]
family = "bspline"
focal_mm = 8
diameter_mm = 60
position_mm = [0, 0, 8]
axis = "-z"
[target]
[[target.zone]]
gamma_deg = [0, 10]
c_deg = [0, 360]
min_cd = 100
[design]
)";

DesignProblem two_mirrors(const TempDir& folder, const std::string& design) {
  write_file(folder / "p.toml", kTwoMirrors + design);
  return design_problem(read_project(folder / "p.toml"), folder / "p.toml");
}

TEST(BodyShadows, OfSeveralMirrorsOneIsShapedAndTheOthersStandInTheLight) {
  const TempDir folder;
  const DesignProblem p = two_mirrors(folder, "reflector = 1\n");
  EXPECT_EQ(p.start.aperture().half_x_mm(), 30.0);
  EXPECT_EQ(p.world_from_mirror.origin_mm().z, 8.0);
  const auto shadows = shadows_of(p.project.scene, p.world_from_mirror.inverse());
  ASSERT_TRUE(shadows);
  // Down the axis: the small mirror's face looks up, 68 mm before the large one's vertex.
  const auto shadow = shadows->first({1, 1, 10}, {0, 0, 1}, 1e9, true);
  ASSERT_TRUE(shadow);
  EXPECT_NEAR(shadow->origin.z, 68.0, 0.3);
  EXPECT_GT(shadow->reflected, 0.99);
  EXPECT_EQ(shadows->first({1, 1, 100}, {0, 0, -1}, 1e9, true)->reflected, 0.0) << "its back";
  // What a design leaves has both, the shaped one first, and reads again.
  write_file(folder / "again.toml", project_text(with_shape(p, p.start)));
  const DesignProblem again = design_problem(read_project(folder / "again.toml"), folder / "again.toml");
  EXPECT_EQ(again.project.scene.reflectors.size(), 2u);
  EXPECT_EQ(again.start.aperture().half_x_mm(), 30.0);
}

TEST(BodyShadows, WhichMirrorIsShapedMustBeSaid) {
  const auto error = [](const std::string& design) -> std::string {
    const TempDir folder;
    try {
      two_mirrors(folder, design);
    } catch (const InputError& e) {
      return e.what();
    }
    return "no error";
  };
  EXPECT_NE(error("").find("design.reflector: is missing: found 2 reflectors"), std::string::npos)
      << error("");
  EXPECT_NE(error("reflector = 2\n").find("expected a whole number from 0 to 1"), std::string::npos);
  EXPECT_NE(error("reflector = 0.5\n").find("expected a whole number from 0 to 1"), std::string::npos);
}

}  // namespace
}  // namespace lucerna
