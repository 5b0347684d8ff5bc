// SPDX-License-Identifier: Apache-2.0
#include "lucerna/rayset/files/convert.h"

#include <fmt/format.h>

#include "lucerna/cli/commands/commands.h"
#include "lucerna/cli/parse/arguments.h"
#include "lucerna/cli/parse/input_kind.h"
#include "lucerna/cli/parse/photometric_arguments.h"
#include "lucerna/core/io/error.h"
#include "lucerna/ray_file.h"

namespace lucerna::cli {

namespace {

struct ConvertArguments {
  std::string input, output, from, to, rays, seed = "1", flux, move, length_unit = "mm", columns;
  std::vector<std::string> rotations;
  bool salvage = false;
  PhotometricArguments photometric;
};

RayConversion conversion_of(const ConvertArguments& a, bool strict) {
  RayConversion conversion;
  conversion.strict = strict;
  if (!a.rays.empty()) {
    conversion.rays = parse_count(a.rays);
    if (*conversion.rays == 0) throw UsageError("--rays 0: expected at least one");
  }
  conversion.seed = parse_count(a.seed);
  if (!a.flux.empty()) conversion.flux = parse_flux(a.flux, "--flux");
  conversion.length_unit = a.length_unit;
  // Turns in the order given, then the move.
  for (const std::string& rotation : a.rotations)
    conversion.new_from_old = parse_rotation(rotation) * conversion.new_from_old;
  if (!a.move.empty()) {
    const auto by = parse_numbers(a.move, 3);
    conversion.new_from_old =
        Frame::from_axis(Direction(), 0.0, {by[0], by[1], by[2]}) * conversion.new_from_old;
  }
  return conversion;
}

void convert_photometry(const ConvertArguments& a, Session& session) {
  const auto format = photometric_format_for(a.output, a.to);
  if (!format) {
    throw UsageError(
        fmt::format("{}: the input is a photometric file; give --to ies-2002, ies-2019 or ldt", a.output));
  }
  if (!a.rays.empty() || !a.flux.empty() || !a.rotations.empty() || !a.move.empty() || a.salvage) {
    throw UsageError("--rays, --flux, --rotate, --move and --salvage are for ray files");
  }
  const PhotometricFile file = read_photometric_file(a.input, a.photometric.read_options(session.strict));
  for (const auto* list : {&file.repairs, &file.notes}) {
    for (const Diagnostic& d : *list) session.note(fmt::format("{}: {}", a.input, to_string(d)));
  }
  write_photometric_file(a.output, file, *format, a.photometric.write_options());
  session.print_line(fmt::format(
      "{}: written; IES angles taken as {}", a.output,
      a.photometric.ies_turn == "90" ? "H = C - 90, sizes kept" : "H = C, width and length swapped"));
}

void convert_rays(const ConvertArguments& a, Session& session) {
  const RayConversion conversion = conversion_of(a, session.strict);
  const std::string format = ray_format_for(a.output, a.to);
  const std::vector<std::string> columns = parse_words(a.columns);
  const auto result = session.timed("convert", [&] {
    return convert_ray_file(a.input, a.output, format, conversion,
                            {.salvage = a.salvage, .format = a.from, .text_columns = columns},
                            session.progress());
  });
  for (const std::string& warning : result.warnings) session.note(warning);
  session.print_line(fmt::format(
      "{}: {} rays{} as {}", a.output, result.rays,
      result.flux ? fmt::format(" of {:.6g} {}", *result.flux, symbol(result.flux_unit)) : "", format));
}

void convert(const ConvertArguments& a, Session& session) {
  session.start();
  if (a.from.empty() && is_photometric_file(a.input)) {
    convert_photometry(a, session);
  } else {
    if (a.from.empty()) require_ray_file(a.input);
    convert_rays(a, session);
  }
}

}  // namespace

void add_convert(CLI::App& app, Session& session, int&) {
  Command command(app, "convert", "Convert ray files (thin, turn, move) and photometric files");
  auto arguments = std::make_shared<ConvertArguments>();
  ConvertArguments& a = *arguments;
  command.required("IN", a.input, "The file to read");
  command.required("OUT", a.output, "The file to write");
  command.option("--from", a.from, "Read IN as this ray-file format, whatever its content says");
  command.option("--to", a.to, "Format of OUT (default: by its ending)");
  command.option("--rays", a.rays,
                 "Keep this number of rays, spread over the file; their flux stays that of all");
  command.option("--seed", a.seed, "Seed of that choice");
  command.option("--flux", a.flux, "Total flux to state, in the rays' unit");
  command.option("--length-unit", a.length_unit, "Unit of lengths in OUT, where its format has a choice");
  command.option("--columns", a.columns, "Columns of a text file without a header: x,y,z,kx,ky,kz,flux,...");
  command.flag("--salvage", a.salvage, "Take what is whole of a damaged file");
  command.repeated("--rotate", a.rotations, "Turn about an axis through the origin: z:90; may be repeated");
  command.option("--move", a.move, "Then move by X,Y,Z mm");
  a.photometric.add_read(command);
  session.add_strict(command);
  session.add_common(command);
  command.on_run([arguments, &session] { convert(*arguments, session); });
}

}  // namespace lucerna::cli
