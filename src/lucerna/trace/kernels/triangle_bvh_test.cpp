// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/kernels/triangle_bvh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "lucerna/core/io/error.h"
#include "lucerna/trace/engines/body_tracer.h"
#include "tests/support/meshes.h"
#include "tests/support/random_direction.h"

namespace lucerna {
namespace {

struct Shape {
  std::string name;
  std::shared_ptr<const Mesh> mesh;
};

std::vector<Shape> shapes() {
  return {{"globe", test::globe(60, 40.0)},
          {"box", test::box_mesh({30.0, 20.0, 45.0})},
          {"sheet", test::sheet(64, 40.0, -0.02, 1.5)},
          {"loose triangles", test::loose_triangles(3000, 9)}};
}

Body body_of(std::shared_ptr<const Mesh> mesh, double smooth_below_deg = 0.0) {
  Body body;
  body.mesh = std::move(mesh);
  body.smooth_below_deg = smooth_below_deg;
  return body;
}

Vec3 rounded(const Vec3& v) {
  const auto f = [](double x) { return static_cast<double>(static_cast<float>(x)); };
  return {f(v.x), f(v.y), f(v.z)};
}

/// From about the mesh and within it, every way; every other ray goes exactly towards a corner, or a point on
/// an edge, of some triangle.
Ray random_ray(Rng& rng, const Mesh& mesh, std::size_t number) {
  const auto within = [&](double half) { return half * (2.0 * rng.uniform() - 1.0); };
  const double reach = number % 3 == 0 ? 150.0 : 30.0;
  const Vec3 from = rounded({within(reach), within(reach), within(reach)});
  const Direction any = test::random_direction(rng);
  if (number % 2 == 0) return {from, any};
  const auto& t = mesh.triangles[static_cast<std::size_t>(rng.uniform() * 0.999999 *
                                                          static_cast<double>(mesh.triangles.size()))];
  const Vec3 a = mesh.vertices_mm[t[0]], b = mesh.vertices_mm[t[1]];
  const double share = number % 4 == 1 ? 0.0 : rng.uniform();
  return {from, Direction::from(a + share * (b - a) - from)};
}

/// How near a point is to the nearest edge of any triangle.
double to_an_edge(const Mesh& mesh, const Vec3& p) {
  double min = std::numeric_limits<double>::infinity();
  for (const auto& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 a = mesh.vertices_mm[t[k]], way = mesh.vertices_mm[t[(k + 1) % 3]] - a;
      const double whole = dot(way, way);
      const double share = whole > 0.0 ? std::clamp(dot(p - a, way) / whole, 0.0, 1.0) : 0.0;
      min = std::min(min, length(p - a - share * way));
    }
  }
  return min;
}

TEST(TriangleBvh, FindsWhatAllTrianglesOneByOneDo) {
  std::vector<Shape> all = shapes();
  auto far_off = std::make_shared<Mesh>(*test::globe(20, 3.0));
  for (Vec3& p : far_off->vertices_mm) p += {4000.0, -2000.0, 10.0};
  all.push_back({"far off", far_off});
  auto same = std::make_shared<Mesh>(*test::box_mesh({1.0, 1.0, 1.0}));
  for (int i = 0; i < 100; ++i) same->triangles.push_back(same->triangles[0]);
  all.push_back({"a hundred times one triangle", same});
  for (const Shape& shape : all) {
    const TriangleBvh tree({body_of(shape.mesh)}, true);
    ASSERT_EQ(tree.triangles().size(), shape.mesh->triangles.size()) << shape.name;
    std::size_t hits = 0;
    for (std::size_t i = 0; i < 4000; ++i) {
      Rng rng(3, i);
      const Ray ray = random_ray(rng, *shape.mesh, i);
      const double t_min = i % 5 == 0 ? 1e-3 : 0.0, t_max = i % 7 == 0 ? 60.0 : 1e30;
      TriangleHit one;
      one.t = t_max;
      for (std::size_t k = 0; k < tree.triangles().size(); ++k) {
        intersect_triangle(tree.triangles()[k], static_cast<std::int32_t>(k), ray.origin_mm,
                           ray.direction.vec(), t_min, one);
      }
      const TriangleHit hit = first_triangle(tree.view(), ray.origin_mm, ray.direction.vec(), t_min, t_max);
      ASSERT_EQ(hit.triangle, one.triangle) << shape.name << ", ray " << i;
      ASSERT_EQ(hit.t, one.t) << shape.name << ", ray " << i;
      hits += hit.triangle >= 0 ? 1 : 0;
    }
    EXPECT_GT(hits, 500u) << shape.name;
  }
}

// Half of the rays go exactly to a corner or edge. Without one of its triangles, the globe leaks.
TEST(TriangleBvh, NoRayLeavesAClosedMesh) {
  for (const auto& mesh : {test::globe(60, 40.0), test::box_mesh({35.0, 32.0, 45.0})}) {
    auto holed = std::make_shared<Mesh>(*mesh);
    holed->triangles.erase(holed->triangles.begin() + 5);
    const TriangleBvh whole({body_of(mesh)}, true), with_hole({body_of(holed)}, true);
    std::size_t leaks = 0, through_hole = 0;
    for (std::size_t i = 0; i < 200000; ++i) {
      Rng rng(4, i);
      Ray ray = random_ray(rng, *mesh, i % 3 == 0 ? i + 1 : i);
      ray.origin_mm = rounded(0.2 * ray.origin_mm);
      if (i % 2 == 1) ray = random_ray(rng, *mesh, 2 * i + 1);
      if (length(ray.origin_mm) > 30.0) ray.origin_mm = {};
      const auto leaves = [&](const TriangleBvh& tree) {
        return first_triangle(tree.view(), ray.origin_mm, ray.direction.vec(), 0.0, 1e30).triangle < 0;
      };
      leaks += leaves(whole) ? 1 : 0;
      through_hole += leaves(with_hole) ? 1 : 0;
    }
    EXPECT_EQ(leaks, 0u);
    EXPECT_GT(through_hole, 0u);
  }
}

/// Compares with Embree, which works in float32: a ray 200 mm long is off by some of these.
constexpr double kTreeRounding = 5e-5;

class Comparison {
 public:
  explicit Comparison(const Shape& shape)
      : shape_(shape),
        embree_({body_of(shape.mesh, 40.0)}),
        corners_(smooth_normals(body_of(shape.mesh, 40.0))),
        tree_({body_of(shape.mesh)}, true) {
    body_.corner_normals = corners_.data();
  }

  void add(const Ray& ray) {
    const double far = std::numeric_limits<float>::max();
    const auto theirs = embree_.first_hit(ray, far, true);
    const auto ours = first_body({tree_.view(), tree_.view(), &body_, 1}, ray, far, true);
    ++rays_;
    if (theirs) ++hits_;
    if (!theirs && !ours) return;
    const BodyHit& nearer = !theirs || (ours && ours->t_mm < theirs->t_mm) ? *ours : *theirs;
    const double across = std::fabs(dot(nearer.face, ray.direction));
    const double off_plane = theirs && ours ? std::fabs(ours->t_mm - theirs->t_mm) * across : 1.0;
    const auto at_edge = [&] {
      return to_an_edge(*shape_.mesh, ray.at(nearer.t_mm)) <
             kTreeRounding * (2.0 + 1.0 / std::max(across, 1e-6));
    };
    if (!(off_plane < kTreeRounding)) {
      ++differ_;
      at_edge_ += at_edge() ? 1 : 0;
      return;
    }
    max_mm_ = std::max(max_mm_, off_plane);
    // On an edge either of two triangles may be met.
    if (length(ours->face.vec() - theirs->face.vec()) > 1e-4) {
      if (++other_face_ % 50 == 1) {
        EXPECT_TRUE(at_edge());
      }
    } else {
      max_turn_ = std::max(max_turn_, across * length(ours->normal.vec() - theirs->normal.vec()));
    }
  }

  /// All differences are at edges; at most `max` of all rays differ.
  void expect_agreement(double max, const char* rays) const {
    std::printf(
        "%s, rays %s: %zu of %zu hit; %zu differ, %zu of them beside an edge; %zu the other face of an "
        "edge; else within %.2g mm of its plane, smooth normals within %.2g\n",
        shape_.name.c_str(), rays, hits_, rays_, differ_, at_edge_, other_face_, max_mm_, max_turn_);
    EXPECT_EQ(differ_, at_edge_) << shape_.name;
    EXPECT_GT(hits_, rays_ / 10);
    EXPECT_LE(static_cast<double>(differ_), max * static_cast<double>(rays_)) << shape_.name;
    EXPECT_LT(max_turn_, 1e-4);
  }

 private:
  Shape shape_;
  BodyTracer embree_;
  std::vector<Vec3> corners_;
  TriangleBvh tree_;
  BodyView body_;
  std::size_t rays_ = 0, hits_ = 0, differ_ = 0, at_edge_ = 0, other_face_ = 0;
  double max_mm_ = 0.0, max_turn_ = 0.0;
};

TEST(TriangleBvh, MeetsWhatEmbreeMeets) {
  try {
    const BodyTracer there({body_of(test::box_mesh({1, 1, 1}))});
  } catch (const InputError& e) {
    GTEST_SKIP() << e.what();
  }
  for (const Shape& shape : shapes()) {
    Comparison anywhere(shape), at_edges(shape);
    for (std::size_t i = 0; i < 40000; ++i) {
      Rng rng(5, i);
      (i % 2 == 0 ? anywhere : at_edges).add(random_ray(rng, *shape.mesh, i));
    }
    anywhere.expect_agreement(1e-3, "anywhere");
    // Exactly at an outline either answer is right.
    at_edges.expect_agreement(0.2, "at edges");
  }
}

TEST(TriangleBvh, LampsMeetOnlyReturningLight) {
  Body lamp = body_of(test::box_mesh({1, 1, 1}));
  lamp.only_returning_light = true;
  lamp.world_from_body = Frame::from_axis(Direction{}, 0.0, {0, 0, 5});
  const std::vector<Body> bodies{lamp, body_of(test::box_mesh({2, 2, 2}))};
  const TriangleBvh direct(bodies, false), returning(bodies, true);
  EXPECT_EQ(direct.triangles().size(), 12u);
  EXPECT_EQ(returning.triangles().size(), 24u);
  const BodyView views[2] = {};
  const BodiesView all{direct.view(), returning.view(), views, 2};
  const Ray down{{0.3, 0.1, 20.0}, Direction::from({0, 0, -1})};
  EXPECT_EQ(first_body(all, down, 1e30, false)->body, 1u);
  EXPECT_EQ(first_body(all, down, 1e30, false)->t_mm, 18.0);
  EXPECT_EQ(first_body(all, down, 1e30, true)->body, 0u);
  EXPECT_EQ(first_body(all, down, 1e30, true)->t_mm, 14.0);
  EXPECT_FALSE(first_body(all, down, 14.0, true).has_value()) << "a mirror stands before it";
  const TriangleBvh none({lamp}, false);
  EXPECT_FALSE(first_body({none.view(), returning.view(), views, 2}, down, 1e30, false).has_value());
  // A start on a triangle does not meet it again.
  const Ray off{{0.3, 0.1, 2.0}, Direction::from({0, 0.1, 1})};
  EXPECT_EQ(first_body(all, off, 1e30, true)->body, 0u);
  EXPECT_GT(first_body(all, off, 1e30, true)->t_mm, 1.9);
}

}  // namespace
}  // namespace lucerna
