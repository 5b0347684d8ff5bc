// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "emitter.h"
#include "json_node.h"
#include "surface.h"
#include "target.h"

namespace bench {

/// What happens at the surfaces of a task.
struct Optics {
  std::vector<std::string> roles;
  double reflectance = 1.0;
  /// Interfaces: Fresnel's equations (unpolarised), or a fixed share that is lost; total reflection is
  /// without loss in both.
  bool fresnel = true;
  double interface_loss = 0.0, min_index = 1.0, max_index = 1.0, absorption_per_mm = 0.0;
};

/// A rule for the place of all surfaces of a submission.
struct Limit {
  std::string kind;
  std::vector<double> values;
  std::string note;
};

/// A task file (benchmarks/README.md, "Tasks"). Throws InputError with the place of what is wrong.
struct Task {
  explicit Task(const std::string& file);

  std::string id, title, headline;
  JsonNode definition;
  std::unique_ptr<Source> source;
  SourceBody source_body;
  Frame source_place;
  Optics optics;
  std::vector<Limit> limits;
  /// May a submission say where its target is?
  bool free_target = false;
};

/// How a limit is met by a submission.
struct LimitCheck {
  std::string limit, found, allowed;
  bool held = false;
};
/// `surfaces`: those of a submission.
LimitCheck check_limit(const Limit& limit, const std::vector<const Surface*>& surfaces);

}  // namespace bench
