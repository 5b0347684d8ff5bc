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
    const SpectralTable* const spectrum = s.drawn_spectrum();
    if (spectrum == nullptr) continue;
    const bool in_lumen = s.rays->flux_unit() == FluxUnit::lumen;
    colours.spectrum.emplace(in_lumen ? luminous_spectrum(*spectrum) : *spectrum);
  }
}

void RayColours::emit(std::size_t source, const Sequence& sequence, std::uint64_t first,
                      std::span<float> nm) const {
  if (!are_needed_) {
    std::ranges::fill(nm, 0.0F);
    return;
  }
  const Colours& colours = sources_[source];
  if (!colours.spectrum) return colours.rays->emit_wavelengths(sequence, first, nm);
  // Slope errors, glasses and lobes have the streams from 0x10000 to 0x3ffff.
  for (std::size_t i = 0; i < nm.size(); ++i)
    nm[i] = colours.spectrum->wavelength_nm(Rng(sequence.seed(), first + i, 0x40000U).uniform());
}

}  // namespace lucerna
