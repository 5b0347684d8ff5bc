// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cctype>
#include <cmath>

#include "lucerna/core/io/file.h"
#include "lucerna/photometric_file.h"
#include "lucerna/photometric_metrics.h"
#include "lucerna/photometry/formats/photometric_text.h"

namespace lucerna {

namespace {

constexpr std::uint64_t kMaxBytes = std::uint64_t{64} << 20;
constexpr std::size_t kHeadBytes = std::size_t{64} << 10;
/// A text of fewer lines is no light distribution, whatever it is called.
constexpr int kFewestLines = 3;

bool looks_like_ies(const std::vector<std::string_view>& lines) {
  const auto starts = [](std::string_view line, std::string_view with) {
    line = trimmed(line);
    if (line.size() < with.size()) return false;
    return std::equal(with.begin(), with.end(), line.begin(), [](char a, char b) {
      return a == static_cast<char>(std::toupper(static_cast<unsigned char>(b)));
    });
  };
  if (!lines.empty() && (starts(lines.front(), "IESNA") || starts(lines.front(), "IES:"))) return true;
  return std::any_of(lines.begin(), lines.end(), [&](std::string_view line) {
    if (!starts(line, "TILT")) return false;
    const std::string_view rest = trimmed(trimmed(line).substr(4));
    return rest.starts_with('=');
  });
}

bool looks_like_ldt(const std::vector<std::string_view>& lines) {
  if (lines.size() < 30) return false;
  const auto value = [&](std::size_t line) {
    std::string text(trimmed(lines[line - 1]));
    if (text.empty()) return 0.0;
    std::replace(text.begin(), text.end(), ',', '.');
    return number_from(text).value_or(std::nan(""));
  };
  const auto whole = [&](std::size_t line, double from, double to) {
    const double v = value(line);
    return v == std::floor(v) && v >= from && v <= to && !trimmed(lines[line - 1]).empty();
  };
  if (!whole(2, 0, 3) || !whole(3, 0, 4) || !whole(4, 1, 1e5) || !whole(6, 2, 1e5) || !whole(26, 1, 1000))
    return false;
  for (std::size_t line = 13; line <= 24; ++line) {
    if (std::isnan(value(line))) return false;
  }
  return true;
}

void check_flux(const PhotometricFile& file, std::vector<Diagnostic>& found) {
  const auto warn = [&](const std::string& text) { found.push_back({Severity::warning, "", text}); };
  const double flux = total_flux(file.distribution);
  if (!(flux > 0.0)) {
    warn("no light at all");
    return;
  }
  if (const auto lamp = lamp_flux_lm(file.luminaire)) {
    const double ratio = flux / *lamp;
    if (ratio < 0.01 || ratio > 1.05) {
      warn(fmt::format(
          "light output ratio {:.1f} %: {:.1f} lm out of lamps of {:.1f} lm, 1 to 105 % is plausible",
          100.0 * ratio, flux, *lamp));
    }
  }
  if (const auto stated = file.origin.declared_flux_lm;
      stated && *stated > 0.0 && file.distribution.unit == FluxUnit::lumen) {
    if (std::abs(flux / *stated - 1.0) > 0.02) {
      warn(fmt::format("the intensities hold {:.1f} lm, the file states {:.1f} lm ({:+.1f} %)", flux, *stated,
                       100.0 * (flux / *stated - 1.0)));
    }
  }
  const double up = zonal_flux(file.distribution, 90.0, 180.0) / flux;
  if (up > 0.001 && up < 0.07) {
    found.push_back(
        {Severity::note, "",
         fmt::format("{:.1f} % of the flux goes up: stray light, if the luminaire is sealed above",
                     100.0 * up)});
  }
}

void check_isym3(const PhotometricFile& file, std::vector<Diagnostic>& found) {
  if (file.origin.symmetry != "Isym 3") return;
  double front = 0.0, back = 0.0;
  const std::vector<double> rings = ring_weights_sr(file.distribution.gamma_deg);
  const std::vector<double> planes = plane_weights(file.distribution.c_deg);
  for (std::size_t c = 0; c < planes.size(); ++c) {
    const double side = std::sin(radians(file.distribution.c_deg[c]));
    for (std::size_t g = 0; g < rings.size(); ++g) {
      const double flux = planes[c] * rings[g] * file.distribution.at(c, g);
      if (side > 1e-9) front += flux;
      if (side < -1e-9) back += flux;
    }
  }
  if (back > 1.2 * front) {
    found.push_back(
        {Severity::note, line_place(3),
         "more light to C270 than to C90: if this is a street light its planes may be stored in reverse "
         "(read it with isym3 reversed)"});
  }
}

}  // namespace

std::optional<PhotometricFormat> detect_photometric_format(std::string_view head) {
  head = head.substr(0, kHeadBytes);
  const std::string text = decoded_text(head);
  if (text.find('\0') != std::string::npos) return std::nullopt;
  const std::vector<std::string_view> lines = lines_of(text);
  if (looks_like_ies(lines)) return PhotometricFormat::ies_2019;
  if (looks_like_ldt(lines)) return PhotometricFormat::ldt;
  return std::nullopt;
}

namespace {

/// Of a text whose counts are wrong, so that it does not look like what it is called: its reader says where.
std::optional<PhotometricFormat> named_format(const std::filesystem::path& path, std::string_view bytes) {
  const std::string ending = lower_ending(path);
  const auto lines = std::ranges::count(bytes, '\n');
  if (lines < kFewestLines || bytes.find('\0') != std::string_view::npos) return std::nullopt;
  if (ending == ".ldt") return PhotometricFormat::ldt;
  if (ending == ".ies") return PhotometricFormat::ies_2019;
  return std::nullopt;
}

}  // namespace

bool is_photometric_file(const std::filesystem::path& path) {
  try {
    const InputFile file(path);
    std::string head(std::min<std::uint64_t>(file.size(), kHeadBytes), '\0');
    file.read_at(0, std::as_writable_bytes(std::span(head)));
    return detect_photometric_format(head).has_value();
  } catch (const InputError&) {
    return false;
  }
}

PhotometricFile read_photometric_file(const std::filesystem::path& path,
                                      const PhotometricReadOptions& options) {
  const std::string bytes = read_file(path, kMaxBytes);
  auto format = detect_photometric_format(bytes);
  if (!format) format = named_format(path, bytes);
  if (!format)
    throw InputError(fmt::format("{}: neither an IES LM-63 nor a EULUMDAT file", path.string()),
                     ErrorCause::damaged);
  return *format == PhotometricFormat::ldt ? read_ldt(bytes, path.string(), options)
                                           : read_ies(bytes, path.string(), options);
}

void write_photometric_file(const std::filesystem::path& path, const PhotometricFile& file,
                            PhotometricFormat format, const PhotometricWriteOptions& options) {
  write_file(path,
             format == PhotometricFormat::ldt ? ldt_text(file, options) : ies_text(file, format, options));
}

std::vector<Diagnostic> check_photometric_file(const std::filesystem::path& path,
                                               const PhotometricReadOptions& options) {
  [[maybe_unused]] const InputFile opened(path);  // throws if it cannot be opened
  std::vector<Diagnostic> found;
  try {
    PhotometricReadOptions tolerant = options;
    tolerant.strict = false;
    const PhotometricFile file = read_photometric_file(path, tolerant);
    found = file.repairs;
    found.insert(found.end(), file.notes.begin(), file.notes.end());
    check_flux(file, found);
    check_isym3(file, found);
    const LuminaireData& l = file.luminaire;
    if (l.luminous_length_mm == 0.0 && l.luminous_width_mm == 0.0) {
      found.push_back({Severity::note, "", "no size of the luminous area: a point"});
    }
  } catch (const InputError& error) {
    found.push_back(diagnostic(error, path));
  }
  for (Diagnostic& d : found) {
    if (options.strict && d.severity == Severity::warning) d.severity = Severity::error;
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const Diagnostic& a, const Diagnostic& b) { return line_of(a) < line_of(b); });
  return found;
}

double tilt_factor(const PhotometricOrigin& origin, double tilt_deg) {
  const auto& factors = origin.tilt_factors;
  if (factors.empty()) return 1.0;
  if (!(tilt_deg > factors.front().first)) return factors.front().second;
  for (std::size_t i = 1; i < factors.size(); ++i) {
    const auto [from, before] = factors[i - 1];
    const auto [to, after] = factors[i];
    if (tilt_deg <= to && to > from) return before + (after - before) * (tilt_deg - from) / (to - from);
  }
  return factors.back().second;
}

}  // namespace lucerna
