// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "lucerna/rayset/statistics/etendue_curve.h"
#include "lucerna/source_model.h"

namespace lucerna {

/// The étendue curve of a model from its own density p: `rays` of its rays in the order of falling p, each of
/// which represents 1 / (rays p) of étendue. Noise: about 1 / sqrt(rays) of each value. Degenerate where the
/// model has no étendue. Cost: pdf_etendue of each ray; 16,384 rays of a model of clusters take some seconds.
EtendueCurve etendue_curve(const SourceModel& model, std::uint64_t rays = 16'384, std::uint64_t seed = 1);

/// The same of any source that knows its density: a model, or a source with a luminance (luminance_source.h),
/// which has it within the noise of the rays and in milliseconds. Nothing for others.
std::optional<EtendueCurve> known_etendue_curve(const RaySource& source, std::uint64_t rays = 16'384,
                                                std::uint64_t seed = 1);

/// The curve of a ray set by way of an adaptive model of at most 2^17 of its rays (four trees a chart), whose
/// support follows a coil or a tube, where the tree of rayset/statistics/etendue_curve.h, on one plane, needs
/// far more rays than there are. The model orders phase space by luminance; as many other rays say how much
/// flux each part has, so that noise does not pass for brightness. Throws InputError without rays or flux.
/// Cost: some seconds.
EtendueCurve searched_etendue_curve(const RayBlock& rays);

}  // namespace lucerna
