// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <optional>
#include <span>

#include "lucerna/core/io/error.h"
#include "lucerna/optics/height_field/height_field.h"
#include "lucerna/trace/detectors/far_field_grid.h"
#include "lucerna/trace/engines/surface_finish.h"
#include "lucerna/trace/engines/trace_engine.h"
#include "lucerna/trace/kernels/curve_view.h"
#include "lucerna/trace/kernels/exact_mirrors.h"
#include "lucerna/trace/kernels/facet_mirror.h"
#include "lucerna/trace/kernels/field_view.h"
#include "lucerna/trace/tally/flux_quanta.h"

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
           finish_of(r)});
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
      emit_wavelengths(run, kind_, scratch);
      batch.wavelength_nm = scratch.wavelength_nm;
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
    SurfaceFinish finish;
  };
  /// All rays of one run on their way.
  struct Batch {
    WorldRays rays;
    WorldRays out;
    std::size_t out_count = 0;
    alignas(64) float cosine[kBatch];
    /// First hits with bodies, where those come before all mirrors; of no length without bodies.
    std::vector<std::optional<BodyHit>> body;
    /// The same of cover glasses and solids, where those come before all else.
    std::vector<std::optional<GlassHit>> glass;
    /// By number, how often each ray was reflected; kept only if there are any of these: else it is the same
    /// for all rays still on their way.
    std::array<int, kBatch> reflections;
    /// By number; only with cover glasses or solids.
    std::span<const float> wavelength_nm;
  };
  struct MirrorHits {
    LocalRays rays;
    LocalHits hits;
  };

  static void lose(LostCause cause, float flux, Tally& tally) {
    tally.lost[static_cast<std::size_t>(cause)] += quanta_of(flux);
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
    alignas(64) std::int32_t status[kBatch];
    for (std::size_t i = 0; i < n; ++i) {
      const bool finite =
          std::isfinite(in.x_mm[i] + in.y_mm[i] + in.z_mm[i] + in.kx[i] + in.ky[i] + in.kz[i]);
      status[i] = finite ? 0 : kTerminated;
      if (!finite) lose(LostCause::not_finite, out.flux[i], tally);
    }
    WorldRays none;
    std::size_t none_count = 0;
    const std::size_t stay = kernels_.compact(out, status, n, none, none_count);
    for (std::size_t i = 0; i < stay; ++i) out.mirror[i] = -1;
    return stay;
  }

  void follow(Batch& batch, std::size_t n, const SourceRun& run, TraceScratch& scratch, Tally& tally) const {
    const auto memory = std::make_unique_for_overwrite<MirrorHits[]>(mirrors_.size());
    const std::span<MirrorHits> mirror_hits(memory.get(), mirrors_.size());
    for (int bounce = 0; n > 0; ++bounce) {
      const std::size_t left_before = batch.out_count;
      intersect_mirrors(batch.rays, n, mirror_hits);
      if (!bodies().empty()) intersect_bodies(batch, n, bounce, mirror_hits);
      if (!glasses().empty()) intersect_glasses(batch, n, bounce, mirror_hits);
      for (std::size_t m = 0; m < mirrors_.size(); ++m) {
        if (mirrors_[m].finish.slope_error_rad > 0.0)
          tilt(mirrors_[m].finish.slope_error_rad, batch.rays, n, run, bounce, mirror_hits[m].hits);
      }
      n = resolve_interactions(batch, n, mirror_hits, {run.sequence_seed, run.first, bounce}, tally);
      count_leaving(batch, left_before, bounce, tally);
    }
    detect(batch.out, batch.out_count, scratch, tally);
  }

  /// Adds what left in step `bounce`, all of `out` from `first` on, to the ledger.
  void count_leaving(const Batch& batch, std::size_t first, int bounce, Tally& tally) const {
    std::int64_t direct = 0, all = 0;
    for (std::size_t i = first; i < batch.out_count; ++i) {
      const std::int64_t u = quanta_of(batch.out.flux[i]);
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
      for (std::size_t i = 0; i < n; ++i) bins[cell[i]] += quanta_of(out.flux[i]);
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
            quanta_of(out.flux[i]), scratch, tally);
    }
  }

  /// Of a hit, in the mirror's frame.
  static Direction normal_of(const LocalHits& hits, std::size_t i) {
    return Direction::from({-static_cast<double>(hits.gx[i]), -static_cast<double>(hits.gy[i]),
                            static_cast<double>(hits.gz[i])});
  }

  /// Sends on by its lobes what mirror `m` has mirrored.
  void scatter(std::size_t m, const LocalHits& hits, std::size_t n, ReflectionKey first,
               WorldRays& rays) const {
    for (std::size_t i = 0; i < n; ++i) {
      if (hits.state[i] != kFront) continue;
      ReflectionKey key = first;
      key.ray += static_cast<std::uint64_t>(rays.number[i]);
      const Direction normal = turned(mirrors_[m].world_from_mirror, normal_of(hits, i));
      const Ray mirrored = ray_of(rays, i);
      put(rays, i, {mirrored.origin_mm, scattered(mirrors_[m].finish, normal, mirrored.direction, key)});
    }
  }

  /// Gives the normals of all reflections of one mirror their slope error.
  static void tilt(double slope_error_rad, const WorldRays& rays, std::size_t n, const SourceRun& run,
                   int bounce, LocalHits& hits) {
    for (std::size_t i = 0; i < n; ++i) {
      if (hits.state[i] != kFront) continue;
      const ReflectionKey key{run.sequence_seed, run.first + static_cast<std::uint64_t>(rays.number[i]),
                              bounce};
      const Vec3 t = tilted_normal(normal_of(hits, i), slope_error_rad, key);
      hits.gx[i] = static_cast<float>(-t.x);
      hits.gy[i] = static_cast<float>(-t.y);
      hits.gz[i] = static_cast<float>(t.z);
    }
  }

  /// First hits with every mirror; where a ray hits several, all but the nearest become misses.
  void intersect_mirrors(const WorldRays& rays, std::size_t n, std::span<MirrorHits> mirror_hits) const {
    for (std::size_t m = 0; m < mirrors_.size(); ++m) {
      kernels_.to_local(mirrors_[m].mirror_from_world, rays, n, static_cast<std::int32_t>(m),
                        mirror_hits[m].rays);
      if (mirrors_[m].curve.node_count > 0) {
        intersect_curve(mirrors_[m].curve, mirror_hits[m].rays, n, mirror_hits[m].hits);
      } else if (mirrors_[m].facets.columns > 0) {
        intersect_facets(mirrors_[m].facets, mirror_hits[m].rays, n, mirror_hits[m].hits);
      } else {
        kernels_.intersect(mirrors_[m].field, mirror_hits[m].rays, n, mirror_hits[m].hits);
      }
    }
    for (std::size_t m = 1; m < mirrors_.size(); ++m) {
      for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t k = 0; k < m; ++k) {
          LocalHits &a = mirror_hits[k].hits, &b = mirror_hits[m].hits;
          if (a.state[i] == kMiss || b.state[i] == kMiss) continue;
          (b.t[i] < a.t[i] ? a : b).state[i] = kMiss;
        }
      }
    }
  }

  /// First hits with bodies; mirrors behind them become misses.
  void intersect_bodies(Batch& batch, std::size_t n, int bounce, std::span<MirrorHits> mirror_hits) const {
    for (std::size_t i = 0; i < n; ++i) {
      double nearest = std::numeric_limits<float>::max();
      for (const MirrorHits& m : mirror_hits) {
        if (m.hits.state[i] != kMiss) nearest = std::min(nearest, static_cast<double>(m.hits.t[i]));
      }
      const bool returning = reflections(batch, batch.rays, i, bounce) > 0;
      batch.body[i] = bodies().first_hit(ray_of(batch.rays, i), nearest, returning);
      if (!batch.body[i]) continue;
      for (MirrorHits& m : mirror_hits) m.hits.state[i] = kMiss;
    }
  }

  /// First hits with cover glasses and solids; mirrors and bodies behind them become misses.
  void intersect_glasses(Batch& batch, std::size_t n, int bounce, std::span<MirrorHits> mirror_hits) const {
    std::vector<Ray> rays(n);
    std::vector<double> nearest(n, std::numeric_limits<float>::max());
    for (std::size_t i = 0; i < n; ++i) {
      rays[i] = ray_of(batch.rays, i);
      for (const MirrorHits& m : mirror_hits) {
        if (m.hits.state[i] != kMiss) nearest[i] = std::min(nearest[i], static_cast<double>(m.hits.t[i]));
      }
      if (!bodies().empty() && batch.body[i]) nearest[i] = std::min(nearest[i], batch.body[i]->t_mm);
    }
    glasses().first_hits(rays, bounce > 0, nearest, std::span(batch.glass).first(n));
    for (std::size_t i = 0; i < n; ++i) {
      if (!batch.glass[i]) continue;
      if (!bodies().empty()) batch.body[i].reset();
      for (MirrorHits& m : mirror_hits) m.hits.state[i] = kMiss;
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
  static void absorb(float& flux, double throughput, std::size_t cause, Tally& tally) {
    const std::int64_t before = quanta_of(flux);
    flux = static_cast<float>(static_cast<double>(flux) * throughput);
    tally.absorbed[cause] += before - quanta_of(flux);
  }

  static void put(WorldRays& rays, std::size_t i, const Ray& ray) {
    rays.x[i] = static_cast<float>(ray.origin_mm.x);
    rays.y[i] = static_cast<float>(ray.origin_mm.y);
    rays.z[i] = static_cast<float>(ray.origin_mm.z);
    rays.dx[i] = static_cast<float>(ray.direction.x());
    rays.dy[i] = static_cast<float>(ray.direction.y());
    rays.dz[i] = static_cast<float>(ray.direction.z());
  }

  /// Sends all rays through the cover glasses and solids that they hit, and notes their statuses.
  void transmit(Batch& batch, std::size_t n, const ReflectionKey& first, std::int32_t* status,
                Tally& tally) const {
    std::vector<GlassRay> rays;
    std::vector<std::size_t> which;
    for (std::size_t i = 0; i < n; ++i) {
      if (!batch.glass[i]) continue;
      const auto number = static_cast<std::size_t>(batch.rays.number[i]);
      ReflectionKey key = first;
      key.ray += number;
      rays.push_back({ray_of(batch.rays, i), *batch.glass[i], key, batch.wavelength_nm[number]});
      which.push_back(i);
    }
    std::vector<GlassPassage> passages(rays.size());
    glasses().pass(rays, passages);
    for (std::size_t k = 0; k < which.size(); ++k)
      status[which[k]] = transmit(batch, which[k], passages[k], first.bounce, tally);
  }

  /// Sends ray `i` on; returns what resolve_interactions notes of it.
  std::int32_t transmit(Batch& batch, std::size_t i, const GlassPassage& passage, int bounce,
                        Tally& tally) const {
    WorldRays& rays = batch.rays;
    const GlassHit& hit = *batch.glass[i];
    const bool reflected = passage.throughput > 0.0 && !passage.transmitted;
    if (reflected && !may_reflect(batch, i, bounce, tally)) return kTerminated;
    absorb(rays.flux[i], passage.throughput, glass_cause(hit.glass), tally);
    if (passage.throughput == 0.0) return kTerminated;
    if (passage.lost) {
      lose(LostCause::bounce_limit, rays.flux[i], tally);
      return kTerminated;
    }
    if (reflected) ++tally.reflections;
    put(rays, i, passage.ray);
    return kHitObstacle;
  }

  static Ray ray_of(const WorldRays& rays, std::size_t i) {
    return {{rays.x[i], rays.y[i], rays.z[i]}, Direction::from({rays.dx[i], rays.dy[i], rays.dz[i]})};
  }

  /// Absorbs or reflects ray `i` where it hit a body; returns what resolve_interactions notes of it.
  std::int32_t reflect_off_body(Batch& batch, std::size_t i, ReflectionKey key, Tally& tally) const {
    WorldRays& rays = batch.rays;
    const BodyHit& hit = *batch.body[i];
    const int bounce = key.bounce;
    key.ray += static_cast<std::uint64_t>(rays.number[i]);
    if (!may_reflect(batch, i, bounce, tally)) return kTerminated;
    const Ray ray = ray_of(rays, i);
    const double throughput = scene_.bodies[hit.body].reflectance.at(-dot(ray.direction, hit.normal));
    absorb(rays.flux[i], throughput, kMirrorLosses + hit.body, tally);
    if (throughput == 0.0) return kTerminated;
    ++tally.reflections;
    put(rays, i, {ray.at(hit.t_mm), reflected_off(scene_.bodies[hit.body], ray.direction, hit, key)});
    return kHitObstacle;
  }

  /// Reflects what met mirror `m`, less what that absorbs, and notes its status; `reflected` is how often
  /// before.
  void reflect_off(std::size_t m, const MirrorHits& at_mirror, std::size_t n, const std::int32_t* reflected,
                   const ReflectionKey& first, Batch& batch, std::int32_t* status, Tally& tally) const {
    const LocalHits& hits = at_mirror.hits;
    kernels_.reflect(mirrors_[m].world_from_mirror, at_mirror.rays, hits, n, batch.rays, batch.cosine);
    if (mirrors_[m].finish.scatters()) scatter(m, hits, n, first, batch.rays);
    alignas(64) double throughput[kBatch];
    const Reflectance& reflectance = *mirrors_[m].reflectance;
    if (reflectance.is_constant()) {
      std::fill_n(throughput, n, reflectance.at(1.0));
    } else {
      for (std::size_t i = 0; i < n; ++i) {
        throughput[i] = hits.state[i] == kFront ? reflectance.at(static_cast<double>(batch.cosine[i])) : 1.0;
      }
    }
    const MirrorSums sums = kernels_.resolve_hits(hits, reflected, max_bounces_, throughput,
                                                  static_cast<std::int32_t>(m), n, batch.rays.flux, status);
    tally.absorbed[static_cast<std::size_t>(MirrorLoss::face)] += sums.face;
    tally.absorbed[static_cast<std::size_t>(MirrorLoss::back)] += sums.back;
    const auto limit = static_cast<std::size_t>(LostCause::bounce_limit);
    tally.lost[limit] += sums.lost;
    tally.lost_rays[limit] += static_cast<std::uint64_t>(sums.lost_rays);
    tally.reflections += static_cast<std::uint64_t>(sums.reflections);
  }

  /// Reflects what was reflected, moves what leaves to `out`, and closes the gaps; returns how many rays
  /// stay.
  std::size_t resolve_interactions(Batch& batch, std::size_t n, std::span<const MirrorHits> mirror_hits,
                                   const ReflectionKey& first, Tally& tally) const {
    const int bounce = first.bounce;
    WorldRays& rays = batch.rays;
    alignas(64) std::int32_t status[kBatch], reflected[kBatch];
    for (std::size_t i = 0; i < n; ++i) {
      status[i] = kEscaped;
      reflected[i] = reflections(batch, rays, i, bounce);
    }
    for (std::size_t m = 0; m < mirrors_.size(); ++m)
      reflect_off(m, mirror_hits[m], n, reflected, first, batch, status, tally);
    for (std::size_t i = 0; !glasses().empty() && i < n; ++i) {
      if (status[i] >= 0) ++batch.reflections[static_cast<std::size_t>(rays.number[i])];
    }
    for (std::size_t i = 0; !bodies().empty() && i < n; ++i) {
      if (batch.body[i]) status[i] = reflect_off_body(batch, i, first, tally);
    }
    if (!glasses().empty()) transmit(batch, n, first, status, tally);
    return kernels_.compact(rays, status, n, batch.out, batch.out_count);
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
