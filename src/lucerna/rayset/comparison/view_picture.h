// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace lucerna {

/// Three pictures side by side, for write_png: reference, test and their difference (test - reference).
struct ComparisonPicture {
  std::size_t width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
  /// White in the first two, black is 0: the largest value of the reference.
  double white = 0.0;
  /// Full red (the test has more) and full blue (less) in the third, white is 0: the largest difference.
  double difference = 0.0;
};

/// Both have `columns` x `rows` values, those of a column together, the lowest row first (as the cells of a
/// ViewWindow; what follows them is ignored); each becomes a square of `zoom` pixels. Values are shown by a
/// colour scale of steadily rising lightness (D. A. Green, Bull. Astron. Soc. India 39, 289, 2011), also
/// readable in grey.
ComparisonPicture comparison_picture(std::size_t columns, std::size_t rows, std::span<const double> reference,
                                     std::span<const double> test, std::size_t zoom);

}  // namespace lucerna
