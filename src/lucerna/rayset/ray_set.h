// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lucerna/core/flux_unit.h"
#include "lucerna/rayset/ray_block.h"

namespace lucerna {

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

struct ColumnSpec {
  ColumnKind kind = ColumnKind::additional;
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
  std::vector<float> wavelength_nm, relative_power;
  friend bool operator==(const SpectralTable&, const SpectralTable&) = default;
};

/// Free text that ray files carry; empty where the file says nothing. Names follow TM-25-13 clause 4.4.
struct RaySetTexts {
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
  std::vector<ColumnSpec> columns;
  std::vector<SpectralTable> spectra;
  /// Set when all rays have this one wavelength.
  std::optional<float> wavelength_nm;
  RaySetTexts texts;
  /// TM-25's creation method: 0 simulation, 1 measurement, -1 not said.
  int creation_method = -1;
  /// TM-25's "ray start position" code, 0 = unknown.
  int start_position = 0;

  /// The total flux in `flux_unit`; absent when the file does not state it.
  std::optional<double> flux() const { return flux_unit == FluxUnit::lumen ? flux_lm : flux_w; }
  void set_flux(double flux) { (flux_unit == FluxUnit::lumen ? flux_lm : flux_w) = flux; }

  friend bool operator==(const RaySetHeader&, const RaySetHeader&) = default;
};

/// A ray set in memory: header and all rays. Weights are as the file had them; a ray's flux is
/// `header.flux() * weight / sum of weights`.
struct RaySet {
  RaySetHeader header;
  RayBlock rays;
  friend bool operator==(const RaySet&, const RaySet&) = default;
};

}  // namespace lucerna
