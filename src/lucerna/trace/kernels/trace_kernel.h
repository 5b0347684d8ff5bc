// SPDX-License-Identifier: Apache-2.0
#pragma once

// What becomes of one ray, from its number to the bins: the body of the GPU's tracing kernel. Included by
// what is compiled for one lane only (simd_float.h): the CUDA kernels, and the CPU's stand-in for them
// (accelerator_emulated.cpp), which runs the same functions in a loop. Plain data in flat arrays; sums are
// the whole quanta of flux_quanta.h, so that the order of adding does not matter.

#include <cfloat>
#include <type_traits>

#include "lucerna/core/parallel/atomic_add.h"
#include "lucerna/trace/kernels/exact_mirrors.h"
#include "lucerna/trace/kernels/field_kernel.h"
#include "lucerna/trace/kernels/launch_view.h"
#include "lucerna/trace/kernels/scatter_kernel.h"
#include "lucerna/trace/tally/flux_quanta.h"

namespace lucerna {
namespace {

/// The sums of the ledger that one thread makes.
struct Counters {
  std::int64_t sum[kLedgerSums] = {};
  LUCERNA_HD void add(LedgerSum which, std::int64_t quanta) { sum[which] += quanta; }
};

/// A ray as a source emits it: float32 as in a ray file, in the source's frame.
struct Emitted {
  LaneRays ray;
  float weight;
};

LUCERNA_HD inline Emitted emitted(const Ray& r) {
  const auto f = [](double x) { return Float(static_cast<float>(x)); };
  return {{f(r.origin_mm.x), f(r.origin_mm.y), f(r.origin_mm.z), f(r.direction.x()), f(r.direction.y()),
           f(r.direction.z()), mask_of(0)},
          1.0f};
}

/// Ray `i` of a run; `place` is where the launch keeps it if the CPU drew it.
LUCERNA_HD inline Emitted emit(const LaunchView& v, const RunView& run, std::uint32_t i, std::size_t place) {
  const SourceView& source = v.sources[run.source];
  const Sequence sequence(v.sequence, run.sequence_seed);
  switch (source.kind) {
    case SourceView::Kind::adaptive:
      return emitted(sample_adaptive(source.adaptive, sequence.point<4>(run.first + i)));
    case SourceView::Kind::clusters:
      return emitted(sample_clusters(source.clusters, sequence.point<6>(run.first + i)));
    case SourceView::Kind::sent:
      break;
  }
  const SentRays& s = v.sent;
  return {{s.x[place], s.y[place], s.z[place], s.dx[place], s.dy[place], s.dz[place], mask_of(0)},
          s.weight[place]};
}

/// As rays are kept for what works in double.
LUCERNA_HD inline Ray world_ray(const LaneRays& ray) {
  return {{ray.x.v, ray.y.v, ray.z.v}, Direction::from({ray.dx.v, ray.dy.v, ray.dz.v})};
}

LUCERNA_HD LUCERNA_HD_CALL inline void add_to_tents(const LaunchView& v, const Direction& d,
                                                    std::int64_t quanta, std::int64_t* bins) {
  for (std::int32_t i = 0; i < v.far_field_count; ++i) {
    const FarFieldView& far = v.far_fields[i];
    if (far.grid.tent()) far.grid.add_tent(d, quanta, bins + far.first_bin);
  }
}

/// A ray that has left, given to all detectors.
template <SceneFeatures kFeatures>
LUCERNA_HD inline void detect(const LaunchView& v, const LaneRays& ray, float flux, std::uint32_t replicate,
                              std::size_t place) {
  std::int64_t* const bins = v.bins + replicate * v.bins_per_replicate;
  const std::int64_t quanta = quanta_of(flux);
  for (std::int32_t d = 0; d < v.far_field_count; ++d) {
    const FarFieldView& far = v.far_fields[d];
    if constexpr ((kFeatures & kTents) != 0) {
      if (far.grid.tent()) continue;  // below
    }
    atomic_add(bins + far.first_bin + far_field_cell(ray.dx, ray.dy, ray.dz, far.c_count, far.gamma_count).v,
               quanta);
  }
  if ((kFeatures & kTents) == 0 && v.plane_count == 0 && v.out_rays == nullptr) return;
  const Ray leg = world_ray(ray);
  if constexpr ((kFeatures & kTents) != 0) add_to_tents(v, leg.direction, quanta, bins);
  for (std::int32_t d = 0; d < v.plane_count; ++d) {
    if (const auto cell = v.planes[d].bins.cell(leg))
      atomic_add(bins + v.planes[d].first_bin + *cell, quanta);
  }
  if (v.out_rays == nullptr) return;
  v.out_rays[place] = {ray.x.v,
                       ray.y.v,
                       ray.z.v,
                       static_cast<float>(leg.direction.x()),
                       static_cast<float>(leg.direction.y()),
                       static_cast<float>(leg.direction.z()),
                       static_cast<float>(static_cast<double>(quanta) / kQuantaPerRay)};
}

LUCERNA_HD LUCERNA_HD_CALL inline ExactHit intersect_exact(const MirrorView& mirror, const Vec3& o,
                                                           const Vec3& d, bool on_mirror) {
  return mirror.curve.node_count > 0 ? curve_hit(mirror.curve, o, d, on_mirror)
                                     : facet_hit(mirror.facets, o, d, on_mirror);
}

/// First hit of a ray in a mirror's frame with that mirror.
template <SceneFeatures kFeatures>
LUCERNA_HD inline LaneHits intersect_mirror(const MirrorView& mirror, const LaneRays& local) {
  if constexpr ((kFeatures & kExactMirrors) != 0) {
    if (mirror.curve.node_count > 0 || mirror.facets.columns > 0) {
      const ExactHit hit = intersect_exact(mirror, {local.x.v, local.y.v, local.z.v},
                                           {local.dx.v, local.dy.v, local.dz.v}, local.on_mirror.m);
      return {hit.t, hit.gx, hit.gy, Int(hit.state), hit.gz};
    }
  }
  return Packet(mirror.field, local).run(mask_of(1));
}

/// The mirror that a ray meets first; -1 if none.
struct FirstHit {
  std::int32_t mirror = -1;
  LaneRays local;
  LaneHits hit;
};
template <SceneFeatures kFeatures>
LUCERNA_HD inline FirstHit first_hit(const LaunchView& v, const LaneRays& ray, std::int32_t last) {
  FirstHit first;
  for (std::int32_t m = 0; m < v.mirror_count; ++m) {
    LaneRays local = in_frame(v.mirrors[m].mirror_from_world, ray);
    local.on_mirror = {m == last};
    const LaneHits hit = intersect_mirror<kFeatures>(v.mirrors[m], local);
    if (hit.state.v == kMiss || (first.mirror >= 0 && !(hit.t().v < first.hit.t().v))) continue;
    first.mirror = m;
    first.local = local;
    first.hit = hit;
  }
  return first;
}

LUCERNA_HD inline Direction normal_of(const LaneHits& hit) {
  return Direction::from(
      {-static_cast<double>(hit.gx.v), -static_cast<double>(hit.gy.v), static_cast<double>(hit.gz.v)});
}

LUCERNA_HD inline void tilt(double slope_error_rad, const ReflectionKey& key, LaneHits& hit) {
  const Vec3 t = tilted_normal(normal_of(hit), slope_error_rad, key);
  hit.gx = static_cast<float>(-t.x);
  hit.gy = static_cast<float>(-t.y);
  hit.gz = static_cast<float>(t.z);
}

/// Sends on by its lobes what a mirror has mirrored, a ray of the luminaire frame.
LUCERNA_HD LUCERNA_HD_CALL inline void scatter(const MirrorView& mirror, const ReflectionKey& key,
                                               const LaneHits& hit, LaneRays& out) {
  const Direction mirrored = Direction::from(
      {static_cast<double>(out.dx.v), static_cast<double>(out.dy.v), static_cast<double>(out.dz.v)});
  const Direction normal = turned(mirror.world_from_mirror, normal_of(hit));
  const Vec3 d = scattered(mirror.finish, normal, mirrored, key);
  out.dx = static_cast<float>(d.x);
  out.dy = static_cast<float>(d.y);
  out.dz = static_cast<float>(d.z);
}

LUCERNA_HD inline bool all_finite(const LaneRays& r) {
  return std::isfinite(r.x.v + r.y.v + r.z.v + r.dx.v + r.dy.v + r.dz.v);
}

/// What becomes of a ray at what is no mirror.
struct ObstacleHit {
  bool is_hit = false;
  bool reflected = false;   ///< else it was let through
  double throughput = 0.0;  ///< share of its flux that goes on; 0: it ends here
  std::int32_t cause = 0;   ///< that keeps the rest
  Ray ray;                  ///< after it
};

LUCERNA_HD LUCERNA_HD_CALL inline std::optional<BodyHit> intersect_bodies(const LaunchView& v, const Ray& ray,
                                                                          double nearest_mm, bool returning) {
  return first_body(v.bodies, ray, nearest_mm, returning);
}

/// The first thing that is no mirror before `nearest_mm`. `reflections`: how often the ray was reflected
/// before.
LUCERNA_HD LUCERNA_HD_CALL inline ObstacleHit intersect_obstacles(const LaunchView& v, const Ray& ray,
                                                                  double nearest_mm, int reflections,
                                                                  const ReflectionKey& key) {
  std::optional<BodyHit> hit;
  if (v.bodies.count > 0) hit = intersect_bodies(v, ray, nearest_mm, reflections > 0);
  if (hit) nearest_mm = hit->t_mm;
  if (const auto cover_glass = first_cover_glass(v.cover_glasses, v.cover_glass_count, ray, nearest_mm)) {
    const GlassPassage passage =
        through_cover_glass(v.cover_glasses[cover_glass->glass], ray, *cover_glass, key);
    return {true, passage.throughput > 0.0 && !passage.transmitted, passage.throughput,
            static_cast<std::int32_t>(v.bodies.count + cover_glass->glass), passage.ray};
  }
  if (!hit) return {};
  const BodyView& body = v.bodies.bodies[hit->body];
  const double throughput =
      reflectance_at(body.reflectance, body.reflectance_entries, -dot(ray.direction, hit->normal));
  ObstacleHit e{true, true, throughput, static_cast<std::int32_t>(hit->body), {}};
  if (throughput > 0.0) {
    e.ray = {ray.at(hit->t_mm), reflected_off(body.finish, ray.direction, *hit, key)};
  }
  return e;
}

/// Takes `1 - kept` off `flux`; returns what that is.
LUCERNA_HD inline std::int64_t absorb(float& flux, double throughput) {
  const std::int64_t before = quanta_of(flux);
  flux = static_cast<float>(static_cast<double>(flux) * throughput);
  return before - quanta_of(flux);
}

LUCERNA_HD inline void lose_to_bounce_limit(float flux, Counters& counters) {
  counters.add(kLostBounceLimit, quanta_of(flux));
  counters.add(kLostBounceLimitRays, 1);
}

/// Follows a ray of the luminaire frame until it leaves, is absorbed or is given up.
template <SceneFeatures kFeatures>
LUCERNA_HD inline void follow(const LaunchView& v, LaneRays ray, float flux, ReflectionKey key,
                              std::uint32_t replicate, std::size_t place, Counters& counters) {
  constexpr bool kHasObstacles = (kFeatures & kObstacles) != 0;
  std::int32_t last = -1;
  // All that a ray meets counts as a bounce; without glass each is a reflection.
  for (int bounce = 0, reflections = 0;; ++bounce) {
    if constexpr (!kHasObstacles) reflections = bounce;
    FirstHit first = first_hit<kFeatures>(v, ray, last);
    key.bounce = bounce;
    if constexpr (kHasObstacles) {
      const double nearest =
          first.mirror < 0 ? static_cast<double>(FLT_MAX) : static_cast<double>(first.hit.t().v);
      const ObstacleHit e = intersect_obstacles(v, world_ray(ray), nearest, reflections, key);
      if (e.is_hit) {
        if (e.reflected && reflections == v.max_bounces) return lose_to_bounce_limit(flux, counters);
        const std::size_t copy = replicate * kCauseCopies + place % kCauseCopies;
        atomic_add(v.causes + copy * static_cast<std::size_t>(v.cause_count) + e.cause,
                   absorb(flux, e.throughput));
        if (e.throughput == 0.0) return;
        ray = emitted(e.ray).ray;
        last = -1;
        if (e.reflected) {
          counters.add(kReflections, 1);
          ++reflections;
        }
        continue;
      }
    }
    if (first.mirror < 0) {
      counters.add(reflections == 0 ? kOutDirect : kOutReflected, quanta_of(flux));
      detect<kFeatures>(v, ray, flux, replicate, place);
      return;
    }
    const MirrorView& mirror = v.mirrors[first.mirror];
    if (first.hit.state.v == kBack) return counters.add(kAbsorbedBack, quanta_of(flux));
    if (reflections == v.max_bounces) return lose_to_bounce_limit(flux, counters);
    if (mirror.finish.slope_error_rad > 0.0) tilt(mirror.finish.slope_error_rad, key, first.hit);
    Float cosine;
    ray = in_frame(mirror.world_from_mirror, reflected(first.local, first.hit, cosine));
    if (mirror.finish.scatters()) scatter(mirror, key, first.hit, ray);
    const double throughput =
        reflectance_at(mirror.reflectance, mirror.reflectance_entries, static_cast<double>(cosine.v));
    counters.add(kAbsorbedFace, absorb(flux, throughput));
    counters.add(kReflections, 1);
    ++reflections;
    last = first.mirror;
  }
}

/// Ray number `k` (0 .. kBlockRays - 1) of block `block` of the launch: drawn, traced and counted.
template <SceneFeatures kFeatures>
LUCERNA_HD inline void trace_number(const LaunchView& v, std::size_t block, std::uint32_t k,
                                    Counters& counters) {
  const std::size_t place = block * kBlockRays + k;
  std::uint32_t i = k;
  for (std::uint32_t r = v.run_begin[block]; r < v.run_begin[block + 1]; ++r) {
    const RunView& run = v.runs[r];
    if (i >= run.count) {
      i -= run.count;
      continue;
    }
    const SourceView& source = v.sources[run.source];
    const Emitted e = emit(v, run, i, place);
    const LaneRays ray = in_frame(source.world_from_source, e.ray);
    const float flux = static_cast<float>(static_cast<double>(e.weight) * source.ray_flux);
    counters.add(kEmitted, quanta_of(flux));
    counters.add(kRays, 1);
    if (!all_finite(ray)) {
      counters.add(kLostNotFinite, quanta_of(flux));
      return counters.add(kLostNotFiniteRays, 1);
    }
    const std::uint32_t replicate = static_cast<std::uint32_t>((v.first_block + block) % kReplicates);
    return follow<kFeatures>(v, ray, flux, {run.sequence_seed, run.first + i, 0}, replicate, place, counters);
  }
}

/// Calls `f` with the smallest compiled set of features (an integral_constant) that has all of `features`.
template <class F>
void with_compiled(SceneFeatures features, const F& f) {
  if (features == kPlainScene) return f(std::integral_constant<SceneFeatures, kPlainScene>{});
  if (features == kExactMirrors) return f(std::integral_constant<SceneFeatures, kExactMirrors>{});
  f(std::integral_constant<SceneFeatures, kAllFeatures>{});
}

/// Node `i` of level `level` of a field's tree.
LUCERNA_HD inline void rebuild_node(const HierarchyView& h, int level, std::size_t i) {
  const std::size_t n = static_cast<std::size_t>(h.cells / kFieldBlock) >> level;
  FieldNode* const out = h.nodes + h.offsets[level] + i;
  if (level > 0) {
    *out = field_parent(h.nodes + h.offsets[level - 1], 2 * n, h.step_x, h.step_y, level, i % n, i / n);
    return;
  }
  FieldLeaf leaf;
  if (h.leaf_kinds[i] != LeafKind::beyond)
    leaf = field_leaf(h.vertices, h.cells, h.step_x, h.step_y, i % n, i / n);
  *out = h.leaf_kinds[i] == LeafKind::mirror ? leaf.slab : FieldNode{};
  h.gradient_bound[i] = leaf.gradient_bound;
}

/// Bounds of nothing, to be widened.
LUCERNA_HD inline FieldBounds no_bounds() { return {DBL_MAX, -DBL_MAX, 0.0}; }

LUCERNA_HD inline void widen(FieldBounds& bounds, const FieldBounds& by) {
  bounds.low = by.low < bounds.low ? by.low : bounds.low;
  bounds.high = by.high > bounds.high ? by.high : bounds.high;
  bounds.gradient_bound =
      by.gradient_bound > bounds.gradient_bound ? by.gradient_bound : bounds.gradient_bound;
}

/// Widens `bounds` by what leaf `i` of a field holds.
LUCERNA_HD inline void widen(FieldBounds& bounds, const HierarchyView& h, std::size_t i) {
  const FieldNode& leaf = h.nodes[i];
  const double gradient_bound = static_cast<double>(h.gradient_bound[i]);
  bounds.gradient_bound = gradient_bound > bounds.gradient_bound ? gradient_bound : bounds.gradient_bound;
  if (leaf.e < 0.0F) return;
  const double reach = static_cast<double>(field_reach(leaf, h.step_x, h.step_y));
  const double a = static_cast<double>(leaf.a);
  widen(bounds, {a - reach, a + reach, 0.0});
}

}  // namespace
}  // namespace lucerna
