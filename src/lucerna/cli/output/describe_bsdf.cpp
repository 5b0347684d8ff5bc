// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "lucerna/bsdf.h"
#include "lucerna/cli/output/describe.h"
#include "lucerna/core/io/file.h"
#include "lucerna/scatter.h"

namespace lucerna::cli {

bool is_bsdf_file(const std::string& path) { return lower_ending(path) == ".bsdf"; }

Description describe_bsdf(const std::string& path) {
  const BsdfTable table = read_bsdf(path);
  const std::vector<double> found = Scatter(table).integrals();
  const std::string maker = table.is_about_normal ? "LightTools" : "Zemax";
  Description d;
  d.json = Json{{"path", path}, {"format", "bsdf"}, {"maker", maker}, {"incidences", Json::array()}};
  d.lines.push_back(fmt::format(
      "  format              bsdf of {}, {} azimuths to {:g} degrees, {} radial angles to {:g}", maker,
      table.azimuth_deg.size(), table.azimuth_deg.back(), table.radial_deg.size(), table.radial_deg.back()));
  for (std::size_t i = 0; i < found.size(); ++i) {
    d.lines.push_back(fmt::format("  incidence {:>4g} deg   reflectance {:.4f} stated, {:.4f} by its values",
                                  table.incidence_deg[i], table.total[i], found[i]));
    d.json["incidences"].push_back(Json{{"incidence_deg", table.incidence_deg[i]},
                                        {"reflectance_stated", table.total[i]},
                                        {"reflectance_of_values", found[i]}});
  }
  return d;
}

}  // namespace lucerna::cli
