// SPDX-License-Identifier: Apache-2.0
#include "lucerna/results/folders/trace_file.h"

#include <zstd.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstring>
#include <utility>
#include <vector>

#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"
#include "lucerna/trace/detectors/far_field_grid.h"
#include "lucerna/trace/engines/ray_numbering.h"
#include "lucerna/trace/tally/flux_quanta.h"
#include "lucerna/trace/tally/wide_sums.h"
#include "lucerna/trace_file.h"
#include "lucerna/version.h"

namespace lucerna {

namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::string_view kMagic = "LUCTRACE";
/// The second has sums of two lanes (Tally::high); it is written only where a sum needs them.
constexpr std::uint32_t kVersion = 3, kTwoLanesVersion = 4;
/// Sixteen replicates of three detectors of 16 M cells of two lanes of 8 bytes: more than any project needs.
constexpr std::uint64_t kMaxTraceBytes = std::uint64_t{12} << 30;

/// One description of the layout serves both ways: `archive(x)` writes or reads x.
class Writer {
 public:
  template <class T>
  requires std::integral<T> || std::floating_point<T>
  void operator()(const T& value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof value); }
  void operator()(const std::string& text) {
    count(text.size(), 1);
    bytes.append(text);
  }
  template <class T>
  std::size_t count(std::size_t n, T) {
    (*this)(static_cast<std::uint64_t>(n));
    return n;
  }
  std::string bytes;
};

class Reader {
 public:
  Reader(std::string_view bytes, std::string file) : bytes_(bytes), file_(std::move(file)) {}
  template <class T>
  requires std::integral<T> || std::floating_point<T>
  void operator()(T& value) {
    need(sizeof value);
    std::memcpy(&value, bytes_.data() + at_, sizeof value);
    at_ += sizeof value;
  }
  void operator()(std::string& text) {
    const std::size_t n = count(0, 1);
    text = std::string(bytes_.substr(at_, n));
    at_ += n;
  }
  /// A count of items of at least `item_bytes` each, which the rest of the file must be able to hold.
  std::size_t count(std::size_t, std::size_t item_bytes) {
    std::uint64_t n = 0;
    (*this)(n);
    if (n > (bytes_.size() - at_) / item_bytes) fail("a count of {} is more than the file holds", n);
    return static_cast<std::size_t>(n);
  }
  template <class... Args>
  [[noreturn]] void fail(fmt::format_string<Args...> text, Args&&... args) const {
    throw_input_error(file_, fmt::format("unpacked byte {}", at_), text, std::forward<Args>(args)...);
  }
  bool at_end() const { return at_ == bytes_.size(); }

 private:
  void need(std::size_t n) const {
    if (bytes_.size() - at_ < n) fail("the file ends, expected {} more bytes", n);
  }
  std::string_view bytes_;
  std::string file_;
  std::size_t at_ = 0;
};

template <class Archive, class Vector, class Each>
void each(Archive& archive, Vector& items, std::size_t item_bytes, Each&& body) {
  const std::size_t n = archive.count(items.size(), item_bytes);
  if constexpr (!std::is_const_v<Vector>) items.resize(n);
  for (auto& item : items) body(item);
}

template <class Archive, class GridType>
void describe_grid(Archive& archive, GridType& grid) {
  Vec3 v[4] = {grid.world_from_plane.ex(), grid.world_from_plane.ey(), grid.world_from_plane.ez(),
               grid.world_from_plane.origin_mm()};
  for (Vec3& a : v) {
    archive(a.x);
    archive(a.y);
    archive(a.z);
  }
  archive(grid.size_x_mm);
  archive(grid.size_y_mm);
  std::uint64_t nx = grid.nx, ny = grid.ny;
  archive(nx);
  archive(ny);
  if constexpr (!std::is_const_v<GridType>) {
    grid.world_from_plane = Frame(v[0], v[1], v[2], v[3]);
    grid.nx = static_cast<std::size_t>(nx);
    grid.ny = static_cast<std::size_t>(ny);
  }
}

template <class Archive, class Origin>
void describe_origin(Archive& archive, Origin& o) {
  archive(o.scene_id);
  archive(o.program_version);
  archive(o.project);
  archive(o.luminous_length_mm);
  archive(o.luminous_width_mm);
}

template <class Archive, class Result>
void describe_head(Archive& archive, Result& r) {
  archive(r.first_ray);
  archive(r.last_ray);
  archive(r.seed);
  std::uint8_t sobol = r.sequence == SequenceKind::sobol, watt = r.unit == FluxUnit::watt;
  archive(sobol);
  archive(watt);
  archive(r.max_bounces);
  archive(r.isa);
  archive(r.flux);
  if constexpr (!std::is_const_v<Result>) {
    r.sequence = sobol != 0 ? SequenceKind::sobol : SequenceKind::random;
    r.unit = watt != 0 ? FluxUnit::watt : FluxUnit::lumen;
  }
  each(archive, r.body_names, 8, archive);
  each(archive, r.far_fields, 24, [&](auto& d) {
    archive(d.name);
    archive(d.c_step_deg);
    archive(d.gamma_step_deg);
    std::uint8_t tent = d.tent ? 1 : 0;
    archive(tent);
    if constexpr (!std::is_const_v<Result>) d.tent = tent != 0;
  });
  each(archive, r.planes, 64, [&](auto& d) {
    archive(d.name);
    describe_grid(archive, d.grid);
  });
  each(archive, r.luminances, 64, [&](auto& d) {
    archive(d.name);
    describe_grid(archive, d.grid);
    archive(d.half_angle_deg);
    archive(d.distance_mm);
    archive(d.pupil_radius_mm);
  });
  each(archive, r.ray_detectors, 16, [&](auto& d) {
    archive(d.name);
    archive(d.format);
  });
}

template <class Archive, class Result>
void describe_rays(Archive& archive, Result& r) {
  each(archive, r.out_runs, 16, [&](auto& run) {
    archive(run.block);
    archive(run.source);
    archive(run.rays);
  });
  auto& rays = r.out_rays;
  for (auto* column : {&rays.x_mm, &rays.y_mm, &rays.z_mm, &rays.kx, &rays.ky, &rays.kz, &rays.weight})
    each(archive, *column, 4, archive);
}

/// `two_lanes`: the version that has Tally::high.
template <class Archive, class Replicates>
void describe_sums(Archive& archive, Replicates& replicates, bool two_lanes) {
  each(archive, replicates, 64, [&](auto& t) {
    archive(t.rays);
    archive(t.reflections);
    archive(t.emitted);
    archive(t.out_direct);
    archive(t.out_reflected);
    each(archive, t.absorbed, 8, archive);
    each(archive, t.lost, 8, archive);
    each(archive, t.lost_rays, 8, archive);
    each(archive, t.bins, 8, [&](auto& bins) { each(archive, bins, 8, archive); });
    if (two_lanes) each(archive, t.high, 8, archive);
  });
}

/// Runs ascend and hold all kept rays.
void check_rays(const TraceResult& r, const Reader& reader) {
  const RayBlock& b = r.out_rays;
  for (const RayDetector& d : r.ray_detectors) check(d);
  std::uint64_t rays = 0;
  bool good = true;
  for (std::size_t i = 0; i < r.out_runs.size(); ++i) {
    const OutRun& run = r.out_runs[i];
    rays += run.rays;
    if (i > 0)
      good = good &&
             std::pair(r.out_runs[i - 1].block, r.out_runs[i - 1].source) < std::pair(run.block, run.source);
  }
  for (const auto* column : {&b.x_mm, &b.y_mm, &b.z_mm, &b.kx, &b.ky, &b.kz})
    good = good && column->size() == b.weight.size();
  // Accelerators keep rays without their runs; those cannot be added to others, but are whole.
  const bool all = r.out_runs.empty() || rays == b.weight.size();
  if (!good || !all || (r.ray_detectors.empty() && !b.empty()))
    reader.fail("kept rays that do not fit their runs");
}

/// Are the lanes of the sums such that many tallies add without overflow?
bool can_be_added(const Tally& t) {
  if (t.high.empty()) return fits_one_lane(t);
  // 2^53 rays of 2^26 units are 2^79, of which the low lane has 32 bits.
  constexpr std::int64_t kMostHigh = std::int64_t{1} << 50;
  bool good = t.high.size() == sum_count(t);
  for (const std::int64_t high : t.high) good = good && high >= -kMostHigh && high <= kMostHigh;
  for_each_sum(t, [&](const std::int64_t* low, std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) good = good && low[i] >= 0 && low[i] < std::int64_t{1} << 32;
  });
  return good;
}

/// What merging and the figures rely on.
void check_shape(const TraceResult& r, const Reader& reader) {
  if (!(r.first_ray < r.last_ray && r.last_ray <= kMaxRays))
    reader.fail("rays {}:{}", r.first_ray, r.last_ray);
  if (!(r.flux > 0.0 && std::isfinite(r.flux))) reader.fail("flux {}", r.flux);
  if (r.replicates.size() != kReplicates)
    reader.fail("{} replicates, expected {}", r.replicates.size(), kReplicates);
  std::vector<std::size_t> sizes;
  for (const FarFieldDetector& d : r.far_fields) sizes.push_back(FarFieldGrid::counted(d).size());
  for (const PlaneDetector& d : r.planes) check(d), sizes.push_back(d.grid.size());
  for (const LuminanceDetector& d : r.luminances) check(d), sizes.push_back(d.grid.size());
  std::uint64_t rays = 0;
  Int128 emitted = 0;
  for (const Tally& t : r.replicates) {
    bool good = t.absorbed.size() == kMirrorLosses + r.body_names.size() && t.lost.size() == kLostCauses &&
                t.lost_rays.size() == kLostCauses && t.bins.size() == sizes.size() && t.rays <= kMaxRays;
    for (std::size_t d = 0; good && d < sizes.size(); ++d) good = t.bins[d].size() == sizes[d];
    good = good && can_be_added(t) && emitted_of(t) >= 0;
    if (!good) reader.fail("sums that do not fit the detectors");
    rays += t.rays;
    emitted += emitted_of(t);
  }
  if (rays != r.last_ray - r.first_ray || emitted <= 0)
    reader.fail("{} rays in {}:{}", rays, r.first_ray, r.last_ray);
  check_rays(r, reader);
}

}  // namespace

std::string encode_trace(const TraceResult& result, const TraceOrigin& origin) {
  Writer writer;
  describe_origin(writer, origin);
  describe_head(writer, result);
  const bool two_lanes = std::any_of(result.replicates.begin(), result.replicates.end(),
                                     [](const Tally& t) { return !t.high.empty(); });
  describe_sums(writer, result.replicates, two_lanes);
  describe_rays(writer, result);
  std::string packed(ZSTD_compressBound(writer.bytes.size()), '\0');
  const std::size_t n =
      ZSTD_compress(packed.data(), packed.size(), writer.bytes.data(), writer.bytes.size(), 3);
  LUCERNA_CHECK(ZSTD_isError(n) == 0, "{}", ZSTD_getErrorName(n));
  std::string bytes(kMagic);
  const std::uint32_t version = two_lanes ? kTwoLanesVersion : kVersion;
  bytes.append(reinterpret_cast<const char*>(&version), sizeof version);
  bytes.append(packed, 0, n);
  return bytes;
}

void write_trace_file(const std::filesystem::path& path, const TraceResult& result,
                      const TraceOrigin& origin) {
  write_file(path, encode_trace(result, origin));
}

StoredTrace read_trace_file(const std::filesystem::path& path) {
  return decode_trace(read_file(path, kMaxTraceBytes), path.string());
}

StoredTrace decode_trace(std::string_view bytes, const std::string& name) {
  constexpr std::size_t kHead = kMagic.size() + sizeof kVersion;
  if (bytes.size() < kHead || !bytes.starts_with(kMagic))
    throw_input_error(name, "byte 0", "this is no trace of Lucerna's");
  std::uint32_t version = 0;
  std::memcpy(&version, bytes.data() + kMagic.size(), sizeof version);
  if (version != kVersion && version != kTwoLanesVersion) {
    throw_input_error(name, fmt::format("byte {}", kMagic.size()), "version {}, expected {} or {}", version,
                      kVersion, kTwoLanesVersion);
  }
  const std::string_view frame = bytes.substr(kHead);
  const unsigned long long size = ZSTD_getFrameContentSize(frame.data(), frame.size());
  // zstd packs at most about 1 : 2^17 (runs of one byte), so a small file cannot ask for much memory.
  if (size == ZSTD_CONTENTSIZE_ERROR || size == ZSTD_CONTENTSIZE_UNKNOWN || size > kMaxTraceBytes ||
      size / (1u << 17) > frame.size()) {
    throw_input_error(name, fmt::format("byte {}", kHead), "the packed part is damaged");
  }
  std::string unpacked(static_cast<std::size_t>(size), '\0');
  const std::size_t n = ZSTD_decompress(unpacked.data(), unpacked.size(), frame.data(), frame.size());
  if (ZSTD_isError(n) != 0 || n != unpacked.size()) {
    throw_input_error(name, fmt::format("byte {}", kHead), "the packed part is damaged: {}",
                      ZSTD_getErrorName(n));
  }
  Reader reader(unpacked, name);
  StoredTrace stored;
  describe_origin(reader, stored.origin);
  describe_head(reader, stored.result);
  describe_sums(reader, stored.result.replicates, version == kTwoLanesVersion);
  describe_rays(reader, stored.result);
  if (!reader.at_end()) reader.fail("more bytes than the sums need");
  check_shape(stored.result, reader);
  for (Tally& t : stored.result.replicates) settle_lanes(t);
  return stored;
}

std::string trace_bytes(const TraceResult& result) {
  return encode_trace(result, {.program_version = std::string(version())});
}

TraceResult trace_from_bytes(std::string_view bytes, const std::string& name) {
  return decode_trace(bytes, name).result;
}

TraceResult read_trace(const std::filesystem::path& folder) {
  return read_trace_file(folder / kTraceFileName).result;
}

}  // namespace lucerna
