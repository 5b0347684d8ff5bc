// SPDX-License-Identifier: Apache-2.0
#include "lucerna/cli/parse/session.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <ctime>
#include <nlohmann/json.hpp>

#include "lucerna/cli/parse/arguments.h"
#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"

namespace lucerna::cli {

namespace {

// Handlers run on any thread and are read on all: atomic, and without locks, which a handler may not take.
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<long>::is_always_lock_free);
std::atomic<bool> stop_signal = false;
/// Whether the first Ctrl-C says what a second one does, and on a line that holds something already.
std::atomic<bool> tell_of_signals = false, on_terminal = false;
/// When the first SIGINT came, in ms; 0 before.
std::atomic<long> first_interrupt_ms = 0;

/// `timeout` and launchers send one Ctrl-C twice, to the program and to its group; nobody types so fast.
constexpr long kOneCtrlC_ms = 250;

long monotonic_ms() {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  return (now.tv_sec * 1000L + now.tv_nsec / 1'000'000) | 1;  // never 0
}

extern "C" void on_stop_signal(int) { stop_signal = true; }

/// Asks the work to stop; a second one ends the program as if there were no handler. Calls only what a
/// handler may call (POSIX: async-signal-safe).
extern "C" void on_interrupt(int signal) {
  const int saved_errno = errno;
  stop_signal = true;
  const long now = monotonic_ms();
  if (first_interrupt_ms != 0 && now - first_interrupt_ms > kOneCtrlC_ms) {
    std::signal(signal, SIG_DFL);
    std::raise(signal);
  } else if (first_interrupt_ms == 0) {
    first_interrupt_ms = now;
    constexpr std::string_view kNote = "\nlucerna: stopping; Ctrl-C again ends the program at once\n";
    const std::string_view note = kNote.substr(on_terminal ? 0 : 1);
    if (tell_of_signals && ::write(STDERR_FILENO, note.data(), note.size()) < 0) stop_signal = true;
  }
  errno = saved_errno;
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

void TerminalProgress::update(std::string_view phase, std::uint64_t done, std::uint64_t total) {
  if (!visible_) return;
  const auto now = Clock::now();
  if (phase != phase_) {
    phase_ = phase;
    phase_start_ = now;
  }
  if (now - last_draw_ < std::chrono::milliseconds(200)) return;
  last_draw_ = now;
  const double elapsed = seconds_since(phase_start_);
  const double rate = elapsed > 0.0 ? static_cast<double>(done) / elapsed : 0.0;
  std::string line = fmt::format("{}: {}", phase_, done);
  if (total > 0) {
    line =
        fmt::format("{}: {:3.0f} %", phase_, 100.0 * static_cast<double>(done) / static_cast<double>(total));
    if (rate > 0.0 && total > done)
      line += fmt::format(", {:.0f} s left", static_cast<double>(total - done) / rate);
  }
  if (rate > 0.0) line += fmt::format(", {:.3g} M/s", 1e-6 * rate);
  fmt::print(stderr, "\r\033[K{}", line);
  std::fflush(stderr);
  drawn_ = true;
}

void TerminalProgress::show(const std::string& line) {
  const auto now = Clock::now();
  if (!visible_ || now - last_draw_ < std::chrono::milliseconds(200)) return;
  last_draw_ = now;
  fmt::print(stderr, "\r\033[K{}", line);
  std::fflush(stderr);
  drawn_ = true;
}

bool TerminalProgress::stop_requested() const { return stop_signal; }

void TerminalProgress::clear() {
  if (!drawn_) return;
  fmt::print(stderr, "\r\033[K");
  std::fflush(stderr);
  drawn_ = false;
}

Session::~Session() {
  std::error_code of_full_ones;
  for (const auto& folder : made_folders_) std::filesystem::remove(folder, of_full_ones);
}

void Session::add_common(Command& command) {
  command.option("--threads", threads, "Worker threads (default: all)", 1, 4096);
  command.flag("--quiet", quiet, "Print no progress and no result as text; warnings and --json remain");
}

void Session::add_json(Command& command) {
  command.flag("--json", json, "Print one JSON object instead of text");
}

void Session::add_strict(Command& command) {
  command.flag("--strict", strict, "Refuse files that need a repair or raise a warning");
}

void Session::start() {
  if (threads > 0) limit_ = std::make_unique<ThreadLimit>(threads);
  const bool terminal = ::isatty(STDERR_FILENO) == 1;
  progress_ = std::make_unique<TerminalProgress>(!quiet && terminal);
  tell_of_signals = !quiet;
  on_terminal = terminal;
  std::signal(SIGINT, on_interrupt);
  std::signal(SIGTERM, on_stop_signal);
}

Session::PhaseTimer::~PhaseTimer() { session.add_seconds(name, seconds_since(start)); }

void Session::add_seconds(const std::string& phase, double seconds) {
  const auto found =
      std::find_if(run_.wall_s.begin(), run_.wall_s.end(), [&](const auto& p) { return p.first == phase; });
  if (found == run_.wall_s.end()) {
    run_.wall_s.emplace_back(phase, seconds);
  } else {
    found->second += seconds;
  }
}

void Session::stop_on_signal(int signal) { std::signal(signal, on_stop_signal); }

void Session::set_command(const std::string& program, int argc, char** argv) {
  run_.command = program;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const bool plain =
        !word.empty() && word.find_first_of(" \t\n'\"\\$*?[](){}<>|&;`#~!") == std::string::npos;
    run_.command += plain ? " " + word : " '" + word + "'";
  }
}

double Session::seconds(const std::string& phase) const {
  for (const auto& [name, elapsed] : run_.wall_s) {
    if (name == phase) return elapsed;
  }
  return 0.0;
}

Json Session::json_head(std::optional<std::uint64_t> seed, const std::string& isa) const {
  return run_json(run_, seed, isa);
}

void Session::print_line(const std::string& line) {
  if (quiet || json) return;
  if (progress_) progress_->clear();
  fmt::print("{}\n", line);
}

void Session::note(const std::string& line) {
  if (!notes_.insert(line).second) return;
  if (progress_) progress_->clear();
  fmt::print(stderr, "lucerna: {}\n", line);
}

void Session::print_json(const Json& object) {
  if (!json) return;
  if (progress_) progress_->clear();
  fmt::print("{}\n", object.dump(2, ' ', false, Json::error_handler_t::replace));
}

void Session::prepare_folder(const std::filesystem::path& folder, bool may_hold_files) {
  std::error_code error;
  if (std::filesystem::create_directories(folder, error)) made_folders_.push_back(folder);
  if (error || !std::filesystem::is_directory(folder)) {
    throw InputError(fmt::format("{}: cannot make the folder: {}", folder.string(),
                                 error ? error.message() : "a file of that name is in the way"),
                     ErrorCause::unwritable);
  }
  if (!may_hold_files && !std::filesystem::is_empty(folder)) {
    throw InputError(
        fmt::format("{}: the folder is not empty; choose another or give --force", folder.string()));
  }
  require_writable(folder / "result.json");  // before the work whose result would be lost
}

void require_writable(const std::filesystem::path& file) {
  if (file.empty()) return;
  const OutputFile probe(file);  // not committed: leaves nothing behind
}

void require_report(const std::filesystem::path& file) {
  const std::string ending = lower_ending(file);
  if (!file.empty() && ending != ".html" && ending != ".htm")
    throw UsageError(fmt::format("{}: a report is an HTML file, expected the ending .html", file.string()));
  require_writable(file);
}

}  // namespace lucerna::cli
