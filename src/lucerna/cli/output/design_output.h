// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "lucerna/cli/parse/session.h"
#include "lucerna/design/run/design_run.h"
#include "lucerna/results/json/design_json.h"

namespace lucerna::cli {

/// Adds a step to the lines of history.csv.
void add_step(const FitRecord& record, std::string& history);
/// What is drawn of a step while a design runs.
std::string step_line(const FitRecord& record);
/// Notes how long each phase took, and where the time did not bring the trace's noise to its goal.
void note_phases(const FollowUp& run, Session& session);

/// Draws the progress and leaves the best so far in the folder after every step.
class DesignWatch {
 public:
  /// `history`: lines of before, of a design that goes on. `problem` and `session` must outlive it.
  DesignWatch(std::filesystem::path folder, const DesignProblem& problem, std::string history,
              Session& session)
      : folder_(std::move(folder)), problem_(problem), history_(std::move(history)), session_(session) {}

  void operator()(const FitRecord& record, const DesignShape& best, const std::string& checkpoint);
  const std::string& history() const { return history_; }

 private:
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
  }
  std::filesystem::path folder_;
  const DesignProblem& problem_;
  std::string history_;
  Session& session_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

/// Designs with a watch, and notes how long each phase took.
DesignRun run_watched(const DesignProblem& problem, const DesignOptions& options, const DesignObserver& watch,
                      Session& session, Progress& progress);

/// Where the results of a design go.
struct DesignOutput {
  std::string folder, report;
  std::uint64_t seed = 1;
  /// "cpu", or the name of the device that evaluated.
  std::string device = "cpu";
  /// DesignWatch::history.
  std::string history;
};

/// A design that is over.
struct FinishedDesign {
  const DesignTarget& target;
  const DesignFindings& result;
  DesignForm form;
  const FollowUp& run;
  const Project& project;
};
/// Fills the folder, `result.json` with these fields last; returns the names.
using DesignFiles = std::function<std::vector<std::string>(const nlohmann::ordered_json&)>;

/// The end of `design`: fills the folder, prints the figures, writes the report unless its name is empty.
/// Returns the exit code: 1 where a limit is not held or a zone not met, 3 where the design was interrupted.
int write_design_output(const DesignOutput& output, const FinishedDesign& design, const DesignFiles& write,
                        Session& session);
int write_design_output(const DesignOutput& output, const DesignProblem& problem, const DesignRun& made,
                        Session& session);

}  // namespace lucerna::cli
