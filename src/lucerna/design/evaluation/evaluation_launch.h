// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>

#include "lucerna/core/parallel/atomic_add.h"
#include "lucerna/design/evaluation/design_ray_block.h"
#include "lucerna/design/evaluation/evaluation_kernel.h"
#include "lucerna/trace/device/accelerator.h"
#include "lucerna/trace/tally/flux_quanta.h"

namespace lucerna {

// An evaluation in an accelerator's memory. All sums are whole numbers, so they do not depend on the order in
// which threads add: flux in units of trace/tally/flux_quanta.h, derivatives in units of 2^-20 of a mean ray
// per mm.

inline constexpr double kDerivativeUnits = 0x1p20;
/// One derivative of one ray is held to +-2^50 units, a thousand million mean rays per mm, which only rays
/// that graze the mirror reach: the sum of 2^13 such rays still fits.
inline constexpr double kMaxDerivative = 0x1p50;

/// PathEnd by PathEnd, then what the mirror absorbed.
inline constexpr int kEvaluationEnds = 5;

/// Where the sums go; zero before the launch.
struct EvaluationTotals {
  std::int64_t* flux = nullptr;        ///< kDesignStreams x bins
  std::int64_t* ends = nullptr;        ///< kEvaluationEnds
  std::int64_t* derivative = nullptr;  ///< bins x coefficients
  std::int32_t bins = 0, coefficients = 0;
};

/// What EvaluationView::trace adds to, of one thread.
struct EvaluationThread {
  EvaluationTotals totals;
  std::int64_t* flux = nullptr;  ///< of the rays' stream
  std::int64_t ends[kEvaluationEnds] = {};

  LUCERNA_HD static std::int64_t whole(double x) { return static_cast<std::int64_t>(std::floor(x + 0.5)); }
  LUCERNA_HD void ended(PathEnd end, double reflected_flux, double absorbed) {
    ends[static_cast<int>(end)] += whole(reflected_flux * kQuantaPerRay);
    ends[kEvaluationEnds - 1] += whole(absorbed * kQuantaPerRay);
  }
  LUCERNA_HD void add(int bin, double x) { atomic_add(flux + bin, whole(x * kQuantaPerRay)); }
  struct Row {
    std::int64_t* at;
    LUCERNA_HD void add(int coefficient, double x) const {
      double u = x * kDerivativeUnits;
      u = u < kMaxDerivative ? u : kMaxDerivative;
      u = u > -kMaxDerivative ? u : -kMaxDerivative;
      atomic_add(at + coefficient, whole(u));
    }
  };
  LUCERNA_HD Row row(int bin) const {
    return {totals.derivative + static_cast<std::int64_t>(bin) * totals.coefficients};
  }
};

/// The first `block_count` blocks of rays.
template <class Shape>
struct EvaluationLaunch {
  EvaluationView<Shape> view;
  const DesignRayBlock* blocks = nullptr;
  std::uint32_t block_count = 0;
  EvaluationTotals totals;
};

/// Ray k of a block.
template <class Shape>
LUCERNA_HD void evaluate_ray(const EvaluationLaunch<Shape>& launch, std::uint32_t block, std::size_t k,
                             Path<Shape>& path, EvaluationThread& thread) {
  const DesignRayBlock& b = launch.blocks[block];
  launch.view.trace({b.x_mm[k], b.y_mm[k], b.z_mm[k]}, {b.kx[k], b.ky[k], b.kz[k]},
                    static_cast<double>(b.weight[k]), path, thread);
}

LUCERNA_HD inline EvaluationThread evaluation_thread(const EvaluationTotals& totals, std::uint32_t block) {
  EvaluationThread thread;
  thread.totals = totals;
  thread.flux = totals.flux + static_cast<std::int64_t>(block % kDesignStreams) * totals.bins;
  return thread;
}

/// On a CUDA device: into `stream`, a cudaStream_t. Only in builds with CUDA.
void launch_on_cuda(void* stream, const EvaluationLaunch<BsplineView>& launch);
void launch_on_cuda(void* stream, const EvaluationLaunch<RevolutionView>& launch);

}  // namespace lucerna
