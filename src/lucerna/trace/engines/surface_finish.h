// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "lucerna/scene.h"
#include "lucerna/trace/kernels/measured_scatter.h"
#include "lucerna/trace/kernels/scatter_kernel.h"

namespace lucerna {

/// Of a mirror or a body, which must outlive it.
template <class Mirror>
SurfaceFinish finish_of(const Mirror& mirror) {
  const auto& lobes = mirror.scatter.lobes();
  const MeasuredScatter* const measured = mirror.scatter.measured();
  return {1e-3 * mirror.slope_error_mrad, lobes.data(), static_cast<std::uint32_t>(lobes.size()),
          measured != nullptr ? &measured->view() : nullptr};
}

/// Does chance decide where a reflection there goes?
inline bool is_rough(const SurfaceFinish& finish) {
  return finish.slope_error_rad > 0.0 || finish.scatters();
}

}  // namespace lucerna
