// SPDX-License-Identifier: Apache-2.0
// Evaluations of designs on CUDA devices. What a thread does is in evaluation_launch.h and
// evaluation_kernel.h.
#include <cuda_runtime.h>

#include "lucerna/design/evaluation/evaluation_launch.h"
#include "lucerna/trace/device/accelerator_error.h"
#include "lucerna/trace/device/block_sums.cuh"
#include "lucerna/trace/tally/flux_quanta.h"

namespace lucerna {

namespace {

/// Threads of a block; each follows kBlockRays / kThreads rays of one block of rays.
constexpr unsigned kThreads = 128;
static_assert(kBlockRays % kThreads == 0);

template <class Shape>
__global__ void __launch_bounds__(kThreads)
    evaluation_kernel(const __grid_constant__ EvaluationLaunch<Shape> launch) {
  EvaluationThread thread = evaluation_thread(launch.totals, blockIdx.x);
  Path<Shape> path;
  for (std::uint32_t k = threadIdx.x; k < kBlockRays; k += kThreads) {
    evaluate_ray(launch, blockIdx.x, k, path, thread);
  }
  add_block_sums(thread.ends, kEvaluationEnds, launch.totals.ends);
}

template <class Shape>
void launch_kernel(void* stream, const EvaluationLaunch<Shape>& launch) {
  if (launch.block_count == 0) return;
  evaluation_kernel<<<launch.block_count, kThreads, 0, static_cast<cudaStream_t>(stream)>>>(launch);
  const cudaError_t code = cudaGetLastError();
  if (code != cudaSuccess) throw_accelerator_error("CUDA device", cudaGetErrorString(code));
}

}  // namespace

void launch_on_cuda(void* stream, const EvaluationLaunch<BsplineView>& launch) {
  launch_kernel(stream, launch);
}
void launch_on_cuda(void* stream, const EvaluationLaunch<RevolutionView>& launch) {
  launch_kernel(stream, launch);
}

}  // namespace lucerna
