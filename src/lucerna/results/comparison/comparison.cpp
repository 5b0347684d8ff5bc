// SPDX-License-Identifier: Apache-2.0
#include "lucerna/comparison.h"

#include <array>
#include <memory>
#include <utility>

#include "lucerna/core/image/png.h"
#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"
#include "lucerna/design/validation/box_error.h"
#include "lucerna/ray_file.h"
#include "lucerna/rayset/comparison/field_comparison.h"
#include "lucerna/rayset/comparison/view_picture.h"
#include "lucerna/rayset/files/named_warnings.h"
#include "lucerna/results/folders/trace_folder.h"
#include "lucerna/results/svg/svg_polar.h"
#include "lucerna/source/emitters/draw_rays.h"
#include "lucerna/source/model/model_etendue.h"
#include "lucerna/source_model.h"

namespace lucerna {

namespace {

namespace fs = std::filesystem;

/// Pixels of a picture's cell, across.
constexpr std::size_t kZoom = 6;

/// One of the two: a ray set, or a model and rays drawn from it.
struct Side {
  RayBlock rays;
  std::unique_ptr<SourceModel> model;
  FluxUnit unit = FluxUnit::lumen;
};

Side read_side(const fs::path& path, std::uint64_t stream, const FileComparisonOptions& options,
               std::vector<std::string>& warnings, Progress& progress) {
  Side side;
  if (!is_source_model(path)) {
    std::vector<std::string> found;
    RaySet set = read_ray_set(path, {}, progress, &found);
    side.unit = set.header.flux_unit;
    side.rays = std::move(set.rays);
    add_named_warnings(path, found, warnings);
    if (options.photometric.strict && !warnings.empty()) throw InputError(warnings.front());
    return side;
  }
  side.model = load_source_model(path);
  side.unit = side.model->flux_unit();
  const Sequence sequence(SequenceKind::random, options.seed + stream);
  side.rays = draw_rays(*side.model, sequence, static_cast<std::size_t>(options.rays));
  return side;
}

EtendueShares etendue_of(const Side& side) {
  const EtendueCurve curve = side.model ? etendue_curve(*side.model) : searched_etendue_curve(side.rays);
  return {curve.at(0.5), curve.at(0.9), curve.at(0.99)};
}

std::vector<LuminancePicture> write_pictures(const fs::path& folder, const Views& views,
                                             const RayBlock& reference, const RayBlock& test) {
  std::vector<LuminancePicture> pictures;
  for (const Viewpoint from : {Viewpoint::front, Viewpoint::side}) {
    const auto image = luminance_image(views, reference, test, from);
    if (!image) continue;
    const ComparisonPicture p = comparison_picture(LuminanceImage::kCells, LuminanceImage::kCells,
                                                   image->reference, image->test, kZoom);
    const std::string file = fmt::format("luminance-{}.png", to_string(from));
    write_png(folder / file, p.width, p.height, p.rgb);
    pictures.push_back({file, 0.5 * (image->window.high[0] - image->window.low[0]), p.white, p.difference});
  }
  return pictures;
}

RayFileComparison compare_sides(const Side& reference, const Side& test,
                                const FileComparisonOptions& options) {
  const Views views(reference.rays);
  ViewCounts p(views), q(views);
  p.add(reference.rays);
  q.add(test.rays);
  RayFileComparison r;
  r.reference_rays = reference.rays.size();
  r.test_rays = test.rays.size();
  r.views = compare_view_counts(p, q);
  r.focus_plane = focus_plane_differences(views, reference.rays, test.rays, options.cells_um);
  r.fields = field_correlations(p, q, reference.rays, test.rays);
  r.reference_etendue = etendue_of(reference);
  r.test_etendue = etendue_of(test);
  if (!options.pictures.empty()) {
    r.pictures = write_pictures(options.pictures, views, reference.rays, test.rays);
  }
  return r;
}

/// A light distribution, with the standard errors of its values where they are known.
FarFieldTable read_distribution(const fs::path& path, const FileComparisonOptions& options,
                                std::vector<std::string>& warnings) {
  if (!fs::is_directory(path)) {
    PhotometricFile file = read_photometric_file(path, options.photometric);
    for (const Diagnostic& repair : file.repairs)
      warnings.push_back(fmt::format("{}: {}", path.string(), to_string(repair)));
    return {path.string(), std::move(file.distribution), {}};
  }
  TraceFolder folder = read_trace_folder(path);
  if (folder.far_fields.empty()) {
    throw InputError(fmt::format("{}: the trace has no far field", path.string()));
  }
  return std::move(folder.far_fields.front());
}

LightFileComparison compare_light(const fs::path& reference_path, const fs::path& test_path,
                                  const FileComparisonOptions& options, std::vector<std::string>& warnings) {
  const FarFieldTable reference = read_distribution(reference_path, options, warnings);
  const FarFieldTable test = read_distribution(test_path, options, warnings);
  if (reference.distribution.unit != test.distribution.unit) {
    throw InputError(fmt::format("{}: found {}, expected {} as {} has", test_path.string(),
                                 intensity_symbol(test.distribution.unit),
                                 intensity_symbol(reference.distribution.unit), reference_path.string()));
  }
  LightFileComparison light;
  light.distributions = compare_distributions(reference.distribution, test.distribution,
                                              {.reference_error_cd = reference.standard_error,
                                               .test_error_cd = test.standard_error,
                                               .reference_flux_error = reference.flux_standard_error,
                                               .test_flux_error = test.flux_standard_error});
  light.boxes = box_error({reference.distribution, reference.standard_error},
                          {test.distribution, test.standard_error}, TargetMode::shape);
  if (!options.pictures.empty()) {
    write_file(options.pictures / "polar.svg",
               polar_svg(test.distribution, {.title = test_path.filename().string(),
                                             .reference = &reference.distribution,
                                             .reference_name = reference_path.filename().string()}));
  }
  return light;
}

bool is_distribution(const fs::path& path) { return fs::is_directory(path) || is_photometric_file(path); }

/// Why a light distribution cannot be compared with another file: what is wrong with that, where it is none
/// though it is called one, or that it is something else.
[[noreturn]] void refuse_pair(const fs::path& light, const fs::path& other,
                              const FileComparisonOptions& options) {
  const InputFile opened(other);
  const std::string ending = lower_ending(other);
  if (ending == ".ldt" || ending == ".ies")
    static_cast<void>(read_photometric_file(other, options.photometric));
  throw InputError(fmt::format("{}: found rays or a model, expected a light distribution as {} is",
                               other.string(), light.string()));
}

}  // namespace

FileComparison compare(const fs::path& reference, const fs::path& test, const FileComparisonOptions& options,
                       Progress& progress) {
  const bool light = is_distribution(reference);
  if (light != is_distribution(test)) {
    refuse_pair(light ? reference : test, light ? test : reference, options);
  }
  FileComparison found;
  if (light) {
    found.light = compare_light(reference, test, options, found.warnings);
    return found;
  }
  const Side a = read_side(reference, 0, options, found.warnings, progress);
  const Side b = read_side(test, 1, options, found.warnings, progress);
  if (a.unit != b.unit) {
    found.warnings.push_back(fmt::format("{} is in {}, {} in {}; each is compared by shares of its own flux",
                                         reference.string(), symbol(a.unit), test.string(), symbol(b.unit)));
  }
  found.rays = compare_sides(a, b, options);
  return found;
}

}  // namespace lucerna
