// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lucerna/core/parallel/peers.h"
#include "lucerna/design.h"
#include "lucerna/design/constraints/limit_check.h"
#include "lucerna/design/run/advice.h"
#include "lucerna/design/run/design_problem.h"
#include "lucerna/design/run/pareto.h"
#include "lucerna/design/validation/bounds.h"
#include "lucerna/design/validation/box_error.h"
#include "lucerna/design/validation/zone_check.h"
#include "lucerna/trace.h"

namespace lucerna {

/// How the light of a result is traced.
using FinalTrace =
    std::function<std::optional<NoiseTrace>(const Scene&, const TraceOptions&, const NoiseGoal&)>;

struct DesignOptions {
  std::uint64_t seed = 1;
  /// Wall time after which the design stops at the next step; nothing: the problem's own. It only stops:
  /// every decision depends on counts.
  std::optional<double> time_s;
  /// Rays of an evaluation at the end, at most.
  std::uint64_t max_rays = std::uint64_t{1} << 23;
  /// Rays of the validation, at most (ValidationOptions::max_rays), other than those it was fitted with.
  /// Where time ran out or the user asked to stop, fewer may be traced.
  std::uint64_t validation_rays = std::uint64_t{1} << 24;
  /// Rays that will be traced after that (run_design sets it); time is kept for them.
  std::uint64_t rays_after = 0;
  /// Where evaluations are traced (device_evaluator.h); null: on the CPU.
  std::shared_ptr<Accelerator> accelerator;
  /// Processes that run the same design and share its work (peers.h): each calls with the same arguments, and
  /// its progress asks to stop at the same moments of the design. CPU only. Null: this one alone.
  Peers* peers = nullptr;
  /// Traces the light of the result (run_design); empty: `trace_until`. With peers all call it, and the
  /// first alone has to return something: the others have no light and no figures.
  FinalTrace final_trace;
  /// Also the trade between error and light (pareto.h), after the time that was given.
  bool pareto = false;
  /// Also what other outlines and families would bring (advice.h), each designed for the same time.
  bool advise = false;
  /// State to go on from (`checkpoint_text`); empty: from the start.
  std::string checkpoint;
};

/// Throws InputError for fewer rays than an evaluation needs: one block of every task (8192).
void check(const DesignOptions& options);

struct DesignResult : DesignFindings {
  explicit DesignResult(DesignShape found) : shape(std::move(found)) {}

  DesignShape shape;
  std::vector<FitRecord> history;
  /// State to resume from; a design that is taken up from it ends at the same bits as one never stopped.
  std::string checkpoint;
  /// Seconds that validating start and result took.
  double validation_s = 0.0;
};

/// What is computed after a search. Where it is stopped it is left out, and a remark of the result says so,
/// by the name of `what`; nothing is computed after that. Processes that share the work stop together, by the
/// exception.
template <class Compute>
void unless_stopped(const DesignOptions& options, DesignResult& result, const char* what,
                    const Compute& compute) {
  try {
    if (result.end != DesignTermination::interrupted) return compute();
  } catch (const Interrupted&) {
    if (options.peers != nullptr) throw;
    result.end = DesignTermination::interrupted;
  }
  result.remarks.push_back(std::string("left out, for the design was stopped before: ") + what);
}

/// Called after every step with the best so far and the state to resume from.
using DesignObserver =
    std::function<void(const FitRecord&, const DesignShape& best, const std::string& checkpoint)>;

/// The rays of a problem's sources in the mirror's frame, evaluated where the options say, with what shades
/// them. None are drawn yet.
DesignRays design_rays(const DesignProblem& problem, const DesignOptions& options, std::uint64_t seed);

/// The problem as a fit sees it: in the mirror's frame, in shares of the sources' flux, with all limits. Both
/// `problem` and `rays` (the problem's sources in the mirror's frame) must outlive it.
FitProblem fit_problem(const DesignProblem& problem, const DesignOptions& options, DesignRays& rays);

/// Shapes the problem's mirror until its far field is the target's, as well as it can be: Levenberg-Marquardt
/// with exact path derivatives on smooth bins. Free forms are searched among candidates
/// (docs/theory/free-form-search.md), other families on a schedule from coarse to fine with restarts
/// (docs/theory/design.md). The result is validated, and never worse than the given mirror by that.
/// Progress phases "rays", "design" (in steps of unknown number). Stops early at `time_s` or when progress
/// asks; the result is then the best so far, whole, with `end` saying so. Throws InputError on a checkpoint
/// of another problem, and where min_efficiency and the reflectance contradict each other.
DesignResult design(const DesignProblem& problem, const DesignOptions& options,
                    Progress& progress = no_progress(), const DesignObserver& observer = {});

/// The history as CSV.
std::string history_csv(const std::vector<FitRecord>& history);

}  // namespace lucerna
