// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "lucerna/design/problem/target.h"
#include "lucerna/results/folders/trace_folder.h"
#include "lucerna/scene.h"

namespace lucerna {

/// One line of a design's history.csv.
struct HistoryLine {
  double evaluations = 0.0, stage = 0.0, total_rays = 0.0, relative_rms = 0.0, floor = 0.0, efficiency = 0.0;
  bool accepted = true;
};

/// Reads history.csv by its header's names. `file` names it in errors. Throws InputError with the line where
/// a column or number is missing.
std::vector<HistoryLine> read_history(std::string_view csv, const std::string& file);

/// What a design report shows beside the folder's files.
struct DesignReportOptions {
  /// Of the folder's project, for the target and the 3D view; not owned, both or none. Without them the
  /// report says why there is neither: `no_problem`, plain text.
  const DesignTarget* target = nullptr;
  const Scene* scene = nullptr;
  std::string no_problem = "the project was not read";
};

/// The report of a design as one self-contained HTML file (html_page.h): figures, limits and remarks,
/// convergence, target against result and their difference, energy balance, 3D view of the mirror found,
/// diagrams of its light, provenance. A plane target is compared on its own rectangle, traced again with a
/// million rays. Throws InputError where result.json or history.csv lacks a figure.
std::string design_report_html(const TraceFolder& folder, const std::vector<HistoryLine>& history,
                               const DesignReportOptions& options = {});

/// Was the folder written by `lucerna design`? (It has a history.csv beside its result.json.)
bool is_design_folder(const std::filesystem::path& folder);

/// Reads the folder and writes its report to `output`. Where the project or its target cannot be read any
/// more, the report says so instead of showing them.
void write_design_report(const std::filesystem::path& folder, const std::filesystem::path& output);

}  // namespace lucerna
