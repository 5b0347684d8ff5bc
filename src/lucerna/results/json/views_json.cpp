// SPDX-License-Identifier: Apache-2.0
#include "lucerna/results/json/views_json.h"

#include <string>
#include <utility>

#include "lucerna/results/json/error_json.h"

namespace lucerna {

namespace {

nlohmann::ordered_json difference_json(const ViewDifference& d) {
  return {{"error", number_json(d.error)},
          {"floor", number_json(d.floor)},
          {"excess", number_json(d.excess)},
          {"standard_error", number_json(d.standard_error)},
          {"raw", number_json(d.raw)}};
}

}  // namespace

nlohmann::ordered_json views_json(const RaySetComparison& comparison) {
  nlohmann::ordered_json views;
  for (const ViewKind kind : kViewKinds)
    views[std::string(to_string(kind))] = difference_json(comparison[kind]);
  return views;
}

nlohmann::ordered_json held_out_json(const HeldOutComparison& found) {
  nlohmann::ordered_json json, scales;
  for (const ScaleDifference& s : found.scales) {
    nlohmann::ordered_json scale = difference_json(s.difference);
    scale["cell_mm"] = number_json(s.cell_mm);
    scales.push_back(std::move(scale));
  }
  json["training_rays"] = found.training_rays;
  json["rays"] = found.held_out_rays;
  json["views"] = views_json(found.views);
  json["scales"] = std::move(scales);
  return json;
}

}  // namespace lucerna
