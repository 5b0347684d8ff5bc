// SPDX-License-Identifier: Apache-2.0
#include "trace.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <thread>
#include <vector>

namespace bench {

namespace {

constexpr int kMaxHits = 200;
/// Weaker reflections of interfaces go on as often as they are weaker, with this weight: of a lens most do
/// not. That saves two fifths of the time; the error keeps its noise, light beside the rectangle has twice as
/// much.
constexpr double kFaint = 0.3;
/// Faces that meet in a curved edge end at chords of it, each at its own. A ray slips between chords that are
/// up to a thousandth of a millimetre (kChordMm) apart; one that is this far beside it does not.
constexpr double kBesideMm = 0.002;

/// Light on its way. `lossless`: its weight if nothing were lost; 0 for what an interface reflects partly.
struct Path {
  Vec3 origin, direction;
  double weight = 1.0, lossless = 1.0;
  bool inside = false;
  int hits = 0;
};

class Tracer {
 public:
  Tracer(const Task& task, const Source& source, const SurfaceScene& scene, const Target& target,
         std::uint64_t seed)
      : task_(task), source_(source), scene_(scene), target_(target), seed_(seed), tally_(target) {}

  void ray(std::uint64_t index) {
    replicate_ = (index / kRun) % kReplicates;
    RayRandom random(seed_, index);
    const SourceRay start = source_.ray(index, random);
    sums().emitted += Tally::quanta(start.weight);
    waiting_.push_back({start.origin, start.direction, start.weight, start.weight});
    while (!waiting_.empty()) {
      const Path path = waiting_.back();
      waiting_.pop_back();
      follow(path, random);
    }
  }
  const Tally& tally() const { return tally_; }

 private:
  Sums& sums() { return tally_[replicate_].sums; }
  static void add(std::uint64_t& sum, double weight) { sum += Tally::quanta(weight); }

  void follow(Path p, RayRandom& random) {
    for (;; ++p.hits) {
      if (p.hits > kMaxHits) return add(sums().too_many_hits, p.weight);
      const SurfaceScene::PartHit found = next_hit(p);
      const double t = found.part != nullptr ? found.hit.t : std::numeric_limits<double>::infinity();
      if (p.hits > 0 && task_.source_body.hit(p.origin, p.direction, t)) return add(sums().source, p.weight);
      if (found.part == nullptr) return leave(p);
      if (p.inside) fade(p, t);
      p.origin = p.origin + t * p.direction;
      if (!interact(p, found, random)) return;
    }
  }

  /// The first hit, or that of a ray beside it, which `p` then becomes, where the first is on the wrong side.
  SurfaceScene::PartHit next_hit(Path& p) const {
    const SurfaceScene::PartHit found = scene_.first_hit(p.origin, p.direction);
    if (right_side(p, found)) return found;
    const Frame ray = frame_about(p.direction);
    for (const Vec3& side : {ray.x, ray.y, -ray.x, -ray.y}) {
      const Vec3 beside = p.origin + kBesideMm * side;
      const SurfaceScene::PartHit other = scene_.first_hit(beside, p.direction);
      if (!right_side(p, other)) continue;
      p.origin = beside;
      return other;
    }
    return found;
  }

  /// Can light in the medium of `p` meet this next?
  static bool right_side(const Path& p, const SurfaceScene::PartHit& next) {
    if (next.part == nullptr) return !p.inside;
    return next.part->role != Role::interface || enters(p, next) != p.inside;
  }
  static bool enters(const Path& p, const SurfaceScene::PartHit& at) {
    return dot(p.direction, at.hit.geometric) < 0.0;
  }

  void leave(const Path& p) {
    if (p.inside) return add(sums().wrong_side, p.weight);
    tally_.leaves(replicate_, target_.land(p.origin, p.direction), p.weight, p.lossless, p.hits == 0);
  }

  void fade(Path& p, double way_mm) {
    if (task_.optics.absorption_per_mm == 0.0) return;
    const double kept = p.weight * std::exp(-task_.optics.absorption_per_mm * way_mm);
    add(sums().bulk, p.weight - kept);
    p.weight = kept;
  }

  /// False where the path ends.
  bool interact(Path& p, const SurfaceScene::PartHit& at, RayRandom& random) {
    if (at.part->role == Role::interface) return cross_interface(p, at, random);
    if (at.part->role == Role::absorber) {
      add(sums().absorber, p.weight);
      return false;
    }
    if (!enters(p, at)) {
      add(sums().mirror_back, p.weight);
      return false;
    }
    const double kept = p.weight * task_.optics.reflectance;
    add(sums().mirror, p.weight - kept);
    p.weight = kept;
    p.direction = reflected(p.direction, at.hit.normal);
    return true;
  }

  static Vec3 reflected(const Vec3& d, const Vec3& n) { return unit(d - 2.0 * dot(d, n) * n); }

  bool cross_interface(Path& p, const SurfaceScene::PartHit& at, RayRandom& random) {
    if (!right_side(p, at)) {
      add(sums().wrong_side, p.weight);
      return false;
    }
    const double n = at.part->refractive_index;
    const bool in = enters(p, at);
    const Vec3 normal = in ? at.hit.normal : -at.hit.normal;
    const Refraction r = refract(p.direction, normal, in ? 1.0 : n, in ? n : 1.0);
    if (r.reflected >= 1.0) {
      p.direction = reflected(p.direction, normal);
      return true;
    }
    const Optics& o = task_.optics;
    const double taken = p.weight * (o.fresnel ? r.reflected : o.interface_loss);
    if (!o.fresnel) add(sums().interface, taken);
    if (o.fresnel) follow_reflection(p, reflected(p.direction, normal), taken, random);
    p.weight -= taken;
    p.inside = in;
    p.direction = r.direction;
    return p.lossless > 0.0 || survives(p.weight, random);
  }

  /// Faint light that goes on as often as it is fainter than kFaint keeps its mean.
  static bool survives(double& weight, RayRandom& random) {
    if (weight >= kFaint) return true;
    if (random.uniform() * kFaint >= weight) return false;
    weight = kFaint;
    return true;
  }

  void follow_reflection(const Path& p, const Vec3& direction, double weight, RayRandom& random) {
    if (!survives(weight, random)) return;
    waiting_.push_back({p.origin, direction, weight, 0.0, p.inside, p.hits + 1});
  }

  const Task& task_;
  const Source& source_;
  const SurfaceScene& scene_;
  const Target& target_;
  std::uint64_t seed_;
  std::size_t replicate_ = 0;
  std::vector<Path> waiting_;
  Tally tally_;
};

}  // namespace

Refraction refract(const Vec3& direction, const Vec3& normal, double n1, double n2) {
  const double cosine = -dot(direction, normal), ratio = n1 / n2;
  const double sine2 = ratio * ratio * (1.0 - cosine * cosine);
  if (!(cosine > 0.0) || sine2 >= 1.0) return {};
  const double other = std::sqrt(1.0 - sine2);
  const double s = (n1 * cosine - n2 * other) / (n1 * cosine + n2 * other);
  const double p = (n2 * cosine - n1 * other) / (n2 * cosine + n1 * other);
  return {0.5 * (s * s + p * p), unit(ratio * direction + (ratio * cosine - other) * normal)};
}

std::uint64_t whole_rays(std::uint64_t rays, const Source& source) {
  if (source.count() > 0) return source.count();
  constexpr std::uint64_t kUnit = kRun * kReplicates;
  return (rays + kUnit - 1) / kUnit * kUnit;
}

Tally trace(const Task& task, const Source& source, const SurfaceScene& scene, const Target& target,
            const TraceSettings& settings) {
  const std::uint64_t rays = whole_rays(settings.rays, source);
  std::vector<Tracer> tracers(std::max(1U, settings.threads),
                              Tracer(task, source, scene, target, settings.seed));
  std::atomic<std::uint64_t> next{0};
  const auto work = [&](Tracer& tracer) {
    for (std::uint64_t first = next.fetch_add(kRun); first < rays; first = next.fetch_add(kRun)) {
      for (std::uint64_t i = first; i < std::min(rays, first + kRun); ++i) tracer.ray(i);
    }
  };
  std::vector<std::thread> threads;
  for (std::size_t k = 1; k < tracers.size(); ++k) threads.emplace_back(work, std::ref(tracers[k]));
  work(tracers[0]);
  for (std::thread& t : threads) t.join();
  Tally sum(target);
  for (const Tracer& t : tracers) sum += t.tally();
  return sum;
}

}  // namespace bench
