// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <set>
#include <string>

#include "lucerna/cli/output/describe.h"
#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"
#include "lucerna/glass_catalogue.h"

namespace lucerna::cli {

namespace {

constexpr double kDLineNm = 587.5618;

void add_glass(const CatalogueGlass& glass, Description& d) {
  const bool has_index = glass.min_nm <= kDLineNm && kDLineNm <= glass.max_nm;
  const std::string index = has_index ? fmt::format("{:.5f}", glass_index(glass, kDLineNm)) : "-";
  std::string line = fmt::format("  {:<18}  index {:<7}  {:g} to {:g} nm, formula {}", glass.name, index,
                                 glass.min_nm, glass.max_nm, glass.formula);
  if (!glass.transmittance.empty()) {
    line += fmt::format("; transmittance {:g} to {:g} nm", glass.transmittance.front().wavelength_nm,
                        glass.transmittance.back().wavelength_nm);
  }
  d.lines.push_back(std::move(line));
  Json json{{"name", glass.name},
            {"formula", glass.formula},
            {"min_nm", glass.min_nm},
            {"max_nm", glass.max_nm},
            {"index_d", nullptr}};
  if (has_index) json["index_d"] = glass_index(glass, kDLineNm);
  d.json["glasses"].push_back(std::move(json));
}

}  // namespace

bool is_glass_catalogue(const std::string& path) { return lower_ending(path) == ".agf"; }

Description describe_catalogue(const std::string& path) {
  const std::vector<std::string> names = glass_names(path);
  Description d;
  d.json = Json{{"path", path}, {"format", "agf"}, {"glasses", Json::array()}};
  d.lines.push_back(
      fmt::format("  format              agf, {} glasses; index at {:.2f} nm", names.size(), kDLineNm));
  std::set<std::string> known;
  for (const std::string& name : names) {
    if (!known.insert(name).second) {
      d.warnings.push_back(
          fmt::format("{}: the name stands more than once; the first glass of it counts", name));
      continue;
    }
    try {
      add_glass(read_glass(path, name), d);
    } catch (const InputError& e) {
      d.warnings.push_back(fmt::format("{}: {}", name, e.what()));
    }
  }
  if (!d.warnings.empty()) d.json["warnings"] = d.warnings;
  return d;
}

}  // namespace lucerna::cli
