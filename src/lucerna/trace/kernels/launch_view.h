// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "lucerna/detectors.h"
#include "lucerna/optics/height_field/field_hierarchy.h"
#include "lucerna/random.h"
#include "lucerna/scene.h"
#include "lucerna/source/adaptive/sampling/adaptive_view.h"
#include "lucerna/source/clusters/cluster_view.h"
#include "lucerna/trace/detectors/far_field_grid.h"
#include "lucerna/trace/detectors/plane_bins.h"
#include "lucerna/trace/kernels/body_kernel.h"
#include "lucerna/trace/kernels/cover_glass_kernel.h"
#include "lucerna/trace/kernels/curve_kernel.h"
#include "lucerna/trace/kernels/facet_kernel.h"
#include "lucerna/trace/kernels/kernel.h"
#include "lucerna/trace/tally/flux_quanta.h"

namespace lucerna {

// What a launch of the tracing kernel reads and writes: plain data and pointers into the accelerator's
// memory.

/// Sums of one replicate, in quanta or counts.
enum LedgerSum : std::int32_t {
  kRays,
  kReflections,
  kEmitted,
  kOutDirect,
  kOutReflected,
  kAbsorbedFace,
  kAbsorbedBack,
  kLostBounceLimit,
  kLostNotFinite,
  kLostBounceLimitRays,
  kLostNotFiniteRays,
  kLedgerSums
};

/// Copies of the sums of causes: rays of neighbouring numbers, which meet the same glass at the same time,
/// add to different ones.
inline constexpr std::size_t kCauseCopies = 32;

struct SourceView {
  /// `sent`: the CPU draws the rays and sends them along (ray files, analytic emitters).
  enum class Kind : std::int32_t { sent, adaptive, clusters } kind = Kind::sent;
  FrameView world_from_source;
  /// Flux of a ray of weight 1, in mean rays.
  double ray_flux = 0.0;
  AdaptiveView adaptive;
  ClusterView clusters;
};

/// A SourceRun.
struct RunView {
  std::uint64_t first = 0, sequence_seed = 0;
  std::uint32_t source = 0, count = 0;
};

/// What a scene has beyond height fields and hard bins. Kernels are compiled for some sets of these, so that
/// plain scenes do not pay for them.
enum SceneFeature : std::uint32_t {
  kExactMirrors = 1,  ///< swept curves, facets
  kObstacles = 2,     ///< bodies, cover glasses
  kTents = 4,
};
using SceneFeatures = std::uint32_t;
inline constexpr SceneFeatures kPlainScene = 0, kAllFeatures = kExactMirrors | kObstacles | kTents;

struct MirrorView {
  FieldView field{};
  FrameView world_from_mirror, mirror_from_world;
  const ReflectanceEntry* reflectance = nullptr;
  std::uint32_t reflectance_entries = 0;
  SurfaceFinish finish;
  /// In the field's place, if they have any nodes or columns (kExactMirrors):
  CurveView curve{};
  FacetView facets{};
};

struct FarFieldView {
  std::int32_t c_count = 0, gamma_count = 0;
  /// Where its bins begin within those of a replicate.
  std::uint64_t first_bin = 0;
  /// Its tents, if it has any (kTents).
  FarFieldGrid grid;
};
struct PlaneView {
  PlaneBins bins;
  std::uint64_t first_bin = 0;
};

/// Rays drawn by the CPU, by their places in the launch.
struct SentRays {
  const float *x = nullptr, *y = nullptr, *z = nullptr, *dx = nullptr, *dy = nullptr, *dz = nullptr;
  const float* weight = nullptr;
};

/// A ray that left, as RayBlock keeps it; all bytes 0xff (no number) where the ray of that place did not
/// leave.
struct OutRay {
  float x, y, z, kx, ky, kz, weight;
};

/// Blocks first_block .. first_block + blocks - 1 of a run (kBlockRays numbers each).
struct LaunchView {
  std::uint64_t first_block = 0;
  std::uint32_t blocks = 0;
  /// Runs of block b of the launch: runs[run_begin[b]] .. runs[run_begin[b + 1] - 1], in order.
  const std::uint32_t* run_begin = nullptr;
  const RunView* runs = nullptr;
  SentRays sent;

  SceneFeatures features = kPlainScene;
  SequenceKind sequence = SequenceKind::sobol;
  std::int32_t max_bounces = 0, mirror_count = 0, far_field_count = 0, plane_count = 0;
  const SourceView* sources = nullptr;
  const MirrorView* mirrors = nullptr;
  const FarFieldView* far_fields = nullptr;
  const PlaneView* planes = nullptr;
  BodiesView bodies;
  const PlacedCoverGlass* cover_glasses = nullptr;
  std::uint64_t cover_glass_count = 0;

  /// kReplicates times bins_per_replicate, and times kLedgerSums.
  std::int64_t* bins = nullptr;
  std::uint64_t bins_per_replicate = 0;
  std::int64_t* ledger = nullptr;
  /// What bodies, then cover glasses, absorbed, cause by cause: kReplicates times kCauseCopies times
  /// cause_count.
  std::int64_t* causes = nullptr;
  std::int32_t cause_count = 0;
  /// By place; null if no detector keeps rays.
  OutRay* out_rays = nullptr;
};

/// What a height field's leaves hold together, over its quadric (HeightField).
struct FieldBounds {
  double low = 0.0, high = 0.0;
  double gradient_bound = 0.0;  ///< double, so that nothing between the members is copied unwritten
};

/// The tree over a height field, to be made again from its vertices.
struct HierarchyView {
  const FieldVertex* vertices = nullptr;
  FieldNode* nodes = nullptr;
  const LeafKind* leaf_kinds = nullptr;
  /// By leaf square.
  float* gradient_bound = nullptr;
  FieldBounds* bounds = nullptr;
  std::int32_t offsets[16] = {};
  std::int32_t cells = 0, levels = 0;
  float step_x = 0.0F, step_y = 0.0F;
};

}  // namespace lucerna
