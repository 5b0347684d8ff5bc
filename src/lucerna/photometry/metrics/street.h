// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "lucerna/intensity.h"
#include "lucerna/photometric_file.h"

namespace lucerna {

/// The C angle that a file's format means by the street side: C90 for EULUMDAT and for what was made here;
/// for IES files H 0, which is C0, or C90 if they were read with `IesTurn::minus_90`.
double street_side_c_deg(const PhotometricOrigin& origin, IesTurn ies_turn);

/// Flux in the ten secondary solid angles of IES TM-15-11, in lm: front (within 90 degrees of the street
/// side in C) and back, low (gamma 0-30), medium (30-60), high (60-80) and very high (80-90); up low (90-100)
/// and up high (100-180).
struct LuminaireZones {
  double front_low = 0.0, front_medium = 0.0, front_high = 0.0, front_very_high = 0.0;
  double back_low = 0.0, back_medium = 0.0, back_high = 0.0, back_very_high = 0.0;
  double up_low = 0.0, up_high = 0.0;

  double sum() const {
    return front_low + front_medium + front_high + front_very_high + back_low + back_medium + back_high +
           back_very_high + up_low + up_high;
  }
};

/// Computes them by the rule of `zonal_flux`, with the intensity linear in C where a plane at the border of
/// front and back is missing; they add up to `total_flux` where 30, 60, 80, 90 and 100 are grid angles.
/// Throws InputError if the grid breaks its rules or the data are radiometric. O(values log planes).
LuminaireZones luminaire_zones(const IntensityDistribution& distribution, double street_side_c_deg);

/// How a BUG rating is to be made.
struct BugOptions {
  double street_side_c_deg = 90.0;  ///< see `street_side_c_deg`
  /// Type V and VS luminaires, symmetric about nadir: their back counts like their front for glare.
  bool type_v = false;
  /// A zone of no more than this many lm counts as dark. U0 asks for exactly 0 lm, which neither laboratory
  /// (stray light) nor ray tracing (noise) can show; whoever quotes U0 with a threshold says so.
  double dark_below_lm = 0.0;
};

/// Backlight, uplight and glare rating of TM-15-11 (addendum A), each 0 to 5.
struct BugRating {
  LuminaireZones zones;  ///< as they are, before the threshold
  int backlight = 0, uplight = 0, glare = 0;
  /// True if without the threshold the rating would be another: to be printed with it.
  bool threshold_used = false;

  /// "B2-U0-G1".
  std::string text() const;
};

/// Limits of the BUG and G* tables are as commonly quoted from the two standards; their own text was not at
/// hand to compare with.
///
/// Rates a luminaire; the distribution must be absolute (lm of the luminaire as installed). Limits: B by
/// BL, BM, BH; U by UL, UH; G by FVH, BVH, FH, BH. Throws as `luminaire_zones`, and if the threshold is
/// negative or no number. Thread safe.
BugRating bug_rating(const IntensityDistribution& distribution, const BugOptions& options = {});

/// Luminous intensity class G*1 to G*6 of EN 13201-2:2015, table A.1, for the luminaire as it stands.
struct GlareClass {
  int number = 0;  ///< 1 to 6; 0 = none
  /// Largest intensities at and beyond 70, 80 and 90 degrees, and beyond 95, in cd per 1000 lm of the
  /// luminaire's own flux.
  double from_70 = 0.0, from_80 = 0.0, from_90 = 0.0, beyond_95 = 0.0;
  bool threshold_used = false;  ///< the class without the threshold would be lower

  /// "G*4", or "none".
  std::string text() const;
};

/// Classifies it: the highest class whose limits are all met. G*4 to G*6 also ask for no light beyond 95
/// degrees, and G*6 for none from 90 on; `dark_below_cd_per_klm` is what counts as none. Throws InputError if
/// the grid breaks its rules, the data are radiometric or dark, or the threshold is negative. O(values).
GlareClass glare_class(const IntensityDistribution& distribution, double dark_below_cd_per_klm = 0.0);

}  // namespace lucerna
