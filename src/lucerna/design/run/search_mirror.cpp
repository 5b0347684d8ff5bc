// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/run/search_mirror.h"

#include <fmt/format.h>

#include <algorithm>

#include "lucerna/design/fit/fit.h"
#include "lucerna/design/search/checkpoint.h"
#include "lucerna/design/search/free_form_search.h"

namespace lucerna {

namespace {

/// Knots along the longer side where the project does not say how many: 2.5 mm on a mirror of 120 mm, which
/// closes the image of a hole of 8 mm.
constexpr int kMaxFreeIntervals = 48;

/// Asks after every step whether to stop, and says why.
class Stop {
 public:
  Stop(const SearchRun& run, std::uint64_t rays_before, DesignResult& result)
      : run_(run), before_(rays_before), result_(result) {}

  bool operator()(std::uint64_t total_rays, std::uint64_t next_rays) {
    if (run_.progress.stop_requested()) {
      result_.end = DesignTermination::interrupted;
    } else if (run_.time.spent(total_rays - before_, next_rays)) {
      result_.end = DesignTermination::time;
    }
    return result_.end != DesignTermination::converged;
  }

 private:
  const SearchRun& run_;
  std::uint64_t before_;
  DesignResult& result_;
};

/// Steps a search until it is done or has to stop; the result gets what it came to.
template <class Search>
void step_until_done(const SearchRun& run, Search& search, Stop& stop, DesignResult& result) {
  while (!search.done() && !stop(search.state().total_rays, search.next_rays())) {
    const std::optional<FitRecord> record = search.step(run.progress);
    if (!record) continue;  // a candidate without a start
    result.history.push_back(*record);
    run.progress.update("design", static_cast<std::uint64_t>(record->evaluations), 0);
    if (run.observer) run.observer(*record, search.best(), checkpoint_text(search.state(), run.key));
  }
  result.shape = search.best();
  result.checkpoint = checkpoint_text(search.state(), run.key);
  result.evaluations = search.state().evaluations;
  result.rays = search.state().total_rays;
}

void search_free_form(const SearchRun& run, const FitProblem& fit, DesignResult& result) {
  FreeFormState state;
  if (!run.options.checkpoint.empty()) state = parse_search_checkpoint(run.options.checkpoint, run.key);
  Stop stop(run, state.total_rays, result);
  const int intervals = run.problem.fixed_knots ? 0 : kMaxFreeIntervals;
  FreeFormSearch search(fit, run.problem.start, intervals, run.options.max_rays, std::move(state));
  step_until_done(run, search, stop, result);
  if (search.out_of_candidates()) {
    result.remarks.push_back("ended before its time: no mirror to begin with is left to try");
  }
}

void search_coarse_to_fine(const SearchRun& run, FitProblem& fit_data, DesignResult& result) {
  const DesignProblem& problem = run.problem;
  const ContinuationSchedule schedule =
      continuation_schedule(problem.start, fit_data.bins, {run.options.max_rays, problem.knot_doublings});
  FitState state;
  if (!run.options.checkpoint.empty()) state = parse_checkpoint(run.options.checkpoint, run.key);
  Stop stop(run, state.total_rays, result);
  const bool begun = !state.parameters.empty();  // before the fit there may be a search
  const auto watch = [&](const FitRecord& record, const DesignShape& best) {
    result.history.push_back(record);
    result.rays = record.total_rays;
    if (run.observer) run.observer(record, best, checkpoint_text(state, run.key));
    return !stop(record.total_rays, record.rays);
  };
  if (!prepare_guesses(fit_data, problem.start, schedule, problem.optimizer, state.search_costs, watch,
                       run.progress)) {
    result.shape = fit_data.guesses[0].shape;
    result.checkpoint = checkpoint_text(state, run.key);
    result.evaluations = static_cast<int>(state.search_costs.size());
    return;
  }
  Fit fit = begun ? Fit(fit_data, schedule, problem.start, state)
                  : Fit(fit_data, schedule, problem.start, state.search_costs);
  step_until_done(run, fit, stop, result);
  if (result.end == DesignTermination::converged && !fit.at_noise()) {
    result.remarks.push_back(
        fmt::format("ended before its time: {} further restarts in a row brought nothing better",
                    fit.state().restart.failed));
  }
}

}  // namespace

bool uses_free_form_search(const DesignProblem& problem) {
  return !problem.start.is_revolution() && problem.optimizer.name == "auto";
}

void search_mirror(const SearchRun& run, FitProblem& fit, DesignResult& result) {
  if (uses_free_form_search(run.problem)) {
    search_free_form(run, fit, result);
  } else {
    search_coarse_to_fine(run, fit, result);
  }
}

}  // namespace lucerna
