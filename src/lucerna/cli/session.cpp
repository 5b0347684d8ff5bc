// SPDX-License-Identifier: Apache-2.0
#include "lucerna/cli/session.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <set>

#include "lucerna/cli/arguments.h"
#include "lucerna/core/error.h"
#include "lucerna/core/file.h"
#include "lucerna/version.h"

namespace lucerna::cli {

namespace {

volatile std::sig_atomic_t stop_signal = 0;

extern "C" void on_stop_signal(int) { stop_signal = 1; }

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

bool TerminalProgress::stop_requested() const { return stop_signal != 0; }

void TerminalProgress::clear() {
  if (!drawn_) return;
  fmt::print(stderr, "\r\033[K");
  std::fflush(stderr);
  drawn_ = false;
}

void Session::add_common(Command& command) {
  command.option("--threads", threads, "Worker threads (default: all)", 1, 4096);
  command.flag("--quiet", quiet, "Print no progress and no summary");
}

void Session::add_json(Command& command) {
  command.flag("--json", json, "Print one JSON object instead of text");
}

void Session::add_strict(Command& command) {
  command.flag("--strict", strict, "Refuse files that need a repair or raise a warning");
}

void Session::start() {
  if (threads > 0) limit_ = std::make_unique<ThreadLimit>(threads);
  progress_ = std::make_unique<TerminalProgress>(!quiet && ::isatty(STDERR_FILENO) == 1);
  std::signal(SIGINT, on_stop_signal);
  std::signal(SIGTERM, on_stop_signal);
}

Session::PhaseTimer::~PhaseTimer() {
  const double elapsed = seconds_since(start);
  auto& phases = session.phases_;
  const auto found =
      std::find_if(phases.begin(), phases.end(), [&](const auto& p) { return p.first == name; });
  if (found == phases.end()) {
    phases.emplace_back(name, elapsed);
  } else {
    found->second += elapsed;
  }
}

void Session::set_command(int argc, char** argv) {
  command_ = "lucerna";
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const bool plain =
        !word.empty() && word.find_first_of(" \t\n'\"\\$*?[](){}<>|&;`#~!") == std::string::npos;
    command_ += plain ? " " + word : " '" + word + "'";
  }
}

double Session::seconds(const std::string& phase) const {
  for (const auto& [name, elapsed] : phases_) {
    if (name == phase) return elapsed;
  }
  return 0.0;
}

Json Session::json_head(std::optional<std::uint64_t> seed, const std::string& isa) const {
  Json head;
  head["program_version"] = std::string(version());
  head["schema_version"] = kJsonSchemaVersion;
  head["command"] = command_;
  head["seed"] = seed ? Json(*seed) : Json();
  head["threads"] = ThreadLimit::current();
  head["isa"] = isa;
  head["inputs"] = Json::array();
  std::set<std::filesystem::path> seen;
  for (const auto& path : inputs_) {
    if (!seen.insert(path).second) continue;
    head["inputs"].push_back({{"path", path.string()}, {"sha256", sha256_of_file(path)}});
  }
  head["wall_s"] = Json::object();
  for (const auto& [name, elapsed] : phases_) head["wall_s"][name] = elapsed;
  return head;
}

void Session::say(const std::string& line) {
  if (quiet || json) return;
  if (progress_) progress_->clear();
  fmt::print("{}\n", line);
}

void Session::note(const std::string& line) {
  if (progress_) progress_->clear();
  fmt::print(stderr, "lucerna: {}\n", line);
}

void Session::print_json(const Json& object) {
  if (!json) return;
  if (progress_) progress_->clear();
  fmt::print("{}\n", object.dump(2, ' ', false, Json::error_handler_t::replace));
}

void prepare_folder(const std::filesystem::path& folder, bool force) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error || !std::filesystem::is_directory(folder)) {
    throw InputError(fmt::format("{}: cannot make the folder: {}", folder.string(),
                                 error ? error.message() : "a file of that name is in the way"));
  }
  if (!force && !std::filesystem::is_empty(folder)) {
    throw InputError(
        fmt::format("{}: the folder is not empty; choose another or give --force", folder.string()));
  }
}

}  // namespace lucerna::cli
