// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "score.h"

namespace bench {

/// What was run: it stands apart from the score, which does not depend on it.
struct RunFacts {
  std::uint64_t seed = 1;
  std::string rays_from;
  unsigned threads = 1;
  double seconds = 0.0;
  std::string machine;
};

/// All figures in one object; `run` has the threads, the seconds and the machine of the scoring.
nlohmann::ordered_json score_json(const Task& task, const Submission& submission, const Target& target,
                                  const Score& score, const RunFacts& run);
std::string score_text(const nlohmann::ordered_json& score);

/// Boxes as lines `u_low,u_high,v_low,v_high,measure,target,share,standard_error`.
std::string boxes_csv(const Target& target, const Score& score);

/// Model of the processor and number of its threads, as the system names them.
std::string machine_name();

}  // namespace bench
