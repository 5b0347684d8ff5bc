// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "lucerna/diagnostic.h"
#include "lucerna/intensity.h"

#pragma GCC visibility push(default)
namespace lucerna {

/// One set of lamps of EULUMDAT lines 26a-26f. Sets are alternatives: their fluxes are not added.
struct LampSet {
  int count = 1;  ///< lamps in the set, >= 0 (absolute photometry is `LuminaireData::absolute`)
  /// As in the file.
  std::string type{};
  double flux_lm = 0.0;  ///< of all lamps of the set together; of the luminaire for absolute photometry
  std::string color{};   ///< colour appearance or temperature, as in the file
  std::string color_rendering{};  ///< group or index, as in the file
  double watts = 0.0;             ///< of the set, with ballast
  friend bool operator==(const LampSet&, const LampSet&) = default;
};

/// File generation types of LM-63-2019 (its table 2): intensities of a computer simulation; not said how.
inline constexpr const char* kGenerationSimulated = "1.00010";
inline constexpr const char* kGenerationUndefined = "1.00001";

/// What a photometric file says of the luminaire beside its intensities. Text is UTF-8, without line ends.
/// Lengths in mm in EULUMDAT's sense: length along C90-C270, width along C0-C180; width 0 with a length is a
/// circle of that diameter.
struct LuminaireData {
  /// As the file has them; empty where it says nothing.
  std::string manufacturer, name, catalog_number, report_number, test_lab;
  std::string date_user;  ///< EULUMDAT line 12; ISSUEDATE of LM-63
  std::string file_name;  ///< EULUMDAT line 11
  /// Size of the luminaire; 0 = not stated.
  double length_mm = 0.0, width_mm = 0.0, height_mm = 0.0;
  /// Size of the luminous area; 0 = not stated.
  double luminous_length_mm = 0.0, luminous_width_mm = 0.0;
  /// Height of the luminous area in planes C0, C90, C180, C270.
  std::array<double, 4> luminous_height_mm{};
  /// True if intensities stand by themselves (LM-63 lumens -1, EULUMDAT lamp count -1), not for the flux of a
  /// lamp.
  bool absolute = true;
  /// The lamps; none for absolute photometry made here. The first set is the one that EULUMDAT's cd/klm refer
  /// to.
  std::vector<LampSet> lamps;
  /// Electric power of the luminaire; 0 = not stated.
  double input_watts = 0.0;
  double tilt_deg = 0.0;   ///< of the luminaire while it was measured
  int type_indicator = 0;  ///< EULUMDAT Ityp; 0 = choose from the symmetry when writing
  /// EULUMDAT's direct ratios for room indices k = 0.6 to 5; 0 = not stated.
  std::array<double, 10> direct_ratios{};
  /// Further LM-63 keywords in their order, without brackets; a text with line ends was continued with
  /// [MORE].
  std::vector<std::pair<std::string, std::string>> keywords;
  /// How the intensities were found: file generation type of LM-63-2019, as in the file; empty if not said.
  std::string generation_type{};
  /// More about that: text of LM-63-2019's [FILEGENINFO]; empty: none.
  std::string generation_info{};
  friend bool operator==(const LuminaireData&, const LuminaireData&) = default;
};

/// What the file looked like before it was expanded, turned and scaled to cd.
struct PhotometricOrigin {
  std::string format;                  ///< "IES LM-63-2002", "EULUMDAT"; empty if not from a file
  std::string symmetry;                ///< "H 0..90", "Isym 3"
  char type = 'C';                     ///< goniometer type A, B or C
  std::size_t planes = 0, gammas = 0;  ///< angles that the file lists
  double multiplier = 1.0;             ///< LM-63 multiplier, EULUMDAT conversion factor; applied
  double ballast_factor = 1.0;         ///< LM-63, applied
  std::array<double, 3> raw_size{};    ///< LM-63 width, length, height as in the file
  /// True if that is in feet.
  bool feet = false;
  std::optional<double> declared_flux_lm;  ///< lamp flux times LORL, or a keyword for luminaire lumens
  double nadir_spread = 0.0;               ///< (max - min) / mean of the nadir row before it was evened out
  /// LM-63 TILT=INCLUDE: angle of the lamp's tilt in degrees and what all intensities are multiplied by
  /// there. Not applied: they depend on the installation. See `tilt_factor`.
  std::vector<std::pair<double, double>> tilt_factors{};
  /// 1 vertical lamp, 2 horizontal lamp that stays level, 3 horizontal lamp that tilts; 0 without factors.
  int tilt_geometry = 0;
};

/// A light distribution with what is said of it: what readers return and writers take.
struct PhotometricFile {
  /// Intensities.
  IntensityDistribution distribution;
  /// What the file says of the luminaire.
  LuminaireData luminaire;
  /// What the file looked like.
  PhotometricOrigin origin{};
  std::vector<Diagnostic> repairs{};  ///< every repair that reading needed, in the order of the file
  std::vector<Diagnostic> notes{};    ///< what was assumed or is unusual but legal
};

/// Flux of the lamps that intensities may be quoted for (cd/klm), in lm: of the first lamp set with flux, or
/// none for absolute photometry.
std::optional<double> lamp_flux_lm(const LuminaireData& luminaire);

/// What all intensities are to be multiplied by (`scale`) when the lamp is tilted by `tilt_deg` (>= 0):
/// linear between the file's tilt factors, the first and last beyond them, 1 if the file has none.
double tilt_factor(const PhotometricOrigin& origin, double tilt_deg);

/// How IES's H angles stand to C (docs/concepts/frames-and-units.md): both are in use, and no file says
/// which.
enum class IesTurn {
  none,      ///< H = C; sizes swap (IES width = our length, IES length = our width)
  minus_90,  ///< H = C - 90; sizes keep their names
};

/// The formats that are written.
enum class PhotometricFormat { ies_2002, ies_2019, ldt };

/// How a photometric file is written.
struct PhotometricWriteOptions {
  /// How C angles become H angles in IES files.
  IesTurn ies_turn = IesTurn::none;
  /// Significant digits of the peak; all other intensities get as many decimals. 17 or more: shortest text
  /// that reads back to the same double.
  int digits = 7;
};

/// The text of an IES LM-63 file, CR LF, symmetry found at the printed precision, absolute photometry as
/// lumens -1. The required keywords are always there, "unknown" where nothing is known. `format` must be one
/// of the two IES formats. Radiometric distributions carry [_INTENSITYUNITS] W/sr. Throws InputError if the
/// grid breaks its rules, or starts at neither 0 nor 90 or ends at neither 90 nor 180, which LM-63 cannot
/// say. Thread safe, O(values).
[[nodiscard]] std::string ies_text(const PhotometricFile& file, PhotometricFormat format,
                                   const PhotometricWriteOptions& options = {});

/// The text of a EULUMDAT file (Stockmar 1990), CR LF, UTF-8, symmetry found at the printed precision, planes
/// of Isym 3 from C270 over C0 to C90. Absolute photometry as lamp count -1, luminaire flux, LORL 100.
/// Radiometric distributions are refused with InputError: the format has no unit. Thread safe, O(values).
[[nodiscard]] std::string ldt_text(const PhotometricFile& file, const PhotometricWriteOptions& options = {});

/// The order in which EULUMDAT files with Isym 3 store their planes.
enum class Isym3Order {
  standard,  ///< C270 over C0 to C90 (the format's text, and the files of makers)
  reversed,  ///< C90 over C180 to C270 (files of QLumEdit and its relatives)
};

/// How a photometric file is read.
struct PhotometricReadOptions {
  bool strict = false;  ///< the first repair becomes an InputError
  /// How EULUMDAT files of Isym 3 are meant.
  Isym3Order isym3 = Isym3Order::standard;
  IesTurn ies_turn = IesTurn::none;  ///< how the H angles and sizes of IES files are meant
};

/// What the first bytes of a file (64 KiB are plenty) say it is: `ies_2019` for every IES version, `ldt`, or
/// nothing. IES is known by its header or TILT line, EULUMDAT by the numbers on its lines 2 to 7 and 13
/// to 26. Never throws.
[[nodiscard]] std::optional<PhotometricFormat> detect_photometric_format(std::string_view head);

/// True if the file's content looks like IES or EULUMDAT. False for anything else, also for a file that
/// cannot be read.
[[nodiscard]] bool is_photometric_file(const std::filesystem::path& path);

/// Reads the text of an IES LM-63 file of any version (1986 to 2019), types A, B and C. Candela are value x
/// multiplier x ballast factor (x photometric factor in 1986 and 1991 only). Types A and B are turned so that
/// H0 V0 is nadir and V+90 is C0; H counts clockwise there, so H+90 is C270; they are resampled on 1 x 2.5
/// degrees with the flux of their own quadrature. TILT factors are kept, not applied. Intensities in mW/sr or
/// W/sr ([_INTENSITYUNITS]) become W/sr. `name` is for messages. Throws InputError with the line where
/// reading is not possible, or, if strict, at the first repair. Thread safe. O(bytes).
[[nodiscard]] PhotometricFile read_ies(std::string_view bytes, std::string_view name,
                                       const PhotometricReadOptions& options = {});

/// Reads the text of a EULUMDAT file, Isym 0 to 4. cd = value x conversion factor x flux of the first lamp
/// set / 1000.
[[nodiscard]] PhotometricFile read_ldt(std::string_view bytes, std::string_view name,
                                       const PhotometricReadOptions& options = {});

/// Reads either, by content. Throws InputError if it is neither, larger than 64 MiB, or as above.
[[nodiscard]] PhotometricFile read_photometric_file(const std::filesystem::path& path,
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
[[nodiscard]] std::vector<Diagnostic> check_photometric_file(const std::filesystem::path& path,
                                                             const PhotometricReadOptions& options = {});

}  // namespace lucerna
#pragma GCC visibility pop
