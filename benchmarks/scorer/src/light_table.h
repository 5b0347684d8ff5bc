// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "emitter.h"

namespace bench {

/// The planes C0 and C180 of an LDT file (EULUMDAT) as light of a two-dimensional task: directions in the
/// plane y = 0, intensity per angle from -z, C0 towards +x, linear between the file's gammas and none beyond
/// the last. What a surface would do to the source's light is not known from it, so all light is in the
/// table: its light output ratio must be 100 (within 0.01). Throws InputError with the place where the file
/// is damaged.
std::unique_ptr<Source> read_light_table(const std::string& file);

}  // namespace bench
