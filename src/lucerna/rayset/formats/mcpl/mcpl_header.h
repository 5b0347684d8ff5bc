// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "lucerna/core/io/byte_stream.h"
#include "lucerna/rayset/formats/common/record_file.h"
#include "lucerna/rayset/formats/mcpl/mcpl_layout.h"

namespace lucerna {

/// All that a file says before its particles.
struct McplHeader {
  RayFileFacts facts;
  McplRecord record;
  std::uint64_t first_byte = 0;
  /// Where the records do not say it.
  double weight = 1.0;
  std::int32_t pdg_code = 0;
};

/// Reads the header and leaves `stream` at the first particle. InputError with the byte where it does not
/// add up, or where a version other than 3 or another order of bytes is stated. Memory: 64 KiB.
McplHeader read_mcpl_header(ByteStream& stream, bool salvage);

}  // namespace lucerna
