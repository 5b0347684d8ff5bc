// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "lucerna/cli/photometric_arguments.h"
#include "lucerna/cli/session.h"

namespace lucerna::cli {

struct CompareArguments {
  std::string reference, test, output, rays = "4e6", seed = "1", cells_um = "12,24,48,96,240";
  PhotometricArguments photometric;
};

/// Two ray sets or models: the five views, focus-plane illuminance, correlations, étendue, pictures.
void compare_rays(const CompareArguments& a, Session& session);

/// Prints `json` and, with a folder asked for, writes it there as result.json.
void write_comparison(const CompareArguments& a, const Json& json, Session& session);

}  // namespace lucerna::cli
