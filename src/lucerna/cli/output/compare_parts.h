// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "lucerna/cli/parse/photometric_arguments.h"
#include "lucerna/cli/parse/session.h"
#include "lucerna/comparison.h"
#include "lucerna/held_out.h"

namespace lucerna::cli {

struct CompareArguments {
  std::string reference, test, output, rays = "4e6", seed = "1", cells_um = "12,24,48,96,240";
  PhotometricArguments photometric;
};

/// How far a model of half of the rays is from the others, as tables.
void print_held_out(const HeldOutComparison& h, Session& session);
/// Of two ray sets or models, the result's keys; and what is said of it.
Json rays_json(const RayFileComparison& r);
void say_rays(const CompareArguments& a, const RayFileComparison& r, Session& session);

}  // namespace lucerna::cli
