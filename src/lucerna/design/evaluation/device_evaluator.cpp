// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/evaluation/device_evaluator.h"

#include <variant>

#include "lucerna/design/evaluation/evaluation_launch.h"
#include "lucerna/design/evaluation/evaluation_sums.h"
#include "lucerna/trace/tally/flux_quanta.h"

namespace lucerna {

namespace {

template <class Shape>
void run(Accelerator& accelerator, const EvaluationLaunch<Shape>& launch) {
  if (void* const stream = accelerator.native_stream(0)) return launch_on_cuda(stream, launch);
  Path<Shape> path;
  for (std::uint32_t block = 0; block < launch.block_count; ++block) {
    EvaluationThread thread = evaluation_thread(launch.totals, block);
    for (std::size_t k = 0; k < kBlockRays; ++k) evaluate_ray(launch, block, k, path, thread);
    for (int i = 0; i < kEvaluationEnds; ++i) atomic_add(launch.totals.ends + i, thread.ends[i]);
  }
}

std::vector<double> in_rays(const std::int64_t* units, std::size_t n, double per) {
  std::vector<double> out(n);
  for (std::size_t i = 0; i < n; ++i) out[i] = static_cast<double>(units[i]) / per;
  return out;
}

}  // namespace

template <class T>
T* DeviceEvaluator::room(AcceleratorBuffer& buffer, std::size_t n, bool on_host) {
  if (buffer.bytes() < n * sizeof(T)) buffer = AcceleratorBuffer(*accelerator_, n * sizeof(T), on_host);
  return buffer.as<T>();
}

void DeviceEvaluator::copy_rays(const DesignRays& rays) {
  const std::uint64_t blocks = rays.size() / kBlockRays;
  if (blocks == blocks_) return;
  auto* const there = room<DesignRayBlock>(rays_, blocks);
  accelerator_->upload(0, there, &rays.block(0), blocks * sizeof(DesignRayBlock));
  accelerator_->wait(0);
  blocks_ = blocks;
}

template <class Shape>
Evaluation DeviceEvaluator::evaluate_family(const DesignShape& design, const Shape& shape,
                                            const Reflectance& reflectance, const TentBins& bins,
                                            const EvaluationOptions& options) {
  Accelerator& a = *accelerator_;
  const std::size_t n = bins.size(), m = shape.coefficients().size();
  const std::size_t derivatives = options.derivatives ? n * m : 0;
  const std::size_t total = kDesignStreams * n + kEvaluationEnds + derivatives;
  EvaluationLaunch<decltype(shape.view())> launch{
      evaluation_view(shape, design.aperture(), reflectance, bins, options)};
  auto* const c = room<double>(coefficients_, m);
  a.upload(0, c, shape.coefficients().data(), m * sizeof(double));
  launch.view.shape.coefficients = c;
  auto* const near = room<double>(near_curvatures_, shape.near_curvatures().size());
  a.upload(0, near, shape.near_curvatures().data(), shape.near_curvatures().size() * sizeof(double));
  launch.view.shape.near_curvatures = near;
  auto* const table = room<ReflectanceEntry>(reflectance_, reflectance.table().size());
  a.upload(0, table, reflectance.table().data(), reflectance.table().size() * sizeof(ReflectanceEntry));
  launch.view.reflectance = table;
  auto* const totals = room<std::int64_t>(totals_, total);
  a.fill(0, totals, 0, total * sizeof(std::int64_t));
  launch.totals = {totals, totals + kDesignStreams * n, totals + kDesignStreams * n + kEvaluationEnds,
                   static_cast<std::int32_t>(n), static_cast<std::int32_t>(m)};
  launch.blocks = rays_.as<DesignRayBlock>();
  launch.block_count = static_cast<std::uint32_t>(options.rays / kBlockRays / kDesignTasks * kDesignTasks);
  run(a, launch);
  auto* const back = room<std::int64_t>(host_totals_, total, true);
  a.download(0, back, totals, total * sizeof(std::int64_t));
  a.wait(0);

  EvaluationSums sums;
  for (std::size_t s = 0; s < kDesignStreams; ++s) sums.flux[s] = in_rays(back + s * n, n, kQuantaPerRay);
  const std::vector<double> ends = in_rays(back + kDesignStreams * n, kEvaluationEnds, kQuantaPerRay);
  const auto of = [&](PathEnd end) { return ends[static_cast<std::size_t>(end)]; };
  sums.direct = of(PathEnd::direct), sums.reflected = of(PathEnd::reflected);
  sums.back = of(PathEnd::back), sums.lost = of(PathEnd::lost), sums.absorbed = ends.back();
  for (const double end : ends) sums.weight += end;
  Evaluation e = evaluation_of(sums);
  e.rays = std::uint64_t{launch.block_count} * kBlockRays;
  if (options.derivatives) {
    e.jacobian =
        fold_jacobians({in_rays(back + kDesignStreams * n + kEvaluationEnds, derivatives, kDerivativeUnits)},
                       n, design, 1.0 / sums.weight);
  }
  return e;
}

Evaluation DeviceEvaluator::evaluate(const DesignShape& shape, const Reflectance& reflectance,
                                     const DesignRays& rays, const TentBins& bins,
                                     const EvaluationOptions& options) {
  const std::scoped_lock lock(mutex_);
  copy_rays(rays);
  return std::visit([&](const auto& s) { return evaluate_family(shape, s, reflectance, bins, options); },
                    shape.family());
}

}  // namespace lucerna
