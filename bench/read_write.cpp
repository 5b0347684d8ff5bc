// SPDX-License-Identifier: Apache-2.0
// Reading, checking and writing ray files: rays per second per format, and the most memory that it took.
// Usage: bench_read_write [RAYS = 1e7] [FOLDER = temporary folder]
#include <fmt/format.h>
#include <sys/resource.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <numbers>

#include "lucerna/core/parallel/parallel.h"
#include "lucerna/random.h"
#include "lucerna/ray_file.h"

namespace {

using namespace lucerna;
namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

void fill(RayBlock& block, std::uint64_t first) {
  parallel_blocks(block.size(), 8192, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Rng rng(1, first + i);
      const double kz = rng.uniform(), phi = 2.0 * std::numbers::pi * rng.uniform(),
                   across = std::sqrt(1.0 - kz * kz);
      block.set(i, {{rng.uniform(), rng.uniform(), rng.uniform()},
                    Direction::from_unit({across * std::cos(phi), across * std::sin(phi), kz})});
      block.weight[i] = 1.0F;
    }
  });
}

void write_rays(const fs::path& path, std::string_view format, std::uint64_t rays) {
  RaySetHeader header;
  header.set_flux(100.0);
  const auto writer = create_ray_file(path, format, header, rays);
  RayBlock block;
  for (std::uint64_t done = 0; done < rays; done += block.size()) {
    block.resize(std::min<std::uint64_t>(kStreamBlock, rays - done), 0);
    fill(block, done);
    writer->write(block);
  }
  writer->finish();
}

/// Seconds to read and check `in`, and, if `out` is not empty, to write it anew in the same format.
double pass(const fs::path& in, const fs::path& out) {
  const auto start = Clock::now();
  const auto reader = open_ray_file(in);
  std::unique_ptr<RayWriter> writer;
  if (!out.empty()) writer = create_ray_file(out, reader->format(), reader->header(), reader->ray_count());
  RayBlock block;
  while (reader->read(block, kStreamBlock) > 0) {
    if (writer) writer->write(block);
  }
  if (writer) writer->finish();
  return seconds_since(start);
}

/// Processor time of all threads so far: what does not depend on who else uses the machine.
double cpu_seconds() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
         1e-6 * static_cast<double>(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

double peak_mb() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) * 1024e-6;
}

}  // namespace

int main(int argc, char** argv) {
  const auto rays = static_cast<std::uint64_t>(argc > 1 ? std::atof(argv[1]) : 1e7);
  const fs::path folder =
      (argc > 2 ? fs::path(argv[2]) : fs::temp_directory_path()) / "lucerna_bench_read_write";
  fs::create_directories(folder);
  const double million = static_cast<double>(rays) * 1e-6;
  fmt::print("{:.1f} M rays, {} threads, best of 3, input cached, output file new\n", million,
             ThreadLimit::current());
  fmt::print(
      "| format | file | read + check, M rays/s | read + check + write, M rays/s | the same per processor "
      "second |\n|---|---|---|---|---|\n");
  for (const std::string_view format :
       {"tm25", "zemax-binary", "lighttools-binary", "lighttools-ascii", "zemax-text"}) {
    const fs::path in = folder / "in", out = folder / "out";
    write_rays(in, format, rays);
    double read = 1e30, copy = 1e30, cpu = 1e30;
    for (int repeat = 0; repeat < 3; ++repeat) {
      read = std::min(read, pass(in, {}));
      fs::remove(out);
      const double before = cpu_seconds();
      copy = std::min(copy, pass(in, out));
      cpu = std::min(cpu, cpu_seconds() - before);
    }
    fmt::print("| {} | {:.0f} MB | {:.3g} | {:.3g} | {:.3g} |\n", format,
               static_cast<double>(fs::file_size(in)) * 1e-6, million / read, million / copy, million / cpu);
  }
  fmt::print("peak memory {:.0f} MB\n", peak_mb());
  fs::remove_all(folder);
}
