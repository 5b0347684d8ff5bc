// SPDX-License-Identifier: Apache-2.0
// What a GPU will evaluate, run by the CPU in its place: the same kernels over the same flat arrays.
#include "lucerna/design/evaluation/device_evaluator.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lucerna/design/fit/fit.h"
#include "lucerna/source.h"

namespace lucerna {
namespace {

DesignRays lamp(std::uint64_t rays = 1 << 15) {
  EmitterOptions options;
  options.kind = EmitterKind::cylinder;
  options.radius_mm = 0.5;
  options.length_mm = 3.0;
  DesignRays all({{make_emitter(options), Frame({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 14}), {}}}, Frame(),
                 5);
  all.grow(rays);
  return all;
}

DesignShape rough(const DesignShape& shape) {
  Eigen::VectorXd p = shape.parameters();
  for (Eigen::Index i = 0; i < p.size(); ++i) p[i] = 0.2 * std::sin(1.7 * static_cast<double>(i));
  return shape.with(p);
}

struct DeviceCase {
  const char* name;
  DesignShape shape;
  TentBins bins;
};

std::vector<DeviceCase> device_cases() {
  const Frame plane({1, 0, 0}, {0, -1, 0}, {0, 0, -1}, {0, 0, 500});
  return {
      {"revolution, rings", rough(DesignShape::revolution(15, Aperture::circle(50, 6), 8)),
       TentBins::rings(Frame(), 0.4, 40)},
      {"free form, square", rough(DesignShape::bspline(15, Aperture::circle(50), 5, 6)),
       TentBins::square(Frame(), 0.4, 24)},
      {"trough, plane", rough(DesignShape::trough(15, Aperture::rectangle(50, 40, 5), 7, true)),
       TentBins::plane(plane, 200, 150, 20)},
      {"free form, glare zone", rough(DesignShape::bspline(4, Aperture::rectangle(40, 40), 4, 4)),
       TentBins::zone(Frame(), 0.15, 8, 12)},
  };
}

/// The largest difference over the largest entry.
template <class A>
double apart(const A& a, const A& b) {
  return (a - b).cwiseAbs().maxCoeff() / b.cwiseAbs().maxCoeff();
}

TEST(DeviceEvaluator, IsTheCpusWithinTheUnits) {
  DesignRays rays = lamp();
  const Reflectance mirror(std::vector<ReflectanceEntry>{{0.0, 0.9}, {60.0, 0.85}, {90.0, 1.0}});
  EvaluationOptions options;
  options.rays = 1 << 15;
  for (const DeviceCase& c : device_cases()) {
    for (const double rim_mm : {0.0, 0.5}) {
      options.rim_mm = rim_mm;
      rays.evaluate_on(nullptr);
      const Evaluation cpu = evaluate(c.shape, mirror, rays, c.bins, options);
      rays.evaluate_on(make_emulated_accelerator());
      const Evaluation device = evaluate(c.shape, mirror, rays, c.bins, options);
      // A unit is 2^-26 of a ray; a bin rounds once a ray and tent.
      EXPECT_LT(apart(device.flux, cpu.flux), 1e-6) << c.name;
      EXPECT_LT(apart(device.variance, cpu.variance), 1e-4) << c.name;
      EXPECT_LT(apart(device.jacobian, cpu.jacobian), 1e-6) << c.name;
      EXPECT_NEAR(device.reflected, cpu.reflected, 1e-7);
      EXPECT_NEAR(device.direct, cpu.direct, 1e-7);
      EXPECT_NEAR(device.absorbed, cpu.absorbed, 1e-7);
      EXPECT_NEAR(device.back, cpu.back, 1e-7);
      EXPECT_EQ(device.rays, cpu.rays);
      EXPECT_GT(cpu.absorbed, 0.02) << c.name;
      // Another mirror is seen.
      const Evaluation other =
          evaluate(c.shape.with(0.99 * c.shape.parameters()), mirror, rays, c.bins, options);
      EXPECT_GT(apart(other.flux, cpu.flux), 1e-4) << c.name;
    }
  }
}

TEST(DeviceEvaluator, WithoutDerivativesAndWithMoreRaysLater) {
  DesignRays rays = lamp(1 << 14), all = lamp(1 << 16);
  const DeviceCase c = device_cases().front();
  rays.evaluate_on(make_emulated_accelerator());
  all.evaluate_on(make_emulated_accelerator());
  EvaluationOptions options;
  options.rays = 1 << 14;
  options.derivatives = false;
  options.direct_light = false;
  const Evaluation few = evaluate(c.shape, Reflectance(1.0), rays, c.bins, options);
  EXPECT_EQ(few.jacobian.size(), 0);
  EXPECT_EQ(few.absorbed, 0.0);
  // Rays that come later are copied too, and those that were there count the same to the bit.
  rays.grow(1 << 16);
  EXPECT_EQ(evaluate(c.shape, Reflectance(1.0), rays, c.bins, options).flux, few.flux);
  options.rays = 1 << 16;
  options.derivatives = true;
  const Evaluation grown = evaluate(c.shape, Reflectance(1.0), rays, c.bins, options);
  const Evaluation at_once = evaluate(c.shape, Reflectance(1.0), all, c.bins, options);
  EXPECT_EQ(grown.flux, at_once.flux);
  EXPECT_EQ(grown.jacobian, at_once.jacobian);
  EXPECT_NE(grown.flux, few.flux);
}

/// The fit of a plain paraboloid to the light of a rough mirror; its parameters at the end.
Eigen::VectorXd fitted(std::shared_ptr<Accelerator> accelerator, double& error) {
  const DesignShape start = DesignShape::bspline(15, Aperture::circle(50), 2, 2);
  DesignRays rays = lamp(1 << 14), truth = lamp(1 << 15);
  rays.evaluate_on(std::move(accelerator));
  const TentBins bins = TentBins::square(Frame(), 0.4, 16);
  FitProblem problem{&rays, Reflectance(0.9),
                     [&](const TentBins& b) {
                       EvaluationOptions plain{.rays = 1 << 15, .derivatives = false};
                       return evaluate(rough(start), Reflectance(0.9), truth, b, plain).flux;
                     },
                     bins, TargetMode::absolute};
  problem.max_failed_restarts = 0;
  Fit fit(problem, continuation_schedule(start, bins, {1 << 14, 0}), start);
  FitRecord last;
  while (!fit.done()) last = fit.step();
  error = last.error;
  return fit.best().parameters();
}

TEST(DeviceEvaluator, AWholeFitRunsThereToTheSameMirror) {
  double cpu = 0.0, device = 0.0, again = 0.0;
  const Eigen::VectorXd here = fitted(nullptr, cpu), there = fitted(make_emulated_accelerator(), device);
  EXPECT_NEAR(device, cpu, 0.02 * cpu);
  EXPECT_LT(apart(there, here), 0.02);
  EXPECT_EQ(fitted(make_emulated_accelerator(), again), there);
}

/// On a machine with a CUDA device: ctest -L gpu, or scripts/gpu_check.sh.
void expect_agreement(std::uint64_t n) {
  auto devices = cuda_accelerators();
  if (devices.empty()) GTEST_SKIP() << cuda_unavailable_reason();
  const std::shared_ptr<Accelerator> device = std::move(devices.front());
  DesignRays rays = lamp(n);
  EvaluationOptions options;
  options.rays = n;
  options.rim_mm = 0.5;
  for (const DeviceCase& c : device_cases()) {
    rays.evaluate_on(nullptr);
    const Evaluation cpu = evaluate(c.shape, Reflectance(0.9), rays, c.bins, options);
    rays.evaluate_on(device);
    const Evaluation there = evaluate(c.shape, Reflectance(0.9), rays, c.bins, options);
    // Its arc tangents differ in the last digit: a ray in a million may miss where another hits.
    EXPECT_LT(apart(there.flux, cpu.flux), 1e-5) << c.name;
    EXPECT_LT(apart(there.jacobian, cpu.jacobian), 1e-4) << c.name;
    const Evaluation again = evaluate(c.shape, Reflectance(0.9), rays, c.bins, options);
    EXPECT_EQ(again.flux, there.flux) << c.name;
    EXPECT_EQ(again.jacobian, there.jacobian) << c.name;
  }
}
TEST(DeviceEvaluatorGpu, FewRaysAgreeWithTheCpuAndToTheBitWithThemselves) { expect_agreement(1 << 14); }
TEST(DeviceEvaluatorGpu, AMillionRaysAgreeWithTheCpuAndToTheBitWithThemselves) { expect_agreement(1 << 20); }

}  // namespace
}  // namespace lucerna
