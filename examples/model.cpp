// SPDX-License-Identifier: Apache-2.0
// A model of rays in memory, and how far it is from other rays of the source: model OUT.nfl.
#include <lucerna/lucerna.h>

#include <cstdio>

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  try {
    lucerna::EmitterOptions led;
    led.kind = lucerna::EmitterKind::led;
    led.flux = 800.0;
    const auto source = lucerna::make_emitter(led);
    const auto rays = [&](std::uint64_t seed) {
      return lucerna::sample(*source, 100'000,
                             lucerna::Sequence(lucerna::SequenceKind::random, seed));
    };

    lucerna::RaySet training{.header = {}, .rays = rays(1)};
    training.header.set_flux(source->flux());
    const auto model = lucerna::compress(training);
    const std::uint64_t bytes = lucerna::save_source_model(argv[1], *model);
    std::printf("%.0f lm, %zu leaves, %llu bytes\n", model->flux(), model->leaves(),
                static_cast<unsigned long long>(bytes));

    const lucerna::Sequence fresh(lucerna::SequenceKind::random, 3);
    const auto difference =
        lucerna::compare_ray_sets(rays(2), lucerna::sample(*model, 400'000, fresh));
    for (const lucerna::ViewKind view : lucerna::kViewKinds)
      std::printf("%-7s excess %.3f +- %.3f\n", lucerna::to_string(view).data(),
                  difference[view].excess, difference[view].standard_error);
  } catch (const lucerna::Error& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}
