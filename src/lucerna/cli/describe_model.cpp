// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <filesystem>

#include "lucerna/cli/describe.h"
#include "lucerna/source/adaptive_model.h"
#include "lucerna/source/cluster_model.h"
#include "lucerna/source/model_etendue.h"
#include "lucerna/source_model.h"

namespace lucerna::cli {

namespace {

/// Rays whose density gives the étendue: of clusters fewer, whose density is slow.
constexpr std::uint64_t kEtendueRays = 16'384, kClusterEtendueRays = 1024;

Json vector_json(const Vec3& v) { return {v.x, v.y, v.z}; }

std::string vector_text(const Vec3& v) { return fmt::format("({:.4g}, {:.4g}, {:.4g})", v.x, v.y, v.z); }

/// Sizes that the kind of support has, as JSON and as words.
struct Sizes {
  Json json = Json::object();
  std::string text;
};

Sizes sizes_of(const Support& s) {
  Sizes sizes;
  const auto add = [&](const char* key, const char* words, double value, const char* unit) {
    sizes.json[key] = value;
    sizes.text += fmt::format(", {} {:.4g} {}", words, value, unit);
  };
  if (s.kind == SupportKind::sphere || s.kind == SupportKind::cylinder)
    add("radius_mm", "radius", s.radius_mm, "mm");
  if (s.kind == SupportKind::cylinder) add("length_mm", "length", 2.0 * s.half_size_mm.z, "mm");
  if (s.kind == SupportKind::box) {
    sizes.json["size_mm"] = vector_json(2.0 * s.half_size_mm);
    sizes.text += fmt::format(", size {} mm", vector_text(2.0 * s.half_size_mm));
  }
  if (s.twist_per_mm != 0.0) add("twist_rad_per_mm", "twist", s.twist_per_mm, "rad/mm");
  return sizes;
}

struct Count {
  std::size_t trees = 0, leaves = 0;
};

Count count_of(const AdaptiveLayer& layer) {
  Count n;
  for (const AdaptiveChart& chart : layer.charts) {
    n.trees += chart.trees.size();
    for (const DensityTree& tree : chart.trees) n.leaves += tree.leaves();
  }
  return n;
}

void describe_adaptive(const AdaptiveModel& model, Description& d) {
  const AdaptiveData& data = model.data();
  d.json["starting_surface"] = std::string(to_string(data.surface.kind));
  d.lines.push_back(data.surface.kind == SurfaceKind::none
                        ? std::string("  rays start          on the supports")
                        : fmt::format("  rays start          on a {}", to_string(data.surface.kind)));
  Json chosen = Json::array();
  for (std::size_t i = 0; i < data.layers.size(); ++i) {
    const AdaptiveLayer& layer = data.layers[i];
    const Support& s = layer.support;
    const Count n = count_of(layer);
    const Sizes sizes = sizes_of(s);
    const char* map = s.map == PolarMap::polar ? "polar" : "concentric";
    const Vec3 at = s.world_from_support.origin_mm(), axis = s.world_from_support.ez();
    Json entry = {{"support", std::string(to_string(s.kind))},
                  {"share", layer.share},
                  {"leaves", n.leaves},
                  {"charts", layer.charts.size()},
                  {"trees", n.trees},
                  {"position_mm", vector_json(at)},
                  {"axis", vector_json(axis)},
                  {"directions", map},
                  {"why", layer.why}};
    entry.update(sizes.json);
    chosen.push_back(std::move(entry));
    d.lines.push_back(fmt::format("  layer {:<14}{} at {} mm, axis {}{}; directions {}", i + 1,
                                  to_string(s.kind), vector_text(at), vector_text(axis), sizes.text, map));
    d.lines.push_back(fmt::format("{:22}{:.3f} % of the flux, {} leaves in {} trees of {} chart(s)", "",
                                  100.0 * layer.share, n.leaves, n.trees, layer.charts.size()));
    if (!layer.why.empty()) d.lines.push_back(fmt::format("{:22}why: {}", "", layer.why));
  }
  d.json["chosen"] = std::move(chosen);
}

void describe_clusters(const ClusterModel& model, Description& d) {
  d.json["starting_surface"] = std::string(to_string(model.data().surface.kind));
  d.json["clusters"] = model.clusters();
  d.json["triangles"] = model.triangles();
  d.lines.push_back(fmt::format("  rays start          on a {}", to_string(model.data().surface.kind)));
  d.lines.push_back(fmt::format("  clusters            {}, in a mesh of {} triangles", model.clusters(),
                                model.triangles()));
}

void describe_etendue(const SourceModel& model, Description& d) {
  const bool clusters = model.method() == "clusters";
  const EtendueCurve curve = etendue_curve(model, clusters ? kClusterEtendueRays : kEtendueRays);
  const double p50 = curve.at(0.5), p90 = curve.at(0.9), p99 = curve.at(0.99);
  d.json["etendue_mm2sr"] = {{"p50", p50}, {"p90", p90}, {"p99", p99}};
  d.lines.push_back(fmt::format(
      "  etendue (mm2 sr)    {:.4g} / {:.4g} / {:.4g} for the brightest 50 / 90 / 99 % of the flux", p50, p90,
      p99));
}

}  // namespace

Description describe_model(const std::string& path) {
  const auto model = load_source_model(path);
  const auto bytes = std::filesystem::file_size(path);
  const bool lumen = model->flux_unit() == FluxUnit::lumen;
  Description d;
  d.json = {{"path", path},
            {"format", "nfl"},
            {"method", std::string(model->method())},
            {"rays", model->training_rays()},
            {lumen ? "flux_lm" : "flux_w", model->flux()},
            {"bytes", bytes},
            {"layers", model->layers()},
            {"leaves", model->leaves()},
            {"warnings", Json::array()}};
  d.lines = {
      fmt::format("  format              source model (.nfl), method {}, {} bytes", model->method(), bytes),
      fmt::format("  made from           {} rays", model->training_rays()),
      fmt::format("  flux                {:.6g} {}", model->flux(), symbol(model->flux_unit())),
      fmt::format("  size                {} layer(s), {} leaves", model->layers(), model->leaves())};
  describe_etendue(*model, d);
  if (const auto* adaptive = dynamic_cast<const AdaptiveModel*>(model.get())) describe_adaptive(*adaptive, d);
  if (const auto* clusters = dynamic_cast<const ClusterModel*>(model.get())) describe_clusters(*clusters, d);
  return d;
}

}  // namespace lucerna::cli
