// SPDX-License-Identifier: Apache-2.0
// The C++ side of bench/python_overhead.py, which starts it: reads commands, a line each, and answers with
// the seconds of the call alone and figures that Python must have to the bit.
//   sample MODEL RAYS SEED   -> seconds, x of the middle ray, kz of the last
//   open PROJECT RAYS SEED   -> number of parameters
//   evaluate STEP            -> seconds, sum of the squared residuals, of the Jacobian's entries;
//                               at the start moved by STEP mm
#include <chrono>
#include <cstdio>
#include <iostream>
#include <memory>
#include <numeric>
#include <optional>
#include <sstream>
#include <string>
#include <utility>

#include "lucerna/objective.h"
#include "lucerna/project.h"
#include "lucerna/source_model.h"

using namespace lucerna;

namespace {

double seconds_of(const auto& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void sample_model(std::istream& in) {
  std::string path;
  std::size_t rays = 0;
  std::uint64_t seed = 0;
  in >> path >> rays >> seed;
  const auto model = load_source_model(path);
  RayBlock block;
  const double seconds =
      seconds_of([&] { block = sample(*model, rays, Sequence(SequenceKind::random, seed)); });
  std::printf("%.9f %a %a\n", seconds, static_cast<double>(block.x_mm[rays / 2]),
              static_cast<double>(block.kz[rays - 1]));
}

std::optional<Objective> open_objective(std::istream& in) {
  std::string path;
  ObjectiveOptions options;
  in >> path >> options.rays >> options.seed;
  Objective objective(read_project(path), path, options);
  std::printf("%zu\n", objective.parameter_count());
  return objective;
}

void evaluate(const Objective& objective, std::istream& in) {
  double step = 0.0;
  in >> step;
  std::vector<double> x = objective.start();
  for (double& p : x) p += step;
  ObjectiveValue value;
  const double seconds = seconds_of([&] { value = objective.at(x); });
  // One after another, as Python's loop adds.
  double squares = 0.0;
  for (const double r : value.residuals) squares += r * r;
  std::printf("%.9f %a %a\n", seconds, squares,
              std::accumulate(value.jacobian.begin(), value.jacobian.end(), 0.0));
}

}  // namespace

int main() {
  std::optional<Objective> objective;
  for (std::string line; std::getline(std::cin, line);) {
    std::istringstream in(line);
    std::string command;
    in >> command;
    if (command == "sample") sample_model(in);
    if (command == "open") objective = open_objective(in);
    if (command == "evaluate") evaluate(objective.value(), in);
    std::fflush(stdout);
  }
}
