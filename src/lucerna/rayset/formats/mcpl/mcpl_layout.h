// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace lucerna {

/// Places of the numbers in the header; the texts follow, each after its length in 4 bytes.
struct McplHeaderBytes {
  static constexpr std::size_t version = 4, endian = 7, particles = 8, comments = 16, blobs = 20,
                               user_flags = 24, polarisation = 28, single_precision = 32, pdg_code = 36,
                               particle_size = 40, universal_weight = 44, size = 48;
};

/// Where the numbers of one particle stand, in this order: polarisation (3 numbers, if any), place (3),
/// direction and energy packed (3), time, weight (unless all have one), PDG code (unless all have one), user
/// flags (if any).
struct McplRecord {
  bool user_flags = false, polarisation = false, single_precision = false;
  bool own_weights = true, own_codes = false;

  std::size_t number_bytes() const { return single_precision ? 4 : 8; }
  std::size_t place() const { return polarisation ? 3 * number_bytes() : 0; }
  std::size_t direction() const { return place() + 3 * number_bytes(); }
  std::size_t time() const { return direction() + 3 * number_bytes(); }
  std::size_t weight() const { return time() + number_bytes(); }
  std::size_t code() const { return weight() + (own_weights ? number_bytes() : 0); }
  std::size_t flags() const { return code() + (own_codes ? 4 : 0); }
  std::size_t bytes() const { return flags() + (user_flags ? 4 : 0); }
};

/// Photons, and what Geant4 calls optical photons.
constexpr bool is_photon(std::int32_t pdg_code) { return pdg_code == 22 || pdg_code == -22; }

/// Wavelength times energy: h c in nm MeV, and J per MeV. Both follow from the exact constants of the SI
/// (2019).
inline constexpr double kMcplNmMeV = 1.2398419843320026e-3, kMcplJoulePerMeV = 1.602176634e-13;
inline constexpr double kMcplMmPerCm = 10.0;

/// Labels of the additional columns that MCPL has places for.
inline constexpr std::string_view kMcplFlags = "userflags";
inline constexpr std::array<std::string_view, 3> kMcplPolarisation{"polarisation x", "polarisation y",
                                                                   "polarisation z"};

/// What comments of files written here begin with: "lucerna: flux_w 1.25", "lucerna: unit lm",
/// "lucerna: light_source NAME".
inline constexpr std::string_view kMcplCommentPrefix = "lucerna: ";

/// The program that stands as the source of files written here, unless the ray set names one.
inline constexpr std::string_view kMcplSource = "Lucerna";

}  // namespace lucerna
