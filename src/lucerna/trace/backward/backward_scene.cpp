// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/backward/backward_scene.h"

#include <algorithm>
#include <limits>

#include "lucerna/core/io/error.h"
#include "lucerna/trace/kernels/facet_mirror.h"

namespace lucerna {

namespace {

/// Past everything; a start there loses less than a nanometre.
constexpr double kFarAway_mm = 1e6;

/// A slope error turns where light goes but not how much of a mirror it sees: over the surface's own normal,
/// a mirror takes light in by the cosine of incidence and gives it off by that of exit.
struct Reflection {
  Direction backward;
  double factor = 0.0;
};

Reflection reflect_backward(const PlacedReflector& mirror, double slope_error_rad, const Direction& normal,
                            const Direction& out, const ReflectionKey& key) {
  const Direction tilted = slope_error_rad > 0.0 ? tilted_normal(normal, slope_error_rad, key) : normal;
  // Both point away from the surface: where the light goes, and where it came from.
  const Direction from = Direction::from(2.0 * dot(out, tilted) * tilted.vec() - out.vec());
  const double cos_out = dot(out, normal), cos_in = dot(from, normal);
  if (!(cos_out > 0.0 && cos_in > 0.0)) return {from, 0.0};
  return {from, mirror.reflectance.at(cos_in) * cos_in / cos_out};
}

}  // namespace

/// On a mirror, or on the cover glass.
struct BackwardScene::Hit {
  const Mirror* mirror = nullptr;
  double t_mm = 0.0;
  Vec3 point;
  Direction normal;
  bool front = true;
  std::optional<GlassHit> glass = {};
};

std::string no_backward_reason(const Scene& scene) {
  for (const PlacedSource& s : scene.sources) {
    if (luminance_of(*s.rays) == nullptr) return "a source has no known luminance";
  }
  for (const PlacedReflector& r : scene.reflectors) {
    if (r.reflector.curve) return "a mirror is a swept curve";
    if (faceted(r.reflector) != nullptr) return "a mirror is faceted";
    if (!r.scatter.empty()) return "a mirror scatters";
  }
  for (const Body& b : scene.bodies) {
    if (b.reflectance.max() > 0.0) return "a body reflects";
  }
  if (!scene.solids.empty()) return "there is a solid";
  // Light between two plates leaves after any number of reflections.
  return scene.glasses.size() > 1 ? "there are several cover glasses" : "";
}

BackwardScene::BackwardScene(const Scene& scene, int max_bounces)
    : max_bounces_(max_bounces), bodies_(scene.bodies), glasses_(scene.glasses) {
  check(scene);
  const std::string reason = no_backward_reason(scene);
  if (!reason.empty()) throw InputError("light cannot be followed backward: " + reason);
  for (const PlacedReflector& r : scene.reflectors) {
    mirrors_.push_back(
        {&r, MirrorTracer(r.reflector), r.world_from_reflector.inverse(), 1e-3 * r.slope_error_mrad});
  }
  for (const PlacedSource& s : scene.sources) {
    sources_.push_back(
        {luminance_of(*s.rays), s.world_from_source, s.world_from_source.inverse(), s.total_flux()});
  }
}

std::span<const Exit> BackwardScene::exits() const {
  static constexpr Exit kExits[] = {Exit::onward, Exit::off_glass};
  return {kExits, glasses_.empty() ? 1u : 2u};
}

Direction BackwardScene::direction_before(Exit exit, const Direction& out) const {
  if (exit == Exit::onward) return out;
  const Vec3 normal = glasses_.cover_glasses().front().world_from_glass.ez();
  return Direction::from(out.vec() - 2.0 * dot(normal, out.vec()) * normal);
}

std::optional<BackwardScene::Hit> BackwardScene::nearest(const Ray& ray) const {
  std::optional<Hit> best;
  for (const Mirror& m : mirrors_) {
    const auto hit = m.tracer.first_hit(m.mirror_from_world.ray(ray));
    if (!hit || (best && best->t_mm <= hit->t_mm)) continue;
    const Frame& world_from_mirror = m.placed->world_from_reflector;
    best = {&m, hit->t_mm, world_from_mirror.point(hit->point_mm), world_from_mirror.direction(hit->normal),
            hit->front};
  }
  if (glasses_.empty()) return best;
  if (const auto glass = glasses_.first_hit(ray, best ? best->t_mm : kNoEnd, true)) {
    best.emplace();
    best->t_mm = glass->t_mm;
    best->glass = glass;
  }
  return best;
}

/// What light that goes on against `backward` came to at `at`: which share of it that is, and on which line.
BackwardScene::Step BackwardScene::step_back(const Hit& at, const ReflectionKey& key,
                                             const Ray& backward) const {
  if (at.glass) {
    // A plate is the same for light both ways.
    const GlassPassage passage = glasses_.pass(backward, *at.glass, key, 0.0f);
    return {passage.ray, passage.throughput, !passage.transmitted};
  }
  if (!at.front) return {backward, 0.0, true};
  const Reflection r =
      reflect_backward(*at.mirror->placed, at.mirror->slope_error_rad, at.normal, -backward.direction, key);
  return {{at.point, r.backward}, r.factor, true};
}

/// Light that starts on the line of `backward` within `reach_mm` of its origin and runs against it.
double BackwardScene::emitted_on(const Ray& backward, double reach_mm, Scratch& scratch) const {
  double sum = 0.0;
  for (const Source& s : sources_) {
    scratch.clear();
    const Ray light{backward.origin_mm, -backward.direction};
    s.light->add_light_on(s.source_from_world.ray(light), scratch);
    for (const LineLight& l : scratch) {
      if (l.start_mm <= 0.0 && -l.start_mm < reach_mm) sum += s.flux * l.pdf_etendue;
    }
  }
  return sum;
}

double BackwardScene::reflected_luminance(const Mirror& mirror, const Vec3& point, const Direction& normal,
                                          const Direction& out, Exit exit, ReflectionKey key,
                                          Scratch& scratch) const {
  double sum = 0.0, throughput = 1.0;
  Hit at{&mirror, 0.0, point, normal};
  Ray backward{point, -out};
  int reflections = exit == Exit::off_glass ? 1 : 0;
  for (int met = 1;; ++met) {
    key.bounce = met;
    const Step step = step_back(at, key, backward);
    throughput *= step.share;
    reflections += step.reflected ? 1 : 0;
    if (!(throughput > 0.0) || reflections > max_bounces_) break;
    backward = step.backward;
    const auto next = nearest(backward);
    const double next_mm = next ? next->t_mm : kNoEnd;
    // Light that comes straight from a lamp does not see the lamp's own body.
    const auto body = bodies_.first_hit(backward, next_mm, false);
    sum += throughput * emitted_on(backward, body ? body->t_mm : next_mm, scratch);
    if (!next || bodies_.first_hit(backward, next_mm, true)) break;
    at = *next;
  }
  return sum;
}

bool BackwardScene::escapes(const Ray& ray, bool returning) const {
  return !nearest(ray) && !bodies_.first_hit(ray, kNoEnd, returning);
}

double BackwardScene::leaving_share(const Vec3& point, const Direction& start, Exit exit, bool returning,
                                    const ReflectionKey& key) const {
  const Ray ray{point, start};
  const auto first = nearest(ray);
  if (bodies_.first_hit(ray, first ? first->t_mm : kNoEnd, returning)) return 0.0;
  if (!first) return exit == Exit::onward ? 1.0 : 0.0;
  if (!first->glass) return 0.0;
  const PlacedCoverGlass& plate = glasses_.cover_glasses()[first->glass->glass];
  const GlassSides side = exit == Exit::onward ? GlassSides::transmitted : GlassSides::reflected;
  const GlassPassage passage = through_cover_glass(plate, ray, *first->glass, key, side);
  return passage.throughput > 0.0 && escapes(passage.ray, returning || exit == Exit::off_glass)
             ? passage.throughput
             : 0.0;
}

double BackwardScene::direct_luminance(const Source& source, const Ray& ray, Exit exit,
                                       const ReflectionKey& key, Scratch& scratch, double end_mm) const {
  scratch.clear();
  source.light->add_light_on(source.source_from_world.ray(ray), scratch);
  double sum = 0.0;
  for (const LineLight& l : scratch) {
    if (l.start_mm < end_mm)
      sum += source.flux * l.pdf_etendue * leaving_share(ray.at(l.start_mm), ray.direction, exit, false, key);
  }
  return sum;
}

double BackwardScene::leaving_luminance(const Ray& line, ReflectionKey key, Scratch& scratch,
                                        double end_mm) const {
  LUCERNA_CHECK(glasses_.empty(), "{} cover glasses", glasses_.cover_glasses().size());
  double sum = 0.0;
  for (const Source& s : sources_) sum += direct_luminance(s, line, Exit::onward, key, scratch, end_mm);
  const Ray against{line.at(kFarAway_mm), -line.direction};
  const auto last = nearest(against);
  if (!last || !last->front || kFarAway_mm - last->t_mm > end_mm) return sum;
  if (!escapes({last->point, line.direction}, true)) return sum;
  return sum + reflected_luminance(*last->mirror, last->point, last->normal, line.direction, Exit::onward,
                                   key, scratch);
}

}  // namespace lucerna
