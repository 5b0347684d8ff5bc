// SPDX-License-Identifier: Apache-2.0
#include "lucerna/distributed/partial_trace.h"

#include <utility>

#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"
#include "lucerna/core/io/message_bytes.h"
#include "lucerna/core/io/sha256.h"
#include "lucerna/results/folders/trace_file.h"
#include "lucerna/trace/result/addition.h"

namespace lucerna {

namespace {

constexpr std::string_view kMagic = "LUCPART1";
constexpr std::size_t kHashBytes = 64;
constexpr std::uint64_t kMaxPartBytes = std::uint64_t{16} << 30;

/// Do the rays of `range` all come after those of `sum`? Then they are appended, which costs nothing.
bool follow(const TraceResult& sum, const TraceResult& range) {
  if (sum.out_runs.empty() || range.out_runs.empty()) return true;
  const OutRun &last = sum.out_runs.back(), &first = range.out_runs.front();
  return std::pair(last.block, last.source) < std::pair(first.block, first.source);
}

void add_rays(TraceResult& sum, const TraceResult& range) {
  if (follow(sum, range)) {
    sum.out_rays.append(range.out_rays);
    sum.out_runs.insert(sum.out_runs.end(), range.out_runs.begin(), range.out_runs.end());
    return;
  }
  TraceResult joined;
  join_rays(sum, range, joined);
  sum.out_rays = std::move(joined.out_rays);
  sum.out_runs = std::move(joined.out_runs);
}

void add_sums(TraceResult& sum, const TraceResult& other) {
  check_addable(sum, other);
  for (std::size_t r = 0; r < sum.replicates.size(); ++r) sum.replicates[r] += other.replicates[r];
  if (!sum.ray_detectors.empty()) add_rays(sum, other);
}

}  // namespace

void PartialTrace::add(const TraceResult& range) {
  add_sums(sums, range);
  done.add({range.first_ray, range.last_ray});
}

void PartialTrace::add(const PartialTrace& other) {
  LUCERNA_CHECK(!done.overlaps(other.done), "rays of both");
  add_sums(sums, other.sums);
  done.add(other.done);
}

std::string encode_part(const PartialTrace& part, const TraceOrigin& origin) {
  std::string body;
  append(body, part.done.all().size());
  for (const RayInterval& i : part.done.all()) {
    append(body, i.first);
    append(body, i.last);
  }
  // The file of a trace has one range: here as many rays as there are, whichever they are.
  TraceResult sums = part.sums;
  sums.first_ray = 0;
  sums.last_ray = part.done.count();
  body += encode_trace(sums, origin);
  return std::string(kMagic) + sha256_of_text(body) + body;
}

StoredPart decode_part(std::string_view bytes, const std::string& name) {
  if (bytes.size() < kMagic.size() + kHashBytes + sizeof(std::uint64_t) || !bytes.starts_with(kMagic))
    throw_input_error(name, "byte 0", "this is no part of a trace of Lucerna's");
  std::string_view body = bytes.substr(kMagic.size() + kHashBytes);
  if (sha256_of_text(body) != bytes.substr(kMagic.size(), kHashBytes))
    throw_input_error(name, fmt::format("byte {}", kMagic.size()), "the checksum is not that of the bytes");
  const std::uint64_t count = take(body);
  if (count == 0 || count > body.size() / (2 * sizeof(std::uint64_t)))
    throw_input_error(name, "", "{} intervals are not what the file holds", count);
  RayIntervals done;
  for (std::uint64_t k = 0; k < count; ++k) {
    const std::uint64_t first = take(body), last = take(body);
    if (first >= last || (k > 0 && first <= done.all().back().last))
      throw_input_error(name, "", "rays {}:{}: expected intervals that ascend", first, last);
    done.add({first, last});
  }
  StoredTrace stored = decode_trace(body, name);
  if (stored.result.last_ray != done.count())
    throw_input_error(name, "", "{} rays in the sums, {} in the intervals", stored.result.last_ray,
                      done.count());
  return {{std::move(stored.result), std::move(done)}, std::move(stored.origin)};
}

StoredPart read_part_file(const std::filesystem::path& path) {
  return decode_part(read_file(path, kMaxPartBytes), path.string());
}

}  // namespace lucerna
