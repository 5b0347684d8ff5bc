// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "lucerna/cli/parse/session.h"
#include "lucerna/results/folders/trace_origin.h"
#include "lucerna/results/json/trace_json.h"

namespace lucerna::cli {

/// The end of `trace` and `merge`: fills `folder` (files by detector, result.json, the raw sums that `merge`
/// takes), prints the JSON, and tells of `warnings` (trace_warnings) and others. Returns the names of the
/// files. `seed` and inputs are what the session's head says.
std::vector<std::string> write_trace_output(const std::string& folder, const TraceResult& result,
                                            const TraceOrigin& origin, const TraceMetrics& figures,
                                            std::vector<std::string> warnings, Session& session);

/// Says what of the noise that was asked for (`goal`) is missing, and why. `of`: begins the sentence.
void note_noise(const std::string& of, const NoiseTrace& traced, double goal, Session& session);
/// Says that a ray file ended before the rays up to `last_ray` that were asked for.
void note_ray_file(std::uint64_t last_ray, const NoiseTrace& traced, Session& session);

/// Without the light that is followed backward, figures are those of `merge`.
void note_interrupted_figures(Session& session);

/// The figures as text, and the files.
void print_trace_summary(const TraceMetrics& figures, const std::vector<std::string>& names,
                         Session& session);

/// The report of a folder that write_trace_output() filled, as one HTML file.
void write_trace_report(const std::string& html, const std::string& folder, const Scene& scene,
                        Session& session);

}  // namespace lucerna::cli
