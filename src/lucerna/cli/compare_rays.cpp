// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "lucerna/cli/arguments.h"
#include "lucerna/cli/compare_parts.h"
#include "lucerna/cli/describe.h"
#include "lucerna/core/png.h"
#include "lucerna/ray_file.h"
#include "lucerna/rayset/field_comparison.h"
#include "lucerna/rayset/view_picture.h"
#include "lucerna/source/draw_rays.h"
#include "lucerna/source/model_etendue.h"
#include "lucerna/source_model.h"

namespace lucerna::cli {

namespace {

constexpr std::array<double, 3> kShares{0.5, 0.9, 0.99};
constexpr std::array<const char*, 3> kShareNames{"p50", "p90", "p99"};
constexpr std::size_t kZoom = 6;

/// One of the two: a ray set, or a model and rays drawn from it.
struct Side {
  RayBlock rays;
  std::unique_ptr<SourceModel> model;
};

Side read_side(const std::string& path, const CompareArguments& a, std::uint64_t stream, Session& session) {
  session.add_input(path);
  Side side;
  if (!is_source_model(path)) {
    std::vector<std::string> warnings;
    RaySet set = read_ray_set(path, {}, session.progress(), &warnings);
    for (const std::string& warning : warnings) session.note(warning);
    side.rays = std::move(set.rays);
    return side;
  }
  side.model = load_source_model(path);
  const Sequence sequence(SequenceKind::random, parse_count(a.seed) + stream);
  side.rays = draw_rays(*side.model, sequence, static_cast<std::size_t>(parse_count(a.rays)));
  return side;
}

/// étendue at kShares: of a model from its density, of rays by way of a model of them.
std::array<double, 3> etendue_of(const Side& side) {
  const EtendueCurve curve = side.model ? etendue_curve(*side.model) : searched_etendue_curve(side.rays);
  std::array<double, 3> values{};
  for (std::size_t i = 0; i < kShares.size(); ++i) values[i] = curve.at(kShares[i]);
  return values;
}

Json etendue_json(const std::array<double, 3>& values) {
  Json json;
  for (std::size_t i = 0; i < values.size(); ++i) json[kShareNames[i]] = to_json(values[i]);
  return json;
}

struct Picture {
  std::string name;
  double half_mm = 0.0;
  double white = 0.0, difference = 0.0;  // luminance over flux, 1/(mm^2 sr)
};

struct Results {
  RaySetComparison views;
  std::vector<PlaneDifference> plane;
  FieldCorrelations fields;
  std::array<double, 3> reference_etendue{}, test_etendue{};
  std::vector<Picture> pictures;
};

std::vector<Picture> write_pictures(const std::string& folder, const Views& views, const Side& reference,
                                    const Side& test) {
  std::vector<Picture> pictures;
  for (const LookFrom from : {LookFrom::front, LookFrom::side}) {
    const auto image = luminance_image(views, reference.rays, test.rays, from);
    if (!image) continue;
    Picture picture;
    picture.name = fmt::format("luminance-{}.png", to_string(from));
    picture.half_mm = 0.5 * (image->window.high[0] - image->window.low[0]);
    const ComparisonPicture p = comparison_picture(LuminanceImage::kCells, LuminanceImage::kCells,
                                                   image->reference, image->test, kZoom);
    write_png(std::filesystem::path(folder) / picture.name, p.width, p.height, p.rgb);
    picture.white = p.white;
    picture.difference = p.difference;
    pictures.push_back(std::move(picture));
  }
  return pictures;
}

Results compare_sides(const Side& reference, const Side& test, const CompareArguments& a) {
  const Views views(reference.rays);
  ViewCounts p(views), q(views);
  p.add(reference.rays);
  q.add(test.rays);
  Results r;
  r.views = compare_view_counts(p, q);
  r.plane = focus_plane_differences(views, reference.rays, test.rays, parse_numbers(a.cells_um));
  r.fields = field_correlations(p, q, reference.rays, test.rays);
  r.reference_etendue = etendue_of(reference);
  r.test_etendue = etendue_of(test);
  if (!a.output.empty()) r.pictures = write_pictures(a.output, views, reference, test);
  return r;
}

Json correlation_json(const std::optional<CrossCorrelation>& c) {
  if (!c) return nullptr;
  return {{"value", to_json(c->value)}, {"noise_limit", to_json(c->noise_limit)}};
}

Json results_json(const Results& r) {
  Json json;
  for (const ViewKind kind : kViewKinds) {
    const ViewDifference& d = r.views[kind];
    json["views"][std::string(to_string(kind))] = {{"error", to_json(d.error)},
                                                   {"floor", to_json(d.floor)},
                                                   {"excess", to_json(d.excess)},
                                                   {"standard_error", to_json(d.standard_error)},
                                                   {"raw", to_json(d.raw)}};
  }
  json["focus_plane"] = Json::array();
  for (const PlaneDifference& d : r.plane) {
    json["focus_plane"].push_back(
        {{"cell_um", to_json(d.cell_um)}, {"l1", to_json(d.l1)}, {"floor", to_json(d.floor)}});
  }
  json["cross_correlation"] = {{"near", correlation_json(r.fields.near)},
                               {"mid", correlation_json(r.fields.mid)},
                               {"far", correlation_json(r.fields.far)}};
  json["etendue_mm2sr"] = {{"reference", etendue_json(r.reference_etendue)},
                           {"test", etendue_json(r.test_etendue)}};
  if (!r.pictures.empty()) json["pictures"] = Json::array();
  for (const Picture& p : r.pictures) {
    json["pictures"].push_back({{"file", p.name},
                                {"half_width_mm", to_json(p.half_mm)},
                                {"white_per_mm2sr", to_json(p.white)},
                                {"full_colour_per_mm2sr", to_json(p.difference)}});
  }
  return json;
}

void say_fields(const Results& r, Session& session) {
  session.say("  illuminance on the focus plane: sum of |differences| of the cells' shares (noise alone)");
  for (const PlaneDifference& d : r.plane) {
    session.say(fmt::format("  {:>6g} um {:>9.4f} ({:.4f})", d.cell_um, d.l1, d.floor));
  }
  session.say("  normalised cross-correlation (what noise leaves of 1)");
  const auto line = [&](const char* name, const std::optional<CrossCorrelation>& c) {
    if (c) session.say(fmt::format("  {:<8}{:>10.5f} ({:.5f})", name, c->value, c->noise_limit));
  };
  line("near", r.fields.near);
  line("mid", r.fields.mid);
  line("far", r.fields.far);
  session.say("  etendue of the brightest 50 / 90 / 99 % of the flux, mm2 sr");
  for (const auto& [name, e] : {std::pair{"A", r.reference_etendue}, std::pair{"B", r.test_etendue}}) {
    session.say(fmt::format("  {:<8}{:>10.4g}{:>10.4g}{:>10.4g}", name, e[0], e[1], e[2]));
  }
  for (const Picture& p : r.pictures) {
    session.say(
        fmt::format("  {}: A, B, B - A; {:.4g} mm wide, white = {:.4g} of the flux a mm2 sr, full red or "
                    "blue = {:.4g} more or less",
                    p.name, 2.0 * p.half_mm, p.white, p.difference));
  }
}

}  // namespace

void compare_rays(const CompareArguments& a, Session& session) {
  const Side reference = session.timed("read", [&] { return read_side(a.reference, a, 0, session); });
  const Side test = session.timed("read", [&] { return read_side(a.test, a, 1, session); });
  const Results r = session.timed("compare", [&] { return compare_sides(reference, test, a); });
  Json json = session.json_head(parse_count(a.seed));
  json["rays"] = {reference.rays.size(), test.rays.size()};
  json.update(results_json(r));
  write_comparison(a, json, session);
  session.say(fmt::format("{} ({} rays) against {} ({} rays); shares of the l2 norm, in per cent", a.test,
                          test.rays.size(), a.reference, reference.rays.size()));
  session.say(
      fmt::format("  {:<8}{:>10}{:>10}{:>10}{:>10}{:>10}", "view", "error", "floor", "excess", "+-", "raw"));
  for (const ViewKind kind : kViewKinds) {
    const ViewDifference& d = r.views[kind];
    session.say(fmt::format("  {:<8}{:>10.3f}{:>10.3f}{:>10.3f}{:>10.3f}{:>10.3f}", to_string(kind),
                            100.0 * d.error, 100.0 * d.floor, 100.0 * d.excess, 100.0 * d.standard_error,
                            100.0 * d.raw));
  }
  say_fields(r, session);
}

}  // namespace lucerna::cli
