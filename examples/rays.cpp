// SPDX-License-Identifier: Apache-2.0
// What is in a ray file, and the same rays as text: rays IN.tm25ray OUT.txt.
#include <lucerna/lucerna.h>

#include <cstdio>

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  try {
    std::vector<std::string> warnings;
    const lucerna::RaySet set =
        lucerna::read_ray_set(argv[1], {}, lucerna::no_progress(), &warnings);
    const lucerna::RaySummary summary = lucerna::summarize(set.rays);

    std::printf("%zu rays of %g lm\n", set.rays.size(),
                lucerna::require_flux(set.header, argv[1]));
    if (summary.virtual_focus && summary.virtual_focus->determined) {
      const lucerna::Vec3 focus = summary.virtual_focus->point_mm;
      std::printf("virtual focus (%.3f, %.3f, %.3f) mm\n", focus.x, focus.y, focus.z);
    }
    for (const std::string& warning : warnings) std::printf("warning: %s\n", warning.c_str());

    for (const std::string& left_out : lucerna::write_ray_set(argv[2], set, "text"))
      std::printf("not in %s: %s\n", argv[2], left_out.c_str());
  } catch (const lucerna::Error& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}
