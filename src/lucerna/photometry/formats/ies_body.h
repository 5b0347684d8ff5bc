// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>
#include <vector>

#include "lucerna/photometry/formats/photometric_text.h"

namespace lucerna {

/// The numbers of an LM-63 file after its TILT line, sorted into their fields. Counts agree with the vectors'
/// sizes.
struct IesBody {
  int tilt_geometry = 0;                                ///< 1 to 3; 0 without TILT=INCLUDE
  std::vector<std::pair<double, double>> tilt_factors;  ///< angle, factor
  double lamps = 1.0, lumens_per_lamp = -1.0, multiplier = 1.0;
  int type = 1;   ///< 1 C, 2 B, 3 A
  int units = 2;  ///< 1 feet, 2 m
  double width = 0.0, length = 0.0, height = 0.0;
  double ballast_factor = 1.0, second_factor = 1.0;
  std::string_view second_text;  ///< `second_factor` as written
  double input_watts = 0.0;
  std::vector<double> v_deg, h_deg, values;  ///< `values[h * v_deg.size() + v]`
  std::size_t first_line = 0, v_line = 0, h_line = 0, values_line = 0;
};

/// Sorts the numbers on `lines[from...]`. Values are parted by blanks, tabs, line ends and commas; if the
/// count then does not fit but does with commas read as decimal points, those are taken, with a repair. A
/// missing second record and values left over are repaired; too few values and what is no number fail with
/// both numbers and the line. `line_count` entries are allocated only after they were found in the file.
IesBody parse_ies_body(const std::vector<std::string_view>& lines, std::size_t from, bool tilt_included,
                       RepairLog& log);

}  // namespace lucerna
