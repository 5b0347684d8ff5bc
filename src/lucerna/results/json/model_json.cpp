// SPDX-License-Identifier: Apache-2.0
#include "lucerna/results/json/model_json.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "lucerna/source/adaptive/sampling/adaptive_model.h"
#include "lucerna/source/clusters/cluster_model.h"
#include "lucerna/source/model/model_etendue.h"

namespace lucerna {

namespace {

using Json = nlohmann::ordered_json;

/// Rays whose density gives the étendue: of clusters fewer, whose density is slow.
constexpr std::uint64_t kEtendueRays = 16'384, kClusterEtendueRays = 1024;

Json triple_json(const Vec3& v) { return {v.x, v.y, v.z}; }

/// Sizes that the kind of support has.
Json sizes_json(const Support& s) {
  Json sizes = Json::object();
  if (s.kind == SupportKind::sphere || s.kind == SupportKind::cylinder) sizes["radius_mm"] = s.radius_mm;
  if (s.kind == SupportKind::cylinder) sizes["length_mm"] = 2.0 * s.half_size_mm.z;
  if (s.kind == SupportKind::box) sizes["size_mm"] = triple_json(2.0 * s.half_size_mm);
  if (s.twist_per_mm != 0.0) sizes["twist_rad_per_mm"] = s.twist_per_mm;
  return sizes;
}

Json layer_json(const AdaptiveLayer& layer) {
  std::size_t trees = 0, leaves = 0;
  for (const AdaptiveChart& chart : layer.charts) {
    trees += chart.trees.size();
    for (const DensityTree& tree : chart.trees) leaves += tree.leaves();
  }
  const Support& s = layer.support;
  Json json = {{"support", std::string(to_string(s.kind))},
               {"share", layer.share},
               {"leaves", leaves},
               {"charts", layer.charts.size()},
               {"trees", trees},
               {"position_mm", triple_json(s.world_from_support.origin_mm())},
               {"axis", triple_json(s.world_from_support.ez())},
               {"directions", s.map == PolarMap::polar ? "polar" : "concentric"},
               {"why", layer.why}};
  json.update(sizes_json(s));
  return json;
}

/// What the model knows of colour: bands that differ in place or direction, or spectra that drawn rays name.
void add_wavelengths(const AdaptiveData& data, Json& json) {
  if (!data.spectra.empty()) json["spectra"] = data.spectra.size();
  if (data.wavelengths.empty()) return;
  float min_nm = data.wavelengths.front().nm.front(), max_nm = min_nm;
  for (const WavelengthTable& band : data.wavelengths) {
    min_nm = std::min(min_nm, band.nm.front());
    max_nm = std::max(max_nm, band.nm.back());
  }
  json["wavelengths_nm"] = {{"min", min_nm}, {"max", max_nm}, {"bands", data.wavelengths.size()}};
}

Json etendue_json(const SourceModel& model) {
  const bool clusters = model.method() == "clusters";
  const EtendueCurve curve = etendue_curve(model, clusters ? kClusterEtendueRays : kEtendueRays);
  return {{"p50", curve.at(0.5)}, {"p90", curve.at(0.9)}, {"p99", curve.at(0.99)}};
}

}  // namespace

Json model_json(const SourceModel& model, const std::filesystem::path& path) {
  Json json = {{"path", path.string()},
               {"format", "nfl"},
               {"method", std::string(model.method())},
               {"rays", model.training_rays()},
               {model.flux_unit() == FluxUnit::lumen ? "flux_lm" : "flux_w", model.flux()},
               {"bytes", std::filesystem::file_size(path)},
               {"layers", model.layers()},
               {"leaves", model.leaves()},
               {"warnings", Json::array()}};
  json["etendue_mm2sr"] = etendue_json(model);
  if (const auto* adaptive = dynamic_cast<const AdaptiveModel*>(&model)) {
    json["starting_surface"] = std::string(to_string(adaptive->data().surface.kind));
    json["chosen"] = Json::array();
    for (const AdaptiveLayer& layer : adaptive->data().layers) json["chosen"].push_back(layer_json(layer));
    add_wavelengths(adaptive->data(), json);
  }
  if (const auto* clusters = dynamic_cast<const ClusterModel*>(&model)) {
    json["starting_surface"] = std::string(to_string(clusters->data().surface.kind));
    json["clusters"] = clusters->clusters();
    json["triangles"] = clusters->triangles();
  }
  return json;
}

}  // namespace lucerna
