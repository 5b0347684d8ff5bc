// SPDX-License-Identifier: Apache-2.0
#include "intensity_table.h"

#include <algorithm>
#include <cmath>

namespace bench {

IntensityTable::IntensityTable(const JsonNode& t)
    : c_step_deg_(t.at("c_step_deg").number_in(0.01, 180.0)),
      gamma_step_deg_(t.at("gamma_step_deg").number_in(0.01, 90.0)) {
  for (const JsonNode& row : t.at("rows").items()) {
    rows_.push_back(row.numbers());
    if (rows_.back().size() < 2 || rows_.back().size() != rows_.front().size())
      row.fail(std::to_string(rows_.back().size()) + " values", "two or more, in all rows as many");
    if (*std::min_element(rows_.back().begin(), rows_.back().end()) < 0.0)
      row.fail("an intensity < 0", "none");
  }
  const double planes = 360.0 / c_step_deg_;
  if (std::abs(planes - static_cast<double>(rows_.size())) > 1e-6)
    t.at("rows").fail(std::to_string(rows_.size()) + " rows", "360 / c_step_deg");
  if (gamma_step_deg_ * static_cast<double>(rows_.front().size() - 1) > 90.0 + 1e-6)
    t.at("rows").fail("values beyond 90 degrees", "a beam within 90 degrees of its axis");
}

double IntensityTable::at(double u, double v) const {
  const double gamma = std::asin(std::min(1.0, std::hypot(u, v))) / kDegree / gamma_step_deg_;
  const std::size_t last = rows_.front().size() - 1;
  if (gamma > static_cast<double>(last)) return 0.0;
  double c = std::atan2(-v, u) / kDegree;
  if (c < 0.0) c += 360.0;
  c /= c_step_deg_;
  const std::size_t i = std::min(static_cast<std::size_t>(c), rows_.size() - 1),
                    j = std::min(static_cast<std::size_t>(gamma), last - 1);
  const auto &a = rows_[i], &b = rows_[(i + 1) % rows_.size()];
  const double s = c - static_cast<double>(i), g = gamma - static_cast<double>(j);
  return (1.0 - s) * ((1.0 - g) * a[j] + g * a[j + 1]) + s * ((1.0 - g) * b[j] + g * b[j + 1]);
}

}  // namespace bench
