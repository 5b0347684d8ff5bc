// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/problem/target.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"
#include "lucerna/design/evaluation/window.h"
#include "lucerna/design/problem/zone_guide.h"
#include "lucerna/photometric_file.h"
#include "lucerna/project/sections/project_memory.h"

namespace lucerna {

namespace {

/// Intensity of a point at `from_mm` that lights the plane as the target wants it: E r^2 / cos.
IntensityDistribution seen_from(const PlaneTarget& plane, const Vec3& from_mm, FluxUnit unit) {
  IntensityDistribution out = uniform_distribution(2.5, 1.0, unit);
  const Frame plane_from_world = plane.world_from_plane.inverse();
  const Vec3 from = plane_from_world.point(from_mm);
  for (std::size_t c = 0; c < out.c_deg.size(); ++c) {
    for (std::size_t g = 0; g < out.gamma_deg.size(); ++g) {
      const Vec3 d = plane_from_world.vector(
          direction_from_type_c({radians(out.c_deg[c]), radians(out.gamma_deg[g])}).vec());
      if (d.z >= 0.0 || from.z <= 0.0) continue;
      const double t = -from.z / d.z;
      const double lx = plane.at(from.x + t * d.x, from.y + t * d.y);
      out.at(c, g) = lx * t * t / kMm2PerM2 / -d.z;
    }
  }
  return out;
}

TargetMode read_mode(TomlReader& reader) {
  return reader.word("mode").value_or("shape") == "shape" ? TargetMode::shape : TargetMode::absolute;
}

IlluminanceMap read_map(TomlReader& reader, const std::filesystem::path& file, TargetMode mode) {
  const std::string ending = lower_ending(file);
  const auto white = reader.number("white_lx");
  if (ending == ".csv" || ending == ".txt") {
    if (white) reader.fail("white_lx", "belongs to a PNG picture; a CSV holds the illuminances themselves");
    return read_illuminance_csv(file);
  }
  if (ending != ".png") {
    reader.fail("file",
                fmt::format("found '{}', expected a .csv, .txt or .png with the illuminance", ending));
  }
  if (mode == TargetMode::absolute && !white) {
    reader.missing("white_lx", "mode = \"absolute\" needs the illuminance of the picture's white");
  }
  IlluminanceMap map = read_illuminance_png(file);
  for (double& v : map.value) v *= white.value_or(1.0);
  return map;
}

/// The same, checked.
IlluminanceMap read_checked_map(TomlReader& reader, const std::filesystem::path& file, TargetMode mode) {
  IlluminanceMap map = read_map(reader, file, mode);
  if (!std::isfinite(std::accumulate(map.value.begin(), map.value.end(), 0.0)))
    reader.fail("file", fmt::format("{}: the sum of the illuminances is no finite number", file.string()));
  return map;
}

/// All of a plane target but its map.
PlaneTarget read_plane(TomlReader& reader, const Vec3& luminaire_mm) {
  PlaneTarget plane;
  const auto position = reader.vector("position_mm");
  if (!position) reader.missing("position_mm", "the centre of the plane's rectangle");
  const auto normal = reader.axis("normal");
  if (!normal) reader.missing("normal", "where the lit side looks to, as \"+z\" for a floor");
  const auto size = reader.numbers("size_mm", 2);
  if (!size) reader.missing("size_mm", "the rectangle's sides along x and y");
  plane.turn_deg = reader.number("turn_deg", 0.0);
  plane.world_from_plane = Frame::from_axis(*normal, radians(plane.turn_deg), *position);
  plane.size_x_mm = (*size)[0];
  plane.size_y_mm = (*size)[1];
  if (plane.world_from_plane.inverse().point(luminaire_mm).z <= 0.0) {
    reader.fail("normal", "looks away from the luminaire; expected the side that is lit");
  }
  return plane;
}

/// Zones that ask for light lie on the plane's rectangle.
void check_places(const TomlReader& reader, const PlaneTarget& plane, const std::vector<TargetZone>& zones) {
  for (const TargetZone& z : zones) {
    const bool in = std::max(std::abs(z.column.low), std::abs(z.column.high)) <= 0.5 * plane.size_x_mm &&
                    std::max(std::abs(z.row.low), std::abs(z.row.high)) <= 0.5 * plane.size_y_mm;
    if (in || !z.asks_for_light()) continue;
    reader.fail("zone", fmt::format("'{}' reaches beyond size_mm, and has a minimum there", z.name));
  }
}

std::shared_ptr<const ZoneCells> read_cells(TomlReader& reader, double source_flux,
                                            const std::optional<PlaneTarget>& plane) {
  const auto axis = reader.axis("axis");
  std::vector<TargetZone> zones = read_zones(reader, plane.has_value(), source_flux);
  const bool h_v = std::any_of(zones.begin(), zones.end(),
                               [](const TargetZone& z) { return z.coordinates == ZoneCoordinates::h_v; });
  if (axis && !h_v) reader.fail("axis", "is what zones with h_deg and v_deg are about; there are none");
  if (h_v && !axis) reader.missing("axis", "the direction of h_deg = 0 and v_deg = 0");
  if (zones.empty()) return nullptr;
  if (plane) check_places(reader, *plane, zones);
  const auto frame = plane ? std::optional<Frame>(plane->world_from_plane) : std::nullopt;
  return std::make_shared<const ZoneCells>(std::move(zones), axis.value_or(Direction()), frame);
}

bool ask_for_light(const ZoneCells& cells) {
  return std::any_of(cells.zones().begin(), cells.zones().end(),
                     [](const TargetZone& z) { return z.asks_for_light(); });
}

/// A target is a file, or zones that ask for light.
void require_file_or_zones(TomlReader& reader, bool plane) {
  if (reader.has("file") || reader.has("zone")) return;
  reader.fail("file", plane ? "is missing: a CSV or PNG file with the target illuminance"
                            : "is missing: an IES or EULUMDAT file with the target distribution");
}

/// A photometric file's distribution; tells what was mended in it.
IntensityDistribution read_repaired(const std::filesystem::path& path, std::vector<std::string>& warnings) {
  PhotometricFile file = read_photometric_file(path);
  for (const Diagnostic& d : file.repairs)
    warnings.push_back(fmt::format("{}: {}", path.string(), to_string(d)));
  return std::move(file.distribution);
}

/// What zones without a file are begun with.
void set_guide(TomlReader& reader, FluxUnit unit, DesignTarget& target) {
  if (!ask_for_light(*target.zones)) {
    reader.fail("file", "is missing, and no zone has a minimum: expected a file or a zone with a minimum");
  }
  if (reader.has("mode")) {
    reader.fail("mode", "belongs to a target with a file; zones count as their bounds say");
  }
  target.zones_only = true;
  if (target.plane) {
    target.plane->map = guide_map(*target.zones, target.plane->size_x_mm, target.plane->size_y_mm);
  } else {
    target.distribution = guide_distribution(*target.zones, unit);
  }
}

}  // namespace

double PlaneTarget::flux() const {
  double sum = 0.0;
  for (const double lx : map.value) sum += lx;
  return sum / static_cast<double>(map.value.size()) * size_x_mm * size_y_mm / kMm2PerM2;
}

DesignTarget read_target(TomlReader reader, FluxUnit unit, double source_flux, const Vec3& luminaire_mm,
                         Project& project) {
  DesignTarget target;
  const bool plane = reader.word("kind").value_or("far-field") == "plane";
  require_file_or_zones(reader, plane);
  if (plane) target.plane = read_plane(reader, luminaire_mm);
  target.zones = read_cells(reader, source_flux, target.plane);
  const auto file = reader.file("file");
  const auto given = file ? in_memory(project.memory.targets, *file) : nullptr;
  if (!file) {
    set_guide(reader, unit, target);
  } else {
    target.mode = read_mode(reader);
    target.file = file->string();
    if (given == nullptr) project.inputs.push_back(*file);
    if (target.plane) target.plane->map = read_checked_map(reader, *file, target.mode);
  }
  reader.finish();
  if (file && !target.plane) {
    target.distribution = given != nullptr ? *given : read_repaired(*file, project.warnings);
  }
  if (target.plane) target.distribution = seen_from(*target.plane, luminaire_mm, unit);
  if (target.mode == TargetMode::absolute && target.distribution.unit != unit) {
    reader.fail("mode",
                fmt::format("the target is in {}, the sources in {}; they can be compared by shape only",
                            symbol(target.distribution.unit), symbol(unit)));
  }
  return target;
}

TentBins target_bins(const DesignTarget& target, const Frame& world_from_mirror, bool rings) {
  const Frame mirror_from_world = world_from_mirror.inverse();
  if (target.plane) {
    const PlaneTarget& p = *target.plane;
    return TentBins::plane(mirror_from_world * p.world_from_plane, 0.5 * p.size_x_mm, 0.5 * p.size_y_mm,
                           WindowOptions().count);
  }
  const std::vector<DirectedFlux> light = directed_flux(target.distribution);
  const Direction axis = world_from_mirror.direction(Direction());
  const TentBins bins = rings ? ring_window(light, axis) : square_window(light, axis);
  const Frame& a = bins.axes();
  const Frame axes(mirror_from_world.vector(a.ex()), mirror_from_world.vector(a.ey()),
                   mirror_from_world.vector(a.ez()), {});
  return rings ? TentBins::rings(axes, bins.extent(), bins.count())
               : TentBins::square(axes, bins.extent(), bins.count());
}

std::function<Eigen::VectorXd(const TentBins&)> target_flux(const DesignTarget& target,
                                                            const Frame& world_from_mirror,
                                                            double source_flux) {
  const double unit = target.mode == TargetMode::absolute ? 1.0 / source_flux : 1.0;
  return [&target, world_from_mirror, unit](const TentBins& bins) {
    const std::vector<double> flux =
        bins.is_plane()
            ? bins.flux_on([&](double x, double y) { return unit / kMm2PerM2 * target.plane->at(x, y); })
            : bins.flux_of([&](const Direction& d) {
                return unit * intensity_in(target.distribution, world_from_mirror.direction(d));
              });
    return Eigen::VectorXd(
        Eigen::Map<const Eigen::VectorXd>(flux.data(), static_cast<Eigen::Index>(flux.size())));
  };
}

}  // namespace lucerna
