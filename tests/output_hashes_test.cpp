// SPDX-License-Identifier: Apache-2.0
// The bits of what the verbs make, kept: a change that should change no number changes none. A change that is
// meant to takes the new hashes from the failure's text. They are of one instruction set and of the standard
// library's mathematics; elsewhere the tests are skipped, visibly.
#include <gtest/gtest.h>

#include <cstring>
#include <map>
#include <span>

#include "lucerna/core/io/file.h"
#include "lucerna/core/io/sha256.h"
#include "lucerna/design/run/design.h"
#include "lucerna/source.h"
#include "lucerna/source_model.h"
#include "lucerna/trace_metrics.h"
#include "tests/support/temp_dir.h"

namespace lucerna {
namespace {

constexpr std::string_view kIsa = "avx512";
const std::map<std::string, std::string> kHashes{{"compress", "0cb0df858b7759d5"},
                                                 {"compress clusters", "6416d4aa69b030ed"},
                                                 {"sample", "c5c7ac0519faa163ea5bfb82d301ad09"},
                                                 {"trace", "1143e8e671932cb0"},
                                                 {"design", "c9d6c5b6cbe01b98"}};

template <class Number>
std::string hash_of(std::span<const Number> numbers) {
  return sha256_of_text({reinterpret_cast<const char*>(numbers.data()), numbers.size_bytes()}).substr(0, 16);
}

RaySet led_rays() {
  RaySet set;
  set.header.set_flux(1000.0);
  set.rays.resize(20'000);
  make_emitter({.kind = EmitterKind::led})->emit(Sequence(SequenceKind::random, 5), 0, set.rays);
  return set;
}

Scene lamp() {
  Scene scene;
  scene.sources.push_back({make_emitter({.kind = EmitterKind::led}), Frame(), {}});
  const Reflector mirror = conic_reflector(ConicPreset::parabola, 15.0, 0.0, Aperture::circle(60.0, 6.0));
  scene.reflectors.push_back(
      {mirror, Frame::from_axis(Direction::from({0, 0, -1}), 0.0, {0, 0, 15}), Reflectance(0.9)});
  scene.far_fields.emplace_back();
  return scene;
}

class OutputHashes : public testing::Test {
 protected:
  void SetUp() override {
    TraceOptions options;
    options.last_ray = 1 << 16;
    traced_ = trace(lamp(), options);
    if (traced_.isa != kIsa) GTEST_SKIP() << "hashes are of " << kIsa << ", this is " << traced_.isa;
  }
  static void expect(const std::string& what, const std::string& hash) {
    EXPECT_EQ(hash, kHashes.at(what)) << what;
  }
  TraceResult traced_;
};

TEST_F(OutputHashes, OfModelsAndTheirRays) {
  const test::TempDir dir;
  const RaySet rays = led_rays();
  for (const CompressMethod method : {CompressMethod::adaptive, CompressMethod::clusters}) {
    const auto model = compress(rays, {.method = method});
    save_source_model(dir / "m.nfl", *model);
    const bool clusters = method == CompressMethod::clusters;
    expect(clusters ? "compress clusters" : "compress", sha256_of_file(dir / "m.nfl").substr(0, 16));
    if (clusters) continue;
    RayBlock drawn;
    drawn.resize(4096);
    model->emit(Sequence(SequenceKind::sobol, 1), 0, drawn);
    expect("sample", hash_of(std::span<const float>(drawn.x_mm)) + hash_of(std::span<const float>(drawn.kx)));
  }
}

TEST_F(OutputHashes, OfATrace) {
  const auto cd = trace_metrics(traced_).far_fields.at(0).intensity.distribution.cd;
  expect("trace", hash_of(std::span<const double>(cd)));
}

constexpr const char* kDesign = R"([[source]]
kind = "led"
[[reflector]]
family = "revolution"
preset = "parabola"
focal_mm = 15
diameter_mm = 60
hole_diameter_mm = 6
position_mm = [0, 0, 15]
axis = "-z"
[target]
kind = "plane"
file = "t.csv"
position_mm = [0, 0, -1000]
normal = "+z"
size_mm = [800, 600]
[design]
intervals = 4
restarts = 0
)";

TEST_F(OutputHashes, OfADesign) {
  const test::TempDir dir;
  write_file(dir / "t.csv", "1,2,1\n2,4,2\n1,2,1\n");
  write_file(dir / "p.toml", kDesign);
  DesignOptions options;
  options.time_s = 1e6;
  options.max_rays = 1 << 13;
  options.validation_rays = 1 << 14;
  const DesignResult result = design(design_problem(read_project(dir / "p.toml"), dir / "p.toml"), options);
  const Eigen::VectorXd& heights = result.shape.parameters();
  expect("design",
         hash_of(std::span<const double>(heights.data(), static_cast<std::size_t>(heights.size()))));
}

}  // namespace
}  // namespace lucerna
