// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "surface.h"
#include "task.h"

namespace bench {

enum class Role { mirror, absorber, interface };

struct Part {
  std::string name;
  Role role = Role::mirror;
  std::shared_ptr<const Surface> surface;
  /// Normals are turned about.
  bool flip = false;
  double refractive_index = 1.0;
};

/// What the author says of the work: it is printed with the score and not checked.
struct Stated {
  std::int64_t free_parameters = 0;
  double wall_s = 0.0;
  std::optional<double> cpu_s;
  std::string machine, program, method;
};

/// A submission file (benchmarks/README.md, "Submissions"), its surfaces read. Throws InputError, also where
/// the task does not allow a role.
struct Submission {
  Submission(const std::string& file, const Task& task);

  std::string file, name, author;
  std::vector<Part> parts;
  /// Instead of surfaces, of a two-dimensional task: its light, which is not traced.
  std::unique_ptr<const Source> light_table;
  std::optional<Frame> target_place;
  Stated stated;
  /// How the task's limits are met.
  std::vector<LimitCheck> limits;

  /// Whose light is traced: the task's, or the light table.
  const Source& source(const Task& task) const { return light_table ? *light_table : *task.source; }
};

}  // namespace bench
