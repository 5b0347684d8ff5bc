// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/engines/ray_colours.h"

#include <algorithm>

#include "lucerna/rayset/data/luminous_spectrum.h"

namespace lucerna {

RayColours::RayColours(const Scene& scene)
    : are_needed_(std::ranges::any_of(scene.solids, [](const Solid& s) { return s.dispersion != nullptr; })) {
  if (!are_needed_) return;
  for (const PlacedSource& s : scene.sources) {
    Colours& colours = sources_.emplace_back();
    colours.rays = s.rays;
    if (s.spectrum.wavelength_nm.empty()) continue;
    const bool in_lumen = s.rays->flux_unit() == FluxUnit::lumen;
    colours.spectrum.emplace(in_lumen ? luminous_spectrum(s.spectrum) : s.spectrum);
  }
}

void RayColours::emit(std::size_t source, const Sequence& sequence, std::uint64_t first,
                      std::span<float> nm) const {
  const Colours& colours = sources_[source];
  if (!colours.spectrum) return colours.rays->emit_wavelengths(sequence, first, nm);
  for (std::size_t i = 0; i < nm.size(); ++i) nm[i] = colours.spectrum->of_ray(sequence.seed(), first + i);
}

}  // namespace lucerna
