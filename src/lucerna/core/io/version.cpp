// SPDX-License-Identifier: Apache-2.0
#include "lucerna/version.h"

namespace lucerna {

std::string_view version() { return LUCERNA_VERSION; }

}  // namespace lucerna
