// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "json_node.h"
#include "random.h"
#include "vec.h"

namespace bench {

struct SourceRay {
  Vec3 origin, direction;
  double weight = 1.0;
};

/// Where the rays of a task come from. Immutable; thread safe.
class Source {
 public:
  virtual ~Source() = default;
  /// Ray `index`; weights have mean 1.
  virtual SourceRay ray(std::uint64_t index, RayRandom& random) const = 0;
  /// Rays there are, or 0 for any number.
  virtual std::uint64_t count() const { return 0; }
};

/// The emitter of a task's `source` table, by its definition (benchmarks/README.md, "Sources"), in the frame
/// of the task. Throws InputError for unknown kinds and sizes out of range.
std::unique_ptr<Source> read_emitter(const JsonNode& source);

/// Rays of a TM-25 file (IES TM-25-13), moved from the emitter's frame to that of the task. Throws InputError
/// with the byte where the file is damaged.
std::unique_ptr<Source> read_tm25(const std::string& file, const Frame& place);

/// What of the source takes light that comes back: a flat piece of the plane z = 0 of its frame.
struct SourceBody {
  Frame place;
  bool blocks = false;
  double half_x_mm = 0.0, half_y_mm = 0.0;
  /// Is the piece crossed within (0, t_max)?
  bool hit(const Vec3& origin, const Vec3& direction, double t_max) const;
};
SourceBody read_source_body(const JsonNode& source);

}  // namespace bench
