// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "lucerna/design/evaluation/design_ray_block.h"
#include "lucerna/design/shape/design_shape.h"
#include "lucerna/progress.h"
#include "lucerna/rays.h"
#include "lucerna/trace/engines/ray_numbering.h"
#include "lucerna/trace/kernels/solid_kernel.h"
#include "lucerna/trace/tally/flux_quanta.h"

namespace lucerna {

class Accelerator;
class BodyShadows;
class DeviceEvaluator;
class Peers;

/// What blocks of rays are padded to and dealt by, so that the order of summing is fixed.
inline constexpr std::size_t kDesignTasks = 16;

/// The rays that every evaluation of a design traces again (common random numbers), in the frame of the
/// mirror. Block b of kBlockRays rays belongs to stream b mod kDesignStreams; within a stream, sources take
/// their shares by SourceInterleaving and each has a Sobol sequence of its own. Grows on demand and never
/// changes what is there. 28 bytes per ray. Not thread safe while it grows.
class DesignRays {
 public:
  /// `sources` in the luminaire frame. Throws InputError as `check(Scene)` does for sources.
  DesignRays(std::vector<PlacedSource> sources, const Frame& mirror_from_world, std::uint64_t seed);

  /// Makes sure that there are at least `n` rays (rounded up to kDesignTasks blocks). Progress phase "rays".
  void grow(std::uint64_t n, Progress& progress = no_progress());

  std::uint64_t size() const { return block_.size() * kBlockRays; }
  /// Flux of all sources, in their unit.
  double flux() const { return flux_; }
  const std::vector<PlacedSource>& sources() const { return sources_; }
  FluxUnit unit() const { return sources_.front().rays->flux_unit(); }

  using Block = DesignRayBlock;
  const Block& block(std::uint64_t b) const { return block_[b]; }
  /// From now on `evaluate` traces these rays on `accelerator`, which must not be used by another thread
  /// meanwhile; nothing: on the CPU.
  void evaluate_on(std::shared_ptr<Accelerator> accelerator);
  /// Null on the CPU.
  DeviceEvaluator* device() const { return device_.get(); }

  /// From now on bodies stand in the rays' way, and evaluations are traced on the CPU; null: none.
  void shade_by(std::shared_ptr<const BodyShadows> shadows) { shadows_ = std::move(shadows); }
  /// Null without bodies.
  const BodyShadows* shadows() const { return shadows_.get(); }

  /// What is done to each ray, in the mirror's frame, before a design sees it: returns the share of its flux
  /// that is left. Thread safe.
  using Pass = std::function<double(Ray&)>;
  /// From now on the shape is the last face of a lens: rays that are drawn from here on first go into the
  /// medium by `into`, and the face refracts them. There are none yet.
  void refract(const MediumView& medium, Pass into);
  /// From now on the shape is the first face of a lens, by which rays come into the medium, and `last` (a
  /// free form in the same frame) that by which they leave it. May be said again where the last face changes.
  void refract_in(const MediumView& medium, DesignShape last);
  /// The medium of the lens that the shape is a face of; nothing where it is a mirror.
  const std::optional<MediumView>& medium() const { return medium_; }
  /// Null where the shape is the last face itself, or a mirror.
  const DesignShape* last_face() const { return last_ ? &*last_ : nullptr; }

  /// Share of the sources' flux that the first `count` rays (whole blocks) still have where a design sees
  /// them.
  double share_left(std::uint64_t count) const;

  /// From now on evaluations are shared with other processes, which make all of them too (peers.h); null:
  /// this one makes them alone.
  void share_with(Peers* peers) { peers_ = peers; }
  /// Null alone.
  Peers* peers() const { return peers_; }

  /// A copy of the first `max` rays (whole blocks of them), for what takes ray sets.
  RayBlock first(std::uint64_t max) const;

 private:
  void fill(std::uint64_t b);

  std::vector<PlacedSource> sources_;
  Frame mirror_from_world_;
  SourceInterleaving word_;
  std::uint64_t seed_;
  double flux_ = 0.0;
  std::vector<double> ray_flux_;
  std::vector<Block> block_;
  std::shared_ptr<DeviceEvaluator> device_;
  std::shared_ptr<const BodyShadows> shadows_;
  std::optional<MediumView> medium_;
  std::optional<DesignShape> last_;
  Pass into_;
  Peers* peers_ = nullptr;
};

/// As long as it lives, the rays' evaluations are made by this process alone.
class UnsharedRays {
 public:
  explicit UnsharedRays(DesignRays& rays) : rays_(rays), peers_(rays.peers()) { rays_.share_with(nullptr); }
  ~UnsharedRays() { rays_.share_with(peers_); }
  UnsharedRays(const UnsharedRays&) = delete;
  UnsharedRays& operator=(const UnsharedRays&) = delete;

 private:
  DesignRays& rays_;
  Peers* peers_;
};

}  // namespace lucerna
