// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "lucerna/cli/output/describe.h"
#include "lucerna/photometric_metrics.h"
#include "lucerna/photometry/metrics/street.h"
#include "lucerna/results/json/trace_json.h"

namespace lucerna::cli {

namespace {

std::string angle(const std::optional<double>& deg) { return deg ? fmt::format("{:.1f}", *deg) : "-"; }

/// BUG rating and G* class, for luminous intensities only.
void add_street_metrics(Description& d, const PhotometricFile& file, const PhotometricReadOptions& options) {
  if (file.distribution.unit != FluxUnit::lumen) return;
  const double side = street_side_c_deg(file.origin, options.ies_turn);
  const BugRating bug = bug_rating(file.distribution, {.street_side_c_deg = side});
  const GlareClass glare = glare_class(file.distribution);
  d.json["street"] = {{"street_side_c_deg", side},
                      {"backlight", bug.backlight},
                      {"uplight", bug.uplight},
                      {"glare", bug.glare},
                      {"glare_class", glare.number}};
  d.lines.push_back(fmt::format("  as a street light   {} (TM-15, street side C{:g}), {} (EN 13201-2)",
                                bug.text(), side, glare.text()));
}

}  // namespace

Description describe_photometry(const std::string& path, const PhotometricReadOptions& options) {
  const PhotometricFile file = read_photometric_file(path, options);
  const PhotometricMetrics figures = photometric_metrics(file);
  const BeamMetrics& beam = figures.beam;
  const PhotometricOrigin& origin = file.origin;
  const bool lumen = file.distribution.unit == FluxUnit::lumen;
  Description d;
  for (const Diagnostic& repair : file.repairs) d.warnings.push_back(to_string(repair));
  std::vector<std::string> notes;
  for (const Diagnostic& note : file.notes) notes.push_back(to_string(note));
  const auto lamps = lamp_flux_lm(file.luminaire);
  d.json = {
      {"path", path},
      {"format", origin.format},
      {"type", std::string(1, origin.type)},
      {"symmetry", origin.symmetry},
      {"luminaire", file.luminaire.name},
      {"manufacturer", file.luminaire.manufacturer},
      {"planes", origin.planes},
      {"gammas", origin.gammas},
      {lumen ? "flux_lm" : "flux_w", beam.flux},
      {"lamp_flux_lm", to_json(lamps)},
      {"light_output_ratio", lamps ? to_json(beam.flux / *lamps) : Json()},
      {"peak", {{"intensity", beam.peak.cd}, {"c_deg", beam.peak.c_deg}, {"gamma_deg", beam.peak.gamma_deg}}},
      {"beam", beam_json(beam)["planes"]},
      {"multiplier", origin.multiplier},
      {"ballast_factor", origin.ballast_factor},
      {"ies_turn_deg", options.ies_turn == IesTurn::none ? 0 : 90},
      {"notes", notes},
      {"warnings", d.warnings}};
  const char* unit = lumen ? "cd" : "W/sr";
  d.lines.push_back(fmt::format("  format              {}, type {}, {}, {} planes x {} angles", origin.format,
                                origin.type, origin.symmetry, origin.planes, origin.gammas));
  d.lines.push_back(
      fmt::format("  luminaire           {} {}", file.luminaire.manufacturer, file.luminaire.name));
  d.lines.push_back(fmt::format(
      "  flux                {:.7g} {}{}", beam.flux, lumen ? "lm" : "W",
      lamps ? fmt::format(" of {:g} lm of lamps (LOR {:.1f} %)", *lamps, 100.0 * beam.flux / *lamps)
            : ", absolute photometry"));
  d.lines.push_back(fmt::format("  peak                {:.6g} {} at C {:g}, gamma {:g}", beam.peak.cd, unit,
                                beam.peak.c_deg, beam.peak.gamma_deg));
  for (const auto& plane : beam.planes) {
    if (plane.c_deg != 0.0 && plane.c_deg != 90.0) continue;
    d.lines.push_back(fmt::format("  {:<20}beam angle {} deg, field angle {} deg (of its grid's maximum)",
                                  fmt::format("C{:g}-C{:g}", plane.c_deg, plane.c_deg + 180.0),
                                  angle(plane.beam_of_maximum), angle(plane.field_of_maximum)));
  }
  const auto& code = figures.cie_flux_code;
  d.lines.push_back(fmt::format(
      "  flux by zone        0-30 {:.5g}, 30-60 {:.5g}, 60-90 {:.5g}, 90-180 {:.5g}", figures.flux_0_30,
      figures.flux_0_60 - figures.flux_0_30, figures.flux_60_90, figures.flux_90_180));
  d.lines.push_back(
      fmt::format("  CIE flux code       {:.0f} {:.0f} {:.0f} {:.0f} {:.0f}; cut-off {:.1f} deg (2.5 % of "
                  "the peak); NEMA {}H x {}V",
                  code[0], code[1], code[2], code[3], code[4], figures.cut_off_deg, figures.nema_horizontal,
                  figures.nema_vertical));
  add_street_metrics(d, file, options);
  for (const std::string& note : notes) d.lines.push_back("  note: " + note);
  return d;
}

}  // namespace lucerna::cli
