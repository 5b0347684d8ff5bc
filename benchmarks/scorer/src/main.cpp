// SPDX-License-Identifier: Apache-2.0
// lucerna-bench-score TASK.json SUBMISSION.json [--rays N] [--seed S] [--threads T] [--rays-from
// FILE.tm25ray]
//   [--json FILE] [--boxes FILE.csv]
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "output.h"
#include "report.h"
#include "trace.h"

namespace {

using namespace bench;

constexpr const char* kUsage =
    "usage: lucerna-bench-score TASK.json SUBMISSION.json [options]\n"
    "  --rays N          fresh rays, 100000000 when not given; raised to a multiple of 16384\n"
    "  --seed S          seed of the fresh rays, 1 when not given\n"
    "  --threads T       threads, all when not given; the score has the same bits with any\n"
    "  --rays-from FILE  the rays of a TM-25 file (the frozen source) instead of fresh ones\n"
    "  --json FILE       also writes the score as JSON\n"
    "  --boxes FILE      also writes the 48 x 48 boxes as CSV\n"
    "exit: 0 the score counts, 1 it does not or a file is bad, 2 usage\n";

struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct Arguments {
  std::string task, submission, rays_from, json, boxes;
  TraceSettings settings;
};

std::uint64_t count_of(const std::string& option, const std::string& text, std::uint64_t low,
                       std::uint64_t high) {
  char* end = nullptr;
  const double x = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0' || !(x >= static_cast<double>(low) && x <= static_cast<double>(high)) ||
      x != std::floor(x))
    throw UsageError(option + ": found " + text + ", expected a whole number from " + std::to_string(low) +
                     " to " + std::to_string(high));
  return static_cast<std::uint64_t>(x);
}

Arguments parse(const std::vector<std::string>& words) {
  Arguments a;
  a.settings.threads = std::max(1U, std::thread::hardware_concurrency());
  std::vector<std::string> files;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (words[i].rfind("--", 0) != 0) {
      files.push_back(words[i]);
      continue;
    }
    if (i + 1 == words.size()) throw UsageError(words[i] + ": found no value, expected one");
    const std::string &option = words[i], &value = words[++i];
    if (option == "--rays") {
      a.settings.rays = count_of(option, value, 1, 8'000'000'000);
    } else if (option == "--seed") {
      a.settings.seed = count_of(option, value, 0, 9'000'000'000'000'000);
    } else if (option == "--threads") {
      a.settings.threads = static_cast<unsigned>(count_of(option, value, 1, 4096));
    } else if (option == "--rays-from") {
      a.rays_from = value;
    } else if (option == "--json") {
      a.json = value;
    } else if (option == "--boxes") {
      a.boxes = value;
    } else {
      throw UsageError("found the unknown option " + option);
    }
  }
  if (files.size() != 2)
    throw UsageError("found " + std::to_string(files.size()) + " files, expected a task and a submission");
  a.task = files[0];
  a.submission = files[1];
  return a;
}

int run(const Arguments& a) {
  const auto begin = std::chrono::steady_clock::now();
  const Task task(a.task);
  const Submission submission(a.submission, task);
  const Frame* place = submission.target_place ? &*submission.target_place : nullptr;
  const Target target(task.definition.at("target"), place);
  if (target.road() && !a.boxes.empty())
    throw UsageError("--boxes: found a task with a road, which has no boxes");
  std::unique_ptr<Source> frozen;
  if (!a.rays_from.empty()) {
    if (submission.light_table)
      throw InputError(a.submission, "/light_table", "a light table with --rays-from", "surfaces to trace");
    frozen = read_tm25(a.rays_from, task.source_place);
  }
  const Source& source = frozen ? *frozen : submission.source(task);
  if (frozen && frozen->count() < kRun * kReplicates)
    throw InputError(a.rays_from, "rays", std::to_string(frozen->count()) + " rays", "16384 or more");
  const SurfaceScene scene(submission.parts);
  const Tally tally = trace(task, source, scene, target, a.settings);
  const Score score = score_of(tally, target, whole_rays(a.settings.rays, source));
  RunFacts facts{a.settings.seed, frozen ? a.rays_from : "fresh", a.settings.threads, 0.0, machine_name()};
  facts.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  const auto json = score_json(task, submission, target, score, facts);
  std::fputs(score_text(json).c_str(), stdout);
  if (!a.json.empty()) write_whole(a.json, json.dump(2) + "\n");
  if (!a.boxes.empty()) write_whole(a.boxes, boxes_csv(target, score));
  return json["counts"].get<bool>() ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) try {
  return run(parse({argv + 1, argv + argc}));
} catch (const UsageError& e) {
  std::fprintf(stderr, "lucerna-bench-score: %s\n%s", e.what(), kUsage);
  return 2;
} catch (const std::exception& e) {
  std::fprintf(stderr, "lucerna-bench-score: %s\n", e.what());
  return 1;
}
