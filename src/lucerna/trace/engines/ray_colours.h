// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "lucerna/random.h"
#include "lucerna/rayset/data/spectrum_sampler.h"
#include "lucerna/scene.h"

namespace lucerna {

/// The wavelengths of a scene's rays, which solids that disperse ask for. Immutable and thread safe.
class RayColours {
 public:
  /// `scene` as `check` has it.
  explicit RayColours(const Scene& scene);

  /// Does anything in the scene ask for wavelengths?
  bool are_needed() const { return are_needed_; }

  /// Sets those of rays `first` .. `first + nm.size() - 1` of the stream of a source, by its number: drawn
  /// from its spectrum, else its own. 0 (not known) where they are not needed.
  void emit(std::size_t source, const Sequence& sequence, std::uint64_t first, std::span<float> nm) const;

 private:
  struct Colours {
    std::shared_ptr<const RaySource> rays;
    std::optional<SpectrumSampler> spectrum;
  };
  bool are_needed_ = false;
  std::vector<Colours> sources_;
};

}  // namespace lucerna
