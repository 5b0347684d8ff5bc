// SPDX-License-Identifier: Apache-2.0
#include "lucerna/results/folders/trace_folder.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"
#include "lucerna/version.h"

namespace lucerna {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint64_t kMaxTextBytes = std::uint64_t{1} << 24;   // result.json, project.toml
constexpr std::uint64_t kMaxTableBytes = std::uint64_t{1} << 30;  // 16 M cells of 60 bytes

/// Takes the part of `text` before the next `end`, which goes too.
std::string_view take_until(std::string_view& text, char end) {
  const std::size_t at = std::min(text.find(end), text.size());
  const std::string_view part = text.substr(0, at);
  text.remove_prefix(std::min(at + 1, text.size()));
  return part;
}

/// Reads the lines of a table one by one: two coordinates, a value and its standard error.
class TableReader {
 public:
  TableReader(std::string_view text, const std::string& file) : rest_(text), file_(file) {}

  /// The header line, for the caller to judge.
  std::string_view header() { return next_line(); }

  struct Row {
    double a, b, value, standard_error;
  };
  bool next(Row& row) {
    if (rest_.empty()) return false;
    std::string_view line = next_line();
    row.a = number(take_until(line, ','));
    row.b = number(take_until(line, ','));
    row.value = not_negative(take_until(line, ','));
    row.standard_error = line.empty() ? std::nan("") : not_negative(line);
    return true;
  }

  template <class... Args>
  [[noreturn]] void fail(fmt::format_string<Args...> text, Args&&... args) const {
    throw_input_error(file_, fmt::format("line {}", line_), text, std::forward<Args>(args)...);
  }

 private:
  std::string_view next_line() {
    ++line_;
    std::string_view line = take_until(rest_, '\n');
    if (line.ends_with('\r')) line.remove_suffix(1);
    return line;
  }

  double number(std::string_view word) const {
    double value = 0.0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(value)) {
      fail("found '{}', expected a finite number", word.substr(0, 40));
    }
    return value;
  }
  double not_negative(std::string_view word) const {
    const double value = number(word);
    if (value < 0.0) fail("found '{}', expected a number, 0 or more", word.substr(0, 40));
    return value;
  }

  std::string_view rest_;
  const std::string& file_;
  std::size_t line_ = 0;
};

/// What a trace writes is the same since; later schemas changed designs and comparisons.
constexpr int kOldestSchema = 4;

Json read_result(const std::filesystem::path& path) {
  const std::string text = read_file(path, kMaxTextBytes);
  Json result = Json::parse(text, nullptr, false);
  const std::string file = path.string();
  if (result.is_discarded()) throw_input_error(file, "", "is no JSON");
  if (!result.is_object() || !result.contains("ledger") || !result.contains("detectors")) {
    throw_input_error(file, "", "found no ledger and detectors, expected the result of a trace");
  }
  const Json schema = result.value("schema_version", Json());
  if (!schema.is_number_integer() || schema < kOldestSchema || schema > kJsonSchemaVersion) {
    throw_input_error(file, "schema_version", "found {}, expected {} to {}", schema.dump(), kOldestSchema,
                      kJsonSchemaVersion);
  }
  return result;
}

/// The name of a detector: it names a file, so it may not lead elsewhere.
std::string detector_name(const Json& detector, const std::string& file) {
  const Json name = detector.is_object() ? detector.value("name", Json()) : Json();
  if (!name.is_string() || name.get<std::string>().find_first_of("/\\") != std::string::npos) {
    throw_input_error(file, "detectors", "found the name {}, expected a file's name", name.dump());
  }
  return name.get<std::string>();
}

/// Standard error of a detector's flux; nothing where the file has none.
std::optional<double> flux_error(const Json& detector) {
  const Json flux = detector.value("flux", Json());
  const Json error = flux.is_object() ? flux.value("standard_error", Json()) : Json();
  return error.is_number() ? std::optional(error.get<double>()) : std::nullopt;
}

/// What a plane's table may begin with.
struct PlaneHeader {
  std::string_view line;
  bool luminance;
  FluxUnit unit;
  std::string_view value_unit;
};
constexpr std::array kPlaneHeaders{
    PlaneHeader{"x_mm,y_mm,illuminance_lx,standard_error_lx", false, FluxUnit::lumen, "lx"},
    PlaneHeader{"x_mm,y_mm,luminance_cd_per_m2,standard_error_cd_per_m2", true, FluxUnit::lumen, "cd/m2"},
    PlaneHeader{"x_mm,y_mm,irradiance_w_per_m2,standard_error_w_per_m2", false, FluxUnit::watt, "W/m2"},
    PlaneHeader{"x_mm,y_mm,radiance_w_per_m2_sr,standard_error_w_per_m2_sr", true, FluxUnit::watt,
                "W/(m2 sr)"}};

}  // namespace

FarFieldTable far_field_table(std::string_view csv, const std::string& file) {
  TableReader reader(csv, file);
  FarFieldTable table;
  IntensityDistribution& d = table.distribution;
  const std::string_view header = reader.header();
  if (header == "c_deg,gamma_deg,intensity_w_per_sr,standard_error_w_per_sr") {
    d.unit = FluxUnit::watt;
  } else if (header != "c_deg,gamma_deg,intensity_cd,standard_error_cd") {
    reader.fail("found '{}', expected the header of a far-field table", header.substr(0, 80));
  }
  bool error_known = true;
  TableReader::Row row;
  while (reader.next(row)) {
    if (d.c_deg.empty() || row.a != d.c_deg.back()) d.c_deg.push_back(row.a);
    if (d.c_deg.size() == 1) d.gamma_deg.push_back(row.b);
    const std::size_t g = d.cd.size() - (d.c_deg.size() - 1) * d.gamma_deg.size();
    if (g >= d.gamma_deg.size() || row.b != d.gamma_deg[g]) {
      reader.fail("found gamma {:g}, expected the gammas of the first plane in every plane", row.b);
    }
    d.cd.push_back(row.value);
    table.standard_error.push_back(row.standard_error);
    error_known = error_known && std::isfinite(row.standard_error);
  }
  if (!error_known) table.standard_error.clear();
  if (const std::string fault = grid_fault(d); !fault.empty()) throw_input_error(file, "", "{}", fault);
  return table;
}

PlaneTable plane_table(std::string_view csv, const std::string& file) {
  TableReader reader(csv, file);
  PlaneTable table;
  const std::string_view header = reader.header();
  bool known = false;
  for (const PlaneHeader& h : kPlaneHeaders) {
    if (header != h.line) continue;
    known = true;
    table.luminance = h.luminance;
    table.unit = h.unit;
    table.value_unit = h.value_unit;
  }
  if (!known) reader.fail("found '{}', expected the header of a plane's table", header.substr(0, 80));
  bool error_known = true;
  TableReader::Row row;
  while (reader.next(row)) {
    if (table.y_mm.empty() || row.b != table.y_mm.back()) {
      if (!table.y_mm.empty() && row.b < table.y_mm.back()) reader.fail("found y {:g}, expected more", row.b);
      if (table.value.size() != table.y_mm.size() * table.x_mm.size()) reader.fail("the row before is short");
      table.y_mm.push_back(row.b);
    }
    if (table.y_mm.size() == 1) table.x_mm.push_back(row.a);
    const std::size_t x = table.value.size() - (table.y_mm.size() - 1) * table.x_mm.size();
    if (x >= table.x_mm.size() || row.a != table.x_mm[x])
      reader.fail("found x {:g}, expected the x of the first row in every row", row.a);
    table.value.push_back(row.value);
    table.standard_error.push_back(row.standard_error);
    error_known = error_known && std::isfinite(row.standard_error);
  }
  if (table.value.empty()) reader.fail("found no cell, expected at least one");
  if (table.value.size() != table.y_mm.size() * table.x_mm.size()) reader.fail("the last row is short");
  if (!error_known) table.standard_error.clear();
  return table;
}

TraceFolder read_trace_folder(const std::filesystem::path& folder) {
  const std::filesystem::path result_json = folder / "result.json";
  if (!std::filesystem::exists(result_json)) {
    throw InputError(
        fmt::format("{}: found no result.json, expected the folder of a trace or design", folder.string()));
  }
  TraceFolder read;
  read.path = folder;
  read.result = read_result(result_json);
  read.project = read_file(folder / "project.toml", kMaxTextBytes);
  const std::string result_file = result_json.string();
  for (const Json& detector : read.result["detectors"]) {
    const std::string name = detector_name(detector, result_file);
    const Json kind = detector.value("kind", Json());
    const std::filesystem::path csv = folder / (name + ".csv");
    if (kind == "far-field") {
      read.far_fields.push_back(far_field_table(read_file(csv, kMaxTableBytes), csv.string()));
      read.far_fields.back().name = name;
      read.far_fields.back().flux_standard_error = flux_error(detector);
    } else if (kind == "plane" || kind == "luminance") {
      read.planes.push_back(plane_table(read_file(csv, kMaxTableBytes), csv.string()));
      read.planes.back().name = name;
    } else if (kind != "rays") {
      throw_input_error(result_file, fmt::format("detector '{}'", name),
                        "found the kind {}, expected far-field, plane, luminance or rays", kind.dump());
    }
  }
  return read;
}

}  // namespace lucerna
