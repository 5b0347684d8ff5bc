// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "lucerna/progress.h"
#include "lucerna/rays.h"
#include "lucerna/source_model.h"

namespace lucerna {

/// What a model's report shows beside the model.
struct ModelReportOptions {
  std::string title;
  /// The rays that the model is shown against, at most some millions (not owned); without them there is no
  /// comparison.
  const RayBlock* rays = nullptr;
  /// Of how many rays in the files `rays` is a choice; 0 = of all.
  std::uint64_t rays_in_files = 0;
  /// Rays drawn from the model for the comparison.
  std::size_t model_rays = std::size_t{1} << 21;
};

/// The report of a source model as one self-contained HTML file (html_page.h): figures, luminance from any
/// direction drawn in the page, the five views of rays and model with error, floor, excess and raw, the
/// étendue curve, layers, provenance. `result` is what compress or info say of it (method rays bytes
/// layers leaves flux_lm|flux_w and the keys that every result has); the page embeds it with `views` and
/// `etendue_mm2sr` added. Cost: about a second per million rays, and some for the étendue (model_etendue.h).
/// Throws InputError where `result` lacks a figure.
std::string model_report_html(const SourceModel& model, nlohmann::ordered_json result,
                              const ModelReportOptions& options, Progress& progress = no_progress());

}  // namespace lucerna
