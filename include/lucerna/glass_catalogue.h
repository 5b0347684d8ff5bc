// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "lucerna/material.h"

#pragma GCC visibility push(default)
namespace lucerna {

/// How much light of one wavelength passes a plate, without what its faces reflect.
struct InternalTransmittance {
  /// In vacuum, as the catalogue rounds it.
  double wavelength_nm = 0.0;
  /// Share in [0, 1].
  double transmittance = 1.0;
  /// Of the plate; > 0.
  double thickness_mm = 1.0;
};

/// A glass or plastic of a maker's catalogue in the ANSI Glass Format (AGF), at the temperature of the
/// catalogue, relative to air of that temperature and one atmosphere.
struct CatalogueGlass {
  /// As the catalogue spells it.
  std::string name;
  /// Which dispersion formula, 1 to 13 (docs/theory/materials.md has them).
  int formula = 1;
  /// Of the formula, for wavelengths in um; at least as many as it has.
  std::vector<double> coefficients;
  /// Where the formula holds.
  double min_nm = 0.0, max_nm = 0.0;
  /// The index at the d line, 587.56 nm, that the catalogue states beside its formula; 0 where it states
  /// none.
  double stated_index_d = 0.0;
  /// By wavelength, each but once (the thickest plate's); empty where the catalogue states none.
  std::vector<InternalTransmittance> transmittance;
};

/// The names of a catalogue's glasses, in its order. Throws InputError if the file cannot be read, is larger
/// than 64 MiB or names no glass. Thread safe. Cost: one reading of the file.
[[nodiscard]] std::vector<std::string> glass_names(const std::filesystem::path& catalogue);

/// One glass of a catalogue, by its name in upper or lower case. Text may be in UTF-8, UTF-16 or
/// Windows-1252. Records that are not needed are passed over, and so are errors in other glasses. Throws
/// InputError with file and line for what breaks the format, for a name that is not there (with the nearest),
/// for a formula or its coefficients missing, and where the formula's index at the d line is more than 0.001
/// from the one that the catalogue states: then one of them is wrong. Thread safe. Cost: one reading of the
/// file.
[[nodiscard]] CatalogueGlass read_glass(const std::filesystem::path& catalogue, std::string_view name);

/// The index in air of `glass` by its formula. Throws InputError where the wavelength is out of its range,
/// and where the formula gives no index there. Thread safe.
[[nodiscard]] double glass_index(const CatalogueGlass& glass, double wavelength_nm);

/// Natural absorption coefficient by the internal transmittance: of a plate of 1 mm it is linear between the
/// catalogue's wavelengths. 0 where the catalogue states no transmittance. Throws InputError where it states
/// some, but not for this wavelength, and where no light passes. Thread safe.
[[nodiscard]] double glass_absorption_per_mm(const CatalogueGlass& glass, double wavelength_nm);

/// Both over the range of the formula, sampled each nanometre: the longest stretch of it in which the formula
/// gives an index of 1 to 4. Absorption only where the catalogue states transmittances, and beyond its
/// wavelengths that of the nearest. Light that does not pass at all is absorbed to 1e-30 within a millimetre.
/// Throws InputError if no two neighbouring samples have such an index. Thread safe.
[[nodiscard]] Dispersion dispersion(const CatalogueGlass& glass);

}  // namespace lucerna
#pragma GCC visibility pop
