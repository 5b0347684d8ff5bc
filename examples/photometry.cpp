// SPDX-License-Identifier: Apache-2.0
// The figures of a light distribution, and half of it as IES: photometry IN.ldt OUT.ies.
#include <lucerna/lucerna.h>

#include <cstdio>

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  try {
    lucerna::PhotometricFile file = lucerna::read_photometric_file(argv[1]);
    for (const lucerna::Diagnostic& repair : file.repairs)
      std::printf("%s\n", lucerna::to_string(repair).c_str());

    const lucerna::PhotometricMetrics figures = lucerna::photometric_metrics(file);
    std::printf("%s, %zu planes\n", file.origin.format.c_str(), file.distribution.c_deg.size());
    std::printf("flux %.1f lm, within 30 degrees %.1f lm\n", figures.beam.flux,
                figures.flux_0_30);
    std::printf("peak %.0f cd\n", figures.beam.peak.cd);
    std::printf("straight down %.0f cd\n", lucerna::intensity_at(file.distribution, 0.0, 0.0));

    lucerna::PhotometricFile dimmed = file;
    lucerna::scale(dimmed.distribution, 0.5);
    lucerna::write_photometric_file(argv[2], dimmed, lucerna::PhotometricFormat::ies_2019);
    const auto difference =
        lucerna::compare_distributions(file.distribution, dimmed.distribution);
    std::printf("flux ratio %.3f, shape moved by %.3f degrees\n", difference.flux_ratio.mean,
                difference.wasserstein_deg.mean);
  } catch (const lucerna::Error& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}
