// SPDX-License-Identifier: Apache-2.0
// A mirror for the target of a project: mirror IN.toml SECONDS OUT.step OUT.toml.
#include <lucerna/lucerna.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>

int main(int argc, char** argv) {
  if (argc != 5) return 2;
  try {
    const lucerna::DesignedMirror mirror =
        lucerna::design(argv[1], {.time_s = std::atof(argv[2]), .max_rays = 1 << 18});

    const auto& error = mirror.error.c48;
    std::printf("error %.2f +- %.2f %%, at first %.2f %%\n", 100 * error.excess,
                100 * error.standard_error, 100 * mirror.start_error.c48.excess);
    std::printf("light in the target %.1f %%, that leaves %.1f %%\n",
                100 * mirror.error.in_rectangle.mean, 100 * mirror.efficiency.mean);
    for (const lucerna::LimitCheck& limit : mirror.limits)
      std::printf("%s %s, allowed %.4g: %s\n", limit.limit.c_str(),
                  lucerna::estimate_text(limit.found).c_str(), limit.allowed,
                  limit.held ? "held" : "not held");

    std::ofstream(argv[3]) << lucerna::step_text(mirror.reflector);
    std::ofstream(argv[4]) << mirror.project_text;
  } catch (const lucerna::Error& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}
