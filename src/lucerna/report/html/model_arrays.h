// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>

#include "lucerna/source_model.h"

namespace lucerna {

/// How the pictures of a model are taken: about a centre, as wide as its light is.
struct ModelExtent {
  Vec3 centre_mm;
  /// Distance from the centre that 95 % of the rays' lines pass within.
  double radius_mm = 1.0;
};

/// From 65536 rays of the model.
ModelExtent model_extent(const SourceModel& model);

/// A model as the flat arrays that assets/model_view.js evaluates without decoding anything. One object:
/// `method unit flux centre_mm radius_mm` (model_extent), `from_deg` (azimuth and height to look from first),
/// `peak` (a colour scale's upper end: luminance that 99 % of the flux stays below) and `probes[{origin
/// direction luminance}]` (rays of the model with the library's own value, for the page to check itself
/// against). adaptive: `layers[{kind polar world_from_support radius_mm half_size_mm twist_per_mm share
/// charts[{chart low high trees[{value link}]}]}]`, nodes in preorder: `link` = offset of the right child * 4
/// + axis, 0 for a leaf, `value` = place of the cut, or the leaf's part of the model's pdf_etendue.
/// clusters: `clusters{leaf_begin code density}` (directional distributions: codes of direction_code,
/// densities per sr) and `pieces{corner density cluster}` (flat triangles: nine coordinates, three densities
/// per mm^2 of all light, three clusters). Nothing if the model has no luminance (rays through one point,
/// along one line, or parallel). O(leaves).
std::optional<nlohmann::ordered_json> model_arrays_json(const SourceModel& model);

}  // namespace lucerna
