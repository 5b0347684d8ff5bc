// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "lucerna/rays.h"
#include "lucerna/source/adaptive/charts/support_batch.h"
#include "lucerna/source/adaptive/mixture/wavelengths.h"
#include "lucerna/source/adaptive/sampling/adaptive_view.h"
#include "lucerna/source/adaptive/tree/adaptive_tree.h"
#include "lucerna/source/emitters/luminance_source.h"
#include "lucerna/source/file/nfl.h"
#include "lucerna/source_model.h"

namespace lucerna {

inline constexpr NflTag kAdaptiveMethod{'A', 'D', 'A', 'P'};

/// The density in one chart of a support: the mean of its trees.
struct AdaptiveChart {
  std::uint32_t chart = 0;
  /// Of the layer's flux.
  double share = 0.0;
  TreeBox box;
  std::vector<DensityTree> trees;
  friend bool operator==(const AdaptiveChart&, const AdaptiveChart&) = default;
};

/// Light that is written down on one support.
struct AdaptiveLayer {
  Support support;
  /// Of the model's flux; shares of all layers sum to 1.
  double share = 0.0;
  std::vector<AdaptiveChart> charts;
  /// Why this support, for people: "plane: 3.21 nats per ray better than the bounding surface".
  std::string why;
  /// Which of the model's wavelength tables this light has; 0 if there are none.
  std::uint32_t band = 0;
  friend bool operator==(const AdaptiveLayer&, const AdaptiveLayer&) = default;
};

/// All that an adaptive model stores.
struct AdaptiveData {
  double flux = 0.0;
  FluxUnit flux_unit = FluxUnit::lumen;
  std::uint64_t training_rays = 0;
  /// Where sampled rays start; `none`: on the supports themselves.
  BoundingSurface surface;
  std::vector<AdaptiveLayer> layers;
  /// Spectra of the ray file, as they were.
  std::vector<SpectralTable> spectra;
  /// Of rays with wavelengths of their own: one table, or one for each band of layers; else empty.
  std::vector<WavelengthTable> wavelengths;

  std::size_t leaves() const;
};

/// The file's sections, and back (docs/reference/nfl-adaptive.md); `name` is for messages. Every count and
/// tree is checked.
NflFile encode_adaptive(const AdaptiveData& data);
AdaptiveData decode_adaptive(const NflFile& file, std::string_view name);

/// The adaptive model as a source. A ray takes four numbers of the sequence: the first chooses the leaf (by
/// inverting the sum of their shares through a guide table: O(1)) and, with what the choice leaves of it, the
/// first number of the ray in the leaf; 1-3 are the others. Even points stay even this way: leaves are in the
/// order of their trees, so that neighbours in the first number are neighbours in the source.
class AdaptiveModel final : public SourceModel, public LuminanceSource {
 public:
  /// `data` must be as decode_adaptive checks it.
  explicit AdaptiveModel(AdaptiveData data);
  static std::unique_ptr<AdaptiveModel> from_nfl(const NflFile& file, std::string_view name);

  double flux() const override { return data_.flux; }
  FluxUnit flux_unit() const override { return data_.flux_unit; }
  void emit(const Sequence& sequence, std::uint64_t first, RayBlock& out) const override;
  bool has_wavelengths() const override { return !data_.wavelengths.empty(); }
  void emit_wavelengths(const Sequence& sequence, std::uint64_t first, std::span<float> nm) const override;
  std::span<const SpectralTable> spectra() const override { return data_.spectra; }

  std::string_view method() const override { return "adaptive"; }
  std::size_t layers() const override { return data_.layers.size(); }
  std::size_t leaves() const override { return data_.leaves(); }
  std::uint64_t training_rays() const override { return data_.training_rays; }

  /// Integrals of pdf_etendue over 4096 even directions: to about 1 % for wide beams.
  double pdf_area(const Vec3& point_mm) const override;
  double pdf_solid_angle(const Vec3& point_mm, const Direction& direction) const override;
  /// Radiance over flux of the ray's line, wherever on it the ray starts: the sum over layers of share times
  /// density. Throws InputError if a layer has no étendue (rays through one point or line, or parallel).
  double pdf_etendue(const Ray& ray) const override;
  NflFile to_nfl() const override { return encode_adaptive(data_); }

  bool has_luminance() const override { return has_etendue_; }
  void add_light_on(const Ray& ray, std::vector<LineLight>& to) const override;
  LightBound light_bound() const override;

  const AdaptiveData& data() const { return data_; }
  /// False if some layer's rays have no étendue.
  bool has_etendue() const { return has_etendue_; }

  /// Ray of the point `u` of the unit cube (multiples of 2^-32).
  Ray sample(const std::array<double, 4>& u) const;
  /// What sample_adaptive reads; points into the model.
  AdaptiveView view() const;

 private:
  struct Place {
    const Support* support;
    std::uint32_t chart, band;
    double share;
    std::vector<TreeLookup> trees;
  };
  double density(const Ray& ray) const;
  double radiance_at(const Vec3& point_mm, const Direction& d) const;
  void build_sampler();
  std::size_t leaf_of(std::uint32_t bits) const;

  /// A batch of rays as numbers in their leaves.
  struct Chosen {
    std::array<BatchColumn, 4> c;
    std::array<std::uint32_t, kSupportBatch> place;
  };
  static constexpr std::size_t kPieceBatches = 8;
  using Piece = std::array<Chosen, kPieceBatches>;
  void choose(const Sequence& sequence, std::uint64_t first, std::size_t batches, Piece& to) const;
  void make(std::uint32_t place, const std::array<BatchColumn, 4>& c, std::size_t n, RayBatch& rays) const;
  void emit_piece(const Sequence& sequence, std::uint64_t first, std::size_t at, std::size_t n,
                  RayBlock& out) const;

  AdaptiveData data_;
  std::vector<Place> places_;
  std::vector<SamplerLeaf> leaves_;  // and one more that only ends the last
  std::vector<std::uint32_t> guide_;
  std::vector<std::uint32_t> last_bits_;  // the last value that chooses each leaf: the search reads only this
  std::vector<SamplerPlace> sampler_places_;
  unsigned guide_shift_ = 31;
  bool has_etendue_ = true;
};

}  // namespace lucerna
