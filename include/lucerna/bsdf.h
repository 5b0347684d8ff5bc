// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#pragma GCC visibility push(default)
namespace lucerna {

/// A measured BRDF as a `.bsdf` file has it: values at azimuths and radial angles. Of Zemax OpticStudio these
/// are about the mirrored direction, and azimuth 0 leads from there to the surface's normal; of LightTools
/// about the normal, and azimuth 0 (270 in the file) leads to the mirrored direction.
struct BsdfTable {
  /// True for angles about the normal.
  bool is_about_normal = false;
  /// Angles of incidence, ascending in [0, 90).
  std::vector<double> incidence_deg;
  /// Ascending from 0: to 180, and the same on the other side of the plane of incidence, or to 360.
  std::vector<double> azimuth_deg;
  /// Ascending from 0, at most 180; about the normal at most 90. Beyond the last the BRDF is 0.
  std::vector<double> radial_deg;
  /// 1/sr, >= 0: [incidence][azimuth][radial].
  std::vector<double> brdf;
  /// Where the file has several, and these values are of the one nearest to what was asked for; else 0.
  double wavelength_nm = 0.0;
  /// Reflectance at each incidence as the file states it (TIS), in (0, 1].
  std::vector<double> total;

  /// Do azimuths to 180 degrees stand for both sides?
  bool is_symmetrical() const { return azimuth_deg.back() == 180.0; }
  /// Where the values of an incidence and an azimuth begin.
  std::size_t row(std::size_t incidence, std::size_t azimuth) const {
    return (incidence * azimuth_deg.size() + azimuth) * radial_deg.size();
  }
};

/// Reads such a file of either maker. Of tristimulus values Y is taken, of several wavelengths (LightTools)
/// the one nearest to `wavelength_nm`; of LightTools the front's BRDF, while its back and light that goes
/// through are passed over. Throws InputError with file and line for what breaks the format, and what is not
/// supported: a file of Zemax of light that goes through (BTDF), several rotations of the sample or planes of
/// incidence, and no BRDF of the front. At most 64 MiB. Thread safe.
[[nodiscard]] BsdfTable read_bsdf(const std::filesystem::path& path, double wavelength_nm = 555.0);
/// The same of a text; `name` stands for the file in messages.
[[nodiscard]] BsdfTable parse_bsdf(std::string_view text, const std::string& name,
                                   double wavelength_nm = 555.0);

}  // namespace lucerna
#pragma GCC visibility pop
