// SPDX-License-Identifier: Apache-2.0
// From a ray file to a light distribution: beam IN.tm25ray OUT.ldt.
#include <lucerna/lucerna.h>

#include <cstdio>

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  try {
    lucerna::CompressedFiles source = lucerna::compress({argv[1]});

    lucerna::Scene scene;
    scene.sources.push_back(
        {.rays = std::move(source.model), .world_from_source = {}, .flux = {}});
    const auto outline = lucerna::Aperture::circle(40.0);
    scene.reflectors.push_back({.reflector = lucerna::conic_reflector(
                                    lucerna::ConicPreset::parabola, 15.0, 0.0, outline),
                                .world_from_reflector = lucerna::Frame::from_axis(
                                    -lucerna::Direction(), 0.0, {0, 0, 15}),
                                .reflectance = lucerna::Reflectance(0.92)});
    scene.far_fields.push_back({.name = "beam", .c_step_deg = 5.0, .gamma_step_deg = 1.0});

    const lucerna::NoiseTrace traced = lucerna::trace_until(scene, {}, {.noise = 0.01});
    const lucerna::TraceMetrics figures = lucerna::trace_metrics(traced.result, scene);
    const lucerna::FarFieldResult& beam = figures.far_fields.front();
    std::printf("flux %s\n", lucerna::estimate_text(beam.metrics.flux, "lm").c_str());
    std::printf("axis %s\n", lucerna::estimate_text(beam.metrics.axis_cd, "cd").c_str());
    std::printf("beam %s\n", lucerna::angle_text(beam.metrics.planes[0].beam_of_maximum).c_str());

    lucerna::write_photometric_file(
        argv[2], {.distribution = beam.intensity.distribution, .luminaire = {}},
        lucerna::PhotometricFormat::ldt);
  } catch (const lucerna::Error& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}
