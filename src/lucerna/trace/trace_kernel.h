// SPDX-License-Identifier: Apache-2.0
#pragma once

// What becomes of one ray, from its number to the bins: the body of the GPU's tracing kernel. Included by
// what is compiled for one lane only (simd.h): the CUDA kernels, and the CPU's stand-in for them
// (accelerator_emulated.cpp), which runs the same functions in a loop. Plain data in flat arrays; sums are
// the whole units of tally.h, so that the order of adding does not matter.

#include <type_traits>

#include "lucerna/core/atomic_add.h"
#include "lucerna/trace/exact_mirrors.h"
#include "lucerna/trace/field_kernel.h"
#include "lucerna/trace/launch_view.h"
#include "lucerna/trace/slope_error.h"

namespace lucerna {
namespace {

/// The sums of the ledger that one thread makes.
struct Counters {
  std::int64_t sum[kLedgerSums] = {};
  LUCERNA_HD void add(LedgerSum which, std::int64_t units) { sum[which] += units; }
};

LUCERNA_HD inline std::int64_t units_of(float flux) {
  return static_cast<std::int64_t>(static_cast<double>(flux) * kUnitsPerRay + 0.5);
}

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

/// A ray that has left, given to all detectors.
LUCERNA_HD inline void detect(const LaunchView& v, const LaneRays& ray, float flux, std::uint32_t replicate,
                              std::size_t place) {
  std::int64_t* const bins = v.bins + replicate * v.bins_per_replicate;
  const std::int64_t units = units_of(flux);
  for (std::int32_t d = 0; d < v.far_field_count; ++d) {
    const FarFieldView& far = v.far_fields[d];
    atomic_add(bins + far.first_bin + far_field_cell(ray.dx, ray.dy, ray.dz, far.c_count, far.gamma_count).v,
               units);
  }
  if (v.plane_count == 0 && v.out_rays == nullptr) return;
  const Ray leg{{ray.x.v, ray.y.v, ray.z.v}, Direction::from({ray.dx.v, ray.dy.v, ray.dz.v})};
  for (std::int32_t d = 0; d < v.plane_count; ++d) {
    if (const auto cell = v.planes[d].bins.cell(leg)) atomic_add(bins + v.planes[d].first_bin + *cell, units);
  }
  if (v.out_rays == nullptr) return;
  v.out_rays[place] = {ray.x.v,
                       ray.y.v,
                       ray.z.v,
                       static_cast<float>(leg.direction.x()),
                       static_cast<float>(leg.direction.y()),
                       static_cast<float>(leg.direction.z()),
                       static_cast<float>(static_cast<double>(units) / kUnitsPerRay)};
}

LUCERNA_HD LUCERNA_HD_CALL inline ExactHit meet_exact(const MirrorView& mirror, const Vec3& o, const Vec3& d,
                                                      bool on_mirror) {
  return mirror.curve.node_count > 0 ? curve_hit(mirror.curve, o, d, on_mirror)
                                     : facet_hit(mirror.facets, o, d, on_mirror);
}

/// First hit of a ray in a mirror's frame with that mirror.
template <SceneFeatures kFeatures>
LUCERNA_HD inline LaneHits meet(const MirrorView& mirror, const LaneRays& local) {
  if constexpr ((kFeatures & kExactMirrors) != 0) {
    if (mirror.curve.node_count > 0 || mirror.facets.columns > 0) {
      const ExactHit hit = meet_exact(mirror, {local.x.v, local.y.v, local.z.v},
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
    const LaneHits hit = meet<kFeatures>(v.mirrors[m], local);
    if (hit.state.v == kMiss || (first.mirror >= 0 && !(hit.t.v < first.hit.t.v))) continue;
    first.mirror = m;
    first.local = local;
    first.hit = hit;
  }
  return first;
}

LUCERNA_HD inline void tilt(double slope_error_rad, const ReflectionKey& key, LaneHits& hit) {
  const Direction normal = Direction::from(
      {-static_cast<double>(hit.gx.v), -static_cast<double>(hit.gy.v), static_cast<double>(hit.gz.v)});
  const Vec3 t = tilted_normal(normal, slope_error_rad, key);
  hit.gx = static_cast<float>(-t.x);
  hit.gy = static_cast<float>(-t.y);
  hit.gz = static_cast<float>(t.z);
}

LUCERNA_HD inline bool all_finite(const LaneRays& r) {
  return std::isfinite(r.x.v + r.y.v + r.z.v + r.dx.v + r.dy.v + r.dz.v);
}

/// Follows a ray of the luminaire frame until it leaves, is absorbed or is given up.
template <SceneFeatures kFeatures>
LUCERNA_HD inline void follow(const LaunchView& v, LaneRays ray, float flux, ReflectionKey key,
                              std::uint32_t replicate, std::size_t place, Counters& counters) {
  std::int32_t last = -1;
  for (int bounce = 0;; ++bounce) {
    FirstHit first = first_hit<kFeatures>(v, ray, last);
    if (first.mirror < 0) {
      counters.add(bounce == 0 ? kOutDirect : kOutReflected, units_of(flux));
      detect(v, ray, flux, replicate, place);
      return;
    }
    const MirrorView& mirror = v.mirrors[first.mirror];
    if (first.hit.state.v == kBack) return counters.add(kAbsorbedBack, units_of(flux));
    if (bounce == v.max_bounces) {
      counters.add(kLostBounceLimit, units_of(flux));
      return counters.add(kLostBounceLimitRays, 1);
    }
    if (mirror.slope_error_rad > 0.0) {
      key.bounce = bounce;
      tilt(mirror.slope_error_rad, key, first.hit);
    }
    Float cosine;
    ray = in_frame(mirror.world_from_mirror, reflected(first.local, first.hit, cosine));
    const double kept =
        reflectance_at(mirror.reflectance, mirror.reflectance_entries, static_cast<double>(cosine.v));
    const std::int64_t before = units_of(flux);
    flux = static_cast<float>(static_cast<double>(flux) * kept);
    counters.add(kAbsorbedFace, before - units_of(flux));
    counters.add(kReflections, 1);
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
    counters.add(kEmitted, units_of(flux));
    counters.add(kRays, 1);
    if (!all_finite(ray)) {
      counters.add(kLostNotFinite, units_of(flux));
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
  f(std::integral_constant<SceneFeatures, kExactMirrors>{});
}

/// Node `i` of level `level` of a field's tree.
LUCERNA_HD inline void rebuild_node(const HierarchyView& h, int level, std::size_t i) {
  const std::size_t n = static_cast<std::size_t>(h.cells / kFieldBlock) >> level;
  FieldNode* const out = h.nodes + h.offsets[level] + i;
  if (level > 0) {
    *out = field_parent(h.nodes + h.offsets[level - 1], 2 * n, h.step_x, h.step_y, level, i % n, i / n);
  } else {
    *out = h.leaf_is_mirror[i] != 0 ? field_leaf(h.vertices, h.cells, h.step_x, h.step_y, i % n, i / n)
                                    : FieldNode{};
  }
}

/// Widens [low, high] by what leaf `i` of a field holds.
LUCERNA_HD inline void widen_band(const HierarchyView& h, std::size_t i, double& low, double& high) {
  const FieldNode& leaf = h.nodes[i];
  if (leaf.e < 0.0F) return;
  const double reach = static_cast<double>(field_reach(leaf, h.step_x, h.step_y));
  const double a = static_cast<double>(leaf.a) - reach, b = static_cast<double>(leaf.a) + reach;
  low = a < low ? a : low;
  high = b > high ? b : high;
}

}  // namespace
}  // namespace lucerna
