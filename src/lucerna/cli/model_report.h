// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "lucerna/cli/session.h"
#include "lucerna/source_model.h"

namespace lucerna::cli {

/// Writes the report of the model in the file `model_path` to `output`, against the rays of `ray_paths`
/// (none: without a comparison). `json` is the result that the page shows. Of large files every so-manieth
/// ray is taken, 4 M together.
void write_model_report(const SourceModel& model, const std::string& model_path,
                        const std::vector<std::string>& ray_paths, Json json, const std::string& output,
                        Session& session);

}  // namespace lucerna::cli
