// SPDX-License-Identifier: Apache-2.0
#include "lucerna/cli/output/compress_output.h"

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "lucerna/cli/output/compare_parts.h"
#include "lucerna/cli/parse/arguments.h"
#include "lucerna/core/io/error.h"
#include "lucerna/held_out.h"
#include "lucerna/report/html/write_model_report.h"
#include "lucerna/results/json/views_json.h"

namespace lucerna::cli {

namespace {

void note_files(const CompressArguments& a, const CompressedFiles& made, Session& session) {
  for (const std::string& input : a.inputs) session.add_input(input);
  for (const std::string& note : made.notes) session.note(note);
  for (const std::string& warning : made.warnings) {
    if (session.strict) throw InputError(warning);
    session.note(warning);
  }
}

/// Says and notes how far the model is to be trusted, if there are rays enough to say so.
void judge(const CompressArguments& a, Json& json, Session& session) {
  const std::uint64_t max_rays = parse_count(a.held_out);
  if (max_rays == 0) return;
  const auto found = session.timed("held-out", [&] {
    return compare_held_out(a.files(), max_rays, compress_options(a), session.progress());
  });
  if (!found) return;
  json["held_out"] = held_out_json(*found);
  print_held_out(*found, session);
}

}  // namespace

void write_compress_output(const CompressArguments& a, const CompressedFiles& made, Session& session) {
  note_files(a, made, session);
  const SourceModel& model = *made.model;
  const std::uint64_t bytes = session.timed("write", [&] { return save_source_model(a.output, model); });
  Json json = session.json_head(parse_count(a.seed));
  json["method"] = std::string(model.method());
  json["rays"] = made.rays;
  json["bytes"] = bytes;
  json["layers"] = model.layers();
  json["leaves"] = model.leaves();
  json[model.flux_unit() == FluxUnit::lumen ? "flux_lm" : "flux_w"] = model.flux();
  const double ratio = 28.0 * static_cast<double>(made.rays) / static_cast<double>(bytes);
  session.print_line(fmt::format(
      "{}: {} rays to {} bytes ({}), method {}, {} layer(s), {} leaves, {:g} {}; {:.3g} s", a.output,
      made.rays, bytes,
      ratio >= 1.0 ? fmt::format("{:.3g} times smaller", ratio) : "larger than the rays themselves",
      model.method(), model.layers(), model.leaves(), model.flux(), symbol(model.flux_unit()),
      session.seconds("compress")));
  judge(a, json, session);
  session.print_json(json);
  if (a.report.empty()) return;
  write_model_report(model, a.output, a.files(), std::move(json), a.report, session.progress());
  session.print_line(fmt::format("  report: {}, {:.2f} MB", a.report,
                                 1e-6 * static_cast<double>(std::filesystem::file_size(a.report))));
}

}  // namespace lucerna::cli
