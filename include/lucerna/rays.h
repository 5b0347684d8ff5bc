// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lucerna/flux_unit.h"
#include "lucerna/geometry.h"

#pragma GCC visibility push(default)
namespace lucerna {

/// Some rays as a structure of arrays, in the precision of ray files (float32). All arrays have the same
/// length. The unit of streaming: readers fill it, sources emit it, tracers take it.
struct RayBlock {
  /// Where each ray starts, mm. New large columns are made equally far apart, if the allocator allows it.
  std::vector<float> x_mm, y_mm, z_mm;
  /// Its direction cosines; unit length to float precision once a reader has checked them. Placed likewise.
  std::vector<float> kx, ky, kz;
  /// Relative flux, >= 0. A ray carries flux * weight / (sum of all weights), whatever unit the file gave its
  /// weights.
  std::vector<float> weight;
  /// Further numbers per ray, one array for each entry of RaySetHeader::columns.
  std::vector<std::vector<float>> extra;

  /// Number of rays.
  std::size_t size() const { return weight.size(); }
  /// True if there are no rays.
  bool empty() const { return weight.empty(); }

  /// Makes room for exactly `n` rays and `columns` extra columns; new values are zero.
  void resize(std::size_t n, std::size_t columns);
  /// The same with as many extra columns as there are.
  void resize(std::size_t n) { resize(n, extra.size()); }

  /// Makes appending up to `n` rays free of further allocations.
  void reserve(std::size_t n);

  /// Appends ray `i` of `other`, which has the same extra columns.
  void append(const RayBlock& other, std::size_t i);
  /// Appends all of `other`.
  void append(const RayBlock& other);

  /// Start of ray `i`; `i` is not checked.
  Vec3 origin_mm(std::size_t i) const { return {x_mm[i], y_mm[i], z_mm[i]}; }
  /// Normalised in double, so that it is unit to a few ulp.
  Direction direction(std::size_t i) const { return Direction::from({kx[i], ky[i], kz[i]}); }
  /// Start and direction of ray `i`.
  Ray ray(std::size_t i) const { return {origin_mm(i), direction(i)}; }

  /// Sets start and direction of ray `i`; weight and extra columns stay.
  void set(std::size_t i, const Ray& ray);

  friend bool operator==(const RayBlock&, const RayBlock&) = default;
};

/// What an extra column of a ray set holds (TM-25-13 clause 4.7.6 has them all).
enum class ColumnKind {
  radiant_flux_w,    ///< beside luminous weights
  luminous_flux_lm,  ///< beside radiant weights
  wavelength_nm,
  stokes,  ///< S1, S2, S3 relative to S0, then the axis of the polarisation ellipse; one column each
  tristimulus_x,
  tristimulus_z,
  spectrum_index,  ///< 1-based index into RaySetHeader::spectra
  additional,      ///< whatever `label` says
};

/// One extra column of a ray set: what it holds and what it is called.
struct ColumnSpec {
  /// What it holds.
  ColumnKind kind = ColumnKind::additional;
  /// What it is called.
  std::string label;
  friend bool operator==(const ColumnSpec&, const ColumnSpec&) = default;
};

/// The label that readers give to columns of a kind that formats define, "wavelength nm"; `n` counts the
/// Stokes columns from 0. Empty for `additional`.
std::string standard_label(ColumnKind kind, std::size_t n = 0);

/// Index in `columns` of the first of this kind; absent if there is none.
std::optional<std::size_t> find_column(const std::vector<ColumnSpec>& columns, ColumnKind kind);

/// Relative spectral power over wavelength; wavelengths ascend.
struct SpectralTable {
  /// Equally many of both.
  std::vector<float> wavelength_nm, relative_power;
  friend bool operator==(const SpectralTable&, const SpectralTable&) = default;
};

/// Free text that ray files carry; empty where the file says nothing. Names follow TM-25-13 clause 4.4.
struct RaySetTexts {
  /// As the clause names them.
  std::string light_source, manufacturer, model_creator, file_creator, equipment, camera,
      operating_conditions, additional_info, geometry_reference, additional_text, date;
  friend bool operator==(const RaySetTexts&, const RaySetTexts&) = default;
};

/// All that is known of a ray set beside its rays.
struct RaySetHeader {
  /// Unit of the rays' weights, and of the flux that they share.
  FluxUnit flux_unit = FluxUnit::lumen;
  /// Totals as the file states them; absent = not stated. A TM-25 file may state both.
  std::optional<double> flux_lm, flux_w;
  /// What RayBlock::extra holds, column by column.
  std::vector<ColumnSpec> columns;
  /// Spectra that a `spectrum_index` column refers to.
  std::vector<SpectralTable> spectra;
  /// Set when all rays have this one wavelength.
  std::optional<float> wavelength_nm;
  /// Free text of the file.
  RaySetTexts texts;
  /// TM-25's creation method: 0 simulation, 1 measurement, -1 not said.
  int creation_method = -1;
  /// TM-25's "ray start position" code, 0 = unknown.
  int start_position = 0;

  /// The total flux in `flux_unit`; absent when the file does not state it.
  std::optional<double> flux() const { return flux_unit == FluxUnit::lumen ? flux_lm : flux_w; }
  /// States the total flux in `flux_unit`.
  void set_flux(double flux) { (flux_unit == FluxUnit::lumen ? flux_lm : flux_w) = flux; }

  friend bool operator==(const RaySetHeader&, const RaySetHeader&) = default;
};

/// A ray set in memory: header and all rays. Weights are as the file had them; a ray's flux is
/// `header.flux() * weight / sum of weights`.
struct RaySet {
  /// All but the rays.
  RaySetHeader header;
  /// The rays.
  RayBlock rays;
  friend bool operator==(const RaySet&, const RaySet&) = default;
};

}  // namespace lucerna
#pragma GCC visibility pop
