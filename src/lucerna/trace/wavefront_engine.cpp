// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <optional>
#include <span>

#include "lucerna/core/error.h"
#include "lucerna/reflector/height_field.h"
#include "lucerna/trace/curve_view.h"
#include "lucerna/trace/exact_mirrors.h"
#include "lucerna/trace/facet_mirror.h"
#include "lucerna/trace/far_field_grid.h"
#include "lucerna/trace/field_view.h"
#include "lucerna/trace/slope_error.h"
#include "lucerna/trace/trace_engine.h"
#include "lucerna/trace/units.h"

namespace lucerna {

namespace {

/// Batches of rays go through all mirrors together, one reflection at a time; what leaves is binned at the
/// end.
class WavefrontEngine final : public TraceEngine {
 public:
  WavefrontEngine(const Scene& scene, const RayNumbering& numbering, const TraceOptions& options)
      : TraceEngine(scene),
        scene_(scene),
        numbering_(numbering),
        max_bounces_(options.max_bounces),
        kind_(options.sequence),
        kernels_(options.isa.empty() ? best_kernels() : kernels_named(options.isa.c_str())) {
    for (const PlacedReflector& r : scene.reflectors) {
      const FacetedSurface* const facets = faceted(r.reflector);
      facets_.push_back(facets ? std::make_unique<const FacetMirror>(*facets, r.reflector.aperture)
                               : nullptr);
      fields_.push_back(facets || r.reflector.curve
                            ? nullptr
                            : std::make_unique<const HeightField>(r.reflector, options.cells));
    }
    for (std::size_t i = 0; i < scene.reflectors.size(); ++i) {
      const PlacedReflector& r = scene.reflectors[i];
      mirrors_.push_back(
          {fields_[i] ? view_of(*fields_[i], length(r.world_from_reflector.origin_mm())) : FieldView{},
           facets_[i] ? facets_[i]->view() : FacetView{},
           r.reflector.curve ? view_of(*r.reflector.curve, r.reflector.aperture) : CurveView{},
           view_of(r.world_from_reflector), view_of(r.world_from_reflector.inverse()), &r.reflectance,
           1e-3 * r.slope_error_mrad});
    }
  }

  std::string isa() const override { return kernels_.isa; }

  void trace_run(const SourceRun& run, TraceScratch& scratch, Tally& tally) const override {
    RayBlock& rays = scratch.rays;
    const PlacedSource& source = scene_.sources[run.source];
    rays.resize(run.count, 0);
    source.rays->emit(Sequence(kind_, run.sequence_seed), run.first, rays);
    Batch batch;
    const std::size_t n =
        emit(rays, source.world_from_source, numbering_.ray_flux(run.source), batch.rays, tally);
    if (!bodies().empty()) batch.body.resize(n);
    if (!glasses().empty()) {
      batch.glass.resize(n);
      batch.reflections.fill(0);
    }
    follow(batch, n, run, scratch, tally);
  }

 private:
  struct Mirror {
    FieldView field;
    // In the field's place, if they have any:
    FacetView facets;
    CurveView curve;
    FrameView world_from_mirror, mirror_from_world;
    const Reflectance* reflectance;
    double slope_error_rad;
  };
  /// All rays of one run on their way.
  struct Batch {
    WorldRays rays;
    WorldRays out;
    std::size_t out_count = 0;
    alignas(64) float cosine[kBatch];
    /// First hits with bodies, where those come before all mirrors; of no length without bodies.
    std::vector<std::optional<BodyHit>> body;
    /// The same of cover glasses, where those come before all else.
    std::vector<std::optional<GlassHit>> glass;
    /// By number, how often each ray was reflected; kept only if there are cover glasses: else it is the same
    /// for all rays still on their way.
    std::array<int, kBatch> reflections;
  };
  struct Meeting {
    LocalRays rays;
    LocalHits hits;
  };

  static void lose(LostCause cause, float flux, Tally& tally) {
    tally.lost[static_cast<std::size_t>(cause)] += units_of(flux);
    ++tally.lost_rays[static_cast<std::size_t>(cause)];
  }

  /// Rays of `in` to the luminaire frame; returns how many have finite numbers.
  std::size_t emit(const RayBlock& in, const Frame& frame, double ray_flux, WorldRays& out,
                   Tally& tally) const {
    const std::size_t n = in.size();
    LUCERNA_CHECK(n <= kBatch, "{} rays", n);
    const RayArrays arrays{in.x_mm.data(), in.y_mm.data(), in.z_mm.data(),  in.kx.data(),
                           in.ky.data(),   in.kz.data(),   in.weight.data()};
    bool all_finite = true;
    tally.emitted += kernels_.enter(view_of(frame), arrays, n, ray_flux, out, all_finite);
    tally.rays += n;
    if (all_finite) return n;
    alignas(64) std::int32_t fate[kBatch];
    for (std::size_t i = 0; i < n; ++i) {
      const bool finite =
          std::isfinite(in.x_mm[i] + in.y_mm[i] + in.z_mm[i] + in.kx[i] + in.ky[i] + in.kz[i]);
      fate[i] = finite ? 0 : kGone;
      if (!finite) lose(LostCause::not_finite, out.flux[i], tally);
    }
    WorldRays none;
    std::size_t none_count = 0;
    const std::size_t stay = kernels_.part(out, fate, n, none, none_count);
    for (std::size_t i = 0; i < stay; ++i) out.mirror[i] = -1;
    return stay;
  }

  void follow(Batch& batch, std::size_t n, const SourceRun& run, TraceScratch& scratch, Tally& tally) const {
    const auto memory = std::make_unique_for_overwrite<Meeting[]>(mirrors_.size());
    const std::span<Meeting> meetings(memory.get(), mirrors_.size());
    for (int bounce = 0; n > 0; ++bounce) {
      const std::size_t left_before = batch.out_count;
      meet(batch.rays, n, meetings);
      if (!bodies().empty()) meet_bodies(batch, n, bounce, meetings);
      if (!glasses().empty()) meet_glasses(batch, n, meetings);
      for (std::size_t m = 0; m < mirrors_.size(); ++m) {
        if (mirrors_[m].slope_error_rad > 0.0)
          tilt(mirrors_[m].slope_error_rad, batch.rays, n, run, bounce, meetings[m].hits);
      }
      n = sort_out(batch, n, meetings, {run.sequence_seed, run.first, bounce}, tally);
      count_leaving(batch, left_before, bounce, tally);
    }
    detect(batch.out, batch.out_count, scratch, tally);
  }

  /// Adds what left in step `bounce`, all of `out` from `first` on, to the ledger.
  void count_leaving(const Batch& batch, std::size_t first, int bounce, Tally& tally) const {
    std::int64_t direct = 0, all = 0;
    for (std::size_t i = first; i < batch.out_count; ++i) {
      const std::int64_t u = units_of(batch.out.flux[i]);
      all += u;
      direct += reflections(batch, batch.out, i, bounce) == 0 ? u : 0;
    }
    tally.out_direct += direct;
    tally.out_reflected += all - direct;
  }

  /// Gives all that left to the detectors.
  void detect(const WorldRays& out, std::size_t n, TraceScratch& scratch, Tally& tally) const {
    alignas(64) std::int32_t cell[kBatch];
    for (std::size_t d = 0; d < far_fields().size(); ++d) {
      const FarFieldGrid& grid = far_fields()[d];
      if (grid.tent()) continue;  // `leave` deals to its tents
      kernels_.far_field_cells(out, n, static_cast<std::int32_t>(grid.c_count()),
                               static_cast<std::int32_t>(grid.gamma_count()), cell);
      std::int64_t* const bins = tally.bins[d].data();
      for (std::size_t i = 0; i < n; ++i) bins[cell[i]] += units_of(out.flux[i]);
    }
    if (!looks_at_places()) return;
    // Rays leave after different numbers of reflections; by number they are in the order they were emitted
    // in.
    std::array<std::size_t, kBatch> order;
    std::iota(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(n), std::size_t{0});
    std::sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(n),
              [&](std::size_t a, std::size_t b) { return out.number[a] < out.number[b]; });
    for (std::size_t k = 0; k < n; ++k) {
      const std::size_t i = order[k];
      leave({{out.x[i], out.y[i], out.z[i]}, Direction::from({out.dx[i], out.dy[i], out.dz[i]})},
            units_of(out.flux[i]), scratch, tally);
    }
  }

  /// Gives the normals of all reflections of one mirror their slope error.
  static void tilt(double slope_error_rad, const WorldRays& rays, std::size_t n, const SourceRun& run,
                   int bounce, LocalHits& hits) {
    for (std::size_t i = 0; i < n; ++i) {
      if (hits.state[i] != kFront) continue;
      const ReflectionKey key{run.sequence_seed, run.first + static_cast<std::uint64_t>(rays.number[i]),
                              bounce};
      const Vec3 normal{-static_cast<double>(hits.gx[i]), -static_cast<double>(hits.gy[i]),
                        static_cast<double>(hits.gz[i])};
      const Vec3 t = tilted_normal(Direction::from(normal), slope_error_rad, key);
      hits.gx[i] = static_cast<float>(-t.x);
      hits.gy[i] = static_cast<float>(-t.y);
      hits.gz[i] = static_cast<float>(t.z);
    }
  }

  /// First hits with every mirror; where a ray meets several, all but the nearest become misses.
  void meet(const WorldRays& rays, std::size_t n, std::span<Meeting> meetings) const {
    for (std::size_t m = 0; m < mirrors_.size(); ++m) {
      kernels_.to_local(mirrors_[m].mirror_from_world, rays, n, static_cast<std::int32_t>(m),
                        meetings[m].rays);
      if (mirrors_[m].curve.node_count > 0) {
        meet_curve(mirrors_[m].curve, meetings[m].rays, n, meetings[m].hits);
      } else if (mirrors_[m].facets.columns > 0) {
        meet_facets(mirrors_[m].facets, meetings[m].rays, n, meetings[m].hits);
      } else {
        kernels_.intersect(mirrors_[m].field, meetings[m].rays, n, meetings[m].hits);
      }
    }
    for (std::size_t m = 1; m < mirrors_.size(); ++m) {
      for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t k = 0; k < m; ++k) {
          LocalHits &a = meetings[k].hits, &b = meetings[m].hits;
          if (a.state[i] == kMiss || b.state[i] == kMiss) continue;
          (b.t[i] < a.t[i] ? a : b).state[i] = kMiss;
        }
      }
    }
  }

  /// First hits with bodies; mirrors behind them become misses.
  void meet_bodies(Batch& batch, std::size_t n, int bounce, std::span<Meeting> meetings) const {
    for (std::size_t i = 0; i < n; ++i) {
      double nearest = std::numeric_limits<float>::max();
      for (const Meeting& m : meetings) {
        if (m.hits.state[i] != kMiss) nearest = std::min(nearest, static_cast<double>(m.hits.t[i]));
      }
      const bool returning = reflections(batch, batch.rays, i, bounce) > 0;
      batch.body[i] = bodies().first_hit(ray_of(batch.rays, i), nearest, returning);
      if (!batch.body[i]) continue;
      for (Meeting& m : meetings) m.hits.state[i] = kMiss;
    }
  }

  /// First hits with cover glasses; mirrors and bodies behind them become misses.
  void meet_glasses(Batch& batch, std::size_t n, std::span<Meeting> meetings) const {
    for (std::size_t i = 0; i < n; ++i) {
      double nearest = std::numeric_limits<float>::max();
      for (const Meeting& m : meetings) {
        if (m.hits.state[i] != kMiss) nearest = std::min(nearest, static_cast<double>(m.hits.t[i]));
      }
      if (!bodies().empty() && batch.body[i]) nearest = std::min(nearest, batch.body[i]->t_mm);
      batch.glass[i] = glasses().first_hit(ray_of(batch.rays, i), nearest);
      if (!batch.glass[i]) continue;
      if (!bodies().empty()) batch.body[i].reset();
      for (Meeting& m : meetings) m.hits.state[i] = kMiss;
    }
  }

  /// How often ray `i` of `rays` was reflected before step `bounce`.
  int reflections(const Batch& batch, const WorldRays& rays, std::size_t i, int bounce) const {
    return glasses().empty() ? bounce : batch.reflections[static_cast<std::size_t>(rays.number[i])];
  }

  /// Counts a reflection of ray `i`; false if it would be one too many, and the ray is lost.
  bool may_reflect(Batch& batch, std::size_t i, int bounce, Tally& tally) const {
    if (reflections(batch, batch.rays, i, bounce) == max_bounces_) {
      lose(LostCause::bounce_limit, batch.rays.flux[i], tally);
      return false;
    }
    if (!glasses().empty()) ++batch.reflections[static_cast<std::size_t>(batch.rays.number[i])];
    return true;
  }

  /// Takes `1 - kept` off the flux of a ray.
  static void absorb(float& flux, double kept, std::size_t cause, Tally& tally) {
    const std::int64_t before = units_of(flux);
    flux = static_cast<float>(static_cast<double>(flux) * kept);
    tally.absorbed[cause] += before - units_of(flux);
  }

  static void put(WorldRays& rays, std::size_t i, const Ray& ray) {
    rays.x[i] = static_cast<float>(ray.origin_mm.x);
    rays.y[i] = static_cast<float>(ray.origin_mm.y);
    rays.z[i] = static_cast<float>(ray.origin_mm.z);
    rays.dx[i] = static_cast<float>(ray.direction.x());
    rays.dy[i] = static_cast<float>(ray.direction.y());
    rays.dz[i] = static_cast<float>(ray.direction.z());
  }

  /// Sends ray `i` through the cover glass it met; returns what sort_out notes of it.
  std::int32_t leave_glass(Batch& batch, std::size_t i, ReflectionKey key, Tally& tally) const {
    WorldRays& rays = batch.rays;
    const GlassHit& hit = *batch.glass[i];
    const int bounce = key.bounce;
    key.ray += static_cast<std::uint64_t>(rays.number[i]);
    const GlassPassage passage = glasses().pass(ray_of(rays, i), hit, key);
    const bool reflected = passage.kept > 0.0 && !passage.transmitted;
    if (reflected && !may_reflect(batch, i, bounce, tally)) return kGone;
    absorb(rays.flux[i], passage.kept, glass_cause(hit.glass), tally);
    if (passage.kept == 0.0) return kGone;
    if (reflected) ++tally.reflections;
    put(rays, i, passage.ray);
    return kOnBody;
  }

  static Ray ray_of(const WorldRays& rays, std::size_t i) {
    return {{rays.x[i], rays.y[i], rays.z[i]}, Direction::from({rays.dx[i], rays.dy[i], rays.dz[i]})};
  }

  /// Absorbs or reflects ray `i` where it met a body; returns what sort_out notes of it.
  std::int32_t leave_body(Batch& batch, std::size_t i, ReflectionKey key, Tally& tally) const {
    WorldRays& rays = batch.rays;
    const BodyHit& hit = *batch.body[i];
    const int bounce = key.bounce;
    key.ray += static_cast<std::uint64_t>(rays.number[i]);
    if (!may_reflect(batch, i, bounce, tally)) return kGone;
    const Ray ray = ray_of(rays, i);
    const double kept = scene_.bodies[hit.body].reflectance.at(-dot(ray.direction, hit.normal));
    absorb(rays.flux[i], kept, kMirrorLosses + hit.body, tally);
    if (kept == 0.0) return kGone;
    ++tally.reflections;
    put(rays, i, {ray.at(hit.t_mm), reflected_off(scene_.bodies[hit.body], ray.direction, hit, key)});
    return kOnBody;
  }

  /// Reflects what met mirror `m`, less what that absorbs, and notes its fate; `reflected` is how often
  /// before.
  void reflect_off(std::size_t m, const Meeting& meeting, std::size_t n, const std::int32_t* reflected,
                   Batch& batch, std::int32_t* fate, Tally& tally) const {
    const LocalHits& hits = meeting.hits;
    kernels_.reflect(mirrors_[m].world_from_mirror, meeting.rays, hits, n, batch.rays, batch.cosine);
    alignas(64) double kept[kBatch];
    const Reflectance& reflectance = *mirrors_[m].reflectance;
    if (reflectance.is_constant()) {
      std::fill_n(kept, n, reflectance.at(1.0));
    } else {
      for (std::size_t i = 0; i < n; ++i) {
        kept[i] = hits.state[i] == kFront ? reflectance.at(static_cast<double>(batch.cosine[i])) : 1.0;
      }
    }
    const MirrorSums sums = kernels_.settle_fates(hits, reflected, max_bounces_, kept,
                                                  static_cast<std::int32_t>(m), n, batch.rays.flux, fate);
    tally.absorbed[static_cast<std::size_t>(MirrorLoss::face)] += sums.face;
    tally.absorbed[static_cast<std::size_t>(MirrorLoss::back)] += sums.back;
    const auto limit = static_cast<std::size_t>(LostCause::bounce_limit);
    tally.lost[limit] += sums.lost;
    tally.lost_rays[limit] += static_cast<std::uint64_t>(sums.lost_rays);
    tally.reflections += static_cast<std::uint64_t>(sums.reflections);
  }

  /// Reflects what was reflected, moves what leaves to `out`, and closes the gaps; returns how many rays
  /// stay.
  std::size_t sort_out(Batch& batch, std::size_t n, std::span<const Meeting> meetings,
                       const ReflectionKey& first, Tally& tally) const {
    const int bounce = first.bounce;
    WorldRays& rays = batch.rays;
    alignas(64) std::int32_t fate[kBatch], reflected[kBatch];
    for (std::size_t i = 0; i < n; ++i) {
      fate[i] = kLeaves;
      reflected[i] = reflections(batch, rays, i, bounce);
    }
    for (std::size_t m = 0; m < mirrors_.size(); ++m)
      reflect_off(m, meetings[m], n, reflected, batch, fate, tally);
    for (std::size_t i = 0; !glasses().empty() && i < n; ++i) {
      if (fate[i] >= 0) ++batch.reflections[static_cast<std::size_t>(rays.number[i])];
    }
    for (std::size_t i = 0; !bodies().empty() && i < n; ++i) {
      if (batch.body[i]) fate[i] = leave_body(batch, i, first, tally);
    }
    for (std::size_t i = 0; !glasses().empty() && i < n; ++i) {
      if (batch.glass[i]) fate[i] = leave_glass(batch, i, first, tally);
    }
    return kernels_.part(rays, fate, n, batch.out, batch.out_count);
  }

  const Scene& scene_;
  const RayNumbering& numbering_;
  int max_bounces_;
  SequenceKind kind_;
  const Kernels& kernels_;
  // Null where the mirror is of another kind.
  std::vector<std::unique_ptr<const HeightField>> fields_;
  std::vector<std::unique_ptr<const FacetMirror>> facets_;
  std::vector<Mirror> mirrors_;
};

}  // namespace

std::unique_ptr<TraceEngine> make_wavefront_engine(const Scene& scene, const RayNumbering& numbering,
                                                   const TraceOptions& options) {
  return std::make_unique<WavefrontEngine>(scene, numbering, options);
}

}  // namespace lucerna
