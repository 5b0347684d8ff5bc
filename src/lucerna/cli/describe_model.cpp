// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <filesystem>

#include "lucerna/cli/describe.h"
#include "lucerna/source/source_model.h"

namespace lucerna::cli {

Description describe_model(const std::string& path) {
  const auto model = load_source_model(path);
  const auto bytes = std::filesystem::file_size(path);
  const bool lumen = model->flux_unit() == FluxUnit::lumen;
  Description d;
  d.json = {{"path", path},
            {"format", "nfl"},
            {"method", std::string(model->method())},
            {"rays", model->training_rays()},
            {lumen ? "flux_lm" : "flux_w", model->flux()},
            {"bytes", bytes},
            {"layers", model->layers()},
            {"leaves", model->leaves()},
            {"warnings", Json::array()}};
  d.lines = {
      fmt::format("  format              source model (.nfl), method {}, {} bytes", model->method(), bytes),
      fmt::format("  made from           {} rays", model->training_rays()),
      fmt::format("  flux                {:.6g} {}", model->flux(), symbol(model->flux_unit())),
      fmt::format("  size                {} layer(s), {} leaves", model->layers(), model->leaves())};
  return d;
}

}  // namespace lucerna::cli
