// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

#include "lucerna/photometry/photometric_file.h"

namespace lucerna {

/// The order in which EULUMDAT files with Isym 3 store their planes.
enum class Isym3Order {
  standard,  ///< C270 over C0 to C90 (the format's text, and the files of makers)
  reversed,  ///< C90 over C180 to C270 (files of QLumEdit and its relatives)
};

struct PhotometricReadOptions {
  bool strict = false;  ///< the first repair becomes an InputError
  Isym3Order isym3 = Isym3Order::standard;
  IesTurn ies_turn = IesTurn::none;  ///< how the H angles and sizes of IES files are meant
};

/// What the first bytes of a file (64 KiB are plenty) say it is: `ies_2019` for every IES version, `ldt`, or
/// nothing. IES is known by its header or TILT line, EULUMDAT by the numbers on its lines 2 to 7 and 13
/// to 26. Never throws.
std::optional<PhotometricFormat> detect_photometric_format(std::string_view head);

/// True if the file's content looks like IES or EULUMDAT. False for anything else, also for a file that
/// cannot be read.
bool is_photometric_file(const std::filesystem::path& path);

/// Reads the text of an IES LM-63 file of any version (1986 to 2019), types A, B and C. Candela are value x
/// multiplier x ballast factor (x photometric factor in 1986 and 1991 only). Types A and B are turned so that
/// H0 V0 is nadir and V+90 is C0; H counts clockwise there, so H+90 is C270; they are resampled on 1 x 2.5
/// degrees with the flux of their own quadrature. TILT factors are kept, not applied. Intensities in mW/sr or
/// W/sr ([_INTENSITYUNITS]) become W/sr. `name` is for messages. Throws InputError with the line where
/// reading is not possible, or, if strict, at the first repair. Thread safe. O(bytes).
PhotometricFile read_ies(std::string_view bytes, std::string_view name,
                         const PhotometricReadOptions& options = {});

/// Reads the text of a EULUMDAT file, Isym 0 to 4. cd = value x conversion factor x flux of the first lamp
/// set / 1000.
PhotometricFile read_ldt(std::string_view bytes, std::string_view name,
                         const PhotometricReadOptions& options = {});

/// Reads either, by content. Throws InputError if it is neither, larger than 64 MiB, or as above.
PhotometricFile read_photometric_file(const std::filesystem::path& path,
                                      const PhotometricReadOptions& options = {});

/// Writes a whole file, or none. Throws InputError if the place cannot be written or the format cannot say
/// it.
void write_photometric_file(const std::filesystem::path& path, const PhotometricFile& file,
                            PhotometricFormat format, const PhotometricWriteOptions& options = {});

/// Everything about a file that its reader may want to know, in the order of the lines: repairs (warnings),
/// notes, a reading error (error), and what is implausible: flux against what the file states, light output
/// ratio outside 1 to 105 %, a little uplight (under 7 % of the flux, as stray light in the laboratory
/// gives), missing sizes, an Isym 3 file that looks reversed. Strict: warnings become errors. Throws only if
/// the file cannot be opened.
std::vector<Fault> check_photometric_file(const std::filesystem::path& path,
                                          const PhotometricReadOptions& options = {});

}  // namespace lucerna
