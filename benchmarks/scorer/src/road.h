// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "box_error.h"
#include "json_node.h"

namespace bench {

/// What a ray adds to a sum: its weight times `per_weight`, which is from 0 to 1.
struct Deposit {
  int sum = -1;
  double per_weight = 0.0;
};
inline constexpr std::size_t kMaxLanes = 4;
using Deposits = std::array<Deposit, kMaxLanes + 1>;

/// How a road is lit by lamps like this one at even distances: figures of EN 13201-3 and CIE 140. Each with
/// its standard error from the replicates.
struct RoadScore {
  /// Flux of a lamp, with which the darkest lane's mean luminance is 1 cd/m2, as of the source.
  Estimate lm_per_cd_m2;
  /// Least over mean luminance of the field (Uo), and along the middle of a lane (Ul): of the worst lane.
  Estimate overall, lengthwise;
  /// Largest threshold increment (TI) at 1 cd/m2, as a share.
  Estimate threshold_increment;
};

/// A straight road under a row of lamps. Frame: the lamp stands over the origin; x is the direction of
/// travel, z up; lanes side by side from y = 0 on. All lamps are alike, so a ray of one counts in the field
/// of another.
///
/// The field between two lamps has cells, `steps` along and three across each lane. A cell's luminance is the
/// mean over its area: each ray adds its flux times the luminance coefficient that its own direction has for
/// an observer 60 m before the field, 1.5 m high, in the middle of each lane. (The standards take the cell's
/// middle.) Glare: veiling luminance at eyes in the middle of each lane at as many places, from lamps that
/// are not screened by the car's roof (20 degrees), up to 500 m away; the illuminance at an eye is the mean
/// over the field's step by 1 m. Immutable; thread safe.
class Road {
 public:
  /// Keys of a target of kind road. Throws InputError.
  Road(const JsonNode& target, double height_mm);

  /// Of a ray that comes from above: where it meets the road, what it adds. False off the road.
  bool land(const Vec3& origin, const Vec3& direction, Deposits& deposits) const;
  std::size_t sums() const { return field_sums() + lanes_ * steps_; }
  /// From the sums of each replicate as shares of the source's flux.
  RoadScore score(const std::vector<std::vector<double>>& by_replicate) const;
  double width_mm() const { return static_cast<double>(lanes_) * lane_mm_; }
  double min_overall() const { return min_overall_; }
  double min_lengthwise() const { return min_lengthwise_; }
  double max_increment() const { return max_increment_; }

 private:
  struct Figures {
    double lm_per_cd_m2 = 0.0, overall = 0.0, lengthwise = 0.0, threshold_increment = 0.0;
  };
  static constexpr std::size_t kAcross = 3;

  std::size_t field_sums() const { return lanes_ * kAcross * lanes_ * steps_; }
  double step_mm() const { return spacing_mm_ / static_cast<double>(steps_); }
  void read_reflection(const JsonNode& table);
  /// Reduced luminance coefficient r, per sr.
  double reduced(double tan_gamma, double beta_deg) const;
  /// Veiling luminance, cd/m2, of an illuminance at the eye: Holladay's formula for an observer of 23 years.
  static double veil(double theta_deg, double lux);
  double luminance_coefficient(const Vec3& at, const Vec3& direction, std::size_t observer) const;
  Deposit glare(const Vec3& eye_level, const Vec3& direction) const;
  Figures figures(const std::vector<double>& shares) const;

  double most_veil_;
  double height_mm_, lane_mm_, spacing_mm_, min_overall_, min_lengthwise_, max_increment_;
  std::size_t lanes_, steps_;
  std::vector<double> tan_gamma_, beta_deg_;
  std::vector<std::vector<double>> reduced_;
};

}  // namespace bench
