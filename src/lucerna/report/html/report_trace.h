// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "lucerna/results/folders/trace_folder.h"
#include "lucerna/scene.h"

namespace lucerna {

/// What a trace report shows beside the folder's files.
struct TraceReportOptions {
  /// The scene of the folder's project, for the 3D view; not owned. Without it the report says why there is
  /// none: `no_scene`, plain text.
  const Scene* scene = nullptr;
  std::string no_scene = "the project was not read";
};

/// The report of a trace as one self-contained HTML file (html_page.h): figures with their errors, energy
/// balance, diagrams, zonal flux, 3D view, provenance. A figure that result.json holds stands in an element
/// whose `data-key` is its JSON pointer; the values of the far fields are in the page as float32, thinned to
/// at most 27 k directions each (the page says so). Throws InputError where result.json lacks a figure.
std::string trace_report_html(const TraceFolder& folder, const TraceReportOptions& options = {});

/// Reads the project in the folder for `trace_report_html` and writes the report to `output`. Where the
/// project cannot be read any more (a ray file moved away), the report says so instead of the 3D view.
void write_trace_report(const std::filesystem::path& folder, const std::filesystem::path& output);

}  // namespace lucerna
