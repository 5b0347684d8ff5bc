// SPDX-License-Identifier: Apache-2.0
#include "lucerna/core/io/error.h"
#include "lucerna/source.h"

namespace lucerna {

void RaySource::emit_wavelengths(const Sequence&, std::uint64_t, std::span<float> nm) const {
  LUCERNA_CHECK(nm.empty(), "{} wavelengths of a source without", nm.size());
}

}  // namespace lucerna
