// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "lucerna/cli/commands/commands.h"
#include "lucerna/cli/parse/arguments.h"
#include "lucerna/core/io/error.h"
#include "lucerna/ray_file.h"
#include "lucerna/source.h"
#include "lucerna/source/emitters/draw_rays.h"
#include "lucerna/version.h"

namespace lucerna::cli {

namespace {

struct MakeSourceArguments {
  std::string kind, output, count, to, seed = "1", sequence = "random", flux_lm, flux_w;
  std::string radius, length, size, ghost_share, surface, surface_size;
};

EmitterOptions emitter_options(const MakeSourceArguments& a) {
  EmitterOptions options{.kind = emitter_kind(a.kind)};
  if (!a.radius.empty()) options.radius_mm = parse_number(a.radius);
  if (!a.length.empty()) options.length_mm = parse_number(a.length);
  if (!a.ghost_share.empty()) options.ghost_share = parse_number(a.ghost_share);
  if (!a.size.empty()) {
    const auto size = parse_numbers(a.size, 2);
    options.size_mm = {{size[0], size[1]}};
  }
  if (!a.flux_lm.empty() && !a.flux_w.empty()) throw UsageError("--flux-lm and --flux-w exclude each other");
  if (!a.flux_lm.empty()) options.flux = parse_flux(a.flux_lm, "--flux-lm");
  if (!a.flux_w.empty()) {
    options.flux = parse_flux(a.flux_w, "--flux-w");
    options.flux_unit = FluxUnit::watt;
  }
  if (a.surface.empty() && !a.surface_size.empty()) throw UsageError("--surface-mm needs --surface");
  if (!a.surface.empty()) {
    const std::vector<double> mm =
        a.surface_size.empty() ? std::vector<double>() : parse_numbers(a.surface_size);
    options.surface = BoundingSurface::from_sizes(surface_kind(a.surface), mm);
  }
  return options;
}

void make_source(const MakeSourceArguments& a, Session& session) {
  session.start();
  const auto source = make_emitter(emitter_options(a));
  const std::uint64_t n = parse_count(a.count);
  const std::string format = ray_format_for(a.output, a.to);
  const Sequence sequence(sequence_kind(a.sequence), parse_count(a.seed));
  RaySetHeader header;
  header.flux_unit = source->flux_unit();
  header.set_flux(source->flux());
  header.texts.light_source = "analytic emitter: " + a.kind;
  header.texts.file_creator = fmt::format("Lucerna {}", version());
  header.creation_method = 0;
  const auto warnings = session.timed("write", [&] {
    return draw_rays(*source, sequence, n, *create_ray_file(a.output, format, header, n), session.progress());
  });
  for (const std::string& warning : warnings) session.note(fmt::format("{}: {}", a.output, warning));
  session.print_line(fmt::format("{}: {} rays of {:g} {} as {}, {:.1f} M rays/s", a.output, n, source->flux(),
                                 symbol(source->flux_unit()), format,
                                 1e-6 * static_cast<double>(n) / session.seconds("write")));
}

}  // namespace

void add_make_source(CLI::App& app, Session& session, int&) {
  Command command(app, "make-source", "Make a ray file of an exactly known source");
  auto arguments = std::make_shared<MakeSourceArguments>();
  MakeSourceArguments& a = *arguments;
  command.required("KIND", a.kind,
                   "point disk rectangle cylinder sphere filament led phong500 phong25 radial cosine");
  command.required("-o,--output", a.output, "The ray file to write");
  command.required("-n,--rays", a.count, "Number of rays");
  command.option("--to", a.to, "Format of the file (default: by its ending)");
  command.option("--seed", a.seed, "Seed of the random numbers");
  command.option("--sequence", a.sequence, "random or sobol");
  command.option("--flux-lm", a.flux_lm, "Luminous flux (default 1000)");
  command.option("--flux-w", a.flux_w, "Radiant flux, instead of a luminous one");
  command.option("--radius-mm", a.radius, "disk, cylinder, sphere, filament, synthetic sets");
  command.option("--length-mm", a.length, "cylinder, filament");
  command.option("--size-mm", a.size, "rectangle: X,Y");
  command.option("--ghost-share", a.ghost_share, "filament: share of the flux in the bulb's mirror image");
  command.option("--surface", a.surface,
                 "Surface that the rays start on: none, sphere, cylinder, box, plane");
  command.option("--surface-mm", a.surface_size,
                 "Its size: sphere RADIUS, cylinder RADIUS,LENGTH, box X,Y,Z, plane its z");
  session.add_common(command);
  command.on_run([arguments, &session] { make_source(*arguments, session); });
}

}  // namespace lucerna::cli
