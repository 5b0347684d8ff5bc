// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "lucerna/trace.h"

#pragma GCC visibility push(default)
namespace lucerna {

/// A trace as bytes, to be sent to another process and merged there: the layout of the file of raw sums that
/// `write_trace` leaves, without its project. About a byte per used bin and replicate, 26 per kept ray.
[[nodiscard]] std::string trace_bytes(const TraceResult& result);

/// The inverse, to the bit; `name` is for messages. Throws InputError with the byte on anything that
/// `trace_bytes` cannot have made.
[[nodiscard]] TraceResult trace_from_bytes(std::string_view bytes, const std::string& name = "trace");

/// The raw sums in a folder that `write_trace` or `lucerna trace` has filled. Throws InputError as above.
[[nodiscard]] TraceResult read_trace(const std::filesystem::path& folder);

}  // namespace lucerna
#pragma GCC visibility pop
