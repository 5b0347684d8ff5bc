// SPDX-License-Identifier: Apache-2.0
#include "lucerna/report/html/model_arrays.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <vector>

#include "lucerna/core/io/error.h"
#include "lucerna/ray_statistics.h"
#include "lucerna/report/html/html_text.h"
#include "lucerna/source/adaptive/sampling/adaptive_model.h"
#include "lucerna/source/clusters/cluster_model.h"
#include "lucerna/source/emitters/draw_rays.h"

namespace lucerna {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kExtentRays = 1 << 16, kPeakRays = 4096, kProbes = 24;
constexpr double kSquareMmPerSquareM = 1e6;

Json vec_json(const Vec3& v) { return {v.x, v.y, v.z}; }

Json frame_json(const Frame& f) {
  Json columns = Json::array();
  for (const Vec3& v : {f.ex(), f.ey(), f.ez(), f.origin_mm()}) {
    for (const double x : {v.x, v.y, v.z}) columns.push_back(x);
  }
  return columns;
}

Json tree_json(const TreeLookup& tree, double share) {
  std::vector<double> value;
  std::vector<std::uint32_t> link;
  for (const TreeLookup::Node& node : tree.nodes()) {
    value.push_back(node.right == 0 ? share * node.value : node.value);
    link.push_back(node.right * 4 + node.axis);
  }
  return {{"value", base64_floats(value)}, {"link", base64_counts(link)}};
}

Json layers_json(const AdaptiveData& data) {
  Json layers = Json::array();
  double total = 0.0;
  for (const AdaptiveLayer& layer : data.layers) {
    for (const AdaptiveChart& chart : layer.charts) total += layer.share * chart.share;
  }
  for (const AdaptiveLayer& layer : data.layers) {
    const Support& s = layer.support;
    Json charts = Json::array();
    for (const AdaptiveChart& chart : layer.charts) {
      const double share = layer.share * chart.share / total / static_cast<double>(chart.trees.size());
      Json trees = Json::array();
      for (const DensityTree& tree : chart.trees)
        trees.push_back(tree_json(TreeLookup(tree, chart.box), share));
      charts.push_back({{"chart", chart.chart},
                        {"low", chart.box.low},
                        {"high", chart.box.high},
                        {"trees", std::move(trees)}});
    }
    layers.push_back({{"kind", std::string(to_string(s.kind))},
                      {"polar", s.map == PolarMap::polar},
                      {"world_from_support", frame_json(s.world_from_support)},
                      {"radius_mm", s.radius_mm},
                      {"half_size_mm", vec_json(s.half_size_mm)},
                      {"twist_per_mm", s.twist_per_mm},
                      {"share", layer.share},
                      {"charts", std::move(charts)}});
  }
  return layers;
}

/// Directional densities of all clusters, 1/sr.
Json directions_json(const ClusterData& data) {
  std::vector<std::uint32_t> code;
  std::vector<double> density;
  for (std::size_t v = 0; v < data.clusters(); ++v) {
    double sum = 0.0;
    for (std::uint32_t i = data.leaf_begin[v]; i < data.leaf_begin[v + 1]; ++i)
      sum += relative_weight_of(data.leaf[i].level);
    for (std::uint32_t i = data.leaf_begin[v]; i < data.leaf_begin[v + 1]; ++i) {
      const ClusterLeaf& leaf = data.leaf[i];
      code.push_back(leaf.code);
      density.push_back(relative_weight_of(leaf.level) / sum /
                        direction_triangle(leaf.code, leaf.depth).solid_angle_sr());
    }
  }
  return {{"leaf_begin", base64_counts(data.leaf_begin)},
          {"code", base64_counts(code)},
          {"density", base64_floats(density)}};
}

/// Distinct corners of an element: 3 for a triangle, 2 for a segment, 1 for a point.
std::size_t corners(const Triangle& t) { return t[0] == t[1] ? 1 : t[1] == t[2] ? 2 : 3; }

/// Triangles with their share of the flux per mm^2.
Json pieces_json(const ClusterData& data) {
  const std::vector<MeshPiece> pieces = mesh_pieces(data);
  double total = 0.0;
  for (const MeshPiece& p : pieces) {
    const std::size_t n = corners(data.elements[p.element]);
    for (std::size_t k = 0; k < n; ++k) total += p.measure * p.density[k] / static_cast<double>(n);
  }
  std::vector<double> corner, density;
  std::vector<std::uint32_t> cluster;
  for (const MeshPiece& p : pieces) {
    if (corners(data.elements[p.element]) != 3) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      corner.insert(corner.end(), {p.corner_mm[k].x, p.corner_mm[k].y, p.corner_mm[k].z});
      density.push_back(p.density[k] / total);
      cluster.push_back(data.elements[p.element][k]);
    }
  }
  std::vector<double> place;
  for (std::size_t v = 0; v < data.clusters(); ++v) {
    const Vec3 p = data.point_mm(v);
    place.insert(place.end(), {p.x, p.y, p.z});
  }
  return {{"corner", base64_floats(corner)},
          {"density", base64_floats(density)},
          {"cluster", base64_counts(cluster)},
          {"place", base64_floats(place)}};
}

double luminance(const SourceModel& model, const Ray& ray) {
  return kSquareMmPerSquareM * model.flux() * model.pdf_etendue(ray);
}

/// The luminance that 99 % of the flux stays below.
double peak_luminance(const SourceModel& model, const RayBlock& rays) {
  std::vector<double> values;
  for (std::size_t i = 0; i < std::min(kPeakRays, rays.size()); ++i) {
    const double l = luminance(model, rays.ray(i));
    if (std::isfinite(l)) values.push_back(l);
  }
  if (values.empty()) return 0.0;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

Json probes_json(const SourceModel& model, const RayBlock& rays) {
  Json probes = Json::array();
  for (std::size_t i = 0; i < std::min(kProbes, rays.size()); ++i) {
    const Ray ray = rays.ray(i);
    const double l = luminance(model, ray);
    if (!std::isfinite(l)) continue;
    probes.push_back({{"origin", vec_json(ray.origin_mm)},
                      {"direction", vec_json(ray.direction.vec())},
                      {"luminance", l}});
  }
  return probes;
}

/// Azimuth and height in degrees from where the light's brighter side is seen; from aside if it goes
/// everywhere.
Json first_direction(const Vec3& mean) {
  if (length(mean) < 0.2) return {-60, 20};
  const double height = degrees(std::atan2(mean.z, std::hypot(mean.x, mean.y)));
  const double azimuth = std::hypot(mean.x, mean.y) < 1e-2 ? 0.0 : degrees(std::atan2(mean.y, mean.x));
  return {std::lround(azimuth), std::lround(std::abs(height) > 85.0 ? std::copysign(90.0, height) : height)};
}

}  // namespace

ModelExtent model_extent(const SourceModel& model) {
  const RayBlock rays = draw_rays(model, Sequence(SequenceKind::sobol, 1), kExtentRays);
  const RaySummary summary = summarize(rays);
  ModelExtent extent;
  if (summary.virtual_focus) extent.centre_mm = summary.virtual_focus->point_mm;
  std::vector<double> beside(rays.size());
  for (std::size_t i = 0; i < rays.size(); ++i)
    beside[i] = length(cross(rays.origin_mm(i) - extent.centre_mm, rays.direction(i).vec()));
  const auto at = beside.begin() + static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(beside.size()));
  std::nth_element(beside.begin(), at, beside.end());
  extent.radius_mm = std::max(1e-6, *at);
  return extent;
}

std::optional<Json> model_arrays_json(const SourceModel& model) {
  const auto* adaptive = dynamic_cast<const AdaptiveModel*>(&model);
  const auto* clusters = dynamic_cast<const ClusterModel*>(&model);
  LUCERNA_CHECK(adaptive != nullptr || clusters != nullptr, "a model of method {}", model.method());
  if (adaptive != nullptr ? !adaptive->has_etendue() : !clusters->data().surface.has_area())
    return std::nullopt;
  const ModelExtent extent = model_extent(model);
  const RayBlock rays = draw_rays(model, Sequence(SequenceKind::sobol, 2), kPeakRays);
  Json json{{"method", std::string(model.method())},
            {"unit", model.flux_unit() == FluxUnit::lumen ? "cd/m²" : "W/(m² sr)"},
            {"flux", model.flux()},
            {"centre_mm", vec_json(extent.centre_mm)},
            {"radius_mm", extent.radius_mm},
            {"from_deg", first_direction(*summarize(rays).mean_direction)},
            {"peak", peak_luminance(model, rays)},
            {"probes", probes_json(model, rays)}};
  if (adaptive != nullptr) {
    json["layers"] = layers_json(adaptive->data());
  } else {
    json["clusters"] = directions_json(clusters->data());
    json["pieces"] = pieces_json(clusters->data());
  }
  return json;
}

}  // namespace lucerna
