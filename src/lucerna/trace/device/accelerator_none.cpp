// SPDX-License-Identifier: Apache-2.0
// Stands in for cuda/accelerator_cuda.cu in a build without CUDA.
#include "lucerna/trace/device/accelerator.h"

namespace lucerna {

std::vector<std::unique_ptr<Accelerator>> cuda_accelerators() { return {}; }
std::string cuda_unavailable_reason() { return "this program was built without CUDA"; }

}  // namespace lucerna
