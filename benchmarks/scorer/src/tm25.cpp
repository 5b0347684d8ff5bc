// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstring>
#include <fstream>

#include "emitter.h"

namespace bench {

namespace {

// IES TM-25-13: where the header has what is needed here.
constexpr std::size_t kVersion = 4, kRayCount = 20, kTables = 76, kItems = 80, kFlags = 256, kHeader = 36288;
constexpr std::size_t kRadiant = 2, kLuminous = 4, kFlagCount = 8;

class Tm25File {
 public:
  explicit Tm25File(const std::string& file) : file_(file), in_(file, std::ios::binary | std::ios::ate) {
    if (!in_) throw InputError(file, "file", "nothing that can be opened", "a TM-25 file");
    size_ = static_cast<std::uint64_t>(in_.tellg());
    if (size_ < kHeader) fail(0, std::to_string(size_) + " bytes", "a header of 36288 bytes");
    head_ = bytes(0, kHeader);
  }

  std::vector<SourceRay> rays() {
    check_head();
    const auto n = load<std::uint64_t>(kRayCount);
    if (n == 0) fail(kRayCount, "no rays", "one ray or more");
    const std::uint64_t columns = column_count();
    if (n > (size_ - kHeader) / (4 * columns))
      fail(kRayCount, std::to_string(n) + " rays", "no more than the file has room for");
    // The rays end the file; so blocks of spectra and texts before them need not be understood.
    const std::uint64_t start = size_ - n * columns * 4;
    const std::vector<char> data = bytes(start, n * columns * 4);
    std::vector<SourceRay> out;
    double total = 0.0;
    for (std::uint64_t i = 0; i < n; ++i) {
      out.push_back(ray(data, i, columns, start));
      total += out.back().weight;
    }
    if (!(total > 0.0)) fail(start, "no flux", "a flux > 0");
    for (SourceRay& r : out) r.weight *= static_cast<double>(n) / total;
    return out;
  }

 private:
  [[noreturn]] void fail(std::uint64_t byte, const std::string& found, const std::string& expected) const {
    throw InputError(file_, "byte " + std::to_string(byte), found, expected);
  }
  std::vector<char> bytes(std::uint64_t at, std::uint64_t count) {
    std::vector<char> out(count);
    in_.seekg(static_cast<std::streamoff>(at));
    if (!in_.read(out.data(), static_cast<std::streamsize>(count)))
      fail(at, "the end of the file", std::to_string(count) + " bytes");
    return out;
  }
  template <class T>
  T load(std::size_t at) const {
    T value;
    std::memcpy(&value, head_.data() + at, sizeof value);
    return value;
  }
  bool flag(std::size_t k) const { return load<std::int32_t>(kFlags + 4 * k) == 1; }

  void check_head() const {
    if (std::memcmp(head_.data(), "TM25", 4) != 0) fail(0, "other bytes", "TM25");
    if (load<std::int32_t>(kVersion) != 2013)
      fail(kVersion, "version " + std::to_string(load<std::int32_t>(kVersion)), "version 2013");
    if (load<std::int32_t>(kTables) != 0) fail(kTables, "spectral tables", "none in a frozen source");
    if (load<std::int32_t>(kItems) != 0) fail(kItems, "additional items per ray", "none in a frozen source");
    for (std::size_t k = 0; k < kFlagCount; ++k) {
      const bool wanted = k < 2, allowed = wanted || k == kRadiant || k == kLuminous;
      if (flag(k) && !allowed) fail(kFlags + 4 * k, "flag set", "flag clear in a frozen source");
      if (!flag(k) && wanted) fail(kFlags + 4 * k, "flag clear", "rays with position and direction");
    }
    if (!flag(kRadiant) && !flag(kLuminous)) fail(kFlags + 8, "no flux per ray", "a flux per ray");
  }
  std::uint64_t column_count() const { return 6U + (flag(kRadiant) ? 1U : 0U) + (flag(kLuminous) ? 1U : 0U); }
  SourceRay ray(const std::vector<char>& data, std::uint64_t i, std::uint64_t columns,
                std::uint64_t start) const {
    float v[7];
    std::memcpy(v, data.data() + i * columns * 4, sizeof v);
    const SourceRay out{{v[0], v[1], v[2]}, unit({v[3], v[4], v[5]}), static_cast<double>(v[6])};
    const double check = dot(out.origin, out.origin) + out.weight;
    const Vec3 d{v[3], v[4], v[5]};
    if (!std::isfinite(check) || !(out.weight >= 0.0) || !(std::abs(length(d) - 1.0) < 1e-3))
      fail(start + i * columns * 4, "a ray out of range", "finite numbers, a unit direction, flux >= 0");
    return out;
  }

  std::string file_;
  std::ifstream in_;
  std::uint64_t size_ = 0;
  std::vector<char> head_;
};

class FrozenRays final : public Source {
 public:
  FrozenRays(std::vector<SourceRay> rays, const Frame& place) : rays_(std::move(rays)) {
    for (SourceRay& r : rays_) {
      r.origin = place.point(r.origin);
      r.direction = place.vector(r.direction);
    }
  }
  SourceRay ray(std::uint64_t index, RayRandom&) const override { return rays_[index]; }
  std::uint64_t count() const override { return rays_.size(); }

 private:
  std::vector<SourceRay> rays_;
};

}  // namespace

std::unique_ptr<Source> read_tm25(const std::string& file, const Frame& place) {
  return std::make_unique<FrozenRays>(Tm25File(file).rays(), place);
}

}  // namespace bench
