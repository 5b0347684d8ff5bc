// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/validation/validation.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include "lucerna/core/io/error.h"
#include "lucerna/core/io/message_bytes.h"
#include "lucerna/core/parallel/counted_progress.h"
#include "lucerna/core/parallel/parallel.h"
#include "lucerna/design/validation/mesh_hits.h"
#include "lucerna/design/validation/mesh_tolerance.h"
#include "lucerna/trace/engines/body_tracer.h"
#include "lucerna/trace/engines/ray_numbering.h"
#include "lucerna/trace/tally/flux_quanta.h"

namespace lucerna {

namespace {

constexpr int kMaxReflections = 100;
/// Rays of the first round; each further one doubles what there is.
constexpr std::uint64_t kFirstRound = std::uint64_t{1} << 18;
/// An error is known where its standard error is this share of it, from so many rays on.
constexpr double kKnown = 0.01;
constexpr std::uint64_t kFewestRays = std::uint64_t{1} << 20;
/// Rays that are one block of every replicate.
constexpr std::uint64_t kRoundUnit = kReplicates * kBlockRays;
/// Reflected rays start this share of the scene's size in front of the facet: some roundings of float32, so
/// that none hits its own facet from behind.
constexpr double kLift = 4e-6;

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// The scene's solid things in the frame that rays are traced in: that of the first mirror, where coordinates
/// are small. Mirrors come first, then the bodies.
class Meshes {
 public:
  Meshes(const Scene& scene, const ErrorBoxes& boxes, std::span<const double> target,
         const ValidationOptions& options)
      : scene_(scene),
        mirrors_(scene.reflectors.size()),
        local_from_world_(scene.reflectors.empty() ? Frame()
                                                   : scene.reflectors[0].world_from_reflector.inverse()) {
    for (const PlacedReflector& mirror : scene.reflectors) {
      CadTolerance tolerance =
          options.tolerance.value_or(mesh_tolerance(boxes, target, mirror.world_from_reflector.origin_mm()));
      Body body;
      body.mesh = std::make_shared<const Mesh>(cad_mesh_within(mirror.reflector, tolerance));
      body.world_from_body = local_from_world_ * mirror.world_from_reflector;
      if (tolerance.slope_deg > tolerance_.slope_deg) tolerance_ = tolerance;
      add(body);
    }
    if (mirrors_ > 0) {
      middle_mm_ = 0.5 * (low_mm_ + high_mm_);
      radius_mm_ = 0.5 * length(high_mm_ - low_mm_);
    }
    for (Body body : scene.bodies) {
      check(body);
      body.world_from_body = local_from_world_ * body.world_from_body;
      add(body);
    }
    embree_ = options.engine == HitEngine::best ? has_embree() : options.engine == HitEngine::embree;
    const auto finder = [&](const std::vector<Body>& bodies) {
      return std::shared_ptr<const MeshHitFinder>(embree_ ? embree_hits(bodies) : tree_hits(bodies));
    };
    returning_ = finder(bodies_);
    direct_ = returning_;
    if (std::any_of(bodies_.begin(), bodies_.end(), [](const Body& b) { return b.only_returning_light; })) {
      std::vector<Body> some = bodies_;
      for (Body& b : some) {
        if (b.only_returning_light) b.mesh = std::make_shared<const Mesh>();
      }
      direct_ = finder(some);
    }
  }

  const MeshHitFinder& finder(bool returning) const { return returning ? *returning_ : *direct_; }
  const Frame& local_from_world() const { return local_from_world_; }
  std::size_t triangles() const { return triangles_; }
  const CadTolerance& tolerance() const { return tolerance_; }
  bool embree() const { return embree_; }
  double lift_mm() const { return kLift * size_mm_; }
  /// Where a ray that starts within a sphere about the mirrors leaves it, seen from its middle in radii: near
  /// its hit. Of others the direction.
  Vec3 on_sphere(const Vec3& from, const Vec3& along) const {
    const Vec3 p = (1.0 / radius_mm_) * (from - middle_mm_);
    const double b = dot(p, along), outside = dot(p, p) - 1.0;
    return outside < 0.0 ? p + (std::sqrt(b * b - outside) - b) * along : along;
  }
  /// The mirror of a mesh, or null for a body.
  const PlacedReflector* mirror(std::uint32_t mesh) const {
    return mesh < mirrors_ ? &scene_.reflectors[mesh] : nullptr;
  }
  const Body& body(std::uint32_t mesh) const { return bodies_[mesh]; }
  /// Unit normal of a facet, on the side that its corners run counter-clockwise on.
  Vec3 normal(std::uint32_t mesh, std::uint32_t triangle) const {
    const std::array<float, 3>& n = normals_[mesh][triangle];
    return {static_cast<double>(n[0]), static_cast<double>(n[1]), static_cast<double>(n[2])};
  }
  /// Three smooth normals of a body's facet, or null.
  const Vec3* corners(std::uint32_t mesh, std::uint32_t triangle) const {
    return smooth_[mesh].empty() ? nullptr : &smooth_[mesh][std::size_t{3} * triangle];
  }

 private:
  void add(const Body& body) {
    const Mesh& mesh = *body.mesh;
    std::vector<std::array<float, 3>>& normals = normals_.emplace_back();
    normals.reserve(mesh.triangles.size());
    for (const auto& t : mesh.triangles) {
      const Vec3 &a = mesh.vertices_mm[t[0]], &b = mesh.vertices_mm[t[1]], &c = mesh.vertices_mm[t[2]];
      const Vec3 n = body.world_from_body.vector(cross(b - a, c - a));
      const double l = length(n) > 0.0 ? length(n) : 1.0;
      normals.push_back(
          {static_cast<float>(n.x / l), static_cast<float>(n.y / l), static_cast<float>(n.z / l)});
    }
    for (const Vec3& p : mesh.vertices_mm) {
      const Vec3 q = body.world_from_body.point(p);
      size_mm_ = std::max({size_mm_, std::abs(q.x), std::abs(q.y), std::abs(q.z)});
      low_mm_ = {std::min(low_mm_.x, q.x), std::min(low_mm_.y, q.y), std::min(low_mm_.z, q.z)};
      high_mm_ = {std::max(high_mm_.x, q.x), std::max(high_mm_.y, q.y), std::max(high_mm_.z, q.z)};
    }
    smooth_.push_back(smooth_normals(body));
    triangles_ += mesh.triangles.size();
    bodies_.push_back(body);
  }

  const Scene& scene_;
  std::size_t mirrors_, triangles_ = 0;
  /// Corners of what was added, and a sphere about the mirrors, which come first.
  static constexpr double kFar = std::numeric_limits<double>::infinity();
  Vec3 low_mm_{kFar, kFar, kFar}, high_mm_ = -low_mm_, middle_mm_{};
  double radius_mm_ = 1.0;
  /// The coarsest of the mirrors'.
  CadTolerance tolerance_{.chord_mm = 0.0, .slope_deg = 0.0};
  Frame local_from_world_;
  double size_mm_ = 1.0;
  bool embree_ = false;
  std::vector<Body> bodies_;
  std::vector<std::vector<std::array<float, 3>>> normals_;
  std::vector<std::vector<Vec3>> smooth_;
  std::shared_ptr<const MeshHitFinder> direct_, returning_;
};

bool is_rough(const Scene& scene) {
  const auto has = [](const auto& thing) { return is_rough(finish_of(thing)); };
  return std::any_of(scene.reflectors.begin(), scene.reflectors.end(), has) ||
         std::any_of(scene.bodies.begin(), scene.bodies.end(), has);
}

/// Traces batches of one task.
class BatchTracer {
 public:
  BatchTracer(const Scene& scene, const RayNumbering& numbering, const Meshes& meshes,
              const ErrorBoxes& boxes, const ValidationOptions& options)
      : scene_(scene),
        numbering_(numbering),
        meshes_(meshes),
        boxes_(boxes),
        zones_(options.zones),
        glare_(options.glare),
        world_from_local_(meshes.local_from_world().inverse()),
        keyed_(is_rough(scene)),
        key_(keyed_ ? kMeshBatch : 0),
        spare_key_(key_) {}

  /// Adds the rays of a block of numbers to the batch, and traces it when it is full.
  void add_block(std::uint64_t block, BoxSums& sums) {
    for (const SourceRun& run : numbering_.runs(block * kBlockRays, (block + 1) * kBlockRays)) {
      emit(run, sums);
    }
    sums.rays += kBlockRays;
    if (count_ + 2 * kBlockRays > kMeshBatch) finish(sums);
  }

  /// Traces what is in the batch to its end.
  void finish(BoxSums& sums) {
    sort_by_place();
    for (int reflections = 0; count_ > 0; ++reflections) {
      meshes_.finder(reflections > 0).first_hits(rays_, count_, hits_);
      std::size_t retained = 0;
      for (std::size_t i = 0; i < count_; ++i) {
        if (!interact(i, reflections, sums)) continue;
        move(i, retained);
        ++retained;
      }
      count_ = retained;
    }
  }

 private:
  /// Rays of a Sobol sequence are far apart from one to the next; neighbours share what they need of the
  /// meshes. A counting sort in a Morton order of where they go to, for a long source has rays of one
  /// direction everywhere.
  void sort_by_place() {
    std::fill(std::begin(begin_), std::end(begin_), 0u);
    for (std::size_t i = 0; i < count_; ++i) {
      const auto cell = [](double cosine) {
        constexpr double kHalf = 0.5 * kSortSide;
        return static_cast<std::uint32_t>(std::clamp(kHalf + kHalf * cosine, 0.0, kSortSide - 1.0));
      };
      const Vec3 to = meshes_.on_sphere(origin(i), direction(i));
      const std::uint32_t behind = to.z < 0.0 ? 0u : kSortSide * kSortSide;
      sort_key_[i] = behind + spread_bits(cell(to.x)) + 2 * spread_bits(cell(to.y));
      ++begin_[sort_key_[i] + 1];
    }
    for (std::size_t k = 1; k < std::size(begin_); ++k) begin_[k] += begin_[k - 1];
    for (std::size_t i = 0; i < count_; ++i) order_[begin_[sort_key_[i]]++] = static_cast<std::uint32_t>(i);
    const auto reorder = [&](auto& values, auto& spare) {
      for (std::size_t i = 0; i < count_; ++i) spare[i] = values[order_[i]];
      std::copy_n(&spare[0], count_, &values[0]);
    };
    for (auto* values : {&rays_.x, &rays_.y, &rays_.z, &rays_.dx, &rays_.dy, &rays_.dz}) {
      reorder(*values, hits_.t);
    }
    reorder(flux_, spare_flux_);
    if (keyed_) reorder(key_, spare_key_);
  }
  /// 0b1011 -> 0b1000101.
  static std::uint32_t spread_bits(std::uint32_t x) {
    x = (x | x << 4) & 0x0F0Fu;
    x = (x | x << 2) & 0x3333u;
    return (x | x << 1) & 0x5555u;
  }

  Vec3 origin(std::size_t i) const {
    return {static_cast<double>(rays_.x[i]), static_cast<double>(rays_.y[i]),
            static_cast<double>(rays_.z[i])};
  }
  Vec3 direction(std::size_t i) const {
    return {static_cast<double>(rays_.dx[i]), static_cast<double>(rays_.dy[i]),
            static_cast<double>(rays_.dz[i])};
  }
  void set(std::size_t i, const Vec3& p, const Vec3& d) {
    rays_.x[i] = static_cast<float>(p.x);
    rays_.y[i] = static_cast<float>(p.y);
    rays_.z[i] = static_cast<float>(p.z);
    rays_.dx[i] = static_cast<float>(d.x);
    rays_.dy[i] = static_cast<float>(d.y);
    rays_.dz[i] = static_cast<float>(d.z);
  }
  void move(std::size_t from, std::size_t to) {
    if (from == to) return;
    for (float* a : {rays_.x, rays_.y, rays_.z, rays_.dx, rays_.dy, rays_.dz}) a[to] = a[from];
    flux_[to] = flux_[from];
    if (keyed_) key_[to] = key_[from];
  }

  void emit(const SourceRun& run, BoxSums& sums) {
    const PlacedSource& source = scene_.sources[run.source];
    const Frame local_from_source = meshes_.local_from_world() * source.world_from_source;
    const double ray_flux = numbering_.ray_flux(run.source);
    block_.resize(run.count, 0);
    source.rays->emit(Sequence(SequenceKind::sobol, run.sequence_seed), run.first, block_);
    for (std::size_t i = 0; i < run.count; ++i, ++count_) {
      const Ray ray = local_from_source.ray(block_.ray(i));
      flux_[count_] = ray_flux * static_cast<double>(block_.weight[i]);
      if (!(is_finite(ray.origin_mm) && is_finite(ray.direction) && std::isfinite(flux_[count_]))) {
        throw InputError("a source gives a ray that is not finite");
      }
      set(count_, ray.origin_mm, ray.direction);
      if (keyed_) key_[count_] = {run.sequence_seed, run.first + i, 0};
      sums.emitted += flux_[count_];
    }
  }

  /// What becomes of ray `i`: true if it was reflected and goes on.
  bool interact(std::size_t i, int reflections, BoxSums& sums) {
    if (hits_.mesh[i] == kNoMesh) {
      leave(i, reflections > 0, sums);
      return false;
    }
    if (reflections == kMaxReflections) {
      sums.lost += flux_[i];
      return false;
    }
    if (keyed_) key_[i].bounce = reflections;
    return meshes_.mirror(hits_.mesh[i]) != nullptr ? off_mirror(i, sums) : off_body(i, sums);
  }

  void leave(std::size_t i, bool reflected, BoxSums& sums) {
    const Vec3 from = world_from_local_.point(origin(i)), along = world_from_local_.vector(direction(i));
    const std::size_t cell = boxes_.cell(from, along);
    sums.flux[cell] += flux_[i];
    if (zones_ != nullptr) zones_->add(from, along, flux_[i], sums.zones);
    if (glare_ != nullptr) glare_->add(along, flux_[i], sums.glare);
    (reflected ? sums.out_reflected : sums.out_direct) += flux_[i];
    if (reflected) return;
    sums.direct[cell] += flux_[i];
    if (zones_ != nullptr) zones_->add(from, along, flux_[i], sums.zones_direct);
    if (glare_ != nullptr) glare_->add(along, flux_[i], sums.glare_direct);
  }

  bool off_mirror(std::size_t i, BoxSums& sums) {
    const PlacedReflector& mirror = *meshes_.mirror(hits_.mesh[i]);
    const Vec3 normal = meshes_.normal(hits_.mesh[i], hits_.triangle[i]), d = direction(i);
    const double towards = -dot(d, normal);
    if (!(towards > 0.0)) {
      sums.back += flux_[i];
      return false;
    }
    const Direction face = Direction::from_unit(normal);
    return reflect_off(i, mirror.reflectance.at(towards), finish_of(mirror), {0.0, 0, face, face},
                       sums.absorbed);
  }

  bool off_body(std::size_t i, BoxSums& sums) {
    const std::uint32_t mesh = hits_.mesh[i], triangle = hits_.triangle[i];
    const Body& body = meshes_.body(mesh);
    const Direction d = Direction::from(direction(i));
    const BodyHit hit =
        body_hit(d, 0.0, mesh, meshes_.normal(mesh, triangle), meshes_.corners(mesh, triangle),
                 static_cast<double>(hits_.u[i]), static_cast<double>(hits_.v[i]));
    return reflect_off(i, body.reflectance.at(-dot(d, hit.normal)), finish_of(body), hit, sums.bodies);
  }

  bool reflect_off(std::size_t i, double reflectance, const SurfaceFinish& finish, const BodyHit& hit,
                   double& absorbed) {
    absorbed += (1.0 - reflectance) * flux_[i];
    flux_[i] *= reflectance;
    if (!(flux_[i] > 0.0)) return false;
    const Direction d = Direction::from(direction(i));
    const Vec3 at =
        origin(i) + static_cast<double>(hits_.t[i]) * d.vec() + meshes_.lift_mm() * hit.face.vec();
    set(i, at, reflected_off(finish, d, hit, keyed_ ? key_[i] : ReflectionKey{}));
    return true;
  }

  const Scene& scene_;
  const RayNumbering& numbering_;
  const Meshes& meshes_;
  const ErrorBoxes& boxes_;
  const ZoneCells* zones_;
  const GlareCells* glare_;
  Frame world_from_local_;
  RayBlock block_;
  std::size_t count_ = 0;
  MeshRays rays_;
  MeshHits hits_;
  double flux_[kMeshBatch], spare_flux_[kMeshBatch];
  /// Kept only where chance decides where a reflection goes.
  bool keyed_;
  std::vector<ReflectionKey> key_, spare_key_;
  static constexpr std::uint32_t kSortSide = 256;
  std::uint32_t sort_key_[kMeshBatch], order_[kMeshBatch], begin_[2 * kSortSide * kSortSide + 1];
};

/// The sums of a replicate as bytes, and back.
void append_sums(const BoxSums& s, std::string& bytes) {
  for (const auto* values : {&s.flux, &s.direct, &s.zones, &s.zones_direct, &s.glare, &s.glare_direct})
    append(bytes, *values);
  for (const double x : {s.emitted, s.out_direct, s.out_reflected, s.absorbed, s.back, s.bodies, s.lost})
    append_double(bytes, x);
  append(bytes, s.rays);
}
void take_sums(BoxSums& s, std::string_view& bytes) {
  for (auto* values : {&s.flux, &s.direct, &s.zones, &s.zones_direct, &s.glare, &s.glare_direct})
    take(bytes, *values);
  for (double* x : {&s.emitted, &s.out_direct, &s.out_reflected, &s.absorbed, &s.back, &s.bodies, &s.lost})
    *x = take_double(bytes);
  s.rays = take(bytes);
}

/// Blocks [first, last) of every replicate; block j of replicate r is number 16 j + r.
void trace_round(const Scene& scene, const RayNumbering& numbering, const Meshes& meshes,
                 const ErrorBoxes& boxes, const ValidationOptions& options, std::uint64_t first,
                 std::uint64_t last, std::vector<BoxSums>& replicates, Progress& progress) {
  CountedProgress counted(progress, "validate", first * kReplicates * kBlockRays, options.min_rays);
  Peers* const peers = options.peers;
  const ItemRange own = own_items(peers, kReplicates);
  parallel_blocks(own.size(), 1, [&](std::size_t i, std::size_t) {
    const std::size_t r = own.first + i;
    const auto tracer = std::make_unique<BatchTracer>(scene, numbering, meshes, boxes, options);
    BoxSums& sums = replicates[r];
    std::uint64_t reported = first;
    for (std::uint64_t j = first; j < last; ++j) {
      tracer->add_block(kReplicates * j + r, sums);
      if (j % 64 != 63 && j + 1 != last) continue;
      counted.add((j + 1 - reported) * kBlockRays);
      reported = j + 1;
    }
    tracer->finish(sums);
  });
  share_items(
      peers, kReplicates, StateKey().add(last).value(),
      [&](std::size_t r, std::string& bytes) { append_sums(replicates[r], bytes); },
      [&](std::size_t r, std::string_view& bytes) { take_sums(replicates[r], bytes); });
}

/// No more rays are needed.
bool is_clear(const ValidationOptions& options, const Validation& found) {
  const BoxErrorEstimate& e = found.error.c48;
  const bool known = e.standard_error <= kKnown * e.excess;
  return e.floor <= 0.5 * e.excess && !any_undetermined(found.zones) &&
         (found.rays >= options.min_rays || (known && found.rays >= kFewestRays));
}

/// Rays to trace in all after `rays` took `seconds` and the meshes `before_s`, or 0: enough.
std::uint64_t next_rays(const ValidationOptions& options, std::uint64_t rays, double seconds, double before_s,
                        bool clear) {
  if (rays >= options.max_rays || clear) return 0;
  std::uint64_t next = std::min(2 * rays, options.max_rays);
  const double left = options.max_s - before_s - seconds, per_ray = seconds / static_cast<double>(rays);
  if (static_cast<double>(next - rays) * per_ray > left) {
    next = left > 0.0 ? rays + static_cast<std::uint64_t>(left / per_ray) : 0;
  }
  next = next / kRoundUnit * kRoundUnit;
  return next > rays ? next : 0;
}

void set_shares(const std::vector<BoxSums>& replicates, Validation& out) {
  out.efficiency =
      replicate_share(replicates, [](const BoxSums& r) { return r.out_direct + r.out_reflected; });
  out.absorbed = replicate_share(replicates, [](const BoxSums& r) { return r.absorbed; });
  out.back = replicate_share(replicates, [](const BoxSums& r) { return r.back; });
  out.bodies = replicate_share(replicates, [](const BoxSums& r) { return r.bodies; });
  out.lost = replicate_share(replicates, [](const BoxSums& r) { return r.lost; });
}

/// Rays of a file count once, but for a first round of files that are shorter.
ValidationOptions limited(ValidationOptions options, const RayNumbering& numbering) {
  options.max_rays = std::max(numbering.last_ray(options.max_rays), kRoundUnit);
  options.min_rays = std::min(options.min_rays, options.max_rays);
  return options;
}

}  // namespace

Validation validate(const Scene& scene, const ErrorBoxes& boxes, std::span<const double> target,
                    TargetMode mode, const ValidationOptions& requested, Progress& progress) {
  check(scene);
  if (!scene.glasses.empty()) throw InputError("a design with cover glasses cannot be validated");
  if (!scene.solids.empty()) throw InputError("a design with solids cannot be validated");
  const Clock::time_point start = Clock::now();
  // A seed of its own: neither the fit's rays nor those of the trace that follows a design.
  const RayNumbering numbering(scene.sources, requested.seed ^ 0x56414C4944415445ull);
  const ValidationOptions options = limited(requested, numbering);
  const Meshes meshes(scene, boxes, target, options);
  Validation out{.triangles = meshes.triangles(), .tolerance = meshes.tolerance(), .embree = meshes.embree()};
  std::vector<BoxSums>& replicates = out.replicates;
  replicates.resize(kReplicates);
  for (BoxSums& r : replicates) {
    r.flux.assign(boxes.size(), 0.0);
    r.direct.assign(boxes.size(), 0.0);
    for (auto* cells : {&r.glare, &r.glare_direct})
      cells->assign(options.glare != nullptr ? options.glare->size() : 0, 0.0);
    if (options.zones == nullptr) continue;
    r.zones.assign(options.zones->size(), 0.0);
    r.zones_direct.assign(options.zones->size(), 0.0);
  }
  const Clock::time_point traced = Clock::now();
  out.mesh_s = of_first(options.peers, seconds_since(start));
  std::uint64_t next = std::min(kFirstRound, options.max_rays) / kRoundUnit;
  for (std::uint64_t blocks = 0; next > blocks;) {
    trace_round(scene, numbering, meshes, boxes, options, blocks, next, replicates, progress);
    blocks = next;
    out.rays = blocks * kRoundUnit;
    out.error = box_error(boxes, target, replicates, mode);
    if (options.zones != nullptr)
      out.zones = check_zones(*options.zones, replicates, total_flux(scene.sources));
    if (progress.stop_requested()) break;
    const double seconds = of_first(options.peers, seconds_since(traced));
    next = next_rays(options, out.rays, seconds, out.mesh_s, is_clear(options, out)) / kRoundUnit;
  }
  set_shares(replicates, out);
  out.seconds = of_first(options.peers, seconds_since(start));
  return out;
}

}  // namespace lucerna
