// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "lucerna/cli/parse/command.h"
#include "lucerna/core/parallel/parallel.h"
#include "lucerna/progress.h"
#include "lucerna/results/json/run_json.h"

namespace lucerna::cli {

using Json = nlohmann::ordered_json;

/// Progress on a terminal's stderr: phase, share, rate and time left, redrawn a few times a second. Ctrl-C
/// (SIGINT) and SIGTERM ask the work to stop; a second Ctrl-C ends the program at once.
class TerminalProgress final : public Progress {
 public:
  explicit TerminalProgress(bool visible) : visible_(visible) {}
  ~TerminalProgress() override { clear(); }
  void update(std::string_view phase, std::uint64_t done, std::uint64_t total) override;
  bool stop_requested() const override;
  /// Draws a line of the caller's own instead, as often as `update` would.
  void show(const std::string& line);
  /// Wipes the line, so that results can follow.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;
  bool visible_, drawn_ = false;
  std::string phase_;
  Clock::time_point phase_start_{}, last_draw_{};
};

/// What the options common to all commands said, and what one run of the program gathers: its clock and its
/// inputs.
class Session {
 public:
  int threads = 0;  ///< 0 = all
  bool quiet = false, json = false, strict = false, force = false;

  Session() = default;
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Adds --threads and --quiet to a command.
  void add_common(Command& command);
  void add_json(Command& command);
  void add_strict(Command& command);

  /// To be called once all options are parsed and before any work.
  void start();
  /// One more signal, beside SIGINT and SIGTERM, that asks the work to stop.
  static void stop_on_signal(int signal);
  Progress& progress() { return *progress_; }
  /// A line of progress on a terminal, redrawn a few times a second.
  void show(const std::string& line) { progress_->show(line); }

  /// Runs `work` and adds its wall time to the phase `name`.
  template <class Work>
  auto timed(const std::string& name, Work&& work) {
    const PhaseTimer timer(*this, name);
    return std::forward<Work>(work)();
  }
  double seconds(const std::string& phase) const;
  /// Adds a wall time that something else took.
  void add_seconds(const std::string& phase, double seconds);

  /// Notes the words of the command line, for the record.
  void set_command(const std::string& program, int argc, char** argv);

  /// The folder that a command writes to: made if missing; refused (InputError) when it holds files, unless
  /// `may_hold_files`, and where no file can be written. One that was made and is still empty when the
  /// session ends is removed.
  void prepare_folder(const std::filesystem::path& folder, bool may_hold_files);

  /// What the run was made of, so far.
  const RunRecord& record() const { return run_; }
  /// Notes a file that the result depends on.
  void add_input(const std::filesystem::path& path) { run_.inputs.push_back(path); }

  /// run_json of this run.
  Json json_head(std::optional<std::uint64_t> seed, const std::string& isa = "scalar") const;

  /// Prints the line unless --quiet or --json; `note` goes to stderr also with --json, the same line once.
  void print_line(const std::string& line);
  void note(const std::string& line);
  void print_json(const Json& object);

 private:
  struct PhaseTimer {
    PhaseTimer(Session& owner, std::string phase_name) : session(owner), name(std::move(phase_name)) {}
    ~PhaseTimer();
    PhaseTimer(const PhaseTimer&) = delete;
    PhaseTimer& operator=(const PhaseTimer&) = delete;
    Session& session;
    std::string name;
    std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
  };

  std::unique_ptr<ThreadLimit> limit_;
  std::unique_ptr<TerminalProgress> progress_;
  RunRecord run_;
  std::set<std::string> notes_;
  std::vector<std::filesystem::path> made_folders_;
};

/// Throws InputError where a file could not be written there, before the work that ends in it; an empty path
/// is none. What is there stays as it is.
void require_writable(const std::filesystem::path& file);

/// The same of a report. Throws UsageError where its name has another ending than a page's: the file that is
/// there may be a project or a result.
void require_report(const std::filesystem::path& file);

}  // namespace lucerna::cli
