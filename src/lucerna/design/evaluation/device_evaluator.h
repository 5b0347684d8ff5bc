// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <mutex>

#include "lucerna/design/evaluation/evaluation.h"
#include "lucerna/trace/device/accelerator_buffer.h"

namespace lucerna {

/// Evaluates designs on an accelerator: the rays are copied there once, and those that are added later; a
/// shape's coefficients go there, the bins' sums and the derivatives (8 bytes a bin and coefficient) come
/// back. Memory there: 28 bytes a ray and those sums. Sums are whole numbers, so that the same rays give the
/// same bits from run to run; they differ from the CPU's by the units' rounding (evaluation_launch.h). Thread
/// safe: evaluations wait for one another. Errors of the device are InputErrors that name it.
class DeviceEvaluator {
 public:
  explicit DeviceEvaluator(std::shared_ptr<Accelerator> accelerator) : accelerator_(std::move(accelerator)) {}

  const Accelerator& accelerator() const { return *accelerator_; }

  /// As `evaluate`; always with the same rays, which only ever grow.
  Evaluation evaluate(const DesignShape& shape, const Reflectance& reflectance, const DesignRays& rays,
                      const TentBins& bins, const EvaluationOptions& options);

 private:
  void copy_rays(const DesignRays& rays);
  template <class Shape>
  Evaluation evaluate_family(const DesignShape& design, const Shape& shape, const Reflectance& reflectance,
                             const TentBins& bins, const EvaluationOptions& options);
  /// Room for `n` numbers, as large as it ever had to be.
  template <class T>
  T* room(AcceleratorBuffer& buffer, std::size_t n, bool on_host = false);

  std::shared_ptr<Accelerator> accelerator_;
  std::mutex mutex_;
  AcceleratorBuffer rays_, near_curvatures_, coefficients_, reflectance_, totals_, host_totals_;
  std::uint64_t blocks_ = 0;
};

}  // namespace lucerna
