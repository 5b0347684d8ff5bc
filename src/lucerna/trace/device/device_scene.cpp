// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/device/device_scene.h"

#include <algorithm>
#include <type_traits>

#include "lucerna/core/io/error.h"
#include "lucerna/source/adaptive/sampling/adaptive_model.h"
#include "lucerna/source/clusters/cluster_model.h"
#include "lucerna/trace/detectors/far_field_grid.h"
#include "lucerna/trace/detectors/plane_bins.h"
#include "lucerna/trace/engines/body_tracer.h"
#include "lucerna/trace/engines/glass_tracer.h"
#include "lucerna/trace/kernels/curve_view.h"
#include "lucerna/trace/kernels/facet_mirror.h"
#include "lucerna/trace/kernels/field_view.h"
#include "lucerna/trace/kernels/triangle_bvh.h"
#include "lucerna/trace/tally/flux_quanta.h"

namespace lucerna {

namespace {

/// Whoever adds something to a scene meets a compiler error here, and teaches it to the kernels.
[[maybe_unused]] void name_all_parts(const Scene& scene) {
  [[maybe_unused]] const auto& [sources, mirrors, far_fields, planes, luminances, rays, bodies, glasses,
                                solids] = scene;
  for (const PlacedReflector& placed : mirrors) {
    [[maybe_unused]] const auto& [reflector, frame, reflectance, slope_error_mrad, scatter] = placed;
    [[maybe_unused]] const auto& [surface, aperture, curve] = reflector;
  }
  for (const Body& body : bodies) {
    [[maybe_unused]] const auto& [name, mesh, frame, reflectance, only_returning, smooth_deg, slope,
                                  scatter] = body;
  }
  for (const CoverGlass& glass : glasses) {
    [[maybe_unused]] const auto& [name, aperture, thickness_mm, index, absorption, frame] = glass;
  }
}

/// Does ray_from_chart know all that this support has? What it does not know is drawn on the CPU and sent.
bool device_draws(const Support& support) {
  // Whoever adds something to a support meets a compiler error here.
  [[maybe_unused]] const auto& [kind, map, frame, radius_mm, half_size_mm, twist_per_mm, dome] = support;
  return true;
}

bool device_draws(const AdaptiveView& model) {
  return std::all_of(model.places, model.places + model.place_count,
                     [](const SamplerPlace& place) { return device_draws(place.support); });
}

}  // namespace

template <class T>
const T* DeviceScene::put(const T* data, std::size_t n) {
  static_assert(std::is_trivially_copyable_v<T>);
  const std::size_t bytes = std::max<std::size_t>(n, 1) * sizeof(T);
  buffers_.emplace_back(accelerator_, bytes);
  if (n > 0) accelerator_.upload(0, buffers_.back().as<void>(), data, n * sizeof(T));
  // The caller's array may go; nothing may still be reading it.
  accelerator_.wait(0);
  return buffers_.back().as<const T>();
}

DeviceScene::DeviceScene(Accelerator& accelerator, const Scene& scene, const RayNumbering& numbering,
                         const TraceOptions& options)
    : accelerator_(accelerator) {
  if (!scene.solids.empty()) {
    throw InputError(fmt::format("solid '{}': solids are traced on the CPU only, expected no device",
                                 scene.solids.front().name),
                     ErrorCause::unsupported, "device");
  }
  for (std::size_t s = 0; s < scene.sources.size(); ++s) {
    sources_.push_back(source_view(scene.sources[s], numbering.ray_flux(s)));
    has_sent_ = has_sent_ || is_sent(s);
  }
  for (const PlacedReflector& r : scene.reflectors) add_mirror(r, options.cells);
  view_.sequence = options.sequence;
  view_.max_bounces = options.max_bounces;
  view_.sources = put(sources_.data(), sources_.size());
  view_.mirror_count = static_cast<std::int32_t>(mirrors_.size());
  device_mirrors_ = const_cast<MirrorView*>(put(mirrors_.data(), mirrors_.size()));
  view_.mirrors = device_mirrors_;
  add_bodies(scene);
  add_glasses(scene);
  add_detectors(scene);
}

template <class Mirror>
SurfaceFinish DeviceScene::put_finish(const Mirror& mirror) {
  SurfaceFinish finish = finish_of(mirror);
  finish.lobes = put(finish.lobes, finish.lobe_count);
  if (finish.measured != nullptr) {
    BsdfView m = *finish.measured;
    const auto size = [](std::int32_t n) { return static_cast<std::size_t>(n); };
    const std::size_t rows = size(m.incidences) * size(m.azimuths);
    m.brdf = put(m.brdf, rows * size(m.radials));
    m.sums = put(m.sums, size(m.incidences) * size(m.cells()));
    m.incidence = put(m.incidence, size(m.incidences));
    m.azimuth = put(m.azimuth, size(m.azimuths));
    m.radial = put(m.radial, size(m.radials));
    finish.measured = put(&m, 1);
  }
  return finish;
}

void DeviceScene::add_bodies(const Scene& scene) {
  if (scene.bodies.empty()) return;
  std::vector<BodyView> bodies;
  bool lamps = false;
  for (const Body& body : scene.bodies) {
    lamps = lamps || body.only_returning_light;
    const auto& table = body.reflectance.table();
    const std::vector<Vec3> corners = smooth_normals(body);
    bodies.push_back({put(table.data(), table.size()), static_cast<std::uint32_t>(table.size()),
                      put_finish(body), corners.empty() ? nullptr : put(corners.data(), corners.size())});
  }
  const auto tree = [&](bool returning) {
    const TriangleBvh made(scene.bodies, returning);
    TriangleBvhView v = made.view();
    v.nodes = put(v.nodes, made.nodes().size());
    v.triangles = put(v.triangles, made.triangles().size());
    return v;
  };
  view_.bodies.returning = tree(true);
  view_.bodies.direct = lamps ? tree(false) : view_.bodies.returning;
  view_.bodies.bodies = put(bodies.data(), bodies.size());
  view_.bodies.count = bodies.size();
  view_.features |= kObstacles;
}

void DeviceScene::add_glasses(const Scene& scene) {
  if (scene.glasses.empty()) return;
  const GlassTracer glasses(scene.glasses);
  view_.cover_glasses = put(glasses.cover_glasses().data(), glasses.cover_glasses().size());
  view_.cover_glass_count = glasses.cover_glasses().size();
  view_.features |= kObstacles;
}

SourceView DeviceScene::source_view(const PlacedSource& source, double ray_flux) {
  SourceView v;
  v.world_from_source = view_of(source.world_from_source);
  v.ray_flux = ray_flux;
  const auto* const model = dynamic_cast<const AdaptiveModel*>(source.rays.get());
  if (model != nullptr && device_draws(model->view())) {
    AdaptiveView a = model->view();
    a.leaves = put(a.leaves, a.leaf_count);
    a.guide = put(a.guide, a.guide_count);
    a.places = put(a.places, a.place_count);
    v.kind = SourceView::Kind::adaptive;
    v.adaptive = a;
  } else if (const auto* clusters = dynamic_cast<const ClusterModel*>(source.rays.get())) {
    ClusterView c = clusters->view();
    c.pieces = put(c.pieces, c.piece_count);
    c.elements = put(c.elements, c.element_count);
    c.points = put(c.points, c.cluster_count);
    c.piece_probability = put(c.piece_probability, 3 * c.piece_count);
    c.piece_alias = put(c.piece_alias, 3 * c.piece_count);
    c.leaf_begin = put(c.leaf_begin, c.cluster_count + 1);
    c.leaf_probability = put(c.leaf_probability, c.leaf_count);
    c.leaf_alias = put(c.leaf_alias, c.leaf_count);
    c.leaf_triangle = put(c.leaf_triangle, c.leaf_count);
    c.triangles = put(c.triangles, c.triangle_count);
    v.kind = SourceView::Kind::clusters;
    v.clusters = c;
  }
  return v;
}

void DeviceScene::add_mirror(const PlacedReflector& placed, int cells) {
  MirrorView m;
  m.world_from_mirror = view_of(placed.world_from_reflector);
  m.mirror_from_world = view_of(placed.world_from_reflector.inverse());
  const auto& table = placed.reflectance.table();
  m.reflectance = put(table.data(), table.size());
  m.reflectance_entries = static_cast<std::uint32_t>(table.size());
  m.finish = put_finish(placed);
  const Reflector& reflector = placed.reflector;
  HierarchyView h;
  if (reflector.curve) {
    m.curve = view_of(*reflector.curve, reflector.aperture);
    m.curve.pieces = put(m.curve.pieces, reflector.curve->pieces().size());
    m.curve.nodes = put(m.curve.nodes, reflector.curve->nodes().size());
    view_.features |= kExactMirrors;
  } else if (const FacetedSurface* const surface = faceted(reflector)) {
    const FacetMirror facets(*surface, reflector.aperture);
    m.facets = facets.view();
    m.facets.facets = put(m.facets.facets, static_cast<std::size_t>(m.facets.columns) *
                                               static_cast<std::size_t>(m.facets.rows));
    view_.features |= kExactMirrors;
  } else {
    h = add_field(HeightField(reflector, cells), length(placed.world_from_reflector.origin_mm()), m.field);
  }
  mirrors_.push_back(m);
  hierarchies_.push_back(h);
  bands_.emplace_back();
  if (is_field(mirrors_.size() - 1)) rebuild(mirrors_.size() - 1);
}

HierarchyView DeviceScene::add_field(const HeightField& field, double away_mm, FieldView& view) {
  HierarchyView h;
  h.vertices = put(field.vertices().data(), field.vertices().size());
  h.leaf_kinds = put(field.leaf_kinds().data(), field.leaf_kinds().size());
  buffers_.emplace_back(accelerator_, field.nodes().size() * sizeof(FieldNode));
  h.nodes = buffers_.back().as<FieldNode>();
  buffers_.emplace_back(accelerator_, field.leaf_kinds().size() * sizeof(float));
  h.gradient_bound = buffers_.back().as<float>();
  buffers_.emplace_back(accelerator_, sizeof(FieldBounds));
  h.bounds = buffers_.back().as<FieldBounds>();
  std::copy(field.level_offsets().begin(), field.level_offsets().end(), h.offsets);
  h.cells = field.cells();
  h.levels = static_cast<std::int32_t>(field.level_offsets().size());
  h.step_x = field.step_x_mm();
  h.step_y = field.step_y_mm();
  view = view_of(field, away_mm);
  view.vertices = &h.vertices->z_mm;
  view.nodes = &h.nodes->a;
  return h;
}

void DeviceScene::rebuild(std::size_t m) {
  accelerator_.rebuild(0, hierarchies_[m]);
  FieldBounds bounds;
  accelerator_.download(0, &bounds, hierarchies_[m].bounds, sizeof bounds);
  accelerator_.wait(0);
  bands_[m] = {bounds.low, bounds.high};
  mirrors_[m].field.low = static_cast<float>(bounds.low);
  mirrors_[m].field.high = static_cast<float>(bounds.high);
  mirrors_[m].field.gradient_bound = static_cast<float>(bounds.gradient_bound);
  if (device_mirrors_ == nullptr) return;
  accelerator_.upload(0, device_mirrors_ + m, &mirrors_[m], sizeof(MirrorView));
  accelerator_.wait(0);
}

void DeviceScene::set_vertices(std::size_t m, const std::vector<FieldVertex>& vertices) {
  LUCERNA_CHECK(is_field(m), "mirror {} is no height field", m);
  const std::size_t n = static_cast<std::size_t>(hierarchies_[m].cells) + 1;
  LUCERNA_CHECK(vertices.size() == n * n, "{} vertices, {} a side", vertices.size(), n);
  accelerator_.upload(0, const_cast<FieldVertex*>(hierarchies_[m].vertices), vertices.data(),
                      vertices.size() * sizeof(FieldVertex));
  rebuild(m);
}

std::vector<FieldNode> DeviceScene::nodes(std::size_t m) const {
  const HierarchyView& h = hierarchies_[m];
  // Four squares have one parent, up to the one that is all.
  std::size_t count = 0;
  for (std::int32_t level = 0; level < h.levels; ++level) {
    const std::size_t side = static_cast<std::size_t>(h.cells / kFieldBlock) >> level;
    count += side * side;
  }
  std::vector<FieldNode> nodes(count);
  accelerator_.download(0, nodes.data(), h.nodes, nodes.size() * sizeof(FieldNode));
  accelerator_.wait(0);
  return nodes;
}

void DeviceScene::add_detectors(const Scene& scene) {
  std::uint64_t first_bin = 0;
  const auto count = [&](std::size_t bins) {
    bin_counts_.push_back(bins);
    first_bin += bins;
  };
  std::vector<FarFieldView> far_fields;
  for (const FarFieldDetector& d : scene.far_fields) {
    const FarFieldGrid grid = FarFieldGrid::counted(d);
    far_fields.push_back({static_cast<std::int32_t>(grid.c_count()),
                          static_cast<std::int32_t>(grid.gamma_count()), first_bin, grid});
    if (grid.tent()) view_.features |= kTents;
    count(grid.size());
  }
  std::vector<PlaneView> planes;
  const auto add = [&](const PlaneBins& bins) {
    planes.push_back({bins, first_bin});
    count(bins.size());
  };
  for (const PlaneDetector& d : scene.planes) add(PlaneBins(d));
  for (const LuminanceDetector& d : scene.luminances) add(PlaneBins(d));
  view_.far_fields = put(far_fields.data(), far_fields.size());
  view_.far_field_count = static_cast<std::int32_t>(far_fields.size());
  view_.planes = put(planes.data(), planes.size());
  view_.plane_count = static_cast<std::int32_t>(planes.size());
  view_.bins_per_replicate = first_bin;
  const auto sums = [&](std::size_t n) {
    buffers_.emplace_back(accelerator_, std::max<std::size_t>(n, 1) * sizeof(std::int64_t));
    accelerator_.fill(0, buffers_.back().as<void>(), 0, buffers_.back().bytes());
    return buffers_.back().as<std::int64_t>();
  };
  view_.bins = sums(kReplicates * first_bin);
  view_.ledger = sums(kReplicates * kLedgerSums);
  view_.cause_count = static_cast<std::int32_t>(scene.bodies.size() + scene.glasses.size());
  view_.causes = sums(kReplicates * kCauseCopies * causes());
  accelerator_.wait(0);
}

namespace {

/// No light, with room for the same causes and detectors.
Tally empty_like(const Tally& t) {
  Tally empty;
  empty.absorbed.resize(t.absorbed.size());
  empty.lost.resize(t.lost.size());
  empty.lost_rays.resize(t.lost_rays.size());
  for (const auto& bins : t.bins) empty.bins.emplace_back(bins.size());
  return empty;
}

}  // namespace

void DeviceScene::add_to(std::vector<Tally>& replicates) const {
  std::vector<std::int64_t> bins(kReplicates * view_.bins_per_replicate);
  std::vector<std::int64_t> ledger(kReplicates * kLedgerSums);
  std::vector<std::int64_t> absorbed(kReplicates * kCauseCopies * causes());
  accelerator_.download(0, bins.data(), view_.bins, bins.size() * sizeof(std::int64_t));
  accelerator_.download(0, ledger.data(), view_.ledger, ledger.size() * sizeof(std::int64_t));
  accelerator_.download(0, absorbed.data(), view_.causes, absorbed.size() * sizeof(std::int64_t));
  accelerator_.wait(0);
  const auto index = [](auto cause) { return static_cast<std::size_t>(cause); };
  for (std::size_t r = 0; r < kReplicates; ++r) {
    Tally t = empty_like(replicates[r]);
    const std::int64_t* const sum = &ledger[r * kLedgerSums];
    t.rays += static_cast<std::uint64_t>(sum[kRays]);
    t.reflections += static_cast<std::uint64_t>(sum[kReflections]);
    t.emitted += sum[kEmitted];
    t.out_direct += sum[kOutDirect];
    t.out_reflected += sum[kOutReflected];
    t.absorbed[index(MirrorLoss::face)] += sum[kAbsorbedFace];
    t.absorbed[index(MirrorLoss::back)] += sum[kAbsorbedBack];
    t.lost[index(LostCause::bounce_limit)] += sum[kLostBounceLimit];
    t.lost[index(LostCause::not_finite)] += sum[kLostNotFinite];
    t.lost_rays[index(LostCause::bounce_limit)] += static_cast<std::uint64_t>(sum[kLostBounceLimitRays]);
    t.lost_rays[index(LostCause::not_finite)] += static_cast<std::uint64_t>(sum[kLostNotFiniteRays]);
    for (std::size_t i = 0; i < kCauseCopies * causes(); ++i) {
      t.absorbed[kMirrorLosses + i % causes()] += absorbed[r * kCauseCopies * causes() + i];
    }
    const std::int64_t* bin = bins.data() + r * view_.bins_per_replicate;
    for (std::size_t d = 0; d < bin_counts_.size(); ++d) {
      for (std::size_t i = 0; i < bin_counts_[d]; ++i) t.bins[d][i] += *bin++;
    }
    replicates[r] += t;
  }
}

}  // namespace lucerna
