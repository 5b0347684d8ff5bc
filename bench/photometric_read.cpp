// SPDX-License-Identifier: Apache-2.0
// Reading and writing of photometric files in memory: milliseconds (least and median) and MB/s for a grid
// without symmetry, in every format that we write. Usage: bench_photometric_read [PLANES = 361] [GAMMAS =
// 263] [REPEATS = 41]
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <vector>

#include "lucerna/photometric_file.h"
#include "lucerna/random.h"

namespace {

using namespace lucerna;
using Clock = std::chrono::steady_clock;

/// `listed` planes as an IES file lists them: the last, at 360, is the first again.
PhotometricFile random_file(std::size_t listed, std::size_t gammas) {
  std::vector<double> c, g;
  const std::size_t planes = listed - 1;
  for (std::size_t i = 0; i < planes; ++i)
    c.push_back(360.0 * static_cast<double>(i) / static_cast<double>(planes));
  for (std::size_t i = 0; i < gammas; ++i)
    g.push_back(180.0 * static_cast<double>(i) / static_cast<double>(gammas - 1));
  PhotometricFile file;
  file.distribution = zero_distribution(std::move(c), std::move(g));
  Rng rng(1, 0);
  IntensityDistribution& d = file.distribution;
  for (std::size_t p = 0; p < planes; ++p) {
    for (std::size_t i = 0; i < gammas; ++i)
      d.at(p, i) = i == 0 || i + 1 == gammas ? 500.0 : 1000.0 * rng.uniform();
  }
  return file;
}

template <class Work>
std::vector<double> milliseconds(int repeats, const Work& work) {
  std::vector<double> ms;
  for (int i = 0; i < repeats; ++i) {
    const auto start = Clock::now();
    work();
    ms.push_back(std::chrono::duration<double, std::milli>(Clock::now() - start).count());
  }
  std::sort(ms.begin(), ms.end());
  return ms;
}

}  // namespace

int main(int argc, char** argv) {
  const auto planes = static_cast<std::size_t>(argc > 1 ? std::max(4, std::atoi(argv[1])) : 361);
  const auto gammas = static_cast<std::size_t>(argc > 2 ? std::max(3, std::atoi(argv[2])) : 263);
  const int repeats = argc > 3 ? std::max(1, std::atoi(argv[3])) : 41;
  const PhotometricFile file = random_file(planes, gammas);
  fmt::print("{} x {} values, {} repeats\n", planes, gammas, repeats);
  fmt::print(
      "| format | size | read, median | read, min | values | write, median |\n|---|---|---|---|---|---|\n");
  for (const auto& named :
       {std::pair{"ies-2002", PhotometricFormat::ies_2002},
        std::pair{"ies-2019", PhotometricFormat::ies_2019}, std::pair{"ldt", PhotometricFormat::ldt}}) {
    const auto name = named.first;  // clang 14 captures no structured bindings
    const auto format = named.second;
    const bool ldt = format == PhotometricFormat::ldt;
    std::string text;
    const auto write = milliseconds(repeats, [&] { text = ldt ? ldt_text(file) : ies_text(file, format); });
    std::size_t values = 0;
    const auto read = milliseconds(repeats, [&] {
      values = (ldt ? read_ldt(text, name) : read_ies(text, name)).distribution.cd.size();
    });
    const double mb = 1e-6 * static_cast<double>(text.size()), median = read[read.size() / 2];
    fmt::print("| {} | {:.2f} MB | {:.1f} ms | {:.1f} ms | {} | {:.1f} ms |\n", name, mb, median,
               read.front(), values, write[write.size() / 2]);
  }
  return 0;
}
