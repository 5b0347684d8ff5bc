// SPDX-License-Identifier: Apache-2.0
// Wrote the files of this folder with Debian's libmcpl-dev 1.3.2:
//   cc make.c -lmcpl -lm -o make && ./make
// mcpl_test.cpp has the same particles in numbers of its own.
#include <math.h>
#include <mcpl.h>

static void add(mcpl_outfile_t file, int i, int pdg_code) {
  mcpl_particle_t particle = {0}, *p = &particle;
  const double polar = 0.3 + 0.4 * i, azimuth = 1.1 * i;
  p->pdgcode = pdg_code;
  p->ekin = 2e-6 + 1e-7 * i;
  p->position[0] = 0.5 * i, p->position[1] = -0.25 * i, p->position[2] = 3.0;
  p->direction[0] = sin(polar) * cos(azimuth), p->direction[1] = sin(polar) * sin(azimuth);
  p->direction[2] = cos(polar);
  p->polarisation[0] = 0.125 * i, p->polarisation[1] = 0.5, p->polarisation[2] = -0.25;
  p->time = i == 3 ? 0.5 : 0.0;
  p->weight = 1e18 * (i + 1);
  p->userflags = 1000u + (unsigned)i;
  mcpl_add_particle(file, p);
}

int main(void) {
  // Double precision, everything there is.
  mcpl_outfile_t all = mcpl_create_outfile("all.mcpl");
  mcpl_hdr_set_srcname(all, "make.c");
  mcpl_hdr_add_comment(all, "eight particles");
  mcpl_hdr_add_data(all, "key", 5, "bytes");
  mcpl_enable_userflags(all), mcpl_enable_polarisation(all), mcpl_enable_doubleprec(all);
  for (int i = 0; i < 8; ++i) add(all, i, 22);
  mcpl_close_outfile(all);

  // Single precision, one weight, electrons among the photons.
  mcpl_outfile_t mixed = mcpl_create_outfile("mixed.mcpl");
  mcpl_enable_universal_weight(mixed, 2e18);
  for (int i = 0; i < 8; ++i) add(mixed, i, i == 2 || i == 5 ? 11 : (i == 7 ? -22 : 22));
  mcpl_close_outfile(mixed);

  // The smallest records, packed.
  mcpl_outfile_t small = mcpl_create_outfile("small.mcpl");
  mcpl_enable_universal_pdgcode(small, 22), mcpl_enable_universal_weight(small, 2e18);
  for (int i = 0; i < 8; ++i) add(small, i, 22);
  return mcpl_closeandgzip_outfile(small) ? 0 : 1;
}
