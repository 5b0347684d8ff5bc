// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "lucerna/optics/height_field/height_field.h"
#include "lucerna/progress.h"
#include "lucerna/rays.h"
#include "lucerna/trace.h"

/// The scenes on which light tracing is measured, for `lucerna bench` and bench/trace.
namespace lucerna {

/// A square mirror of 100 mm: z = r^2 / (4 f) + p cos(k x) cos(k y) with a pitch of 8 mm.
struct BenchmarkScene {
  std::string name;
  double focal_mm = 15.0, pillow_mm = 0.0;
};

/// para (f 15), wavy (f 15, pillows of 0.4 mm), deep (f 5, the same pillows).
std::span<const BenchmarkScene> benchmark_scenes();

/// `n` rays in random order from the lateral surface of a cylinder (radius 1 mm, length 6 mm) into all
/// directions.
std::shared_ptr<const RaySet> benchmark_rays(std::size_t n);

/// The rays about the mirror's focus, reflectance 0.9, Type C bins of one degree.
Scene benchmark_scene(const BenchmarkScene& scene, std::shared_ptr<const RaySet> rays);
inline constexpr int kBenchmarkBounces = 4;

double wall_seconds(const std::function<void()>& work);
/// Seconds of processor time of all threads: on a machine that others use too, what the work costs.
double cpu_seconds(const std::function<void()>& work);
/// The least of `times` measurements.
double best_of(int times, double (*clock)(const std::function<void()>&), const std::function<void()>& work);

/// Rays a second of one trace of all `rays`, less the time that one ray takes (hierarchies and bins).
/// `result`, if given, gets the trace.
double rays_per_second(const Scene& scene, const TraceOptions& options, std::uint64_t rays,
                       double (*clock)(const std::function<void()>&), TraceResult* result = nullptr);

/// Embree 3 on the triangles of a height field, one thread. Its shell is vectorised as far as its interface
/// lets it: rays go in packets of 16 in structure-of-arrays form, and reflection and binning use the kernels
/// of our own tracer.
class EmbreeBaseline {
 public:
  /// Builds its hierarchy. The field must outlive it. InputError if the program was built without Embree.
  explicit EmbreeBaseline(const HeightField& field);
  ~EmbreeBaseline();
  EmbreeBaseline(const EmbreeBaseline&) = delete;
  EmbreeBaseline& operator=(const EmbreeBaseline&) = delete;

  static bool available();
  double build_s() const { return build_s_; }
  /// Traces all rays, lifted by `lift_mm`, with at most `bounces` reflections of 0.9; adds what leaves to
  /// `bins` of one degree (360 * 181).
  void trace(const RayBlock& rays, double lift_mm, int bounces, std::span<double> bins) const;

 private:
  struct Device;
  std::unique_ptr<Device> device_;
  double build_s_ = 0.0;
};

/// What `lucerna bench` says of one scene at one size.
struct BenchmarkMetrics {
  std::string scene, isa;
  int cells = 0, threads = 0;
  std::uint64_t rays = 0;
  /// Wall time with all threads; processor time with one.
  double rays_per_s = 0.0, rays_per_cpu_s = 0.0;
  /// Searches for a first hit: one a ray and one after every reflection.
  double casts_per_ray = 0.0;
  /// Evaluating the surface and building all; building the hierarchy again from given heights.
  double build_ms = 0.0, update_ms = 0.0;
  /// Heights with gradients, and the hierarchy beside them.
  double heights_mb = 0.0, hierarchy_mb = 0.0;
  /// Processor time with one thread; absent without Embree.
  std::optional<double> embree_rays_per_cpu_s, embree_build_ms;
};

/// Measures; takes about ten traces' time. Progress is only asked whether to stop (Interrupted).
BenchmarkMetrics run_benchmark(const BenchmarkScene& scene, int cells,
                               const std::shared_ptr<const RaySet>& rays, Progress& progress = no_progress());

}  // namespace lucerna
