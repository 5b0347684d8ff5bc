// SPDX-License-Identifier: Apache-2.0
// Stands in for evaluation_cuda.cu in a build without CUDA, where no accelerator has streams.
#include "lucerna/core/io/error.h"
#include "lucerna/design/evaluation/evaluation_launch.h"

namespace lucerna {

void launch_on_cuda(void*, const EvaluationLaunch<BsplineView>& launch) {
  LUCERNA_CHECK(false, "{} blocks for a CUDA device in a build without", launch.block_count);
}
void launch_on_cuda(void*, const EvaluationLaunch<RevolutionView>& launch) {
  LUCERNA_CHECK(false, "{} blocks for a CUDA device in a build without", launch.block_count);
}

}  // namespace lucerna
