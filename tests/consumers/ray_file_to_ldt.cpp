// SPDX-License-Identifier: Apache-2.0
// What a user of the library writes: a ray file becomes a model, a paraboloid turns its light, and the far
// field becomes an LDT file.
#include <lucerna/lucerna.h>

#include <cstdio>

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  try {
    lucerna::CompressedFiles compressed = lucerna::compress({argv[1]});

    lucerna::Scene scene;
    scene.sources.push_back({.rays = std::move(compressed.model), .world_from_source = {}, .flux = {}});
    const auto focus = lucerna::Vec3{0.0, 0.0, -15.0};
    scene.reflectors.push_back(
        {.reflector = lucerna::conic_reflector(lucerna::ConicPreset::parabola, 15.0, 0.0,
                                               lucerna::Aperture::circle(100.0, 10.0)),
         .world_from_reflector = lucerna::Frame::from_axis(lucerna::Direction(), 0.0, focus)});
    scene.far_fields.push_back({.name = "beam", .c_step_deg = 15.0, .gamma_step_deg = 1.0});

    const lucerna::NoiseTrace traced = lucerna::trace_until(scene, {}, {.noise = 0.02});
    const lucerna::TraceMetrics figures = lucerna::trace_metrics(traced.result, scene);
    const lucerna::FarFieldResult& beam = figures.far_fields.front();
    lucerna::write_photometric_file(argv[2], {.distribution = beam.intensity.distribution, .luminaire = {}},
                                    lucerna::PhotometricFormat::ldt);
    std::printf("flux %s\n", lucerna::estimate_text(beam.metrics.flux, "lm").c_str());
    if (beam.metrics.peak)
      std::printf("peak %s\n", lucerna::estimate_text(beam.metrics.peak->cd, "cd").c_str());
  } catch (const lucerna::Error& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}
