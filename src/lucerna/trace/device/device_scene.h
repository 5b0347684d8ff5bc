// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lucerna/optics/height_field/height_field.h"
#include "lucerna/scene.h"
#include "lucerna/trace.h"
#include "lucerna/trace/device/accelerator_buffer.h"
#include "lucerna/trace/engines/ray_numbering.h"

namespace lucerna {

/// A scene in an accelerator's memory: source models, mirrors, bodies and glasses are uploaded once, the
/// height fields' trees are made there. Everything it was made from may go afterwards. Memory: 12 bytes a
/// vertex of the fields, 24 a facet, some 60 a triangle of the bodies (twice that if there is a lamp's body
/// among them; 72 more if it is smooth), 16 sets of bins of 8 bytes, the models' flat arrays.
class DeviceScene {
 public:
  DeviceScene(Accelerator& accelerator, const Scene& scene, const RayNumbering& numbering,
              const TraceOptions& options);

  /// Gives mirror `m`, a height field, another shape on the same grid, and makes its tree again.
  void set_vertices(std::size_t m, const std::vector<FieldVertex>& vertices);
  /// The tree of mirror `m` and its band, as they are in the accelerator's memory; none of other mirrors.
  std::vector<FieldNode> nodes(std::size_t m) const;
  HeightRange band(std::size_t m) const { return bands_[m]; }

  /// All that a launch reads and writes but its blocks.
  const LaunchView& view() const { return view_; }
  /// Sources whose rays the CPU draws.
  bool has_sent_sources() const { return has_sent_; }
  bool is_sent(std::size_t source) const { return sources_[source].kind == SourceView::Kind::sent; }

  /// Adds all sums to the kReplicates tallies. Waits for the first stream only.
  void add_to(std::vector<Tally>& replicates) const;

 private:
  template <class T>
  const T* put(const T* data, std::size_t n);
  /// With its lobes.
  template <class Mirror>
  SurfaceFinish put_finish(const Mirror& mirror);
  SourceView source_view(const PlacedSource& source, double ray_flux);
  void add_mirror(const PlacedReflector& placed, int cells);
  /// Uploads a field and makes `view` of it; its tree is still to be made.
  HierarchyView add_field(const HeightField& field, double away_mm, FieldView& view);
  bool is_field(std::size_t m) const { return hierarchies_[m].cells > 0; }
  void add_bodies(const Scene& scene);
  void add_glasses(const Scene& scene);
  void add_detectors(const Scene& scene);
  /// Of absorption, beside the mirrors.
  std::size_t causes() const { return static_cast<std::size_t>(view_.cause_count); }
  void rebuild(std::size_t m);

  Accelerator& accelerator_;
  std::vector<AcceleratorBuffer> buffers_;
  std::vector<SourceView> sources_;
  std::vector<MirrorView> mirrors_;
  /// Without cells for mirrors that are no height field.
  std::vector<HierarchyView> hierarchies_;
  std::vector<HeightRange> bands_;
  MirrorView* device_mirrors_ = nullptr;
  std::vector<std::size_t> bin_counts_;
  LaunchView view_;
  bool has_sent_ = false;
};

}  // namespace lucerna
