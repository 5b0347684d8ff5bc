// SPDX-License-Identifier: Apache-2.0
// One lamp told in three ways: as an analytic emitter, as a ray file and as a model.
#include <gtest/gtest.h>

#include <cmath>

#include "lucerna/core/io/file.h"
#include "lucerna/ray_file.h"
#include "lucerna/results/folders/trace_folder.h"
#include "tests/support/run_program.h"

namespace lucerna {
namespace {

using test::run_lucerna;

class TraceSourcesStatistical : public testing::Test {
 protected:
  FarFieldTable trace(const std::string& source, const std::string& out, const std::string& more) {
    write_file(
        dir / "p.toml",
        "[[source]]\n" + source +
            "flux_lm = 1000\n[[reflector]]\nfamily = 'revolution'\npreset = 'parabola'\nfocal_mm = 15\n"
            "diameter_mm = 80\nposition_mm = [0, 0, 15]\naxis = '-z'\nreflectance = 0.8\n[[detector]]\n"
            "kind = 'far-field'\nc_step_deg = 30\ngamma_step_deg = 6\n");
    const auto run = run_lucerna(dir.path(), "trace p.toml --sequence random -o " + out + more);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return read_trace_folder(dir / out).far_fields.at(0);
  }
  /// Mean of ((a - b) / error)^2 over the cells that many rays reach. Errors from 16 replicates make it 1.15
  /// for two traces of one lamp, with a standard deviation below 0.17 over 100 cells and more: above 2 with
  /// less than 1e-6.
  static double chi2(const FarFieldTable& a, const FarFieldTable& b) {
    double sum = 0.0;
    int cells = 0;
    for (std::size_t i = 0; i < a.standard_error.size(); ++i) {
      const double e = std::hypot(a.standard_error[i], b.standard_error[i]);
      const double mean = 0.5 * (a.distribution.cd[i] + b.distribution.cd[i]);
      if (!(e > 0.0) || e > 0.2 * mean) continue;
      sum += std::pow((a.distribution.cd[i] - b.distribution.cd[i]) / e, 2);
      ++cells;
    }
    EXPECT_GT(cells, 100);
    return sum / cells;
  }
  test::TempDir dir;
};

TEST_F(TraceSourcesStatistical, EmitterRayFileAndModelMakeOneFarField) {
  const std::string lamp = "cylinder --radius-mm 1 --length-mm 6 --surface sphere --surface-mm 8 ";
  ASSERT_EQ(run_lucerna(dir.path(), "make-source " + lamp + "-n 100000 -o lamp.tm25ray").exit_code, 0);
  ASSERT_EQ(run_lucerna(dir.path(), "make-source " + lamp + "-n 400000 --seed 7 -o more.tm25ray").exit_code,
            0);
  const auto made =
      run_lucerna(dir.path(), "compress more.tm25ray -o lamp.nfl --method adaptive --held-out 0");
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const std::string analytic =
      "kind = 'cylinder'\nradius_mm = 1\nlength_mm = 6\nsurface = 'sphere'\nsurface_mm = 8\n";
  const FarFieldTable emitter = trace(analytic, "a", " --rays 100000");
  const FarFieldTable file = trace("file = 'lamp.tm25ray'\n", "b", "");
  const FarFieldTable model = trace("file = 'lamp.nfl'\n", "c", " --rays 100000");
  EXPECT_LT(chi2(emitter, file), 2.0);
  EXPECT_LT(chi2(emitter, model), 2.0);
  EXPECT_LT(chi2(file, model), 2.0);
  const FarFieldTable moved = trace(analytic + "position_mm = [3, 0, 0]\n", "d", " --rays 100000 --seed 2");
  EXPECT_GT(chi2(moved, file), 3.0) << "a lamp that is 3 mm off is seen";
}

// Reflectance over the angle of incidence and slope errors, from the project: on a trough of a flat profile
// both are known in closed form.
TEST_F(TraceSourcesStatistical, ReflectanceTablesAndSlopeErrorsCountAsWritten) {
  RaySet beam;
  beam.header.set_flux(100.0);
  beam.rays.resize(40'000, 0);
  const double incidence = radians(40.0);
  for (std::size_t i = 0; i < beam.rays.size(); ++i) {
    beam.rays.set(i, {{1.3 - 20.0 * std::tan(incidence), 0.7, 20},
                      Direction::from({std::sin(incidence), 0.0, -std::cos(incidence)})});
    beam.rays.weight[i] = 1.0F;
  }
  write_ray_set(dir / "beam.tm25ray", beam, "tm25");
  const auto mirror = [&](const std::string& keys) {
    write_file(dir / "p.toml",
               "[[source]]\nfile = 'beam.tm25ray'\n[[reflector]]\nfamily = 'revolution'\n"
               "profile_mm = [[0, 0], [50, 0], [100, 0]]\n" +
                   keys + "[[detector]]\nkind = 'far-field'\n[[detector]]\nkind = 'rays'\n");
    const auto run = run_lucerna(dir.path(), "trace p.toml --force -o out");
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return read_ray_set(dir / "out" / "rays.tm25ray");
  };
  const RaySet table = mirror("reflectance = [[0, 0.9], [30, 0.8], [50, 0.4]]\n");
  EXPECT_NEAR(*table.header.flux_lm, 60.0, 1e-3) << "half way between 30 and 50 degrees";
  const double s = 0.010;
  const RaySet spread = mirror("slope_error_mrad = 10\n");
  double in_plane = 0.0, across = 0.0;
  for (std::size_t i = 0; i < spread.rays.size(); ++i) {
    const Direction d = spread.rays.direction(i);
    in_plane += std::pow(std::atan2(d.x(), d.z()) - incidence, 2);
    across += d.y() * d.y();
  }
  const double n = static_cast<double>(spread.rays.size());
  // 2 s in the plane of incidence, 2 s cos(i) across it; a variance of 40 k rays is known to 0.7 %.
  EXPECT_NEAR(in_plane / n, 4.0 * s * s, 0.04 * 4.0 * s * s);
  EXPECT_NEAR(across / n, std::pow(2.0 * s * std::cos(incidence), 2), 0.04 * 4.0 * s * s);
}

}  // namespace
}  // namespace lucerna
